#include "calibrate/fit/screen.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate::screen_test {
namespace {

/// Normal deviates of a generator that the implementation does not use.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : bits_(seed) {}
  double deviate() {
    // Box-Muller; std::normal_distribution differs between libraries.
    const double u = (static_cast<double>(bits_() >> 11U) + 0.5) * 0x1p-53;
    const double v = static_cast<double>(bits_() >> 11U) * 0x1p-53;
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
  }
  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd x(rows, columns);
    for (double& value : x.reshaped()) value = deviate();
    return x;
  }

 private:
  std::mt19937_64 bits_;
};

// −ln P(χ²_k ≥ x)

TEST(ChiSquareEvidence, IsThatOfTheDistribution) {
  for (int k = 1; k <= 12; ++k) {
    const boost::math::chi_squared distribution(k);
    for (const double x : {1e-3, 0.1, 1.0, 3.0, 10.0, 40.0, 150.0, 700.0}) {
      const double p = boost::math::cdf(boost::math::complement(distribution, x));
      EXPECT_NEAR(chi_square_evidence(x, k), -std::log(p), 1e-12 * (1.0 + x)) << k << ' ' << x;
    }
  }
}

TEST(ChiSquareEvidence, OfEvenDegreesIsAPoissonSum) {
  // Q(2m, x) = e^(−x/2) Σ_{j<m} (x/2)^j/j!; it holds far beyond where the tail underflows.
  for (const int m : {1, 2, 3, 5}) {
    for (const double x : {0.5, 20.0, 1100.0, 1199.0, 1201.0, 5000.0}) {
      double sum = 0.0;
      double term = 1.0;
      for (int j = 0; j < m; ++j) {
        sum += term / std::pow(0.5 * x, m - 1);
        term *= 0.5 * x / (j + 1);
      }
      const double exact = 0.5 * x - std::log(sum) - (m - 1) * std::log(0.5 * x);
      // Beyond 1200 only the leading term: the next is smaller by (m − 1)/(x/2).
      const double truncation = x > 1200.0 ? 1.2 * (m - 1) / (0.5 * x) : 0.0;
      EXPECT_NEAR(chi_square_evidence(x, 2 * m), exact, truncation + 1e-12 * (1.0 + x))
          << m << ' ' << x;
    }
  }
}

TEST(ChiSquareEvidence, MeetsPrintedQuantiles) {
  struct Quantile {
    double p;
    Eigen::Index degrees;
    double x;  // three decimals, as in any table
  };
  for (const auto& [p, degrees, x] :
       {Quantile{0.05, 1, 3.841}, Quantile{0.01, 1, 6.635}, Quantile{0.001, 1, 10.828},
        Quantile{0.05, 2, 5.991}, Quantile{0.01, 2, 9.210}, Quantile{0.05, 3, 7.815},
        Quantile{0.01, 3, 11.345}, Quantile{0.05, 10, 18.307}, Quantile{0.95, 10, 3.940}}) {
    EXPECT_LE(chi_square_evidence(x - 0.0005, degrees), -std::log(p)) << degrees << ' ' << p;
    EXPECT_GE(chi_square_evidence(x + 0.0005, degrees), -std::log(p)) << degrees << ' ' << p;
  }
}

TEST(ChiSquareEvidence, IsNoneWithoutAStatistic) {
  for (const double x : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    for (const Eigen::Index k : {1, 2, 5}) EXPECT_EQ(chi_square_evidence(x, k), 0.0);
  }
}

TEST(ChiSquareEvidence, GrowsWithoutAStepWhereTheTailUnderflows) {
  for (const Eigen::Index k : {1, 2, 3, 4, 9}) {
    double last = 0.0;
    for (double x = 1190.0; x < 1210.0; x += 0.25) {
      const double evidence = chi_square_evidence(x, k);
      // Slope ½ − (k/2 − 1)/x; the switch to the leading term may add its truncation once.
      if (last > 0.0) {
        EXPECT_GT(evidence, last) << k << ' ' << x;
        EXPECT_LT(evidence, last + 0.125 + 0.01) << k << ' ' << x;
      }
      last = evidence;
    }
  }
}

