#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::compliance {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) {
  return {{.name = "compliance",
           .unit = "arcmin/Nm",
           .lower = 0.0,
           .upper = 1e3,
           .plausible_low = 0.0,
           .plausible_high = 10.0}};
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kLostMotion && o.kind != Kind::kTorqueAngle) return {};
  return {{.name = "output"}};
}

void apply(const Form&, std::span<const Scalar> p, const Condition&, Kind kind, Modification& m) {
  auto& e = m.gearbox.lost_motion;
  e.compliance_rad_Nm = e.compliance_rad_Nm + p[0] * response_unit(kind).si;
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
