#pragma once

#include "geometry/tooth_form.hpp"

namespace gear3k::strength {

/// A fillet's values as constants of another scalar.
template <class S, class T>
geometry::Fillet<S> fillet_values(const geometry::Fillet<T>& f) {
  return {.tool = f.tool,
          .rounding_radius_m = S(value_of(f.rounding_radius_m)),
          .pitch_radius_m = S(value_of(f.pitch_radius_m)),
          .rounding_depth_m = S(value_of(f.rounding_depth_m)),
          .cutter_pitch_radius_m = S(value_of(f.cutter_pitch_radius_m)),
          .rounding_center_radius_m = S(value_of(f.rounding_center_radius_m)),
          .center_offset = S(value_of(f.center_offset)),
          .tool_teeth_ratio = f.tool_teeth_ratio,
          .normal_angle_rad = S(value_of(f.normal_angle_rad))};
}

}  // namespace gear3k::strength
