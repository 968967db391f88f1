#include "calibrate/loops/loop_creep.hpp"

#include <cmath>

#include "calibrate/loops/loop_closing.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {
namespace {

double duration_s(const FilteredRecord& f, const Loop& loop) {
  return f.raw.time_s[loop.last_sample] - f.raw.time_s[loop.first_sample];
}

}  // namespace

CommonSlope common_slope(const std::vector<BranchZero>& branches) {
  CommonSlope slope{.weight_per_s = std::vector<double>(branches.size(), 0.0)};
  double sum_tt = 0.0;
  for (const bool rising : {false, true}) {
    const auto counts = [rising](const BranchZero& b) {
      return b.rising == rising && b.at.has_value();
    };
    double mean = 0.0;
    double count = 0.0;
    for (const BranchZero& b : branches) {
      if (!counts(b)) continue;
      mean += b.at->time_s;
      count += 1.0;
    }
    if (count == 0.0) continue;
    mean /= count;
    for (std::size_t k = 0; k < branches.size(); ++k) {
      if (!counts(branches[k])) continue;
      slope.weight_per_s[k] = branches[k].at->time_s - mean;
      sum_tt += numerics::square(slope.weight_per_s[k]);
    }
  }
  slope.repeats = sum_tt > 0.0;
  if (slope.repeats) {
    for (double& w : slope.weight_per_s) w /= sum_tt;
  }
  return slope;
}

std::optional<Creep> find_creep(const FilteredRecord& f, const std::vector<BranchZero>& branches,
                                const std::vector<Loop>& loops) {
  Creep creep;
  const CommonSlope slope = common_slope(branches);
  if (slope.repeats) {
    double variance = 0.0;
    for (std::size_t k = 0; k < branches.size(); ++k) {
      const double w = slope.weight_per_s[k];
      if (w == 0.0) continue;
      creep.rad_s += w * branches[k].at->angle_rad;
      variance += numerics::square(w) * branches[k].variance_rad2;
    }
    creep.standard_deviation_rad_s = std::sqrt(variance);
  } else {
    std::size_t b = 0;
    while (b < loops.size() && !loops[b].closing_error_rad) ++b;
    if (b == loops.size()) return std::nullopt;
    const double own = duration_s(f, loops[b]);
    if (!(own > 0.0)) return std::nullopt;
    creep.rad_s = *loops[b].closing_error_rad / own;
    creep.standard_deviation_rad_s =
        closing_deviation_rad(f.secant, branches[b], branches[b + 1]) / own;
  }
  return creep;
}

}  // namespace gear3k::calibrate