// Orthonormal basis

/// Greatest length that any column of x has outside the span of `of`.
double outside(const Eigen::MatrixXd& x, const Eigen::MatrixXd& of) {
  double greatest = 0.0;
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    const Eigen::VectorXd left = x.col(k) - of * numerics::least_squares(of, x.col(k));
    greatest = std::max(greatest, left.norm());
  }
  return greatest;
}

TEST(OrthonormalBasis, SpansTheColumnsWithoutThoseThatDepend) {
  Noise noise(1);
  Eigen::MatrixXd x = noise.matrix(20, 7);
  x.col(3) = 2.0 * x.col(0) - 5.0 * x.col(1);
  x.col(5).setZero();
  x.col(6) *= 1e-9;  // short, but a direction of its own
  const Eigen::MatrixXd basis = orthonormal_basis(x);
  ASSERT_EQ(basis.cols(), 5);
  EXPECT_LT((basis.transpose() * basis - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-14);
  EXPECT_LT(outside(x, basis), 1e-13);
  EXPECT_LT(outside(basis, x), 1e-13);
}

TEST(OrthonormalBasis, LeavesOutWhatAddsLessThanAMillionthOfItsLength) {
  Noise noise(2);
  Eigen::MatrixXd x = noise.matrix(30, 3);
  const Eigen::VectorXd across = orthonormal_basis(x).col(2);
  const Eigen::VectorXd along = x.col(0).normalized();
  for (const double share : {3e-6, 0.3e-6}) {
    Eigen::MatrixXd two(30, 2);
    two << along, 7.0 * (along + share * across);
    const Eigen::MatrixXd basis = orthonormal_basis(two);
    ASSERT_EQ(basis.cols(), share > 1e-6 ? 2 : 1);
    if (basis.cols() < 2) continue;
    EXPECT_LT(std::abs(basis.col(0).dot(basis.col(1))), 1e-14);
    // Rounding of the columns over the share.
    EXPECT_NEAR(std::abs(basis.col(1).dot(across)), 1.0, 1e-9);
  }
}

TEST(OrthonormalBasis, LeavesOutColumnsWithoutANumber) {
  Noise noise(3);
  Eigen::MatrixXd x = noise.matrix(10, 2);
  x(4, 0) = std::numeric_limits<double>::quiet_NaN();
  const Eigen::MatrixXd basis = orthonormal_basis(x);
  ASSERT_EQ(basis.cols(), 1);
  EXPECT_NEAR(std::abs(basis.col(0).dot(x.col(1).normalized())), 1.0, 1e-15);
  EXPECT_EQ(orthonormal_basis(Eigen::MatrixXd(10, 0)).cols(), 0);
}

// Gains

double least_squares(const Eigen::MatrixXd& x, const Eigen::VectorXd& y) {
  if (x.cols() == 0) return y.squaredNorm();
  return (y - x * numerics::least_squares(x, y)).squaredNorm();
}

Eigen::MatrixXd joined(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd both(std::max(a.rows(), b.rows()), a.cols() + b.cols());
  both << a, b;
  return both;
}

struct Setting {
  Eigen::MatrixXd own, columns;
  std::vector<Block> blocks;
  Eigen::VectorXd residual;
};

/// Blocks of one to three columns that are not orthogonal to what is fitted nor to each other.
Setting some_setting(std::uint64_t seed, Eigen::Index rows) {
  Noise noise(seed);
  Setting s;
  s.own = noise.matrix(rows, 2);
  s.columns = noise.matrix(rows, 6);
  s.columns.col(1) += 3.0 * s.own.col(0);
  s.columns.col(2) += 2.0 * s.columns.col(1);
  s.blocks = {{.first = 0, .count = 1, .side = 0, .log_weight = 0.0},
              {.first = 1, .count = 2, .side = 0, .log_weight = -1.5},
              {.first = 3, .count = 3, .side = 0, .log_weight = 0.0}};
  s.residual = noise.matrix(rows, 1).col(0) + 0.6 * s.columns.col(2) - 2.0 * s.own.col(1);
  return s;
}

TEST(Gains, AreWhatABlockTakesOffTheSumOfSquares) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Setting s = some_setting(seed, 25);
    const Screen screen(s.own, s.columns, s.blocks, 0.0);
    const auto gains = screen.gains(s.residual);
    const double before = least_squares(s.own, s.residual);
    for (std::size_t k = 0; k < gains.size(); ++k) {
      const Eigen::MatrixXd block = s.columns.middleCols(s.blocks[k].first, s.blocks[k].count);
      const double after = least_squares(joined(s.own, block), s.residual);
      EXPECT_NEAR(gains[k].sum_of_squares, before - after, 1e-12 * before);
    }
  }
}

