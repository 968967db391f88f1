#pragma once
// The gearbox's responses in rows whose friction stands at levels of their own.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/model/row_responses.hpp"

namespace gear3k::calibrate {

/// The levels of friction that rows take, as factors; by default none differs from 1.
struct LevelRange {
  double log_low = 0.0, log_high = 0.0;

  /// With one more level in it, and room around it for derivatives.
  void include(double level);
  [[nodiscard]] bool varies() const { return log_high > log_low; }
  /// Whether a level is in it; any is where none differs.
  [[nodiscard]] bool holds(double level) const;
};

/// Slots that a gearbox's own derivatives may take where levels count: the last one is the level's.
inline constexpr int kSlotsBesideLevel = kMaxVariables - 1;

/// A response with its derivatives.
struct LevelledResponse {
  double value = 0.0;
  Eigen::Matrix<double, kMaxVariables, 1> by_gearbox;  ///< the gearbox's own, by slot
  double by_level = 0.0;

  /// With the derivatives of a level, and of the gearbox if wanted.
  [[nodiscard]] Scalar at(const Scalar& level, bool with_gearbox) const;
};

/// Responses by row and level of friction.
///
/// Where levels vary the gearbox is simulated at three of them x_j, the least, the greatest and
/// their geometric mean, with the slope by the level.  The response is Hermite's polynomial through
/// values y_j and slopes y'_j, its derivatives by the gearbox Lagrange's:
///
///   y(x) = Σ ℓ_j² ((1 − 2 ℓ'_j(x_j) (x − x_j)) y_j + (x − x_j) y'_j)
///   ∂y/∂p = Σ ℓ_j ∂y_j/∂p
///
/// Accuracy over a range of a factor of 4, friction with an exponent of the load of −0.3 and drags:
/// 1e-7 of the response's change, slope by the level 1e-6, derivatives by the gearbox 3e-5 of the
/// greatest.  Where the power of a mesh turns round within the range the response has a bend, which
/// is rounded off.
class LevelledResponses {
 public:
  /// @param gearbox  without derivatives in the last slot
  /// @param missing  kEndsAll: where a row has no response, of no row may there be any
  LevelledResponses(const RowStates& states, const Simulation& simulation,
                    const Modification& gearbox, const LevelRange& levels,
                    MissingRow missing = MissingRow::kLeavesOthers);

  /// Beyond the levels the response stays as it is.
  [[nodiscard]] std::optional<LevelledResponse> of_row(std::size_t row, double level) const;

 private:
  std::vector<double> level_;  ///< of each set; one set: of any level
  std::vector<RowResponses> at_;
};

}  // namespace gear3k::calibrate
