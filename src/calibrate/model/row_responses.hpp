#pragma once
// The gearbox's responses in the rows of a measurement, with every state of it simulated once.

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate {

/// What tells the gearbox's states in the rows apart (Simulation::response() reads nothing else):
/// a case is direction, rotation, speed, torque and by which sensor, or the pair of gears; a state
/// is a case at a temperature.  Angle, time and session act on the reading of the response only.
struct RowStates {
  /// Of one case with so many temperatures that its responses are interpolated between them.
  struct Interpolation {
    std::size_t of_case = 0;
    double middle_K = 0.0, half_range_K = 0.0;
  };

  explicit RowStates(const std::vector<Observation>& rows);

  std::vector<std::size_t> state_of_row, case_of_state;
  std::vector<Condition> states, cases;  ///< conditions of the first row of each
  std::vector<Interpolation> interpolations;
};

/// What a row that cannot be simulated leaves of the others: all of them, or none, as whoever asks
/// has no use for a part.  Rows that lock take the longest.
enum class MissingRow { kLeavesOthers, kEndsAll };

/// Responses by row.
class RowResponses {
 public:
  /// Of a gearbox that is modified alike in all rows.
  RowResponses(const RowStates& states, const Simulation& simulation, const Modification& gearbox,
               MissingRow missing = MissingRow::kLeavesOthers);

  /// Of every case once, or where the temperature counts of every state once.
  ///
  /// A case with more than 64 temperatures is simulated at 17 of them, the Chebyshev-Lobatto points
  /// T_j = T_m + ΔT cos(π j/16), and interpolated between them: where the polynomial through every
  /// second of them misses the others by 1e-6 of the greatest response, or of a derivative, at most
  /// (that of all is then exact to rounding where the response is smooth over the range, and within
  /// 3e-6 of the greatest response where it has one kink or step; what happens between two
  /// neighbouring points alone is not seen); elsewhere every state is simulated.
  /// @param response  called from several threads
  RowResponses(const RowStates& states, bool reads_temperature, const ResponseAt& response,
               MissingRow missing = MissingRow::kLeavesOthers);

  [[nodiscard]] std::optional<Scalar> of_row(std::size_t row) const;

 private:
  static constexpr std::size_t kPoints = 17;
  /// The case's responses at its points of temperature.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): an optional of it is a member here
  struct Interpolant {
    double middle_K, half_range_K;
    std::array<Scalar, kPoints> value;
  };
  void interpolate_temperatures(const ResponseAt& response);

  /// Simulates value_[place(k)] under condition(k).
  template <class PlaceOf, class ConditionOf>
  void simulate_all(std::size_t count, const ResponseAt& response, PlaceOf place,
                    ConditionOf condition, MissingRow missing);

  const RowStates& states_;
  bool reads_temperature_;
  std::vector<std::optional<Interpolant>> of_case_;  ///< where there is a good one
  std::vector<std::optional<Scalar>> value_;         ///< by case, or of other cases by state
};

}  // namespace gear3k::calibrate
