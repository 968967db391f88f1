#include "calibrate/cause.hpp"

namespace gear3k::calibrate {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) {
  return {{.name = "coefficient",
           .unit = "Nms2",
           .lower = 0.0,
           .upper = 1.0,
           .plausible_low = 0.0,
           .plausible_high = 0.001}};
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission) return {};
  return {{.name = "sun", .body = "sun", .weight = 0.7},
          {.name = "output", .body = "output", .weight = 0.3}};
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  const auto shaft = form.name == "sun" ? design::kSunShaft : design::kOutputShaft;
  Scalar& drag = m.gearbox.drag[shaft].quadratic_Nms2;
  drag = drag + p[0];
}

}  // namespace

extern const Cause drag_quadratic;
const Cause drag_quadratic{.id = "drag_quadratic",
                           .title = "drag proportional to speed squared",
                           .remedy = Remedy::kDrag,
                           .place = Place::kGearbox,
                           .weight = 0.7,
                           .exclusive_forms = false,
                           .parameters = parameters,
                           .forms = forms,
                           .apply = apply};

}  // namespace gear3k::calibrate
