#include "calibrate/drag_change.hpp"

namespace gear3k::calibrate {

extern const Cause drag_viscous;
constinit const Cause drag_viscous = drag_cause(
    "drag_viscous", "drag proportional to speed",
    [](const Form&, Kind) { return drag_parameter("coefficient", "Nms", 10.0, 0.1); },
    add_drag<&design::ShaftDrag<Scalar>::viscous_Nms>);

}  // namespace gear3k::calibrate
