#pragma once
// Which of the safeties of teeth limits the torque.

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "strength/mesh_rating.hpp"
#include "strength/torque_capacity.hpp"

namespace gear3k::strength {

/// What a tooth fails by; under overload by the peak of the load, without life.
enum class Mode { kRoot, kFlank, kOverloadRoot, kOverloadFlank };
inline constexpr std::array<std::string_view, 4> kModeNames{"root", "flank", "root_overload",
                                                            "flank_overload"};

/// What limits the torque.
struct GoverningTooth {
  std::size_t mesh = 0, member = 0;  ///< member 0, 1: gear 1, 2 of the mesh
  Mode mode = Mode::kRoot;

  bool operator==(const GoverningTooth&) const = default;
};
template <class T>
struct Capacity {
  T torque_Nm{};
  GoverningTooth governing;
};

/// Safeties over their least values, with where they are.
template <class T>
struct JudgedSafeties {
  std::vector<SafetyRatio<T>> ratios;
  std::vector<GoverningTooth> places;
};
/// Whether any safety is judged: a limit stress, or under overload a yield strength, is stated.
bool judges_any(const RatingTask& task);

/// Adds the safeties of a mesh: those of root and flank whose limits are stated, and under overload
/// those that are rated.
/// @param k      the mesh's number in GoverningTooth
/// @param gears  of its members, in RatingTask::material
template <class T>
void add_judged_safeties(const MeshRating<T>& mesh, const RatingTask& task, std::size_t k,
                         const std::array<int, 2>& gears, JudgedSafeties<T>& list);

/// torque_capacity() of safeties at a torque, with what governs.
/// @returns empty where none is judged, and as torque_capacity()
std::optional<Capacity<double>> governed_capacity(
    const std::function<JudgedSafeties<double>(double torque_Nm)>& safeties,
    const CapacityOptions& options);

}  // namespace gear3k::strength
