#include <algorithm>
#include <cmath>
#include <string_view>

#include "calibrate/causes/friction_change.hpp"
#include "calibrate/model/cause.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate::friction_direction {

namespace {

constexpr const char* kOfPairs = "driving_";
constexpr const char* kPinion = "driving_pinion";
constexpr const char* kGear = "driving_gear";
constexpr const char* kPinionGear = "driving_pinion_gear";
constexpr const char* kInner = "driving_inner";
constexpr const char* kOuter = "driving_outer";

/// Of a pair: +1 where the gear of fewer teeth drives, −1 where it is driven, 0 of equal ones.
int driving_side(const Condition& c) {
  return (c.driving_teeth < c.driven_teeth ? 1 : 0) - (c.driving_teeth > c.driven_teeth ? 1 : 0);
}

bool both_drive(const MeasurementSet& data) {
  const auto some = [&](int side) {
    return std::ranges::any_of(
        data.rows, [&](const Observation& row) { return driving_side(row.condition) == side; });
  };
  return some(1) && some(-1);
}

/// Of both sides of the pitch point or both ends, a positive asymmetry takes from the one what it
/// gives to the other.
bool is_of_both(const Form& form) {
  return form.name == "forward_backward" || form.name == "approach_recess" ||
         form.name == kPinionGear;
}

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  return {{.name = "asymmetry",
           .unit = "",
           .lower = -50.0,
           .upper = 50.0,
           .plausible_low = kSomeFriction,
           .plausible_high = is_of_both(form) ? -kSomeFriction : kMostChange}};
}

/// Friction differs before and behind the pitch point, or with the end that drives the train, or
/// with the gear that drives in each mesh, as other flanks carry then: of pairs the smaller or the
/// larger gear, in a gearbox the inner one (sun, or planet in a ring) or the outer one, which in
/// some meshes drives forward and in others backward.  One gearbox cannot tell these apart.  Either
/// side of the pitch point by itself is the asymmetry together with the level, which is a cause of
/// its own: a form with both would hide it.
std::vector<Form> forms(const Occasion& o) {
  if (o.kind == Kind::kPairLoss) {
    std::vector<Form> result{{.name = "approach_recess", .weight = 0.5},
                             {.name = "approach", .weight = 0.1},
                             {.name = "recess", .weight = 0.1}};
    if (both_drive(*o.data)) {
      result.push_back({.name = kPinionGear, .weight = 0.2, .law = kOnFriction});
      result.push_back({.name = kPinion, .weight = 0.05, .law = kOnFriction});
      result.push_back({.name = kGear, .weight = 0.05, .law = kOnFriction});
    }
    return result;
  }
  if (o.kind != Kind::kTransmission) return {};
  std::vector<Form> result{{.name = "forward_backward", .weight = 0.6},
                           {.name = "forward", .weight = 0.2},
                           {.name = "backward", .weight = 0.2}};
  if (o.teeth != nullptr) {
    result.push_back({.name = kInner, .weight = 0.15});
    result.push_back({.name = kOuter, .weight = 0.15});
  }
  // What the flanks do can be told from these only by other gearboxes: it takes their place where
  // it explains the data as well.
  if (o.teeth != nullptr) result.push_back({.name = "approach_recess", .weight = 0.0});
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
           Modification& m) {
  if (kind == Kind::kPairLoss && form.name.starts_with(kOfPairs)) {
    const int side = driving_side(condition);
    const bool acts = form.name == kPinionGear || (form.name == kPinion) == (side > 0);
    if (!acts || side == 0) return;
    const double sign = form.name == kPinionGear ? side : 1.0;
    m.friction_level = m.friction_level * (1.0 + sign * p[0]);
    return;
  }
  auto& f = m.gearbox.friction;
  const auto scale = [&](Scalar& factor, const Scalar& change) {
    factor = factor * (1.0 + change);
  };
  if (form.name == "forward_backward" || form.name == "forward") scale(f.forward, p[0]);
  if (form.name == "backward") scale(f.backward, p[0]);
  if (form.name == kInner) scale(f.inner_drives, p[0]);
  if (form.name == kOuter) scale(f.outer_drives, p[0]);
  if (form.name == "forward_backward") scale(f.backward, -p[0]);
  if (form.name.starts_with("approach")) scale(f.approach, p[0]);
  if (form.name == "recess") scale(f.recess, p[0]);
  if (form.name == "approach_recess") scale(f.recess, -p[0]);
}

/// In data of pairs the coefficients on either side of the pitch point, which all causes of a fit
/// make together.  Friction below 0 would drive.
std::vector<DerivedParameter> flank_coefficients(const Form&, std::span<const Scalar>,
                                                 const Simulation& simulation,
                                                 const Modification& all) {
  if (simulation.kind() != Kind::kPairLoss) return {};
  const auto coefficients = simulation.flank_coefficients(all);
  const auto side = [&](std::string_view name, const Scalar& value) {
    return DerivedParameter{.record = {.name = name,
                                       .unit = "",
                                       .lower = -HUGE_VAL,
                                       .upper = HUGE_VAL,
                                       .plausible_low = 0.0,
                                       .plausible_high = kMostFriction},
                            .value = value};
  };
  return {side("friction_in_approach", coefficients[0]),
          side("friction_in_recess", coefficients[1])};
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "friction_direction",
                  .title = "mesh friction differs with the side that drives",
                  .remedy = Remedy::kFlanks,
                  .place = Place::kGearbox,
                  .weight = 1.2,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply,
                  .derived = flank_coefficients};

}  // namespace gear3k::calibrate::friction_direction
