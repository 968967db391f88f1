#include "app/mesh_load_search.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/evaluate.hpp"
#include "app/robust_run.hpp"
#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::app {

namespace {

using MeshLoads = std::array<double, train::kMeshCount>;

constexpr int kFreeSearches = 5, kMostSearches = 20;
/// Held above what the last design had, and at most so much above that of the next one.
constexpr double kRoom = 1.005, kMostRoom = 1.02;

}  // namespace

bool has_own_mesh_load(const optimize::Specification& spec) {
  return spec.rating &&
         spec.rating->factors.mesh_load_source == strength::MeshLoadSource::kTolerances;
}

void refuse_with_own_mesh_load(const OptimizeTask& task) {
  if (!has_own_mesh_load(task.spec)) return;
  const auto refuse = [&](const char* what) {
    throw io::InvalidInput(
        fmt::format("{}: strength.k_gamma = \"tolerances\" with {}: K_gamma is known of one design "
                    "at one torque only; allowed: one of them, or k_gamma as a number",
                    task.source, what));
  };
  using optimize::Objective;
  if (task.spec.objectives.size() > 1) refuse("a list of objectives");
  const Objective objective = optimize::first_objective(task.spec);
  if (objective == Objective::kTorqueCapacity || objective == Objective::kTorqueDensity) {
    refuse("an objective of the torque");
  }
  if (task.spec.robust.hold != optimize::Hold::kNominal) refuse("[robust]");
  if (task.round) refuse("--round");
  if (task.model) refuse("--model");
}

HeldMeshLoad hold_mesh_load(OptimizeTask& task, optimize::OptimizeResult& result,
                            optimize::Progress& progress) {
  optimize::Specification& spec = task.spec;
  HeldMeshLoad load;
  load.held.fill(1.0);
  for (;;) {
    spec.rating->factors.held_mesh_load = load.held;
    result = optimize::optimize(spec, progress, {.best_only = task.certify});
    ++load.searches;
    load.own.reset();
    if (result.interrupted || !result.best) return load;
    const design::Evaluation evaluation =
        evaluate(io::as_written(optimize::design_of(spec, *result.best)), task.source);
    if (!evaluation.strength || !evaluation.strength->planet_sharing ||
        !evaluation.strength->planet_sharing->series) {
      return load;
    }
    const auto& factors = evaluation.strength->planet_sharing->series->quantile;
    MeshLoads own{};
    bool enough = true, tight = true;
    for (std::size_t k = 0; k < own.size(); ++k) {
      own[k] = std::max(1.0, factors[k]);
      enough = enough && own[k] <= load.held[k];
      tight = tight && load.held[k] <= kMostRoom * own[k];
    }
    load.own = own;
    const bool free = load.searches <= kFreeSearches;
    load.consistent = enough && (tight || !free);
    if (load.consistent || load.searches == kMostSearches) return load;
    for (std::size_t k = 0; k < own.size(); ++k) {
      load.held[k] = free ? kRoom * own[k] : std::max(load.held[k], kRoom * own[k]);
    }
    restart(progress);
  }
}

std::string mesh_load_note(const HeldMeshLoad& load) {
  const auto listed = [](const MeshLoads& k) {
    return fmt::format("{:.4g}, {:.4g}, {:.4g}", k[0], k[1], k[2]);
  };
  std::string text = fmt::format(
      "K_gamma of the tolerances: held at {} (S-P1, P1-R1, P2-R2) in the last of {} searches",
      listed(load.held), load.searches);
  if (!load.own) return text + "; that of the best design is not known";
  text += fmt::format("; the best design has {}", listed(*load.own));
  return text +
         (load.consistent ? "" : ", which is more: no search held as much as its design has");
}

}  // namespace gear3k::app
