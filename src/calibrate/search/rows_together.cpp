#include "calibrate/search/rows_together.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate/fit/fit.hpp"
#include "calibrate/measurement/noise.hpp"
#include "numerics/distributions.hpp"

namespace gear3k::calibrate {

namespace {

/// The rows of a group in its sense.
struct Sense {
  int rows = 0;
  int above = 0, below = 0;         ///< far off with and against it
  double sum = 0.0, squares = 0.0;  ///< of all its rows
  /// Whether the group is off as a whole: more than half of it, or a third while all its rows sum
  /// up to more than such of their own scatter with random signs do once in ten.
  [[nodiscard]] bool is_of_all(int hit) const {
    constexpr double kOnceInTen = 1.645;
    if (2 * hit > rows) return true;
    return 3 * hit >= rows && sum * sum > kOnceInTen * kOnceInTen * squares;
  }
};

Sense sense_of(const Eigen::VectorXd& residual, const Eigen::VectorXd& column, double bound) {
  // What a column leaves where it does not act is rounding.
  constexpr double kActs = 1e-6;
  const double least = kActs * column.cwiseAbs().maxCoeff();
  Sense sense;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    if (!(std::abs(column[i]) > least)) continue;
    ++sense.rows;
    const double along = column[i] > 0.0 ? residual[i] : -residual[i];
    sense.sum += along;
    sense.squares += along * along;
    if (along > bound) ++sense.above;
    if (along < -bound) ++sense.below;
  }
  return sense;
}

/// Of the two tests the share of the probability that the one by signs gets.
constexpr double kOfSigns = 0.8;

/// P that rows off fall into the group as many as here and that its rows agree in how far they are
/// off as they do (Student's t by their own scatter), by the product x of both probabilities,
/// x (1 − ln x) (Fisher).
double chance_alike(int rows, int off, const Sense& sense) {
  double places = 0.0;
  for (int j = std::max(sense.above, sense.below); j <= std::min(off, sense.rows); ++j) {
    places += numerics::hypergeometric_probability(rows, sense.rows, off, j);
  }
  const double of_mean = sense.sum * sense.sum / sense.rows;
  const double about_it = (sense.squares - of_mean) / (sense.rows - 1);
  if (!(about_it > 0.0)) return 1.0;
  const double x = places * f_tail(of_mean / about_it, 1, sense.rows - 1);
  return x > 0.0 ? std::min(1.0, x * (1.0 - std::log(x))) : 0.0;
}

}  // namespace

double chance_together(int rows, int off, int size, int hit) {
  // Beyond the mean the terms of places fall ever faster.
  constexpr double kNothing = 1e-17;
  const double mean = static_cast<double>(size) * off / rows;
  double sum = 0.0;
  for (int j = hit; j <= std::min(off, size); ++j) {
    const double places = numerics::hypergeometric_probability(rows, size, off, j);
    if (j > mean && places <= kNothing * sum) break;
    sum += places * numerics::binomial_upper_tail(j, 0.5, hit);
  }
  return std::min(1.0, 2.0 * sum);
}

std::optional<RowsTogether> rows_together(const Eigen::VectorXd& residual, double scale,
                                          const Eigen::MatrixXd& groups) {
  const auto n = static_cast<int>(residual.size());
  const double bound = kWinsor * scale;
  const auto off = static_cast<int>((residual.array().abs() > bound).count());
  if (off < kFewestTogether || !(scale > 0.0)) return std::nullopt;
  std::optional<RowsTogether> best;
  int looked_at = 0;
  for (Eigen::Index g = 0; g < groups.cols(); ++g) {
    const Sense sense = sense_of(residual, groups.col(g), bound);
    if (sense.rows < kFewestTogether || 2 * sense.rows > n) continue;
    ++looked_at;
    const int hit = std::max(sense.above, sense.below);
    if (hit < kFewestTogether || !sense.is_of_all(hit)) continue;
    const double p = std::min(chance_together(n, off, sense.rows, hit) / kOfSigns,
                              chance_alike(n, off, sense) / (1.0 - kOfSigns));
    if (!best || p < best->p_value) {
      best = RowsTogether{.group = g, .off = hit, .rows = sense.rows, .p_value = p};
    }
  }
  if (best) best->p_value = std::min(1.0, best->p_value * looked_at);
  return best;
}

}  // namespace gear3k::calibrate
