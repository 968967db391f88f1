#include "calibrate/causes/angle_order.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::mesh_order {

namespace {

std::vector<Form> forms(const Occasion& o) {
  if (o.teeth == nullptr) return {};
  return angle_forms(o, train::mesh_orders(*o.teeth));
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "mesh_order",
                  .title = "an error that repeats with the teeth (pitch error)",
                  .remedy = Remedy::kAccuracy,
                  .place = Place::kMeasurement,
                  .weight = 0.9,
                  .parameters = angle_parameters,
                  .forms = forms,
                  .apply = apply_angle,
                  .derived = angle_amplitude};

}  // namespace gear3k::calibrate::mesh_order
