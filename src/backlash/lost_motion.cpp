#include "backlash/lost_motion.hpp"

#include <cmath>

#include "backlash/normal_backlash.hpp"

namespace gear3k::backlash {

using train::kR1, train::kR2, train::kS;

template <class T>
std::array<T, train::kMeshCount> normal_backlashes(const train::TrainGeometry<T>& train) {
  std::array<T, train::kMeshCount> j{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    j[k] = normal_backlash(train.gears[static_cast<std::size_t>(first)],
                           train.gears[static_cast<std::size_t>(second)], train.meshes[k]);
  }
  return j;
}

template <class T>
std::array<T, train::kMeshCount> kinematic_lost_motion(
    const train::TrainGeometry<T>& train, const std::array<T, train::kMeshCount>& j_bn) {
  const double g1 = train::g1(train.teeth);
  const double g2 = train::g2(train.teeth);
  const double ratio = std::abs(train::ratio(train.teeth));
  return {j_bn[0] / (ratio * train.gears[kS].base_radius_m),
          (g1 + g2) / (1.0 + g1) * j_bn[1] / train.gears[kR1].base_radius_m,
          j_bn[2] / train.gears[kR2].base_radius_m};
}

template <class T>
std::array<T, train::kMeshCount> paper_lost_motion(const train::TrainGeometry<T>& train,
                                                   const std::array<T, train::kMeshCount>& j_bn) {
  // cos alpha r_k are base radii.
  const double ratio = std::abs(train::ratio(train.teeth));
  return {j_bn[0] / (ratio * train.gears[kS].base_radius_m),
          j_bn[1] / train.gears[kR1].base_radius_m, j_bn[2] / train.gears[kR2].base_radius_m};
}

template <class T>
T output_lost_motion(const train::TrainGeometry<T>& train,
                     const std::array<T, train::kMeshCount>& j_bn, LostMotionModel model) {
  if (model == LostMotionModel::kPaper) {
    const auto phi = paper_lost_motion(train, j_bn);
    return phi[0] + larger(phi[1], phi[2]);
  }
  const auto share = kinematic_lost_motion(train, j_bn);
  return share[0] + share[1] + share[2];
}

#define INSTANTIATE(T)                                                                            \
  template std::array<T, train::kMeshCount> normal_backlashes<T>(const train::TrainGeometry<T>&); \
  template std::array<T, train::kMeshCount> kinematic_lost_motion<T>(                             \
      const train::TrainGeometry<T>&, const std::array<T, train::kMeshCount>&);                   \
  template std::array<T, train::kMeshCount> paper_lost_motion<T>(                                 \
      const train::TrainGeometry<T>&, const std::array<T, train::kMeshCount>&);                   \
  template T output_lost_motion<T>(const train::TrainGeometry<T>&,                                \
                                   const std::array<T, train::kMeshCount>&, LostMotionModel);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::backlash
