#include <algorithm>

#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"
#include "units/units.hpp"

namespace gear3k::calibrate::bearing_load {

namespace {

constexpr const char* kPlanetBearings = "planet_bearings";
constexpr const char* kBothShafts = "both_shafts";
constexpr const char* kPinionShaft = "pinion_shaft";
constexpr const char* kGrowing = "output_bearing_any_exponent";

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  if (form.name == kPlanetBearings || form.name == kBothShafts || form.name == kPinionShaft) {
    return {{.name = "friction_radius",
             .unit = "mm",
             .lower = 0.0,
             .upper = 100.0,
             .plausible_low = 0.0,
             .plausible_high = 1.0}};
  }
  std::vector<ParameterRecord> result{{.name = "share",
                                       .unit = "",
                                       .lower = 0.0,
                                       .upper = 1.0,
                                       .plausible_low = 0.0,
                                       .plausible_high = 0.05}};
  if (form.name == kGrowing) {
    // Of rolling bearings y is 0.3 to 0.55 (Palmgren); between the two others it is no bearing's.
    result.push_back({.name = "load_exponent",
                      .unit = "",
                      .lower = -0.5,
                      .upper = 1.0,
                      .plausible_low = -0.2,
                      .plausible_high = 0.6});
  }
  return result;
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind == Kind::kPairLoss) {
    return {{.name = "shafts", .weight = 0.5},
            {.name = kBothShafts, .weight = 0.3},
            {.name = kPinionShaft, .weight = 0.2}};
  }
  if (o.kind != Kind::kTransmission) return {};
  std::vector<Form> result;
  if (o.teeth != nullptr)
    result.push_back({.name = kPlanetBearings, .body = "planet", .weight = 0.6});
  result.push_back(
      {.name = "output_bearing", .body = "output", .weight = o.teeth == nullptr ? 1.0 : 0.4});
  // Once it is found: a share that grows with the load.
  const ValueRange torque = range_of(*o.data, &Condition::output_torque_Nm);
  if (torque.varies() && torque.high > 0.0) {
    result.push_back({.name = kGrowing,
                      .constants = {{.name = "top_torque", .unit = "Nm", .value = torque.high}},
                      .body = "output",
                      .weight = 0.0});
  }
  return result;
}

/// Σ 1/r of the shafts of a pair whose bearings lose [1/m]: at the same force on the teeth a
/// bearing takes the share μ r_bearing/r of the power.
double inverse_radii(const Form& form, const Condition& c) {
  constexpr double kUsualModule_m = 1e-3;
  const double module_m = c.module_m > 0.0 ? c.module_m : kUsualModule_m;
  const int less = std::min(c.driving_teeth, c.driven_teeth);
  const int more = std::max(c.driving_teeth, c.driven_teeth);
  const double pinion = 2.0 / (module_m * less);
  return form.name == kPinionShaft ? pinion : pinion + 2.0 / (module_m * more);
}

/// In data of pairs a share of the power alike in all of them, or as the radii of the gears have
/// it.
void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
           Modification& m) {
  if (kind == Kind::kPairLoss && (form.name == kBothShafts || form.name == kPinionShaft)) {
    if (condition.driving_teeth <= 0 || condition.driven_teeth <= 0) return;
    m.added = m.added + p[0] * (units::kMillimetre * inverse_radii(form, condition));
  } else if (kind == Kind::kPairLoss) {
    m.added = m.added + p[0];
  } else if (form.name == kPlanetBearings) {
    m.gearbox.planet_bearing_arm_m = m.gearbox.planet_bearing_arm_m + p[0] * units::kMillimetre;
  } else if (form.name == kGrowing) {
    m.gearbox.output_bearing_growth = {
        .share = p[0], .exponent = p[1], .reference_Nm = form.constant("top_torque")};
  } else {
    m.gearbox.output_bearing_share = m.gearbox.output_bearing_share + p[0];
  }
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "bearing_load",
                  .title = "load-proportional loss outside the meshes (bearings)",
                  .remedy = Remedy::kBearings,
                  .place = Place::kGearbox,
                  .weight = 0.7,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::bearing_load
