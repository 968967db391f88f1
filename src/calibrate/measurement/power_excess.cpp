#include "calibrate/measurement/power_excess.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include "numerics/median.hpp"

namespace gear3k::calibrate {

namespace {

constexpr double kStandardDeviations = 3.0;
constexpr double kRelativeAllowance = 0.01;
constexpr std::size_t kFewestNeighbours = 5;
constexpr double kMedianToDeviation = 1.4826;  // of a normal distribution

/// What the response follows first of all: load, or the sum of 1/z.
double load_of(Kind kind, const Observation& o) {
  if (kind == Kind::kTransmission) return o.condition.output_torque_Nm;
  return 1.0 / o.condition.driving_teeth + 1.0 / o.condition.driven_teeth;
}

/// Standard deviation of the response from the scatter about the line through the neighbours in
/// load; 0 where there are too few.  Neighbours of other speeds only make it greater.
double scatter_in_load(const MeasurementSet& set) {
  std::vector<const Observation*> order;
  order.reserve(set.rows.size());
  for (const Observation& o : set.rows) order.push_back(&o);
  const auto group = [](const Observation* o) {
    return std::tuple(o->condition.direction, o->condition.rotation, o->condition.reference_sensor);
  };
  const auto key = [&](const Observation* o) {
    return std::tuple(group(o), load_of(set.kind, *o), o->condition.sun_speed_rad_s);
  };
  std::ranges::stable_sort(
      order, [&](const Observation* a, const Observation* b) { return key(a) < key(b); });
  std::vector<double> deviations;
  deviations.reserve(order.size());
  for (std::size_t k = 1; k + 1 < order.size(); ++k) {
    const Observation *a = order[k - 1], *b = order[k], *c = order[k + 1];
    if (group(a) != group(c)) continue;
    const double from = load_of(set.kind, *a), to = load_of(set.kind, *c);
    const double w = to > from ? (load_of(set.kind, *b) - from) / (to - from) : 0.5;
    const double difference = b->response - (1.0 - w) * a->response - w * c->response;
    deviations.push_back(std::abs(difference) / std::sqrt(1.0 + w * w + (1.0 - w) * (1.0 - w)));
  }
  if (deviations.size() < kFewestNeighbours) return 0.0;
  return kMedianToDeviation * numerics::upper_median(std::move(deviations));
}

}  // namespace

double losing_sign(const Condition& c) {
  return c.direction == design::Direction::kForward ? 1.0 : -1.0;
}

std::vector<PowerExcess> power_excess(const MeasurementSet& set, double ratio) {
  const double estimated = scatter_in_load(set);
  std::vector<PowerExcess> result;
  result.reserve(set.rows.size());
  for (const Observation& o : set.rows) {
    PowerExcess e{.excess = -o.response};
    if (set.kind == Kind::kTransmission) {
      e.ideal = o.condition.output_torque_Nm / std::abs(ratio);
      e.excess = losing_sign(o.condition) * (e.ideal - o.response);
    }
    const double sigma = std::isnan(o.sigma) ? estimated : o.sigma;
    e.allowed = std::max(kStandardDeviations * sigma, kRelativeAllowance * e.ideal);
    result.push_back(e);
  }
  return result;
}

}  // namespace gear3k::calibrate
