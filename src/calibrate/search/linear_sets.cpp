#include "calibrate/search/linear_sets.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

namespace gear3k::calibrate {

LinearSets::LinearSets(const Columns& columns, std::vector<Block> blocks, const Problem& problem)
    : blocks_(std::move(blocks)),
      gram_(columns.other.transpose() * columns.other),
      moment_(columns.other.transpose() * columns.residual),
      total_(columns.residual.squaredNorm()),
      rows_(static_cast<double>(columns.residual.size())),
      known_(problem.noise.known_scale()) {}

std::optional<LinearSets::Left> LinearSets::left_by(const std::vector<std::size_t>& set) const {
  std::array<Eigen::Index, kMostParameters> column{};
  Eigen::Index count = 0;
  for (const std::size_t b : set) {
    for (Eigen::Index k = 0; k < blocks_[b].count; ++k) {
      if (count == kMostParameters) return std::nullopt;
      column[static_cast<std::size_t>(count++)] = blocks_[b].first + k;
    }
  }
  using Small =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostParameters, kMostParameters>;
  using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostParameters, 1>;
  Small a(count, count);
  SmallVector m(count);
  SmallVector length(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index at = column[static_cast<std::size_t>(i)];
    length[i] = std::sqrt(gram_(at, at));
    if (!(length[i] > 0.0)) return std::nullopt;
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index at = column[static_cast<std::size_t>(i)];
    m[i] = moment_[at] / length[i];
    for (Eigen::Index j = 0; j < count; ++j) {
      a(i, j) = gram_(at, column[static_cast<std::size_t>(j)]) / (length[i] * length[j]);
    }
  }
  const Eigen::LLT<Small> factor(a);
  constexpr double kDependent = 1e-4;
  if (factor.info() != Eigen::Success ||
      factor.matrixL().toDenseMatrix().diagonal().minCoeff() < kDependent) {
    return std::nullopt;
  }
  const SmallVector x = factor.solve(m);
  Eigen::Index first = 0;
  for (const std::size_t b : set) {
    if (blocks_[b].side != 0 && x[first] * blocks_[b].side <= 0.0) return std::nullopt;
    first += blocks_[b].count;
  }
  return Left{.columns = count, .squares = std::max(total_ - m.dot(x), 1e-12 * total_)};
}

double LinearSets::score(const std::vector<std::size_t>& set) const {
  const std::optional<Left> left = left_by(set);
  if (!left) return -std::numeric_limits<double>::infinity();
  double log_weight = 0.0;
  for (const std::size_t b : set) log_weight += blocks_[b].log_weight;
  const double likelihood = known_ > 0.0 ? -0.5 * left->squares / (known_ * known_)
                                         : -0.5 * rows_ * std::log(left->squares);
  return likelihood - 0.5 * static_cast<double>(left->columns) * std::log(rows_) + log_weight;
}

double LinearSets::chance(const std::vector<std::size_t>& set) const {
  const std::optional<Left> left = left_by(set);
  if (!left) return 1.0;
  const auto columns = static_cast<int>(left->columns);
  const int rest = static_cast<int>(rows_) - columns;
  if (columns < 1 || rest < 1) return 1.0;
  return f_tail((total_ - left->squares) / columns / (left->squares / rest), columns, rest);
}

std::vector<std::vector<std::size_t>> best_linear_sets(const std::vector<Candidate>& candidates,
                                                       const std::vector<std::size_t>& pool,
                                                       const LinearSets& sets, int size, int most) {
  struct Ranked {
    double score;
    std::vector<std::size_t> set;
  };
  std::vector<Ranked> best;
  const auto cause_of = [&](std::size_t k) { return candidates[k].cause; };
  const auto consider = [&](std::vector<std::size_t> set) {
    const double score = sets.score(set);
    if (!std::isfinite(score)) return;
    // Causes have many forms: each set of causes in its best ones only.
    const auto known = std::ranges::find_if(best, [&](const Ranked& r) {
      return std::ranges::is_permutation(r.set, set, {}, cause_of, cause_of);
    });
    if (known != best.end()) {
      if (score <= known->score) return;
      best.erase(known);
    }
    if (static_cast<int>(best.size()) == most && score <= best.back().score) return;
    const auto at = std::ranges::upper_bound(best, score, std::greater<>(), &Ranked::score);
    best.insert(at, {.score = score, .set = std::move(set)});
    if (static_cast<int>(best.size()) > most) best.pop_back();
  };
  const auto alike = [&](std::size_t a, std::size_t b) {
    return candidates[a].cause == candidates[b].cause;
  };
  for (std::size_t i = 0; i < pool.size(); ++i) {
    for (std::size_t j = i + 1; j < pool.size(); ++j) {
      if (alike(pool[i], pool[j])) continue;
      if (size == 2) {
        consider({pool[i], pool[j]});
        continue;
      }
      for (std::size_t k = j + 1; k < pool.size(); ++k) {
        if (alike(pool[i], pool[k]) || alike(pool[j], pool[k])) continue;
        consider({pool[i], pool[j], pool[k]});
      }
    }
  }
  std::vector<std::vector<std::size_t>> result;
  result.reserve(best.size());
  for (Ranked& r : best) result.push_back(std::move(r.set));
  return result;
}

}  // namespace gear3k::calibrate
