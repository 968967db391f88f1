#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <tuple>

#include "report/display.hpp"
#include "report/rated_mesh.hpp"
#include "report/strength_report.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using design::StrengthResult, strength::MeshRating, strength::ToothRating;

using Meshes = std::span<const RatedMesh>;

constexpr std::array<std::size_t, 2> kMembers{0, 1};

std::string stress_text(double Pa) { return fixed(mpa(Pa), 1); }
std::string safety_text(double safety, bool stated) { return stated ? fixed(safety, 3) : "none"; }
std::string torque_text(double Nm) { return fmt::format("{:.4g} N m", Nm); }

std::string stiffness_text(double Nm_rad) {
  constexpr double kWhole = 1e3;
  return Nm_rad < kWhole ? fmt::format("{:.4g} N m/rad", Nm_rad)
                         : fmt::format("{:.0f} N m/rad", Nm_rad);
}

/// A number with its unit, "none" where there is none.
std::string number_or_none(const std::optional<double>& value, int decimals,
                           const char* unit = "") {
  return value ? fixed(*value, decimals) + unit : "none";
}

/// The mesh in the first of its two rows alone.
std::string mesh_cell(const RatedMesh& mesh, std::size_t member) {
  return member == 0 ? mesh.name : "";
}

template <class Holds>
bool any_tooth(Meshes meshes, Holds holds) {
  return std::ranges::any_of(
      meshes, [&](const RatedMesh& m) { return std::ranges::any_of(m.rating->teeth, holds); });
}

const char* mode_name(strength::Mode mode) {
  switch (mode) {
    case strength::Mode::kRoot:
      return "root";
    case strength::Mode::kFlank:
      return "flank";
    case strength::Mode::kOverloadRoot:
      return "root, overload";
    case strength::Mode::kOverloadFlank:
      return "flank, overload";
  }
  return "";
}

/// Forces, stresses and safeties by tooth; of a train both forces and what governs.
std::string safety_table(Meshes meshes, const std::optional<strength::DrivenCapacity>& least) {
  const bool train = meshes.front().drive.has_value();
  const bool overload = any_tooth(meshes, [](const ToothRating<double>& t) {
    return t.overload_root_safety || t.overload_flank_safety;
  });
  std::vector<std::string> header{"mesh", "gear"};
  const auto append = [](std::vector<std::string>& row, std::vector<std::string> cells) {
    row.insert(row.end(), cells.begin(), cells.end());
  };
  append(header, train ? std::vector<std::string>{"F_n forward", "F_n backward"}
                       : std::vector<std::string>{"F_n"});
  append(header, {"sigma_F", "S_F", "sigma_H", "S_H"});
  if (overload) append(header, {"S_F overload", "S_H overload"});
  if (train) header.emplace_back("governs");
  const std::size_t last = header.size() - 1;
  TextTable table(header);
  table.align_left(1);
  if (train) table.align_left(last);
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const RatedMesh& mesh = meshes[k];
    for (const std::size_t i : kMembers) {
      const ToothRating<double>& t = mesh.rating->teeth[i];
      std::vector<std::string> row{mesh_cell(mesh, i), mesh.gears[i]};
      const auto force = [&](double N) { return i == 0 ? fixed(N, 1) : ""; };
      row.push_back(force(mesh.forward_N));
      if (train) row.push_back(force(mesh.backward_N));
      append(row,
             {stress_text(t.root.stress_Pa), safety_text(t.root_safety, t.root_limit_stated),
              stress_text(t.flank_stress_Pa), safety_text(t.flank_safety, t.flank_limit_stated)});
      if (overload) {
        append(row, {number_or_none(t.overload_root_safety, 3),
                     number_or_none(t.overload_flank_safety, 3)});
      }
      if (least && least->capacity.governing.mesh == k && least->capacity.governing.member == i) {
        row.emplace_back(mode_name(least->capacity.governing.mode));
      }
      table.add(row);
    }
  }
  return table.text(2);
}

