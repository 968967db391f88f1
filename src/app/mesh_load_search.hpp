#pragma once
// A search with K_γ of the tolerances, which is known of a design only.

#include <array>
#include <optional>
#include <string>

#include "app/optimize.hpp"

namespace gear3k::app {

/// K_γ by mesh that a search held, and that of the best design that it found.
struct HeldMeshLoad {
  std::array<double, train::kMeshCount> held{};
  /// Empty where no design was found, or none of its gearboxes assembles.
  std::optional<std::array<double, train::kMeshCount>> own{};
  int searches = 0;
  /// No mesh of the best design has more than was held.
  bool consistent = false;
};

/// Whether a specification takes K_γ from its tolerances.
bool has_own_mesh_load(const optimize::Specification& spec);

/// Says what cannot be had with K_γ of the tolerances.
/// @throws io::InvalidInput
void refuse_with_own_mesh_load(const OptimizeTask& task);

/// Searches with K_γ of each mesh held, from 1 on, until the best design has no more:
///
///   K ← 1.005 K_γ(best),   after 5 searches max(K, 1.005 K_γ(best))
///   consistent: K_γ(best) ≤ K, and before the sixth search K ≤ 1.02 K_γ(best)
///
/// The best design is rated with its own K_γ afterwards, and keeps what was asked of it.  It is
/// the best under the held K_γ: another design of a lesser K_γ of its own may carry as much.
/// Source: own choice, docs/theory §55.
/// @param task    its specification gets the K_γ that the last search held
/// @param result  gets what the last search found
HeldMeshLoad hold_mesh_load(OptimizeTask& task, optimize::OptimizeResult& result,
                            optimize::Progress& progress);

/// What a reader is told of it.
std::string mesh_load_note(const HeldMeshLoad& load);

}  // namespace gear3k::app
