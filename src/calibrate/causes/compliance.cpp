#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::compliance {

namespace {

constexpr const char* kHardening = "hardening";

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  std::vector<ParameterRecord> result{{.name = "compliance",
                                       .unit = "arcmin/Nm",
                                       .lower = 0.0,
                                       .upper = 1e3,
                                       .plausible_low = 0.0,
                                       .plausible_high = 10.0}};
  if (form.name == kHardening) {
    // A contact of points, the softest at its beginning, has 1/3 (Hertz): what looks softer still
    // is play, which is `clearance`.
    constexpr double kSoftest = 0.5;
    result.push_back({.name = "hardening",
                      .unit = "",
                      .lower = -1.0,
                      .upper = kSoftest,
                      .plausible_low = -0.2,
                      .plausible_high = kSoftest});
  }
  return result;
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
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind kind,
           Modification& m) {
  auto& e = m.gearbox.lost_motion;
  e.compliance_rad_Nm = e.compliance_rad_Nm + p[0] * response_unit(kind).si;
  if (form.name != kHardening) return;
  e.hardening = p[1];
  e.hardening_torque_Nm = form.constant("hardening_torque");
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
                  .apply = apply};

}  // namespace gear3k::calibrate::compliance
