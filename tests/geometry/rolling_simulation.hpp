#pragma once
// Gears cut and rolled point by point: the truth that the interference checks are held against.
//
// A profile is the boundary of the space that a tool sweeps: at every radius, the largest angle
// that the tool's contour reaches over the whole generating roll, found by search.  Two profiles
// are then rolled against each other in the same way.  No form circle, trochoid or condition of
// interference is used in closed form; the involute itself is used for the shape of a cutter's or
// an arc ring's flank (its definition) and as what a cut flank is compared with.
//
// All lengths are in modules, all angles in radians.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/gear.hpp"

namespace gear3k::test {

/// One side of a tooth (external gear) or of a tooth space (ring) as half-angle over radius, about
/// its axis of symmetry.  Radii are spaced with the square of the node's number from the root
/// circle on, where the profile is steep.
///
/// Accuracy: about 1e-5 modules normal to the profile, from linear interpolation.
struct CutProfile {
  int teeth = 0;
  bool ring = false;
  double root_radius = 0.0;
  double tip_radius = 0.0;  ///< of the blank
  double reach = 0.0;       ///< tip radius of what is left: flanks may meet before the tip circle
  double base_radius = 0.0;
  /// The ideal flank's half-angle at the base circle: half-angle = base_half_angle − inv α_y.
  double base_half_angle = 0.0;
  std::function<double(double)> exact;  ///< half-angle by search, without the table
  std::vector<double> half_angle;       ///< at node i: radius(i)
  std::vector<double> slope;            ///< radius · d(half-angle)/d(radius), at nodes

