#include "calibrate/fit/holdout.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/causes/reading_change.hpp"
#include "calibrate/measurement/row_selection.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate {

std::optional<Blocks> blocks_along(std::string_view name, const std::vector<Levels>& levels) {
  constexpr int kFewest = 3;
  const auto at = std::ranges::find(levels, name, &Levels::name);
  if (at == levels.end() || at->count < kFewest) return std::nullopt;
  Blocks blocks{.name = at->name, .of = at->of, .count = at->count};
  for (int& of : blocks.of) of = std::max(of, 0);
  return blocks;
}

namespace {

/// The condition that a cause is a law of, as covariate_levels() names it; empty: of none.
std::string_view condition_of(const Cause& cause) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kLaws{
      {{"friction_load", "load"},
       {"friction_speed", "speed"},
       {"friction_temperature", "temperature"},
       {"compliance", "test torque"}}};
  const auto* const law =
      std::ranges::find(kLaws, cause.id, &std::pair<std::string_view, std::string_view>::first);
  return law == kLaws.end() ? "" : law->second;
}

}  // namespace

bool bends_with_levels(const Hypothesis& h, std::string_view condition,
                       const std::vector<Levels>& levels) {
  const auto along = std::ranges::find(levels, condition, &Levels::name);
  if (along == levels.end() || along->binned) return false;
  return std::ranges::any_of(h.effects, [&](const Candidate& c) {
    return static_cast<int>(c.parameters.size()) + 1 >= along->count &&
           condition_of(*c.cause) == condition;
  });
}

Blocks holdout_blocks(const MeasurementSet& data, const std::vector<Levels>& levels,
                      const Hypothesis& h) {
  constexpr int kFewest = 3;
  Blocks blocks;
  if (data.kind == Kind::kPairLoss) {
    std::map<int, int> pinions;
    for (const Observation& row : data.rows) {
      const int teeth = std::min(row.condition.driving_teeth, row.condition.driven_teeth);
      const auto [at, inserted] = pinions.emplace(teeth, static_cast<int>(pinions.size()));
      blocks.of.push_back(at->second);
    }
    blocks.name = "pinion";
    blocks.count = static_cast<int>(pinions.size());
    if (blocks.count >= kFewest) return blocks;
  }
  bool bends = false;
  for (const char* name : {"load", "test torque", "speed", "run"}) {
    auto along = blocks_along(name, levels);
    if (!along) continue;
    if (!bends_with_levels(h, name, levels)) return *std::move(along);
    bends = true;
  }
  if (bends) return {.name = "", .of = std::vector<int>(data.rows.size(), 0), .count = 1};
  return parts_of_rows(data);
}

Blocks parts_of_rows(const MeasurementSet& data) {
  Blocks blocks;
  const std::size_t n = data.rows.size();
  const bool turns = std::ranges::all_of(
      data.rows, [](const auto& row) { return std::isfinite(row.condition.output_angle_rad); });
  constexpr int kParts = 10;
  blocks.of.assign(n, 0);
  blocks.count = std::min<int>(kParts, static_cast<int>(n));
  blocks.name = turns ? "angle" : "rows";
  for (std::size_t i = 0; i < n; ++i) {
    if (turns) {
      const double turn = data.rows[i].condition.output_angle_rad / (2.0 * std::numbers::pi);
      blocks.of[i] =
          std::min(static_cast<int>((turn - std::floor(turn)) * blocks.count), blocks.count - 1);
    } else {
      blocks.of[i] = static_cast<int>(i * static_cast<std::size_t>(blocks.count) / n);
    }
  }
  return blocks;
}

int last_session(const MeasurementSet& data, const Blocks& blocks) {
  if (blocks.name != "run" || data.rows.empty()) return -1;
  const auto last = std::ranges::max_element(
      data.rows, {}, [](const Observation& row) { return row.condition.run; });
  return blocks.of[static_cast<std::size_t>(last - data.rows.begin())];
}

