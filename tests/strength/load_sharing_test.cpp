#include "strength/load_sharing.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "backlash/monte_carlo.hpp"
#include "strength/mesh_forces.hpp"
#include "strength/train_stiffness.hpp"
#include "tests/backlash/toleranced_train.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/linear_solve.hpp"

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

/// Each of 10^low to 10^high N/m.
MeshSprings random_springs(RandomTrain& random, double low, double high) {
  MeshSprings springs{};
  for (double& k : springs) k = std::pow(10.0, random.between(low, high));
  return springs;
}

/// Whether R2 can turn in the sense of the torque without end and meet nothing: some way of the
/// carrier w for y = ±1 leaves each planet an angle v at which no u moves towards a finite bound.
/// What a way allows changes only where two of the three ends of v meet.
bool turns_for_ever(const backlash::OutputLevers& levers, const std::vector<PlanetPlay>& plays,
                    double torque) {
  const double y = torque > 0.0 ? 1.0 : -1.0;
  std::vector<double> ways{0.0, -y / levers.sun_side, y / (levers.planet - levers.sun_side)};
  std::ranges::sort(ways);
  ways.insert(ways.end(),
              {ways[0] - 1.0, 0.5 * (ways[0] + ways[1]), 0.5 * (ways[1] + ways[2]), ways[2] + 1.0});
  return std::ranges::any_of(ways, [&](double w) {
    return std::ranges::all_of(plays, [&](const PlanetPlay& play) {
      double low = -kInfinite, high = kInfinite;
      const auto keep = [&](const MeshPlay& mesh, double end, bool falls) {
        if (std::isfinite(falls ? mesh.lower_m : mesh.upper_m)) high = std::min(high, end);
        if (std::isfinite(falls ? mesh.upper_m : mesh.lower_m)) low = std::max(low, end);
      };
      keep(play[0], 0.0, false);
      keep(play[1], w, true);
      keep(play[2], (y + levers.sun_side * w) / levers.planet, true);
      return low <= high + 1e-12;  // where two ends meet, up to rounding
    });
  });
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
    const Eigen::VectorXd way =
        -test::solved(Eigen::MatrixXd(a.transpose() * held.asDiagonal() * a), slope);
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
  int back_flanks = 0, idle = 0, above_all_on_one = 0;
  for (int n = 0; n < 600; ++n) {
    const auto g = random_geometry(random, n);
    const auto levers = backlash::output_levers(g);
    const double half = n % 5 == 0 ? 2e-6 : 20e-6;
    const auto plays = random_plays(random, random.count(1, 5), half, 8e-6);
    const double size = std::pow(10.0, random.between(-1.0, 2.5));
    const double torque = n % 3 == 0 ? -size : size;
    const MeshSprings springs = random_springs(random, 7.5, 8.5);
    const auto forces = shared_forces(levers, springs, plays, torque);
    const auto factors = mesh_load_factors(levers, forces, torque);
    const double all = static_cast<double>(plays.size()) * (1.0 + 1e-6);
    above_all_on_one += std::ranges::max(factors) > all ? 1 : 0;
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
    const auto witness = forces_on_one_carrier(g, springs, plays, torque);
    for (std::size_t p = 0; p < forces.size(); ++p) {
      for (std::size_t m = 0; m < 3; ++m) {
        least_energy.see(n, forces[p][m] - witness[p][m], 1e-8 * greatest);
      }
    }
  }
  sum.expect_allowed("sums_of_forces");
  least_energy.expect_allowed("forces");
  EXPECT_GT(idle, 50);
  EXPECT_GT(back_flanks, 5);
  EXPECT_GT(above_all_on_one, 5);
}

TEST(LoadSharing, ForcesAreInBalanceFromLightLoadsToHeavyOnes) {
  RandomTrain random(87);
  LargestDeviation sum;
  for (int n = 0; n < 3000; ++n) {
    const auto g = random_geometry(random, n);
    const auto levers = backlash::output_levers(g);
    const double half = std::pow(10.0, random.between(-6.0, -3.6));
    const auto plays = random_plays(random, random.count(1, 6), half, half);
    const double torque = std::pow(10.0, random.between(-4.0, 4.0));
    const MeshSprings springs = random_springs(random, 6.0, 10.0);
    const auto forces = shared_forces(levers, springs, plays, torque);
    double greatest = 0.0, places_N = 0.0;
    PlanetForces total{};
    for (std::size_t p = 0; p < plays.size(); ++p) {
      for (std::size_t m = 0; m < 3; ++m) {
        greatest = std::max(greatest, std::abs(forces[p][m]));
        total[m] += forces[p][m];
        const MeshPlay& play = plays[p][m];
        places_N += springs[m] * std::max(std::abs(play.lower_m), std::abs(play.upper_m));
      }
    }
    const double force = torque / levers.output_m;
    const PlanetForces expected{-levers.ring_side * force, -levers.sun_side * force, force};
    for (std::size_t m = 0; m < 3; ++m) {
      sum.see(n, total[m] - expected[m], 1e-10 * greatest + 1e-14 * places_N);
    }
  }
  sum.expect_allowed("sums_of_forces");
}