TEST(Gains, WithoutAnythingFittedCountAllOfTheResidual) {
  const Setting s = some_setting(6, 25);
  const Screen screen(Eigen::MatrixXd(25, 0), s.columns, s.blocks, 0.0);
  const auto gains = screen.gains(s.residual);
  for (std::size_t k = 0; k < gains.size(); ++k) {
    const Eigen::MatrixXd block = s.columns.middleCols(s.blocks[k].first, s.blocks[k].count);
    EXPECT_NEAR(gains[k].sum_of_squares,
                s.residual.squaredNorm() - least_squares(block, s.residual), 1e-10);
  }
}

TEST(Gains, OfAKnownScaleAreChiSquare) {
  const Setting s = some_setting(7, 25);
  constexpr double kScale = 0.8;
  const Screen screen(s.own, s.columns, s.blocks, kScale);
  const auto gains = screen.gains(s.residual);
  for (std::size_t k = 0; k < gains.size(); ++k) {
    const double x = gains[k].sum_of_squares / (kScale * kScale);
    const boost::math::chi_squared law(static_cast<double>(s.blocks[k].count));
    const double p = boost::math::cdf(boost::math::complement(law, x));
    EXPECT_NEAR(gains[k].statistic, x, 1e-12 * x);
    EXPECT_NEAR(gains[k].evidence, -std::log(p) + s.blocks[k].log_weight, 1e-10);
  }
}

TEST(Gains, OfAnUnknownScaleAreNearlyThoseOfTheFTest) {
  constexpr Eigen::Index kRows = 122;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Setting s = some_setting(seed, kRows);
    const Screen screen(s.own, s.columns, s.blocks, 0.0);
    const auto gains = screen.gains(s.residual);
    for (std::size_t k = 0; k < gains.size(); ++k) {
      const auto p = static_cast<double>(s.blocks[k].count);
      const double left = static_cast<double>(kRows) - 2.0 - p;
      const Eigen::MatrixXd block = s.columns.middleCols(s.blocks[k].first, s.blocks[k].count);
      const double before = least_squares(s.own, s.residual);
      const double after = least_squares(joined(s.own, block), s.residual);
      const double f = (before - after) / p / (after / left);
      const boost::math::fisher_f law(p, left);
      const double exact = -std::log(boost::math::cdf(boost::math::complement(law, f)));
      // Of the second order in 1/left, but for the block of three: −½ in place of Bartlett's +½.
      const double found = gains[k].evidence - s.blocks[k].log_weight;
      EXPECT_NEAR(found, exact, 0.02 * exact) << seed << ' ' << k;
    }
  }
}

