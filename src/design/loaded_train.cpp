#include "design/loaded_train.hpp"

namespace gear3k::design {

template <class T>
strength::RatedTrain<T> loaded_train(const train::TrainGeometry<T>& geometry,
                                     std::span<const geometry::ToothForm<T>> forms,
                                     const std::array<T, 2>& face_width_m,
                                     const DirectionalFriction<T>& friction,
                                     efficiency::LossModel model) {
  strength::RatedTrain<T> loaded{
      .geometry = geometry, .forms = forms, .face_width_m = face_width_m};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    const auto& gear1 = geometry.gears[static_cast<std::size_t>(first)];
    const auto& gear2 = geometry.gears[static_cast<std::size_t>(second)];
    for (const std::size_t driver : {0U, 1U}) {
      const auto contact = efficiency::contact_of(gear1, gear2, geometry.meshes[k], driver == 0);
      for (const std::size_t direction : {0U, 1U}) {
        loaded.friction[direction][k] = friction[direction][k].coefficient;
        loaded.efficiency[direction][k][driver] =
            efficiency::mesh_efficiency(contact, friction[direction][k], model);
      }
    }
  }
  return loaded;
}

template <class T>
DirectionalFriction<T> even_friction(const efficiency::FlankFriction<T>& forward,
                                     const efficiency::FlankFriction<T>& backward) {
  return {{{forward, forward, forward}, {backward, backward, backward}}};
}

#define INSTANTIATE(T)                                                                  \
  template strength::RatedTrain<T> loaded_train<T>(                                     \
      const train::TrainGeometry<T>&, std::span<const geometry::ToothForm<T>>,          \
      const std::array<T, 2>&, const DirectionalFriction<T>&, efficiency::LossModel);   \
  template DirectionalFriction<T> even_friction<T>(const efficiency::FlankFriction<T>&, \
                                                   const efficiency::FlankFriction<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::design
