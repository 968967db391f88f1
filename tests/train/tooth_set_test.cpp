#include "train/tooth_set.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <string>

#include "tests/largest_deviation.hpp"
#include "tests/linear_solve.hpp"

namespace gear3k::train::tooth_set_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

class RandomTeeth {
 public:
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }
  /// A 3K set whose output moves.
  ToothSet operator()(int largest_planet = 60) {
    for (;;) {
      ToothSet z;
      z.S = count(10, 30);
      z.P1 = count(12, largest_planet);
      z.R1 = z.S + 2 * z.P1 + count(-4, 4);
      z.P2 = count(12, largest_planet);
      z.R2 = z.P2 + count(8, 70);
      if (z.P1 * z.R2 != z.P2 * z.R1) return z;
    }
  }

 private:
  std::mt19937_64 generator_{5};
};

/// Speeds at w_R2 = 1 from the rolling conditions at the pitch points, as one linear system.
struct SolvedSpeeds {
  double sun, planet, carrier;
};
SolvedSpeeds solve_willis(const ToothSet& z) {
  // Unknowns: w_S, w_P, w_C.  Pitch velocities seen from the carrier agree in every mesh.
  Eigen::Matrix3d a;
  Eigen::Vector3d b;
  a << z.S, z.P1, -(z.S + z.P1),  // S-P1: zS (wS - wC) = -zP1 (wP - wC)
      0, z.P1, z.R1 - z.P1,       // P1-R1: zP1 (wP - wC) = zR1 (0 - wC)
      0, z.P2, z.R2 - z.P2;       // P2-R2: zP2 (wP - wC) = zR2 (1 - wC)
  b << 0.0, 0.0, z.R2;
  const Eigen::Vector3d w = test::solved(a, b);
  return {.sun = w[0], .planet = w[1], .carrier = w[2]};
}

TEST(SpeedRatios, SolveTheWillisEquations) {
  RandomTeeth random;
  LargestDeviation largest;
  int reversed = 0;
  for (int i = 0; i < 5000; ++i) {
    const ToothSet z = random();
    const SolvedSpeeds solved = solve_willis(z);
    const SpeedRatios w = speed_ratios(z);
    // The linear system loses digits as G2 nears 1, where the carrier becomes fast.
    const double allowed = 64.0 * kEps * (1.0 + solved.carrier * solved.carrier);
    largest.see(i, w.sun - solved.sun, allowed * std::abs(solved.sun / solved.carrier));
    largest.see(i, w.planet - solved.planet, allowed);
    largest.see(i, w.carrier - solved.carrier, allowed);
    largest.see(i, ratio(z) - solved.sun, allowed * std::abs(solved.sun / solved.carrier));
    reversed += ratio(z) < 0.0 ? 1 : 0;
  }
  largest.expect_allowed("speed");
  EXPECT_GT(reversed, 1000);
}

TEST(SpeedRatios, RollingSpeedsAreTheAbsoluteOnesSeenFromTheCarrier) {
  RandomTeeth random;
  LargestDeviation largest;
  for (int i = 0; i < 5000; ++i) {
    const SpeedRatios w = speed_ratios(random());
    const double output = 1.0 - w.carrier;
    const double allowed = 64.0 * kEps * (1.0 + std::abs(w.carrier)) / std::abs(output);
    largest.see(i, w.planet_rolling - (w.planet - w.carrier) / output,
                allowed * (1.0 + std::abs(w.planet_rolling)));
    largest.see(i, w.sun_rolling - (w.sun - w.carrier) / output,
                allowed * (1.0 + std::abs(w.sun_rolling)));
  }
  largest.expect_allowed("rolling_speed");
}

TEST(Ratio, OutputTurnsAgainstTheInputExactlyWhenG2ExceedsOne) {
  RandomTeeth random;
  for (int i = 0; i < 2000; ++i) {
    const ToothSet z = random();
    EXPECT_EQ(ratio(z) < 0.0, z.P2 * z.R1 > z.P1 * z.R2);
    EXPECT_EQ(ratio(z) < 0.0, g2(z) > 1.0);
  }
}

TEST(Ratio, OfTheBilateralDriveGearIs5967Over62) {
  EXPECT_EQ(ratio({.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81}), 5967.0 / 62.0);
}

