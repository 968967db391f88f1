#pragma once
// The whole task: search the tooth sets, refine every one, pick the best.

#include <array>
#include <atomic>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "optimize/progress.hpp"
#include "optimize/specification.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// Largest KKT residual that counts as a local optimum.
inline constexpr double kStationary = 1e-4;

/// optimal: a feasible point with KKT residual ≤ kStationary.  failed: feasible points were found,
/// but none that is stationary, or the model was defined nowhere.
enum class Status { kOptimal, kNoFeasibleFound, kInfeasible, kFailed };
inline constexpr std::size_t kStatusCount = 4;
/// Names in result files, in the order of the enum.
inline constexpr std::array<std::string_view, kStatusCount> kStatusNames{
    "optimal", "no_feasible_found", "infeasible", "failed"};

/// By how much one constraint is missed.
struct Miss {
  std::string_view name;   ///< a check, or stage1_module / stage2_module
  double violation = 0.0;  ///< scaled to order 1
  double amount = 0.0;     ///< the same in `unit`, as files and tables print it
  std::string_view unit;
};

/// What refinement made of one tooth set.
struct RefinedSet {
  Candidate candidate;
  Status status = Status::kFailed;
  /// What blocks the set; empty when optimal or failed.  infeasible: the constraint that no point
  /// of the box can meet.  no_feasible_found: the constraints any one of which may give way alone
  /// (a point was found that meets all others), least (scaled) first; or, when none was found to
  /// suffice, those that the least violating point misses most, together.
  std::vector<Miss> blocked_by;
  bool blocked_together = false;  ///< none of blocked_by was found to suffice alone
  // The rest only when optimal.
  train::TrainParameters<double> train;
  double eta_b = 0.0, eta_f = 0.0;
  /// With all losses of the calibrated model at the operating point; empty without them, or where
  /// the gearbox does not run.
  std::optional<double> eta_b_model, eta_f_model;
  double lost_motion_rad = 0.0;  ///< by the specification's model
  std::array<double, train::kMeshCount> contact_ratio{};
  double ring_root_diameter_m = 0.0;  ///< the larger ring's
  double kkt_residual = 0.0;
};

struct OptimizeResult {
  ToothSearchResult search;
  std::vector<RefinedSet> sets;  ///< in the order of search.candidates; done ones only
  std::optional<std::size_t> best;
  std::vector<std::size_t> pareto;  ///< see pareto_front()
  bool interrupted = false;
};

/// The first constraint that blocks a set; "" when there is none.
inline std::string_view reason_of(const RefinedSet& set) {
  return set.blocked_by.empty() ? std::string_view() : set.blocked_by.front().name;
}

/// Efficiency that a specification maximises.
double objective_of(const RefinedSet& set, Objective objective);

/// Whether a calibrated model decides between the refined sets.
bool judged_by_model(const Specification& spec);

/// Efficiency by which refined sets are compared: objective_of(), or that with the model; minus
/// infinity where the gearbox does not run with it.
double judged_objective(const Specification& spec, const RefinedSet& set);

/// Refines one tooth set: every module of the series, several starts each, the best feasible end;
/// when no start ends feasible, one more from the point of least violation.
RefinedSet refine(const Specification& spec, const Candidate& candidate);
/// The same; empty when `stop` became true before the set was done.
std::optional<RefinedSet> refine(const Specification& spec, const Candidate& candidate,
                                 const std::atomic<bool>& stop);

/// Searches and refines everything, OpenMP over the tooth sets.  The result does not depend on the
/// number of threads.  Ties go to the set that comes first.
OptimizeResult optimize(const Specification& spec, Progress& progress);

/// Indices of the optimal sets that no other one beats or equals in all of eta_b, eta_f, lost
/// motion and ring root diameter at once, in the order of the sets.  With `by_model` the
/// efficiencies are those with the model; sets that do not run with it are beaten by any that do.
std::vector<std::size_t> pareto_front(const std::vector<RefinedSet>& sets, bool by_model = false);

/// The design of a refined set, with the specification's limits and friction; without its model.
design::Design design_of(const Specification& spec, const RefinedSet& set);

}  // namespace gear3k::optimize
