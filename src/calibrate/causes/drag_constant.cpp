#include "calibrate/drag_change.hpp"

namespace gear3k::calibrate {

extern const Cause drag_constant;
constinit const Cause drag_constant = drag_cause(
    "drag_constant", "load-independent drag",
    [](const Form&, Kind) { return drag_parameter("torque", "Nm", 100.0, 5.0); },
    add_drag<&design::ShaftDrag<Scalar>::constant_Nm>);

}  // namespace gear3k::calibrate
