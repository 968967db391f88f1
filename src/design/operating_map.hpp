#pragma once
// A gearbox over speed and load: efficiency in both drive directions, drag, back-driving.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "design/evaluation.hpp"
#include "design/operation.hpp"

namespace gear3k::design {

/// What a gearbox does at an operating point.
enum class MapStatus {
  kRuns,
  kHelped,       ///< backward, and only with torque on the sun along its rotation
  kLocks,        ///< no torques are in balance while the train turns
  kNoFriction,   ///< the friction law has no value there
  kNotConverged  ///< no torques were found, close to locking
};
inline constexpr std::array<std::string_view, 5> kMapStatusNames{
    "runs", "helped", "locks", "no_friction_value", "not_converged"};

/// One drive direction at one point.
struct MapPoint {
  MapStatus status = MapStatus::kLocks;
  std::optional<Operation<double>> operation;  ///< empty for kLocks and kNoFriction
  /// efficiency::backdriving_margin() with the friction of this point; backward only, empty where
  /// a mesh has no friction value or no positive efficiency there.
  std::optional<double> backdriving_margin;
  /// Backward: whether R2 would drive the sun there without drags, against the friction of flanks
  /// and planet bearings alone.
  bool drives_sun = false;
};

/// A torque, or why there is none.
struct MapTorque {
  std::optional<double> torque_Nm;
  MapStatus status = MapStatus::kLocks;
  std::string reason;  ///< in words; "" where there is a torque
};

/// Torques that turn the unloaded gearbox.
struct UnloadedTorques {
  MapTorque sun;     ///< at the sun, which drives; R2 free
  MapTorque output;  ///< at R2, which drives; sun free
};

/// Both directions at one speed and load.
struct MapPair {
  OperatingPoint<double> point;
  MapPoint forward, backward;
};
/// The point of a pair in one drive direction.
inline const MapPoint& point_of(const MapPair& pair, Direction direction) {
  return direction == Direction::kForward ? pair.forward : pair.backward;
}

struct OperatingMap {
  std::string name;
  train::ToothSet teeth;
  int planets = 0;
  double ratio = 0.0;
  efficiency::FrictionLaw law = efficiency::FrictionLaw::kConstant;
  double temperature_K = 0.0;
  /// The axes of the grid; points[i * output_torque_Nm.size() + j] is that of sun speed i, torque
  /// j.
  std::vector<double> sun_speed_rad_s, output_torque_Nm;
  std::vector<MapPair> points;
  std::vector<UnloadedTorques> running;  ///< by sun speed
  UnloadedTorques breakaway;             ///< at the onset of motion
  MapPair reference;                     ///< at the operating point, else the grid's most power
  bool reference_given = false;          ///< by the design's operating point
  std::vector<std::string> notes;
};

/// Evaluates a design over the grid that it states.
///
/// Temperature: that of the design's operating point, else 20 °C.  A free sun that R2 cannot drive
/// (backdriving margin not positive) counts as locked, also where no torque at all would balance
/// the motion: any torque would lock it.
/// Source: operate(), drive_free_sun(); docs/theory §24-§26.
/// @returns NotDefined as evaluate(), and for a mesh without contact
/// @throws std::invalid_argument for a grid axis without points, and as evaluate()
std::variant<OperatingMap, NotDefined> make_operating_map(const Design& design);

/// The point of the least backdriving margin on the grid; empty where there is none.
std::optional<MapPair> least_margin(const OperatingMap& map);

}  // namespace gear3k::design
