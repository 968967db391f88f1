#include "strength/load_sharing.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "backlash/monte_carlo.hpp"
#include "strength/mesh_forces.hpp"
#include "strength/train_stiffness.hpp"
#include "tests/backlash/toleranced_train.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::strength::load_sharing_test {
namespace {

using backlash::MeshPlay, backlash::PlanetPlay;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr MeshSprings kSprings{1.2e8, 1.6e8, 1.4e8};

/// G2 < 1 and G2 > 1 in turn.
train::TrainGeometry<double> random_geometry(RandomTrain& random, int n) {
  return random.train(n % 2 == 0);
}

/// Plays of about ±half with middles that differ by up to ±off.
std::vector<PlanetPlay> random_plays(RandomTrain& random, int planets, double half, double off) {
  std::vector<PlanetPlay> plays(static_cast<std::size_t>(planets));
  for (PlanetPlay& planet : plays) {
    for (MeshPlay& mesh : planet) {
      const double middle = random.between(-off, off), wide = half * random.between(0.5, 1.5);
      mesh = {.lower_m = middle - wide, .upper_m = middle + wide};
    }
  }
  return plays;
}

/// Forces by Newton's method on the energy over the turns of carrier, R2 and each planet: springs
/// with gaps on both flanks, closing by the turns (8.1).  Signs as of shared_forces().
std::vector<PlanetForces> forces_on_one_carrier(const train::TrainGeometry<double>& g,
                                                const MeshSprings& stiffness,
                                                const std::vector<PlanetPlay>& plays,
                                                double torque) {
  const auto radius = [&](train::GearId id) { return g.gears[id].base_radius_m; };
  // u by the turns, over rb_R2.
  const std::array<std::array<double, 3>, 3> turns{
      {{-radius(train::kS), 0.0, radius(train::kP1)},
       {-radius(train::kR1), 0.0, -radius(train::kP1)},
       {-radius(train::kR2), radius(train::kR2), -radius(train::kP2)}}};
  const auto planets = static_cast<Eigen::Index>(plays.size());
  const Eigen::Index unknowns = 2 + planets, rows = 6 * planets;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(rows, unknowns);
  Eigen::VectorXd k(rows), b(rows), load = Eigen::VectorXd::Zero(unknowns);
  load(1) = torque / radius(train::kR2);
  for (Eigen::Index p = 0; p < planets; ++p) {
    for (std::size_t m = 0; m < 3; ++m) {
      const MeshPlay& play = plays[static_cast<std::size_t>(p)][m];
      for (const int flank : {0, 1}) {
        const double sign = flank == 0 ? 1.0 : -1.0;
        const Eigen::Index row = 6 * p + 2 * static_cast<Eigen::Index>(m) + flank;
        a(row, 0) = sign * turns[m][0] / radius(train::kR2);
        a(row, 1) = sign * turns[m][1] / radius(train::kR2);
        a(row, 2 + p) = sign * turns[m][2] / radius(train::kR2);
        k(row) = stiffness[m];
        b(row) = flank == 0 ? play.upper_m : -play.lower_m;
      }
    }
  }
  const auto energy = [&](const Eigen::VectorXd& x) {
    const Eigen::ArrayXd u = (a * x - b).cwiseMax(0.0).array();
    return 0.5 * (k.array() * u * u).sum() - load.dot(x);
  };
  Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns);
  for (int step = 0; step < 3000; ++step) {
    const Eigen::VectorXd u = a * x - b;
    const Eigen::VectorXd slope = a.transpose() * k.cwiseProduct(u.cwiseMax(0.0)) - load;
    if (slope.norm() < 1e-12 * load.norm()) break;
    // Open flanks count a little, so that every unknown is held.
    const Eigen::VectorXd held = (u.array() > 0.0).select(k, 1e-6 * k);
    const Eigen::VectorXd way = -(a.transpose() * held.asDiagonal() * a).ldlt().solve(slope);
    double size = 1.0;
    const double before = energy(x);
    while (size > 1e-9 && energy(x + size * way) > before + 1e-4 * size * slope.dot(way)) {
      size *= 0.5;
    }
    x += size * way;
  }
  const Eigen::VectorXd f = k.cwiseProduct((a * x - b).cwiseMax(0.0));
  std::vector<PlanetForces> forces(plays.size());
  for (Eigen::Index p = 0; p < planets; ++p) {
    for (Eigen::Index m = 0; m < 3; ++m) {
      forces[static_cast<std::size_t>(p)][static_cast<std::size_t>(m)] =
          f(6 * p + 2 * m) - f(6 * p + 2 * m + 1);
    }
  }
  return forces;
}

