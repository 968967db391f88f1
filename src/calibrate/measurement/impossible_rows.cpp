#include "calibrate/measurement/impossible_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "calibrate/measurement/left_out_rows.hpp"
#include "calibrate/measurement/marked_together.hpp"
#include "calibrate/measurement/power_excess.hpp"
#include "numerics/median.hpp"

namespace gear3k::calibrate {

namespace {

constexpr double kMostImpossible = 0.2;  // of the rows
/// The greatest fault of a sensor, as share of its reading or of the greatest one: twice what a
/// gain may plausibly be off, and less than any two units differ by.
constexpr double kMostFault = 0.2;

std::size_t count_of(const std::vector<char>& marked) {
  return static_cast<std::size_t>(std::ranges::count(marked, 1));
}

bool are_too_many(std::size_t count, std::size_t rows) {
  return static_cast<double>(count) > kMostImpossible * static_cast<double>(rows);
}

/// Direction and rotation: 0 to 3.
std::size_t cell_of(const Condition& c) {
  return (c.direction == design::Direction::kForward ? 2U : 0U) + (c.rotation >= 0 ? 1U : 0U);
}

double greatest_ideal(const std::vector<PowerExcess>& excess) {
  double greatest = 0.0;
  for (const PowerExcess& e : excess) greatest = std::max(greatest, e.ideal);
  return greatest;
}

using Inside = std::function<bool(const Observation&)>;

/// Whether the impossible rows give the less too much the greater the load, by more than 3 standard
/// errors of the line through each direction, as where the zero of a sensor is wrong: what a
/// gearbox loses, and rows of exchanged directions seem to give, grows with the load.
bool falls_with_load(const MeasurementSet& set, const std::vector<PowerExcess>& excess,
                     const Inside& inside) {
  constexpr double kStandardErrors = 3.0;
  struct Sums {
    double n = 0.0, x = 0.0, y = 0.0;
  };
  std::array<Sums, 2> sums;
  const auto each = [&](const auto& act) {
    for (std::size_t k = 0; k < set.rows.size(); ++k) {
      if (!excess[k].impossible() || !inside(set.rows[k])) continue;
      act(sums[losing_sign(set.rows[k].condition) > 0.0 ? 1 : 0], excess[k].ideal,
          excess[k].excess);
    }
  };
  each([](Sums& s, double x, double y) {
    s.n += 1.0;
    s.x += x;
    s.y += y;
  });
  double rows = 0.0, means = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Sums& s : sums) {
    rows += s.n;
    if (s.n > 0.0) means += 1.0;
  }
  each([&](const Sums& s, double x, double y) {
    const double dx = x - s.x / s.n, dy = y - s.y / s.n;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  });
  const double free = rows - means - 1.0;
  if (!(free > 0.0) || !(xx > 0.0) || !(xy < 0.0)) return false;
  const double variance = std::max(0.0, yy - xy * xy / xx) / free;
  return xy * xy / xx > kStandardErrors * kStandardErrors * variance;
}

/// Whether these rows are possible once forward and backward are exchanged.  A fault of a sensor
/// takes from some readings what it gives to others, so that where it makes those of one direction
/// or rotation impossible, others lose more than before; of one rotation, a zero is wrong by the
/// same at each load.
bool are_exchanged(const MeasurementSet& set, const std::vector<PowerExcess>& excess,
                   const Inside& inside) {
  constexpr std::size_t kFewestLossy = 2;
  struct Cell {
    std::size_t rows = 0, lossy = 0;
  };
  std::array<Cell, 8> cells;  // direction and rotation, each direction, each rotation
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    if (!inside(set.rows[k])) continue;
    const std::size_t cell = cell_of(set.rows[k].condition);
    for (const std::size_t of : {cell, 4 + cell / 2, 6 + cell % 2}) {
      ++cells[of].rows;
      if (excess[k].lossy()) ++cells[of].lossy;
    }
  }
  return std::ranges::none_of(cells,
                              [&](const Cell& c) {
                                return c.lossy >= kFewestLossy && are_too_many(c.lossy, c.rows);
                              }) &&
         !falls_with_load(set, excess, inside);
}

