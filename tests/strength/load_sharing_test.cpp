#include "strength/load_sharing.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "backlash/lost_motion.hpp"
#include "backlash/monte_carlo.hpp"
#include "strength/mesh_forces.hpp"
#include "strength/train_stiffness.hpp"
#include "tests/backlash/toleranced_train.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::strength::load_sharing_test {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

TEST(LoadSharing, EqualGapsShareEvenly) {
  for (const std::size_t planets : {1U, 2U, 3U, 7U}) {
    const std::vector<double> gaps(planets, 3e-4);
    const auto s = load_sharing<double>(gaps, 2e4, 15.0);
    EXPECT_NEAR(s.load_factor, 1.0, 1e-15);
    EXPECT_EQ(s.carrying, planets);
    for (const double t : s.planet_torque_Nm)
      EXPECT_NEAR(t, 15.0 / static_cast<double>(planets), 1e-13);
    EXPECT_NEAR(s.angle_rad, 15.0 / 2e4, 1e-18);
  }
}

TEST(LoadSharing, OnePlanetCarriesAllWhenTheOthersAreFarAway) {
  for (const double gap : {1.0, 1e6, kInfinite}) {
    const std::vector<double> gaps{gap, 0.0, gap, gap};
    const auto s = load_sharing<double>(gaps, 2e4, 15.0);
    EXPECT_NEAR(s.load_factor, 4.0, 1e-14);
    EXPECT_EQ(s.carrying, 1U);
    EXPECT_EQ(s.planet_torque_Nm[0], 0.0);
    EXPECT_NEAR(s.planet_torque_Nm[1], 15.0, 1e-13);
  }
}

TEST(LoadSharing, SolvesTheEquationOfSpringsWithGaps) {
  RandomTrain random(81);
  LargestDeviation sum, each, factor;
  for (int n = 0; n < 2000; ++n) {
    std::vector<double> gaps(static_cast<std::size_t>(random.count(1, 8)));
    for (double& gap : gaps) gap = random.between(-5e-4, 5e-4);
    const double stiffness = random.between(1e3, 1e5), torque = random.between(0.1, 40.0);
    const auto s = load_sharing<double>(gaps, stiffness, torque);
    const double first = *std::ranges::min_element(gaps);
    double total = 0.0, greatest = 0.0;
    std::size_t carrying = 0;
    for (std::size_t p = 0; p < gaps.size(); ++p) {
      const double reached = std::max(0.0, s.angle_rad - (gaps[p] - first));
      each.see(n, s.planet_torque_Nm[p] - stiffness / static_cast<double>(gaps.size()) * reached,
               1e-13 * torque);
      total += s.planet_torque_Nm[p];
      greatest = std::max(greatest, s.planet_torque_Nm[p]);
      carrying += s.planet_torque_Nm[p] > 0.0 ? 1U : 0U;
    }
    sum.see(n, total - torque, 1e-12 * torque);
    factor.see(n, s.load_factor - static_cast<double>(gaps.size()) * greatest / torque, 1e-12);
    EXPECT_EQ(carrying, s.carrying);
  }
  sum.expect_allowed("sum_of_torques");
  each.expect_allowed("spring_law");
  factor.expect_allowed("load_factor");
}

TEST(LoadSharing, FallsWithTheTorqueFromAllOnOneToEven) {
  const std::vector<double> gaps{0.0, 1e-4, 3e-4};
  double before = 3.0 + 1e-12;
  for (const double torque : {0.01, 0.5, 1.0, 3.0, 10.0, 1e3, 1e7}) {
    const double k = load_sharing<double>(gaps, 2e4, torque).load_factor;
    EXPECT_LE(k, before);
    before = k;
  }
  EXPECT_NEAR(before, 1.0, 1e-6);
}

TEST(LoadSharing, GapIsTheDifferenceOfThePlanetsOwnLostMotion) {
  // Planets whose plays differ in one bound: half of each planet's lost motion by (8.4).
  const auto p = backlash::thinned_bilateral_drive_gear();
  const auto g = train::make_train_geometry(p);
  const auto levers = backlash::output_levers(*g);
  std::vector<backlash::PlanetPlay> plays;
  const std::array<double, 3> wider{0.0, 7e-6, 2e-6};
  for (const double more : wider) {
    backlash::PlanetPlay play{};
    for (auto& mesh : play) mesh = {.lower_m = -20e-6 - more, .upper_m = 20e-6 + more};
    plays.push_back(play);
  }
  for (const bool greatest : {true, false}) {
    const auto gaps = planet_gaps(levers, plays, greatest);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto shares = backlash::kinematic_lost_motion(*g, {wider[k], wider[k], wider[k]});
      EXPECT_NEAR(gaps[k], shares[0] + shares[1] + shares[2], 1e-17);
    }
  }
}