TEST(LoadSharing, AlikePlanetsShareEvenly) {
  RandomTrain random(80);
  for (int n = 0; n < 200; ++n) {
    const auto g = random_geometry(random, n);
    const auto levers = backlash::output_levers(g);
    const auto one = random_plays(random, 1, 20e-6, 5e-6);
    const std::vector<PlanetPlay> plays(static_cast<std::size_t>(random.count(1, 7)), one[0]);
    const double torque = random.between(0.1, 40.0) * (n % 3 == 0 ? -1.0 : 1.0);
    const auto forces = shared_forces(levers, kSprings, plays, torque);
    for (const double k : mesh_load_factors(levers, forces, torque)) EXPECT_NEAR(k, 1.0, 1e-10);
    // Each as its share without losses.
    const auto a = normal_forces_per_torque(g);
    for (std::size_t m = 0; m < 3; ++m) {
      const double nominal = std::abs(torque) * a[m] / static_cast<double>(plays.size());
      EXPECT_NEAR(std::abs(forces[0][m]), nominal, 1e-9 * nominal);
    }
  }
}

TEST(LoadSharing, OnePlanetCarriesAllWhenTheOthersMeetNothing) {
  RandomTrain random(81);
  for (int n = 0; n < 200; ++n) {
    const auto g = random_geometry(random, n);
    const auto levers = backlash::output_levers(g);
    const double far = n % 2 == 0 ? 1.0 : kInfinite;
    std::vector<PlanetPlay> plays(4);
    for (PlanetPlay& planet : plays) planet.fill({.lower_m = -far, .upper_m = far});
    plays[1] = random_plays(random, 1, 20e-6, 5e-6)[0];
    const auto forces = shared_forces(levers, kSprings, plays, 15.0);
    for (const double k : mesh_load_factors(levers, forces, 15.0)) EXPECT_NEAR(k, 4.0, 1e-9);
    for (const std::size_t p : {0U, 2U, 3U}) EXPECT_EQ(forces[p], PlanetForces{});
  }
}

TEST(LoadSharing, IsTheLeastEnergyOfAllBodiesAndFlanks) {
  RandomTrain random(82);
  LargestDeviation sum, least_energy;
  int back_flanks = 0, idle = 0;
  for (int n = 0; n < 600; ++n) {
    const auto g = random_geometry(random, n);
    const auto levers = backlash::output_levers(g);
    const double half = n % 5 == 0 ? 2e-6 : 20e-6;
    const auto plays = random_plays(random, random.count(1, 5), half, 8e-6);
    const double size = std::pow(10.0, random.between(-1.0, 2.5));
    const double torque = n % 3 == 0 ? -size : size;
    const auto forces = shared_forces(levers, kSprings, plays, torque);
    const double force = torque / levers.output_m;
    PlanetForces total{};
    double greatest = 0.0;
    for (const PlanetForces& planet : forces) {
      for (const double f : planet) greatest = std::max(greatest, std::abs(f));
    }
    for (const PlanetForces& planet : forces) {
      for (std::size_t m = 0; m < 3; ++m) total[m] += planet[m];
      // No moment on the planet about its own axis.
      sum.see(n, planet[0] - planet[1] - levers.planet * planet[2], 1e-10 * greatest);
      idle += planet == PlanetForces{} ? 1 : 0;
      back_flanks += planet[2] * torque < 0.0 ? 1 : 0;
    }
    const PlanetForces expected{-levers.ring_side * force, -levers.sun_side * force, force};
    for (std::size_t m = 0; m < 3; ++m) sum.see(n, total[m] - expected[m], 1e-10 * greatest);
    const auto witness = forces_on_one_carrier(g, kSprings, plays, torque);
    for (std::size_t p = 0; p < forces.size(); ++p) {
      for (std::size_t m = 0; m < 3; ++m) {
        least_energy.see(n, forces[p][m] - witness[p][m], 1e-9 * greatest);
      }
    }
  }
  sum.expect_allowed("sums_of_forces");
  least_energy.expect_allowed("forces");
  EXPECT_GT(idle, 50);
  EXPECT_GT(back_flanks, 5);
}

