#include <array>
#include <cmath>
#include <utility>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::friction_load {

namespace {

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  std::vector<ParameterRecord> result{{.name = "exponent",
                                       .unit = "",
                                       .lower = -2.0,
                                       .upper = 2.0,
                                       .plausible_low = -0.5,
                                       .plausible_high = 0.5}};
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
  add_free_shapes(free, result);
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  if (p.size() > 1) {
    change_shape(p.subspan(1), half_range_of(form), m.gearbox.friction.load_bend, m);
  }
  m.gearbox.friction.load_exponent = p[0];
  m.gearbox.friction.reference_force_N = form.constant("reference_load");
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
