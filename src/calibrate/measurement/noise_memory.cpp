#include "calibrate/measurement/noise_memory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

namespace {

/// A condition line by line, and the senses in which it differs between lines of one session.
struct ConditionByLine {
  std::vector<double> value;
  std::vector<int> run;
  double same = 0.0;  ///< differences up to this are scatter about a set point

  /// Of line i to a later line j: 1 higher, -1 lower; 0: as high, not stated, or another session.
  [[nodiscard]] int sense(std::size_t i, std::size_t j) const {
    const double change = value[j] - value[i];
    if (run[i] != run[j] || !(std::abs(change) > same)) return 0;
    return change > 0.0 ? 1 : -1;
  }
};

/// Of many lines every n-th; differences of 2 % of the range are none, as between repeats.
template <class Get>
ConditionByLine by_line(const MeasurementSet& data, const Get& get) {
  constexpr std::size_t kMostLines = 1000;
  constexpr double kOfRange = 0.02;
  ConditionByLine c;
  const std::size_t step = (data.rows.size() + kMostLines - 1) / kMostLines;
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
  for (std::size_t i = 0; i < data.rows.size(); i += step) {
    const Condition& here = data.rows[i].condition;
    c.value.push_back(static_cast<double>(get(here)));
    c.run.push_back(here.run);
    low = std::fmin(low, c.value.back());
    high = std::fmax(high, c.value.back());
  }
  c.same = high > low ? kOfRange * (high - low) : 0.0;
  return c;
}

/// Whether a condition moves in one sense from line to line of its sessions: scatter about a set
/// point aside, and but for one line in twenty that was read again (one at least), as good as all
/// pairs of lines that differ do so the same way (rank correlation 0.98).
bool is_sorted(const ConditionByLine& c) {
  const std::size_t n = c.value.size();
  const auto balance = [&](const std::vector<char>& counts) {
    std::array<long, 2> pairs{};  // lower, higher
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 1; j < n && counts[i] != 0; ++j) {
        const int sense = counts[j] != 0 ? c.sense(i, j) : 0;
        if (sense != 0) ++pairs[sense > 0 ? 1 : 0];
      }
    }
    return pairs;
  };
  std::vector<char> counts(n, 1);
  const std::array<long, 2> all = balance(counts);
  const int mainly = all[1] > all[0] ? 1 : -1;
  std::vector<long> against(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      if (c.sense(i, j) != -mainly) continue;
      ++against[i];
      ++against[j];
    }
  }
  const std::size_t spare = std::max<std::size_t>(1, n / 20);
  for (std::size_t k = 0; k < spare; ++k) {
    const auto worst = std::ranges::max_element(against);
    if (worst == against.end() || *worst == 0) break;
    counts[static_cast<std::size_t>(worst - against.begin())] = 0;
    *worst = 0;
  }
  constexpr double kLeast = 0.98;
  const std::array<long, 2> kept = balance(counts);
  const auto differ = static_cast<double>(kept[0] + kept[1]);
  return differ > 0.0 && std::abs(static_cast<double>(kept[1] - kept[0])) >= kLeast * differ;
}

/// Whether a temperature was set: it takes a few values, each within a fifth of the range, most of
/// which a session holds for three lines or more.  One that is read moves in one sense because time
/// does.
bool is_set_temperature(const MeasurementSet& data) {
  const std::vector<Levels> levels = covariate_levels(data);
  const auto temperature = std::ranges::find(levels, "temperature", &Levels::name);
  if (temperature == levels.end() || temperature->binned) return false;
  constexpr int kHeld = 3;
  constexpr double kNarrow = 0.2;
  std::map<std::pair<int, int>, int> lines;  // by session and level
  std::vector<ValueRange> width(static_cast<std::size_t>(temperature->count));
  ValueRange all;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const Condition& c = data.rows[i].condition;
    if (temperature->of[i] < 0) continue;
    ++lines[{c.run, temperature->of[i]}];
    width[static_cast<std::size_t>(temperature->of[i])].extend(c.temperature_K);
    all.extend(c.temperature_K);
  }
  const bool narrow = std::ranges::all_of(
      width, [&](const ValueRange& w) { return w.high - w.low <= kNarrow * (all.high - all.low); });
  if (!narrow) return false;
  const auto held = std::ranges::count_if(lines, [](const auto& l) { return l.second >= kHeld; });
  return 2 * held >= static_cast<std::ptrdiff_t>(lines.size());
}

}  // namespace

