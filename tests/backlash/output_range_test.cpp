#include "backlash/output_range.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "backlash/lost_motion.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::backlash::output_range_test {
namespace {

using train::TrainGeometry;

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// What each mesh's u gains per angle of carrier, planet (against the carrier) and output: the
/// central gear's velocity at the pitch point less the planet's, times cos α_w.
struct Gains {
  double carrier, planet, output;
};
std::array<Gains, 3> mesh_gains(const TrainGeometry<double>& t) {
  const double d = t.center_distance_m;
  std::array<Gains, 3> gains{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    const auto& gear1 = t.gears[static_cast<std::size_t>(first)];
    const auto& gear2 = t.gears[static_cast<std::size_t>(second)];
    const bool internal = k != train::kMeshSP1;
    const double z1 = gear1.gear.teeth;
    const double z2 = gear2.gear.teeth;
    const double central = internal ? d * z2 / (z2 - z1) : d * z1 / (z1 + z2);
    const double cos_w = (internal ? gear2 : gear1).base_radius_m / central;
    gains[k] = {.carrier = -cos_w * central,
                .planet = -cos_w * (central - d),
                .output = k == train::kMeshP2R2 ? cos_w * central : 0.0};
  }
  return gains;
}

struct Found {
  double lower, upper;
};

/// Every way in which N + 2 flanks can touch at once fixes carrier, planets and output; of those
/// positions that no other flank forbids, the extreme ones bound the output.  Empty: there are
/// none.
std::optional<Found> searched_contacts(const TrainGeometry<double>& t,
                                       const std::vector<PlanetPlay>& planets) {
  const auto gains = mesh_gains(t);
  const auto unknowns = static_cast<Eigen::Index>(planets.size()) + 2;
  const auto rows = static_cast<Eigen::Index>(6 * planets.size());
  Eigen::MatrixXd row(rows, unknowns);  // row · x ≤ bound
  Eigen::VectorXd bound(rows);
  row.setZero();
  for (std::size_t p = 0; p < planets.size(); ++p) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (const int side : {0, 1}) {
        const auto i = static_cast<Eigen::Index>(6 * p + 2 * k) + side;
        const double sign = side == 0 ? 1.0 : -1.0;
        row(i, 0) = sign * gains[k].carrier;
        row(i, 1) = sign * gains[k].output;
        row(i, static_cast<Eigen::Index>(p) + 2) = sign * gains[k].planet;
        bound[i] = side == 0 ? planets[p][k].upper_m : -planets[p][k].lower_m;
      }
    }
  }
  const double allowed = 1e-10 * bound.cwiseAbs().maxCoeff();
  std::optional<Found> found;
  std::vector<bool> chosen(static_cast<std::size_t>(rows), false);
  std::fill(chosen.begin(), chosen.begin() + unknowns, true);
  Eigen::MatrixXd touching(unknowns, unknowns);
  Eigen::VectorXd closed(unknowns);
  do {
    bool apart = true;  // the two flanks of a mesh never touch at once
    for (std::size_t i = 0; i < chosen.size(); i += 2) apart &= !(chosen[i] && chosen[i + 1]);
    if (!apart) continue;
    Eigen::Index at = 0;
    for (Eigen::Index i = 0; i < rows; ++i) {
      if (!chosen[static_cast<std::size_t>(i)]) continue;
      touching.row(at) = row.row(i);
      closed[at++] = bound[i];
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> solver(touching);
    if (!solver.isInvertible()) continue;
    const Eigen::VectorXd x = solver.solve(closed);
    if ((row * x - bound).maxCoeff() > allowed) continue;
    if (!found) found = Found{.lower = x[1], .upper = x[1]};
    found->lower = std::min(found->lower, x[1]);
    found->upper = std::max(found->upper, x[1]);
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  return found;
}

std::vector<PlanetPlay> alike(const std::array<double, 3>& j, std::size_t count) {
  PlanetPlay play;
  for (std::size_t k = 0; k < 3; ++k) play[k] = {.lower_m = -0.5 * j[k], .upper_m = 0.5 * j[k]};
  return std::vector<PlanetPlay>(count, play);
}

/// Backlash of 10 to 50 µm, each mesh of each planet off its place by up to `off_m`.
std::vector<PlanetPlay> random_planets(RandomTrain& random, std::size_t count, double off_m) {
  std::vector<PlanetPlay> planets(count);
  for (PlanetPlay& planet : planets) {
    for (MeshPlay& play : planet) {
      const double j = random.between(10e-6, 50e-6);
      const double middle = random.between(-off_m, off_m);
      play = {.lower_m = middle - 0.5 * j, .upper_m = middle + 0.5 * j};
    }
  }
  return planets;
}

class OutputRangeOf : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Trains, OutputRangeOf, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& below) {
                           return below.param ? "G2BelowOne" : "G2AboveOne";
                         });