TEST(Ratio, IsRefusedWhereTheOutputStandsStill) {
  EXPECT_THROW(ratio({.S = 12, .P1 = 40, .R1 = 92, .P2 = 20, .R2 = 46}), std::invalid_argument);
  EXPECT_THROW(speed_ratios({.S = 12, .P1 = 40, .R1 = 92, .P2 = 20, .R2 = 46}),
               std::invalid_argument);
}

double part_of_one(double x) { return x - std::floor(x); }
bool whole(double x) { return std::abs(x - std::round(x)) < 1e-9; }

/// Assembly tried out: the central gears stand as planet 0 wants them; for planet k, every turn of
/// P1 whose teeth fit ring R1 is tried on the sun, and every turn of P2 that fits R2 is compared
/// with it.  Angles in turns.
struct TriedAssembly {
  bool equal_spacing = true;
  std::vector<double> phase;  // smallest P2-against-P1 angle that fits, from planet 0's
};
TriedAssembly try_assembly(const ToothSet& z, int planets) {
  // Planet 0 at angle 0 with a P1 tooth and a P2 tooth pointing outwards: the rings have a space
  // there; towards the sun (half a turn of the planet) P1 has a tooth or a space, S the opposite.
  const double sun_phase = part_of_one(0.5 * z.P1 + 0.5);  // sun's tooth phase at angle 0
  TriedAssembly result;
  for (int k = 0; k < planets; ++k) {
    const double place = static_cast<double>(k) / planets;
    // A gear with a tooth at angle 0 has tooth phase part_of_one(z * angle) at an angle.  At the
    // planet's place: of the rings' spaces (a space at angle 0), and of the sun's teeth.
    const double r1 = part_of_one(z.R1 * place);
    const double r2 = part_of_one(z.R2 * place);
    const double sun = part_of_one(z.S * place + sun_phase);
    double best = 2.0;
    for (int n1 = 0; n1 < z.P1; ++n1) {
      // P1 turned by `turn1`: the tooth phase it shows outwards, zP1 (place - turn1), is R1's.
      const double turn1 = place - (r1 + n1) / z.P1;
      // Towards the sun the phases run against each other and add to half a pitch.
      const double inward = z.P1 * (place + 0.5 - turn1);
      if (!whole(inward + sun - 0.5)) continue;
      for (int n2 = 0; n2 < z.P2; ++n2) {
        const double turn2 = place - (r2 + n2) / z.P2;
        double phase = part_of_one(turn2 - turn1);
        if (phase > 1.0 - 1e-9) phase = 0.0;
        best = std::min(best, phase);
      }
    }
    if (best > 1.0) {
      result.equal_spacing = false;
      return result;
    }
    result.phase.push_back(best);
  }
  return result;
}

TEST(Assembly, AgreesWithTryingTheTeethAtEveryPlanetPosition) {
  RandomTeeth random;
  LargestDeviation largest;
  int spaced = 0, identical = 0, phased = 0;
  for (int i = 0; i < 600; ++i) {
    const ToothSet z = random(40);
    const int planets = random.count(1, 6);
    const TriedAssembly tried = try_assembly(z, planets);
    const Assembly found = assembly(z, planets);
    ASSERT_EQ(found.equal_spacing, tried.equal_spacing) << "case " << i;
    if (!found.equal_spacing) {
      EXPECT_TRUE(found.planet_phase_rad.empty());
      EXPECT_FALSE(found.identical_planets);
      continue;
    }
    ++spaced;
    ASSERT_EQ(found.planet_phase_rad.size(), tried.phase.size());
    bool all_zero = true;
    for (std::size_t k = 0; k < tried.phase.size(); ++k) {
      largest.see(i, found.planet_phase_rad[k] - 2.0 * kPi * tried.phase[k], 1e-12);
      all_zero = all_zero && tried.phase[k] < 1e-9;
    }
    EXPECT_EQ(found.identical_planets, all_zero) << "case " << i;
    (all_zero ? identical : phased) += 1;
  }
  largest.expect_allowed("phase");
  EXPECT_GT(spaced, 150);
  EXPECT_GT(identical, 30);
  EXPECT_GT(phased, 30);
}

TEST(Assembly, OfOnePlanetNeverNeedsAPhase) {
  RandomTeeth random;
  for (int i = 0; i < 200; ++i) {
    const Assembly result = assembly(random(), 1);
    EXPECT_TRUE(result.equal_spacing);
    EXPECT_TRUE(result.identical_planets);
    EXPECT_EQ(result.planet_phase_rad, std::vector<double>{0.0});
  }
}