/// What the shape of a tooth makes of its load, and what its material bears.
std::string tooth_strength_table(Meshes meshes) {
  TextTable table({"mesh", "gear", "Y_F", "Y_S", "s_F", "h_F", "rho_F", "sigma_F0", "sigma_FG",
                   "Z_B, Z_D", "sigma_HG"});
  table.align_left(1);
  for (const RatedMesh& mesh : meshes) {
    for (const std::size_t i : kMembers) {
      const ToothRating<double>& t = mesh.rating->teeth[i];
      const strength::RootForm<double>& form = t.form;
      const strength::FlankStress<double>& flank = mesh.rating->flank;
      table.add({mesh_cell(mesh, i), mesh.gears[i], fixed(form.form_factor, 4),
                 fixed(form.stress_correction_factor, 4) + (form.notch_in_range ? "" : " *"),
                 fixed(mm(form.section.chord_m), 4), fixed(mm(form.bending_arm_m), 4),
                 fixed(mm(form.section.fillet_radius_m), 4), stress_text(t.root.nominal_Pa),
                 t.root_limit_stated ? stress_text(t.root_strength.strength_Pa) : "none",
                 t.plastic
                     ? "none"
                     : fixed(i == 0 ? flank.single_contact1.value : flank.single_contact2.value, 4),
                 t.flank_limit_stated ? stress_text(t.flank_strength.strength_Pa) : "none"});
    }
  }
  const bool outside =
      any_tooth(meshes, [](const ToothRating<double>& t) { return !t.form.notch_in_range; });
  return "\nRoot sections and permissible stresses (mm, N/mm2)\n" + table.text(2) +
         (outside ? "  * notch parameter outside the range of Y_S\n" : "");
}

std::string mesh_load_table(Meshes meshes) {
  TextTable table({"mesh", "b", "speed", "F_t K_A/b", "sigma_H0", "Z_H", "Z_E", "Z_eps", "c'",
                   "c_gamma", "mean stiffness"});
  for (const RatedMesh& mesh : meshes) {
    const MeshRating<double>& r = *mesh.rating;
    const auto stiffness = [](double Pa) {
      return Pa > 0.0 ? fixed(units::from_si(Pa, units::Unit::kMeshStiffness), 2) : "none";
    };
    table.add({mesh.name, fmt::format("{:.5g} mm", mm(r.face_width_m)),
               r.speed_m_s > 0.0 ? fmt::format("{:.4g} m/s", r.speed_m_s) : "not stated",
               fmt::format("{:.1f} N/mm",
                           units::from_si(r.line_load_N_m, units::Unit::kNewtonPerMillimetre)),
               stress_text(r.flank.nominal_Pa), fixed(r.flank.zone_factor, 4),
               fixed(r.flank.elasticity_factor / 1e3, 1), fixed(r.flank.contact_ratio.value, 4),
               stiffness(r.iso.single) + (r.iso_in_range ? "" : " *"), stiffness(r.iso.mesh_alpha),
               stiffness(r.mean_stiffness_Pa.value_or(0.0))});
  }
  const bool outside =
      std::ranges::any_of(meshes, [](const RatedMesh& m) { return !m.rating->iso_in_range; });
  return "\nMeshes under load (N/mm2; stiffness in N/(mm um): c' and c_gamma by ISO, mean over the "
         "path of contact)\n" +
         table.text(2) + (outside ? "  * x1 + x2 outside the range of c'\n" : "");
}

/// Temperature and wear of the teeth of plastic; nothing without any.
std::string plastic_table(Meshes meshes) {
  if (!any_tooth(meshes, [](const ToothRating<double>& t) { return t.plastic; })) return "";
  TextTable table({"mesh", "gear", "root", "flank", "Y_eps", "wear", "deformation"});
  table.align_left(1);
  for (const RatedMesh& mesh : meshes) {
    for (const std::size_t i : kMembers) {
      const ToothRating<double>& t = mesh.rating->teeth[i];
      if (!t.plastic) continue;
      table.add({mesh.name, mesh.gears[i],
                 number_or_none(if_any(t.root_temperature_K, celsius), 1, " C"),
                 number_or_none(if_any(t.flank_temperature_K, celsius), 1, " C"),
                 number_or_none(t.contact_ratio_factor, 4),
                 t.wear_m ? number_or_none(um(*t.wear_m), 2, " um") : "not rated",
                 number_or_none(if_any(mesh.rating->deformation_m, um), 2, " um")});
    }
  }
  return "\nTeeth of plastic (temperature of root and flank)\n" + table.text(2);
}

