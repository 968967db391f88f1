#include "calibrate/causes/drag_change.hpp"

namespace gear3k::calibrate::drag_constant {

extern const Cause cause;
constinit const Cause cause = drag_cause(
    "drag_constant", "load-independent drag",
    [](const Form&, Kind) { return drag_parameter("torque", "Nm", 100.0, kMostDrag_Nm); },
    add_drag<&design::ShaftDrag<Scalar>::constant_Nm>);

}  // namespace gear3k::calibrate::drag_constant
