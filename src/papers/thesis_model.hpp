#pragma once
// The single-tooth model of the directional-impedance thesis on its Table 3.1, and fits of it.

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "efficiency/single_pair_loss.hpp"
#include "papers/thesis_comparison.hpp"

namespace gear3k::papers {

/// Tooth numbers of the loss map: first, last, step.
inline constexpr int kMapFirst = 10, kMapLast = 120, kMapStep = 10;

/// A pair of Table 3.1 that was measured in both directions.
struct MeasuredBothWays {
  MeasuredPairLoss large_drives, small_drives;

  [[nodiscard]] double skew() const { return 0.5 * (large_drives.loss - small_drives.loss); }
  [[nodiscard]] double symmetric() const { return 0.5 * (large_drives.loss + small_drives.loss); }
  [[nodiscard]] double ratio() const {
    return static_cast<double>(large_drives.driving_teeth) / large_drives.driven_teeth;
  }
  [[nodiscard]] int pinion() const { return large_drives.driven_teeth; }
  [[nodiscard]] int gear() const { return large_drives.driving_teeth; }
  [[nodiscard]] std::string name() const { return fmt::format("{}/{}", gear(), pinion()); }
};
std::vector<MeasuredBothWays> measured_both_ways(const std::vector<MeasuredPairLoss>& rows);

/// A pair of full teeth without shift, as the thesis's gears, at a coefficient of friction.
efficiency::SinglePair pair_of(const ThesisStatements& s, const MeasuredPairLoss& m,
                               double friction);

/// Loss, symmetric and skew part over tooth numbers (its Fig. 2-2).
LossMap loss_map(const ThesisStatements& s);

/// The model's symmetric and skew parts on the rows of Table 3.1.
struct Parts {
  Eigen::VectorXd symmetric, skew;
};
Parts parts_of(const ThesisSources& sources, double friction);

Eigen::VectorXd measured_losses(const ThesisSources& sources);

/// Square root of the mean of squares.
double rms(const Eigen::VectorXd& residual);

struct LeastSquares {
  Eigen::VectorXd coefficients;
  double rms_error = 0.0;
};

/// Coefficients of the columns that leave the least squares.
LeastSquares least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& wanted);

/// Least squares of a factor on the symmetric part, an offset, and a factor on one more column.
LeastSquares fit_of_scale(const Parts& parts, const Eigen::VectorXd& third,
                          const Eigen::VectorXd& losses);

/// Bound of the model's range, μ tan α < 1.
double largest_friction(const ThesisStatements& s);

/// The four models of ThesisComparison::models.
std::vector<PairLossModel> loss_models(const ThesisSources& sources);

/// Every row of Table 3.1 with each model's prediction.
std::vector<PairLossRow> loss_rows(const ThesisSources& sources,
                                   const std::vector<PairLossModel>& models);

}  // namespace gear3k::papers