/// Factors of one symbol that follow from one case of one formula.
struct FactorGroup {
  const PlacedFactor* first;
  double least, greatest;
  std::vector<std::string> subjects;
};

std::string subject_text(const PlacedFactor& placed) {
  return placed.gear.empty() ? placed.mesh : fmt::format("{} in {}", placed.gear, placed.mesh);
}

bool same_case(const PlacedFactor& a, const PlacedFactor& b) {
  const auto of = [](const PlacedFactor& p) {
    return std::tuple(p.named.symbol, p.named.factor->branch, p.named.factor->source,
                      p.named.factor->in_range);
  };
  return of(a) == of(b);
}

std::vector<PlacedFactor> all_factors(Meshes meshes) {
  std::vector<PlacedFactor> all;
  for (const RatedMesh& mesh : meshes) {
    std::ranges::copy(factors_of(mesh), std::back_inserter(all));
  }
  return all;
}

std::vector<FactorGroup> grouped(std::span<const PlacedFactor> factors) {
  std::vector<FactorGroup> groups;
  for (const PlacedFactor& placed : factors) {
    const double value = placed.named.factor->value;
    auto group = std::ranges::find_if(
        groups, [&](const FactorGroup& g) { return same_case(*g.first, placed); });
    if (group == groups.end()) {
      // Beside those of its symbol, which another tooth may have begun.
      const auto other = std::find_if(groups.rbegin(), groups.rend(), [&](const FactorGroup& g) {
                           return g.first->named.symbol == placed.named.symbol;
                         }).base();
      group = groups.insert(other == groups.begin() ? groups.end() : other,
                            {.first = &placed, .least = value, .greatest = value, .subjects = {}});
    }
    group->least = std::min(group->least, value);
    group->greatest = std::max(group->greatest, value);
    group->subjects.push_back(subject_text(placed));
  }
  return groups;
}

std::string listed(std::span<const std::string> items) {
  return fmt::format("{}", fmt::join(items, ", "));
}

/// Factors other than 1 with the case of the formula that gave them and its source.
std::string factor_table(std::span<const PlacedFactor> factors) {
  TextTable table({"factor", "value", "of", "case", "source"});
  for (const std::size_t column : {2U, 3U, 4U}) table.align_left(column);
  std::size_t shown = 0;
  for (const FactorGroup& g : grouped(factors)) {
    const strength::Factor<double>& f = *g.first->named.factor;
    if (g.least == 1.0 && g.greatest == 1.0 && f.in_range) continue;
    ++shown;
    const auto of_symbol = static_cast<std::size_t>(std::ranges::count_if(
        factors, [&](const PlacedFactor& p) { return p.named.symbol == g.first->named.symbol; }));
    const auto number = [](double value) {
      return std::isfinite(value) ? fixed(value, 4) : std::string("none");
    };
    const std::string least = number(g.least), greatest = number(g.greatest);
    const bool whole = g.subjects.size() == of_symbol && of_symbol > 1;
    table.add({std::string(g.first->named.symbol),
               least == greatest ? least : fmt::format("{} to {}", least, greatest),
               whole ? "all" : listed(g.subjects),
               std::string(f.branch) + (f.in_range ? "" : " (out of its range)"),
               std::string(f.source)});
  }
  if (shown == 0) return "";
  return "\nFactors (those other than 1; each by itself in the JSON)\n" + table.text(2);
}

bool is_not_stated(const PlacedFactor& placed) {
  return placed.named.factor->source == strength::sources::kNotStated;
}

