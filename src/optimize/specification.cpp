#include "optimize/specification.hpp"

#include <algorithm>

namespace gear3k::optimize {

double length_scale_m(const Specification& spec) {
  const ModuleChoice& stage1 = spec.module[0];
  if (stage1.range_m) return stage1.range_m->min;
  return *std::min_element(stage1.series_m.begin(), stage1.series_m.end());
}

}  // namespace gear3k::optimize
