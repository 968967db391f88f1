#pragma once
// The least that each tooth set can have of one objective, found once for all limits on it.

#include <map>
#include <mutex>
#include <optional>

#include "optimize/objective.hpp"
#include "optimize/refine.hpp"
#include "optimize/stop_flag.hpp"

namespace gear3k::optimize {

/// The least lost motion of tooth sets, whatever else they are to have.
///
/// Within a narrow limit many sets have no design.  A refinement that finds none costs some ten
/// times one that does, and says nothing about the next limit; the least of a set answers all of
/// them. Several starts, as in any refinement: a local optimum, not a proof. Source: own
/// derivation, docs/theory §12 ("Pareto front").
class LeastLostMotion {
 public:
  explicit LeastLostMotion(const Specification& spec);
  LeastLostMotion(const LeastLostMotion&) = delete;
  LeastLostMotion& operator=(const LeastLostMotion&) = delete;
  ~LeastLostMotion() = default;

  /// Whether there is one programme for a set: not with modules, shifts or cutters from lists.
  [[nodiscard]] static bool knows(const Specification& spec);
  /// What a set can have at least.
  struct Least {
    double lost_motion_rad = -kInfinity;  ///< minus infinity where no start ended in a design
    KnownTrain at;                        ///< the design that has it
  };
  /// The same for a set whenever it is asked for.  Thread-safe.
  /// @returns null when `stop` became true
  [[nodiscard]] const Least* of(const Candidate& candidate, const StopFlag& stop);
  /// What is known of a set so far; null: nothing.
  [[nodiscard]] const Least* known(const Candidate& candidate) const;

 private:
  Specification spec_;
  Refiner refiner_;
  mutable std::mutex mutex_;
  std::map<Candidate, Least> known_;
};

}  // namespace gear3k::optimize
