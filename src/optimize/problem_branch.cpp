#include "optimize/problem_branch.hpp"

#include "optimize/objective_value.hpp"

namespace gear3k::optimize {

namespace {

bool no_mesh_interferes(const design::Limits& limits) {
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    if (!(design::least_backlash_m(limits, k).value_or(-1.0) >= 0.0)) return false;
  }
  return true;
}

}  // namespace

bool has_least_lost_motion(const design::Limits& limits) {
  const auto& least = limits[design::CheckId::kOutputBacklashMin];
  return least && (*least > 0.0 || !no_mesh_interferes(limits));
}

std::vector<ProblemBranch> branches_of(const Specification& spec) {
  const bool paper = spec.limits.model == backlash::LostMotionModel::kPaper;
  const bool of_backlash = paper && has_least_lost_motion(spec.limits);
  const bool of_objective = has_objective_branches(first_objective(spec), spec);
  std::vector<ProblemBranch> branches;
  for (const int backlash : of_backlash ? std::vector{1, 2} : std::vector{1}) {
    for (const int objective : of_objective ? std::vector{1, 2} : std::vector{0}) {
      branches.push_back({.backlash = backlash, .objective = objective});
    }
  }
  return branches;
}

}  // namespace gear3k::optimize
