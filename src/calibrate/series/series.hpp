#pragma once
// Several gearboxes of one design: what is the design's, what is the part's.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/series/random_effects.hpp"
#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::calibrate {

/// Fewest rows of a gearbox: its noise is taken from them.
inline constexpr std::size_t kFewestUnitRows = 8;

/// Whose a difference from the simulation is.
enum class Origin {
  kDesign,  ///< the same in all gearboxes
  kPart,    ///< differs from gearbox to gearbox about 0
  kBoth     ///< differs from gearbox to gearbox about a mean other than 0
};
inline constexpr std::array<std::string_view, 3> kOriginNames{"design", "part", "both"};

/// A parameter of a cause over the series, in its unit.
struct SeriesParameter {
  std::string name, unit;
  RandomEffects effects{};
  /// Of all parameters' p-values, of means and of deviations together (Holm).
  double p_mean_adjusted = 1.0, p_between_adjusted = 1.0;
  std::optional<Origin> of{};  ///< empty: neither mean nor deviation is told from 0
  std::vector<UnitEstimate>
      units{};                   ///< by gearbox; sd NaN: its rows do not determine the parameter
  std::vector<bool> at_bound{};  ///< by gearbox
};

struct SeriesCause {
  std::string id, title;
  Form form;
  Remedy remedy = Remedy::kFlanks;
  Origin of = Origin::kDesign;
  std::vector<std::string> alternatives{};  ///< ids that explain the series as well in its place
  std::vector<SeriesParameter> parameters{};
};

/// A gearbox of the series.
struct SeriesMember {
  std::string name;
  std::size_t rows = 0;
  int sessions = 0;
  /// Unexplained: it differs from the others by what no cause explains.
  Verdict verdict = Verdict::kNoDiscrepancy;
  std::optional<std::string> unexplained_along{};  ///< covariate; "" = the same in all its rows
  double p_value = 1.0;                            ///< of that difference by luck
};

struct UnitSeries {
  std::vector<SeriesMember> units;
  std::vector<SeriesCause> causes;
  /// Standard deviation between sessions of one gearbox over that of a row; 0: none found.
  double session_ratio = 0.0;
};

/// Diagnoses data of one kind whose files state their gearbox (MeasurementSet::units).
///
/// Causes are searched for in all gearboxes together, with values for each (search_series()); what
/// each value's mean and deviation are says whose the cause is (random_effects()): the mean, the
/// deviation or both differ from 0 at a tenth of the rate of false discoveries, Holm-adjusted over
/// all of them.  A cause of which neither does is dropped.
///
/// The diagnosis is that of all rows less what is the parts' own,
///
///   y_i − [f_i(θ_u) − f_i(θ_u − b_u)],   b_u = τ²/(τ² + s_u²) (θ_u − μ)
///
/// so that gearboxes that differ are no sessions and no noise.  Its row results hold the parts' own
/// again (`extended`, `holdout`); its model has the causes of design and both with the means and
/// their covariance; of one gearbox it is that of diagnose().
/// Limits: values at a bound of the fit (drags from 0 on) count as they stand; what differs between
/// sessions of their own cannot be told from what differs between gearboxes.
/// @returns empty when progress ended it; Diagnosis::series is set
/// @throws std::invalid_argument when no row can be simulated
std::optional<Diagnosis> diagnose_series(const Simulation& simulation, const MeasurementSet& data,
                                         const DiagnoseOptions& options);

/// The gearboxes of a series without a diagnosis of what they have in common: a fraction of the
/// work; laws of a shape that is not searched for (Form::weight 0) are not tried.
/// @throws std::invalid_argument where fewer than two gearboxes can be simulated
UnitSeries find_series(const Simulation& simulation, const MeasurementSet& data,
                       const DiagnoseOptions& options);

/// Gearboxes of a series that have too few rows: a line for each, with files; empty where there is
/// no series.
std::vector<std::string> units_of_few_rows(const MeasurementSet& data);

}  // namespace gear3k::calibrate
