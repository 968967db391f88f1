#include <array>
#include <cmath>
#include <utility>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::friction_load {

namespace {

constexpr std::string_view kTorque = "reference_torque";

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  std::vector<ParameterRecord> result;
  if (!is_smooth(form)) {
    result.push_back({.name = "exponent",
                      .unit = "",
                      .lower = -2.0,
                      .upper = 2.0,
                      .plausible_low = -2.0,
                      .plausible_high = 2.0});
  }
  add_shape_parameters(form, result);
  return result;
}

/// The force at which the design's coefficient holds is not known: five places over the data.
std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission || !(o.load[1] > o.load[0]) || !(o.load[0] > 0.0)) return {};
  const std::array<std::pair<const char*, double>, 5> places{{{"from_lowest", 0.1},
                                                              {"from_lower", 0.2},
                                                              {"about_middle", 0.4},
                                                              {"from_higher", 0.2},
                                                              {"from_highest", 0.1}}};
  std::vector<Form> result;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double share = static_cast<double>(k) / (places.size() - 1);
    const double reference = o.load[0] * std::pow(o.load[1] / o.load[0], share);
    result.push_back({.name = places[k].first,
                      .constants = {{.name = "reference_load",
                                     .unit = std::string(o.load_unit),
                                     .value = reference}},
                      .weight = places[k].second});
  }
  // Once it is found: with the level at the middle, and the shape, as parameters of their own.
  Form free = result[places.size() / 2];
  free.constants.push_back(
      {.name = "log_half_range", .unit = "", .value = 0.5 * std::log(o.load[1] / o.load[0])});
  const std::vector<double> values = stated(*o.data, &Condition::output_torque_Nm, true);
  add_free_shapes(free, values, result);
  const ValueRange torque = range_of(*o.data, &Condition::output_torque_Nm);
  if (o.teeth == nullptr || !(torque.low > 0.0)) return result;
  free.constants = {
      {.name = std::string(kTorque), .unit = "Nm", .value = std::sqrt(torque.low * torque.high)},
      {.name = "log_half_range", .unit = "", .value = 0.5 * std::log(torque.high / torque.low)}};
  const std::size_t first = result.size();
  add_free_shapes(free, values, result);
  for (std::size_t k = first; k < result.size(); ++k) result[k].name += kByTorque;
  std::erase_if(result, [](const Form& form) { return form.name == "any_shape_by_torque"; });
  // Meshes made for equal pressures follow their own forces, which losses set apart: a steep law
  // then differs with the direction.
  for (const std::string_view name : {kAnyLevel, kAnyCurve}) {
    free.name = std::string(name) + std::string(kByShare);
    free.weight = 0.0;
    result.push_back(free);
  }
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  auto& f = m.gearbox.friction;
  f.share_is_of_force = load_variable(form) == kByShare;
  f.load_is_torque = !load_variable(form).empty();
  f.reference_force_N = form.constant(f.load_is_torque ? kTorque : "reference_load");
  if (is_smooth(form)) {
    change_smoothly(form, p, f.load_bend, m);
    return;
  }
  if (p.size() > 1) change_shape(p.subspan(1), half_range_of(form), f.load_bend, m);
  f.load_exponent = p[0];
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "friction_load",
                  .title = "friction depends on tooth load",
                  .remedy = Remedy::kFlanks,
                  .place = Place::kGearbox,
                  .weight = 3.0,
                  .exclusive_forms = true,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::friction_load
