#pragma once
// What the laws of drag have in common: the shaft that the drag brakes.

#include <vector>

#include "calibrate/cause.hpp"

namespace gear3k::calibrate {

/// A torque or coefficient that a cause adds to the design's, from 0 on.
inline std::vector<ParameterRecord> drag_parameter(std::string_view name, std::string_view unit,
                                                   double greatest, double plausible) {
  return {{.name = name,
           .unit = unit,
           .lower = 0.0,
           .upper = greatest,
           .plausible_low = 0.0,
           .plausible_high = plausible}};
}

/// At the sun, where seals run fastest, or at the output.
inline std::vector<Form> drag_forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission) return {};
  return {{.name = "sun", .body = "sun", .weight = 0.7},
          {.name = "output", .body = "output", .weight = 0.3}};
}

inline void add_drag(const Form& form, Scalar design::ShaftDrag<Scalar>::*term,
                     const Scalar& change, Modification& m) {
  const auto shaft = form.name == "sun" ? design::kSunShaft : design::kOutputShaft;
  Scalar& drag = m.gearbox.drag[shaft].*term;
  drag = drag + change;
}

}  // namespace gear3k::calibrate
