#pragma once
// What an extended model changes in the best design, as `optimize` prints and writes it.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "design/design.hpp"
#include "design/operating_point.hpp"
#include "io/text/json.hpp"
#include "optimize/specification.hpp"

namespace gear3k::report {

/// A value at the model's parameters, with the interval that their covariance gives [SI].
struct ModelEstimate {
  double value = 0.0;
  /// The middle 90 % of what draws of the parameters give, with what the campaign leaves open of
  /// their law (calibrate::gain_doubt) where a gain or a new design is stated; empty where it is
  /// not known.
  std::optional<std::array<double, 2>> ci90;
};

/// A design as the model judges it.
struct JudgedDesign {
  design::Design stated;  ///< as files state it, without the model
  train::ToothSet teeth;
  int planets = 0;
  /// Of backward and forward drive; empty where the gearbox does not run.
  std::optional<ModelEstimate> eta_b, eta_f;
  /// As a test would measure it; empty where the model does not change it.
  std::optional<ModelEstimate> lost_motion_rad;
  bool keeps_lost_motion_limits = true;    ///< those of the specification, with the model
  std::optional<ModelEstimate> objective;  ///< SI
};

/// The best designs of one specification without and with a model, both judged with it.
struct ModelChange {
  optimize::Objective objective = optimize::Objective::kBackwardEfficiency;
  std::optional<design::OperatingPoint<double>> point;  ///< where; empty: by the meshes alone
  JudgedDesign before, after;
  /// objective(after) − objective(before) [SI], whatever the objective's sense; 0 for one design.
  std::optional<ModelEstimate> gain;
  /// What of its interval the parameters' covariance gives, their law taken as right.
  std::optional<std::array<double, 2>> gain_by_parameters;
  /// Equal teeth, lengths to 0.1 µm, and no gain beyond ten of the objective's resolutions.
  bool same_design = false;
  std::uint64_t draws = 0, seed = 0;
  std::string no_intervals;  ///< why there are none; "" where there are
};

/// That change, or why it is not known.
struct ModelComparison {
  std::optional<ModelChange> change;
  std::string missing;       ///< "" where there is a change
  bool interrupted = false;  ///< the search without the model was ended
};

/// Both designs side by side, and the gain.
std::string model_change_table(const ModelComparison& comparison);

/// Member "model_change" of summary.json; null where it is not known.
io::Json model_change_json(const ModelComparison& comparison);

}  // namespace gear3k::report