namespace {

/// ln of the information of some parameters, the others free: det(N)/det(N_others).
double log_information(const Eigen::MatrixXd& normal, const std::vector<bool>& of) {
  std::vector<Eigen::Index> others;
  for (std::size_t k = 0; k < of.size(); ++k) {
    if (!of[k]) others.push_back(static_cast<Eigen::Index>(k));
  }
  const auto log_det = [](const Eigen::MatrixXd& n) {
    return n.size() == 0 ? 0.0 : numerics::symmetric_eigenvalues(n).array().log().sum();
  };
  return log_det(normal) - log_det(normal(others, others));
}

/// What all rows and those outside each block say of a hypothesis' parameters, along its
/// linearisation.
class WithoutBlocks {
 public:
  WithoutBlocks(const Problem& problem, const Hypothesis& hypothesis, const Blocks& blocks)
      : at_(linearise(problem, hypothesis, {})) {
    const Eigen::Index p = at_.own.cols();
    Eigen::MatrixXd plain(at_.own.rows(), p + 1);
    plain << measured(problem.data) - at_.simulated, at_.own;
    Eigen::MatrixXd white = plain;
    problem.noise.whiten(white);
    const double bound = robust_deviation(white.col(0));
    const Eigen::MatrixXd j = white.rightCols(p);
    const Eigen::VectorXd r = winsorised(white.col(0), bound);
    normal_ = j.transpose() * j;
    const Eigen::VectorXd moment = j.transpose() * r;
    rest_normal_.assign(static_cast<std::size_t>(blocks.count), normal_);
    rest_moment_.assign(rest_normal_.size(), moment);
    if (problem.noise.mixes_rows()) {
      whiten_rests(problem.noise, blocks, plain, bound);
    } else {
      for (Eigen::Index i = 0; i < j.rows(); ++i) {
        const auto b = static_cast<std::size_t>(blocks.of[static_cast<std::size_t>(i)]);
        rest_normal_[b] -= j.row(i).transpose() * j.row(i);
        rest_moment_[b] -= j.row(i).transpose() * r[i];
      }
    }
    // In units in which the full data determine every parameter equally well.
    unit_ = normal_.diagonal().cwiseSqrt().cwiseInverse();
  }

  [[nodiscard]] const Linearisation& at() const { return at_; }

  /// How the parameters change without a block; empty where they are not determined.
  /// @param optional  parameters, by their places, that the block alone may show: NaN where it
  /// does; empty: none
  [[nodiscard]] Eigen::VectorXd change(std::size_t b, const Shown& shown,
                                       const std::vector<bool>& optional = {}) const {
    const Eigen::MatrixXd left = left_of(b);
    std::vector<Eigen::Index> seen;
    std::vector<std::vector<bool>> asked(1);  // together, then each by itself
    std::vector<std::size_t> alone;
    for (Eigen::Index k = 0; k < left.rows(); ++k) {
      const auto place = static_cast<std::size_t>(k);
      if (!optional.empty() && optional[place] && !(left(k, k) > kDetermined)) continue;
      if (!shown.each.empty() && shown.each[place]) alone.push_back(seen.size());
      seen.push_back(k);
      asked[0].push_back(!shown.together.empty() && shown.together[place]);
    }
    for (const std::size_t k : alone) {
      asked.emplace_back(seen.size(), false);
      asked.back()[k] = true;
    }
    Eigen::VectorXd change = Eigen::VectorXd::Constant(left.rows(), kUnknown);
    if (seen.empty()) return change;
    const Eigen::MatrixXd of_seen = left(seen, seen);
    if (!(numerics::symmetric_eigenvalues(of_seen)[0] > kDetermined)) return {};
    const Eigen::MatrixXd all = unit_.asDiagonal() * normal_ * unit_.asDiagonal();
    for (const std::vector<bool>& some : asked) {
      const auto count = static_cast<double>(std::ranges::count(some, true));
      if (!(count > 0.0)) continue;
      const double more = log_information(of_seen, some) - log_information(all(seen, seen), some);
      if (more < count * std::log(shown.least)) return {};
    }
    const Eigen::VectorXd moment = moment_of(b)(seen);
    const Eigen::VectorXd solved = numerics::solve_symmetric(of_seen, moment);
    for (std::size_t k = 0; k < seen.size(); ++k) {
      change[seen[k]] = unit_[seen[k]] * solved[static_cast<Eigen::Index>(k)];
    }
    return change;
  }

