#include <cmath>

#include "calibrate/causes/angle_order.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::runout {

namespace {

std::vector<Form> forms(const Occasion& o) {
  // Of a black box only its two shafts are known.
  if (o.teeth == nullptr) {
    const double ratio = std::abs(o.ratio);
    return angle_forms(o, {{.body = "sun", .order = ratio}, {.body = "output", .order = 1.0}});
  }
  return angle_forms(o, train::shaft_orders(*o.teeth));
}

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
