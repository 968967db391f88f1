#include "optimize/rated_set.hpp"

#include "design/loaded_train.hpp"
#include "optimize/objective_value.hpp"

namespace gear3k::optimize {

template <class T>
strength::RatedTrain<T> rated_train(const Specification& spec, const train::TrainGeometry<T>& train,
                                    std::span<const geometry::ToothForm<T>> forms,
                                    const std::array<T, 2>& face_width_m) {
  auto rated =
      design::loaded_train<T>(train, forms, face_width_m,
                              {efficiency::constant_friction<T>(spec.friction, train.teeth, true),
                               efficiency::constant_friction<T>(spec.friction, train.teeth, false)},
                              spec.friction.model);
  // For the centrifugal force on the planets' bearings.
  if (spec.rating->supports && knows_masses(spec)) {
    rated.planet_mass_kg = planet_mass_kg(spec, train, face_width_m);
  }
  return rated;
}

#define INSTANTIATE(T)                                      \
  template strength::RatedTrain<T> rated_train<T>(          \
      const Specification&, const train::TrainGeometry<T>&, \
      std::span<const geometry::ToothForm<T>>, const std::array<T, 2>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::optimize
