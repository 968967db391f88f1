#include "calibrate/model/hypothesis.hpp"

#include <algorithm>

namespace gear3k::calibrate {

std::vector<ParameterRecord> parameters_of(const Hypothesis& h) {
  std::vector<ParameterRecord> result;
  for (const Candidate& effect : h.effects) {
    result.insert(result.end(), effect.parameters.begin(), effect.parameters.end());
  }
  return result;
}

Place place_of(const Candidate& candidate) {
  const Cause& cause = *candidate.cause;
  const bool in_gearbox = cause.acts_in_gearbox != nullptr && cause.acts_in_gearbox(candidate.form);
  return in_gearbox ? Place::kGearbox : cause.place;
}

bool changes_row_friction(const Candidate& candidate) { return candidate.form.law == kOnFriction; }

std::size_t value_offset(const Hypothesis& h, std::size_t effect) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < effect; ++k) first += h.effects[k].parameters.size();
  return first;
}

std::span<const double> values_of(const Hypothesis& h, std::size_t effect) {
  return std::span(h.value).subspan(value_offset(h, effect), h.effects[effect].parameters.size());
}

bool has_cause(const Hypothesis& h, const Cause* cause) {
  return std::ranges::any_of(h.effects, [&](const Candidate& c) { return c.cause == cause; });
}

bool same_forms(const Hypothesis& a, const Hypothesis& b) {
  if (a.effects.size() != b.effects.size()) return false;
  return std::ranges::all_of(a.effects, [&](const Candidate& c) {
    return std::ranges::any_of(b.effects, [&](const Candidate& d) {
      return c.cause == d.cause && c.form.name == d.form.name && c.form.order == d.form.order &&
             std::ranges::equal(c.form.constants, d.form.constants, {}, &FormConstant::value,
                                &FormConstant::value);
    });
  });
}

Hypothesis with(Hypothesis h, const Candidate& candidate) {
  h.effects.push_back(candidate);
  h.value.insert(h.value.end(), candidate.parameters.size(), 0.0);
  return h;
}

Hypothesis without(const Hypothesis& h, std::size_t effect) {
  std::vector<bool> stays(h.effects.size(), true);
  stays[effect] = false;
  return subset(h, stays);
}

Hypothesis subset(const Hypothesis& h, const std::vector<bool>& stays) {
  Hypothesis result{.effects = {}, .value = {}, .left_behind = h.left_behind};
  for (std::size_t k = 0; k < h.effects.size(); ++k) {
    if (!stays[k]) continue;
    const auto values = values_of(h, k);
    result.effects.push_back(h.effects[k]);
    result.value.insert(result.value.end(), values.begin(), values.end());
  }
  return result;
}

namespace {

void apply_effect(const Candidate& effect, bool left_behind, std::span<const Scalar> value,
                  const Condition& condition, Kind kind, Modification& m) {
  const Cause& cause = *effect.cause;
  if (!left_behind || cause.leave_behind == nullptr) {
    cause.apply(effect.form, value, condition, kind, m);
    return;
  }
  std::vector<Scalar> left(value.begin(), value.end());
  Condition at = condition;
  cause.leave_behind(effect.form, left, at);
  cause.apply(effect.form, left, at, kind, m);
}

}  // namespace

void apply(const Hypothesis& h, std::span<const Scalar> value, const Condition& condition,
           Kind kind, Modification& m) {
  for (const Candidate& effect : h.effects) {
    const std::size_t count = effect.parameters.size();
    apply_effect(effect, h.left_behind, value.first(count), condition, kind, m);
    value = value.subspan(count);
  }
}

void apply_to_reading(const Hypothesis& h, std::span<const Scalar> value,
                      const Condition& condition, Kind kind, Modification& m) {
  for (const Candidate& effect : h.effects) {
    const std::size_t count = effect.parameters.size();
    if (place_of(effect) == Place::kMeasurement || kind == Kind::kPairLoss) {
      apply_effect(effect, h.left_behind, value.first(count), condition, kind, m);
    }
    value = value.subspan(count);
  }
}

std::vector<Scalar> constants_of(std::span<const double> values) {
  return {values.begin(), values.end()};
}

std::vector<Scalar> variables_of(std::span<const double> values, std::size_t first,
                                 std::size_t count) {
  std::vector<Scalar> result = constants_of(values);
  const std::size_t end = std::min(values.size(), first + count);
  for (std::size_t k = first; k < end; ++k) {
    result[k] = Scalar(values[k], static_cast<int>(k - first));
  }
  return result;
}

}  // namespace gear3k::calibrate