TEST(Gains, OfWhatIsFittedAlreadyAreNone) {
  Setting s = some_setting(8, 25);
  s.columns.col(0) = s.own.col(0) - 4.0 * s.own.col(1);
  s.columns.col(1) = s.own.col(1);  // of the second block one direction is left
  const Screen screen(s.own, s.columns, s.blocks, 0.0);
  const auto gains = screen.gains(s.residual);
  EXPECT_EQ(gains[0].sum_of_squares, 0.0);
  EXPECT_EQ(gains[0].evidence, 0.0);
  const Eigen::MatrixXd one = s.columns.col(2);
  const double before = least_squares(s.own, s.residual);
  EXPECT_NEAR(gains[1].sum_of_squares, before - least_squares(joined(s.own, one), s.residual),
              1e-12 * before);
}

TEST(Gains, OfASidedBlockCountOnlyOnItsSide) {
  constexpr double kScale = 1.1;
  int growing = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Noise noise(100 + seed);
    const Eigen::MatrixXd own = noise.matrix(15, 1);
    const Eigen::MatrixXd column = noise.matrix(15, 1) + own;
    const Eigen::VectorXd residual = noise.matrix(15, 1).col(0);
    const Eigen::MatrixXd both = joined(own, column);
    const double coefficient = numerics::least_squares(both, residual)[1];
    growing += coefficient > 0.0 ? 1 : 0;
    for (const int side : {1, -1}) {
      const Screen screen(own, column, {{.first = 0, .count = 1, .side = side}}, kScale);
      const Gain gain = screen.gains(residual).front();
      if (coefficient * side <= 0.0) {
        EXPECT_EQ(gain.sum_of_squares, 0.0);
        EXPECT_EQ(gain.evidence, 0.0);
        continue;
      }
      // One-sided normal test of the coefficient.
      const Eigen::Matrix2d normal = both.transpose() * both;
      const double determinant = normal(0, 0) * normal(1, 1) - normal(0, 1) * normal(1, 0);
      const double sd = kScale * std::sqrt(normal(0, 0) / determinant);
      const double tail = boost::math::cdf(
          boost::math::complement(boost::math::normal(), std::abs(coefficient) / sd));
      EXPECT_NEAR(gain.evidence, -std::log(tail), 1e-10);
    }
  }
  EXPECT_GT(growing, 0);
  EXPECT_LT(growing, 20);
}

// Luck

Eigen::MatrixXd half_plane_columns(Eigen::Index rows, Noise& noise) {
  Eigen::MatrixXd columns = noise.matrix(rows, 10);
  columns.col(1) = columns.col(0) + 0.2 * columns.col(1);  // nearly parallel
  return columns;
}

std::vector<Block> ten_columns_in_blocks() {
  return {{.first = 0, .count = 1}, {.first = 1, .count = 1, .side = 1},
          {.first = 2, .count = 2}, {.first = 4, .count = 1, .side = -1, .log_weight = -0.7},
          {.first = 5, .count = 2}, {.first = 7, .count = 3}};
}

double greatest(const Screen& screen, const Eigen::VectorXd& residual) {
  double best = 0.0;
  for (const Gain& gain : screen.gains(residual)) best = std::max(best, gain.evidence);
  return best;
}

TEST(Luck, OfRatesThatNoCaseShowsIsThatOfTheTail) {
  // The greatest of 256 cases whose tail is e^(−x): x = −ln rate at any rate.
  constexpr int kCases = 256;
  std::vector<double> cases;
  for (int k = 0; k < kCases; ++k) cases.push_back(-std::log((k + 0.5) / kCases));
  for (const double rate : {0.05, 1e-3, 1e-6, 1e-9}) {
    EXPECT_NEAR(Screen::luck_of(cases, rate).threshold, -std::log(rate), 0.5) << rate;
    EXPECT_NEAR(std::log(Screen::luck_of(cases, rate).p_value(12.0)), -12.0, 0.5) << rate;
  }
}

