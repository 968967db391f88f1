#include "backlash/turn_orders.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "numerics/linear_algebra.hpp"

namespace gear3k::backlash {

namespace {

constexpr Eigen::Index kQuantities = 3;

}  // namespace

double value_of(const Turn& turn, const TurnPoint& point, TurnQuantity quantity) {
  switch (quantity) {
    case TurnQuantity::kLostMotion:
      return point.lost_motion_rad();
    case TurnQuantity::kErrorForward:
      return turn.error_forward_rad(point);
    case TurnQuantity::kErrorBackward:
      break;
  }
  return turn.error_backward_rad(point);
}

std::vector<TurnOrder> turn_order_list(const train::ToothSet& z, int planets, double revolutions) {
  std::vector<TurnOrder> list;
  const auto add = [&](const std::vector<train::ShaftOrder>& orders, int multiple) {
    for (const train::ShaftOrder& of : orders) {
      const TurnOrder added{.of = of, .multiple = multiple};
      const auto near = [&](double other) {
        return std::abs(added.order() - other) * revolutions < 1.0 - 1e-9;
      };
      if (near(0.0) || std::ranges::any_of(list, near, &TurnOrder::order)) continue;
      list.push_back(added);
    }
  };
  const auto shafts = train::shaft_orders(z);
  add(shafts, 1);
  add(train::mesh_orders(z), 1);
  add(shafts, 2);
  if (planets > 2) add(shafts, planets);
  return list;
}

std::vector<OrderFit> turn_orders(const Turn& turn, const std::vector<TurnOrder>& orders) {
  const auto unknowns = 1 + 2 * static_cast<Eigen::Index>(orders.size());
  const auto rows = static_cast<Eigen::Index>(turn.points.size() - turn.jammed);
  if (rows < 2 * unknowns) return {};
  // Rows of the unknowns' factors and the quantities' values are triangularised block by block: the
  // triangle stands for all rows above it.
  const Eigen::Index columns = unknowns + kQuantities;
  constexpr Eigen::Index kRowsAtOnce = 256;
  Eigen::MatrixXd stack = Eigen::MatrixXd::Zero(columns + kRowsAtOnce, columns);
  Eigen::Index filled = columns;
  const auto reduce = [&] {
    if (filled == columns) return;
    stack.bottomRows(columns + kRowsAtOnce - filled).setZero();
    numerics::triangularise(stack);
    filled = columns;
  };
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const TurnPoint& point : turn.points) {
    if (!point.range.assembles()) continue;
    auto row = stack.row(filled++);
    row[0] = 1.0;
    for (std::size_t k = 0; k < orders.size(); ++k) {
      const double angle = orders[k].order() * point.angle_rad;
      const auto at = 1 + 2 * static_cast<Eigen::Index>(k);
      row[at] = std::cos(angle);
      row[at + 1] = std::sin(angle);
    }
    for (Eigen::Index q = 0; q < kQuantities; ++q) {
      row[unknowns + q] = value_of(turn, point, static_cast<TurnQuantity>(q));
      sum[q] += row[unknowns + q];
    }
    if (filled == stack.rows()) reduce();
  }
  reduce();
  const Eigen::Vector3d mean = sum / static_cast<double>(rows);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (const TurnPoint& point : turn.points) {
    if (!point.range.assembles()) continue;
    for (Eigen::Index q = 0; q < kQuantities; ++q) {
      const double off = value_of(turn, point, static_cast<TurnQuantity>(q)) - mean[q];
      squares[q] += off * off;
    }
  }
  const Eigen::MatrixXd factors = stack.topLeftCorner(unknowns, unknowns);
  const numerics::ColumnPivotingQr solver(factors);
  const Eigen::VectorXd factor_sums = factors.transpose() * factors.col(0);
  std::vector<OrderFit> fits;
  fits.reserve(kQuantities);
  for (Eigen::Index q = 0; q < kQuantities; ++q) {
    const auto right = stack.col(unknowns + q);
    const Eigen::VectorXd x = solver.solve(right.head(unknowns));
    const double left = right.segment(unknowns, kQuantities).squaredNorm() +
                        (factors * x - right.head(unknowns)).squaredNorm();
    // Of each unknown its term's covariance with the quantity, times the rows.
    const Eigen::VectorXd together =
        x.cwiseProduct(factors.transpose() * right.head(unknowns) - mean[q] * factor_sums);
    OrderFit fit{.mean_rad = x[0], .variance_rad2 = squares[q] / static_cast<double>(rows)};
    fit.rest = squares[q] > 0.0 ? left / squares[q] : 0.0;
    fit.parts.reserve(orders.size());
    for (std::size_t k = 0; k < orders.size(); ++k) {
      const auto at = 1 + 2 * static_cast<Eigen::Index>(k);
      fit.parts.push_back(
          {.order = orders[k],
           .amplitude_rad = std::hypot(x[at], x[at + 1]),
           .phase_rad = std::atan2(x[at + 1], x[at]),
           .share = squares[q] > 0.0 ? (together[at] + together[at + 1]) / squares[q] : 0.0});
    }
    fits.push_back(std::move(fit));
  }
  return fits;
}

}  // namespace gear3k::backlash
