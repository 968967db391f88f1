#include "design/measured_lost_motion.hpp"

#include "backlash/lost_motion.hpp"

namespace gear3k::design {

namespace {

template <class T>
T with_extension(const train::TrainGeometry<T>& geometry, const backlash::LostMotionExtension<T>& e,
                 const LostMotionTest<T>& test) {
  const T rigid = backlash::output_lost_motion(geometry, backlash::normal_backlashes(geometry),
                                               backlash::LostMotionModel::kKinematic);
  return rigid + e.clearance_rad + backlash::windup(e, T(test.torque_Nm));
}

}  // namespace

template <class T>
std::optional<T> measured_lost_motion(const train::TrainParameters<T>& parameters,
                                      const train::TrainGeometry<T>& geometry,
                                      const backlash::LostMotionExtension<T>& e,
                                      const LostMotionTest<T>& test) {
  if (is_neutral(e.expansion_1_K, 0.0)) return with_extension(geometry, e, test);
  train::TrainParameters<T> warm = parameters;
  warm.center_distance_m =
      parameters.center_distance_m *
      (1.0 + e.expansion_1_K * (test.temperature_K - e.reference_temperature_K));
  if (!(value_of(warm.center_distance_m) > 0.0)) return std::nullopt;
  const auto expanded = train::make_train_geometry(warm);
  if (!expanded) return std::nullopt;
  return with_extension(*expanded, e, test);
}

template <class T>
std::optional<T> measured_lost_motion(const train::TrainParameters<T>& parameters,
                                      const backlash::LostMotionExtension<T>& e,
                                      const LostMotionTest<T>& test) {
  const auto geometry = train::make_train_geometry(parameters);
  if (!geometry) return std::nullopt;
  return measured_lost_motion(parameters, *geometry, e, test);
}

#define INSTANTIATE(T)                                                                       \
  template std::optional<T> measured_lost_motion<T>(const train::TrainParameters<T>&,        \
                                                    const backlash::LostMotionExtension<T>&, \
                                                    const LostMotionTest<T>&);               \
  template std::optional<T> measured_lost_motion<T>(                                         \
      const train::TrainParameters<T>&, const train::TrainGeometry<T>&,                      \
      const backlash::LostMotionExtension<T>&, const LostMotionTest<T>&);
INSTANTIATE(double)
INSTANTIATE(Jet1)
#undef INSTANTIATE

}  // namespace gear3k::design
