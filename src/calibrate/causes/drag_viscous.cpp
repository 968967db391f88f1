#include "calibrate/causes/drag_change.hpp"

namespace gear3k::calibrate::drag_viscous {

namespace {

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  // What is plausible is told by the torque in the rows (fit/row_drag.hpp).
  auto result = drag_parameter("coefficient", "Nms", 10.0, 10.0);
  add_bend_parameter(form, result);
  return result;
}

/// c ω, or c ω (1 − b (ω₁ − ω)/ω₁): c ω₁ at ω₁ as well, with the exponent 1 + b there.
void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  design::ShaftDrag<Scalar>& drag = shaft_drag(form, m);
  drag.viscous_Nms = drag.viscous_Nms + p[0];
  if (!is_bent(form)) return;
  const Scalar bent = p[0] * p[1];
  drag.viscous_Nms = drag.viscous_Nms - bent;
  drag.quadratic_Nms2 = drag.quadratic_Nms2 + bent / form.constant("top_speed");
}

}  // namespace

extern const Cause cause;
constinit const Cause cause =
    drag_cause("drag_viscous", "drag proportional to speed", parameters, apply, bent_drag_forms);

}  // namespace gear3k::calibrate::drag_viscous
