#include "design/evaluation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "backlash/normal_backlash.hpp"
#include "design/measured_lost_motion.hpp"
#include "efficiency/train_efficiency.hpp"

namespace gear3k::design {

namespace {

using geometry::GearGeometry;

NotDefined no_working_angle(std::string_view mesh, double center_distance_m, double base_sum_m) {
  if (!(base_sum_m > 0.0)) {
    return {fmt::format("mesh {}: the ring needs more teeth than the planet", mesh)};
  }
  return {fmt::format(
      "mesh {}: center distance = {:.6g} mm leaves no working pressure angle, allowed: above "
      "{:.6g} mm (base radii)",
      mesh, center_distance_m * 1e3, base_sum_m * 1e3)};
}

ToothResult tooth_result(const GearGeometry<double>& g, const geometry::ToothForm<double>& form,
                         std::optional<double> pin_diameter_m) {
  return {.tool = form.fillet.tool,
          .form_diameter_m = 2.0 * form.form_radius_m,
          .undercut = form.undercut,
          .fillet_radius_m = form.fillet.rounding_radius_m,
          .full_round = form.full_round,
          .form_thickness_m = geometry::form_circle_thickness(g, form),
          .root_space_m = geometry::root_space_width(g),
          .span = geometry::span_measure(g),
          .pins = geometry::pin_measure(g, pin_diameter_m),
          .chordal = geometry::chordal_thickness(g),
          .infeed = geometry::infeed(g),
          .cutter_teeth = g.gear.kind == geometry::GearKind::kRing ? g.gear.cutter.teeth : 0,
          .cutter_tip_diameter_m = 2.0 * form.cutter_tip_radius_m,
          .cutter_center_distance_m = form.cutter_center_distance_m};
}

GearResult gear_result(std::string_view name, const GearGeometry<double>& g,
                       const geometry::ToothForm<double>& form,
                       std::optional<double> pin_diameter_m) {
  return {.name = std::string(name),
          .teeth = g.gear.teeth,
          .profile_shift = g.gear.profile_shift,
          .tip_shortening = g.gear.tip_shortening,
          .pitch_diameter_m = 2.0 * g.reference_radius_m,
          .base_diameter_m = 2.0 * g.base_radius_m,
          .tip_diameter_m = 2.0 * g.tip_radius_m,
          .root_diameter_m = 2.0 * g.root_radius_m,
          .tip_thickness_m = geometry::tooth_thickness(g, g.tip_radius_m),
          .tooth = tooth_result(g, form, pin_diameter_m)};
}

template <std::size_t N>
std::array<geometry::ToothForm<double>, N> tooth_forms(
    const std::array<GearGeometry<double>, N>& gears) {
  std::array<geometry::ToothForm<double>, N> forms;
  std::ranges::transform(gears, forms.begin(), geometry::make_tooth_form<double>);
  return forms;
}

struct Pairing {
  std::string_view name;
  const GearGeometry<double>& gear1;
  const GearGeometry<double>& gear2;
  const geometry::MeshGeometry<double>& mesh;
  bool gear1_drives;  ///< forward
};

/// Coefficients of friction of a mesh when the train is driven forward and backward.
struct MeshFriction {
  double forward, backward;
};

MeshResult mesh_result(const Pairing& p, const Friction& friction, const MeshFriction& mu) {
  const auto forward = efficiency::contact_of(p.gear1, p.gear2, p.mesh, p.gear1_drives);
  const auto backward = efficiency::contact_of(p.gear1, p.gear2, p.mesh, !p.gear1_drives);
  const double approach = forward.approach_contact_ratio;
  const double recess = forward.recess_contact_ratio;
  const auto efficiency = [&](const efficiency::MeshContact<double>& contact, double coefficient) {
    return efficiency::mesh_efficiency(contact, efficiency::flank_friction(friction, coefficient),
                                       friction.model);
  };
  MeshResult result{
      .name = std::string(p.name),
      .working_pressure_angle_rad = p.mesh.alpha_w_rad,
      .zero_backlash_center_distance_m = geometry::zero_backlash_center_distance(p.gear1, p.gear2),
      .contact_ratio = p.mesh.contact_ratio,
      .approach_contact_ratio = approach,
      .recess_contact_ratio = recess,
      .normal_backlash_m = backlash::normal_backlash(p.gear1, p.gear2, p.mesh),
      .friction_forward = mu.forward,
      .friction_backward = mu.backward,
      .efficiency_forward = efficiency(forward, mu.forward),
      .efficiency_backward = efficiency(backward, mu.backward),
      .loss_model_in_range = efficiency::loss_model_in_range(friction.model, approach, recess),
      .hunting_period_teeth = train::hunting_period_teeth(p.gear1.gear.teeth, p.gear2.gear.teeth),
      .common_factor = std::gcd(p.gear1.gear.teeth, p.gear2.gear.teeth),
      .active_root_diameter_m = {},
      .root_clearance_m = {},
      .tip_sliding = {},
      .planet_phase = {}};
  for (const int which : {1, 2}) {
    const auto i = static_cast<std::size_t>(which - 1);
    const double length = geometry::active_root_length(p.gear1, p.gear2, p.mesh, which);
    const double base = (which == 1 ? p.gear1 : p.gear2).base_radius_m;
    if (length >= 0.0) result.active_root_diameter_m[i] = 2.0 * std::hypot(base, length);
    result.root_clearance_m[i] =
        geometry::root_clearance(p.gear1, p.gear2, p.mesh, which) * p.gear1.gear.module_m;
    result.tip_sliding[i] = geometry::tip_sliding(p.gear1, p.gear2, p.mesh, which);
  }
  return result;
}

struct CheckNames {
  std::span<const std::string_view> gears, meshes;
};

std::vector<CheckResult> run_checks(const std::vector<CheckInstance>& checks,
                                    const Gearing<double>& gearing, const CheckNames& names) {
  std::vector<CheckResult> results;
  for (const CheckInstance& check : checks) {
    const double value = check_value(check, gearing);
    const double margin = check_margin(check, gearing);
    SubjectNames subject = subject_names(check, names.gears, names.meshes, gearing.mesh_gears);
    results.push_back({.record = check.record,
                       .mesh = std::move(subject.mesh),
                       .gear = std::move(subject.gear),
                       .value = value,
                       .limit = check.limit,
                       .margin = margin,
                       .ok = margin >= -kFeasibilityTolerance * check.scale});
  }
  return results;
}

/// What the tolerances make of a gearing and its checks; says so where they leave no mesh.
template <class Stated>
std::optional<ToleranceLimits> limits_within(const std::optional<Stated>& tolerances,
                                             const DrawnGearing& drawn,
                                             const std::vector<CheckInstance>& checks,
                                             std::vector<std::string>& notes) {
  if (!tolerances) return std::nullopt;
  auto limits = tolerance_limits(drawn, tolerances->gears, tolerances->center_distance_m, checks);
  if (!limits) {
    notes.emplace_back(
        "the tolerances have no minimum and maximum: at an end of tolerances.center_distance_um a "
        "mesh has no working pressure angle");
  }
  return limits;
}

void note_loss_model(const std::vector<MeshResult>& meshes, std::vector<std::string>& notes) {
  for (const MeshResult& mesh : meshes) {
    if (mesh.contact_ratio <= 0.0) {
      notes.push_back(
          fmt::format("mesh {} has no contact (contact ratio {:.3f}): the train's "
                      "efficiency is undefined",
                      mesh.name, mesh.contact_ratio));
      continue;
    }
    if (mesh.contact_ratio < 1.0) {
      notes.push_back(fmt::format(
          "mesh {} has a contact ratio of {:.3f}: it does not run continuously, and its efficiency "
          "is that of the part of the pitch with a pair in contact",
          mesh.name, mesh.contact_ratio));
    }
    if (!(mesh.efficiency_forward > 0.0 && mesh.efficiency_backward > 0.0)) {
      notes.push_back(fmt::format(
          "mesh {} has no positive efficiency with this friction: those of the train are undefined",
          mesh.name));
    }
    if (mesh.loss_model_in_range) continue;
    notes.push_back(fmt::format(
        "loss model ohlendorf is outside its range at mesh {}: approach {:.3f}, recess {:.3f}, "
        "valid for 0 to 1 each with a sum of at least 1; it overestimates the loss there "
        "(loss_model = \"sliding\" does not)",
        mesh.name, mesh.approach_contact_ratio, mesh.recess_contact_ratio));
  }
}

/// Says which bodies have no place along the axis, as their gaps are then not checked.
void note_axial_overlap(const Design& design, std::vector<std::string>& notes) {
  if (!design.limits[CheckId::kBodyGap]) return;
  std::vector<std::string_view> unknown;
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    if (!design.axial.extent[i]) unknown.push_back(train::kBodyNames[i]);
  }
  if (unknown.size() == train::kBodyCount) {
    notes.emplace_back("axial overlap is not checked: the design has no [axial] table");
  } else if (!unknown.empty()) {
    notes.push_back(fmt::format("axial overlap is not checked for {}: not in [axial]",
                                fmt::join(unknown, ", ")));
  }
}

/// The gearbox at its operating point; empty without one.
std::optional<OperatingResult> operation_result(const LossyTrain<double>& train,
                                                const Design& design) {
  if (!design.operating_point) return std::nullopt;
  const OperatingPoint<double>& point = *design.operating_point;
  return OperatingResult{.point = point,
                         .forward = operate(train, point, Direction::kForward),
                         .backward = operate(train, point, Direction::kBackward)};
}

/// Friction of each mesh: that of the law at the operating point, where it depends on it.  NaN, and
/// with it no efficiency, without a point or where the gearbox does not run there.
std::array<MeshFriction, train::kMeshCount> mesh_frictions(
    const LossyTrain<double>& train, const std::optional<OperatingResult>& operation) {
  std::array<MeshFriction, train::kMeshCount> mu{};
  if (!efficiency::depends_on_state(train.friction)) {
    const auto constant_mu = [&](bool forward) {
      return train.friction.coefficient * constant_factor(train.friction.extension, forward);
    };
    mu.fill({.forward = constant_mu(true), .backward = constant_mu(false)});
    return mu;
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  mu.fill({.forward = kNone, .backward = kNone});
  const auto at = [&](const OperationResult<double>& result, std::size_t k) {
    return result.operation ? result.operation->mesh[k].friction : kNone;
  };
  for (std::size_t k = 0; operation && k < mu.size(); ++k) {
    mu[k] = {.forward = at(operation->forward, k), .backward = at(operation->backward, k)};
  }
  return mu;
}

void note_operation(const std::optional<OperatingResult>& operation,
                    std::vector<std::string>& notes) {
  if (!operation) return;
  const auto note = [&](const OperationResult<double>& result, std::string_view direction) {
    if (result.operation) return;
    notes.push_back(fmt::format("at the operating point, driven {}: {}", direction,
                                no_operation_text(result.reason)));
  };
  note(operation->forward, "forward");
  note(operation->backward, "backward");
  const auto& backward = operation->backward.operation;
  if (backward && backward->sun_torque_Nm < 0.0) {
    notes.emplace_back(
        "at the operating point R2 alone does not turn the gearbox: drags and friction take more "
        "than it transmits, the sun must help");
  }
}

/// Says what the inertias leave out or count twice.
void note_masses(const MassModel& masses, std::vector<std::string>& notes) {
  if (masses.bodies && !masses.counts_carrier) {
    notes.emplace_back(
        "inertia counts no carrier: state inertia.carrier_kgm2, or its carrier_outer_diameter_mm "
        "and carrier_thickness_mm");
  }
  if (masses.pins_in_solid_planets) {
    notes.emplace_back(
        "masses count the pins' place in the planets twice: state gears.P1.bore_mm and "
        "gears.P2.bore_mm");
  }
}

bool all_positive(const efficiency::MeshEfficiencies<double>& eta) {
  return std::ranges::all_of(eta, [](double e) { return e > 0.0; });
}

EfficiencyResult efficiency_result(const train::ToothSet& teeth,
                                   const inertia::DirectionalEfficiencies<double>& eta,
                                   bool in_contact) {
  EfficiencyResult result{
      .forward = {},
      .backward = {},
      .backdrivable = false,
      .backdriving_margin = efficiency::backdriving_margin(teeth, eta.backward)};
  if (!in_contact) return result;
  if (all_positive(eta.forward)) {
    result.forward = efficiency::forward_efficiency(teeth, eta.forward);
  }
  if (all_positive(eta.backward)) {
    result.backward = efficiency::backward_efficiency(teeth, eta.backward);
    result.backdrivable = result.backdriving_margin > 0.0;
  }
  return result;
}

/// Lost motion with a calibrated model; empty without one.
std::optional<double> measured_result(const Design& design,
                                      const train::TrainParameters<double>& parameters,
                                      const train::TrainGeometry<double>& geometry) {
  if (!changes_lost_motion(design.lost_motion)) return std::nullopt;
  const OperatingPoint<double> point = design.operating_point.value_or(OperatingPoint<double>{});
  return measured_lost_motion<double>(
      parameters, geometry, design.lost_motion,
      {.torque_Nm = point.output_torque_Nm, .temperature_K = point.temperature_K});
}

InertiaResult inertia_result(const inertia::InertialTrain<double>& train,
                             const inertia::DirectionalEfficiencies<double>& eta) {
  InertiaResult result{.lossless_kgm2 = inertia::lossless_inertia(train),
                       .backward_kgm2 = std::nullopt,
                       .forward_kgm2 = std::nullopt,
                       .paper_kgm2 = std::nullopt};
  if (!all_positive(eta.forward) || !all_positive(eta.backward)) return result;
  result.backward_kgm2 = inertia::effective_inertia(train, eta, false);
  result.forward_kgm2 = inertia::effective_inertia(train, eta, true);
  result.paper_kgm2 = inertia::paper_inertia(train, eta.backward);
  return result;
}

/// The centre distance as given, or the zero-backlash distance of mesh P1-R1 where it exists.
std::optional<double> resolved_center_distance(
    const Design& design, const std::array<GearGeometry<double>, train::kGearCount>& gears) {
  if (design.center_distance_given) return design.train.center_distance_m;
  return geometry::zero_backlash_center_distance(gears[train::kP1], gears[train::kR1]);
}

/// The gears of a pair; by the KHK rule where asked for and the distance is known.
std::array<GearGeometry<double>, 2> gears_of(const PairDesign& design,
                                             std::optional<double> center_distance_m) {
  const auto angle = geometry::make_pressure_angle(design.pressure_angle_rad);
  std::array<geometry::Gear<double>, 2> gears{design.gear1, design.gear2};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!design.khk_tip[i] || !center_distance_m) continue;
    gears[i].tip_shortening = geometry::khk_tip_shortening<double>(
        {.teeth_sum = design.gear1.teeth + design.gear2.teeth,
         .module_m = design.gear1.module_m,
         .shift_sum = design.gear1.profile_shift + design.gear2.profile_shift,
         .center_distance_m = *center_distance_m});
  }
  return {geometry::make_gear_geometry(gears[0], angle),
          geometry::make_gear_geometry(gears[1], angle)};
}

