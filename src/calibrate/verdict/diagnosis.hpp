#pragma once
// From measurements to what the simulation gets wrong: verdict, causes, gain, next experiment.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/fit/holdout.hpp"
#include "calibrate/fit/parameter_results.hpp"
#include "calibrate/laws/law_result.hpp"
#include "calibrate/measurement/noise.hpp"
#include "calibrate/model/extended_model.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate {

enum class Verdict { kNoDiscrepancy, kExplained, kAmbiguous, kUnexplained };
inline constexpr std::array<std::string_view, 4> kVerdictNames{"no_discrepancy", "explained",
                                                               "ambiguous", "unexplained"};

struct DiagnoseOptions {
  double false_discovery_rate = 0.05;  ///< of all findings together where nothing is wrong
  std::uint64_t seed = 1;
  /// Limits of the next experiment; by default what the design's map spans, and the data
  /// widened by a quarter.
  std::optional<std::array<double, 2>> sun_speed_rad_s, output_torque_Nm, test_torque_Nm,
      temperature_K;
  /// Told now and then how far the work is, 0 to 1; returning false ends it (the result is then
  /// empty).
  std::function<bool(double)> progress;
};

/// Another cause that explains these data as well in place of an effect.
struct Alternative {
  std::string id;
  std::string title;
  Form form;
  bool with_level = false;  ///< together with another coefficient of friction
  double statistic = 0.0;   ///< its χ² less that of the effect
  double probability = 0.0;
  std::vector<ParameterResult> parameters;
  Remedy remedy = Remedy::kFlanks;
};

struct Effect {
  std::string id;
  std::string title;
  Form form;
  Remedy remedy = Remedy::kFlanks;
  std::vector<ParameterResult> parameters;
  std::vector<Alternative> alternatives;  ///< most likely first
  std::vector<Alternative> other_bodies;  ///< the same cause elsewhere, as good as here
  double delta_bic = 0.0;  ///< of the model without it less that with it; > 0 speaks for it
  /// That this cause is behind it, that one of the alternatives is, that none of the library is:
  /// as often right as stated on simulated campaigns (docs/theory §30).
  double probability = 0.0, no_cause = 0.0;
  double inclusion_frequency = 0.0;  ///< share of subsamples that find it or an alternative
  double p_value = 1.0;              ///< of a gain as great where there is nothing
  /// It could not be told from a missing effect and is preferred because it is a parameter.
  bool preferred_parameter = false;

  /// Whether it is likelier that no cause of the library is behind it.
  [[nodiscard]] bool is_doubtful() const { return no_cause > 0.5; }
};

/// Evidence of each cause as the first effect, for the figure.
struct CauseEvidence {
  std::string id;
  double delta_bic = 0.0;  ///< of the best form by itself against the baseline
  double evidence = 0.0;   ///< −ln p by itself
};

/// How well a model tells rows apart by one covariate.
struct CovariateTest {
  std::string name;  ///< "load", "speed", "angle", ...
  double statistic = 0.0;
  int degrees = 0;
  /// Of the clearer of two tests, by levels and by what they lose, doubled; along angle and time
  /// times the number of orders.
  double p_value = 1.0;
};

/// Lomb-Scargle periodogram of the residuals over the output's angle.
struct Periodogram {
  std::vector<double> order, power;  ///< power: share of the variance, 0 to 1
};

/// Structure that no cause explains.
struct Remainder {
  bool significant = false;
  bool minor = false;     ///< more than noise makes, too little of the discrepancy to matter
  std::string along;      ///< covariate; "" = none
  bool constant = false;  ///< the same in all rows
  double p_value = 1.0;
  double order = 0.0;  ///< along "angle": per output revolution; along "time": per span
  /// Its shape: the best empirical term, over the covariate's values [in the column's unit], with
  /// the mean residual there, the fitted term and the number of rows.
  std::vector<double> at, mean, term;
  std::vector<int> rows;
  double share = 0.0;  ///< of the residual variance that the term takes off
};

/// A cause as a formula where nothing explains, or where one refitted parameter predicts held-out
/// rows better than the causes: it predicts, and says nothing of why.
struct Correction {
  std::string id;
  Form form;
  std::vector<ParameterResult> parameters;
  double held_out_error = kUnknown;  ///< root mean square of rows held out of its fit [SI]
  double held_out_gain = kUnknown;   ///< 1 − that over the same of the simulation as given
};

