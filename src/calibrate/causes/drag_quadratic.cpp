#include "calibrate/causes/drag_change.hpp"

namespace gear3k::calibrate::drag_quadratic {

extern const Cause cause;
constinit const Cause cause = drag_cause(
    "drag_quadratic", "drag proportional to speed squared",
    [](const Form&, Kind) { return drag_parameter("coefficient", "Nms2", 1.0, 0.001); },
    add_drag<&design::ShaftDrag<Scalar>::quadratic_Nms2>);

}  // namespace gear3k::calibrate::drag_quadratic
