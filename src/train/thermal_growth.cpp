#include "train/thermal_growth.hpp"

#include <algorithm>

namespace gear3k::train {

double growth_factor(const Growth& growth, double reference_K, const ThermalState& state) {
  const double warmed = 1.0 + growth.expansion_1_K * (state.temperature_K - reference_K);
  switch (state.moisture) {
    case Moisture::kDry:
      return warmed + growth.swelling.dry;
    case Moisture::kWet:
      return warmed + growth.swelling.wet;
    case Moisture::kDrawn:
      break;
  }
  return warmed;
}

bool swells(const ThermalRange& range) {
  const auto strained = [](const Growth& g) {
    return g.swelling.dry != 0.0 || g.swelling.wet != 0.0;
  };
  return strained(range.carrier) || std::ranges::any_of(range.gear, strained);
}

int end_count(const ThermalRange& range) { return swells(range) ? 4 : 2; }

ThermalState end_state(const ThermalRange& range, int end) {
  if (!swells(range)) {
    return {.temperature_K = end == 0 ? range.least_K : range.greatest_K,
            .moisture = Moisture::kDrawn};
  }
  return {.temperature_K = end < 2 ? range.least_K : range.greatest_K,
          .moisture = end % 2 == 0 ? Moisture::kDry : Moisture::kWet};
}

template <class T>
geometry::GearGeometry<T> grown_gear(const geometry::GearGeometry<T>& gear, double factor) {
  geometry::GearGeometry<T> grown = gear;
  grown.gear.module_m *= constant<T>(factor);
  for (T* radius : {&grown.reference_radius_m, &grown.base_radius_m, &grown.tip_radius_m,
                    &grown.root_radius_m}) {
    *radius *= constant<T>(factor);
  }
  return grown;
}

#define INSTANTIATE(T)                                                                    \
  template geometry::GearGeometry<T> grown_gear<T>(const geometry::GearGeometry<T>& gear, \
                                                   double factor);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::train
