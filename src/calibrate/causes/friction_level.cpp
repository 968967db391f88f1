#include "calibrate/causes/friction_change.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::friction_level {

namespace {

constexpr const char* kByMesh = "by_mesh";

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  std::vector<ParameterRecord> result{level_parameter()};
  if (form.name == kByMesh) {
    ParameterRecord rings = level_parameter();
    rings.name = "relative_change_of_rings";
    result.push_back(rings);
  }
  return result;
}

/// The same in all meshes; once it is found, other friction in the meshes with a ring: their flanks
/// curve alike, so that at the same load the film is thicker (docs/theory §25: μ ~ ρ^-0.2 with a
/// reduced radius several times that of sun and planet), and rings are cut and finished apart.
std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission && o.kind != Kind::kPairLoss) return {};
  std::vector<Form> result{{.name = "coefficient"}};
  if (o.kind == Kind::kTransmission && o.teeth != nullptr) {
    result.push_back({.name = kByMesh, .weight = 0.0});
  }
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind, Modification& m) {
  change_level(p[0], m);
  if (form.name != kByMesh) return;
  Scalar& rings = m.gearbox.friction.ring_meshes;
  rings = rings * (1.0 + p[1]);
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