  /// Standard deviation of what the rows outside a block, each of deviation 1, predict.
  [[nodiscard]] double deviation(std::size_t b, const Eigen::RowVectorXd& by_parameters) const {
    const Eigen::VectorXd x = unit_.cwiseProduct(by_parameters.transpose());
    return std::sqrt(std::max(0.0, x.dot(numerics::solve_symmetric(left_of(b), x))));
  }

 private:
  static constexpr double kDetermined = 1e-9;

  /// Whitened rows that hold others say something of those: the rows outside each block are
  /// whitened by themselves.
  /// @param plain  residual and derivatives, not whitened
  void whiten_rests(const NoiseModel& noise, const Blocks& blocks, const Eigen::MatrixXd& plain,
                    double bound) {
    for (std::size_t b = 0; b < rest_normal_.size(); ++b) {
      std::vector<std::size_t> outside;
      for (std::size_t i = 0; i < blocks.of.size(); ++i) {
        if (blocks.of[i] != static_cast<int>(b)) outside.push_back(i);
      }
      Eigen::MatrixXd white = plain(outside, Eigen::all);
      subset_of(noise, outside).whiten(white);
      const Eigen::MatrixXd j = white.rightCols(white.cols() - 1);
      rest_normal_[b] = j.transpose() * j;
      rest_moment_[b] = j.transpose() * winsorised(white.col(0), bound);
    }
  }

  [[nodiscard]] Eigen::MatrixXd left_of(std::size_t b) const {
    return unit_.asDiagonal() * rest_normal_[b] * unit_.asDiagonal();
  }
  [[nodiscard]] Eigen::VectorXd moment_of(std::size_t b) const {
    return unit_.asDiagonal() * rest_moment_[b];
  }

  Linearisation at_;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd unit_;
  // Of the rows outside each block.
  std::vector<Eigen::MatrixXd> rest_normal_;
  std::vector<Eigen::VectorXd> rest_moment_;
};

/// Of a drift's form, the span that ends at the last of some rows.
void end_drift_at_last_row(Form& form, const MeasurementSet& data) {
  const auto constant = [&](std::string_view name) -> double& {
    return std::ranges::find(form.constants, name, &FormConstant::name)->value;
  };
  const bool by_cycles = form.name.find("_cycles") != std::string::npos;
  const ValueRange range = range_of(data, by_cycles ? &Condition::cycles : &Condition::time_s);
  if (range.known()) constant("span") = range.high - constant("start");
}

bool acts_when_measured(const Candidate& c) { return c.cause->leave_behind != nullptr; }

bool gives_value_to_each(const Candidate& c) { return gives_each_session_a_value(c.form); }

/// The rows of a block, or those of all others.
MeasurementSet rows_of(const MeasurementSet& data, const Blocks& blocks, int block, bool inside) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if ((blocks.of[i] == block) == inside) places.push_back(i);
  }
  return select_rows(data, places);
}

/// Which parameters are of causes that act by when a row was measured: a session that alone shows
/// them says nothing of the others, where they are 0.
std::vector<bool> of_when_measured(const Hypothesis& h) {
  std::vector<bool> result;
  for (const Candidate& c : h.effects) {
    result.insert(result.end(), c.parameters.size(), acts_when_measured(c));
  }
  return result;
}

