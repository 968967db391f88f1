#include "strength/flank_strength.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace gear3k::strength::flank_strength_test {
namespace {

FlankCondition<double> condition() {
  return {.cycles = 5e7,
          .softer_limit_Pa = 700e6,
          .reduced_radius_m = 10e-3,
          .speed_m_s = 10.0,
          .viscosity40_m2_s = 100e-6,
          .own_roughness_m = 3e-6,
          .mate_roughness_m = 3e-6};
}
const Material& soft() { return *find_material("34CrNiMo6 through hardened"); }

TEST(FlankStrength, WithoutStatementsIsTheLimit) {
  const auto strength = flank_strength<double>(
      soft(), 700e6, {.cycles = 5e7, .softer_limit_Pa = 700e6, .reduced_radius_m = 1e-3});
  EXPECT_NEAR(strength.strength_Pa, 700e6, 1e-3);
  for (const auto* factor : {&strength.lubricant, &strength.speed, &strength.roughness}) {
    EXPECT_EQ(factor->value, 1.0);
    EXPECT_EQ(factor->source, sources::kNotStated);
  }
}

TEST(FlankStrength, FilmFactorsAreOneNearTheirReferences) {
  // 100 mm²/s, 10 m/s and 3 µm on a radius of 10 mm are what the factors refer to.
  const auto strength = flank_strength(soft(), 700e6, condition());
  EXPECT_NEAR(strength.lubricant.value, 0.83 + 0.68 / (2.54 * 2.54), 1e-14);
  EXPECT_NEAR(strength.speed.value, 0.85 + 0.30 / 2.0, 1e-14);
  EXPECT_NEAR(strength.roughness.value, 1.0, 1e-14);
  auto still = condition();
  still.speed_m_s = 0.0;
  EXPECT_EQ(flank_strength(soft(), 700e6, still).speed.value, 0.85);
  auto hard = condition();
  hard.softer_limit_Pa = 1025e6;
  EXPECT_NEAR(
      flank_strength(soft(), 700e6, hard).lubricant.value,
      [] {
        const double c = 1025.0 / 4375.0 + 0.6357;
        return c + 4.0 * (1.0 - c) / (2.54 * 2.54);
      }(),
      1e-14);
}

TEST(WorkHardening, HelpsASoftGearWithAHardMateOnly) {
  auto c = condition();
  c.brinell_hardness = 300.0;
  EXPECT_EQ(flank_strength(soft(), 700e6, c).work_hardening.value, 1.0);
  c.mate_group = MaterialGroup::kCaseHardened;
  const auto held = flank_strength(soft(), 700e6, c).work_hardening;
  // R = 3/(1000/1500)^0.33 = 3.43.
  const double r = 3.0 / std::pow(10.0 * 100.0 / 1500.0, 0.33);
  EXPECT_NEAR(held.value, (1.2 - 170.0 / 1700.0) * std::pow(3.0 / r, 0.15), 1e-13);
  c.speed_m_s = 100.0;
  EXPECT_NEAR(flank_strength(soft(), 700e6, c).work_hardening.value, 1.1, 1e-14);
  c.speed_m_s = 1e-4;
  EXPECT_EQ(flank_strength(soft(), 700e6, c).work_hardening.branch, "roughness held at 16");
  c.brinell_hardness = 500.0;
  EXPECT_FALSE(flank_strength(soft(), 700e6, c).work_hardening.in_range);
  c.brinell_hardness.reset();
  EXPECT_EQ(flank_strength(soft(), 700e6, c).work_hardening.value, 1.0);
}

TEST(FlankStrength, RefusesWhatHasNoMeaning) {
  EXPECT_THROW(flank_strength(soft(), 0.0, condition()), std::invalid_argument);
  auto c = condition();
  c.reduced_radius_m = 0.0;
  EXPECT_THROW(flank_strength(soft(), 1e6, c), std::invalid_argument);
  c = condition();
  c.speed_m_s = -1.0;
  EXPECT_THROW(flank_strength(soft(), 1e6, c), std::invalid_argument);
  c = condition();
  c.own_roughness_m = 0.0;
  EXPECT_THROW(flank_strength(soft(), 1e6, c), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::flank_strength_test