TEST(LoadSharing, EvensOutAsTheTorqueRises) {
  RandomTrain random(83);
  const auto g = random_geometry(random, 0);
  const auto levers = backlash::output_levers(g);
  const auto plays = random_plays(random, 3, 20e-6, 8e-6);
  for (const double torque : {1e5, 1e7}) {
    const auto factors =
        mesh_load_factors(levers, shared_forces(levers, kSprings, plays, torque), torque);
    for (const double k : factors) {
      EXPECT_GE(k, 1.0 - 1e-12);
      EXPECT_LE(k - 1.0, 3e5 / torque);
    }
  }
}

/// K_γ of planets that meet the output each as if the carrier turned for it alone:
/// Σ (K/N) max(0, φ − g_p) = T, K_γ = K (φ − min g)/T.
double factor_without_common_carrier(std::vector<double> gap, double output, double torque) {
  std::ranges::sort(gap);
  const double n = static_cast<double>(gap.size());
  double sum = 0.0;
  for (std::size_t carrying = 1;; ++carrying) {
    sum += gap[carrying - 1];
    const double phi = (torque * n / output + sum) / static_cast<double>(carrying);
    if (carrying == gap.size() || phi <= gap[carrying]) return output * (phi - gap[0]) / torque;
  }
}

TEST(LoadSharing, SharesTheRingsMeshesAsWithoutACommonCarrierAndTheSunsWorse) {
  const auto g = *train::make_train_geometry(backlash::thinned_bilateral_drive_gear());
  const auto levers = backlash::output_levers(g);
  const auto a = normal_forces_per_torque(g);
  const double output =
      train_stiffness(g, TrainSprings<double>{.mesh_N_m = kSprings}).output_Nm_rad;
  // The flank that the torque loads: the sign of each mesh's force.
  const auto signs = shared_forces(
      levers, kSprings, std::vector<PlanetPlay>(1, PlanetPlay{MeshPlay{}, MeshPlay{}, MeshPlay{}}),
      1.0);
  RandomTrain random(85);
  constexpr int kGearboxes = 300;
  for (const double torque : {40.0, 200.0}) {
    double simple = 0.0;
    std::array<double, 3> mesh{};
    for (int n = 0; n < kGearboxes; ++n) {
      std::vector<PlanetPlay> plays(3);
      std::vector<double> at_output(3, 0.0);
      for (std::size_t p = 0; p < 3; ++p) {
        for (std::size_t m = 0; m < 3; ++m) {
          const double gap = random.between(-8e-6, 8e-6);
          at_output[p] += a[m] * gap;
          plays[p][m] = signs[0][m] > 0.0 ? MeshPlay{.lower_m = -kInfinite, .upper_m = gap}
                                          : MeshPlay{.lower_m = -gap, .upper_m = kInfinite};
        }
      }
      simple += factor_without_common_carrier(at_output, output, torque) / kGearboxes;
      const auto factors =
          mesh_load_factors(levers, shared_forces(levers, kSprings, plays, torque), torque);
      for (std::size_t m = 0; m < 3; ++m) mesh[m] += factors[m] / kGearboxes;
    }
    EXPECT_NEAR(mesh[1], simple, 0.05 * simple) << torque;
    EXPECT_NEAR(mesh[2], simple, 0.05 * simple) << torque;
    EXPECT_GT(mesh[0], 1.2 * simple) << torque;
  }
}