std::optional<double> resolved_center_distance(const PairDesign& design,
                                               const std::array<GearGeometry<double>, 2>& gears) {
  return design.center_distance_m ? design.center_distance_m
                                  : geometry::zero_backlash_center_distance(gears[0], gears[1]);
}

constexpr std::array<std::string_view, 1> kPairMesh{"1-2"};

}  // namespace

std::optional<NotDefined> why_undefined(const Design& design) {
  const auto gears = train::make_train_gears(design.train);
  const auto distance = resolved_center_distance(design, gears);
  if (!distance) {
    return NotDefined{
        "mesh P1-R1 has no zero-backlash centre distance for these profile shifts: state "
        "center_distance_mm"};
  }
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    const double sum = geometry::base_radius_sum(gears[static_cast<std::size_t>(first)],
                                                 gears[static_cast<std::size_t>(second)]);
    if (!(sum > 0.0 && *distance > sum)) {
      return no_working_angle(train::kMeshNames[k], *distance, sum);
    }
  }
  return std::nullopt;
}

train::TrainParameters<double> resolved_parameters(const Design& design) {
  train::TrainParameters<double> parameters = design.train;
  parameters.center_distance_m =
      *resolved_center_distance(design, train::make_train_gears(parameters));
  return parameters;
}

LossyTrain<double> lossy_train(const Design& design, const train::TrainGeometry<double>& geometry) {
  return {.geometry = geometry,
          .friction = design.friction,
          .shafts = design.shafts,
          .face_width_m = {design.masses.face_width_m[0].value_or(0.0),
                           design.masses.face_width_m[1].value_or(0.0)}};
}

