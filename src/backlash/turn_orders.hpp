#pragma once
// What of lost motion and transmission error repeats with which body's order.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/turn.hpp"
#include "train/shaft_orders.hpp"

namespace gear3k::backlash {

enum class TurnQuantity { kLostMotion, kErrorForward, kErrorBackward };
inline constexpr std::array<std::string_view, 3> kTurnQuantityNames{
    "lost motion", "transmission error forward", "transmission error backward"};

/// Value [rad] of a quantity at a point of its turn.
double value_of(const Turn& turn, const TurnPoint& point, TurnQuantity quantity);

/// An order looked for: a multiple of one of a body or of a stage's teeth.
struct TurnOrder {
  train::ShaftOrder of;
  int multiple = 1;

  [[nodiscard]] double order() const { return multiple * of.order; }
};

/// Those of train::shaft_orders() and train::mesh_orders(), then of the shafts twice and, with more
/// than two planets, N times: what the tightest of N planets decides repeats that often.  An order
/// that stays within one period of an earlier one (or of none) over the window is left out.
std::vector<TurnOrder> turn_order_list(const train::ToothSet& z, int planets, double revolutions);

/// Part of a quantity: amplitude · cos(order φ − phase).
struct OrderPart {
  TurnOrder order;
  double amplitude_rad = 0.0;
  double phase_rad = 0.0;
  /// Of the variance: covariance of the part with the quantity.  Orders that the window leaves
  /// almost orthogonal have amplitude²/2 of it.
  double share = 0.0;
};

/// A quantity as mean and sinusoids by least squares over the points that assemble.
struct OrderFit {
  double mean_rad = 0.0;
  double variance_rad2 = 0.0;  ///< about the mean of the points
  std::vector<OrderPart> parts{};
  double rest = 0.0;  ///< of the variance, what no part explains; 1 with the shares
};

/// The three quantities' fits, in the order of TurnQuantity; empty where fewer points assemble than
/// twice the numbers sought.
/// Solved by QR decomposition, block after block, the last one with column pivoting.
std::vector<OrderFit> turn_orders(const Turn& turn, const std::vector<TurnOrder>& orders);

}  // namespace gear3k::backlash