/// The best refit of one parameter (coefficient of friction, clearance or gain) against what was
/// found, in rows held out of either, over the blocks of all conditions that have some.
struct RefitComparison {
  std::string id;
  double refit_error = kUnknown;  ///< root mean square [SI]
  double found_error = kUnknown;  ///< of causes, law or correction, else of the simulation as given
  bool predicts = false;          ///< the model predicts by the refit, as it is the better one
};

struct RowResult {
  double baseline = 0.0, extended = 0.0;  ///< simulated [SI]
  double sigma = 0.0;                     ///< of the row [SI]
  double holdout = kUnknown;  ///< predicted by the extended model fitted without the row's block
  int block = -1;             ///< that was left out with it
  bool outlier = false;       ///< beyond four standard deviations of what is left
};

struct Errors {
  double baseline_train = 0.0, extended_train = 0.0;
  double baseline_holdout = kUnknown, extended_holdout = kUnknown;  ///< NaN: too few blocks
  double noise_floor = 0.0;  ///< NaN: nothing found in rows too few to tell their noise
  /// 1 − extended/baseline of held-out rows, each over its own σ; NaN where rows count alike.
  double weighted_gain = kUnknown;
};

/// A condition to measure next.
struct ProposedCondition {
  Condition condition;
  int repeats = 1;
};

struct NextExperiment {
  std::vector<std::string> separates;  ///< ids
  std::vector<ProposedCondition> conditions;
  /// Expected χ² between the closest two of them after the measurement, those left out that no
  /// condition tells apart; 9 tells them apart.
  double expected_statistic = 0.0;
  /// Pairs that even all possible conditions together, measured often, would not tell apart.
  std::vector<std::array<std::string, 2>> inseparable;
  std::string advice;  ///< in words, e.g. where only a calibrated sensor can tell
};

struct UnitSeries;  // series/series.hpp

/// Result for the data of one kind.
struct Diagnosis {
  Kind kind = Kind::kTransmission;
  std::string subject;  ///< name of the gearbox
  Verdict verdict = Verdict::kNoDiscrepancy;
  std::vector<Effect> effects;
  std::vector<LawResult> laws;    ///< where the verdict is unexplained: at most one
  Errors errors;                  ///< root mean squares, SI
  std::vector<std::string> runs;  ///< sessions with a row that runs, as forms count them
  std::string holdout_blocks;     ///< "load", "speed", "run", "pinion", "angle", "test torque"
  Extrapolation extrapolation;
  NoiseSource noise_source = NoiseSource::kResiduals;
  double stated_noise = kUnknown;  ///< of a typical row as the data state it [SI]
  int repeat_degrees = 0;
  double session_deviation = 0.0;  ///< standard deviation between sessions [SI]; 0 = none found
  MemoryEstimate memory;           ///< how the noise remembers
  LackOfFit lack_of_fit;           ///< of the baseline
  LackOfFit lack_of_model;         ///< of the extended model; nothing where it has no parameters
  double p_value = 1.0;            ///< of the greatest finding where nothing is wrong
  /// What the model predicts by: where structure is left and neither a cause nor a law stands, and
  /// where one refitted parameter predicts better than what was found.
  std::optional<Correction> correction;
  std::optional<RefitComparison> refit;  ///< none where the model is such a refit, or has no blocks
  std::vector<CauseEvidence> evidence;
  std::vector<CovariateTest> covariates_before, covariates_after;
  /// Conditions that are told by the session alone, beside a step or drift that is named.
  std::vector<std::string> conditions_by_session;
  Periodogram periodogram;
  Remainder remainder;
  std::optional<NextExperiment> next_experiment;
  ExtendedModel model;
  /// Of the output at the greatest test torque [N m/rad], where the simulation winds up by the
  /// springs of [strength].
  std::optional<double> springs_Nm_rad;
  std::vector<RowResult> rows;  ///< as in the data
  std::vector<std::string> notes;
  std::shared_ptr<const UnitSeries> series;  ///< where the files state their gearbox, else null
};

/// Diagnoses the data of one kind, the readings taken for what they are.
/// @returns empty when progress ended it
/// @throws std::invalid_argument when no row can be simulated
std::optional<Diagnosis> diagnose_as_read(const Simulation& simulation, const MeasurementSet& data,
                                          const DiagnoseOptions& options);

/// The same; where something is found in readings of coarse steps, readings as they may have been
/// before rounding if the simulation as given is right (before_rounding()) are diagnosed too.  If
/// nothing is found in them, that is the answer: errors and σ are of the readings themselves, all
/// else of those before rounding.  If something else is found, a note says what.
std::optional<Diagnosis> diagnose(const Simulation& simulation, const MeasurementSet& data,
                                  const DiagnoseOptions& options);

}  // namespace gear3k::calibrate
