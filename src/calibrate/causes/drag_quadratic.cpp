#include "calibrate/cause.hpp"
#include "calibrate/drag_change.hpp"

namespace gear3k::calibrate {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) {
  return drag_parameter("coefficient", "Nms2", 1.0, 0.001);
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  add_drag(form, &design::ShaftDrag<Scalar>::quadratic_Nms2, p[0], m);
}

}  // namespace

extern const Cause drag_quadratic;
const Cause drag_quadratic{.id = "drag_quadratic",
                           .title = "drag proportional to speed squared",
                           .remedy = Remedy::kDrag,
                           .place = Place::kGearbox,
                           .weight = 0.7,
                           .parameters = parameters,
                           .forms = drag_forms,
                           .apply = apply};

}  // namespace gear3k::calibrate
