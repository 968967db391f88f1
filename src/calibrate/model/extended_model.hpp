#pragma once
// A simulation with the causes that measurements have shown: what model.toml holds.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/model/cause.hpp"
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
  /// Of all parameters, cause by cause, row after row.
  std::vector<double> covariance;
  std::vector<ConditionRange> range;  ///< of validity: that of the data
  std::uint64_t fingerprint = 0;      ///< of the data, MeasurementSet::fingerprint
  std::vector<std::string> files;
  /// Of the diagnosis that found it; empty: not known.
  std::optional<Verdict> verdict = std::nullopt;
};

/// Applies the causes to a simulation, one after the other.  Those that belong to the data
/// (sessions, drift) are left out.
void apply_model(const ExtendedModel& model, const Condition& condition, Kind kind,
                 Modification& m);

/// What the causes change in the gearbox; those of sensor and procedure do not.
design::Extension<double> extension_of(const std::vector<ExtendedModel>& models);

}  // namespace gear3k::calibrate