TEST(Luck, IsPassedByFreshNoiseAtTheRateStated) {
  constexpr Eigen::Index kRows = 60;
  constexpr double kRate = 0.05;
  Noise noise(20);
  const Screen screen(noise.matrix(kRows, 2), half_plane_columns(kRows, noise),
                      ten_columns_in_blocks(), 0.0);
  for (const Screen::Chance chance : {Screen::Chance::kSigns, Screen::Chance::kShuffled}) {
    constexpr int kResiduals = 40;
    constexpr int kFresh = 100;
    int passed = 0;
    int rare = 0;
    for (int k = 0; k < kResiduals; ++k) {
      const auto luck = screen.luck(noise.matrix(kRows, 1).col(0), kRate, 1000,
                                    static_cast<std::uint64_t>(k), chance);
      EXPECT_EQ(luck.rate, kRate);
      EXPECT_NEAR(luck.p_value(luck.threshold), kRate, 1e-15);
      for (int i = 0; i < kFresh; ++i) {
        const double evidence = greatest(screen, noise.matrix(kRows, 1).col(0));
        passed += evidence > luck.threshold ? 1 : 0;
        rare += luck.p_value(evidence) <= 0.01 ? 1 : 0;
      }
    }
    // Three binomial standard deviations of the trials; the thresholds' own scatter, by a thousand
    // simulations 14 % of the rate each, adds a fifth of one.
    constexpr double kTrials = 1.0 * kResiduals * kFresh;
    const auto error = [&](double p) { return 3.2 * std::sqrt(p * (1.0 - p) / kTrials); };
    EXPECT_NEAR(passed / kTrials, kRate, error(kRate));
    EXPECT_NEAR(rare / kTrials, 0.01, error(0.01));
  }
}

TEST(Luck, OfAKnownScaleIsPassedAtTheRateStatedToo) {
  constexpr Eigen::Index kRows = 60;
  constexpr double kRate = 0.04;
  constexpr double kScale = 0.3;
  Noise noise(21);
  const Screen screen(noise.matrix(kRows, 2), half_plane_columns(kRows, noise),
                      ten_columns_in_blocks(), kScale);
  // Of its own residual: what a search does, once for each set of data.
  constexpr int kTrials = 1500;
  int passed = 0;
  for (int k = 0; k < kTrials; ++k) {
    const Eigen::VectorXd residual = kScale * noise.matrix(kRows, 1).col(0);
    const auto luck = screen.luck(residual, kRate, 256, static_cast<std::uint64_t>(k));
    passed += greatest(screen, residual) > luck.threshold ? 1 : 0;
  }
  // Three and a half binomial standard deviations.
  EXPECT_NEAR(1.0 * passed / kTrials, kRate, 3.5 * std::sqrt(kRate * (1.0 - kRate) / kTrials));
}

TEST(Luck, DoesNotDependOnTheUnitOfTheResidual) {
  constexpr Eigen::Index kRows = 40;
  Noise noise(22);
  const Screen screen(noise.matrix(kRows, 1), half_plane_columns(kRows, noise),
                      ten_columns_in_blocks(), 0.0);
  const Eigen::VectorXd residual = noise.matrix(kRows, 1).col(0);
  const auto one = screen.luck(residual, 0.05, 512, 3);
  const auto other = screen.luck(1e-6 * residual, 0.05, 512, 3);
  EXPECT_NEAR(one.threshold, other.threshold, 1e-9);
  EXPECT_EQ(one.threshold, screen.luck(residual, 0.05, 512, 3).threshold);
  EXPECT_NE(one.threshold, screen.luck(residual, 0.05, 512, 4).threshold);
}

