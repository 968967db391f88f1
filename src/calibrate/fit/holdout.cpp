#include "calibrate/fit/holdout.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

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

bool bends_with_levels(const Hypothesis& h, std::string_view condition,
                       const std::vector<Levels>& levels) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kLaws{
      {{"load", "friction_load"}, {"speed", "friction_speed"}}};
  const auto along = std::ranges::find(levels, condition, &Levels::name);
  if (along == levels.end() || along->binned) return false;
  return std::ranges::any_of(h.effects, [&](const Candidate& c) {
    return static_cast<int>(c.parameters.size()) + 1 >= along->count &&
           std::ranges::any_of(kLaws, [&](const auto& law) {
             return law.first == condition && law.second == c.cause->id;
           });
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

}  // namespace

Eigen::VectorXd predict_held_out(const Problem& problem, const Hypothesis& hypothesis,
                                 const Blocks& blocks, const Shown& shown) {
  const Linearisation at = linearise(problem, hypothesis, {});
  Eigen::VectorXd predicted = at.simulated;
  const Eigen::Index p = at.own.cols();
  if (p == 0) return predicted;
  Eigen::MatrixXd white(at.own.rows(), p + 1);
  white << measured(problem.data) - at.simulated, at.own;
  problem.noise.whiten(white);
  const Eigen::MatrixXd j = white.rightCols(p);
  const Eigen::VectorXd r = winsorised(white.col(0), robust_deviation(white.col(0)));
  const Eigen::MatrixXd normal = j.transpose() * j;
  const Eigen::VectorXd moment = j.transpose() * r;
  std::vector<Eigen::MatrixXd> block_normal(static_cast<std::size_t>(blocks.count),
                                            Eigen::MatrixXd::Zero(p, p));
  std::vector<Eigen::VectorXd> block_moment(block_normal.size(), Eigen::VectorXd::Zero(p));
  for (Eigen::Index i = 0; i < j.rows(); ++i) {
    const auto b = static_cast<std::size_t>(blocks.of[static_cast<std::size_t>(i)]);
    block_normal[b] += j.row(i).transpose() * j.row(i);
    block_moment[b] += j.row(i).transpose() * r[i];
  }
  std::vector<Eigen::VectorXd> change(block_normal.size());
  // In units in which the full data determine every parameter equally well.
  const Eigen::VectorXd unit = normal.diagonal().cwiseSqrt().cwiseInverse();
  const auto asked = static_cast<double>(std::ranges::count(shown.of, true));
  const double all =
      asked > 0.0 ? log_information(unit.asDiagonal() * normal * unit.asDiagonal(), shown.of) : 0.0;
  for (std::size_t b = 0; b < change.size(); ++b) {
    const Eigen::MatrixXd left = unit.asDiagonal() * (normal - block_normal[b]) * unit.asDiagonal();
    constexpr double kDetermined = 1e-9;
    if (!(numerics::symmetric_eigenvalues(left)[0] > kDetermined)) continue;
    if (asked > 0.0 && log_information(left, shown.of) - all < asked * std::log(shown.least)) {
      continue;
    }
    change[b] = unit.asDiagonal() *
                numerics::solve_symmetric(left, unit.asDiagonal() * (moment - block_moment[b]));
  }
  for (Eigen::Index i = 0; i < predicted.size(); ++i) {
    const auto b = static_cast<std::size_t>(blocks.of[static_cast<std::size_t>(i)]);
    predicted[i] = change[b].size() == 0 ? kUnknown : predicted[i] + at.own.row(i).dot(change[b]);
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
