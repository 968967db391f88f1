#include <fmt/format.h>

#include <numbers>

#include "io/files/design_file.hpp"
#include "io/keys/limit_keys.hpp"
#include "io/keys/loss_keys.hpp"
#include "io/keys/mass_keys.hpp"
#include "io/keys/tolerance_keys.hpp"
#include "io/text/toml_text.hpp"
#include "units/units.hpp"

namespace gear3k::io {

namespace {

std::string limits_text(const design::Limits& limits) {
  using design::CheckId;
  const auto in_unit = [&](CheckId id) {
    return toml_number(design::in_unit(*limits[id], design::check_record(id).unit));
  };
  std::string text = "\n[backlash]\n";
  text += fmt::format("model = \"{}\"\n",
                      limits.model == backlash::LostMotionModel::kPaper ? "paper" : "kinematic");
  if (limits[CheckId::kNormalBacklash]) {
    text += fmt::format("min_normal_um = {}\n", in_unit(CheckId::kNormalBacklash));
  }
  if (limits[CheckId::kOutputBacklashMin]) {
    text += fmt::format("min_output_arcmin = {}\n", in_unit(CheckId::kOutputBacklashMin));
  }
  if (limits[CheckId::kOutputBacklashMax]) {
    text += fmt::format("max_output_arcmin = {}\n", in_unit(CheckId::kOutputBacklashMax));
  }
  // A range has two ends; the one that is off is switched off below.
  const auto& least = limits[CheckId::kContactRatioMin];
  const auto& most = limits[CheckId::kContactRatioMax];
  const bool has_range = least || most;
  if (has_range) {
    text += fmt::format("\n[contact_ratio]\nrange = [{}, {}]\n", toml_number(least.value_or(0.0)),
                        toml_number(most.value_or(kGreatestContactRatio)));
  }
  if (limits[CheckId::kRingRootDiameter]) {
    text += fmt::format("\n[size]\nmax_ring_root_diameter_mm = {}\n",
                        in_unit(CheckId::kRingRootDiameter));
  }
  text += "\n[limits]\n";
  for (const design::CheckRecord& r : design::check_records()) {
    if (r.id == CheckId::kIdenticalPlanets) continue;
    if (r.limit_key.empty() && r.threshold) {
      text += fmt::format("{} = {}\n", r.name, limits[r.id] ? in_unit(r.id) : "false");
    } else if (!limits[r.id] &&
               (r.default_limit || (has_range && r.id == CheckId::kContactRatioMax))) {
      text += fmt::format("{} = false\n", r.name);
    }
  }
  return text;
}

std::string axial_text(const train::AxialLayout& layout) {
  std::string text;
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    const auto& extent = layout.extent[i];
    if (!extent) continue;
    text += fmt::format("{}_mm = [{}, {}]\n", train::kBodyNames[i],
                        toml_number(extent->from_m / units::kMillimetre),
                        toml_number(extent->to_m / units::kMillimetre));
  }
  if (layout.carrier_radius_m > 0.0) {
    text += fmt::format("carrier_diameter_mm = {}\n",
                        toml_number(2.0 * layout.carrier_radius_m / units::kMillimetre));
  }
  return text.empty() ? "" : "\n[axial]\n" + text;
}

std::string inertia_text(const design::Masses& masses) {
  std::string text;
  if (masses.density_kgm3) {
    text += fmt::format("density_kg_m3 = {}\n", toml_number(*masses.density_kgm3));
  }
  for (const Body& body : kBodies) {
    if (masses.*body.member) {
      text += fmt::format("{} = {}\n", body.name, toml_number(*(masses.*body.member)));
    }
  }
  for (const CarrierSize& size : kCarrierSizes) {
    if (masses.*size.member) {
      text +=
          fmt::format("{} = {}\n", size.name, toml_number(*(masses.*size.member) / size.per_unit));
    }
  }
  return text.empty() ? "" : "\n[inertia]\n" + text;
}

}  // namespace

