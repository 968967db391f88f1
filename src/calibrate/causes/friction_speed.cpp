#include <cmath>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/model/cause.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate::friction_speed {

namespace {

constexpr const char* kSlowExcess = "slow_excess";
constexpr const char* kAnyScale = "slow_excess_any_scale";

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  if (form.name.starts_with(kSlowExcess)) {
    std::vector<ParameterRecord> result{{.name = "excess",
                                         .unit = "",
                                         .lower = -0.99,
                                         .upper = 50.0,
                                         .plausible_low = -0.99,
                                         .plausible_high = 50.0}};
    if (form.name == kAnyScale) {
      result.push_back({.name = "log_scale_change",
                        .unit = "",
                        .lower = -1.5,
                        .upper = 1.5,
                        .plausible_low = -1.5,
                        .plausible_high = 1.5});
    }
    return result;
  }
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

/// Falling from a static value to the design's (mixed lubrication), or a power of the speed.
std::vector<Form> forms(const Occasion& o) {
  // At one speed it is another coefficient of friction.
  if (o.kind != Kind::kTransmission || !(o.speed[1] > 1.001 * o.speed[0])) return {};
  const auto form = [&](const char* name, const char* constant, double speed, double weight) {
    return Form{
        .name = name,
        .constants = {{.name = constant, .unit = std::string(o.speed_unit), .value = speed},
                      {.name = "slowest", .unit = std::string(o.speed_unit), .value = o.speed[0]},
                      {.name = "fastest", .unit = std::string(o.speed_unit), .value = o.speed[1]}},
        .weight = weight};
  };
  std::vector<Form> result;
  for (const double share : {0.12, 0.25, 0.5}) {
    result.push_back(form(kSlowExcess, "speed_scale", share * o.speed[1], 0.2));
  }
  // Once it is found: with the scale as a parameter of its own.
  result.push_back(form(kAnyScale, "speed_scale", 0.25 * o.speed[1], 0.0));
  if (o.speed[0] > 0.0) {
    const double middle = std::sqrt(o.speed[0] * o.speed[1]);
    result.push_back(form("power_about_middle", "reference_speed", middle, 0.2));
    Form free = form("", "reference_speed", middle, 0.0);
    free.constants.push_back(
        {.name = "log_half_range", .unit = "", .value = 0.5 * std::log(o.speed[1] / o.speed[0])});
    add_free_shapes(free, stated(*o.data, &Condition::sun_speed_rad_s, true), result);
    result.push_back(form("power_from_highest", "reference_speed", o.speed[1], 0.1));
    result.push_back(form("power_from_lowest", "reference_speed", o.speed[0], 0.1));
  }
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  auto& friction = m.gearbox.friction;
  if (form.name.starts_with(kSlowExcess)) {
    friction.slow_excess = p[0];
    friction.slow_speed_m_s = Scalar(form.constant("speed_scale"));
    if (form.name == kAnyScale) friction.slow_speed_m_s = friction.slow_speed_m_s * exp(p[1]);
  } else if (is_smooth(form)) {
    change_smoothly(form, p, friction.speed_bend, m);
    friction.reference_speed_m_s = form.constant("reference_speed");
  } else {
    if (p.size() > 1) change_shape(p.subspan(1), half_range_of(form), friction.speed_bend, m);
    friction.speed_exponent = p[0];
    friction.reference_speed_m_s = form.constant("reference_speed");
  }
}

/// Friction at the slowest over that at the fastest sliding speed of the data: what the forms of
/// the law have in common.
std::vector<DerivedParameter> slow_over_fast(const Form& form, std::span<const Scalar> p,
                                             const Simulation& simulation, const Modification&) {
  Modification m;
  apply(form, p, {}, simulation.kind(), m);
  const auto friction = [&](const char* speed) {
    return friction_factor(m.gearbox.friction, Scalar(1.0), Scalar(form.constant(speed)),
                           Scalar(m.gearbox.friction.reference_temperature_K), true);
  };
  return {{.record = {.name = "slow_over_fast",
                      .unit = "",
                      .lower = 0.0,
                      .upper = HUGE_VAL,
                      .plausible_low = 0.0,
                      .plausible_high = HUGE_VAL},
           .value = friction("slowest") / friction("fastest")}};
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "friction_speed",
                  .title = "friction depends on sliding speed",
                  .remedy = Remedy::kFlanks,
                  .place = Place::kGearbox,
                  .weight = 2.5,
                  .exclusive_forms = true,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply,
                  .derived = slow_over_fast};

}  // namespace gear3k::calibrate::friction_speed
