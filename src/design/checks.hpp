#pragma once
// The registry of checks.  One record per check feeds the report's row, the optimiser's constraint,
// the named rejection and the key in [limits].

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/lost_motion.hpp"
#include "geometry/tooth_form.hpp"
#include "strength/train_rating.hpp"
#include "train/axial_layout.hpp"
#include "train/thermal_growth.hpp"
#include "train/train_geometry.hpp"
#include "units/units.hpp"

namespace gear3k::design {

using units::Unit;

/// What one value of a check belongs to.
enum class CheckScope {
  kGear,
  kExternalGear,
  kRing,
  kCutRing,     ///< a ring that is shaped by a cutter
  kWalledGear,  ///< a gear whose bore, of a ring whose outer surface, is known
  kListedGear,  ///< a gear whose tooth number is to be one of a list
  kSun,
  kMesh,
  kInternalMesh,
  kTip,         ///< a mesh and the one of its gears whose tip is examined (1 or 2); no pinion tips
  kMember,      ///< a mesh and one of its gears (1 or 2)
  kPlanetStep,  ///< P1 or P2 against its neighbour
  kBodyPair,    ///< two bodies that overlap along the axis
  kTrain,
  kSizedTrain,     ///< a train whose length along the axis is known
  kRatedTooth,     ///< a mesh and one of its gears, where a load is stated (1 or 2)
  kRatedMesh,      ///< a mesh, where a load is stated
  kPlanetBearing,  ///< A or B of a planet, where a load is stated
  kPlanetPin,      ///< where a load is stated
  kThermalMesh,    ///< a mesh at an end of the temperatures, where these are stated
  kThermalMember,  ///< the same and one of its gears (1 or 2)
  kThermalTrain    ///< a train, likewise
};

enum class CheckId {
  kUndercut,
  kTipThickness,
  kRingTipThickness,
  kRingTipOutsideBase,
  kInvoluteInterference,
  kFormCircle,
  kTipFouling,
  kRootClearance,
  kTrochoidInterference,
  kTrimming,
  kRingCutter,
  kPlanetGap,
  kBodyGap,
  kContactRatioMin,
  kContactRatioMax,
  kCoaxiality,
  kNormalBacklash,
  kOutputBacklashMin,
  kOutputBacklashMax,
  kRingRootDiameter,
  kEqualSpacing,
  kIdenticalPlanets,
  kRootSafety,
  kFlankSafety,
  kOverloadRootSafety,
  kOverloadFlankSafety,
  kDynamicSpeed,
  kShiftSumRange,
  kHardnessRange,
  kToothTemperature,
  kToothWear,
  kRimThickness,
  kNotchRange,
  kBearingLoad,
  kPinStress,
  kTipThicknessLength,
  kRootClearanceLength,
  kSpecificSliding,
  kWall,
  kGearboxDiameter,
  kGearboxLength,
  kSunRootDiameter,
  kSameModule,
  kHuntingTooth,
  kAllowedTeeth,
  kThermalBacklash,
  kThermalRootClearance,
  kThermalLostMotion
};
inline constexpr std::size_t kCheckCount = 48;

/// Tooth numbers to choose from, by gear; an empty list allows all.
using AllowedTeeth = std::array<std::vector<int>, train::kGearCount>;

/// What is stated of a train besides its teeth.
template <class T>
struct TrainBodies {
  std::array<double, train::kGearCount> bore_radius_m{};  ///< of external gears; 0: no bore
  /// Of R1 and R2, where it is stated.
  std::array<std::optional<double>, 2> ring_outer_radius_m{};
  double ring_rim_m = 0.0;          ///< of rings outside their root circles, where it is not
  std::array<T, 2> face_width_m{};  ///< by stage; 0 where it is not stated
  const AllowedTeeth* allowed_teeth = nullptr;
};

/// What the checks look at: a whole train, or one pair.
template <class T>
struct Gearing {
  std::span<const geometry::GearGeometry<T>> gears;
  std::span<const geometry::MeshGeometry<T>> meshes;
  std::span<const std::array<int, 2>> mesh_gears;
  std::span<const T> normal_backlash_m;
  /// Root of each gear; empty where no check needs it (CheckRecord::tooth_form).
  std::span<const geometry::ToothForm<T>> forms;
  const train::TrainGeometry<T>* train = nullptr;  ///< null for a pair
  const train::AxialLayout* axial = nullptr;       ///< null where nothing is known of it
  const TrainBodies<T>* bodies = nullptr;          ///< likewise
  backlash::LostMotionModel model = backlash::LostMotionModel::kKinematic;
  /// By mesh; empty where no load is stated or no check needs it (CheckRecord::rating).
  std::span<const strength::MeshRating<T>> rating{};
  const strength::TrainRating<T>* train_rating = nullptr;  ///< likewise; null for a pair
  const train::ThermalRange* thermal = nullptr;            ///< null where none is stated
};

/// One value of one check: which gear (kExternalGear, kRing, kCutRing, kPlanetStep), mesh (kMesh,
/// kInternalMesh, kTip, kMember) or pair of bodies (kBodyPair, index into train::kPassingBodies).
struct CheckSubject {
  int member = 0;
  /// kTip, kMember: the gear of the mesh, 1 or 2.  Output backlash: 0 the whole model, 1 or 2 one
  /// branch of the paper's max(φ_2, φ_3), smooth each.
  int which = 0;
  int end = 0;  ///< kThermal...: see train::end_state()
};

template <class T>
using CheckValue = T (*)(const Gearing<T>&, CheckSubject);

struct CheckRecord {
  CheckId id;
  std::string_view name;   ///< in JSON, in rejections and in [limits]
  std::string_view title;  ///< in tables
  std::string_view group;  ///< what tables put together
  Unit unit;
  CheckScope scope;
  bool at_least;                        ///< value ≥ limit; else value ≤ limit
  std::optional<double> default_limit;  ///< in `unit`; empty = off unless asked for
  /// Limit of a check that is off by default and switched on without a number; empty: none.
  std::optional<double> switched_limit = std::nullopt;
  bool threshold = true;  ///< a limit may be stated; else the check is only on or off
  /// Key outside [limits] that sets the limit, e.g. "backlash.max_output_arcmin"; "" = [limits].
  std::string_view limit_key;
  bool tooth_form = false;  ///< its value needs Gearing::forms
  bool rating = false;      ///< its value needs Gearing::rating
  std::string_view help;
  CheckValue<double> value = nullptr;
  CheckValue<Jet1> value1 = nullptr;
  CheckValue<Jet2> value2 = nullptr;
};

std::span<const CheckRecord> check_records();
const CheckRecord& check_record(CheckId id);

/// What a workshop can make, as a set of limits (preset.hpp).
enum class Preset { kBare, kMachined, kPrinted };
inline constexpr std::array<std::string_view, 3> kPresetNames{"bare", "machined", "printed"};

/// Limits in force, in SI, by check; an empty one switches the check off.  Those of safeties are by
/// how much each must exceed the least one that the load's RatingTask asks for.
struct Limits {
  std::array<std::optional<double>, kCheckCount> limit;
  backlash::LostMotionModel model = backlash::LostMotionModel::kKinematic;
  /// Least normal backlash of one mesh [m], in place of that of all.
  std::array<std::optional<double>, train::kMeshCount> mesh_backlash_m{};
  /// Meshes that CheckId::kHuntingTooth is asked of; empty: all.
  std::vector<train::MeshId> hunting_meshes{};
  AllowedTeeth allowed_teeth{};
  std::optional<Preset> preset{};  ///< that the file names
  /// Limits of a workshop that neither the file nor a preset states.
  std::vector<CheckId> bare{};

