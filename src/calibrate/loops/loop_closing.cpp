#include "calibrate/loops/loop_closing.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate/loops/correlated_noise.hpp"

namespace gear3k::calibrate {
namespace {

/// Loops are compared at their ends when these torques agree within this fraction.
constexpr double kSamePeakFraction = 0.2;

}  // namespace

TorqueAnglePoint point_at_turn(const TorqueAngleRecord& record, std::size_t turn,
                               std::size_t secant) {
  const bool lead = turn >= secant;
  const std::size_t from = lead ? turn - secant : turn;
  const auto count = static_cast<double>(secant + 1);
  const double mean_x = 0.5 * static_cast<double>(secant);
  TorqueAnglePoint mean;
  TorqueAnglePoint slope;
  double sum_xx = 0.0;
  for (std::size_t k = 0; k <= secant; ++k) {
    const double x = static_cast<double>(k) - mean_x;
    sum_xx += x * x;
    mean.torque_Nm += record.torque_Nm[from + k] / count;
    mean.angle_rad += record.angle_rad[from + k] / count;
    slope.torque_Nm += x * record.torque_Nm[from + k];
    slope.angle_rad += x * record.angle_rad[from + k];
  }
  const double x = (lead ? 1.0 : -1.0) * mean_x / sum_xx;
  return {.torque_Nm = mean.torque_Nm + x * slope.torque_Nm,
          .angle_rad = mean.angle_rad + x * slope.angle_rad};
}

std::optional<double> closing_error_rad(const FilteredRecord& f, const Loop& loop) {
  const TorqueAnglePoint start = point_at_turn(f.raw, loop.first_sample, f.secant);
  const TorqueAnglePoint end = point_at_turn(f.raw, loop.last_sample, f.secant);
  const auto& k = start.torque_Nm > 0.0 ? loop.stiffness_positive : loop.stiffness_negative;
  const double rise = end.torque_Nm - start.torque_Nm;
  if (!k || std::abs(rise) > kSamePeakFraction * std::abs(start.torque_Nm)) return std::nullopt;
  return end.angle_rad - start.angle_rad - f.angle_sense * rise / k->stiffness_Nm_rad;
}

double closing_deviation_rad(std::size_t secant, const BranchZero& one, const BranchZero& two) {
  double variance = 0.0;
  for (const BranchZero* branch : {&one, &two}) {
    variance += 4.0 / static_cast<double>(secant + 1) * branch->noise.variance *
                std::max(1.0, variance_inflation(branch->noise));
  }
  return std::sqrt(variance);
}

}  // namespace gear3k::calibrate
