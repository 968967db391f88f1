#include <limits>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::friction_temperature {

namespace {

constexpr const char* kDrag = "drag";

/// That of the viscosity of an oil ISO VG 460 (460 mm²/s at 40 °C, 30.5 at 100 °C) at 10 °C by
/// Ubbelohde and Walther (docs/theory §25): thicker oils are none of a gearbox, and friction goes
/// with at most the first power of viscosity.  A law that bends by a parameter of its own may be a
/// transition, of a grease or a plastic, as steep as it likes within a few kelvin: the friction
/// that it gives the rows says whether it can be.
constexpr double kSteepest = 0.1;

double steepest_of(const Form& form) {
  const bool bends = form.name.starts_with(kAnyCurve) || form.name.starts_with(kAnyShape);
  return bends ? std::numeric_limits<double>::infinity() : kSteepest;
}

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  std::vector<ParameterRecord> result;
  if (!is_smooth(form)) {
    result.push_back({.name = "coefficient",
                      .unit = "1/K",
                      .lower = -0.5,
                      .upper = 0.5,
                      .plausible_low = -steepest_of(form),
                      .plausible_high = steepest_of(form)});
  }
  add_shape_parameters(form, result);
  return result;
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission || !tells_of_temperature(o)) return {};
  const auto form = [&](const char* name, double reference_K, double weight) {
    return Form{.name = name,
                .constants = {{.name = "reference_temperature",
                               .unit = "c",
                               .value = kTemperature.stated(reference_K)}},
                .weight = weight};
  };
  const double span = o.temperature_K[1] - o.temperature_K[0];
  std::vector<Form> result{form("from_design", o.design_temperature_K, 0.4),
                           form("from_coldest", o.temperature_K[0], 0.15),
                           form("about_middle", o.temperature_K[0] + 0.5 * span, 0.6),
                           form("from_warmest", o.temperature_K[1], 0.15)};
  // Once it is found: with the level at the middle, and the shape, as parameters of their own.
  Form free = form("", o.temperature_K[0] + 0.5 * span, 0.0);
  free.constants.push_back({.name = "half_range", .unit = "K", .value = 0.5 * span});
  add_free_shapes(free, stated(*o.data, &Condition::temperature_K, false), result);
  if (o.has_drag) {
    result.push_back(form(kDrag, o.design_temperature_K, 0.3));
    result.back().law = kDrag;
  }
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  const double reference_K = kTemperature.si(form.constant("reference_temperature"));
  if (form.name == kDrag) {
    m.gearbox.drag_temperature_1_K = p[0];
    m.gearbox.drag_reference_temperature_K = reference_K;
  } else if (is_smooth(form)) {
    change_smoothly(form, p, m.gearbox.friction.temperature_bend, m);
    m.gearbox.friction.reference_temperature_K = reference_K;
  } else {
    if (p.size() > 1) {
      change_shape(p.subspan(1), half_range_of(form), m.gearbox.friction.temperature_bend, m);
    }
    m.gearbox.friction.temperature_1_K = p[0];
    m.gearbox.friction.reference_temperature_K = reference_K;
  }
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "friction_temperature",
                  .title = "friction or viscosity follows temperature",
                  .remedy = Remedy::kFlanks,
                  .place = Place::kGearbox,
                  .weight = 2.0,
                  .exclusive_forms = true,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::friction_temperature
