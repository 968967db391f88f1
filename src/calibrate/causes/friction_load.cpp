#include <array>
#include <cmath>
#include <utility>

#include "calibrate/causes/friction_change.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::friction_load {

namespace {

constexpr const char* kAnyLevel = "any_level";

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  std::vector<ParameterRecord> result{{.name = "exponent",
                                       .unit = "",
                                       .lower = -2.0,
                                       .upper = 2.0,
                                       .plausible_low = -0.5,
                                       .plausible_high = 0.5}};
  if (form.name == kAnyLevel) result.push_back(level_parameter());
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
  // Once it is found: with the coefficient at the middle as a parameter of its own.
  Form any = result[places.size() / 2];
  any.name = kAnyLevel;
  any.weight = 0.0;
  result.push_back(std::move(any));
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  if (form.name == kAnyLevel) change_level(p[1], m);
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