TEST_P(OutputRangeOf, AlikePlanetsIsTheClosedFormAndCentred) {
  RandomTrain random(71);
  LargestDeviation largest;
  for (int i = 0; i < 3000; ++i) {
    const auto t = random.train(GetParam());
    const std::array<double, 3> j{random.between(0.0, 50e-6), random.between(0.0, 50e-6),
                                  random.between(0.0, 50e-6)};
    const double closed = output_lost_motion(t, j, LostMotionModel::kKinematic);
    const auto range =
        output_range(output_levers(t), alike(j, static_cast<std::size_t>(random.count(1, 6))));
    EXPECT_TRUE(range.assembles());
    const double rounding = 16.0 * kEps * (j[0] + j[1] + j[2]) / t.gears[train::kR2].base_radius_m;
    largest.see(i, range.width_rad() - closed, rounding);
    largest.see(i, range.upper_rad - 0.5 * closed, rounding);
  }
  largest.expect_allowed("width");
}

TEST_P(OutputRangeOf, UnequalPlanetsIsThatOfASearchOverAllContacts) {
  RandomTrain random(72);
  LargestDeviation largest;
  int jammed = 0;
  int assembled = 0;
  constexpr std::array<int, 3> kCases{400, 400, 100};
  for (std::size_t count = 1; count <= kCases.size(); ++count) {
    for (int i = 0; i < kCases[count - 1]; ++i) {
      const auto t = random.train(GetParam());
      // Every other one often jams.
      const auto planets = random_planets(random, count, i % 2 == 0 ? 12e-6 : 30e-6);
      const auto range = output_range(output_levers(t), planets);
      const auto found = searched_contacts(t, planets);
      ASSERT_EQ(range.assembles(), found.has_value()) << count << " planets, case " << i;
      if (!found) {
        ++jammed;
        continue;
      }
      ++assembled;
      // Rounding of the search: its contacts nearly depend on each other as G2 nears 1.
      const double allowed =
          1e-11 * (found->upper - found->lower) * (1.0 + std::abs(train::ratio(t.teeth)) * 1e-2);
      largest.see(i, range.lower_rad - found->lower, allowed);
      largest.see(i, range.upper_rad - found->upper, allowed);
    }
  }
  largest.expect_allowed("range");
  EXPECT_GT(jammed, 20);
  EXPECT_GT(assembled, 500);
}

TEST_P(OutputRangeOf, JammedPlanetsFitOnceEveryPlayIsWiderByTheLackAndNotBefore) {
  // A chain of meshes with the sum of weights W gains W times what each bound gains; the shortest
  // chain is one mesh, both bounds of weight 1, the longest w of four bounds or, if greater, those
  // with κ.
  RandomTrain random(73);
  int jammed = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto t = random.train(GetParam());
    const auto levers = output_levers(t);
    const auto planets = random_planets(random, 3, 25e-6);
    const double margin = output_range(levers, planets).margin_m;
    if (margin >= 0.0) continue;
    ++jammed;
    const auto widened = [&](double each_m) {
      auto wider = planets;
      for (PlanetPlay& planet : wider) {
        for (MeshPlay& play : planet) {
          play.lower_m -= each_m;
          play.upper_m += each_m;
        }
      }
      return output_range(levers, wider).margin_m;
    };
    const double heaviest = 4.0 * (1.0 + levers.planet);
    const double lightest = 2.0 * std::min(1.0, levers.planet);
    EXPECT_LT(widened(-margin / heaviest * (1.0 - 1e-9)), 0.0);
    EXPECT_GE(widened(-margin / lightest * (1.0 + 1e-9)), 0.0);
  }
  EXPECT_GT(jammed, 500);
}

