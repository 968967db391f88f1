#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::thermal_expansion {

namespace {

constexpr double kMicro = 1e-6;

/// Of the housing less that of the gears.  The most that solids show is 200 (polyethylene;
/// matmake.com, Thermal Expansion of Common Polymers and Plastics).
std::vector<ParameterRecord> parameters(const Form&, Kind) {
  constexpr double kMost = 200.0;
  return {{.name = "expansion",
           .unit = "um/m/K",
           .lower = -2000.0,
           .upper = 2000.0,
           .plausible_low = -kMost,
           .plausible_high = kMost}};
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kLostMotion || !tells_of_temperature(o)) return {};
  if (o.teeth == nullptr) return {};
  const auto form = [&](const char* name, double reference_K, double weight) {
    return Form{.name = name,
                .constants = {{.name = "reference_temperature",
                               .unit = "c",
                               .value = kTemperature.stated(reference_K)}},
                .weight = weight};
  };
  const double middle = 0.5 * (o.temperature_K[0] + o.temperature_K[1]);
  return {form("from_design", o.design_temperature_K, 0.6), form("about_middle", middle, 0.4)};
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  auto& e = m.gearbox.lost_motion;
  e.expansion_1_K = e.expansion_1_K + p[0] * kMicro;
  e.reference_temperature_K = kTemperature.si(form.constant("reference_temperature"));
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "thermal_expansion",
                  .title = "the centre distance follows temperature",
                  .remedy = Remedy::kHousing,
                  .place = Place::kGearbox,
                  .weight = 1.0,
                  .exclusive_forms = true,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::thermal_expansion