std::string_view lines_sorted_by(const MeasurementSet& data) {
  const auto sorted_by = [&](const auto& get) { return is_sorted(by_line(data, get)); };
  // What follows the line before without that, as a temperature that is read does, was measured so;
  // an angle may go on by itself.
  if (sorted_by([](const Condition& c) { return c.output_torque_Nm; })) return "output torque";
  if (sorted_by([](const Condition& c) { return c.sun_speed_rad_s; })) return "sun speed";
  if (sorted_by([](const Condition& c) { return c.test_torque_Nm; })) return "test torque";
  if (sorted_by([](const Condition& c) { return c.temperature_K; }) && is_set_temperature(data)) {
    return "temperature";
  }
  if (sorted_by([](const Condition& c) { return c.rotation; })) return "rotation";
  if (sorted_by([](const Condition& c) { return c.driving_teeth; })) return "teeth";
  if (sorted_by([](const Condition& c) { return c.driven_teeth; })) return "teeth";
  if (sorted_by([](const Condition& c) { return c.module_m; })) return "module";
  const auto backward = [](const Condition& c) {
    return c.direction == design::Direction::kForward ? 0 : 1;
  };
  return sorted_by(backward) ? "direction" : "";
}

ReadingOrder reading_order(const MeasurementSet& data) {
  // Rows of one loop share more than their neighbourhood.
  if (data.kind == Kind::kTorqueAngle || data.rows.empty()) return {};
  const auto stated = [&](double Condition::*member) {
    return std::ranges::all_of(
        data.rows, [&](const Observation& row) { return std::isfinite(row.condition.*member); });
  };
  double Condition::*clock = nullptr;
  if (stated(&Condition::time_s)) {
    clock = &Condition::time_s;
  } else if (stated(&Condition::cycles)) {
    clock = &Condition::cycles;
  } else if (!lines_sorted_by(data).empty()) {
    return {};
  }
  ReadingOrder order{.row = std::vector<int>(data.rows.size()), .step = {}};
  std::iota(order.row.begin(), order.row.end(), 0);
  const auto session = [&](int i) {
    const Observation& row = data.rows[static_cast<std::size_t>(i)];
    return std::pair(row.condition.run, row.condition.run < 0 ? row.file : 0);
  };
  std::ranges::stable_sort(order.row, [&](int a, int b) {
    if (session(a) != session(b)) return session(a) < session(b);
    if (clock == nullptr) return false;
    return data.rows[static_cast<std::size_t>(a)].condition.*clock <
           data.rows[static_cast<std::size_t>(b)].condition.*clock;
  });
  order.step.reserve(order.row.size());
  for (std::size_t k = 0; k < order.row.size(); ++k) {
    const bool first = k == 0 || session(order.row[k - 1]) != session(order.row[k]);
    order.step.push_back(first ? 0 : 1);
  }
  return order;
}

ReadingOrder subset_of(const ReadingOrder& order, const std::vector<std::size_t>& rows) {
  if (!order.known()) return {};
  std::vector<int> place(order.row.size(), -1);
  for (std::size_t k = 0; k < rows.size(); ++k) place[rows[k]] = static_cast<int>(k);
  ReadingOrder part;
  int since = 0;
  bool first = true;
  for (std::size_t k = 0; k < order.row.size(); ++k) {
    since += order.step[k];
    first = first || order.step[k] == 0;
    const int at = place[static_cast<std::size_t>(order.row[k])];
    if (at < 0) continue;
    part.row.push_back(at);
    part.step.push_back(first ? 0 : since);
    since = 0;
    first = false;
  }
  return part;
}

MemoryFilter::MemoryFilter(const ReadingOrder& order, const NoiseMemory& memory) : order_(order) {
  const std::size_t n = order.row.size();
  fade_.resize(n);
  gain_.resize(n);
  unit_.resize(n);
  const double own = 1.0 - memory.share;
  double variance = memory.share;  // of what is remembered, given the rows before
  for (std::size_t k = 0; k < n; ++k) {
    fade_[k] = order.step[k] == 0 ? 0.0 : std::pow(memory.decay, order.step[k]);
    variance = memory.share + fade_[k] * fade_[k] * (variance - memory.share);
    const double total = variance + own;
    gain_[k] = variance / total;
    unit_[k] = 1.0 / std::sqrt(total);
    variance *= own / total;
    log_determinant_ += std::log(total);
  }
}

void MemoryFilter::whiten(Eigen::MatrixXd& columns) const {
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    double state = 0.0;
    for (std::size_t k = 0; k < order_.row.size(); ++k) {
      double& x = columns(order_.row[k], c);
      state *= fade_[k];
      const double off = x - state;
      state += gain_[k] * off;
      x = off * unit_[k];
    }
  }
}

}  // namespace gear3k::calibrate
