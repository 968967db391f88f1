#include "calibrate/model/law_doubt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

/// κ
constexpr double kShareInDoubt = 0.35;
constexpr double kWhereAmbiguous = 2.0;

/// Of a quantity that may be 0, as a speed at rest.
double log_ratio(double a, double b) { return a > 0.0 && b > 0.0 ? std::log(a / b) : 0.0; }

double sum_of_shares(const MeshLosses& losses) {
  double sum = 0.0;
  for (const MeshLoss& mesh : losses) sum += mesh.share;
  return sum;
}

}  // namespace

double mean_force(const design::Operation<double>& operation) {
  double sum = 0.0, count = 0.0;
  for (const auto& mesh : operation.mesh) {
    if (!(mesh.normal_force_N > 0.0)) continue;
    sum += std::log(mesh.normal_force_N);
    count += 1.0;
  }
  return count > 0.0 ? std::exp(sum / count) : 1.0;
}

MeshLosses mesh_losses(const design::Operation<double>& operation, design::Direction direction,
                       const efficiency::FrictionExtension<double>& friction,
                       double temperature_K) {
  MeshLosses losses;
  const bool forward = direction == design::Direction::kForward;
  // Either side of the pitch point is known as little as the level.
  const double sides =
      std::max(std::abs(std::log(friction.approach)), std::abs(std::log(friction.recess)));
  for (std::size_t k = 0; k < losses.size(); ++k) {
    const auto& mesh = operation.mesh[k];
    const double load = friction.load_is_torque ? operation.output_torque_Nm : mesh.normal_force_N;
    const double factor =
        efficiency::friction_factor(friction, load, mesh.sliding_speed_m_s, temperature_K, forward);
    losses[k] = {
        .share = operation.input_power_W > 0.0 ? mesh.loss_W / operation.input_power_W : 0.0,
        .normal_force_N = mesh.normal_force_N,
        .sliding_speed_m_s = mesh.sliding_speed_m_s,
        .change = std::max(std::abs(std::log(factor)), sides)};
  }
  return losses;
}

double gain_doubt(const MeshLosses& before, const MeshLosses& after, bool ambiguous) {
  double change = 0.0;
  for (const MeshLosses* losses : {&before, &after}) {
    for (const MeshLoss& mesh : *losses) change = std::max(change, mesh.change);
  }
  const double sum_before = sum_of_shares(before);
  if (!std::isfinite(change)) return std::numeric_limits<double>::infinity();
  if (!(sum_before > 0.0)) return 0.0;
  const double scale = sum_of_shares(after) / sum_before;
  double variance = 0.0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const double a = after[k].share;
    const double b = scale * before[k].share;
    const double distance =
        numerics::square(log_ratio(after[k].normal_force_N, before[k].normal_force_N)) +
        numerics::square(log_ratio(after[k].sliding_speed_m_s, before[k].sliding_speed_m_s));
    const double likeness = std::exp(-0.5 * distance);
    variance += 2.0 * (a * a + b * b) - 2.0 * a * b * (1.0 + likeness);
  }
  return kShareInDoubt * (ambiguous ? kWhereAmbiguous : 1.0) * change *
         std::sqrt(std::max(0.0, variance));
}

}  // namespace gear3k::calibrate
