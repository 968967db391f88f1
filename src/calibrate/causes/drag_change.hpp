#pragma once
// What the laws of drag have in common: the shaft that the drag brakes.

#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate {

/// The torque that seals, preload and oil are taken to have at any shaft [N m], an assumption.
/// Above it, as in large gearboxes, they have no more than what the shaft carries
/// (fit/row_drag.hpp).
inline constexpr double kMostDrag_Nm = 5.0;

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

inline constexpr std::string_view kBentDrag = "any_curve";
inline bool is_bent(const Form& form) { return form.name.ends_with(kBentDrag); }

/// The same, and once one of them is found: greases and splashed oil follow the law of speed
/// roughly, so that its exponent at the greatest speed ω₁ is a parameter as well.
inline std::vector<Form> bent_drag_forms(const Occasion& o) {
  std::vector<Form> result = drag_forms(o);
  if (result.empty()) return result;
  const ValueRange speed = range_of(*o.data, &Condition::sun_speed_rad_s);
  if (!speed.varies() || !(speed.high > 0.0)) return result;
  for (const std::size_t k : {0U, 1U}) {
    Form form = result[k];
    const double ratio = form.body == "sun" ? 1.0 : std::abs(o.ratio);
    if (!(ratio > 0.0)) continue;
    form.name += "_" + std::string(kBentDrag);
    form.constants = {{.name = "top_speed", .unit = "rad/s", .value = speed.high / ratio}};
    form.weight = 0.0;
    result.push_back(std::move(form));
  }
  return result;
}

/// How far the exponent at ω₁ is above that of the law; held where it is still that law rather than
/// the next one.
inline void add_bend_parameter(const Form& form, std::vector<ParameterRecord>& parameters) {
  if (!is_bent(form)) return;
  constexpr double kMost = 0.6;
  parameters.push_back({.name = "exponent_change",
                        .unit = "",
                        .lower = -kMost,
                        .upper = kMost,
                        .plausible_low = -kMost,
                        .plausible_high = kMost});
}

/// The shaft's drag that a form changes.
inline design::ShaftDrag<Scalar>& shaft_drag(const Form& form, Modification& m) {
  return m.gearbox.drag[form.name.starts_with("sun") ? design::kSunShaft : design::kOutputShaft];
}

/// Adds the parameter to a term of the shaft's drag.
template <Scalar design::ShaftDrag<Scalar>::*kTerm>
void add_drag(const Form& form, std::span<const Scalar> p, const Condition&, Kind,
              Modification& m) {
  Scalar& drag = shaft_drag(form, m).*kTerm;
  drag = drag + p[0];
}

/// A law of drag; the laws are told apart by speeds alone and weigh alike.
constexpr Cause drag_cause(std::string_view id, std::string_view title,
                           decltype(Cause::parameters) parameters, decltype(Cause::apply) apply,
                           decltype(Cause::forms) forms = drag_forms) {
  return {.id = id,
          .title = title,
          .remedy = Remedy::kDrag,
          .place = Place::kGearbox,
          .weight = 0.7,
          .parameters = parameters,
          .forms = forms,
          .apply = apply};
}

}  // namespace gear3k::calibrate
