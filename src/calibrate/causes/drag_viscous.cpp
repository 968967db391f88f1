#include "calibrate/cause.hpp"
#include "calibrate/drag_change.hpp"

namespace gear3k::calibrate {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) {
  return drag_parameter("coefficient", "Nms", 10.0, 0.1);
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  add_drag(form, &design::ShaftDrag<Scalar>::viscous_Nms, p[0], m);
}

}  // namespace

extern const Cause drag_viscous;
const Cause drag_viscous{.id = "drag_viscous",
                         .title = "drag proportional to speed",
                         .remedy = Remedy::kDrag,
                         .place = Place::kGearbox,
                         .weight = 0.7,
                         .parameters = parameters,
                         .forms = drag_forms,
                         .apply = apply};

}  // namespace gear3k::calibrate
