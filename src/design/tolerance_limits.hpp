#pragma once
// What a gearbox built within its tolerances can be: least, drawn and greatest.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "backlash/tolerances.hpp"
#include "design/checks.hpp"

namespace gear3k::design {

/// A quantity over everything that the tolerances allow.  The drawn value lies outside where the
/// limits leave out the deviation 0, as allowances of the tooth thickness do.
struct BuiltRange {
  double least = 0.0, nominal = 0.0, greatest = 0.0;  ///< NaN where a corner has no such value
};

/// One gear as it is built.
struct GearDeviation {
  double tooth_thickness_m = 0.0;  ///< A_s: arc on the reference circle
  double tip_diameter_m = 0.0;
  std::optional<double> root_diameter_m;  ///< empty: the root follows the tooth thickness
};

struct MeshLimits {
  std::string name;
  std::array<std::string, 2> gear_names;
  BuiltRange normal_backlash_m;           ///< j_bn
  BuiltRange circumferential_backlash_m;  ///< j_wt = j_bn/cos α_w, on the working pitch circles
  /// j_r: how far the axes can be moved along their line until there is no backlash.
  BuiltRange radial_backlash_m;
  BuiltRange contact_ratio;
  BuiltRange working_pressure_angle_rad;
  std::array<BuiltRange, 2> root_clearance_m;  ///< between the tip of gear 1, 2 and its mate's root
  std::array<BuiltRange, 2> active_root_diameter_m;
  /// Radial room between active root and form circle, positive when the flank is long enough.
  std::array<BuiltRange, 2> form_reserve_m;
};

struct GearLimits {
  std::string name;
  BuiltRange generating_shift;  ///< x_E of a tool of nominal thickness, in modules
  BuiltRange tooth_thickness_m;
  BuiltRange tip_diameter_m, root_diameter_m, form_diameter_m, tip_thickness_m;
};

struct CheckLimits {
  const CheckRecord* record = nullptr;
  std::string mesh, gear;  ///< "" where the check has none
  BuiltRange margin;       ///< SI
  bool holds = false;      ///< at the worst corner
};

struct ToleranceLimits {
  std::vector<MeshLimits> meshes;
  std::vector<GearLimits> gears;
  std::vector<CheckLimits> checks;            ///< those of the evaluation, in its order
  std::optional<BuiltRange> lost_motion_rad;  ///< kinematic, at the output; empty for a pair
  /// Gears that a corner leaves no material under the root of, where a check is rated.
  std::vector<std::string> gears_without_rim;
};

/// A gearing under the stated load; of a pair the first mesh.
struct LoadedGearing {
  strength::TrainRating<double> rating;  ///< only what is asked for
  /// Gears without material under their root: their teeth in `rating` say nothing.
  std::array<bool, train::kGearCount> without_rim{};
};
/// The stated load on a gearing that differs from the drawn one in dimensions only.
using GearingRating = std::function<LoadedGearing(
    const Gearing<double>& gearing, const std::array<bool, train::kMeshCount>& rated)>;

/// What is drawn: a train or a pair.
struct DrawnGearing {
  std::span<const geometry::GearGeometry<double>> gears;
  std::span<const geometry::ToothForm<double>> forms;
  std::span<const std::array<int, 2>> mesh_gears;
  std::span<const std::string_view> gear_names, mesh_names;
  double center_distance_m = 0.0;
  const train::TrainGeometry<double>* train = nullptr;  ///< null for a pair
  const train::AxialLayout* axial = nullptr;            ///< null where nothing is known of it
  const TrainBodies<double>* bodies = nullptr;          ///< likewise
  backlash::LostMotionModel model = backlash::LostMotionModel::kKinematic;
  GearingRating rating{};                        ///< needed by checks with CheckRecord::rating only
  const train::ThermalRange* thermal = nullptr;  ///< null where none is stated
};

/// Ranges of a gearing and margins of its checks over all gearboxes that the tolerances allow.
///
/// Each quantity is evaluated exactly at every corner: each gear at either end of its tooth
/// thickness, tip and (where stated) root diameter, the centre distance at either end; of a mesh
/// those of its two gears, of the whole train the tooth thicknesses of all.  All planets are alike.
/// What is rated under load is rated anew in every corner, with the built teeth, roots and path of
/// contact.  The tips of all gears count there, as a tip moves the losses of its mesh and these
/// what every mesh has to carry.  Coefficients of friction and masses of planets stay those of the
/// drawn gearbox: the former would differ by the state at which a law is evaluated, the latter by
/// 1e-6 of a bearing's load.  A gear without material under its root has no rated margin there.
/// The drawn gearbox counts as one more where the limits allow it.
/// Valid: quantities that are monotone in each deviation while the others stay, as all are next to
/// a drawn gearbox that is one, or are the least of several such: of a margin that is (tip_fouling,
/// coaxiality), the least lies in a corner, and the greatest may be exceeded inside.  Factors of
/// strength have kinks (K_Hα at its bounds, a contact ratio through 2, Z_B = 1): among 6000 random
/// gearboxes of 150 designs at such places none was below the least of its corners, while the
/// greatest safety of a flank was exceeded by up to 13 % of its range.  Tested with random
/// gearboxes inside the limits.
/// Does not cover: run-out, pitch deviations, pin position and phase of the planets, which differ
/// from tooth to tooth and planet to planet (backlash::ClearanceModel); KISSsoft's minimum and
/// maximum have none of them either.
/// @param gears  tolerances of each gear
/// @param checks  as by list_checks()
/// @returns empty where a mesh has no working pressure angle at an end of the centre distance
std::optional<ToleranceLimits> tolerance_limits(const DrawnGearing& drawn,
                                                std::span<const backlash::GearTolerances> gears,
                                                const backlash::DeviationLimits& center_distance_m,
                                                std::span<const CheckInstance> checks);

}  // namespace gear3k::design
