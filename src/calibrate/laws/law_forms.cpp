#include "calibrate/laws/law_forms.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrate/measurement/commanded_torque.hpp"
#include "calibrate/measurement/condition_quantity.hpp"

namespace gear3k::calibrate {

namespace {

/// More levels than these are thinned out to quantiles.
constexpr std::size_t kMostTried = 10;

std::vector<double> levels_of(std::vector<double> values) {
  std::ranges::sort(values);
  std::vector<double> level = values;
  level.erase(std::unique(level.begin(), level.end()), level.end());
  if (level.size() <= kMostTried) return level;
  level.clear();
  for (std::size_t k = 0; k < kMostTried; ++k) {
    level.push_back(values[(2 * k + 1) * values.size() / (2 * kMostTried)]);
  }
  level.erase(std::unique(level.begin(), level.end()), level.end());
  return level;
}

/// Thresholds between neighbouring values, where there are few, else between quantiles.
std::vector<double> between(const std::vector<double>& level) {
  std::vector<double> result;
  for (std::size_t k = 0; k + 1 < level.size(); ++k) {
    result.push_back(0.5 * (level[k] + level[k + 1]));
  }
  return result;
}

}  // namespace

std::vector<ConditionValues> condition_values(const MeasurementSet& data, LawScope scope) {
  std::vector<ConditionValues> result;
  const auto& conditions = law_conditions();
  const bool plain = scope == LawScope::kPlain;
  const bool load_scatters = plain && is_commanded(data);
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    const LawCondition& condition = conditions[c];
    if (std::ranges::find(condition.kinds, data.kind) == condition.kinds.end()) continue;
    if (plain && condition.of_campaign) continue;
    if (load_scatters && condition.name == kOutputTorque.name) continue;
    ConditionValues values{.condition = c, .value = {}, .level = {}};
    values.value.reserve(data.rows.size());
    for (const Observation& row : data.rows) values.value.push_back(condition.value(row.condition));
    if (!std::ranges::all_of(values.value, [](double x) { return std::isfinite(x); })) continue;
    const auto [low, high] = std::ranges::minmax(values.value);
    if (!(high > low)) continue;
    const bool periodic = condition.turn > 0.0;
    if (condition.natural_zero && !periodic && low < 0.0) continue;
    values.level = levels_of(values.value);
    if (periodic) {
      values.reference = condition.turn;
    } else if (condition.natural_zero) {
      values.reference = high;
    } else {
      values.origin = 0.5 * (low + high);
      values.reference = 0.5 * (high - low);
    }
    result.push_back(std::move(values));
  }
  return result;
}

StepRange::StepRange(const std::vector<double>& rising) {
  constexpr std::size_t kFewest = 4, kShare = 20;
  const std::size_t fewest = std::max(kFewest, rising.size() / kShare);
  if (rising.size() < 2 * fewest) return;
  low = rising[fewest - 1];
  high = rising[rising.size() - fewest];
}

