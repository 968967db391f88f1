#include "optimize/specification.hpp"

namespace gear3k::optimize {

double length_scale_m(const Specification& spec) {
  const ModuleChoice& stage1 = spec.module[0];
  if (stage1.range_m) return 0.5 * (stage1.range_m->min + stage1.range_m->max);
  return stage1.series_m[stage1.series_m.size() / 2];
}

}  // namespace gear3k::optimize
