#include "optimize/specification.hpp"

#include <algorithm>

namespace gear3k::optimize {

double least_module(const ModuleChoice& choice) {
  if (choice.range_m) return choice.range_m->min;
  return *std::min_element(choice.series_m.begin(), choice.series_m.end());
}

const NumberRange& shift_limits(const Specification& spec, int gear) {
  const bool ring = train::kind_of(gear) == geometry::GearKind::kRing;
  return ring && spec.ring_shift ? *spec.ring_shift : spec.profile_shift;
}

std::array<double, 2> least_face_widths_m(const Specification& spec) {
  std::array<double, 2> widths{};
  for (std::size_t stage = 0; stage < 2; ++stage) {
    const auto& range = spec.free.face_width_m[stage];
    const double rated = spec.rating ? spec.rating->face_width_m[stage] : 0.0;
    widths[stage] = range ? range->min : spec.bodies.face_width_m[stage].value_or(rated);
  }
  return widths;
}

std::optional<double> most_ring_root_diameter_m(const Specification& spec) {
  std::optional<double> most = spec.limits[design::CheckId::kRingRootDiameter];
  if (const auto& whole = spec.limits[design::CheckId::kGearboxDiameter]) {
    const double root = *whole - 2.0 * spec.bodies.ring_rim_m;
    most = std::min(most.value_or(root), root);
  }
  return most;
}

bool thinning_varies(const Specification& spec) {
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    if (!spec.thickness_allowance_m[i]) continue;
    const ModuleChoice& module =
        spec.module[static_cast<std::size_t>(train::stage_of(static_cast<int>(i)))];
    const bool one_module =
        module.range_m ? module.range_m->min == module.range_m->max : module.series_m.size() == 1;
    if (!one_module || spec.free.pressure_angle_rad) return true;
  }
  return false;
}

std::array<geometry::PinionCutter, train::kGearCount> cutters_of(const Specification& spec,
                                                                 const std::array<int, 2>& teeth) {
  auto cutters = spec.cutter;
  if (teeth[0] > 0) cutters[train::kR1].teeth = teeth[0];
  if (teeth[1] > 0) cutters[train::kR2].teeth = teeth[1];
  return cutters;
}

double length_scale_m(const Specification& spec) { return least_module(spec.module[0]); }

}  // namespace gear3k::optimize