std::variant<Evaluation, NotDefined> evaluate(const Design& design) {
  if (auto undefined = why_undefined(design)) return *std::move(undefined);
  const train::TrainParameters<double> parameters = resolved_parameters(design);
  const auto train = train::make_train_geometry(parameters);
  const auto& gears = train->gears;
  const auto forms = tooth_forms(gears);
  const auto j_bn = backlash::normal_backlashes(*train);

  Evaluation e{};
  e.name = design.name;
  e.teeth = parameters.teeth;
  e.planets = parameters.planets;
  e.ratio = train::ratio(e.teeth);
  e.g1 = train::g1(e.teeth);
  e.g2 = train::g2(e.teeth);
  e.center_distance_m = parameters.center_distance_m;
  e.center_distance_given = design.center_distance_given;
  e.module_m = parameters.module_m;
  const bool g2_below_one = e.g2 < 1.0;
  const LossyTrain<double> lossy = lossy_train(design, *train);
  e.operation = operation_result(lossy, design);
  const auto mu = mesh_frictions(lossy, e.operation);
  note_operation(e.operation, e.notes);
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    e.meshes.push_back(mesh_result(
        {.name = train::kMeshNames[k],
         .gear1 = gears[static_cast<std::size_t>(first)],
         .gear2 = gears[static_cast<std::size_t>(second)],
         .mesh = train->meshes[k],
         .gear1_drives = train::gear1_drives(static_cast<train::MeshId>(k), g2_below_one, true)},
        design.friction, mu[k]));
  }
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    e.gears.push_back(
        gear_result(train::kGearNames[i], gears[i], forms[i], design.pin_diameter_m[i]));
  }

  inertia::DirectionalEfficiencies<double> eta{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    eta.forward[k] = e.meshes[k].efficiency_forward;
    eta.backward[k] = e.meshes[k].efficiency_backward;
  }
  const bool in_contact = std::ranges::all_of(
      e.meshes, [](const MeshResult& mesh) { return mesh.contact_ratio > 0.0; });
  e.efficiency = efficiency_result(e.teeth, eta, in_contact);

  using backlash::LostMotionModel;
  const double kinematic = backlash::output_lost_motion(*train, j_bn, LostMotionModel::kKinematic);
  e.lost_motion = {.paper_rad = backlash::output_lost_motion(*train, j_bn, LostMotionModel::kPaper),
                   .kinematic_rad = kinematic,
                   .input_kinematic_rad = kinematic * std::abs(e.ratio),
                   .kinematic_share_rad = backlash::kinematic_lost_motion(*train, j_bn),
                   .measured_rad = measured_result(design, parameters, *train)};

  MassModel masses = mass_model(design.masses, *train);
  e.parts = std::move(masses.parts);
  e.total_mass_kg = masses.total_mass_kg;
  e.total_mass_missing = std::move(masses.total_mass_missing);
  if (!masses.bodies) {
    e.inertia_missing = std::move(masses.bodies_missing);
  } else {
    e.inertia = inertia_result({.teeth = e.teeth,
                                .planets = e.planets,
                                .center_distance_m = e.center_distance_m,
                                .bodies = *masses.bodies},
                               eta);
  }
  note_masses(masses, e.notes);
  e.assembly = train::assembly(e.teeth, e.planets);
  for (std::size_t k = 0; e.assembly.equal_spacing && k < train::kMeshCount; ++k) {
    e.meshes[k].planet_phase =
        train::mesh_phases(e.teeth, static_cast<train::MeshId>(k), e.planets);
  }
  Gearing<double> gearing = gearing_of(*train, j_bn, design.limits.model);
  gearing.forms = forms;
  gearing.axial = &design.axial;
  const auto checks = list_checks(design.limits, train_layout({.planets = e.planets,
                                                               .stage1_module_m = e.module_m[0],
                                                               .cutter = parameters.cutter,
                                                               .axial = design.axial}));
  e.checks = run_checks(checks, gearing, {.gears = train::kGearNames, .meshes = train::kMeshNames});
  e.tolerance_limits = limits_within(design.tolerances,
                                     {.gears = gears,
                                      .forms = forms,
                                      .mesh_gears = train::kMeshGears,
                                      .gear_names = train::kGearNames,
                                      .mesh_names = train::kMeshNames,
                                      .center_distance_m = e.center_distance_m,
                                      .train = &*train,
                                      .axial = &design.axial,
                                      .model = design.limits.model},
                                     checks, e.notes);
  note_loss_model(e.meshes, e.notes);
  note_axial_overlap(design, e.notes);
  if (!design.center_distance_given) {
    e.notes.emplace_back(
        "no center_distance_mm given: the zero-backlash distance of mesh P1-R1 is used");
  }
  return e;
}

