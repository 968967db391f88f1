#pragma once
// Conditions that some rows state and others lack.

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/measurement/measurement.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

/// Share of the rows that are left out at most because they lack a condition that others state.
inline constexpr double kMostBlank = 0.2;

/// Where some rows state a condition (temperature, time, cycles, angle, module) and others do not,
/// the others would stand for no change by it, whatever it was: causes that follow it would be held
/// against them.  As long as they are few, a fifth of all at most, such rows are left out, for all
/// causes alike.  Else the condition is not used: no cause and no law that follows it is looked
/// for.  The notes name rows and column either way.  Of several conditions the one that fewest rows
/// lack comes first.
///
/// Rows read from torque-angle records state only a time: what else they lack counts neither way.
void settle_blank_conditions(MeasurementSet& set);

/// Whether many rows lack a condition, so that nothing that follows it is looked for.
[[nodiscard]] bool is_unused(const MeasurementSet& set, const ConditionQuantity& quantity);

/// The range of a condition that causes may follow; none of one that is not used.
[[nodiscard]] ValueRange used_range(const MeasurementSet& set, const ConditionQuantity& quantity);

}  // namespace gear3k::calibrate