/// Those for which a factor is not stated, by gear where that is so in all of its meshes; "" where
/// it is stated for none.
std::string not_stated_for(std::span<const PlacedFactor> factors, std::string_view symbol) {
  std::vector<std::string> subjects;
  bool any_stated = false;
  for (const PlacedFactor& placed : factors) {
    if (placed.named.symbol != symbol) continue;
    if (!is_not_stated(placed)) {
      any_stated = true;
      continue;
    }
    const bool whole_gear =
        !placed.gear.empty() && std::ranges::all_of(factors, [&](const PlacedFactor& p) {
          return p.named.symbol != symbol || p.gear != placed.gear || is_not_stated(p);
        });
    std::string subject = whole_gear ? std::string(placed.gear) : subject_text(placed);
    if (std::ranges::find(subjects, subject) == subjects.end()) {
      subjects.push_back(std::move(subject));
    }
  }
  return any_stated ? " of " + listed(subjects) : "";
}

/// Symbols that are 1 because something is not stated, by what that is; where it is stated for
/// some, with those for which it is not.
std::vector<std::string> not_stated_lines(std::span<const PlacedFactor> factors) {
  struct Reason {
    std::string_view text;
    std::string subjects;
    std::vector<std::string> symbols;
  };
  std::vector<Reason> reasons;
  for (const PlacedFactor& placed : factors) {
    if (!is_not_stated(placed)) continue;
    const std::string_view text = placed.named.factor->branch;
    std::string subjects = not_stated_for(factors, placed.named.symbol);
    auto reason = std::ranges::find_if(
        reasons, [&](const Reason& r) { return r.text == text && r.subjects == subjects; });
    if (reason == reasons.end()) {
      reason = reasons.insert(reason,
                              Reason{.text = text, .subjects = std::move(subjects), .symbols = {}});
    }
    const std::string symbol(placed.named.symbol);
    if (std::ranges::find(reason->symbols, symbol) == reason->symbols.end()) {
      reason->symbols.push_back(symbol);
    }
  }
  std::vector<std::string> lines;
  lines.reserve(reasons.size());
  for (const Reason& reason : reasons) {
    lines.push_back(fmt::format("{}{} ({})", listed(reason.symbols), reason.subjects, reason.text));
  }
  return lines;
}

/// Parts of a train that yield nothing as no stiffness of theirs is stated.
std::string rigid_parts(const strength::TrainStiffness<double>& stiffness) {
  const strength::TrainCompliance<double>& c = stiffness.compliance;
  std::vector<std::string> parts;
  if (c.planet_torsion == 0.0) parts.emplace_back("planet between P1 and P2");
  if (c.bearings == 0.0) parts.emplace_back("planet bearings");
  if (c.sun_shaft == 0.0) parts.emplace_back("shaft of S");
  if (c.ring2 == 0.0) parts.emplace_back("R2 beyond its teeth");
  return listed(parts);
}

std::string capacity_part(const char* direction,
                          const std::optional<strength::Capacity<double>>& capacity) {
  if (!capacity) return fmt::format("{} not judged", direction);
  const auto [mesh, member, mode] = capacity->governing;
  const auto gear = static_cast<std::size_t>(train::kMeshGears.at(mesh).at(member));
  return fmt::format("{} {} ({} of {} in {})", direction, torque_text(capacity->torque_Nm),
                     mode_name(mode), train::kGearNames.at(gear), train::kMeshNames.at(mesh));
}

std::string capacity_text(const StrengthResult& s,
                          const std::optional<strength::DrivenCapacity>& least) {
  if (!s.capacity_forward && !s.capacity_backward) {
    const bool lacks_sharing = s.planet_sharing && !s.planet_sharing->series;
    return lacks_sharing ? "not known: lacks K_gamma" : "not judged";
  }
  return fmt::format("{}: {}, {}", least ? torque_text(least->capacity.torque_Nm) : "not judged",
                     capacity_part("forward", s.capacity_forward),
                     capacity_part("backward", s.capacity_backward));
}

