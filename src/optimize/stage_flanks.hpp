#pragma once
// What flank_safety and root_safety ask of the stages of tooth sets.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "optimize/stage_relaxation.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// What the flanks and roots of one stage ask of its module at least, and what they can have at
/// most.
struct StageFlanks {
  strength::FlankNeed sun, ring;  ///< the least of all tooth sets that share the stage
  /// The same of the roots of the sun, and of the planet in S-P1 and in its ring.
  strength::RootNeed sun_root, planet_root, ring_planet_root;
  std::shared_ptr<const strength::RootTable> sun_table, planet_table;  ///< null: nothing is asked
  double greatest_module_m = 0.0;
};

/// Whether a specification asks anything of flanks that bounds know of.
bool bounds_flanks(const Specification& spec);
/// The same of the roots of sun and planets.
bool bounds_roots(const Specification& spec);

/// Whether no mesh gains power: friction of equal coefficient in approach and recess, of one path
/// model, or such that least_friction() is positive.
bool friction_is_dissipative(const Specification& spec);

/// The least flank safety that is asked of a gear; infinite where none is judged.
double least_flank_safety_asked(const Specification& spec);
/// The same of root safeties, of sun and planets.
double least_root_safety_asked(const Specification& spec);

/// What flanks and roots ask of every stage that candidates share.
/// @param stage  0: S, P1, R1; 1: P2, R2
/// @param tasks  of each stage, without what its load asks
/// @param stage_of  stage of each candidate
std::vector<StageFlanks> stage_flanks(const Specification& spec, std::size_t stage,
                                      std::span<const StageTask> tasks,
                                      std::span<const Candidate> candidates,
                                      std::span<const std::uint32_t> stage_of);

/// The task with what its flanks and roots ask; the tables stay with `flanks`.
StageTask with_flanks(const Specification& spec, const StageTask& task, const StageFlanks& flanks);

}  // namespace gear3k::optimize