TEST(LoadSharing, RefusesATorqueThatNothingHolds) {
  RandomTrain random(88);
  int held = 0, turned = 0;
  for (int n = 0; n < 4000; ++n) {
    const auto g = random_geometry(random, n);
    const auto levers = backlash::output_levers(g);
    auto plays = random_plays(random, random.count(1, 3), 20e-6, 8e-6);
    for (PlanetPlay& planet : plays) {
      for (MeshPlay& play : planet) {
        if (random.count(0, 1) == 0) play.lower_m = -kInfinite;
        if (random.count(0, 1) == 0) play.upper_m = kInfinite;
      }
    }
    const double torque = n % 2 == 0 ? 5.0 : -5.0;
    if (turns_for_ever(levers, plays, torque)) {
      ++turned;
      EXPECT_THROW(shared_forces(levers, kSprings, plays, torque), std::invalid_argument) << n;
    } else {
      ++held;
      double sum = 0.0, greatest = 0.0;
      for (const PlanetForces& planet : shared_forces(levers, kSprings, plays, torque)) {
        sum += planet[2];
        for (const double f : planet) greatest = std::max(greatest, std::abs(f));
      }
      EXPECT_NEAR(sum, torque / levers.output_m, 1e-9 * greatest) << n;
    }
  }
  EXPECT_GT(held, 500);
  EXPECT_GT(turned, 500);
}