std::string design_text(const design::Design& design) {
  const auto& t = design.train;
  std::string text =
      fmt::format("name = {}\nplanets = {}\nidentical_planets = {}\n", toml_quoted(design.name),
                  t.planets, design.limits[design::CheckId::kIdenticalPlanets].has_value());
  text +=
      fmt::format("pressure_angle_deg = {}\n", toml_number(t.pressure_angle_rad / units::kDegree));
  if (design.center_distance_given) {
    text += fmt::format("center_distance_mm = {}\n",
                        toml_number(t.center_distance_m / units::kMillimetre));
  }
  text += "sign_convention = \"khk\"\n";
  text += fmt::format("\n[rack]\naddendum = {}\ndedendum = {}\nroot_radius = {}\n",
                      toml_number(t.rack[0].addendum), toml_number(t.rack[0].dedendum),
                      toml_number(t.rack[0].root_radius));
  for (std::size_t stage = 0; stage < 2; ++stage) {
    text += fmt::format("\n[stage{}]\nmodule_mm = {}\n", stage + 1,
                        toml_number(t.module_m[stage] / units::kMillimetre));
    if (design.masses.face_width_m[stage]) {
      text += fmt::format("face_width_mm = {}\n",
                          toml_number(*design.masses.face_width_m[stage] / units::kMillimetre));
    }
  }
  const design::Masses& masses = design.masses;
  const auto z = train::teeth_of(t.teeth);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    text += fmt::format("\n[gears.{}]\nteeth = {}\nprofile_shift = {}\nmachining_allowance = {}\n",
                        train::kGearNames[i], z[i], toml_number(t.profile_shift[i]),
                        toml_number(t.machining_allowance[i]));
    text += t.khk_tip[i] ? "tip_rule = \"khk\"\n"
                         : fmt::format("tip_shortening = {}\n", toml_number(t.tip_shortening[i]));
    if (design.pin_diameter_m[i]) {
      text += fmt::format("pin_diameter_mm = {}\n",
                          toml_number(*design.pin_diameter_m[i] / units::kMillimetre));
    }
    if (masses.bore_radius_m[i] > 0.0) {
      text += fmt::format("bore_mm = {}\n",
                          toml_number(2.0 * masses.bore_radius_m[i] / units::kMillimetre));
    }
    const auto outer = i == train::kR1   ? masses.ring1_outer_radius_m
                       : i == train::kR2 ? masses.ring2_outer_radius_m
                                         : std::nullopt;
    if (outer)
      text +=
          fmt::format("outer_diameter_mm = {}\n", toml_number(2.0 * *outer / units::kMillimetre));
    if (t.cutter[i].teeth > 0) {
      text +=
          fmt::format("[gears.{}.cutter]\nteeth = {}\nprofile_shift = {}\ntip_radius = {}\n",
                      train::kGearNames[i], t.cutter[i].teeth,
                      toml_number(t.cutter[i].profile_shift), toml_number(t.cutter[i].tip_radius));
    }
  }
  text += axial_text(design.axial);
  text += inertia_text(masses);
  text += "\n[friction]\n";
  if (efficiency::reads_coefficient(design.friction.law)) {
    text += fmt::format("coefficient = {}\n", toml_number(design.friction.coefficient));
  }
  text += fmt::format("loss_model = \"{}\"\n",
                      efficiency::kLossModelNames[static_cast<std::size_t>(design.friction.model)]);
  if (design.friction.model == efficiency::LossModel::kDirectional) {
    text += fmt::format("approach_factor = {}\nrecess_factor = {}\n",
                        toml_number(design.friction.approach_factor),
                        toml_number(design.friction.recess_factor));
  }
  if (design.tolerances) text += tolerances_text(*design.tolerances, design.sampling);
  return text + loss_text(design) + limits_text(design.limits);
}

}  // namespace gear3k::io
