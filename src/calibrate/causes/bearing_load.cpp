#include <algorithm>
#include <cmath>
#include <vector>

#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"
#include "units/units.hpp"

namespace gear3k::calibrate::bearing_load {

namespace {

constexpr const char* kPlanetBearings = "planet_bearings";
constexpr const char* kBothShafts = "both_shafts";
constexpr const char* kPinionShaft = "pinion_shaft";
constexpr const char* kGrowing = "output_bearing_any_exponent";
constexpr const char* kSized = "both_shafts_any_size";

/// The greatest share μ_b r_b/r_L of the load that a bearing may take: of one whose load acts no
/// further in than the bearing itself, r_L >= r_b, that of plain bearings that lubricate
/// themselves, μ_b = 0.01 to 0.3 (Machine Design, "Bearing friction", 2002).
constexpr double kMostShare = 0.3;
/// That of the shafts of a rig for pairs, which run in rolling bearings, an assumption.
constexpr double kMostShareOfRig = 0.05;

bool is_of_radii(const Form& form) {
  return form.name == kBothShafts || form.name == kPinionShaft || form.name == kSized;
}

/// Radius of a gear of a pair [m]; a usual module where the rows state none.
double gear_radius_m(const Condition& c, int teeth) {
  constexpr double kUsualModule_m = 1e-3;
  return 0.5 * teeth * (c.module_m > 0.0 ? c.module_m : kUsualModule_m);
}

/// Radii of all gears of the rows.
ValueRange gear_radii(const MeasurementSet& data) {
  std::vector<double> radii;
  for (const Observation& row : data.rows) {
    for (const int teeth : {row.condition.driving_teeth, row.condition.driven_teeth}) {
      if (teeth > 0) radii.push_back(gear_radius_m(row.condition, teeth));
    }
  }
  return range_of(radii);
}

std::vector<ParameterRecord> parameters(const Form& form, Kind kind) {
  if (form.name == kPlanetBearings || is_of_radii(form)) {
    std::vector<ParameterRecord> radius{{.name = "friction_radius",
                                         .unit = "mm",
                                         .lower = 0.0,
                                         .upper = 100.0,
                                         .plausible_low = 0.0,
                                         .plausible_high = 1.0}};
    if (form.name == kSized) {
      radius.push_back({.name = "size_exponent",
                        .unit = "",
                        .lower = 0.0,
                        .upper = 1.0,
                        .plausible_low = 0.0,
                        .plausible_high = 1.0});
    }
    return radius;
  }
  std::vector<ParameterRecord> result{
      {.name = "share",
       .unit = "",
       .lower = 0.0,
       .upper = 1.0,
       .plausible_low = 0.0,
       .plausible_high = kind == Kind::kPairLoss ? kMostShareOfRig : kMostShare}};
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
    std::vector<Form> result{{.name = "shafts", .weight = 0.5},
                             {.name = kBothShafts, .weight = 0.3},
                             {.name = kPinionShaft, .weight = 0.2}};
    // Once it is found: larger gears sit on larger bearings.
    const ValueRange radius = gear_radii(*o.data);
    if (radius.varies()) {
      const double middle_m = std::sqrt(radius.low * radius.high);
      result.push_back(
          {.name = kSized,
           .constants = {{.name = "reference_radius", .unit = "mm", .value = 1e3 * middle_m}},
           .weight = 0.0});
    }
    return result;
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

/// Σ r_bearing/r of the shafts of a pair over the friction radius [1/m]: at the same force on the
/// teeth a bearing takes the share μ r_bearing/r of the power.  Its radius is the same on all
/// shafts, or goes with that of the gear, r_bearing ~ r^g.
Scalar inverse_radii(const Form& form, std::span<const Scalar> p, const Condition& c) {
  using std::exp;
  const double pinion_m = gear_radius_m(c, std::min(c.driving_teeth, c.driven_teeth));
  const double gear_m = gear_radius_m(c, std::max(c.driving_teeth, c.driven_teeth));
  if (form.name == kPinionShaft) return Scalar(1.0 / pinion_m);
  if (form.name == kBothShafts) return Scalar(1.0 / pinion_m + 1.0 / gear_m);
  const double middle_m = units::kMillimetre * form.constant("reference_radius");
  const auto share = [&](double radius_m) {
    return Scalar(exp(Scalar(p[1] * std::log(radius_m / middle_m))) / radius_m);
  };
  return share(pinion_m) + share(gear_m);
}

/// In data of pairs a share of the power alike in all of them, or as the radii of the gears have
/// it.
void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
           Modification& m) {
  if (kind == Kind::kPairLoss && is_of_radii(form)) {
    if (condition.driving_teeth <= 0 || condition.driven_teeth <= 0) return;
    m.added = m.added + p[0] * units::kMillimetre * inverse_radii(form, p, condition);
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