TEST_P(OutputRangeOf, MovingCarrierPlanetAndOutputMovesTheRangeOnly) {
  // Rigid rotations change every u together; the range turns with the output.
  RandomTrain random(74);
  LargestDeviation largest;
  for (int i = 0; i < 1000; ++i) {
    const auto t = random.train(GetParam());
    const auto gains = mesh_gains(t);
    auto planets = random_planets(random, 3, 5e-6);
    const auto before = output_range(output_levers(t), planets);
    if (!before.assembles()) continue;
    const double carrier = random.between(-1e-3, 1e-3);
    const double output = random.between(-1e-3, 1e-3);
    for (PlanetPlay& planet : planets) {
      const double spin = random.between(-1e-3, 1e-3);
      for (std::size_t k = 0; k < 3; ++k) {
        const double u =
            gains[k].carrier * carrier + gains[k].planet * spin + gains[k].output * output;
        planet[k].lower_m += u;
        planet[k].upper_m += u;
      }
    }
    const auto after = output_range(output_levers(t), planets);
    const double allowed = 100.0 * kEps * 2e-3;
    largest.see(i, after.lower_rad - before.lower_rad - output, allowed);
    largest.see(i, after.upper_rad - before.upper_rad - output, allowed);
    largest.see(i, after.margin_m - before.margin_m, allowed * t.center_distance_m * 10.0);
  }
  largest.expect_allowed("turned");
}

TEST_P(OutputRangeOf, MorePlanetsNeverWidenIt) {
  RandomTrain random(75);
  for (int i = 0; i < 500; ++i) {
    const auto t = random.train(GetParam());
    const auto levers = output_levers(t);
    const auto planets = random_planets(random, 5, 5e-6);
    for (std::size_t count = 2; count <= planets.size(); ++count) {
      const auto fewer = output_range(levers, std::span(planets).first(count - 1));
      const auto more = output_range(levers, std::span(planets).first(count));
      EXPECT_LE(more.margin_m, fewer.margin_m);
      EXPECT_LE(more.upper_rad, fewer.upper_rad);
      EXPECT_GE(more.lower_rad, fewer.lower_rad);
    }
  }
}

TEST(OutputRange, OffsetsOfTenMicrometresHalveTheClosedFormAtForty) {
  // 40 µm in every mesh; meshes 2 and 3 of one planet stand 10 µm off in opposite senses, those of
  // the next the other way round: 20 + 20 of the 40 + 40 µm are lost.
  train::TrainParameters<double> p{};
  p.teeth = {.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  p.pressure_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.module_m = {0.8e-3, 0.8e-3 * 51.0 / 49.0};
  p.center_distance_m = 20.6e-3;
  const auto t = make_train_geometry(p);
  ASSERT_TRUE(t);
  const std::array<double, 3> j{40e-6, 40e-6, 40e-6};
  auto planets = alike(j, 3);
  const auto offset = [&](std::size_t planet, std::size_t mesh, double by_m) {
    planets[planet][mesh].lower_m += by_m;
    planets[planet][mesh].upper_m += by_m;
  };
  offset(0, train::kMeshP1R1, 10e-6);
  offset(0, train::kMeshP2R2, -10e-6);
  offset(1, train::kMeshP1R1, -10e-6);
  offset(1, train::kMeshP2R2, 10e-6);
  const auto range = output_range(output_levers(*t), planets);
  EXPECT_TRUE(range.assembles());
  const double share = range.width_rad() / output_lost_motion(*t, j, LostMotionModel::kKinematic);
  EXPECT_NEAR(share, 0.5, 0.03);
  const auto found = searched_contacts(*t, planets);
  ASSERT_TRUE(found);
  EXPECT_NEAR(range.width_rad(), found->upper - found->lower, 1e-9 * range.width_rad());
}

TEST(OutputRange, OfNoPlanetsIsRefused) {
  EXPECT_THROW(output_range({}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::backlash::output_range_test
