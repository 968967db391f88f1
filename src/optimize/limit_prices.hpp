#pragma once
// What holds an optimum back: its active limits and bounds, with what each of them costs.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "optimize/refined_set.hpp"
#include "optimize/refinement_problem.hpp"

namespace gear3k::optimize {

/// What a limit is of.
enum class LimitKind {
  kCheck,
  kObjective,  ///< that a Pareto search asks for
  kProfileShift,
  kRingShift,
  kModule,
  kTipShortening,
  kAddendum,  ///< in the place of kTipShortening, where that is what a file states
  kPressureAngle,
  kFaceWidth,
  kTorque,
  kFelt,        ///< of what is felt at the output
  kSearchSpace  ///< where the model ends; nobody states it
};

/// One number of a specification: a limit, or an end of a range.
struct LimitOf {
  LimitKind kind = LimitKind::kCheck;
  std::optional<design::CheckId> check{};
  /// The mesh that has a least backlash of its own; the gear, a safety; the stage; the objective.
  int place = -1;
  bool at_least = true;  ///< what the number of its key limits is to be at least it
  bool operator==(const LimitOf&) const = default;
};

/// Path in a SPEC of the limit of a check, e.g. "limits.tip_thickness_mm".
std::string key_of_limit(const design::CheckRecord& record);
/// The same of a limit of kind kCheck, e.g. "backlash.P2-R2.min_normal_um"; not of a safety.
std::string key_of_limit(const LimitOf& limit);
/// The number of such a limit.
std::optional<double>& number_of(design::Limits& limits, const LimitOf& limit);
const std::optional<double>& number_of(const design::Limits& limits, const LimitOf& limit);

/// An active limit with the change of the objective per unit of it.
///
///   ∂objective/∂L = ± scale Σ_k λ_k |∂g_k/∂L|     over the rows and bounds that it sets
///
/// positive where the objective grows with the limit's number.  The load
/// (strength.output_torque_nm) moves every row of strength, and its price is that of all of them
/// together; it has none where the torsional stiffness, which depends on it, is asked for.  Source:
/// own derivation, docs/theory §12.
struct LimitPrice {
  LimitOf limit;
  std::string key;     ///< path in a SPEC, [0] and [1] the ends of a range
  bool stated = true;  ///< a file can state another number; else a switch, or the search's own
  units::Unit unit = units::Unit::kNone;
  double value_si = 0.0;
  std::vector<std::string> where{};  ///< gears, meshes, or gears in meshes
  /// Objective [SI] per limit [SI]: where it gives way, where it is tightened (empty: nothing
  /// feasible is left).  They differ where the multipliers are not unique.
  double loosened = 0.0;
  std::optional<double> tightened{};
  /// What the set gains, refined anew where the limit gives way by its step [SI], with the sense of
  /// the objective's number; 0 where nothing better was found, empty where it was not refined or
  /// that failed.
  std::optional<double> refined_gain_si{};
  [[nodiscard]] bool unique() const;
};

/// A step by which a limit is likely to give way, in the unit of its key, with its sign.
double giving_step(const LimitPrice& price);

/// Whether a least backlash would give way to flanks that press on each other.
inline bool is_below_no_backlash(const LimitPrice& price) {
  return price.limit.at_least && price.unit == units::Unit::kMicrometre &&
         units::decimal_from_si(price.value_si, price.unit) + giving_step(price) < 0.0;
}

/// What a search with a bound given way found: see search_beyond().
struct WiderSearch {
  double value = 0.0;                  ///< of the key
  std::optional<RefinedSet> better{};  ///< empty: nothing better there
};

/// A bound of the tooth search that a set sits at.
struct SearchBound {
  std::string key;
  double value = 0.0;                  ///< of the set, in the unit of the key
  std::optional<WiderSearch> wider{};  ///< empty where nothing beyond it was tried
};

/// The design with the limit given way by its step that gains most, to first order.
struct RelaxedAnswer {
  std::string key;
  double value_si = 0.0;  ///< of the limit then
  bool all_sets = false;  ///< every tooth set was searched with it; else the set itself
  std::optional<RefinedSet> better{};  ///< empty: nothing better was found
};

struct HeldBack {
  double kkt_residual = 0.0;
  std::vector<LimitPrice> prices;  ///< of every active limit, in the order of rows, then bounds
  std::string_view missing;        ///< why there are none; "" where they are known
  std::vector<SearchBound> at;
  std::optional<RelaxedAnswer> relaxed{};  ///< empty where no search was made
  bool interrupted = false;  ///< a search beyond a bound, or with a limit given way, was ended
};

/// The limit of a file that gains most where it gives way by its step, refined anew where that is
/// known and else to first order, and not below no backlash; null: none gains.
/// The load is none: it is what the gearbox is for.
const LimitPrice* dearest(const HeldBack& held);

/// @param set  an optimum of the specification
/// @param stated  what files state of the limits; those of the specification may be tighter, as
///   calibrated models and built gearboxes ask for
HeldBack held_back(const Specification& spec, const RefinedSet& set, const design::Limits& stated);

/// The problem of which a refined set is an optimum, every check a row, with the set as its point;
/// of several branches the one whose KKT residual is the least.  Empty where none holds it.
struct SetProblem {
  RefinementProblem problem;
  Point v{};
  double kkt_residual = 0.0;
};
/// @param slack  by how much rows may be missed at that point (scaled)
std::optional<SetProblem> problem_of(const Specification& spec, const RefinedSet& set,
                                     double slack = design::kFeasibilitySlack);

/// Lowers the torque of a point, where it is a variable, to the greatest that is carried there.
void lower_to_carried_torque(const RefinementProblem& problem, Point& v);

/// The best refined set of each number of planets that has one, by rising number.
std::vector<RefinedSet> best_per_planets(const Specification& spec,
                                         const std::vector<RefinedSet>& refined);

}  // namespace gear3k::optimize
