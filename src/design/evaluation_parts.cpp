#include "design/evaluation_parts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "backlash/normal_backlash.hpp"
#include "efficiency/train_efficiency.hpp"
#include "units/units.hpp"

namespace gear3k::design {

using geometry::GearGeometry;

namespace {

ToothResult tooth_result(const GearGeometry<double>& g, const geometry::ToothForm<double>& form,
                         std::optional<double> pin_diameter_m) {
  const auto pins = geometry::pin_measure(g, pin_diameter_m);
  return {.tool = form.fillet.tool,
          .form_diameter_m = 2.0 * form.form_radius_m,
          .undercut = form.undercut,
          .fillet_radius_m = form.fillet.rounding_radius_m,
          .full_round = form.full_round,
          .form_thickness_m = geometry::form_circle_thickness(g, form),
          .root_space_m = geometry::root_space_width(g),
          .span = geometry::span_measure(g),
          .pins = pins,
          .stated_pin_m = pin_diameter_m,
          .fitting_pins = pins ? std::nullopt : geometry::fitting_pins(g),
          .chordal = geometry::chordal_thickness(g),
          .infeed = geometry::infeed(g),
          .cutter_teeth = g.gear.kind == geometry::GearKind::kRing ? g.gear.cutter.teeth : 0,
          .cutter_tip_diameter_m = 2.0 * form.cutter_tip_radius_m,
          .cutter_center_distance_m = form.cutter_center_distance_m};
}

}  // namespace

std::string why_no_pins(const ToothResult& tooth) {
  if (tooth.pins) return "";
  if (!tooth.fitting_pins) return "no pin finds a seat on the flanks";
  const auto [least_m, greatest_m] = *tooth.fitting_pins;
  const double least_mm = std::ceil(least_m * 1e7) * 1e-4;
  const std::string fitting =
      std::isfinite(greatest_m)
          ? fmt::format("{:.4f} to {:.4f} mm", least_mm, std::floor(greatest_m * 1e7) * 1e-4)
          : fmt::format("{:.4f} mm and more", least_mm);
  if (!tooth.stated_pin_m) {
    return fmt::format("no pin touches on the circle d + 2 x m; pins of {} fit (pin_diameter_mm)",
                       fitting);
  }
  const bool large = *tooth.stated_pin_m > greatest_m;
  return fmt::format("a pin of {:.6g} mm is too {}, it would touch {}; pins of {} fit",
                     *tooth.stated_pin_m * 1e3, large ? "large" : "small",
                     large ? "beyond the tips" : "the root or its fillets", fitting);
}

NotDefined no_working_angle(std::string_view mesh, double center_distance_m, double base_sum_m) {
  if (!(base_sum_m > 0.0)) {
    return {fmt::format("mesh {}: the ring needs more teeth than the planet", mesh)};
  }
  return {fmt::format(
      "mesh {}: center distance = {:.6g} mm leaves no working pressure angle, allowed: above "
      "{:.6g} mm (base radii)",
      mesh, center_distance_m * 1e3, base_sum_m * 1e3)};
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

MeshResult mesh_result(const Pairing& p, const Friction& friction, const MeshFriction& mu) {
  const auto forward = efficiency::contact_of(p.gear1, p.gear2, p.mesh, p.gear1_drives);
  const auto backward = efficiency::contact_of(p.gear1, p.gear2, p.mesh, !p.gear1_drives);
  const double approach = forward.approach_contact_ratio;
  const double recess = forward.recess_contact_ratio;
  const auto efficiency = [&](const efficiency::MeshContact<double>& contact, double coefficient) {
    if (!(p.mesh.contact_ratio > 0.0)) return std::numeric_limits<double>::quiet_NaN();
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

void note_loss_model(const std::vector<MeshResult>& meshes, std::vector<std::string>& notes) {
  for (const MeshResult& mesh : meshes) {
    if (mesh.contact_ratio <= 0.0) {
      notes.push_back(
          fmt::format("mesh {} has no contact (contact ratio {:.3f}): efficiencies are undefined",
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

void note_pointed_teeth(const std::vector<GearResult>& gears, std::vector<std::string>& notes) {
  for (const GearResult& gear : gears) {
    if (gear.tip_thickness_m >= 0.0) continue;
    notes.push_back(
        fmt::format("the flanks of {} cross {:.4f} mm (tip thickness) before the tip circle: tip "
                    "diameter, contact ratio and what follows from them are of teeth that cannot "
                    "be made; shorten the tip",
                    gear.name, units::from_si(gear.tip_thickness_m, units::Unit::kMillimetre)));
  }
}

}  // namespace gear3k::design
