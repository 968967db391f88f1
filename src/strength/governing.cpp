#include "strength/governing.hpp"

#include <algorithm>

namespace gear3k::strength {

namespace {

/// 1 where a stress is proportional to the torque, 2 where its square is.
int torque_exponent(Mode mode) {
  return mode == Mode::kFlank || mode == Mode::kOverloadFlank ? 2 : 1;
}

}  // namespace

bool judges_any(const RatingTask& task) {
  return std::ranges::any_of(task.material, [&](const std::optional<GearMaterial>& material) {
    if (!material) return false;
    const Material& record = material->record;
    return record.root_limit.law != LimitLaw::kNotStated ||
           record.flank_limit.law != LimitLaw::kNotStated ||
           (task.overload && is_plastic(record.group) && record.yield_strength_Pa);
  });
}

template <class T>
void add_judged_safeties(const MeshRating<T>& mesh, const RatingTask& task, std::size_t k,
                         const std::array<int, 2>& gears, JudgedSafeties<T>& list) {
  for (std::size_t i = 0; i < gears.size(); ++i) {
    const ToothRating<T>& tooth = mesh.teeth[i];
    const auto gear = static_cast<std::size_t>(gears[i]);
    const auto add = [&](const T& safety, double least, Mode mode) {
      list.ratios.push_back({.ratio = safety / least, .exponent = torque_exponent(mode)});
      list.places.push_back({.mesh = k, .member = i, .mode = mode});
    };
    if (tooth.root_limit_stated) {
      add(tooth.root_safety, least_root_safety(task, gear), Mode::kRoot);
    }
    if (tooth.flank_limit_stated) {
      add(tooth.flank_safety, least_flank_safety(task, gear), Mode::kFlank);
    }
    if (tooth.overload_root_safety) {
      add(*tooth.overload_root_safety, least_overload_root_safety(task, gear), Mode::kOverloadRoot);
    }
    if (tooth.overload_flank_safety) {
      add(*tooth.overload_flank_safety, least_flank_safety(task, gear), Mode::kOverloadFlank);
    }
  }
}

std::optional<Capacity<double>> governed_capacity(
    const std::function<JudgedSafeties<double>(double torque_Nm)>& safeties,
    const CapacityOptions& options) {
  const JudgedSafeties<double> first = safeties(options.start_Nm);
  if (first.ratios.empty()) return std::nullopt;
  const auto capacity =
      torque_capacity([&](const double& torque_Nm) { return safeties(torque_Nm).ratios; }, options);
  if (!capacity) return std::nullopt;
  return Capacity<double>{.torque_Nm = capacity->torque_Nm,
                          .governing = first.places[capacity->governing]};
}

#define INSTANTIATE(T)                                                                       \
  template void add_judged_safeties<T>(const MeshRating<T>&, const RatingTask&, std::size_t, \
                                       const std::array<int, 2>&, JudgedSafeties<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