/// Where forward and backward are exchanged in one session or file, at least half of its rows being
/// impossible, of both directions, and more than elsewhere: in words; else empty.
std::string exchanged_part(const MeasurementSet& set, const std::vector<PowerExcess>& excess) {
  const auto all = static_cast<int>(set.rows.size());
  const auto all_impossible =
      static_cast<int>(std::ranges::count_if(excess, &PowerExcess::impossible));
  const double chance =
      kChanceTogether / static_cast<double>(std::max(set.runs.size(), set.files.size()));
  const auto looks_so = [&](const auto& inside) {
    int rows = 0, impossible = 0;
    std::array<int, 2> ways{};
    for (std::size_t k = 0; k < set.rows.size(); ++k) {
      if (!inside(set.rows[k])) continue;
      ++rows;
      if (!excess[k].impossible()) continue;
      ++impossible;
      ++ways[losing_sign(set.rows[k].condition) > 0.0 ? 1 : 0];
    }
    return 2 * impossible >= rows && ways[0] > 0 && ways[1] > 0 &&
           chance_of_marks(all, all_impossible, rows, impossible) <= chance &&
           are_exchanged(set, excess, inside);
  };
  for (std::size_t run = 0; run < set.runs.size(); ++run) {
    if (looks_so([&](const Observation& o) { return o.condition.run == static_cast<int>(run); })) {
      return fmt::format("session {}", set.runs[run]);
    }
  }
  for (std::size_t file = 0; set.files.size() > 1 && file < set.files.size(); ++file) {
    if (looks_so([&](const Observation& o) { return o.file == static_cast<int>(file); })) {
      return set.files[file];
    }
  }
  return "";
}

/// Whether the impossible rows are off by more than a sensor is: the median of the half of them
/// with the greater loads, where the zero of a sensor matters least.
bool are_beyond_a_sensor(const std::vector<PowerExcess>& excess, const std::vector<char>& marked) {
  std::vector<PowerExcess> impossible;
  for (std::size_t k = 0; k < excess.size(); ++k) {
    if (marked[k] != 0) impossible.push_back(excess[k]);
  }
  std::ranges::stable_sort(impossible, std::ranges::greater{}, &PowerExcess::ideal);
  impossible.resize((impossible.size() + 1) / 2);
  std::vector<double> size;
  size.reserve(impossible.size());
  for (const PowerExcess& e : impossible) size.push_back(e.excess);
  return numerics::upper_median(std::move(size)) > kMostFault * greatest_ideal(excess);
}

/// How one fault of a sensor, of parameter θ, changes each reading: θ times this.
struct SensorFault {
  std::string_view name;
  std::vector<double> change;
  double most = 0.0;  ///< of |θ|
};

/// Whether one θ makes every row possible, and at least a third of those that it has to help were
/// impossible.
bool explains_all(const SensorFault& fault, const MeasurementSet& set,
                  const std::vector<PowerExcess>& excess, const std::vector<char>& marked) {
  double low = -fault.most, high = fault.most;
  std::vector<double> helps(excess.size());  // excess − θ · helps is what stays of it
  for (std::size_t k = 0; k < excess.size(); ++k) {
    helps[k] = -losing_sign(set.rows[k].condition) * fault.change[k];
    const double beyond = excess[k].excess - excess[k].allowed;
    if (helps[k] > 0.0) {
      low = std::max(low, beyond / helps[k]);
    } else if (helps[k] < 0.0) {
      high = std::min(high, beyond / helps[k]);
    } else if (beyond > 0.0) {
      return false;
    }
  }
  if (!(low <= high)) return false;
  const double theta = low > 0.0 ? low : high;
  const auto helped = static_cast<std::size_t>(
      std::ranges::count_if(helps, [&](double h) { return theta * h > 0.0; }));
  return 3 * count_of(marked) >= helped;
}

/// The fault of a sensor, in all rows or in one session, by which all rows are possible: in words;
/// empty where none is.
std::string one_fault(const MeasurementSet& set, const std::vector<PowerExcess>& excess,
                      const std::vector<char>& marked) {
  const double most_Nm = kMostFault * greatest_ideal(excess);
  const auto fault = [&](std::string_view name, double most, const auto& change_of) {
    SensorFault result{.name = name, .change = {}, .most = most};
    result.change.reserve(set.rows.size());
    for (const Observation& o : set.rows) result.change.push_back(change_of(o));
    return result;
  };
  const std::array<SensorFault, 3> faults{
      fault("gain", kMostFault, [](const Observation& o) { return o.response; }),
      fault("zero", most_Nm,
            [](const Observation& o) {
              return losing_sign(o.condition) * (o.condition.rotation >= 0 ? 1.0 : -1.0);
            }),
      fault("zero", most_Nm, [](const Observation&) { return 1.0; })};
  for (const SensorFault& f : faults) {
    if (explains_all(f, set, excess, marked)) return std::string(f.name);
  }
  for (std::size_t run = 0; set.runs.size() > 1 && run < set.runs.size(); ++run) {
    for (SensorFault f : faults) {
      for (std::size_t k = 0; k < set.rows.size(); ++k) {
        if (set.rows[k].condition.run != static_cast<int>(run)) f.change[k] = 0.0;
      }
      if (explains_all(f, set, excess, marked)) {
        return fmt::format("{} in session {}", f.name, set.runs[run]);
      }
    }
  }
  return "";
}

