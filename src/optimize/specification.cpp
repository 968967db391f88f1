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

double length_scale_m(const Specification& spec) { return least_module(spec.module[0]); }

}  // namespace gear3k::optimize
