#include "strength/root_strength.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "strength/life_factor.hpp"

namespace gear3k::strength::root_strength_test {
namespace {

TEST(LifeFactor, PassesThroughItsPointsAndIsHeldBeyond) {
  struct Point {
    MaterialGroup group;
    LifeCurve curve;
    double cycles, root, flank;
  };
  constexpr auto kV = MaterialGroup::kThroughHardened;
  constexpr auto kEh = MaterialGroup::kCaseHardened;
  for (const double at : {0.0, 1.0, 1e3}) {
    EXPECT_EQ(root_life_factor(kEh, LifeCurve::kSteel, at).value, 2.5);
    EXPECT_EQ(root_life_factor(kV, LifeCurve::kSteel, 10.0 * at).value, 2.5);
    EXPECT_EQ(flank_life_factor(LifeCurve::kSteel, false, 100.0 * at).value, 1.6);
  }
  for (const Point& p :
       {Point{kEh, LifeCurve::kSteel, 3e6, 1.0, 0.0}, Point{kV, LifeCurve::kSteel, 3e6, 1.0, 0.0},
        Point{kV, LifeCurve::kNitrided, 1e3, 1.6, 0.0},
        Point{kV, LifeCurve::kNitrocarburised, 1e3, 1.1, 0.0},
        Point{kV, LifeCurve::kNitrided, 1e10, 0.85, 0.0}}) {
    EXPECT_NEAR(root_life_factor(p.group, p.curve, p.cycles).value, p.root, 1e-12);
  }
  EXPECT_NEAR(flank_life_factor(LifeCurve::kSteel, false, 5e7).value, 1.0, 1e-12);
  EXPECT_NEAR(flank_life_factor(LifeCurve::kSteel, true, 1e7).value, 1.3, 1e-12);
  EXPECT_NEAR(flank_life_factor(LifeCurve::kSteel, true, 1e9).value, 1.0, 1e-12);
  EXPECT_NEAR(flank_life_factor(LifeCurve::kNitrided, false, 1e5).value, 1.3, 1e-12);
  EXPECT_NEAR(flank_life_factor(LifeCurve::kNitrocarburised, false, 2e6).value, 1.0, 1e-12);
  // Halfway in logarithms.
  EXPECT_NEAR(root_life_factor(kEh, LifeCurve::kSteel, std::sqrt(1e3 * 3e6)).value, std::sqrt(2.5),
              1e-12);
  EXPECT_FALSE(root_life_factor(kEh, LifeCurve::kSteel, 1e11).in_range);
  // Of nitrocarburised steel the whole of finite life lies between 1.1 and 1.
  const auto branch = [](double cycles) {
    return root_life_factor(MaterialGroup::kNitrocarburised, LifeCurve::kNitrocarburised, cycles)
        .branch;
  };
  EXPECT_EQ(branch(1e3), "static");
  EXPECT_EQ(branch(1e5), "finite life");
  EXPECT_EQ(branch(1e7), "long life");
  EXPECT_EQ(root_life_factor(kEh, LifeCurve::kNone, 1e5).source, sources::kNotStated);
  EXPECT_EQ(root_life_factor(MaterialGroup::kPom, LifeCurve::kPlastic, 1e5).value, 1.0);
  EXPECT_THROW(root_life_factor(kEh, LifeCurve::kSteel, -1.0), std::invalid_argument);
  EXPECT_THROW(flank_life_factor(LifeCurve::kSteel, false, std::nan("")), std::invalid_argument);
}

Material steel(MaterialGroup group, std::optional<double> yield_Pa = std::nullopt) {
  Material material = *find_material("16MnCr5");
  material.group = group;
  material.yield_strength_Pa = yield_Pa;
  return material;
}
RootCondition<double> condition() {
  return {.cycles = 3e6, .notch_parameter = 2.0, .module_m = 1e-3};
}

TEST(RootStrength, IsTheProductOfItsFactors) {
  auto c = condition();
  c.root_roughness_m = 10e-6;
  c.loading = RootLoading::kReversed;
  const auto strength = root_strength(steel(MaterialGroup::kCaseHardened), 430e6, c);
  const double rho = 0.0030;
  const double notch = (1.0 + std::sqrt(0.2 * rho * 5.0)) / (1.0 + std::sqrt(1.2 * rho));
  const double surface = 1.674 - 0.529 * std::pow(11.0, 0.1);
  EXPECT_NEAR(strength.notch_sensitivity.value, notch, 1e-15);
  EXPECT_NEAR(strength.surface.value, surface, 1e-15);
  EXPECT_NEAR(strength.strength_Pa, 430e6 * 2.0 * notch * surface * 0.7, 1e-3);
  EXPECT_NEAR(root_safety(strength, 100e6), strength.strength_Pa / 100e6, 1e-15);
  EXPECT_NEAR(static_root_strength(steel(MaterialGroup::kCaseHardened), 430e6, c).strength_Pa,
              2.5 * strength.strength_Pa, 1e-3);
}

TEST(NotchSensitivity, IsOneAtTheReferenceNotchAndFollowsTheYieldStrength) {
  auto c = condition();
  c.notch_parameter = 2.5;
  for (const double yield : {350e6, 450e6, 700e6, 1200e6}) {
    const auto strength = root_strength(steel(MaterialGroup::kThroughHardened, yield), 300e6, c);
    EXPECT_NEAR(strength.notch_sensitivity.value, 1.0, 1e-15) << yield;
  }
  c.notch_parameter = 4.0;
  const auto between = root_strength(steel(MaterialGroup::kThroughHardened, 700e6), 300e6, c);
  const double rho = 0.5 * (0.0194 + 0.0064);
  EXPECT_NEAR(between.notch_sensitivity.value,
              (1.0 + std::sqrt(0.2 * rho * 9.0)) / (1.0 + std::sqrt(1.2 * rho)), 1e-14);
  const auto unstated = root_strength(steel(MaterialGroup::kThroughHardened), 300e6, c);
  EXPECT_EQ(unstated.notch_sensitivity.value, 1.0);
  EXPECT_EQ(unstated.notch_sensitivity.source, sources::kNotStated);
  EXPECT_FALSE(root_strength(steel(MaterialGroup::kThroughHardened, 1200e6), 300e6, c)
                   .notch_sensitivity.in_range);
}

TEST(SurfaceAndSize, HaveTheirBranches) {
  auto c = condition();
  EXPECT_EQ(root_strength(steel(MaterialGroup::kInduction), 300e6, c).surface.value, 1.0);
  c.root_roughness_m = 0.5e-6;
  EXPECT_EQ(root_strength(steel(MaterialGroup::kInduction), 300e6, c).surface.value, 1.12);
  EXPECT_EQ(root_strength(steel(MaterialGroup::kNormalised), 300e6, c).surface.value, 1.07);
  EXPECT_EQ(root_strength(steel(MaterialGroup::kNitrided), 300e6, c).surface.value, 1.025);
  // The reference roughness of 10 µm, at which each law is 1 to its digits.
  c.root_roughness_m = 10e-6;
  for (const auto group :
       {MaterialGroup::kInduction, MaterialGroup::kNormalised, MaterialGroup::kNitriding}) {
    EXPECT_NEAR(root_strength(steel(group), 300e6, c).surface.value, 1.0, 0.02);
  }
  c.module_m = 10e-3;
  EXPECT_NEAR(root_strength(steel(MaterialGroup::kInduction), 300e6, c).size.value, 0.95, 1e-14);
  EXPECT_NEAR(root_strength(steel(MaterialGroup::kThroughHardened), 300e6, c).size.value, 0.97,
              1e-14);
  // Continuous at 5 mm.
  c.module_m = 5.0000001e-3;
  EXPECT_NEAR(root_strength(steel(MaterialGroup::kInduction), 300e6, c).size.value, 1.0, 1e-8);
}

TEST(RootStrength, RefusesWhatHasNoMeaning) {
  const Material material = steel(MaterialGroup::kCaseHardened);
  EXPECT_THROW(root_strength(material, 0.0, condition()), std::invalid_argument);
  EXPECT_THROW(root_strength(material, std::nan(""), condition()), std::invalid_argument);
  auto c = condition();
  c.module_m = 0.0;
  EXPECT_THROW(root_strength(material, 1e6, c), std::invalid_argument);
  c = condition();
  c.root_roughness_m = -1e-6;
  EXPECT_THROW(root_strength(material, 1e6, c), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::root_strength_test