/// Adds to a group the marked rows of its directions and rotations that give no more too much than
/// its own: what makes those impossible makes these, wherever noise lets it show.  What is of one
/// session or part of the turn keeps to it.
void add_likes(MarkedTogether& together, const MeasurementSet& set,
               const std::vector<PowerExcess>& excess, const std::vector<char>& marked) {
  if (together.along == "run" || together.along == "angle") return;
  std::array<double, 4> most{};
  for (std::size_t k = 0; k < marked.size(); ++k) {
    if (together.marked[k] == 0) continue;
    double& of_cell = most[cell_of(set.rows[k].condition)];
    of_cell = std::max(of_cell, excess[k].excess);
  }
  for (std::size_t k = 0; k < marked.size(); ++k) {
    if (marked[k] == 0 || together.marked[k] != 0) continue;
    if (excess[k].excess > most[cell_of(set.rows[k].condition)]) continue;
    together.marked[k] = 1;
    ++together.count;
  }
}

std::string refusal_text(const MeasurementSet& set, double ratio, const std::vector<char>& marked,
                         const std::string& exchanged) {
  const std::string places = places_of(set, marked);
  const std::size_t count = count_of(marked);
  if (set.kind == Kind::kPairLoss) {
    return fmt::format(
        "{}: loss_factor below 0 (efficiency above 1) in {} of {} rows, allowed: "
        "at most {:g} %; are driving and driven gears swapped, or is it 1 - loss "
        "with the wrong sign?",
        places, count, set.rows.size(), 100.0 * kMostImpossible);
  }
  return fmt::format(
      "{}: efficiency above 1 at the ratio {:.6g} in {} of {} rows, allowed: at "
      "most {:g} %; are forward and backward swapped{}, is it another ratio, "
      "another unit, or a sensor far out?",
      places, std::abs(ratio), count, set.rows.size(), 100.0 * kMostImpossible,
      exchanged.empty() ? "" : " (" + exchanged + ")");
}

}  // namespace

std::optional<std::string> leave_out_impossible(MeasurementSet& set, double ratio) {
  if (set.kind != Kind::kTransmission && set.kind != Kind::kPairLoss) return std::nullopt;
  if (set.kind == Kind::kTransmission && !(std::isfinite(ratio) && ratio != 0.0)) {
    throw std::invalid_argument(
        fmt::format("leave_out_impossible: ratio = {}: allowed: finite, not 0", ratio));
  }
  const std::vector<PowerExcess> excess = power_excess(set, ratio);
  std::vector<char> marked(set.rows.size(), 0);
  for (std::size_t k = 0; k < excess.size(); ++k) marked[k] = excess[k].impossible() ? 1 : 0;
  const std::vector<char> impossible = marked;
  std::size_t count = count_of(marked);
  if (count == 0) return std::nullopt;
  const bool many = are_too_many(count, set.rows.size());
  if (many) {
    if (set.kind == Kind::kPairLoss || are_beyond_a_sensor(excess, marked) ||
        are_exchanged(set, excess, [](const Observation&) { return true; })) {
      return refusal_text(set, ratio, impossible, "");
    }
    if (const std::string part = exchanged_part(set, excess); !part.empty()) {
      return refusal_text(set, ratio, impossible, part);
    }
  }
  std::vector<std::string> notes;
  while (set.kind == Kind::kTransmission && count > 0) {
    auto together = marked_together(set, marked);
    if (!together) break;
    add_likes(*together, set, excess, marked);
    notes.push_back(fmt::format(
        "{}: efficiency above 1 beyond the noise in {} of {} rows, of {}: they stay, as what is "
        "wrong there together is {}, and no single reading",
        places_of(set, together->marked), together->count, set.rows.size(), together->group,
        together->along == "angle"
            ? "the gearbox or its load in that part of the turn"
            : "a torque sensor (its gain, its zero) or the stated condition"));
    for (std::size_t k = 0; k < marked.size(); ++k) {
      if (together->marked[k] != 0) marked[k] = 0;
    }
    count -= together->count;
  }
  if (are_too_many(count, set.rows.size())) {
    const std::string fault = one_fault(set, excess, impossible);
    if (fault.empty()) return refusal_text(set, ratio, impossible, "");
    notes = {fmt::format(
        "{}: efficiency above 1 beyond the noise in {} of {} rows: they stay, as one wrong {} of a "
        "torque sensor makes all of them so, and no single reading",
        places_of(set, impossible), count_of(impossible), set.rows.size(), fault)};
    count = 0;
  }
  set.notes.insert(set.notes.end(), notes.begin(), notes.end());
  if (count == 0) return std::nullopt;
  const std::string places = places_of(set, marked);
  set.notes.push_back(fmt::format("{}: {} left out, efficiency above 1 beyond the noise", places,
                                  count == 1 ? "row" : "rows"));
  leave_out(set, marked);
  return std::nullopt;
}

}  // namespace gear3k::calibrate
