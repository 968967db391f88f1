#include "calibrate/series/joint_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::joint_fit_test {
namespace {

struct Values {
  std::vector<Eigen::VectorXd> value;
  std::vector<Eigen::MatrixXd> information;
};

Values one_parameter(std::uint64_t seed, double deviation) {
  rig::DeterministicRandom random(seed);
  Values v;
  for (int u = 0; u < 8; ++u) {
    const double sd = random.between(0.1, 0.3);
    v.value.push_back(
        Eigen::VectorXd::Constant(1, 0.4 + deviation * random.normal() + sd * random.normal()));
    v.information.push_back(Eigen::MatrixXd::Constant(1, 1, 1.0 / (sd * sd)));
  }
  return v;
}

/// The bracket of JointFit::score of one parameter, at μ and τ², term by term.
double plain_deviance(const Values& v, double mean, double variance) {
  double sum = 0.0;
  for (std::size_t u = 0; u < v.value.size(); ++u) {
    const double s2 = 1.0 / v.information[u](0, 0);
    sum += std::pow(v.value[u][0] - mean, 2) / (s2 + variance) + std::log((s2 + variance) / s2);
  }
  return sum;
}

TEST(RandomEffectsDeviance, IsTheLeastOfAFineGrid) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Values v = one_parameter(seed, 0.1 * static_cast<double>(seed % 6));
    double least = 1e300;
    for (double tau = 0.0; tau < 2.0; tau += 0.01) {
      for (double mean = -1.0; mean < 2.0; mean += 0.005) {
        least = std::min(least, plain_deviance(v, mean, tau * tau));
      }
    }
    // A ladder of deviations, not a solver: within a tenth of a χ² of the least.
    const double found = random_effects_deviance(v.value, v.information);
    EXPECT_GE(found, least - 0.01) << "seed " << seed;
    EXPECT_LE(found, least + 0.1) << "seed " << seed;
  }
}

TEST(RandomEffectsDeviance, OfParametersWithoutCorrelationAddsUp) {
  const Values a = one_parameter(3, 0.5);
  const Values b = one_parameter(4, 0.0);
  Values both;
  for (std::size_t u = 0; u < a.value.size(); ++u) {
    both.value.push_back(Eigen::Vector2d(a.value[u][0], b.value[u][0]));
    both.information.emplace_back(
        Eigen::Vector2d(a.information[u](0, 0), b.information[u](0, 0)).asDiagonal());
  }
  EXPECT_NEAR(random_effects_deviance(both.value, both.information),
              random_effects_deviance(a.value, a.information) +
                  random_effects_deviance(b.value, b.information),
              0.05);
}

TEST(RandomEffectsDeviance, DoesNotDependOnUnits) {
  Values v;
  Values in_other_units;
  rig::DeterministicRandom random(9);
  const Eigen::Vector2d unit(1e-9, 1e9);
  for (int u = 0; u < 6; ++u) {
    const Eigen::Vector2d value(3.0 + random.normal(), -2.0 + random.normal());
    const Eigen::Matrix2d information{{2.0, 0.9}, {0.9, 1.0 + 0.1 * u}};
    v.value.push_back(value);
    v.information.push_back(information);
    in_other_units.value.push_back(value.cwiseProduct(unit));
    in_other_units.information.push_back(unit.cwiseInverse().asDiagonal() * information *
                                         unit.cwiseInverse().asDiagonal());
  }
  EXPECT_NEAR(random_effects_deviance(in_other_units.value, in_other_units.information),
              random_effects_deviance(v.value, v.information), 1e-6);
}

TEST(RandomEffectsDeviance, DoesNotAskForWhatAUnitDoesNotDetermine) {
  Values v = one_parameter(5, 0.3);
  const double before = random_effects_deviance(v.value, v.information);
  v.value.push_back(Eigen::VectorXd::Constant(1, 1e6));
  v.information.push_back(Eigen::MatrixXd::Zero(1, 1));
  EXPECT_NEAR(random_effects_deviance(v.value, v.information), before, 0.1);
}

}  // namespace
}  // namespace gear3k::calibrate::joint_fit_test
