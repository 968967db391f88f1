#include "calibrate/loops/flank_stiffness.hpp"

#include <cmath>

#include "calibrate/loops/correlated_noise.hpp"

namespace gear3k::calibrate {
namespace {

constexpr double kSignificant = 3.0;  ///< standard deviations

}  // namespace

std::optional<std::size_t> loading_branch(const FilteredRecord& f,
                                          const std::vector<Branch>& branches, std::size_t b,
                                          bool positive, double peak_Nm) {
  const std::size_t own = branches[b].rising == positive ? b : b + 1;
  const auto reaches = [&](std::size_t k) {
    const double end = f.once.torque_Nm[branches[k].last];
    return positive ? end > 0.0 && end >= kLoadedFraction * peak_Nm
                    : end < 0.0 && end <= kLoadedFraction * peak_Nm;
  };
  if (reaches(own)) return own;
  if (own >= 2 && reaches(own - 2)) return own - 2;
  return std::nullopt;
}

std::optional<FlankStiffness> flank_stiffness(const FilteredRecord& f, const Branch& branch) {
  const double peak = f.once.torque_Nm[branch.last];
  std::size_t first = branch.last;
  while (first > branch.first && f.choice_Nm[first - 1] / peak >= kStiffnessFrom) --first;
  std::size_t last = first;
  while (last < branch.last && f.choice_Nm[last + 1] / peak <= kStiffnessTo) ++last;
  const std::size_t count = last - first + 1;
  if (count < kFewestFlankSamples) return std::nullopt;
  const double mean_x = 0.5 * static_cast<double>(first + last);
  double mean_t = 0.0;
  double mean_a = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    mean_t += f.raw.torque_Nm[i] / static_cast<double>(count);
    mean_a += f.raw.angle_rad[i] / static_cast<double>(count);
  }
  double torque = 0.0;
  double angle = 0.0;
  double sum_xx = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    const double x = static_cast<double>(i) - mean_x;
    sum_xx += x * x;
    torque += x * (f.raw.torque_Nm[i] - mean_t);
    angle += x * (f.raw.angle_rad[i] - mean_a);
  }
  const double k = angle != 0.0 ? torque / angle : 0.0;
  if (!(k * f.angle_sense > 0.0)) return std::nullopt;
  std::vector<double> residual;
  residual.reserve(count);
  for (std::size_t i = first; i <= last; ++i) {
    residual.push_back(f.raw.torque_Nm[i] - mean_t - k * (f.raw.angle_rad[i] - mean_a));
  }
  const CorrelatedNoise noise = noise_of_line_residuals(residual, 2.0);
  const double deviation =
      std::sqrt(noise.variance * variance_inflation(noise) * sum_xx) / std::abs(angle);
  if (!std::isfinite(deviation) || kSignificant * deviation > std::abs(k)) return std::nullopt;
  return FlankStiffness{.stiffness_Nm_rad = std::abs(k),
                        .standard_deviation_Nm_rad = deviation,
                        .first_sample = first,
                        .last_sample = last};
}

}  // namespace gear3k::calibrate