std::optional<NotDefined> why_undefined(const PairDesign& design) {
  const auto gears = gears_of(design, std::nullopt);
  const double sum = geometry::base_radius_sum(gears[0], gears[1]);
  const auto distance = resolved_center_distance(design, gears);
  if (sum > 0.0 && !distance) {
    return NotDefined{
        "the pair has no zero-backlash centre distance for these profile shifts: state "
        "center_distance_mm"};
  }
  if (!(sum > 0.0 && *distance > sum)) {
    return no_working_angle(kPairMesh[0], distance.value_or(0.0), sum);
  }
  return std::nullopt;
}

std::variant<PairEvaluation, NotDefined> evaluate(const PairDesign& design) {
  static constexpr std::array<std::string_view, 2> kGears{"1", "2"};
  static constexpr std::array<std::array<int, 2>, 1> kPair{{{0, 1}}};
  if (auto undefined = why_undefined(design)) return *std::move(undefined);
  const auto distance = resolved_center_distance(design, gears_of(design, std::nullopt));
  const auto gears = gears_of(design, distance);
  const auto forms = tooth_forms(gears);
  const auto mesh = geometry::make_mesh_geometry(gears[0], gears[1], *distance);

  PairEvaluation e{};
  e.name = design.name;
  e.center_distance_m = *distance;
  e.center_distance_given = design.center_distance_m.has_value();
  e.mesh = mesh_result(
      {.name = kPairMesh[0],
       .gear1 = gears[0],
       .gear2 = gears[1],
       .mesh = *mesh,
       .gear1_drives = true},
      design.friction,
      {.forward = design.friction.coefficient, .backward = design.friction.coefficient});
  for (std::size_t i = 0; i < 2; ++i) {
    e.gears.push_back(gear_result(kGears[i], gears[i], forms[i], design.pin_diameter_m[i]));
  }
  const std::array<double, 1> j_bn{e.mesh.normal_backlash_m};
  const std::array<geometry::MeshGeometry<double>, 1> meshes{*mesh};
  const std::array<geometry::GearKind, 2> kinds{gears[0].gear.kind, gears[1].gear.kind};
  const std::vector<bool> shaped{e.gears[0].tooth.cutter_teeth > 0,
                                 e.gears[1].tooth.cutter_teeth > 0};
  const Gearing<double> gearing{.gears = gears,
                                .meshes = meshes,
                                .mesh_gears = kPair,
                                .normal_backlash_m = j_bn,
                                .forms = forms,
                                .train = nullptr,
                                .axial = nullptr,
                                .model = design.limits.model};
  const auto checks = list_checks(design.limits, {.gear_kinds = kinds,
                                                  .mesh_gears = kPair,
                                                  .shaped = shaped,
                                                  .passing_bodies = {},
                                                  .planets = 0,
                                                  .length_scale_m = design.gear1.module_m});
  e.checks = run_checks(checks, gearing, {.gears = kGears, .meshes = kPairMesh});
  e.tolerance_limits = limits_within(design.tolerances,
                                     {.gears = gears,
                                      .forms = forms,
                                      .mesh_gears = kPair,
                                      .gear_names = kGears,
                                      .mesh_names = kPairMesh,
                                      .center_distance_m = e.center_distance_m,
                                      .train = nullptr,
                                      .axial = nullptr,
                                      .model = design.limits.model},
                                     checks, e.notes);
  note_loss_model({e.mesh}, e.notes);
  if (!e.center_distance_given) {
    e.notes.emplace_back("no center_distance_mm given: the zero-backlash distance is used");
  }
  return e;
}

bool all_ok(const std::vector<CheckResult>& checks) {
  return std::ranges::all_of(checks, [](const CheckResult& c) { return c.ok; });
}

}  // namespace gear3k::design
