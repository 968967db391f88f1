#include "calibrate/causes/drag_change.hpp"

namespace gear3k::calibrate::drag_constant {

namespace {

constexpr std::string_view kAndOutput = "sun_and_output", kAndSun = "output_and_sun";

bool is_of_both(const Form& form) { return form.name == kAndOutput || form.name == kAndSun; }

// What is plausible is told by the torque in the rows (fit/row_drag.hpp).
std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  constexpr double kMost_Nm = 100.0;
  std::vector<ParameterRecord> result = drag_parameter("torque", "Nm", kMost_Nm, kMost_Nm);
  if (is_of_both(form)) {
    result.push_back(drag_parameter("other_torque", "Nm", kMost_Nm, kMost_Nm).front());
  }
  return result;
}

/// Once it is found at the one shaft: both have a seal.  At the output it counts forward by one
/// over the efficiency and backward by the efficiency what it does referred to the sun, so that two
/// seals are not one.
std::vector<Form> forms(const Occasion& o) {
  std::vector<Form> result = drag_forms(o);
  if (result.empty()) return result;
  result.push_back({.name = std::string(kAndOutput), .body = "sun", .weight = 0.0});
  result.push_back({.name = std::string(kAndSun), .body = "output", .weight = 0.0});
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
           Modification& m) {
  add_drag<&design::ShaftDrag<Scalar>::constant_Nm>(form, p, condition, kind, m);
  if (!is_of_both(form)) return;
  const Form other{.name = form.name == kAndOutput ? "output" : "sun"};
  add_drag<&design::ShaftDrag<Scalar>::constant_Nm>(other, p.subspan(1), condition, kind, m);
}

}  // namespace

extern const Cause cause;
constinit const Cause cause =
    drag_cause("drag_constant", "load-independent drag", parameters, apply, forms);

}  // namespace gear3k::calibrate::drag_constant