TEST(Luck, OfSomeBlocksAfterTheOthersIsThatOfAllTogether) {
  constexpr Eigen::Index kRows = 50;
  Noise noise(25);
  const Eigen::MatrixXd own = noise.matrix(kRows, 2);
  const Eigen::MatrixXd columns = noise.matrix(kRows, 5);
  const Eigen::VectorXd residual = noise.matrix(kRows, 1).col(0);
  const Screen all(own, columns, {{.first = 0, .count = 2}, {.first = 2, .count = 3}}, 0.0);
  const Screen first(own, columns.leftCols(2), {{.first = 0, .count = 2}}, 0.0);
  const Screen second(own, columns.rightCols(3), {{.first = 0, .count = 3}}, 0.0);
  for (const Screen::Chance chance : {Screen::Chance::kSigns, Screen::Chance::kShuffled}) {
    const auto together = all.greatest_by_luck(residual, 100, 7, chance);
    const auto one = first.greatest_by_luck(residual, 100, 7, chance);
    const auto other = second.greatest_by_luck(residual, 100, 7, chance);
    ASSERT_EQ(together.size(), one.size());
    for (std::size_t k = 0; k < together.size(); ++k) {
      EXPECT_NEAR(together[k], std::max(one[k], other[k]), 1e-9);
    }
  }
}

TEST(Luck, AStructureInSixRowsSurvivesSignsButNotShuffling) {
  // Six rows of 120 are off by four standard deviations; a block stands for them.
  constexpr Eigen::Index kRows = 120;
  Noise noise(23);
  Eigen::MatrixXd columns = noise.matrix(kRows, 4);
  columns.col(3).setZero();
  columns.col(3).segment(50, 6).setOnes();
  Eigen::VectorXd residual = noise.matrix(kRows, 1).col(0);
  residual.segment(50, 6).array() += 4.0;
  const Screen screen(
      Eigen::MatrixXd(kRows, 0), columns,
      {{.first = 0, .count = 1}, {.first = 1, .count = 2}, {.first = 3, .count = 1}}, 0.0);
  const double evidence = greatest(screen, residual);
  ASSERT_GT(evidence, 20.0);
  constexpr double kRate = 0.01;
  constexpr int kSimulations = 2048;
  const auto signs = screen.luck(residual, kRate, kSimulations, 1, Screen::Chance::kSigns);
  const auto shuffled = screen.luck(residual, kRate, kSimulations, 1, Screen::Chance::kShuffled);
  // Two of 64 choices of six signs leave the structure as it is: at a rate below 1/32 it is its
  // own threshold.
  EXPECT_GT(signs.p_value(evidence), 0.5 * kRate);
  EXPECT_LT(shuffled.p_value(evidence), 1e-4);
}

TEST(Luck, BothChancesAgreeWhereRowsScatterAlike) {
  constexpr Eigen::Index kRows = 120;
  Noise noise(24);
  const Screen screen(noise.matrix(kRows, 2), half_plane_columns(kRows, noise),
                      ten_columns_in_blocks(), 0.0);
  const Eigen::VectorXd residual = noise.matrix(kRows, 1).col(0);
  const auto signs = screen.luck(residual, 0.05, 4096, 1, Screen::Chance::kSigns);
  const auto shuffled = screen.luck(residual, 0.05, 4096, 1, Screen::Chance::kShuffled);
  // A threshold of 4096 simulations has a standard deviation of about 0.06.
  EXPECT_NEAR(signs.threshold, shuffled.threshold, 0.3);
}

// Random bits

TEST(RandomBits, AreThoseOfSplitMix64) {
  // Published with the generator (Steele, Lea, Flood 2014; Vigna's reference implementation): the
  // first five numbers of seed 1234567.
  RandomBits random(1234567);
  for (const std::uint64_t expected :
       {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
        4593380528125082431ULL, 16408922859458223821ULL}) {
    EXPECT_EQ(random.next(), expected);
  }
}

TEST(RandomBits, UniformIsTheShareOf64Bits) {
  RandomBits bits(99);
  RandomBits random(99);
  double sum = 0.0;
  constexpr int kCount = 10000;
  for (int k = 0; k < kCount; ++k) {
    const double share = std::ldexp(static_cast<double>(bits.next()), -64);
    const double u = random.uniform();
    EXPECT_NEAR(u, share, 0x1p-53);
    EXPECT_GE(u, 0.0);
    EXPECT_LT(u, 1.0);
    sum += u;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 4.0 / std::sqrt(12.0 * kCount));
}

}  // namespace
}  // namespace gear3k::calibrate::screen_test