TEST(Assembly, PhasesStayWithinOneToothSymmetryOfThePlanet) {
  RandomTeeth random;
  for (int i = 0; i < 2000; ++i) {
    const ToothSet z = random();
    for (const double phase : assembly(z, random.count(2, 6)).planet_phase_rad) {
      EXPECT_GE(phase, 0.0);
      EXPECT_LT(phase, 2.0 * kPi / static_cast<double>(std::lcm(z.P1, z.P2)));
    }
  }
}

TEST(Assembly, RefusesLessThanOnePlanet) {
  const ToothSet z{.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  EXPECT_THROW(assembly(z, 0), std::invalid_argument);
  EXPECT_THROW(assembly(z, -3), std::invalid_argument);
}

TEST(HuntingPeriod, IsTheCountOfTeethUntilTheSameTwoMeetAgain) {
  for (int z1 = 8; z1 <= 40; ++z1) {
    for (int z2 = 8; z2 <= 40; ++z2) {
      int passed = 1;
      while (passed % z1 != 0 || passed % z2 != 0) ++passed;
      ASSERT_EQ(hunting_period_teeth(z1, z2), passed) << z1 << "/" << z2;
    }
  }
}

TEST(PublishedGearbox, RatioAndPlanetPhasesAreReproduced) {
  const toml::table file = toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/published_3k.toml");
  int gearboxes = 0;
  for (const toml::node& node : *file["gearbox"].as_array()) {
    const toml::table& box = *node.as_table();
    SCOPED_TRACE(box["id"].value_or("(no id)"));
    ASSERT_NE(std::string(box["cite"].value_or("")), "");
    ASSERT_NE(std::string(box["locator"].value_or("")), "");
    const toml::array& teeth = *box["teeth"].as_array();
    const auto count = [&](std::size_t i) { return teeth[i].value<int>().value(); };
    const ToothSet z{.S = count(0), .P1 = count(1), .R1 = count(2), .P2 = count(3), .R2 = count(4)};
    constexpr double kHalfUnit = 0.5e-3;  // of the ratio's third decimal
    EXPECT_NEAR(ratio(z), box["expect"]["ratio"].value<double>().value(), kHalfUnit);
    const Assembly result = assembly(z, box["planets"].value<int>().value());
    EXPECT_EQ(result.equal_spacing, box["expect"]["equal_spacing"].value<bool>().value());
    EXPECT_EQ(result.identical_planets, box["expect"]["identical_planets"].value<bool>().value());
    const toml::array& phases = *box["expect"]["phases"].as_array();
    ASSERT_EQ(result.planet_phase_rad.size(), phases.size());
    for (std::size_t k = 0; k < phases.size(); ++k) {
      const std::string fraction = phases[k].value_or("");
      const double degrees =
          std::stod(fraction) / (fraction.ends_with("/3") ? 3.0 : 1.0);  // "1/3" reads as 1
      EXPECT_NEAR(result.planet_phase_rad[k], degrees * kPi / 180.0, 4.0 * kEps * kPi);
    }
    ++gearboxes;
  }
  EXPECT_EQ(gearboxes, 2);
}

TEST(MeshPhases, AreWhereATurnByTheCarriersAngleLeavesTheTeeth) {
  // At planet k the line of centres is turned by 2 pi k/N: sun teeth pass it with their own turn,
  // ring teeth against it.  Rolling: the sun's tooth that meets planet 0 lies at angle 0.
  const ToothSet z{.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92};
  for (const int planets : {2, 3, 4, 6}) {
    for (const MeshId mesh : {kMeshSP1, kMeshP1R1, kMeshP2R2}) {
      const double teeth = mesh == kMeshSP1 ? z.S : mesh == kMeshP1R1 ? -z.R1 : -z.R2;
      const auto phases = mesh_phases(z, mesh, planets);
      ASSERT_EQ(phases.size(), static_cast<std::size_t>(planets));
      for (int k = 0; k < planets; ++k) {
        const double pitches = teeth * k / planets;
        EXPECT_NEAR(phases[static_cast<std::size_t>(k)], pitches - std::floor(pitches), 1e-12);
      }
    }
    // Where the planets fit, the meshes of P1 with sun and ring stand alike.
    if ((z.S + z.R1) % planets == 0) {
      EXPECT_EQ(mesh_phases(z, kMeshSP1, planets), mesh_phases(z, kMeshP1R1, planets));
    }
  }
  EXPECT_THROW(mesh_phases(z, kMeshSP1, 0), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::train::tooth_set_test
