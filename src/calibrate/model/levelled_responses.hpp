#pragma once
// The gearbox's responses in rows whose friction stands at levels of their own.

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

/// Responses by row and level of friction.
///
/// Where levels vary the gearbox is simulated at Chebyshev-Lobatto points of ln(level), 5 within a
/// factor of 1.08, 7 within 1.5 and 9 beyond, and the response is the polynomial through them: a
/// smooth function of the level is met to better than 1e-5 of its change over a factor of 4, and
/// its slope to 2e-7 where levels lie within a factor of 1.5.
class LevelledResponses {
 public:
  LevelledResponses(const RowStates& states, const Simulation& simulation,
                    const Modification& gearbox, const LevelRange& levels);

  /// With the derivatives of gearbox and level.
  [[nodiscard]] std::optional<Scalar> of_row(std::size_t row, const Scalar& level) const;
  /// The same with the derivatives of the level alone.
  [[nodiscard]] std::optional<Scalar> by_level(std::size_t row, const Scalar& level) const;

 private:
  std::vector<double> log_level_;  ///< of each set; one set: of any level
  std::vector<RowResponses> at_;
};

}  // namespace gear3k::calibrate
