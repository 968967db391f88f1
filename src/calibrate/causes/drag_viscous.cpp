#include "calibrate/causes/drag_change.hpp"

namespace gear3k::calibrate::drag_viscous {

extern const Cause cause;
constinit const Cause cause = drag_cause(
    "drag_viscous", "drag proportional to speed",
    [](const Form&, Kind) { return drag_parameter("coefficient", "Nms", 10.0, 0.1); },
    add_drag<&design::ShaftDrag<Scalar>::viscous_Nms>);

}  // namespace gear3k::calibrate::drag_viscous