TEST(LoadSharing, UnderHeavyLoadDiffersByWhatThePlaysDoAndThatStays) {
  // While all flanks that the torque loads carry, f = F/N + k (c δv − δb), δb off the mean play,
  // c = ∂u/∂v, and Σ c f = 0 gives δv: K_γ − 1 falls as 1/T.
  RandomTrain random(83);
  for (int n = 0; n < 100; ++n) {
    const auto g = random_geometry(random, n);
    const auto levers = backlash::output_levers(g);
    const auto plays = random_plays(random, random.count(2, 6), 20e-6, 8e-6);
    const auto planets = static_cast<double>(plays.size());
    const MeshSprings springs = random_springs(random, 7.0, 8.5);
    const std::array<double, 3> c{1.0, -1.0, -levers.planet};
    const std::array<double, 3> share{-levers.ring_side, -levers.sun_side, 1.0};
    for (const double torque : {1e6, -1e6, 1e8}) {
      std::array<double, 3> mean{}, most{};
      const auto loaded = [&](const PlanetPlay& play, std::size_t m) {
        return share[m] * torque > 0.0 ? play[m].upper_m : play[m].lower_m;
      };
      for (const PlanetPlay& play : plays) {
        for (std::size_t m = 0; m < 3; ++m) mean[m] += loaded(play, m) / planets;
      }
      most.fill(-kInfinite);
      bool all_carry = true;
      for (const PlanetPlay& play : plays) {
        double turn = 0.0, stiffness = 0.0;
        for (std::size_t m = 0; m < 3; ++m) {
          turn += springs[m] * c[m] * (loaded(play, m) - mean[m]);
          stiffness += springs[m] * c[m] * c[m];
        }
        for (std::size_t m = 0; m < 3; ++m) {
          const double nominal = share[m] * torque / levers.output_m / planets;
          const double more =
              springs[m] * (c[m] * turn / stiffness - (loaded(play, m) - mean[m])) / nominal;
          all_carry = all_carry && more > -1.0;
          most[m] = std::max(most[m], more);
        }
      }
      ASSERT_TRUE(all_carry) << n;
      const auto factors =
          mesh_load_factors(levers, shared_forces(levers, springs, plays, torque), torque);
      for (std::size_t m = 0; m < 3; ++m) {
        EXPECT_NEAR(factors[m], 1.0 + most[m], 1e-10) << n << ' ' << torque;
      }
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
  const backlash::ScatterOptions scatter{};
  const auto sample = draw_plays(model, {.samples = 3000, .seed = 7, .scatter = scatter});
  const auto series = backlash::monte_carlo(model, {.samples = 3000, .seed = 7});
  EXPECT_EQ(sample.drawn, 3000U);
  EXPECT_EQ(sample.assembled, series.assembled.count);
  ASSERT_EQ(sample.plays.size(), sample.assembled * sample.planets);
  // Gearbox by gearbox those that assemble.
  const backlash::RandomGearbox gearbox(model, scatter, 7);
  std::size_t at = 0;
  for (std::uint64_t number = 0; number < 3000; ++number) {
    const auto plays = backlash::plays(model, gearbox.deviations(number));
    if (!backlash::output_range(model.levers, plays).assembles()) continue;
    for (const PlanetPlay& planet : plays) {
      for (std::size_t m = 0; m < 3; ++m) {
        ASSERT_EQ(sample.plays.at(at)[m].lower_m, planet[m].lower_m) << number;
        ASSERT_EQ(sample.plays.at(at)[m].upper_m, planet[m].upper_m) << number;
      }
      ++at;
    }
  }
}

TEST(LoadFactorSeries, MeanAndQuantileOfGearboxesThatAreKnown) {
  RandomTrain random(84);
  const auto g = random_geometry(random, 0);
  // Three planets alike: 1.  One planet that meets anything: 3.  Two that meet nothing on the
  // flanks of one sense: 1 there, 3 in the other.
  const PlanetPlay near = random_plays(random, 1, 20e-6, 5e-6)[0];
  PlanetPlay far;
  far.fill({.lower_m = -1.0, .upper_m = 1.0});
  const auto levers = backlash::output_levers(g);
  const std::array<double, 3> share{-levers.ring_side, -levers.sun_side, 1.0};
  PlanetPlay one_sided = near;
  for (std::size_t m = 0; m < 3; ++m) {
    (share[m] > 0.0 ? one_sided[m].lower_m : one_sided[m].upper_m) = share[m] > 0.0 ? -1.0 : 1.0;
  }
  const PlaySample two{.levers = levers,
                       .planets = 3,
                       .plays = {near, near, near, far, near, far},
                       .drawn = 5,
                       .assembled = 2};
  for (const double torque : {15.0, -15.0}) {
    const auto half = load_factor_series(two, kSprings, torque, 0.5);
    const auto more = load_factor_series(two, kSprings, torque, 0.51);
    for (std::size_t m = 0; m < 3; ++m) {
      EXPECT_NEAR(half.mean[m], 2.0, 1e-9);
      EXPECT_NEAR(half.quantile[m], 1.0, 1e-9);
      EXPECT_NEAR(more.quantile[m], 3.0, 1e-9);
      // Of two values no interval holds the median with 95 %.
      EXPECT_EQ(half.lower[m], 1.0);
      EXPECT_FALSE(half.upper[m]);
    }
    const PlaySample sided{.levers = levers,
                           .planets = 3,
                           .plays = {near, one_sided, one_sided},
                           .drawn = 1,
                           .assembled = 1};
    for (const double k : load_factor_series(sided, kSprings, torque, 1.0).mean) {
      EXPECT_NEAR(k, 3.0, 1e-9);
    }
  }
  for (const double k : mesh_load_factors(
           levers, shared_forces(levers, kSprings, std::vector{near, one_sided, one_sided}, 15.0),
           15.0)) {
    EXPECT_NEAR(k, 1.0, 1e-9);
  }
}

TEST(LoadFactorSeries, RanksOfTheIntervalAreThoseOfTheBinomialSums) {
  for (const std::uint64_t n : {1U, 5U, 30U, 100U, 300U}) {
    for (const double p : {0.05, 0.5, 0.9, 0.99}) {
      // P(B < r), r = 0 … n + 1.
      std::vector<double> below{0.0};
      for (std::uint64_t r = 0; r <= n; ++r) {
        const auto k = static_cast<double>(r), all = static_cast<double>(n);
        below.push_back(below.back() + std::exp(std::lgamma(all + 1.0) - std::lgamma(k + 1.0) -
                                                std::lgamma(all - k + 1.0) + k * std::log(p) +
                                                (all - k) * std::log(1.0 - p)));
      }
      std::uint64_t lower = 0;
      std::optional<std::uint64_t> upper;
      for (std::uint64_t r = 1; r <= n; ++r) {
        if (below[r] <= 0.025) lower = r;
        if (!upper && 1.0 - below[r] <= 0.025) upper = r;
      }
      const QuantileRanks ranks = quantile_ranks(n, p);
      EXPECT_EQ(ranks.lower, lower) << n << ' ' << p;
      EXPECT_EQ(ranks.upper, upper) << n << ' ' << p;
    }
  }
  // Of the median of 100 the 40th and the 61st, as tables of order statistics have it.
  EXPECT_EQ(quantile_ranks(100, 0.5).lower, 40U);
  EXPECT_EQ(quantile_ranks(100, 0.5).upper, 61U);
  EXPECT_EQ(quantile_ranks(100, 1.0).lower, 100U);
  EXPECT_FALSE(quantile_ranks(100, 1.0).upper);
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
