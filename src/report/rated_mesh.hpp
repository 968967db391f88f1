#pragma once
// Meshes under load as the reports see them: with names, and in one drive direction each.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "design/evaluation.hpp"

namespace gear3k::report {

/// A mesh that is rated; of a train in the drive direction in which it carries more.
struct RatedMesh {
  std::string name;
  std::array<std::string, 2> gears;
  const strength::MeshRating<double>* rating = nullptr;
  /// Empty of a pair.
  std::optional<strength::Drive> drive;
  double forward_N = 0.0, backward_N = 0.0;  ///< normal forces of one planet, by drive direction
};
/// The three meshes of a train.  Forces that differ by rounding only are taken forward.
std::array<RatedMesh, train::kMeshCount> rated_meshes(const design::StrengthResult& strength);
/// The mesh of a pair.  @throws std::bad_optional_access without a rating
RatedMesh rated_mesh(const design::PairEvaluation& e);

/// Torque on gear 1 that a pair is rated at [N m].  @throws std::bad_optional_access without a
/// rating
double rated_torque(const design::PairEvaluation& e);

/// A factor under its key in the JSON and its symbol in tables.
struct NamedFactor {
  std::string_view key, symbol;
  const strength::Factor<double>* factor;
};
std::array<NamedFactor, 7> load_factors_of(const strength::MeshRating<double>& mesh);
std::array<NamedFactor, 6> root_factors_of(const strength::ToothRating<double>& tooth);
std::array<NamedFactor, 6> flank_factors_of(const strength::ToothRating<double>& tooth);

/// A factor and what it is of.
struct PlacedFactor {
  NamedFactor named;
  std::string mesh, gear;  ///< gear "": of the mesh
};
/// Every factor of a mesh and its teeth that was applied.
std::vector<PlacedFactor> factors_of(const RatedMesh& mesh);

/// Whether a rating came to the factor: Y_X of a tooth whose limit is not stated is none.
inline bool is_applied(const strength::Factor<double>& factor) {
  return !factor.branch.empty() || !factor.source.empty();
}

}  // namespace gear3k::report
