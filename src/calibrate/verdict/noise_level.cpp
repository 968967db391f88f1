#include "calibrate/verdict/noise_level.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "numerics/distributions.hpp"

namespace gear3k::calibrate {

NoiseLevel noise_level(const NoiseModel& noise, const PureError& pure, double scale_of_fit,
                       bool stated_holds) {
  const bool stated = noise.source == NoiseSource::kStated;
  if (stated && stated_holds) return {.scale = 1.0, .source = noise.source};
  constexpr int kEnoughRepeats = 10;
  // Repeats at other angles or times scatter by what varies with those; repeats that agree to the
  // last digit say nothing.
  constexpr double kMost = 1.15;
  if (pure.degrees >= kEnoughRepeats) {
    const double of_repeats = std::sqrt(pure.sum_of_squares / pure.degrees);
    if (of_repeats > noise.least_scale() && of_repeats < kMost * scale_of_fit) {
      return {.scale = of_repeats, .source = NoiseSource::kRepeats};
    }
  }
  return {.scale = scale_of_fit, .source = stated ? NoiseSource::kResiduals : noise.source};
}

bool stated_level_holds(const NoiseModel& noise, const LeftOver& left, bool structure) {
  if (noise.source != NoiseSource::kStated || noise.known_scale() > 0.0) return true;
  constexpr double kChance = 1e-3;
  const int degrees = left.degrees;
  if (degrees < 1) return true;
  const double squares = winsorised(left.whitened, left.scale).squaredNorm();
  if (kAsStated * kAsStated * squares < degrees &&
      1.0 - numerics::gamma_upper(0.5 * degrees, 0.5 * squares) < kChance) {
    return false;
  }
  // Repeats at other angles and times differ by structure, too: beside it nothing tells.
  return structure || chance_of_scatter(noise, left.whitened, degrees) > kChance;
}

namespace {

constexpr std::string_view kScatterMore = "the rows scatter by ";
constexpr std::string_view kStatedMore = "the stated sigma is ";

}  // namespace

bool tells_of_stated_level(const std::string& note) {
  return note.starts_with(kScatterMore) || note.starts_with(kStatedMore);
}

std::string note_on_stated_level(double factor) {
  return factor > 1.0
             ? fmt::format(
                   "{}{:.3g} times the stated sigma: it weighs them against each "
                   "other, and the noise is that of the rows; the sigma is too small, or rows "
                   "differ in what the file does not say",
                   kScatterMore, factor)
             : fmt::format(
                   "{}{:.3g} times what the rows scatter by: it weighs them "
                   "against each other, and the noise is that of the rows",
                   kStatedMore, 1.0 / factor);
}

double chance_of_scatter(const NoiseModel& noise, const Eigen::VectorXd& whitened, int degrees) {
  if (noise.source != NoiseSource::kStated || degrees < 1) return 1.0;
  const double squares = winsorised(whitened, 1.0).squaredNorm();
  if (squares <= kAsStated * kAsStated * degrees) return 1.0;
  // A tenth of the rows far off is outliers, not scatter; the median of n rows is itself uncertain
  // by 1.17/√n of what it is.
  constexpr double kErrors = 2.0 * 1.167;
  const double most = kAsStated * (1.0 + kErrors / std::sqrt(static_cast<double>(degrees)));
  if (noise.deviation_of(whitened) <= most) return 1.0;
  return numerics::gamma_upper(0.5 * degrees, 0.5 * squares);
}

bool noise_is_known(NoiseSource source, const FinalFit& final) {
  constexpr int kFewestDegrees = 8;
  return source != NoiseSource::kResiduals || final.degrees >= kFewestDegrees;
}

}  // namespace gear3k::calibrate
