#pragma once
// What a simulation and its causes say of the rows of a measurement, with derivatives.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "calibrate/measurement/noise.hpp"
#include "calibrate/model/hypothesis.hpp"
#include "calibrate/model/levelled_responses.hpp"
#include "calibrate/model/row_responses.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate {

/// From here on the rows of one fit are simulated and read in threads; of fewer, several fits are.
inline constexpr std::size_t kManyRows = 2000;

/// Data, simulation and noise that belong together.
struct Problem {
  const Simulation& simulation;
  const MeasurementSet& data;
  NoiseModel noise;
  RowStates states{data.rows};
};

/// Simulated responses and their derivatives, as they are (not weighted).
struct Linearisation {
  Eigen::VectorXd simulated;
  Eigen::MatrixXd own;    ///< by the hypothesis' parameters
  Eigen::MatrixXd other;  ///< by the parameters of further candidates, at 0
  bool runs = true;       ///< false where some row has no simulation
};

/// @param others  candidates to add, each by itself, not of a cause in the hypothesis
Linearisation linearise(const Problem& problem, const Hypothesis& hypothesis,
                        const std::vector<Candidate>& others);

/// A hypothesis beside the data, rows whitened, not scaled.
struct WhitenedRows {
  Eigen::VectorXd residual;   ///< measured − simulated
  Eigen::MatrixXd jacobian;   ///< of the simulated responses by the hypothesis' parameters
  Eigen::VectorXd simulated;  ///< as they are
  bool runs = true;           ///< false where some row has no simulation
};
WhitenedRows whitened_rows(const Problem& problem, const Hypothesis& h);

/// Rows under a hypothesis and near it, of one simulation of the gearbox.
///
/// What acts on the reading, and the level of each row's friction, are as they are at any values;
/// what acts in the gearbox is taken as linear in the change of its parameters, and its derivatives
/// as those of the hypothesis.  The problem outlives it.
class NearbyRows {
 public:
  /// @param room  in ln(level of friction), beyond the levels that the rows have under `about`
  NearbyRows(const Problem& problem, Hypothesis about, double room = 0.0);

  /// Rows whose level is beyond the room have no simulation.
  [[nodiscard]] Linearisation at(const std::vector<double>& value) const;
  [[nodiscard]] WhitenedRows whitened_at(const std::vector<double>& value) const;
  /// Whether nothing that acts in the gearbox differs from the hypothesis.
  [[nodiscard]] bool is_exact_at(const std::vector<double>& value) const;

 private:
  /// Of each row's response, by the parameters that act in the gearbox.
  [[nodiscard]] Eigen::VectorXd change_in_gearbox(const std::vector<double>& value) const;

  /// A row's response before change_in_gearbox(), with derivatives by the parameters [first, end).
  [[nodiscard]] std::optional<Scalar> response_of(std::size_t row, const Scalar& level,
                                                  std::size_t first, std::size_t end) const;
  /// Of the parameters that act in the gearbox, those of one simulation.
  [[nodiscard]] std::span<const std::size_t> acting_of_block(std::size_t block) const;

  const Problem* problem_;
  Hypothesis about_;
  LevelRange levels_;
  std::vector<std::size_t> acting_;         ///< parameters that act in the gearbox
  std::vector<LevelledResponses> gearbox_;  ///< by block of them
};

/// Measured responses.
Eigen::VectorXd measured(const MeasurementSet& data);

}  // namespace gear3k::calibrate
