#include "strength/torque_capacity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

namespace gear3k::strength {

namespace {

constexpr int kGreatestDoublings = 200;
constexpr int kConfirmations = 3;
constexpr int kCapacitySteps = 400;
constexpr int kScansPerOctave = 4;
/// In ln torque, downwards: where factors rise steeply, ratios may even underflow.
constexpr double kGreatestStep = 3.0;

/// The least exponent · ln ratio, by how much the torque may rise, and whose it is.
struct TorqueReserve {
  double logarithm = 0.0;
  std::size_t item = 0;
};
TorqueReserve reserve_at(const SafetyFunction<double>& safeties, double torque_Nm) {
  const std::vector<SafetyRatio<double>> items = safeties(torque_Nm);
  if (items.empty()) throw std::invalid_argument("torque capacity: no safeties");
  TorqueReserve least{.logarithm = std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].exponent < 1) {
      throw std::invalid_argument(fmt::format(
          "torque capacity: exponent of item {} = {}, allowed: 1 and more", i, items[i].exponent));
    }
    // A strength of 0 and less, as of a plastic past the end of its curve, bears no torque at all.
    const double ratio = items[i].ratio;
    const double reserve = ratio <= 0.0 ? -std::numeric_limits<double>::infinity()
                                        : items[i].exponent * std::log(ratio);
    if (std::isnan(reserve)) return {.logarithm = reserve, .item = i};
    if (reserve < least.logarithm) least = {.logarithm = reserve, .item = i};
  }
  return least;
}

/// The capacity below a torque; both as logarithms.
struct FoundTorque {
  double log_torque = 0.0;
  std::size_t governing = 0;
};
/// From a torque at which the reserve is below 0 downwards; empty where there is none from
/// `lowest` on.
std::optional<FoundTorque> capacity_below(
    const std::function<TorqueReserve(double log_torque)>& reserve, double above, double lowest,
    double tolerance) {
  TorqueReserve at_above = reserve(above);
  double below = 0.0;
  TorqueReserve at_below;
  for (;;) {
    if (at_above.logarithm >= -tolerance) {
      return FoundTorque{.log_torque = above, .governing = at_above.item};
    }
    below = above + std::max(at_above.logarithm, -kGreatestStep);
    if (!(below > lowest)) return std::nullopt;
    at_below = reserve(below);
    if (std::isnan(at_below.logarithm)) return std::nullopt;
    if (at_below.logarithm >= -tolerance) break;
    above = below;
    at_above = at_below;
  }
  // Between them: false position (Illinois), and halving where that stalls.
  double weight_above = at_above.logarithm;
  double weight_below = at_below.logarithm;
  int last_side = 0;
  for (int step = 0; step < kCapacitySteps; ++step) {
    if (std::abs(at_below.logarithm) <= tolerance) break;
    double middle = above - weight_above * (above - below) / (weight_above - weight_below);
    if (!(middle > below && middle < above) || step % 8 == 7) middle = 0.5 * (below + above);
    if (!(middle > below && middle < above)) break;
    const TorqueReserve r = reserve(middle);
    if (std::isnan(r.logarithm)) return std::nullopt;
    const int side = r.logarithm >= 0.0 ? -1 : 1;
    if (side < 0) {
      below = middle;
      at_below = r;
      weight_below = r.logarithm;
      if (side == last_side) weight_above *= 0.5;
    } else {
      above = middle;
      weight_above = r.logarithm;
      if (side == last_side) weight_below *= 0.5;
    }
    last_side = side;
    if (std::abs(r.logarithm) <= tolerance) {
      below = middle;
      at_below = r;
    }
  }
  return FoundTorque{.log_torque = below, .governing = at_below.item};
}

}  // namespace

std::optional<TorqueCapacity<double>> torque_capacity(const SafetyFunction<double>& safeties,
                                                      const CapacityOptions& options) {
  if (!(options.start_Nm > 0.0 && std::isfinite(options.start_Nm))) {
    throw std::invalid_argument(
        fmt::format("torque capacity: start = {} N m, allowed: above 0", options.start_Nm));
  }
  // Logarithms of torque from here on.
  const double start = std::log(options.start_Nm);
  const double limit = kGreatestDoublings * std::log(2.0);
  const auto reserve = [&](double log_torque) {
    return reserve_at(safeties, std::exp(log_torque));
  };
  double above = start;
  double high = start;
  for (int confirmed = 0; confirmed <= kConfirmations; high += std::log(2.0)) {
    if (high > start + limit) return std::nullopt;
    const TorqueReserve r = reserve(high);
    if (std::isnan(r.logarithm)) return std::nullopt;
    if (r.logarithm >= 0.0) {
      confirmed = 0;
    } else if (confirmed++ == 0) {
      above = high;
    }
  }
  // The reserve is below 0 at `above`.
  const double step = std::log(2.0) / kScansPerOctave;
  for (;;) {
    const auto found = capacity_below(reserve, above, start - limit, options.tolerance);
    if (!found) return std::nullopt;
    const double last = std::ceil((found->log_torque - start) / step) - 1.0;
    bool falls_short = false;
    for (int n = 0; n < kScansPerOctave * options.scanned_octaves; ++n) {
      const double scanned = start + (last - n) * step;
      if (!(reserve(scanned).logarithm < -options.tolerance)) continue;
      above = scanned;
      falls_short = true;
    }
    if (!falls_short) {
      return TorqueCapacity<double>{.torque_Nm = std::exp(found->log_torque),
                                    .governing = found->governing};
    }
  }
}

TorqueCapacity<Jet1> capacity_with_derivatives(const SafetyFunction<Jet1>& safeties,
                                               const TorqueCapacity<double>& capacity) {
  const Jet1 torque(capacity.torque_Nm);
  const Jet1 turning(capacity.torque_Nm, 0);
  const Jet1 ratio = safeties(torque).at(capacity.governing).ratio;
  const double slope = safeties(turning).at(capacity.governing).ratio.v[0] - ratio.v[0];
  TorqueCapacity<Jet1> result{.torque_Nm = torque, .governing = capacity.governing};
  result.torque_Nm.v = ratio.v * (-1.0 / slope);
  return result;
}

}  // namespace gear3k::strength
