#include "optimize/specification.hpp"

#include <algorithm>

namespace gear3k::optimize {

double least_module(const ModuleChoice& choice) {
  if (choice.range_m) return choice.range_m->min;
  return *std::min_element(choice.series_m.begin(), choice.series_m.end());
}

double length_scale_m(const Specification& spec) { return least_module(spec.module[0]); }

}  // namespace gear3k::optimize
