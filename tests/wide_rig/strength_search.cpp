#include "tests/wide_rig/strength_search.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace gear3k::wide_rig {
namespace {

struct Reached {
  double strength = 0.0;
  bool physical = true;
};

// Bisection between an amplitude that is weak and physical and one that is not.
template <typename Function>
FoundAmplitude bisected(const Function& reached, double low, double high, double wanted) {
  FoundAmplitude best{low, low == 0.0 ? 0.0 : reached(low).strength};
  bool limited = false;  // by what is physical: that limit need not be known well
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const Reached at = reached(middle);
    if (at.physical && at.strength <= wanted) {
      low = middle;
      best = {middle, at.strength};
      if (wanted - at.strength < 1e-7 * wanted) break;
    } else {
      high = middle;
      limited = !at.physical;
    }
    if (std::fabs(high - low) < (limited ? 1e-3 : 1e-9) * std::fabs(high)) break;
  }
  return best;
}

template <typename Function>
FoundAmplitude towards(const Function& reached, double start, double limit, double wanted) {
  double low = 0.0, high = start;
  if (std::fabs(high) > std::fabs(limit)) high = limit;
  for (int i = 0; i < 60; ++i) {
    const Reached at = reached(high);
    // Most effects are nearly proportional to their amplitude: two secants end the search.
    if (at.physical && std::fabs(at.strength - wanted) < 1e-7 * wanted) return {high, at.strength};
    if (!at.physical || at.strength > wanted) {
      if (at.physical && at.strength < 4.0 * wanted) {
        const double next = high * wanted / at.strength;
        const Reached there = reached(next);
        if (there.physical && std::fabs(there.strength - wanted) < 1e-6 * wanted) {
          return {next, there.strength};
        }
        if (there.physical && there.strength <= wanted) low = next;
      }
      break;
    }
    if (high == limit) return {high, at.strength};
    low = high;
    const double growth = at.strength > 0.0 ? wanted / at.strength : 4.0;
    high *= std::clamp(growth, 1.0 + 1e-6, 8.0);
    if (std::fabs(high) > std::fabs(limit)) high = limit;
  }
  return bisected(reached, low, high, wanted);
}

}  // namespace

BenchReading clean_reading(const BenchSubject& subject, const std::string& kind,
                           const BenchRow& row, const std::vector<AppliedEffect>& effects) {
  if (kind == "transmission") return sun_torque(subject, row, effects);
  if (kind == "pair_loss") return pair_loss(subject, row, effects);
  return lost_motion(subject, row, effects);
}

FoundAmplitude amplitude_for(const BenchSubject& subject, const std::string& kind,
                             const std::vector<BenchRow>& rows, const HiddenEffect& effect,
                             double noise_sd, double strength) {
  std::vector<double> without;
  without.reserve(rows.size());
  for (const BenchRow& row : rows) without.push_back(clean_reading(subject, kind, row, {}).value);
  const auto reached = [&](double amplitude) {
    Reached result;
    double square = 0.0;
    const std::vector<AppliedEffect> applied{{&effect, amplitude}};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const BenchReading reading = clean_reading(subject, kind, rows[i], applied);
      if (!reading.physical) {
        result.physical = false;
        break;
      }
      square += (reading.value - without[i]) * (reading.value - without[i]);
    }
    result.strength = std::sqrt(square / static_cast<double>(rows.size())) / noise_sd;
    return result;
  };
  const auto limit = [&](double sign) { return sign > 0.0 ? effect.largest : effect.smallest; };
  const double sign = effect.start < 0.0 ? -1.0 : 1.0;
  const FoundAmplitude first = towards(reached, effect.start, limit(sign), strength);
  if (first.strength > 0.99 * strength || limit(-sign) == 0.0) return first;
  const FoundAmplitude second = towards(reached, -effect.start, limit(-sign), strength);
  return second.strength > first.strength ? second : first;
}

}  // namespace gear3k::wide_rig
