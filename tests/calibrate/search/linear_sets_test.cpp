#include "calibrate/search/linear_sets.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/linear_algebra.hpp"
#include "tests/calibrate/rig_campaign.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::linear_sets_test {
namespace {

constexpr int kRows = 40;

class Sets : public testing::Test {
 protected:
  Sets() : simulation_(some_black_box(), Kind::kTransmission) {
    rig::DeterministicRandom random(9);
    columns_.other = Eigen::MatrixXd(kRows, 6);
    columns_.own = Eigen::MatrixXd(kRows, 0);
    columns_.residual = Eigen::VectorXd(kRows);
    for (int i = 0; i < kRows; ++i) {
      for (int k = 0; k < 5; ++k) columns_.other(i, k) = random.between(-1.0, 1.0);
      // The last column is one of the others in another unit.
      columns_.other(i, 5) = 1e6 * columns_.other(i, 0);
      columns_.residual[i] = 0.8 * columns_.other(i, 1) - 0.5 * columns_.other(i, 2) +
                             0.3 * columns_.other(i, 4) + random.between(-0.2, 0.2);
    }
    data_.rows.resize(kRows);
    for (const int first : {0, 1, 2, 5}) blocks_.push_back({.first = first, .count = 1});
    blocks_.push_back({.first = 3, .count = 2});
  }
  [[nodiscard]] Problem problem() const {
    return {.simulation = simulation_, .data = data_, .noise = make_noise_model(data_)};
  }
  /// −(n/2) ln S − (p/2) ln n, with S by a QR decomposition.
  [[nodiscard]] double expected(const std::vector<Eigen::Index>& at) const {
    const Eigen::MatrixXd a = columns_.other(Eigen::all, at);
    const Eigen::VectorXd x = numerics::least_squares(a, columns_.residual);
    const double left = (columns_.residual - a * x).squaredNorm();
    return -0.5 * kRows * std::log(left) -
           0.5 * static_cast<double>(at.size()) * std::log(static_cast<double>(kRows));
  }

  Simulation simulation_;
  MeasurementSet data_;
  Columns columns_;
  std::vector<Block> blocks_;
};

TEST_F(Sets, ScoreWhatLeastSquaresLeave) {
  const LinearSets sets(columns_, blocks_, problem());
  EXPECT_NEAR(sets.score({1}), expected({1}), 1e-9);
  EXPECT_NEAR(sets.score({1, 2}), expected({1, 2}), 1e-9);
  EXPECT_NEAR(sets.score({1, 2, 4}), expected({1, 2, 3, 4}), 1e-9);
}

TEST_F(Sets, OfDependentColumnsNeverWin) {
  const LinearSets sets(columns_, blocks_, problem());
  EXPECT_EQ(sets.score({0, 3}), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(sets.score({1, 3})));
}

TEST_F(Sets, OfASidedParameterNeedItsSign) {
  std::vector<Block> sided = blocks_;
  sided[1].side = 1;
  sided[2].side = 1;
  const LinearSets sets(columns_, sided, problem());
  EXPECT_TRUE(std::isfinite(sets.score({1})));
  EXPECT_EQ(sets.score({1, 2}), -std::numeric_limits<double>::infinity());
}

TEST_F(Sets, PayForTheirWeights) {
  std::vector<Block> weighted = blocks_;
  weighted[1].log_weight = std::log(0.3);
  weighted[2].log_weight = std::log(0.5);
  EXPECT_NEAR(LinearSets(columns_, weighted, problem()).score({1, 2}),
              expected({1, 2}) + std::log(0.15), 1e-9);
}

TEST_F(Sets, BestAreThoseOfAllSetsWithACauseEach) {
  std::vector<Candidate> candidates{
      candidate("friction_level", {.name = "coefficient"}),
      candidate("drag_constant", {.name = "sun"}), candidate("sensor_offset", {.name = "offset"}),
      candidate("sensor_gain", {.name = "gain"}), candidate("drag_constant", {.name = "output"})};
  const LinearSets sets(columns_, blocks_, problem());
  const std::vector<std::size_t> pool{0, 1, 2, 3, 4};
  for (const int size : {2, 3}) {
    // By counting through all subsets.
    std::vector<std::pair<double, std::vector<std::size_t>>> all;
    for (unsigned bits = 0; bits < 32; ++bits) {
      std::vector<std::size_t> set;
      for (std::size_t k = 0; k < 5; ++k) {
        if ((bits >> k & 1U) != 0U) set.push_back(k);
      }
      const bool both_drags = (bits & 0b10010U) == 0b10010U;
      if (static_cast<int>(set.size()) != size || both_drags) continue;
      if (std::isfinite(sets.score(set))) all.emplace_back(sets.score(set), set);
    }
    std::ranges::sort(all, std::greater<>());
    // Of two sets of the same causes, which differ by the form of the drag, the better one.
    std::set<std::set<std::size_t>> known;
    std::erase_if(all, [&](const auto& one) {
      std::set<std::size_t> causes;
      for (const std::size_t k : one.second) causes.insert(k == 4 ? 1 : k);
      return !known.insert(causes).second;
    });
    const auto best = best_linear_sets(candidates, pool, sets, size, 3);
    ASSERT_EQ(best.size(), std::min<std::size_t>(3, all.size()));
    ASSERT_GE(best.size(), 2U);
    for (std::size_t k = 0; k < best.size(); ++k) {
      EXPECT_EQ(sets.score(best[k]), all[k].first);
      EXPECT_TRUE(std::ranges::any_of(all, [&](const auto& a) { return a.second == best[k]; }));
    }
    EXPECT_NE(best[0], best[1]);
  }
}

}  // namespace
}  // namespace gear3k::calibrate::linear_sets_test
