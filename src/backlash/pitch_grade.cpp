#include "backlash/pitch_grade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>

namespace gear3k::backlash {

namespace {

constexpr std::array<double, 9> kModuleEnds_mm{0.5, 2.0, 3.5, 6.0, 10.0, 16.0, 25.0, 40.0, 70.0};
constexpr std::array<double, 13> kDiameterEnds_mm{
    5.0, 20.0, 50.0, 125.0, 280.0, 560.0, 1000.0, 1600.0, 2500.0, 4000.0, 6000.0, 8000.0, 10000.0};

/// Geometric mean of the range that a size lies in (an end belongs to the range below it); empty
/// outside of all.
std::optional<double> range_mean(std::span<const double> ends, double size) {
  // A size that a file states in mm may differ from the end by rounding.
  constexpr double kRounding = 1e-9;
  if (!(size >= ends.front() * (1.0 - kRounding) && size <= ends.back() * (1.0 + kRounding))) {
    return std::nullopt;
  }
  std::size_t upper = 1;
  while (upper + 1 < ends.size() && size > ends[upper] * (1.0 + kRounding)) ++upper;
  return std::sqrt(ends[upper - 1] * ends[upper]);
}

double rounded_um(double um) {
  if (um >= 10.0) return std::round(um);
  if (um >= 5.0) return 0.5 * std::round(2.0 * um);
  return 0.1 * std::round(10.0 * um);
}

}  // namespace

std::optional<PitchTolerances> pitch_grade(const GradedSize& gear, int grade) {
  if (grade < kFinestGrade || grade > kCoarsestGrade) {
    throw std::invalid_argument(fmt::format("pitch_grade: grade = {}, allowed: {} to {}", grade,
                                            kFinestGrade, kCoarsestGrade));
  }
  const auto m = range_mean(kModuleEnds_mm, gear.module_m * 1e3);
  const auto d = range_mean(kDiameterEnds_mm, gear.reference_diameter_m * 1e3);
  if (!m || !d) return std::nullopt;
  const double step = std::exp2(0.5 * (grade - 5));
  const double single = (0.3 * (*m + 0.4 * std::sqrt(*d)) + 4.0) * step;
  const double cumulative = (0.3 * *m + 1.25 * std::sqrt(*d) + 7.0) * step;
  return PitchTolerances{.single_pitch_m = 1e-6 * rounded_um(single),
                         .cumulative_pitch_m = 1e-6 * rounded_um(cumulative),
                         .runout_m = 1e-6 * rounded_um(0.8 * cumulative)};
}

}  // namespace gear3k::backlash