  [[nodiscard]] double radius(std::size_t node) const;
  /// Half-angle of what was cut; constant beyond the first and the last node.
  [[nodiscard]] double at(double r) const;
  [[nodiscard]] double slope_at(double r) const;
  /// Half-angle of the ideal involute; at the base circle's below it.
  [[nodiscard]] double involute_at(double r) const;
  /// Material missing (positive) or left over (negative) against the ideal flank, normal to it.
  [[nodiscard]] double missing_at(double r) const;
};

/// The gear that its tool leaves; gear.module_m is not used.
///
///   external: rack tool, thickness π/2 + q/cos α on its datum line, datum line at x outside the
///             reference circle, tip line hfP* beyond it, tip corners of radius ρfP*
///   ring, no cutter: space of an external involute tooth, corners to the root circle filled by
///   arcs ring, cutter: what the pinion cutter sweeps at its generating centre distance
///
/// @returns nothing when the tool does not exist (corner radii that do not fit, no generating
///          centre distance, a cutter or space whose flanks meet before its outer circle) or when
///          nothing is left of the teeth
std::optional<CutProfile> cut_gear(const geometry::Gear<double>& gear, double pressure_angle_rad);

/// An external pair, or an external gear (gear1) in a ring (gear2).
struct SimulatedPair {
  double pressure_angle_rad = 0.0;
  double center_distance = 0.0;  ///< in modules
  geometry::Gear<double> gear1, gear2;
};

/// Deepest overlap found in one region, and where: radii on both gears, angle from the line of
/// centres seen from gear 2 for rings, from gear 1 otherwise.
struct Overlap {
  double depth = 0.0;  ///< 0 = none
  double radius1 = 0.0, radius2 = 0.0, angle_rad = 0.0;
};

struct RollingResult {
  Overlap mesh;        ///< flanks and fillets in the mesh zone
  Overlap tips;        ///< beyond the angles at which contact ends, with a tenth of room
  double root1 = 0.0;  ///< tip circle of gear 2 beyond the root circle of gear 1; < 0 = clearance
  double root2 = 0.0;  ///< tip circle of gear 1 beyond the root circle of gear 2; < 0 = clearance
  /// Where the mate's tip wants contact: distance on the line of action from the gear's base
  /// tangent point (negative: beyond it), and the radius there.
  std::array<double, 2> contact_distance{}, contact_radius{};
  /// Most material missing from the flank between that radius and the tip, normal to the flank;
  /// infinite when contact is wanted beyond the base tangent point or no tip is left.
  std::array<double, 2> missing{};
  double normal_backlash = 0.0;
  double cutter_feed = 0.0;  ///< cutter_feed_overlap() of gear 2
};

/// Overlap and missing flank above these count; both in modules.
struct Sight {
  double overlap, missing;
};
/// What no check may miss, and the little that still confirms an alarm: the simulation's accuracy.
inline constexpr Sight kPlain{.overlap = 1e-3, .missing = 1e-4};
inline constexpr Sight kFaint{.overlap = 1e-4, .missing = 1e-5};

/// Rolls the pair at its centre distance through all positions in which the tip circles overlap,
/// with one side of the teeth in contact and all the backlash on the other.
/// @returns nothing when the base circles leave no line of action
std::optional<RollingResult> roll(const SimulatedPair& pair, const CutProfile& gear1,
                                  const CutProfile& gear2);

/// Overlap when the pinion moves into its ring along the line of centres without turning, from
/// where it is free of the ring to the working distance, with the backlash halved between the two
/// sides of the teeth.
///
/// @param phases  positions of the pinion between a tooth on the line of centres and a space there
/// @returns the worst depth over all phases
double radial_assembly_overlap(const SimulatedPair& pair, const CutProfile& pinion,
                               const CutProfile& ring, int phases);

/// The same for a ring's cutter, fed in radially without turning: what it takes off the finished
/// ring's teeth.  0 for a ring without cutter.
double cutter_feed_overlap(const geometry::Gear<double>& ring, double pressure_angle_rad,
                           const CutProfile& cut, int phases);

/// What a simulation saw first of: "flank lost", "root", "tips", "mesh", "feed"; "" = nothing.
std::string_view seen(const RollingResult& result, const Sight& sight = kPlain);

/// Signed margin of a check on a pair, negative = failed, in modules (angles as arcs on the ring).
struct NamedMargin {
  std::string_view name;  ///< of the check
  int gear = 0;           ///< the one it is about, 1 or 2; 0 = the mesh
  double margin = 0.0;
};
using MarginsOf = std::function<std::vector<NamedMargin>(const SimulatedPair&)>;

/// Margins smaller than this are near their limit: radial distances, arcs and lengths on the line
/// of action; gaps normal to the profiles, of which 0 is flank contact.
inline constexpr double kNearLimit = 0.05, kNearGap = 0.005;
double near_limit(std::string_view check);

/// The checks whose passing together claims that a pair runs free of interference.
inline constexpr std::array<std::string_view, 7> kInterferenceChecks{
    "ring_tip_outside_base", "involute_interference", "form_circle", "root_clearance",
    "trochoid_interference", "tip_fouling",           "ring_cutter"};

enum class Agreement {
  kAgree,
  kMissed,     ///< plainly seen by the simulation, passed by every check
  kFalseAlarm  ///< not even faintly seen, although a check fails by more than near_limit()
};

struct Comparison {
  Agreement agreement = Agreement::kAgree;
  /// No margin lies within near_limit() of zero.
  bool away_from_limits = true;
  /// The smallest margin in shares of its near_limit(), which raised the alarm if there is one;
  /// none without checks.
  std::optional<NamedMargin> worst;
};

/// Compares what was seen with the margins of kInterferenceChecks; other margins do not count.
Comparison compare(const RollingResult& result, std::span<const NamedMargin> margins);

/// Random pairs, the same ones for the same seed and number.
class RandomPair {
 public:
  RandomPair(std::uint64_t seed, std::uint64_t number);

  /// A pair whose tools exist, whose teeth keep a tip of at least 0.05 modules, whose contact ratio
  /// is at least one and whose backlash is not negative.
  ///
  ///   external: z 8..60 with 8..100, x −0.5..1.2;  internal: 12..60 in 6..60 more, x −0.5..1.5
  ///   α 14.5°..25°, haP* 0.8..1.2, hfP* 0.15..0.35 more, ρfP* up to what fits, q 0..0.1
  ///
  /// Two thirds are at the distance without backlash of the full teeth and up to 0.1 modules of
  /// running clearance, the others anywhere up to 0.4 modules from it.
  SimulatedPair pair();

  /// The pair changed in one of its parameters until the check's margin lies within near_limit() on
  /// either side of zero; nothing when no parameter brings it there.
  std::optional<SimulatedPair> move_near_limit(const SimulatedPair& base, const NamedMargin& check,
                                               const MarginsOf& margins_of);

  double between(double low, double high);
  int count(int low, int high);

 private:
  std::mt19937_64 generator_;
};

}  // namespace gear3k::test