TEST(LoadFactorSeries, DrawIsThatOfTheYield) {
  backlash::RandomToleranced random(82);
  const auto model = random.model(true, 3, 4);
  const auto sample = draw_plays(model, {.samples = 3000, .seed = 7});
  const auto series = backlash::monte_carlo(model, {.samples = 3000, .seed = 7});
  EXPECT_EQ(sample.drawn, 3000U);
  EXPECT_EQ(sample.assembled, series.assembled.count);
  EXPECT_EQ(sample.plays.size(), sample.assembled * sample.planets);
}

/// A series of which more than a third assembles.
PlaySample some_sample(int seed, std::uint64_t samples) {
  backlash::RandomToleranced random(static_cast<unsigned>(seed));
  for (;;) {
    auto sample = draw_plays(random.model(true, 3, 3), {.samples = samples, .seed = 2});
    if (3 * sample.assembled > samples) return sample;
  }
}

TEST(LoadFactorSeries, MeanAndQuantileAreThoseOfTheSortedFactorsOfBothSenses) {
  const PlaySample sample = some_sample(83, 500);
  std::array<std::vector<double>, 3> factors;
  for (std::size_t n = 0; n < sample.assembled; ++n) {
    const auto plays = std::span(sample.plays).subspan(3 * n, 3);
    const auto on =
        mesh_load_factors(sample.levers, shared_forces(sample.levers, kSprings, plays, 8.0), 8.0);
    const auto back =
        mesh_load_factors(sample.levers, shared_forces(sample.levers, kSprings, plays, -8.0), -8.0);
    for (std::size_t m = 0; m < 3; ++m) factors[m].push_back(std::max(on[m], back[m]));
  }
  const auto series = load_factor_series(sample, kSprings, 8.0, 0.95);
  const auto all = load_factor_series(sample, kSprings, -8.0, 1.0);
  for (std::size_t m = 0; m < 3; ++m) {
    std::ranges::sort(factors[m]);
    const auto n = static_cast<double>(factors[m].size());
    EXPECT_NEAR(series.mean[m], std::accumulate(factors[m].begin(), factors[m].end(), 0.0) / n,
                1e-12);
    EXPECT_EQ(series.quantile[m], factors[m][static_cast<std::size_t>(std::ceil(0.95 * n)) - 1]);
    EXPECT_EQ(all.quantile[m], factors[m].back());
    EXPECT_GE(factors[m].front(), 1.0 - 1e-10);
  }
}

TEST(LoadSharing, BadInputIsNamed) {
  RandomTrain random(86);
  const auto levers = backlash::output_levers(random_geometry(random, 0));
  const std::vector<PlanetPlay> none, one(1, PlanetPlay{}),
      crossed(1, PlanetPlay{MeshPlay{.lower_m = 1e-6, .upper_m = -1e-6}});
  EXPECT_THROW(shared_forces(levers, kSprings, none, 1.0), std::invalid_argument);
  EXPECT_THROW(shared_forces(levers, kSprings, crossed, 1.0), std::invalid_argument);
  EXPECT_THROW(shared_forces(levers, kSprings, one, 0.0), std::invalid_argument);
  EXPECT_THROW(shared_forces(levers, kSprings, one, kInfinite), std::invalid_argument);
  EXPECT_THROW(shared_forces(levers, {0.0, 1e8, 1e8}, one, 1.0), std::invalid_argument);
  const PlaySample empty;
  EXPECT_THROW(load_factor_series(empty, kSprings, 1.0, 0.5), std::invalid_argument);
  const PlaySample sample{.levers = levers, .planets = 1, .plays = one, .drawn = 1, .assembled = 1};
  EXPECT_THROW(load_factor_series(sample, kSprings, 1.0, 0.0), std::invalid_argument);
  EXPECT_THROW(load_factor_series(sample, kSprings, 1.0, 1.5), std::invalid_argument);
  const backlash::ClearanceModel model;
  EXPECT_THROW(draw_plays(model, {.samples = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::load_sharing_test
