#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/display.hpp"
#include "report/rated_mesh.hpp"
#include "report/strength_report.hpp"

namespace gear3k::report {

namespace {

using design::StrengthResult, strength::Drive, strength::MeshRating, strength::ToothRating,
    units::Unit;

std::string_view drive_name(Drive drive) {
  return strength::kDriveNames[static_cast<std::size_t>(drive)];
}

double n_mm(double N_m) { return units::from_si(N_m, Unit::kNewtonPerMillimetre); }
double n_mm_um(double Pa) { return units::from_si(Pa, Unit::kMeshStiffness); }
/// Z_E in √(N/mm²).
double root_mpa(double root_Pa) { return root_Pa / 1e3; }

std::optional<double> if_stated(double value, bool stated) {
  return stated ? std::optional(value) : std::nullopt;
}
/// A quantity that is 0 where it is not stated or not computed.
std::optional<double> if_positive(double value) { return if_stated(value, value > 0.0); }

void add_drive(Fields& f, const RatedMesh& mesh) {
  if (mesh.drive) f.add("direction", drive_name(*mesh.drive));
}

Fields rated_mesh_fields(const RatedMesh& mesh) {
  const MeshRating<double>& r = *mesh.rating;
  Fields f(mesh.name);
  f.add("name", mesh.name);
  add_drive(f, mesh);
  f.add("normal_force_n", r.normal_N, {"normal_force", "N"});
  if (mesh.drive) {
    f.add("normal_force_forward_n", mesh.forward_N, {"normal_force_forward", "N"});
    f.add("normal_force_backward_n", mesh.backward_N, {"normal_force_backward", "N"});
  }
  f.add("tangential_force_n", r.tangential_N, {"tangential_force", "N"});
  f.add("face_width_mm", mm(r.face_width_m), {"face_width", "mm"});
  f.add("speed_m_s", if_positive(r.speed_m_s), {"pitch_line_speed", "m/s"});
  f.add("line_load_n_mm", n_mm(r.line_load_N_m), {"line_load", "N/mm"});
  f.add("sigma_h0_mpa", mpa(r.flank.nominal_Pa), {"sigma_h0", "MPa"});
  f.add("sigma_h_mpa", mpa(std::max(r.teeth[0].flank_stress_Pa, r.teeth[1].flank_stress_Pa)),
        {"sigma_h", "MPa"});
  f.add("sigma_h_pitch_point_mpa", mpa(r.flank.pitch_point_Pa), {"sigma_h_pitch_point", "MPa"});
  f.add("z_h", r.flank.zone_factor, {"z_h"});
  f.add("z_e", root_mpa(r.flank.elasticity_factor), {"z_e", "sqrt(MPa)"});
  f.add("z_eps", r.flank.contact_ratio.value, {"z_eps"});
  f.add("z_b", r.flank.single_contact1.value, {"z_b"});
  f.add("z_d", r.flank.single_contact2.value, {"z_d"});
  for (const auto& [key, symbol, factor] : load_factors_of(r)) {
    f.add(key, factor->value, {std::string(key)});
  }
  f.add("c_prime_n_mm_um", if_positive(n_mm_um(r.iso.single)), {"c_prime", "N/(mm um)"});
  f.add("c_gamma_alpha_n_mm_um", if_positive(n_mm_um(r.iso.mesh_alpha)),
        {"c_gamma_alpha", "N/(mm um)"});
  f.add("c_gamma_beta_n_mm_um", if_positive(n_mm_um(r.iso.mesh_beta)),
        {"c_gamma_beta", "N/(mm um)"});
  f.add("c_prime_in_range", r.iso_in_range);
  f.add("mean_stiffness_n_mm_um", if_any(r.mean_stiffness_Pa, n_mm_um),
        {"mean_stiffness", "N/(mm um)"});
  f.add("deformation_um", if_any(r.deformation_m, um), {"deformation", "um"});
  return f;
}

/// Y of a limit, or Z: null where the rating did not come to it.
void add_factor(Fields& f, const NamedFactor& named) {
  f.add(named.key, if_stated(named.factor->value, is_applied(*named.factor)),
        {std::string(named.key)});
}

Fields rated_tooth_fields(const RatedMesh& mesh, std::size_t member) {
  const ToothRating<double>& t = mesh.rating->teeth[member];
  const strength::RootForm<double>& form = t.form;
  Fields f(fmt::format("{}, {}", mesh.name, mesh.gears[member]));
  f.add("gear", mesh.gears[member]);
  f.add("mesh", mesh.name);
  add_drive(f, mesh);
  f.add("plastic", t.plastic);
  f.add("cycles", t.cycles, {"load_cycles"});
  f.add("y_f", form.form_factor, {"y_f"});
  f.add("y_s", form.stress_correction_factor, {"y_s"});
  f.add("y_b", t.rim.value, {"y_b"});
  f.add("y_eps", t.contact_ratio_factor, {"y_eps"});
  f.add("root_chord_mm", mm(form.section.chord_m), {"root_chord", "mm"});
  f.add("root_section_diameter_mm",
        2.0 * mm(std::hypot(form.section.height_m, 0.5 * form.section.chord_m)),
        {"root_section_diameter", "mm"});
  f.add("bending_arm_mm", mm(form.bending_arm_m), {"bending_arm", "mm"});
  f.add("fillet_radius_mm", mm(form.section.fillet_radius_m), {"root_fillet_radius", "mm"});
  f.add("section_on_fillet", form.section.on_fillet);
  f.add("load_angle_deg", degrees(form.load.angle_rad), {"load_angle", "deg"});
  f.add("notch_parameter", form.notch_parameter, {"notch_parameter"});
  f.add("notch_in_range", form.notch_in_range);
  const bool root = t.root_limit_stated;
  f.add("sigma_f0_mpa", mpa(t.root.nominal_Pa), {"sigma_f0", "MPa"});
  f.add("sigma_f_mpa", mpa(t.root.stress_Pa), {"sigma_f", "MPa"});
  f.add("sigma_f_lim_mpa", if_stated(mpa(t.root_strength.limit_Pa), root), {"sigma_f_lim", "MPa"});
  for (const NamedFactor& named : root_factors_of(t)) add_factor(f, named);
  f.add("sigma_fg_mpa", if_stated(mpa(t.root_strength.strength_Pa), root), {"sigma_fg", "MPa"});
  f.add("root_safety", if_stated(t.root_safety, root), {"root_safety"});
  const bool flank = t.flank_limit_stated;
  f.add("sigma_h_mpa", mpa(t.flank_stress_Pa), {"sigma_h", "MPa"});
  f.add("sigma_h_lim_mpa", if_stated(mpa(t.flank_strength.limit_Pa), flank),
        {"sigma_h_lim", "MPa"});
  for (const NamedFactor& named : flank_factors_of(t)) add_factor(f, named);
  f.add("sigma_hg_mpa", if_stated(mpa(t.flank_strength.strength_Pa), flank), {"sigma_hg", "MPa"});
  f.add("flank_safety", if_stated(t.flank_safety, flank), {"flank_safety"});
  f.add("limit_in_range", t.limit_in_range);
  f.add("root_temperature_c", if_any(t.root_temperature_K, celsius), {"root_temperature", "C"});
  f.add("flank_temperature_c", if_any(t.flank_temperature_K, celsius), {"flank_temperature", "C"});
  f.add("wear_um", if_any(t.wear_m, um), {"wear", "um"});
  f.add("overload_root_safety", t.overload_root_safety, {"overload_root_safety"});
  f.add("overload_flank_safety", t.overload_flank_safety, {"overload_flank_safety"});
  return f;
}

Fields placed_factor_fields(const PlacedFactor& placed) {
  Fields f;
  f.add("name", placed.named.key);
  f.add("mesh", placed.mesh);
  f.add("gear", placed.gear.empty() ? io::Json() : io::Json(placed.gear));
  f.add("value", placed.named.factor->value);
  f.add("branch", placed.named.factor->branch);
  f.add("source", placed.named.factor->source);
  f.add("in_range", placed.named.factor->in_range);
  return f;
}

/// `meshes`, `teeth` and, at the end of the block, `factors`.
template <class Meshes>
void add_meshes(Fields& f, const Meshes& meshes) {
  f.add_list("meshes", meshes, rated_mesh_fields);
  f.add("teeth", io::Json::array());
  for (const RatedMesh& mesh : meshes) {
    for (const std::size_t member : {0U, 1U}) f.append("teeth", rated_tooth_fields(mesh, member));
  }
}
template <class Meshes>
void add_factors(Fields& f, const Meshes& meshes) {
  f.add("factors", io::Json::array());
  for (const RatedMesh& mesh : meshes) {
    for (const PlacedFactor& placed : factors_of(mesh)) {
      f.append("factors", placed_factor_fields(placed));
    }
  }
}

io::Json governing_json(const std::optional<strength::Capacity<double>>& capacity, Drive drive) {
  if (!capacity) return nullptr;
  const auto [mesh, member, mode] = capacity->governing;
  const auto gear = static_cast<std::size_t>(train::kMeshGears.at(mesh).at(member));
  return {{"gear", train::kGearNames.at(gear)},
          {"mesh", train::kMeshNames.at(mesh)},
          {"mode", strength::kModeNames.at(static_cast<std::size_t>(mode))},
          {"direction", drive_name(drive)}};
}

void add_capacity(Fields& f, const design::Evaluation& e) {
  const StrengthResult& s = e.strength.value();
  const auto torque = [](const std::optional<strength::Capacity<double>>& capacity) {
    return capacity ? std::optional(capacity->torque_Nm) : std::nullopt;
  };
  const std::optional<strength::DrivenCapacity> least = s.least_capacity();
  f.add("capacity_nm", least ? std::optional(least->capacity.torque_Nm) : std::nullopt,
        {"torque_capacity", "N m"});
  f.add("capacity_forward_nm", torque(s.capacity_forward), {"torque_capacity_forward", "N m"});
  f.add("capacity_backward_nm", torque(s.capacity_backward), {"torque_capacity_backward", "N m"});
  f.add("torque_density_nm_per_kg", torque_density(e), {"torque_density", "N m/kg"});
  f.add("gears_torque_density_nm_per_kg", gears_torque_density(e),
        {"gears_torque_density", "N m/kg"});
  f.add("governing", least ? governing_json(least->capacity, least->drive) : nullptr);
  f.add("governing_forward", governing_json(s.capacity_forward, Drive::kForward));
  f.add("governing_backward", governing_json(s.capacity_backward, Drive::kBackward));
}

Fields stiffness_fields(const strength::TrainStiffness<double>& stiffness) {
  const strength::TrainCompliance<double>& c = stiffness.compliance;
  Fields f("train");
  f.add("output_nm_per_rad", stiffness.output_Nm_rad, {"output_stiffness", "N m/rad"});
  f.add("input_nm_per_rad", stiffness.input_Nm_rad, {"input_stiffness", "N m/rad"});
  Fields parts("train");
  const auto add = [&](std::string_view part, double rad_Nm) {
    parts.add(part, rad_Nm, {fmt::format("compliance {}", part), "rad/(N m)"});
  };
  for (std::size_t k = 0; k < c.mesh.size(); ++k) add(train::kMeshNames[k], c.mesh[k]);
  add("planet_torsion", c.planet_torsion);
  add("bearings", c.bearings);
  add("sun_shaft", c.sun_shaft);
  add("ring2", c.ring2);
  f.add("compliance_rad_per_nm", std::move(parts));
  return f;
}

/// A radial and a tangential force under the name of where it acts.
Fields force_fields(const std::string& item, const std::string& key, const char* place,
                    const strength::TransverseForce<double>& force) {
  Fields f(item);
  f.add(key, place);
  f.add("radial_n", force.radial_N, {fmt::format("force {} radial", place), "N"});
  f.add("tangential_n", force.tangential_N, {fmt::format("force {} tangential", place), "N"});
  return f;
}

/// Loads of one planet in a drive direction.
Fields planet_load_fields(const strength::TrainRating<double>& rating) {
  const strength::PlanetLoads<double>& p = rating.planet.value();
  const std::string item = fmt::format("planet {}", drive_name(rating.drive));
  Fields f(item);
  f.append("plane_forces", force_fields(item, "plane", "P1", p.plane[0]));
  f.append("plane_forces", force_fields(item, "plane", "P2", p.plane[1]));
  f.add("centrifugal_n", p.centrifugal_N, {"centrifugal_force", "N"});
  f.add("tilting_couple_nm", p.tilting_couple_Nm, {"tilting_couple", "N m"});
  f.append("reactions", force_fields(item, "support", "A", p.reaction[0]));
  f.append("reactions", force_fields(item, "support", "B", p.reaction[1]));
  f.append("bearing_load_n", p.bearing_load_N[0], {"bearing_load A", "N"});
  f.append("bearing_load_n", p.bearing_load_N[1], {"bearing_load B", "N"});
  f.add("bending_moment_nm", p.bending_moment_Nm, {"pin_bending_moment", "N m"});
  f.add("bending_position_mm", mm(p.bending_position_m), {"pin_bending_position", "mm"});
  f.add("pin_stress_mpa", if_any(rating.pin_stress_Pa, mpa), {"pin_stress", "MPa"});
  return f;
}

/// Where K_γ of the meshes comes from.
Fields sharing_fields(const design::PlanetSharing& sharing) {
  Fields f("planet_sharing");
  f.add("quantile", sharing.quantile, {"quantile"});
  f.add("drawn", sharing.drawn, {"drawn"});
  f.add("assembled", sharing.assembled, {"assembled"});
  for (const char* key : {"mean_k_gamma", "k_gamma_lower", "k_gamma_upper"}) f.add(key, nullptr);
  if (sharing.series) {
    const auto add = [&](const char* key, const auto& values) {
      for (std::size_t k = 0; k < values.size(); ++k) {
        f.append(key, values[k], {key, "", 0, std::string(train::kMeshNames[k])});
      }
    };
    add("mean_k_gamma", sharing.series->mean);
    add("k_gamma_lower", sharing.series->lower);
    add("k_gamma_upper", sharing.series->upper);
  }
  return f;
}

}  // namespace

std::optional<double> torque_density(const design::Evaluation& e) {
  const auto least = e.strength ? e.strength->least_capacity() : std::nullopt;
  if (!least || !e.total_mass_kg) return std::nullopt;
  return least->capacity.torque_Nm / *e.total_mass_kg;
}

std::optional<double> gears_mass_kg(const design::Evaluation& e) {
  double sum_kg = 0.0;
  for (const std::string_view gear : train::kGearNames) {
    const auto part = std::ranges::find(e.parts, gear, &design::PartMass::name);
    if (part == e.parts.end() || !part->mass_kg) return std::nullopt;
    sum_kg += part->count * *part->mass_kg;
  }
  return sum_kg;
}

std::optional<double> gears_torque_density(const design::Evaluation& e) {
  const auto least = e.strength ? e.strength->least_capacity() : std::nullopt;
  const auto mass_kg = gears_mass_kg(e);
  if (!least || !mass_kg) return std::nullopt;
  return least->capacity.torque_Nm / *mass_kg;
}

Fields strength_fields(const design::Evaluation& e) {
  const StrengthResult& s = e.strength.value();
  const auto meshes = rated_meshes(s);
  Fields f("train");
  f.add("output_torque_nm", s.forward.torque_Nm, {"rated_output_torque", "N m"});
  add_capacity(f, e);
  f.add("not_judged", io::Json(not_judged(e)));
  f.add("locks_forward", s.forward.locked);
  f.add("locks_backward", s.backward.locked);
  f.add("planet_sharing", nullptr);
  if (s.planet_sharing) f.add("planet_sharing", sharing_fields(*s.planet_sharing));
  add_meshes(f, meshes);
  f.add("stiffness", nullptr);
  if (s.forward.stiffness) f.add("stiffness", stiffness_fields(*s.forward.stiffness));
  f.add("planet", nullptr);
  if (s.forward.planet && s.backward.planet) {
    Fields planet;
    planet.add("forward", planet_load_fields(s.forward));
    planet.add("backward", planet_load_fields(s.backward));
    f.add("planet", std::move(planet));
  }
  add_factors(f, meshes);
  return f;
}

Fields strength_fields(const design::PairEvaluation& e) {
  const std::array<RatedMesh, 1> meshes{rated_mesh(e)};
  Fields f("pair");
  f.add("torque_nm", clean(rated_torque(e)), {"rated_torque", "N m"});
  const auto& capacity = e.torque_capacity;
  f.add("capacity_nm", capacity ? std::optional(capacity->torque_Nm) : std::nullopt,
        {"torque_capacity", "N m"});
  f.add("governing", nullptr);
  if (capacity) {
    const auto [mesh, member, mode] = capacity->governing;
    f.add("governing", io::Json{{"gear", meshes[0].gears.at(member)},
                                {"mesh", meshes[0].name},
                                {"mode", strength::kModeNames.at(static_cast<std::size_t>(mode))}});
  }
  f.add("not_judged", io::Json(not_judged(e)));
  add_meshes(f, meshes);
  f.add("stiffness", nullptr);
  if (e.strength->mean_stiffness_Pa) {
    const double mesh_N_m = *e.strength->mean_stiffness_Pa * e.strength->face_width_m;
    Fields stiffness("pair");
    stiffness.add("mesh_n_per_um", units::from_si(mesh_N_m, Unit::kNewtonPerMicrometre),
                  {"mesh_stiffness", "N/um"});
    f.add("stiffness", std::move(stiffness));
  }
  f.add("planet", nullptr);
  add_factors(f, meshes);
  return f;
}

}  // namespace gear3k::report