std::string pair_capacity_text(const design::PairEvaluation& e, const RatedMesh& mesh) {
  if (!e.torque_capacity) return "not judged";
  const auto [k, member, mode] = e.torque_capacity->governing;
  return fmt::format("{} on gear {} ({} of {})", torque_text(e.torque_capacity->torque_Nm),
                     mesh.gears.at(0), mode_name(mode), mesh.gears.at(member));
}

std::string density_text(const design::Evaluation& e,
                         const std::optional<strength::DrivenCapacity>& least) {
  if (const auto density = torque_density(e)) {
    return fmt::format("{:.4g} N m/kg, of {:.5g} kg", *density, *e.total_mass_kg);
  }
  if (!least) return "not judged";
  std::string text = "not known: lacks the mass of a part";
  if (const auto of_gears = gears_torque_density(e)) {
    text += fmt::format("; of the gears alone {:.4g} N m/kg, of {:.5g} kg", *of_gears,
                        gears_mass_kg(e).value());
  }
  return text;
}

std::string bearing_text(const strength::TrainRating<double>& rating) {
  const strength::PlanetLoads<double>& p = rating.planet.value();
  return fmt::format(
      "A {:.1f} N, B {:.1f} N (tilting couple {:.4g} N m, pin bending moment {:.4g} N m{})",
      p.bearing_load_N[0], p.bearing_load_N[1], p.tilting_couple_Nm, p.bending_moment_Nm,
      rating.pin_stress_Pa ? fmt::format(", {:.1f} N/mm2", mpa(*rating.pin_stress_Pa)) : "");
}

/// Lines under one label, which stands at the first.
void add_lines(TextTable& table, const std::string& label, std::span<const std::string> lines) {
  for (std::size_t k = 0; k < lines.size(); ++k) table.add({k == 0 ? label : "", lines[k]});
}

std::string train_lines(const design::Evaluation& e,
                        const std::optional<strength::DrivenCapacity>& least,
                        std::span<const PlacedFactor> factors) {
  const StrengthResult& s = e.strength.value();
  TextTable table({"capacity", capacity_text(s, least)});
  table.align_left(1);
  table.add({"torque density", density_text(e, least)});
  if (s.forward.stiffness) {
    table.add(
        {"torsional stiffness",
         fmt::format("{} at the output (sun locked), {} at the sun (R2 locked), at {:.5g} N m",
                     stiffness_text(s.forward.stiffness->output_Nm_rad),
                     stiffness_text(s.forward.stiffness->input_Nm_rad), s.forward.torque_Nm)});
  }
  if (s.forward.planet && s.backward.planet) {
    table.add({"planet bearings, forward", bearing_text(s.forward)});
    table.add({"planet bearings, backward", bearing_text(s.backward)});
    table.add({"", "of the nominal torque: K_A and K_gamma do not act on bearings and pin"});
  } else {
    table.add({"planet bearings", "not known: lacks their positions"});
  }
  if (s.planet_sharing && s.planet_sharing->series) {
    const design::PlanetSharing& sharing = *s.planet_sharing;
    std::vector<std::string> of_mesh;
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      of_mesh.push_back(fmt::format("{} {:.3f} (mean {:.3f})", train::kMeshNames[k],
                                    s.forward.mesh[k].factors.mesh_load.value,
                                    sharing.series->mean[k]));
    }
    table.add({"K_gamma of tolerances",
               fmt::format("{}; of {:g} % of {} gearboxes that assemble, {} drawn",
                           fmt::join(of_mesh, ", "), percent(sharing.quantile), sharing.assembled,
                           sharing.drawn)});
  }
  for (const auto* rating : {&s.forward, &s.backward}) {
    if (!rating->locked) continue;
    table.add(
        {fmt::format("driven {}", strength::kDriveNames[static_cast<std::size_t>(rating->drive)]),
         "locks; forces without losses, of a load that is held"});
  }
  add_lines(table, "not stated, taken as 1", not_stated_lines(factors));
  const std::string rigid = s.forward.stiffness ? rigid_parts(*s.forward.stiffness) : "";
  if (!rigid.empty()) table.add({"not stated, taken as rigid", rigid});
  return table.text(2);
}