TEST(LoadSharing, DrawIsThatOfTheYield) {
  backlash::RandomToleranced random(82);
  const auto model = random.model(true, 3, 4);
  const PlanetGapOptions options{.samples = 3000, .seed = 7};
  const auto sample = draw_planet_gaps(model, options);
  const auto series = backlash::monte_carlo(model, {.samples = 3000, .seed = 7});
  EXPECT_EQ(sample.drawn, 3000U);
  EXPECT_EQ(sample.assembled, series.assembled.count);
  EXPECT_EQ(sample.gap_rad.size(), sample.assembled * sample.planets);
  for (std::size_t k = 0; k < sample.assembled; ++k) {
    const auto begin = sample.gap_rad.begin() + static_cast<std::ptrdiff_t>(k * sample.planets);
    EXPECT_EQ(*std::min_element(begin, begin + static_cast<std::ptrdiff_t>(sample.planets)), 0.0);
  }
}

TEST(LoadSharing, MeanAndQuantileAreThoseOfTheSortedFactors) {
  backlash::RandomToleranced random(83);
  const auto model = random.model(false, 3, 3);
  const auto sample = draw_planet_gaps(model, {.samples = 1000, .seed = 2});
  ASSERT_GT(sample.assembled, 100U);
  std::vector<double> factors;
  double sum = 0.0;
  for (std::size_t k = 0; k < sample.assembled; ++k) {
    factors.push_back(
        load_sharing<double>(std::span(sample.gap_rad).subspan(3 * k, 3), 1.5e4, 8.0).load_factor);
    sum += factors.back();
  }
  std::ranges::sort(factors);
  const auto distribution = load_factor_distribution<double>(sample, 1.5e4, 8.0, 0.95);
  const auto n = static_cast<double>(factors.size());
  EXPECT_NEAR(distribution.mean, sum / n, 1e-12);
  EXPECT_EQ(distribution.quantile, factors[static_cast<std::size_t>(std::ceil(0.95 * n)) - 1]);
  EXPECT_EQ(load_factor_distribution<double>(sample, 1.5e4, 8.0, 1.0).quantile, factors.back());
  EXPECT_GE(factors.front(), 1.0 - 1e-12);
  EXPECT_LE(factors.back(), 3.0 + 1e-12);
}

TEST(LoadSharing, DerivativesAreThoseOfDifferences) {
  const std::vector<double> gaps{0.0, 1e-4, 3e-4};
  for (const double torque : {0.5, 2.0, 30.0}) {
    const double stiffness = 2e4, h = 1e-5;
    const auto k = load_sharing(std::span<const double>(gaps), Jet1(stiffness, 0), Jet1(torque, 1))
                       .load_factor;
    const auto at = [&](double dk, double dt) {
      return load_sharing<double>(gaps, stiffness * (1.0 + dk), torque * (1.0 + dt)).load_factor;
    };
    EXPECT_NEAR(k.v[0] * stiffness, (at(h, 0.0) - at(-h, 0.0)) / (2.0 * h), 1e-6);
    EXPECT_NEAR(k.v[1] * torque, (at(0.0, h) - at(0.0, -h)) / (2.0 * h), 1e-6);
  }
  backlash::RandomToleranced random(84);
  const auto model = random.model(true, 3, 3);
  const auto sample = draw_planet_gaps(model, {.samples = 300, .seed = 2});
  ASSERT_GT(sample.assembled, 50U);
  const auto d = load_factor_distribution(sample, Jet1(1.5e4, 0), Jet1(8.0, 1), 0.9);
  const double h = 1e-7;
  const auto up = load_factor_distribution<double>(sample, 1.5e4 * (1.0 + h), 8.0, 0.9);
  const auto down = load_factor_distribution<double>(sample, 1.5e4 * (1.0 - h), 8.0, 0.9);
  EXPECT_NEAR(d.mean.v[0] * 1.5e4, (up.mean - down.mean) / (2.0 * h), 1e-6);
  EXPECT_NEAR(d.quantile.v[0] * 1.5e4, (up.quantile - down.quantile) / (2.0 * h), 1e-6);
}

