#pragma once
// A simulation with the causes that measurements have shown: what model.toml holds.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/model/cause.hpp"
#include "calibrate/model/law.hpp"
#include "design/extension.hpp"

namespace gear3k::calibrate {

enum class Verdict;  // diagnosis.hpp

/// A cause with its fitted parameters.
struct AppliedCause {
  std::string id;
  Form form;
  std::vector<double> value;  ///< in units of the cause's parameters
  /// Ids of the causes that explained the data as well in its place.
  std::vector<std::string> alternatives = {};
  /// Names of its parameters, derived ones too, whose values no gearbox shows.
  std::vector<std::string> implausible = {};
  /// A formula that predicts what nothing explains, no finding.
  bool empirical = false;
  /// The one change of all rows that later measurements are expected to meet, where the campaign
  /// does not tell what goes on (change_left_behind()); NaN: as Cause::leave_behind says.
  double left_behind = kUnknown;
  /// What it changes: one of kOnFriction to kOnDrag, "" the response [of friction and gain a share,
  /// else in the unit of the response].
  std::string left_behind_on = {};
};

/// Range of a condition in the data; NaN = the data do not state it.
struct ConditionRange {
  std::string name, unit;  ///< a column's name without its unit, and the unit as in the column
  double low = 0.0, high = 0.0;
};

struct ExtendedModel {
  std::string name;  ///< of the gearbox that was measured
  Kind kind = Kind::kTransmission;
  std::vector<AppliedCause> causes;
  /// What no cause explains; they change readings, not the gearbox.
  std::vector<AppliedLaw> laws = {};
  /// Of all parameters, cause by cause and law by law, row after row.
  std::vector<double> covariance;
  std::vector<ConditionRange> range;  ///< of validity: that of the data
  std::uint64_t fingerprint = 0;      ///< of the data, MeasurementSet::fingerprint
  std::vector<std::string> files;
  /// Of the diagnosis that found it; empty: not known.
  std::optional<Verdict> verdict = std::nullopt;
  /// The simulation that was measured wound up by the springs of [strength]: a cause `compliance`
  /// counts beyond them.
  bool beyond_springs = false;
};

/// Of all causes, then of all laws: the covariance has as many rows.
std::size_t parameter_count(const ExtendedModel& model);

/// Applies the causes to a simulation, one after the other, then the laws of the same kind of data;
/// drift, sessions and laws over time or cycles as the campaign left them behind
/// (Cause::leave_behind, as_left_behind()).
void apply_model(const ExtendedModel& model, const Condition& condition, Kind kind,
                 Modification& m);

/// Whether a model's cause `compliance` is all of the wind-up.
bool has_whole_windup(const std::vector<ExtendedModel>& models);

/// What the causes change in the gearbox; those of sensor and procedure do not.
design::Extension<double> extension_of(const std::vector<ExtendedModel>& models);

}  // namespace gear3k::calibrate
