#pragma once
// Where an extended model is valid, and what of it is the gearbox's own.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/model/extended_model.hpp"

namespace gear3k::calibrate {

/// Ranges of the conditions that data of a kind state.
std::vector<ConditionRange> ranges_of(const MeasurementSet& data);

/// The middle of the range of a model of sun speed and output torque (20 °C where its data state no
/// temperature); empty where there is none.
std::optional<design::OperatingPoint<double>> middle_of_range(
    const std::vector<ExtendedModel>& models);

/// Where a model is to be used, from the least to the greatest.
struct UsedRange {
  std::string where;  ///< "the operating point"
  design::OperatingPoint<double> low, high;
};
/// A line for each quantity that leaves a model's range, with by how much.  The test torque of a
/// lost motion is compared with the output torque.
std::vector<std::string> outside_range(const std::vector<ExtendedModel>& models,
                                       const UsedRange& used);
/// The same of data that are measured under models: those of models of their kind.
std::vector<std::string> outside_range(const std::vector<ExtendedModel>& models,
                                       const MeasurementSet& data);

/// Whether a cause changes the gearbox itself, as extension_of() takes it: not the sensor, the
/// procedure, or what repeats within a revolution.
bool changes_gearbox(const AppliedCause& cause, Kind kind);

/// What of an extension needs an operating point to act on efficiencies: friction by load, speed or
/// temperature, drags and bearings.
bool needs_operating_point(const design::Extension<double>& extension);

/// Causes whose forms hold constants of a black box (torque and speed at its shafts), which mean
/// nothing in a gearbox with teeth.
std::vector<std::string> black_box_causes(const std::vector<ExtendedModel>& models);

/// Causes that act on what a black box has not: by tooth force and sliding, by mesh, by the gear
/// that drives it or by the side of its pitch point; on planets and their bearings, the centre
/// distance, and drags that the design states.
std::vector<std::string> inner_causes(const std::vector<ExtendedModel>& models);

}  // namespace gear3k::calibrate
