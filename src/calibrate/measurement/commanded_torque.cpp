#include "calibrate/measurement/commanded_torque.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace gear3k::calibrate {

namespace {

/// Loads at one sun torque: without an eighth of them at either end, which may be outliers.
struct LoadsAtTorque {
  double torque_Nm = 0.0;
  std::size_t count = 0;
  double low = 0.0, middle = 0.0, high = 0.0;
  double range = 0.0;  ///< of all of them, were they spread evenly
};
LoadsAtTorque loads_at_torque(double torque_Nm, std::vector<double> loads) {
  constexpr std::size_t kEighth = 8;
  std::ranges::sort(loads);
  const std::size_t count = loads.size(), off = count / kEighth;
  const double low = loads[off], high = loads[count - 1 - off];
  const double kept = 1.0 - 2.0 * static_cast<double>(off) / static_cast<double>(count);
  return {.torque_Nm = torque_Nm,
          .count = count,
          .low = low,
          .middle = loads[count / 2],
          .high = high,
          .range = (high - low) / kept};
}

/// Fewest readings at a torque that was set.
constexpr std::size_t kFewestAtTorque = 3;

/// Whether most torques, of either direction, were read once or twice: what a sensor makes of loads
/// short of its limit.
bool are_hardly_repeated(const std::array<std::vector<LoadsAtTorque>, 2>& at) {
  std::ptrdiff_t torques = 0, repeated = 0;
  for (const std::vector<LoadsAtTorque>& of_direction : at) {
    torques += std::ssize(of_direction);
    repeated += std::ranges::count_if(of_direction,
                                      [](const auto& of) { return of.count >= kFewestAtTorque; });
  }
  return 2 * repeated < torques;
}

/// Whether loads at the least or the greatest torque scatter far more than at the others, which
/// scatter alike where torques were set, or in proportion to them.
bool ends_at_limit(const std::vector<LoadsAtTorque>& at) {
  constexpr double kFarMore = 3.0;
  constexpr std::size_t kFewestAtLimit = 5;
  return std::ranges::any_of(at, [&](const LoadsAtTorque& end) {
    if ((&end != &at.front() && &end != &at.back()) || end.count < kFewestAtLimit) return false;
    double others = -1.0;
    for (const LoadsAtTorque& of : at) {
      if (&of == &end || of.count < kFewestAtTorque) continue;
      const double larger = of.torque_Nm > 0.0 ? end.torque_Nm / of.torque_Nm : 1.0;
      others = std::max(others, of.range * std::max(1.0, larger));
    }
    return others >= 0.0 && end.range > kFarMore * others;
  });
}

/// Whether loads at each of some sun torques of one direction, ascending, lie together as where the
/// torques were set: close to each other, or to the loads at the next torque as far again.  Those
/// at the limit of a sensor do not, and those that a coarse one rounds to a torque reach up to the
/// next.
bool lie_together(const std::vector<LoadsAtTorque>& at) {
  constexpr double kClose = 0.5, kApart = 0.75;
  for (std::size_t k = 0; k < at.size(); ++k) {
    double step = HUGE_VAL;
    if (k > 0) step = std::min(step, std::abs(at[k].middle - at[k - 1].middle));
    if (k + 1 < at.size()) step = std::min(step, std::abs(at[k + 1].middle - at[k].middle));
    const bool apart = at.size() > 1 && at[k].range <= kApart * step;
    if (!apart && !(at[k].range <= kClose * at[k].high)) return false;
  }
  return true;
}

}  // namespace

bool is_commanded(const MeasurementSet& data) {
  if (data.readings) return data.readings->commanded;
  if (data.kind != Kind::kTransmission) return false;
  std::array<std::map<double, std::vector<double>>, 2> load_at;  // by direction and sun torque
  std::set<double> responses, loads;
  for (const Observation& row : data.rows) {
    const bool forward = row.condition.direction == design::Direction::kForward;
    load_at[forward ? 0 : 1][row.response].push_back(row.condition.output_torque_Nm);
    responses.insert(row.response);
    loads.insert(row.condition.output_torque_Nm);
  }
  constexpr std::size_t kSeveral = 3;
  if (responses.size() < 2 || kSeveral * responses.size() > loads.size()) return false;
  std::array<std::vector<LoadsAtTorque>, 2> at;
  for (std::size_t k = 0; k < at.size(); ++k) {
    at[k].reserve(load_at[k].size());
    for (const auto& [torque, all] : load_at[k]) at[k].push_back(loads_at_torque(torque, all));
  }
  return !are_hardly_repeated(at) && std::ranges::all_of(at, [](const auto& of_direction) {
    return lie_together(of_direction) && !ends_at_limit(of_direction);
  });
}

}  // namespace gear3k::calibrate
