#include "calibrate/causes/angle_order.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::runout {

namespace {

std::vector<Form> forms(const Occasion& o) { return angle_forms(o, shafts_of(o)); }

}  // namespace

extern const Cause cause;
const Cause cause{.id = "runout",
                  .title = "run-out of a body",
                  .remedy = Remedy::kAccuracy,
                  .place = Place::kMeasurement,
                  .weight = 0.6,
                  .parameters = angle_parameters,
                  .forms = forms,
                  .apply = apply_angle,
                  .derived = angle_amplitude};

}  // namespace gear3k::calibrate::runout