/// Forces of every mesh of every planet when all planets stand on one carrier: least energy of the
/// springs with gaps over the turns of carrier, R2 and planets, by Newton's method.
std::vector<double> forces_on_one_carrier(const train::TrainGeometry<double>& g,
                                          const std::array<double, 3>& stiffness,
                                          const std::vector<std::array<double, 3>>& gap,
                                          double torque) {
  const auto radius = [&](train::GearId id) { return g.gears[id].base_radius_m; };
  // Closing of the flanks that a torque on R2 loads, by the turns (8.1), over rb_R2.
  const double i = train::ratio(g.teeth) < 0.0 ? -1.0 : 1.0;
  const std::array<std::array<double, 3>, 3> closing{
      {{i * radius(train::kS), 0.0, -i * radius(train::kP1)},
       {radius(train::kR1), 0.0, radius(train::kP1)},
       {-radius(train::kR2), radius(train::kR2), -radius(train::kP2)}}};
  const auto planets = static_cast<Eigen::Index>(gap.size());
  const Eigen::Index unknowns = 2 + planets;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * planets, unknowns);
  Eigen::VectorXd k(3 * planets), b(3 * planets), load = Eigen::VectorXd::Zero(unknowns);
  load(1) = torque / radius(train::kR2);
  for (Eigen::Index p = 0; p < planets; ++p) {
    for (std::size_t m = 0; m < 3; ++m) {
      const Eigen::Index row = 3 * p + static_cast<Eigen::Index>(m);
      a(row, 0) = closing[m][0] / radius(train::kR2);
      a(row, 1) = closing[m][1] / radius(train::kR2);
      a(row, 2 + p) = closing[m][2] / radius(train::kR2);
      k(row) = stiffness[m];
      b(row) = gap[static_cast<std::size_t>(p)][m];
    }
  }
  const auto energy = [&](const Eigen::VectorXd& x) {
    const Eigen::ArrayXd u = (a * x - b).cwiseMax(0.0).array();
    return 0.5 * (k.array() * u * u).sum() - load.dot(x);
  };
  Eigen::VectorXd x =
      (a.transpose() * k.asDiagonal() * a).ldlt().solve(load + a.transpose() * k.cwiseProduct(b));
  for (int step = 0; step < 1000; ++step) {
    const Eigen::VectorXd u = a * x - b;
    const Eigen::VectorXd slope = a.transpose() * k.cwiseProduct(u.cwiseMax(0.0)) - load;
    if (slope.norm() < 1e-8 * load.norm()) break;
    // Open flanks count a little, so that every unknown is held.
    const Eigen::VectorXd held = (u.array() > 0.0).select(k, 1e-8 * k);
    const Eigen::VectorXd way = -(a.transpose() * held.asDiagonal() * a).ldlt().solve(slope);
    double size = 1.0;
    const double before = energy(x);
    while (energy(x + size * way) > before + 1e-4 * size * slope.dot(way) && size > 1e-12) {
      size *= 0.5;
    }
    x += size * way;
  }
  const Eigen::VectorXd f = k.cwiseProduct((a * x - b).cwiseMax(0.0));
  return {f.begin(), f.end()};
}

TEST(LoadSharing, OneCarrierSharesTheRingsMeshesLikeItAndTheSunsWorse) {
  const auto g = *train::make_train_geometry(backlash::thinned_bilateral_drive_gear());
  const std::array<double, 3> stiffness{1.2e8, 1.6e8, 1.6e8};
  const auto a = normal_forces_per_torque(g);
  const double output =
      train_stiffness(g, TrainSprings<double>{.mesh_N_m = stiffness}).output_Nm_rad;
  RandomTrain random(85);
  constexpr int kGearboxes = 300;
  for (const double torque : {40.0, 200.0}) {
    double simple = 0.0;
    std::array<double, 3> mesh{};
    for (int n = 0; n < kGearboxes; ++n) {
      std::vector<std::array<double, 3>> gap(3);
      std::vector<double> at_output(3, 0.0);
      for (std::size_t p = 0; p < 3; ++p) {
        for (std::size_t m = 0; m < 3; ++m) {
          gap[p][m] = random.between(-8e-6, 8e-6);
          at_output[p] += a[m] * gap[p][m];
        }
      }
      simple += load_sharing<double>(at_output, output, torque).load_factor / kGearboxes;
      const auto forces = forces_on_one_carrier(g, stiffness, gap, torque);
      for (std::size_t m = 0; m < 3; ++m) {
        const double greatest = std::max({forces[m], forces[3 + m], forces[6 + m]});
        // The sum over the planets is that of the torque.
        EXPECT_NEAR(forces[m] + forces[3 + m] + forces[6 + m], a[m] * torque, 1e-5 * a[m] * torque);
        mesh[m] += greatest / (a[m] * torque / 3.0) / kGearboxes;
      }
    }
    EXPECT_NEAR(mesh[1], simple, 0.05 * simple) << torque;
    EXPECT_NEAR(mesh[2], simple, 0.05 * simple) << torque;
    EXPECT_GT(mesh[0], 1.2 * simple) << torque;
  }
}

TEST(LoadSharing, BadInputIsNamed) {
  const std::vector<double> none, one{0.0}, lost{kInfinite, kInfinite},
      nan{std::numeric_limits<double>::quiet_NaN(), 0.0};
  EXPECT_THROW(load_sharing<double>(none, 1e4, 1.0), std::invalid_argument);
  EXPECT_THROW(load_sharing<double>(lost, 1e4, 1.0), std::invalid_argument);
  EXPECT_THROW(load_sharing<double>(nan, 1e4, 1.0), std::invalid_argument);
  EXPECT_THROW(load_sharing<double>(one, 0.0, 1.0), std::invalid_argument);
  EXPECT_THROW(load_sharing<double>(one, 1e4, 0.0), std::invalid_argument);
  EXPECT_THROW(load_factor_distribution<double>(PlanetGapSample{}, 1e4, 1.0, 0.5),
               std::invalid_argument);
  const PlanetGapSample sample{.planets = 1, .gap_rad = {0.0}, .drawn = 1, .assembled = 1};
  EXPECT_THROW(load_factor_distribution<double>(sample, 1e4, 1.0, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::load_sharing_test
