#include "calibrate/model/cause.hpp"
#include "units/units.hpp"

namespace gear3k::calibrate::bearing_load {

namespace {

constexpr const char* kPlanetBearings = "planet_bearings";

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  if (form.name == kPlanetBearings) {
    return {{.name = "friction_radius",
             .unit = "mm",
             .lower = 0.0,
             .upper = 100.0,
             .plausible_low = 0.0,
             .plausible_high = 1.0}};
  }
  return {{.name = "share",
           .unit = "",
           .lower = 0.0,
           .upper = 1.0,
           .plausible_low = 0.0,
           .plausible_high = 0.05}};
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind == Kind::kPairLoss) return {{.name = "shafts"}};
  if (o.kind != Kind::kTransmission) return {};
  if (o.teeth == nullptr) return {{.name = "output_bearing", .body = "output"}};
  return {{.name = kPlanetBearings, .body = "planet", .weight = 0.6},
          {.name = "output_bearing", .body = "output", .weight = 0.4}};
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind kind,
           Modification& m) {
  if (kind == Kind::kPairLoss) {
    m.added = m.added + p[0];
  } else if (form.name == kPlanetBearings) {
    m.gearbox.planet_bearing_arm_m = m.gearbox.planet_bearing_arm_m + p[0] * units::kMillimetre;
  } else {
    m.gearbox.output_bearing_share = m.gearbox.output_bearing_share + p[0];
  }
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "bearing_load",
                  .title = "load-proportional loss outside the meshes (bearings)",
                  .remedy = Remedy::kBearings,
                  .place = Place::kGearbox,
                  .weight = 0.7,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::bearing_load