/// What a fit without a block says of later rows: a step that the block alone shows is none, and a
/// drift ends at the last of the rows.
/// @param change  NaN for such a step
Hypothesis fit_without(const Hypothesis& h, const Eigen::VectorXd& change,
                       const MeasurementSet& rest) {
  Hypothesis later = h;
  later.left_behind = true;
  std::size_t first = 0;
  for (Candidate& c : later.effects) {
    for (std::size_t k = 0; k < c.parameters.size(); ++k) {
      double& value = later.value[first + k];
      value += change[static_cast<Eigen::Index>(first + k)];
      value = std::isfinite(value) ? std::clamp(value, c.parameters[k].lower, c.parameters[k].upper)
                                   : 0.0;
    }
    if (c.cause->id == "drift") end_drift_at_last_row(c.form, rest);
    first += c.parameters.size();
  }
  return later;
}

}  // namespace

Shown shown_by_bends(const Hypothesis& h, const Blocks& blocks) {
  const auto bends = [](const Candidate& c) {
    return is_smooth(c.form) || std::ranges::find(c.parameters, "curvature",
                                                  &ParameterRecord::name) != c.parameters.end();
  };
  Shown shown;
  constexpr double kSaysNothing = 2.0;
  if (blocks.name != "run" && std::ranges::any_of(h.effects, bends)) {
    shown.most_deviation = kSaysNothing;
  }
  return shown;
}

void forget_beyond(const Hypothesis& h, const Blocks& blocks, const std::vector<Levels>& levels,
                   Eigen::VectorXd& predicted) {
  for (const Candidate& c : h.effects) {
    if (c.form.weight > 0.0) continue;
    const auto along = std::ranges::find(levels, condition_of(*c.cause), &Levels::name);
    if (along == levels.end()) continue;
    // Of each level the block of its rows; -1: none, -2: several.
    std::vector<int> alone(static_cast<std::size_t>(along->count), -1);
    for (std::size_t i = 0; i < blocks.of.size(); ++i) {
      if (along->of[i] < 0) continue;
      int& block = alone[static_cast<std::size_t>(along->of[i])];
      block = block == -1 || block == blocks.of[i] ? blocks.of[i] : -2;
    }
    // A block alone at an end leaves the others without it.
    const auto of_end = [&](auto first, auto last) {
      const auto end = std::find_if(first, last, [](int block) { return block != -1; });
      if (end == last || *end == -2) return std::pair(-1, end);
      return std::pair(*end, std::find_if(end, last, [&](int b) { return b != -1 && b != *end; }));
    };
    const auto [lowest, low_end] = of_end(alone.begin(), alone.end());
    const auto [highest, high_end] = of_end(alone.rbegin(), alone.rend());
    const auto least = low_end - alone.begin();
    const auto most = alone.rend() - high_end - 1;
    for (std::size_t i = 0; i < blocks.of.size(); ++i) {
      if (along->of[i] < 0) continue;
      if ((blocks.of[i] == lowest && along->of[i] < least) ||
          (blocks.of[i] == highest && along->of[i] > most)) {
        predicted[static_cast<Eigen::Index>(i)] = kUnknown;
      }
    }
  }
}

Eigen::VectorXd predict_held_out(const Problem& problem, const Hypothesis& hypothesis,
                                 const Blocks& blocks, const Shown& shown) {
  if (hypothesis.value.empty()) return linearise(problem, hypothesis, {}).simulated;
  const WithoutBlocks without(problem, hypothesis, blocks);
  std::vector<Eigen::VectorXd> change(static_cast<std::size_t>(blocks.count));
  const std::vector<ParameterRecord> records = parameters_of(hypothesis);
  for (std::size_t b = 0; b < change.size(); ++b) {
    change[b] = without.change(b, shown);
    // A fit without the block keeps to the bounds.
    for (Eigen::Index k = 0; k < change[b].size(); ++k) {
      const auto place = static_cast<std::size_t>(k);
      const double value = hypothesis.value[place];
      const ParameterRecord& record = records[place];
      change[b][k] = std::clamp(value + change[b][k], std::min(record.lower, value),
                                std::max(record.upper, value)) -
                     value;
    }
  }
  Eigen::VectorXd predicted = without.at().simulated;
  for (Eigen::Index i = 0; i < predicted.size(); ++i) {
    const auto b = static_cast<std::size_t>(blocks.of[static_cast<std::size_t>(i)]);
    const auto row = without.at().own.row(i);
    const bool known =
        change[b].size() > 0 &&
        (std::isinf(shown.most_deviation) ||
         problem.noise.weight[i] * without.deviation(b, row) <= shown.most_deviation);
    predicted[i] = known ? predicted[i] + row.dot(change[b]) : kUnknown;
  }
  return predicted;
}

