#pragma once
// What sessions, time and cycles can change: the reading as a whole, or what makes it.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/causes/friction_change.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate {

/// Where a change acts.  Wear and running-in change friction, which loses power in proportion to
/// the load: more torque at the sun forward, less backward.
enum class Target {
  kAdded,     ///< to the magnitude of the response
  kFriction,  ///< of the meshes, as a share of it
  kGain,      ///< of the sensor
  kOffset,    ///< of the sensor, in its own sign
  kDrag       ///< at the sun: adds forward, takes away backward
};

struct TargetRecord {
  Target target;
  std::string_view law;  ///< "" of what is added
  double weight;         ///< before the data
};

/// The targets that data of a kind have; what is added comes first.
inline std::vector<TargetRecord> targets_of(Kind kind) {
  std::vector<TargetRecord> result{{Target::kAdded, "", 0.4}};
  if (kind == Kind::kTransmission || kind == Kind::kPairLoss) {
    result.push_back({Target::kFriction, kOnFriction, 0.3});
  }
  if (kind == Kind::kTransmission) {
    result.push_back({Target::kGain, kOnGain, 0.25});
    result.push_back({Target::kOffset, kOnOffset, 0.25});
    result.push_back({Target::kDrag, kOnDrag, 0.2});
  }
  return result;
}

/// Form of sensor_offset: the load at the output is another one by the same in all rows.
inline constexpr std::string_view kOutputMagnitude = "output_magnitude";

/// A form with a value for every session, and how many it can tell apart.
inline constexpr const char* kSessions = "sessions";
inline constexpr std::size_t kMostSessions = 16;
inline bool gives_each_session_a_value(const Form& form) {
  return form.name.find(kSessions) != std::string::npos;
}

/// Of a drift, what all rows have in common: a constant of its own.
inline constexpr std::string_view kStartChange = "start_change";
inline bool has_start_parameter(const std::vector<ParameterRecord>& parameters) {
  return std::ranges::any_of(parameters,
                             [](const ParameterRecord& r) { return r.name == kStartChange; });
}

/// The name of a form that acts on a target: "linear_time", "linear_time_friction".
inline std::string targeted(std::string name, const TargetRecord& target) {
  if (!target.law.empty()) name += "_" + std::string(target.law);
  return name;
}

/// @param form_name  or a law by itself
inline Target target_of(std::string_view form_name) {
  if (form_name.ends_with(kOnFriction)) return Target::kFriction;
  if (form_name.ends_with(kOnGain)) return Target::kGain;
  if (form_name.ends_with(kOnOffset)) return Target::kOffset;
  if (form_name.ends_with(kOnDrag)) return Target::kDrag;
  return Target::kAdded;
}

/// The greatest change of a sensor's gain by session or time, an assumption.
inline constexpr double kMostGainChange = 0.2;

/// A parameter that is a change of a target: of friction and gain a share, else in the unit of the
/// response.
inline ParameterRecord change_parameter(std::string_view name, Target target, Kind kind) {
  constexpr double kFar = 1e4;
  switch (target) {
    case Target::kFriction:
      return {.name = name,
              .unit = "",
              .lower = kLeastChange,
              .upper = kMostChange,
              .plausible_low = kSomeFriction,
              .plausible_high = kMostChange};
    case Target::kGain:
      return {.name = name,
              .unit = "",
              .lower = -0.9,
              .upper = 9.0,
              .plausible_low = -kMostGainChange,
              .plausible_high = kMostGainChange};
    case Target::kAdded:
    case Target::kOffset:
    case Target::kDrag:
      break;
  }
  // A loss is a share itself.
  const double plausible = kind == Kind::kPairLoss ? 0.1 : kFar;
  return {.name = name,
          .unit = response_unit(kind).name,
          .lower = -kFar,
          .upper = kFar,
          .plausible_low = -plausible,
          .plausible_high = plausible};
}

/// @param change  in the unit of change_parameter()
inline void change_reading(Target target, const Scalar& change, const Condition& condition,
                           Kind kind, Modification& m) {
  const double si = response_unit(kind).si;
  switch (target) {
    case Target::kAdded:
      m.added = m.added + change * si;
      return;
    case Target::kFriction:
      m.friction_level = m.friction_level * (1.0 + change);
      return;
    case Target::kGain:
      m.sensor_gain = m.sensor_gain * (1.0 + change);
      return;
    case Target::kOffset:
      m.sensor_offset = m.sensor_offset + change * si;
      return;
    case Target::kDrag:
      m.added =
          m.added + (condition.direction == design::Direction::kForward ? 1.0 : -1.0) * change * si;
      return;
  }
}

}  // namespace gear3k::calibrate
