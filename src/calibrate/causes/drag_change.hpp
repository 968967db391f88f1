#pragma once
// What the laws of drag have in common: the shaft that the drag brakes.

#include <span>
#include <string_view>
#include <vector>

#include "calibrate/model/cause.hpp"

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

/// Adds the parameter to a term of the shaft's drag.
template <Scalar design::ShaftDrag<Scalar>::*kTerm>
void add_drag(const Form& form, std::span<const Scalar> p, const Condition&, Kind,
              Modification& m) {
  const auto shaft = form.name == "sun" ? design::kSunShaft : design::kOutputShaft;
  Scalar& drag = m.gearbox.drag[shaft].*kTerm;
  drag = drag + p[0];
}

/// A law of drag; the laws are told apart by speeds alone and weigh alike.
constexpr Cause drag_cause(std::string_view id, std::string_view title,
                           decltype(Cause::parameters) parameters, decltype(Cause::apply) apply) {
  return {.id = id,
          .title = title,
          .remedy = Remedy::kDrag,
          .place = Place::kGearbox,
          .weight = 0.7,
          .parameters = parameters,
          .forms = drag_forms,
          .apply = apply};
}

}  // namespace gear3k::calibrate