std::vector<Eigen::Index> known_rows(const Eigen::VectorXd& predicted) {
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < predicted.size(); ++i) {
    if (std::isfinite(predicted[i])) known.push_back(i);
  }
  if (2 * static_cast<Eigen::Index>(known.size()) < predicted.size()) known.clear();
  return known;
}

Eigen::VectorXd predict_left_out(const Problem& problem, const Hypothesis& hypothesis,
                                 const Blocks& blocks, const Shown& shown) {
  Eigen::VectorXd predicted = predict_held_out(problem, hypothesis, blocks, shown);
  const MeasurementSet& data = problem.data;
  // What a session of a value of its own would be without its rows is not known.
  if (last_session(data, blocks) < 0 ||
      std::ranges::none_of(hypothesis.effects, acts_when_measured) ||
      std::ranges::any_of(hypothesis.effects, gives_value_to_each)) {
    return predicted;
  }
  const int last_block = last_session(data, blocks);
  const WithoutBlocks without(problem, hypothesis, blocks);
  const Eigen::VectorXd change =
      without.change(static_cast<std::size_t>(last_block), shown, of_when_measured(hypothesis));
  if (change.size() == 0) return predicted;
  const MeasurementSet rows = rows_of(data, blocks, last_block, true);
  const Problem later{.simulation = problem.simulation, .data = rows, .noise = {}};
  const Linearisation at = linearise(
      later, fit_without(hypothesis, change, rows_of(data, blocks, last_block, false)), {});
  Eigen::Index next = 0;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (blocks.of[i] != last_block) continue;
    predicted[static_cast<Eigen::Index>(i)] = at.runs ? at.simulated[next] : kUnknown;
    ++next;
  }
  return predicted;
}

bool predicts_no_worse(const Problem& problem, const Eigen::VectorXd& predicted,
                       const Eigen::VectorXd& by_other, double scale) {
  const Eigen::VectorXd y = measured(problem.data);
  double worse = 0.0;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (!std::isfinite(predicted[i]) || !std::isfinite(by_other[i])) continue;
    const double unit = scale / problem.noise.weight[i];
    worse += huber_square((y[i] - predicted[i]) / unit) - huber_square((y[i] - by_other[i]) / unit);
  }
  return worse <= 0.0;
}

Extrapolation extrapolate(const Problem& problem, const Hypothesis& h,
                          const std::vector<Levels>& levels, const Eigen::VectorXd& y,
                          const Eigen::VectorXd& baseline) {
  Extrapolation result;
  for (const char* name : {"load", "speed", "test torque"}) {
    const auto at = std::ranges::find(levels, name, &Levels::name);
    if (at == levels.end() || at->count < 3 || bends_with_levels(h, name, levels)) continue;
    Blocks blocks{.name = name, .of = {}, .count = 2};
    for (const int level : at->of) blocks.of.push_back(level == at->count - 1 ? 1 : 0);
    const Eigen::VectorXd predicted = predict_held_out(problem, h, blocks);
    double before = 0.0;
    double after = 0.0;
    for (std::size_t i = 0; i < blocks.of.size(); ++i) {
      if (blocks.of[i] == 0) continue;
      const auto k = static_cast<Eigen::Index>(i);
      before += (y[k] - baseline[k]) * (y[k] - baseline[k]);
      after += (y[k] - predicted[k]) * (y[k] - predicted[k]);
      ++result.rows;
    }
    result.along = name;
    result.left_out = at->at.back();
    result.baseline = std::sqrt(before / result.rows);
    result.extended = std::sqrt(after / result.rows);
    return result;
  }
  return result;
}

}  // namespace gear3k::calibrate
