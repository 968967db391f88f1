#pragma once
// The rows that a law is looked for in, as the search works with them.

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calibrate/fit/holdout.hpp"
#include "calibrate/fit/linearisation.hpp"
#include "calibrate/laws/law_forms.hpp"
#include "calibrate/model/law.hpp"

namespace gear3k::calibrate {

/// Residual of a hypothesis on the searched rows, and what of it its own parameters explain.
struct LawData {
  std::vector<std::size_t> rows;  ///< of the data, ascending
  MeasurementSet data;            ///< those rows
  NoiseModel noise;               ///< of those rows
  Eigen::VectorXd simulated;      ///< under the hypothesis [SI]
  Eigen::VectorXd residual;       ///< measured less simulated, whitened
  Eigen::MatrixXd own;            ///< derivatives by the hypothesis' own parameters, whitened
  Eigen::MatrixXd own_basis;      ///< orthonormal, of the same space
  double si = 1.0;                ///< SI value of the unit of amplitudes
  LawScope scope = LawScope::kEveryForm;
};
/// All rows, or 1500 at random (always the same) of more.
LawData law_data(const Problem& problem, const Hypothesis& hypothesis, LawScope scope);

/// The searched rows in a block, or those outside it.
std::vector<Eigen::Index> rows_of(const LawData& d, const Blocks& all, int block, bool inside);

/// What a law's value, in the unit of its amplitude, is multiplied by to change a response.
/// @param response  [SI]  @param si  SI value of that unit
double law_change(LawAction action, const Condition& c, double response, double si);
/// The same by row; 0 where the rows are left out.
Eigen::VectorXd channel_weights(const LawData& d, LawAction action, LawRows rows);

/// What the hypothesis' own parameters leave of the residual.
Eigen::VectorXd left_by_own(const LawData& d);

/// A form with values of its parameters: amplitude, perhaps offset, then those of its factors; once
/// refined, the changes of the hypothesis' own parameters before them.
struct LawTrial {
  Law law;
  std::vector<double> value;
  double gain = 0.0;                ///< squares that it takes off, along the grid
  double sum = 0.0;                 ///< Σ ρ once refined
  int orders = 1;                   ///< that a wave or pulse was chosen from
  double highest_order = HUGE_VAL;  ///< of these; infinite where none were looked through
};

/// How far beyond the range of a condition, over that range, a law is held against its rows and
/// asked for a value of its own.
inline constexpr double kLawReach = 0.25;

/// Whether a law does more where nothing was measured than its rows hold: one of its conditions
/// varied from each row by itself, inside the range of the rows by more than a quarter of what the
/// law differs by in them, a quarter of the range beyond it by more than that difference.
/// @param inside  another share in the place of the quarter
bool exceeds_its_rows(const LawData& d, const LawTrial& trial, double inside = 0.25);

/// Parameters that a form has, its constants among them: they are chosen too.
int law_cost(const Law& law);
/// Parameters of a form that are fitted.
int fitted_count(const Law& law);
/// Own parameters of the hypothesis among a trial's values: none before it is refined.
Eigen::Index own_size(const LawTrial& t);

}  // namespace gear3k::calibrate
