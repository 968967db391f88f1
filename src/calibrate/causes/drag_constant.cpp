#include "calibrate/cause.hpp"
#include "calibrate/drag_change.hpp"

namespace gear3k::calibrate {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) {
  return drag_parameter("torque", "Nm", 100.0, 5.0);
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  add_drag(form, &design::ShaftDrag<Scalar>::constant_Nm, p[0], m);
}

}  // namespace

extern const Cause drag_constant;
const Cause drag_constant{.id = "drag_constant",
                          .title = "load-independent drag",
                          .remedy = Remedy::kDrag,
                          .place = Place::kGearbox,
                          .weight = 0.7,
                          .parameters = parameters,
                          .forms = drag_forms,
                          .apply = apply};

}  // namespace gear3k::calibrate
