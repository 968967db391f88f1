#include <algorithm>
#include <cmath>
#include <vector>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::compliance {

namespace {

constexpr const char* kHardening = "hardening";
constexpr const char* kTwoStage = "two_stage";

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  std::vector<ParameterRecord> result{{.name = "compliance",
                                       .unit = "arcmin/Nm",
                                       .lower = 0.0,
                                       .upper = 1e3,
                                       .plausible_low = 0.0,
                                       .plausible_high = 10.0}};
  if (form.name == kHardening) {
    // Compliance by T^(-h): points that touch have 1/3 (Hertz), a cone 1/2 (Sneddon), rough seats
    // up to 1, as their approach goes with ln T (Persson 2007).  Beyond 1/2 the fit would take up
    // play, which is `clearance`, but a gearbox may well be so soft at first.
    constexpr double kSoftestOfFit = 0.5, kSoftest = 1.0;
    result.push_back({.name = "hardening",
                      .unit = "",
                      .lower = -1.0,
                      .upper = kSoftestOfFit,
                      .plausible_low = -0.2,
                      .plausible_high = kSoftest});
  }
  if (form.name == kTwoStage) {
    result.push_back({.name = "soft_windup",
                      .unit = "arcmin",
                      .lower = 0.0,
                      .upper = 1e4,
                      .plausible_low = 0.0,
                      .plausible_high = 1e3});
    const double most = half_range_of(form);
    result.push_back({.name = "log_soft_torque_change",
                      .unit = "",
                      .lower = -most,
                      .upper = most,
                      .plausible_low = -most,
                      .plausible_high = most});
  }
  return result;
}

/// Test torques between which what is soft at first may come to its end: a quarter of the loaded
/// rows, and two torques at least, lie at or below.  Otherwise it would be a constant in disguise,
/// which is `clearance`.
ValueRange soft_torques(const MeasurementSet& data) {
  std::vector<double> torque_Nm;
  for (const Observation& row : data.rows) {
    if (row.condition.test_torque_Nm > 0.0) torque_Nm.push_back(row.condition.test_torque_Nm);
  }
  std::ranges::sort(torque_Nm);
  constexpr double kApart = 1.02;
  const auto second =
      std::ranges::find_if(torque_Nm, [&](double t) { return t > kApart * torque_Nm.front(); });
  if (second == torque_Nm.end()) return {};
  return {.low = std::max(*second, torque_Nm[torque_Nm.size() / 4]), .high = torque_Nm.back()};
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kLostMotion && o.kind != Kind::kTorqueAngle) return {};
  std::vector<Form> result{{.name = "output"}};
  // Once it is found: teeth and bearings that touch more as the torque grows are soft near zero.
  const ValueRange torque = range_of(*o.data, &Condition::test_torque_Nm);
  if (torque.varies()) {
    result.push_back(
        {.name = kHardening,
         .constants = {{.name = "hardening_torque", .unit = "Nm", .value = torque.high}},
         .weight = 0.0});
  }
  // Bearings whose rollers do not all carry yet, or a flexible part that settles: soft up to a
  // torque.
  const ValueRange soft = soft_torques(*o.data);
  constexpr double kApart = 1.2;
  if (soft.high > kApart * soft.low) {
    result.push_back({.name = kTwoStage,
                      .constants = {{.name = "soft_torque",
                                     .unit = "Nm",
                                     .value = std::sqrt(soft.low * soft.high)},
                                    {.name = "torque_half_range",
                                     .unit = "",
                                     .value = 0.5 * std::log(soft.high / soft.low)}},
                      .weight = 0.0});
  }
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind kind,
           Modification& m) {
  auto& e = m.gearbox.lost_motion;
  e.compliance_rad_Nm = e.compliance_rad_Nm + p[0] * response_unit(kind).si;
  if (form.name == kHardening) {
    e.hardening = p[1];
    e.hardening_torque_Nm = form.constant("hardening_torque");
  }
  if (form.name == kTwoStage) {
    using std::exp;
    e.soft_windup_rad = p[1] * response_unit(kind).si;
    e.soft_torque_Nm = Scalar(form.constant("soft_torque") * exp(p[2]));
  }
}

/// Where what is soft at first comes to its end.
std::vector<DerivedParameter> soft_torque(const Form& form, std::span<const Scalar> p,
                                          const Simulation&, const Modification&) {
  using std::exp;
  if (form.name != kTwoStage) return {};
  return {{.record = {.name = "soft_torque",
                      .unit = "Nm",
                      .lower = -HUGE_VAL,
                      .upper = HUGE_VAL,
                      .plausible_low = 0.0,
                      .plausible_high = HUGE_VAL},
           .value = Scalar(form.constant("soft_torque") * exp(p[2]))}};
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "compliance",
                  .title = "elastic wind-up under the test torque",
                  .remedy = Remedy::kStiffness,
                  .place = Place::kGearbox,
                  .weight = 0.6,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply,
                  .derived = soft_torque};

}  // namespace gear3k::calibrate::compliance
