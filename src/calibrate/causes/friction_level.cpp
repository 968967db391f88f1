#include "calibrate/causes/friction_change.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::friction_level {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) { return {level_parameter()}; }

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission && o.kind != Kind::kPairLoss) return {};
  return {{.name = "coefficient"}};
}

void apply(const Form&, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  change_level(p[0], m);
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "friction_level",
                  .title = "the coefficient of friction is not the stated one",
                  .remedy = Remedy::kFrictionValue,
                  .place = Place::kGearbox,
                  .weight = 0.8,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::friction_level
