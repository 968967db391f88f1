#include "calibrate/measurement/impossible_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/measurement/left_out_rows.hpp"
#include "calibrate/measurement/level_groups.hpp"
#include "numerics/distributions.hpp"
#include "numerics/median.hpp"

namespace gear3k::calibrate {

namespace {

constexpr double kStandardDeviations = 3.0;
constexpr double kRelativeAllowance = 0.01;
constexpr double kMostImpossible = 0.2;  // of the rows
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

/// Marked rows that fall together.
struct MarkedTogether {
  std::vector<char> marked;  ///< of the group
  std::size_t count = 0;
  std::string group;     ///< in words
  bool in_turn = false;  ///< a part of the turn
};

/// The group of one session, direction, load, speed or twelfth of a turn, or of one in one
/// direction, into which the marked rows fall as random places seldom do (5 %, each group paid
/// for), a third of its rows at least; empty where none is.
std::optional<MarkedTogether> marked_together(const MeasurementSet& set,
                                              const std::vector<char>& marked) {
  constexpr double kChance = 0.05;
  std::vector<Levels> levels = covariate_levels(set);
  std::erase_if(levels, [](const Levels& l) {
    return l.name != "run" && l.name != "direction" && l.name != "load" && l.name != "speed";
  });
  const LevelGroups groups = level_groups(set, levels);
  const auto rows = static_cast<int>(marked.size());
  const auto all = static_cast<int>(std::ranges::count(marked, 1));
  double best = 1.0;
  int looked_at = 0;
  std::optional<Eigen::Index> at;
  for (Eigen::Index g = 0; g < groups.columns.cols(); ++g) {
    // The same rows in another sense are no group of their own.
    if ((groups.columns.col(g).array() < 0.0).any()) continue;
    int size = 0, hit = 0;
    for (int i = 0; i < rows; ++i) {
      if (groups.columns(i, g) == 0.0) continue;
      ++size;
      if (marked[static_cast<std::size_t>(i)] != 0) ++hit;
    }
    if (2 * size > rows) continue;
    ++looked_at;
    if (hit < 2 || 3 * hit < size) continue;
    double p = 0.0;
    for (int j = hit; j <= std::min(all, size); ++j) {
      p += numerics::hypergeometric_probability(rows, size, all, j);
    }
    if (p < best) {
      best = p;
      at = g;
    }
  }
  if (!at || best * looked_at > kChance) return std::nullopt;
  const LevelGroup& group = groups.group[static_cast<std::size_t>(*at)];
  MarkedTogether result{.marked = std::vector<char>(marked.size(), 0),
                        .group = level_text(set, group),
                        .in_turn = group.along == "angle"};
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (marked[i] == 0 || groups.columns(static_cast<Eigen::Index>(i), *at) == 0.0) continue;
    result.marked[i] = 1;
    ++result.count;
  }
  return result;
}

}  // namespace

std::optional<std::string> leave_out_impossible(MeasurementSet& set, double ratio) {
  if (set.kind != Kind::kTransmission && set.kind != Kind::kPairLoss) return std::nullopt;
  if (set.kind == Kind::kTransmission && !(std::isfinite(ratio) && ratio != 0.0)) {
    throw std::invalid_argument(
        fmt::format("leave_out_impossible: ratio = {}: allowed: finite, not 0", ratio));
  }
  const double estimated = scatter_in_load(set);
  std::vector<char> marked(set.rows.size(), 0);
  std::size_t count = 0;
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    const Observation& o = set.rows[k];
    double excess = -o.response, scale = 1.0;
    if (set.kind == Kind::kTransmission) {
      scale = o.condition.output_torque_Nm / std::abs(ratio);
      excess = o.condition.direction == design::Direction::kForward ? scale - o.response
                                                                    : o.response - scale;
    }
    const double sigma = std::isnan(o.sigma) ? estimated : o.sigma;
    if (excess > std::max(kStandardDeviations * sigma, kRelativeAllowance * scale)) {
      marked[k] = 1;
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  if (static_cast<double>(count) > kMostImpossible * static_cast<double>(set.rows.size())) {
    const std::string places = places_of(set, marked);
    return set.kind == Kind::kTransmission
               ? fmt::format(
                     "{}: efficiency above 1 at the ratio {:.6g} in {} of {} rows, allowed: at "
                     "most {:g} %; are forward and backward swapped, is it another ratio, "
                     "another unit, or a sensor far out?",
                     places, std::abs(ratio), count, set.rows.size(), 100.0 * kMostImpossible)
               : fmt::format(
                     "{}: loss_factor below 0 (efficiency above 1) in {} of {} rows, allowed: "
                     "at most {:g} %; are driving and driven gears swapped, or is it 1 - loss "
                     "with the wrong sign?",
                     places, count, set.rows.size(), 100.0 * kMostImpossible);
  }
  while (set.kind == Kind::kTransmission && count > 0) {
    const auto together = marked_together(set, marked);
    if (!together) break;
    set.notes.push_back(fmt::format(
        "{}: efficiency above 1 beyond the noise in {} of {} rows, of {}: they stay, as what is "
        "wrong there together is {}, and no single reading",
        places_of(set, together->marked), together->count, set.rows.size(), together->group,
        together->in_turn ? "the gearbox or its load in that part of the turn"
                          : "a torque sensor (its gain, its zero) or the stated condition"));
    for (std::size_t k = 0; k < marked.size(); ++k) {
      if (together->marked[k] != 0) marked[k] = 0;
    }
    count -= together->count;
  }
  if (count == 0) return std::nullopt;
  const std::string places = places_of(set, marked);
  set.notes.push_back(fmt::format("{}: {} left out, efficiency above 1 beyond the noise", places,
                                  count == 1 ? "row" : "rows"));
  leave_out(set, marked);
  return std::nullopt;
}

}  // namespace gear3k::calibrate