std::vector<TriedFactor> grid_of(LawShape shape, const ConditionValues& values) {
  std::vector<TriedFactor> grid;
  const LawFactor plain{.shape = shape,
                        .condition = values.condition,
                        .origin = values.origin,
                        .reference = values.reference};
  const auto add = [&](double first, double second = 0.0, double constant = 0.0) {
    TriedFactor tried{.factor = plain, .p = {first, second}};
    tried.factor.constant = constant;
    grid.push_back(tried);
  };
  const double span = values.level.back() - values.level.front();
  switch (shape) {
    case LawShape::kPower:
      for (const double a : {-2.0, -1.0, -0.5, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0}) add(a);
      break;
    case LawShape::kExponential:
      for (const double k : {-6.0, -3.0, -1.0, 1.0, 3.0}) add(k);
      break;
    case LawShape::kGrowth:
      for (const double k : {-12.0, -6.0, -3.0, -1.5, 1.5, 3.0, 6.0}) add(k);
      break;
    case LawShape::kSaturation:
      for (const double h : {0.03, 0.1, 0.3, 1.0}) add(h * values.reference);
      break;
    case LawShape::kBell:
    case LawShape::kResonance:
      for (const double centre : values.level) {
        for (const double w : {0.06, 0.12, 0.25, 0.5}) add(centre, w * span);
      }
      break;
    case LawShape::kWindow:
      for (const double centre : values.level) {
        if (!(centre > 0.0)) continue;
        for (const double w : {0.2, 0.4, 0.8}) add(centre, 0.0, w);
      }
      break;
    case LawShape::kRamp:
      for (const double threshold : between(values.level)) add(threshold);
      break;
    case LawShape::kStep: {
      std::vector<double> rising = values.value;
      std::ranges::sort(rising);
      const StepRange steps(rising);
      for (const double threshold : between(values.level)) {
        if (steps.contains(threshold)) add(0.0, 0.0, threshold);
      }
      break;
    }
    case LawShape::kCentred:
      for (const double zero : values.level) add(zero);
      break;
    case LawShape::kWave:
    case LawShape::kPulse:
      break;
  }
  return grid;
}

double preferred_number(double value, int steps) {
  constexpr std::array<double, 10> kDecade{1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0};
  constexpr int kPlaces = static_cast<int>(kDecade.size());
  const int place = static_cast<int>(std::lround(kPlaces * std::log10(value))) + steps;
  const int in_decade = (place % kPlaces + kPlaces) % kPlaces;
  return kDecade[static_cast<std::size_t>(in_decade)] *
         std::pow(10.0, (place - in_decade) / kPlaces);
}

std::vector<LawShape> single_shapes() {
  return {LawShape::kPower,      LawShape::kExponential, LawShape::kGrowth,
          LawShape::kSaturation, LawShape::kBell,        LawShape::kResonance,
          LawShape::kWindow,     LawShape::kRamp,        LawShape::kStep};
}

std::vector<std::array<LawShape, 2>> product_shapes() {
  return {{LawShape::kPower, LawShape::kPower},
          {LawShape::kPower, LawShape::kExponential},
          {LawShape::kExponential, LawShape::kExponential},
          {LawShape::kPower, LawShape::kSaturation},
          {LawShape::kCentred, LawShape::kCentred},
          {LawShape::kWindow, LawShape::kWindow},
          {LawShape::kPower, LawShape::kStep},
          {LawShape::kStep, LawShape::kStep}};
}

std::vector<Channel> channels_of(const MeasurementSet& data, LawScope scope) {
  const auto differ = [&](auto get) {
    return std::ranges::any_of(data.rows, [&](const Observation& row) {
      return get(row.condition) != get(data.rows.front().condition);
    });
  };
  const bool both_ways = data.kind == Kind::kTransmission &&
                         differ([](const Condition& c) { return static_cast<int>(c.direction); });
  const bool both_senses =
      data.kind == Kind::kTransmission && differ([](const Condition& c) { return c.rotation; });
  std::vector<Channel> channels;
  std::vector<LawAction> actions{LawAction::kAdded, LawAction::kShare};
  if (both_ways)
    actions = {LawAction::kLoss, LawAction::kAdded, LawAction::kShareLost, LawAction::kShare};
  channels.reserve(3 * actions.size() + 4);
  for (const LawAction action : actions) channels.push_back({.action = action});
  if (scope == LawScope::kPlain) return channels;
  if (both_senses) {
    for (const LawRows rows : {LawRows::kPositive, LawRows::kNegative}) {
      for (const LawAction action : actions) channels.push_back({.action = action, .rows = rows});
    }
  }
  if (both_ways) {
    // In one direction a loss is no other law than the response itself.
    for (const LawRows rows : {LawRows::kForward, LawRows::kBackward}) {
      for (const LawAction action : {LawAction::kAdded, LawAction::kShare}) {
        channels.push_back({.action = action, .rows = rows});
      }
    }
  }
  return channels;
}

}  // namespace gear3k::calibrate
