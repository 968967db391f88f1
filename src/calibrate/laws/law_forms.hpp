#pragma once
// The forms that a law is looked for in, and where its parameters are tried first.

#include <vector>

#include "calibrate/fit/linearisation.hpp"
#include "calibrate/model/law.hpp"

namespace gear3k::calibrate {

/// Which forms are tried.
enum class LawScope {
  kEveryForm,
  /// Those that act in all rows, by conditions that are no time and no scatter of what was read: a
  /// few far rows of one sense, or one hour, look like a law too easily where nothing else tells of
  /// structure.
  kPlain,
};

/// Of the rows: each condition that all of them state and along which they differ.
struct ConditionValues {
  std::size_t condition = 0;             ///< of law_conditions()
  std::vector<double> value;             ///< by row, in the unit of files
  std::vector<double> level;             ///< ascending: the values, or quantiles of many
  double origin = 0.0, reference = 1.0;  ///< of the factors
};
std::vector<ConditionValues> condition_values(const MeasurementSet& data, LawScope scope);

/// A factor with values of its parameters.
struct TriedFactor {
  LawFactor factor;
  std::array<double, 2> p{};
};

/// Thresholds that a step may have: what parts off fewer than 4 of the rows, or a twentieth, is no
/// law but these rows.
/// @param rising  values of the rows, ascending, each as often as it is stated
struct StepRange {
  explicit StepRange(const std::vector<double>& rising);
  [[nodiscard]] bool contains(double threshold) const {
    return threshold > low && threshold < high;
  }
  double low = 0.0, high = 0.0;  ///< empty where there are too few rows
};

/// Places where the search tries a factor of one condition: the grid of its parameters.
std::vector<TriedFactor> grid_of(LawShape shape, const ConditionValues& values);

/// The preferred number (R10 of ISO 3: 1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3, 8, 10, ...) nearest
/// in ratio to a value above 0, or the one so many steps above it: what widths are taken from.
double preferred_number(double value, int steps = 0);

/// Shapes of a law of one condition but for waves and pulses, whose orders are scanned for.
std::vector<LawShape> single_shapes();
/// Shapes that go together in a product, in this order or (if they differ) in the other.
std::vector<std::array<LawShape, 2>> product_shapes();

/// Actions and rows that tell the rows of these data apart: of data of one direction the loss is no
/// other law than the response.
struct Channel {
  LawAction action = LawAction::kAdded;
  LawRows rows = LawRows::kAll;
};
std::vector<Channel> channels_of(const MeasurementSet& data, LawScope scope);

}  // namespace gear3k::calibrate
