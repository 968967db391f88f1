#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::clearance {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) {
  return {{.name = "extra_lost_motion",
           .unit = "arcmin",
           .lower = -1e3,
           .upper = 1e3,
           .plausible_low = -10.0,
           .plausible_high = 30.0}};
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kLostMotion && o.kind != Kind::kTorqueAngle) return {};
  return {{.name = "constant"}};
}

void apply(const Form&, std::span<const Scalar> p, const Condition&, Kind kind, Modification& m) {
  auto& e = m.gearbox.lost_motion;
  e.clearance_rad = e.clearance_rad + p[0] * response_unit(kind).si;
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "clearance",
                  .title = "constant extra lost motion (bearing play, thinner teeth)",
                  .remedy = Remedy::kClearance,
                  .place = Place::kGearbox,
                  .weight = 1.0,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::clearance