/// By what is missing the gears, each once, in the order of the meshes.
std::vector<std::string> not_judged_of(Meshes meshes) {
  constexpr std::array<const char*, 3> kWhat{"root", "flank", "root and flank"};
  std::array<std::vector<std::string>, kWhat.size()> gears;
  std::vector<std::string> seen;
  for (const RatedMesh& mesh : meshes) {
    for (const std::size_t i : kMembers) {
      const ToothRating<double>& t = mesh.rating->teeth[i];
      if (t.root_limit_stated && t.flank_limit_stated) continue;
      if (std::ranges::find(seen, mesh.gears[i]) != seen.end()) continue;
      seen.push_back(mesh.gears[i]);
      const std::size_t what = t.root_limit_stated ? 1 : t.flank_limit_stated ? 0 : 2;
      gears.at(what).push_back(mesh.gears[i]);
    }
  }
  std::vector<std::string> lines;
  for (std::size_t what = 0; what < kWhat.size(); ++what) {
    if (gears.at(what).empty()) continue;
    lines.push_back(fmt::format("{} of {}", kWhat.at(what), listed(gears.at(what))));
  }
  return lines;
}

}  // namespace

std::string capacity_summary(const design::Evaluation& e) {
  const StrengthResult& s = e.strength.value();
  const auto least = strength::least_capacity(s.capacity_forward, s.capacity_backward);
  if (!least) return capacity_text(s, least);
  const auto [mesh, member, mode] = least->capacity.governing;
  const auto gear = static_cast<std::size_t>(train::kMeshGears.at(mesh).at(member));
  return fmt::format("carries {} at R2 ({} of {} in {}), {} asked for",
                     torque_text(least->capacity.torque_Nm), mode_name(mode),
                     train::kGearNames.at(gear), train::kMeshNames.at(mesh),
                     torque_text(s.forward.torque_Nm));
}

std::string capacity_summary(const design::PairEvaluation& e) {
  const RatedMesh mesh = rated_mesh(e);
  return fmt::format("carries {}, {} asked for", pair_capacity_text(e, mesh),
                     torque_text(rated_torque(e)));
}

std::vector<std::string> not_judged(const design::Evaluation& e) {
  if (!e.strength) return {};
  return not_judged_of(rated_meshes(*e.strength));
}
std::vector<std::string> not_judged(const design::PairEvaluation& e) {
  if (!e.strength) return {};
  return not_judged_of(std::array{rated_mesh(e)});
}

std::string strength_table(const design::Evaluation& e) {
  if (!e.strength) return "";
  const auto meshes = rated_meshes(*e.strength);
  const auto least = e.strength->least_capacity();
  const std::vector<PlacedFactor> factors = all_factors(meshes);
  return fmt::format(
             "\nStrength at {:.5g} N m at R2 (N, N/mm2; each mesh in the drive direction in which "
             "its force is greater)\n",
             e.strength->forward.torque_Nm) +
         safety_table(meshes, least) + train_lines(e, least, factors) +
         tooth_strength_table(meshes) + mesh_load_table(meshes) + plastic_table(meshes) +
         factor_table(factors);
}

std::string strength_table(const design::PairEvaluation& e) {
  if (!e.strength) return "";
  const std::array<RatedMesh, 1> meshes{rated_mesh(e)};
  const std::vector<PlacedFactor> factors = all_factors(meshes);
  std::string text = fmt::format("\nStrength at {:.5g} N m on gear {} (N, N/mm2)\n",
                                 clean(rated_torque(e)), meshes[0].gears[0]) +
                     safety_table(meshes, {});
  TextTable table({"capacity", pair_capacity_text(e, meshes[0])});
  table.align_left(1);
  add_lines(table, "not stated, taken as 1", not_stated_lines(factors));
  text += table.text(2);
  return text + tooth_strength_table(meshes) + mesh_load_table(meshes) + plastic_table(meshes) +
         factor_table(factors);
}

}  // namespace gear3k::report
