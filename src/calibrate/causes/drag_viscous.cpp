#include "calibrate/cause.hpp"

namespace gear3k::calibrate {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) {
  return {{.name = "coefficient",
           .unit = "Nms",
           .lower = 0.0,
           .upper = 10.0,
           .plausible_low = 0.0,
           .plausible_high = 0.1}};
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission) return {};
  return {{.name = "sun", .body = "sun", .weight = 0.7},
          {.name = "output", .body = "output", .weight = 0.3}};
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  const auto shaft = form.name == "sun" ? design::kSunShaft : design::kOutputShaft;
  Scalar& drag = m.gearbox.drag[shaft].viscous_Nms;
  drag = drag + p[0];
}

}  // namespace

extern const Cause drag_viscous;
const Cause drag_viscous{.id = "drag_viscous",
                         .title = "drag proportional to speed",
                         .remedy = Remedy::kDrag,
                         .place = Place::kGearbox,
                         .weight = 0.7,
                         .exclusive_forms = false,
                         .parameters = parameters,
                         .forms = forms,
                         .apply = apply};

}  // namespace gear3k::calibrate