  const std::optional<double>& operator[](CheckId id) const {
    return limit[static_cast<std::size_t>(id)];
  }
  std::optional<double>& operator[](CheckId id) { return limit[static_cast<std::size_t>(id)]; }
};
Limits default_limits();

/// Whether CheckId::kHuntingTooth is asked of a mesh, where it is on.
bool hunts(const Limits& limits, std::size_t mesh);

/// Least normal backlash that a mesh is to have [m]; empty: none.
std::optional<double> least_backlash_m(const Limits& limits, std::size_t mesh);

/// A check to be evaluated on one subject.
struct CheckInstance {
  const CheckRecord* record = nullptr;
  CheckSubject subject;
  double limit = 0.0;  ///< SI
  double scale = 1.0;  ///< SI; feasible means margin ≥ −kFeasibilityTolerance · scale
  std::string at{};    ///< of kThermal...: "60 C", else ""
};
inline constexpr double kFeasibilityTolerance = 1e-6;
/// What bounds of feasible designs allow for: they may miss a limit by kFeasibilityTolerance of its
/// scale, and rounding.
inline constexpr double kFeasibilitySlack = 2.0 * kFeasibilityTolerance;

/// Kinds of gears and meshes that a list of checks is made for.
struct GearingLayout {
  std::span<const geometry::GearKind> gear_kinds;
  std::span<const std::array<int, 2>> mesh_gears;
  std::vector<bool> shaped{};         ///< by gear: a ring shaped by a cutter
  std::vector<int> passing_bodies{};  ///< indices into train::kPassingBodies that overlap
  std::vector<bool> walled{};         ///< by gear: its bore, of a ring its outer surface, is known
  bool sized = false;                 ///< the length along the axis is known
  int planets = 0;                    ///< 0 for a pair: no planet steps, no train
  double length_scale_m = 1e-3;       ///< scale of checks on lengths: the module
  const strength::RatingTask* rating = nullptr;  ///< the load, where one is stated
  const train::ThermalRange* thermal = nullptr;  ///< likewise
};
/// What of a train decides which checks it has.
struct TrainLayout {
  int planets = 0;
  double stage1_module_m = 1e-3;
  std::array<geometry::PinionCutter, train::kGearCount> cutter{};
  train::AxialLayout axial{};
  TrainBodies<double> bodies{};
  const strength::RatingTask* rating = nullptr;
  const train::ThermalRange* thermal = nullptr;
};
GearingLayout train_layout(const TrainLayout& train);

/// All checks that are switched on, in the order of the registry, then of the members.
std::vector<CheckInstance> list_checks(const Limits& limits, const GearingLayout& layout);

/// Value of a check on its subject, in SI.
template <class T>
T check_value(const CheckInstance& check, const Gearing<T>& gearing);

/// Signed margin in SI: value − limit or limit − value; negative = failed.
template <class T>
T check_margin(const CheckInstance& check, const Gearing<T>& gearing) {
  const T value = check_value(check, gearing);
  return check.record->at_least ? T(value - check.limit) : T(check.limit - value);
}

/// Temperature and moisture as tables name them: "60 C", "60 C wet".
std::string state_text(const train::ThermalState& state);

/// Names of what a check of a train is about: mesh and gear, "" where there is none; with
/// the temperature of a check that is at one ("S-P1 at 60 C", of a train as a gear).
struct SubjectNames {
  std::string mesh, gear;
};
SubjectNames subject_names(const CheckInstance& check, std::span<const std::string_view> gears,
                           std::span<const std::string_view> meshes,
                           std::span<const std::array<int, 2>> mesh_gears);

/// View of a train's geometry for the checks, without tooth forms and axial layout; both arguments
/// must outlive it.
template <class T>
Gearing<T> gearing_of(const train::TrainGeometry<T>& train,
                      const std::array<T, train::kMeshCount>& normal_backlash_m,
                      backlash::LostMotionModel model);

}  // namespace gear3k::design
