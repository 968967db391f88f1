#include "design/evaluation.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/strength/steel.hpp"

namespace gear3k::design::evaluation_test {
namespace {

using efficiency::LossModel;
using geometry::GearKind;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr double kArcmin_rad = kPi / 10800.0;

Design prototype(const toml::table& box) {
  const auto number = [&](const char* key, std::size_t i) {
    return (*box[key].as_array())[i].value<double>().value();
  };
  const auto teeth = [&](std::size_t i) { return static_cast<int>(number("teeth", i)); };
  Design d;
  d.name = box["id"].value_or("");
  d.train = {
      .teeth = {.S = teeth(0), .P1 = teeth(1), .R1 = teeth(2), .P2 = teeth(3), .R2 = teeth(4)},
      .planets = 3,
      .pressure_angle_rad = box["pressure_angle"].value<double>().value() * kPi / 180.0,
      .center_distance_m = 0.0,
      .module_m = {number("modules", 0) * 1e-3, number("modules", 1) * 1e-3},
      .profile_shift = {},
      .machining_allowance = {},
      .tip_shortening = {},
      .rack = {}};
  for (std::size_t i = 0; i < train::kGearCount; ++i)
    d.train.profile_shift[i] = number("shifts", i);
  return d;
}

const toml::table& published() {
  static const toml::table kFile =
      toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/published_3k.toml");
  return kFile;
}

const toml::table& gearbox(const std::string& id) {
  for (const toml::node& node : *published()["gearbox"].as_array()) {
    const toml::table& box = *node.as_table();
    if (box["id"].value_or("") == id) return box;
  }
  throw std::invalid_argument("no gearbox " + id + " in published_3k.toml");
}

Design low_backlash() { return prototype(gearbox("low_backlash")); }
Design bilateral() { return prototype(gearbox("bilateral_drive_gear")); }

Evaluation evaluated(const Design& design) { return std::get<Evaluation>(evaluate(design)); }

const CheckResult& find_check(const std::vector<CheckResult>& checks, CheckId id,
                              const std::string& mesh = "", const std::string& gear = "") {
  for (const CheckResult& c : checks) {
    if (c.record->id == id && c.mesh == mesh && c.gear == gear) return c;
  }
  throw std::invalid_argument("no such check");
}

bool has_note(const std::vector<std::string>& notes, const std::string& text) {
  return std::ranges::any_of(
      notes, [&](const std::string& n) { return n.find(text) != std::string::npos; });
}

/// The teeth of a 3K train whose output turns against its input.
Design reversed() {
  Design d = low_backlash();
  d.train.teeth = {.S = 12, .P1 = 40, .R1 = 92, .P2 = 43, .R2 = 95};
  d.train.module_m = {0.6e-3, 0.6e-3};
  d.train.profile_shift = {0.3, 0.2, 0.4, 0.2, 0.4};
  return d;
}

TEST(Evaluation, PublishedEfficienciesAreReproducedToTheirPrintedDigits) {
  const toml::table& box = gearbox("low_backlash");
  ASSERT_NE(std::string(box["cite"].value_or("")), "");
  const auto expected = [&](const char* model, std::size_t i) {
    return (*box["expect"][model].as_array())[i].value<double>().value();
  };
  for (const bool given : {false, true}) {
    Design d = low_backlash();
    d.center_distance_given = given;
    d.train.center_distance_m = given ? 16.1813e-3 : 0.0;  // to the digits of the golden distance
    d.friction = {.coefficient = box["expect"]["friction"].value<double>().value(),
                  .model = LossModel::kOhlendorf};
    const Evaluation ohlendorf = evaluated(d);
    EXPECT_NEAR(ohlendorf.efficiency.forward.value(), expected("ohlendorf", 0), 0.5e-4);
    EXPECT_NEAR(ohlendorf.efficiency.backward.value(), expected("ohlendorf", 1), 0.5e-4);
    d.friction.model = LossModel::kSliding;
    const Evaluation sliding = evaluated(d);
    EXPECT_NEAR(sliding.efficiency.forward.value(), expected("sliding", 0), 0.5e-3);
    EXPECT_NEAR(sliding.efficiency.backward.value(), expected("sliding", 1), 0.5e-3);
    for (const std::size_t k : {1U, 2U}) {
      const MeshResult& m = sliding.meshes[k];
      EXPECT_NEAR(std::max(m.approach_contact_ratio, m.recess_contact_ratio),
                  expected("greater_shares", k - 1), 0.5e-2)
          << m.name;
    }
  }
}

TEST(Evaluation, FrictionFittedToMeasuredEfficienciesIsReproduced) {
  int fits = 0;
  for (const toml::node& node : *published()["gearbox"].as_array()) {
    const toml::table& box = *node.as_table();
    for (const toml::node& entry : *box["fits"].as_array()) {
      const toml::table& fit = *entry.as_table();
      const bool forward = fit.contains("forward");
      const double wanted = fit[forward ? "forward" : "backward"].value<double>().value();
      const auto efficiency_at = [&](double mu) {
        Design d = prototype(box);
        d.friction = {.coefficient = mu, .model = LossModel::kOhlendorf};
        const Evaluation e = evaluated(d);
        return forward ? e.efficiency.forward.value() : e.efficiency.backward.value();
      };
      const double mu = fit["mu"].value<double>().value();
      constexpr double kHalfUnit = 0.5e-3;  // of mu and of the efficiency
      EXPECT_GE(efficiency_at(mu - kHalfUnit), wanted - kHalfUnit) << mu;
      EXPECT_LE(efficiency_at(mu + kHalfUnit), wanted + kHalfUnit) << mu;
      ++fits;
    }
  }
  EXPECT_EQ(fits, 6);
}

TEST(Evaluation, PublishedContactRatiosAreReproducedWithFullAndWithShortenedTips) {
  const toml::table& box = gearbox("bilateral_drive_gear");
  const auto expected = [&](const char* key, std::size_t i) {
    return (*box["expect"][key].as_array())[i].value<double>().value();
  };
  constexpr double kHalfUnit = 0.5e-3;
  Design d = bilateral();
  const Evaluation full = evaluated(d);
  d.center_distance_given = true;
  for (std::size_t k = 0; k < 3; ++k) {
    d.train.center_distance_m = full.meshes[k].zero_backlash_center_distance_m.value();
    EXPECT_NEAR(evaluated(d).meshes[k].contact_ratio, expected("contact_ratios", k), kHalfUnit)
        << full.meshes[k].name;
  }
  d.center_distance_given = false;
  // KHK rule: k = x_S + x_P1 - (a - a0)/m on both gears of the external mesh.
  const double y = full.center_distance_m / 0.8e-3 - 0.5 * (12 + 39);
  const double shortening = 0.476 + 0.762 - y;
  d.train.tip_shortening[train::kS] = shortening;
  d.train.tip_shortening[train::kP1] = shortening;
  const Evaluation cut = evaluated(d);
  EXPECT_NEAR(cut.meshes[0].contact_ratio, expected("shortened_contact_ratios", 0), kHalfUnit);
  EXPECT_NEAR(cut.meshes[1].contact_ratio, expected("shortened_contact_ratios", 1), kHalfUnit);
}

TEST(Evaluation, OptimumOfAnotherProgramIsReproducedWithinTheDigitsOfItsVariables) {
  const toml::table file = toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/rp96.toml");
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  ASSERT_NE(std::string(file["locator"].value_or("")), "");
  const auto number = [&](const char* key) { return file[key].value<double>().value(); };
  const auto entry = [&](const char* key, std::size_t i) {
    return (*file[key].as_array())[i].value<double>().value();
  };
  const auto teeth = [&](std::size_t i) { return static_cast<int>(entry("teeth", i)); };
  // Variables: five shifts, module of stage 2, centre distance.
  std::array<double, 7> variables{}, half_units{};
  for (std::size_t i = 0; i < 5; ++i) {
    variables[i] = entry("shifts", i);
    half_units[i] = entry("shift_half_units", i);
  }
  variables[5] = number("module2");
  half_units[5] = number("module2_half_unit");
  variables[6] = number("center_distance");
  half_units[6] = number("center_distance_half_unit");
  const auto results = [&](const std::array<double, 7>& v) {
    Design d;
    d.train = {
        .teeth = {.S = teeth(0), .P1 = teeth(1), .R1 = teeth(2), .P2 = teeth(3), .R2 = teeth(4)},
        .planets = 3,
        .pressure_angle_rad = number("pressure_angle") * kPi / 180.0,
        .center_distance_m = v[6] * 1e-3,
        .module_m = {1e-3, v[5] * 1e-3},
        .profile_shift = {v[0], v[1], v[2], v[3], v[4]},
        .machining_allowance = {},
        .tip_shortening = {},
        .rack = {}};
    d.center_distance_given = true;
    d.friction = {.coefficient = number("friction"), .model = LossModel::kOhlendorf};
    const Evaluation e = evaluated(d);
    return std::map<std::string, double>{
        {"ratio", e.ratio},
        {"forward", e.efficiency.forward.value()},
        {"backward", e.efficiency.backward.value()},
        {"contact_ratio1", e.meshes[0].contact_ratio},
        {"contact_ratio2", e.meshes[1].contact_ratio},
        {"contact_ratio3", e.meshes[2].contact_ratio},
        {"paper_arcmin", e.lost_motion.paper_rad / kArcmin_rad},
        {"kinematic_arcmin", e.lost_motion.kinematic_rad / kArcmin_rad}};
  };
  const auto nominal = results(variables);
  std::map<std::string, double> spread;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    std::map<std::string, double> worst;
    for (const double side : {-1.0, 1.0}) {
      auto moved = variables;
      moved[i] += side * half_units[i];
      for (const auto& [name, value] : results(moved)) {
        worst[name] = std::max(worst[name], std::abs(value - nominal.at(name)));
      }
    }
    for (const auto& [name, value] : worst) spread[name] += value;
  }
  for (const toml::node& node : *file["expect"].as_array()) {
    const toml::table& e = *node.as_table();
    const std::string quantity = e["quantity"].value_or("");
    const double half_unit = 0.5 * std::pow(10.0, -e["decimals"].value<int>().value());
    EXPECT_NEAR(nominal.at(quantity), e["value"].value<double>().value(),
                spread.at(quantity) + half_unit)
        << quantity;
    // The inputs' digits leave the comparison sharp.
    EXPECT_LT(spread.at(quantity), 0.02 * std::abs(nominal.at(quantity))) << quantity;
  }
}

TEST(Evaluation, WithoutACentreDistanceTakesTheZeroBacklashOneOfTheMiddleMeshAndSaysSo) {
  Design d = low_backlash();
  const Evaluation e = evaluated(d);
  ASSERT_TRUE(e.meshes[1].zero_backlash_center_distance_m);
  EXPECT_EQ(e.center_distance_m, *e.meshes[1].zero_backlash_center_distance_m);
  EXPECT_FALSE(e.center_distance_given);
  EXPECT_TRUE(has_note(e.notes, "P1-R1"));
  EXPECT_NEAR(e.meshes[1].normal_backlash_m, 0.0, 1e-14 * e.center_distance_m * 4.0);
  d.center_distance_given = true;
  d.train.center_distance_m = 16.19e-3;
  const Evaluation given = evaluated(d);
  EXPECT_EQ(given.center_distance_m, 16.19e-3);
  EXPECT_TRUE(given.center_distance_given);
  EXPECT_FALSE(has_note(given.notes, "center_distance_mm"));
}

TEST(Evaluation, NegativeNormalBacklashIsAFailedCheckAndNotAnError) {
  // At mesh P1-R1's own distance, S-P1 (which wants 16.2077 mm) interferes.
  const Evaluation e = evaluated(low_backlash());
  const CheckResult& c = find_check(e.checks, CheckId::kNormalBacklash, "S-P1");
  EXPECT_LT(e.meshes[0].normal_backlash_m, 0.0);
  EXPECT_EQ(c.value, e.meshes[0].normal_backlash_m);
  EXPECT_EQ(c.margin, c.value - c.limit);
  EXPECT_FALSE(c.ok);
  EXPECT_FALSE(all_ok(e.checks));
}

TEST(Evaluation, NoCommonDistanceLeavesTheProposedGearWithoutInterference) {
  // Zero-backlash distances 16.2077 (external, wants more), 16.1813 and 16.1752 (internal, want
  // less): with q = 0 some mesh interferes at every distance.
  Design d = low_backlash();
  d.center_distance_given = true;
  for (double mm = 16.10; mm <= 16.30; mm += 0.002) {
    d.train.center_distance_m = mm * 1e-3;
    const Evaluation e = evaluated(d);
    EXPECT_TRUE(std::ranges::any_of(e.meshes, [](const MeshResult& m) {
      return m.normal_backlash_m < 0.0;
    })) << mm;
  }
}

TEST(Evaluation, LargerDistanceOpensTheExternalAndClosesTheInternalMeshes) {
  Design d = low_backlash();
  d.center_distance_given = true;
  d.train.center_distance_m = 16.18e-3;
  const Evaluation before = evaluated(d);
  d.train.center_distance_m += 20e-6;
  const Evaluation after = evaluated(d);
  EXPECT_GT(after.meshes[0].normal_backlash_m, before.meshes[0].normal_backlash_m);
  EXPECT_LT(after.meshes[1].normal_backlash_m, before.meshes[1].normal_backlash_m);
  EXPECT_LT(after.meshes[2].normal_backlash_m, before.meshes[2].normal_backlash_m);
}

TEST(Evaluation, DistanceInsideTheBaseCirclesIsNotDefinedWithMeshAndBound) {
  // Base radii of P2-R2 differ by 0.58 * 28 * cos 20 deg = 15.26 mm, those of the other meshes
  // make 14.97 mm.
  Design d = low_backlash();
  d.center_distance_given = true;
  d.train.center_distance_m = 15.1e-3;
  const auto result = evaluate(d);
  ASSERT_TRUE(std::holds_alternative<NotDefined>(result));
  const std::string message = std::get<NotDefined>(result).message;
  EXPECT_NE(message.find("P2-R2"), std::string::npos) << message;
  EXPECT_NE(message.find("15.1 mm"), std::string::npos) << message;
  EXPECT_NE(message.find("15.26"), std::string::npos) << message;
}

TEST(Evaluation, ShiftsWithoutAZeroBacklashDistanceAreNotDefinedWithTheKeyToState) {
  Design d = low_backlash();
  d.train.profile_shift[train::kP1] = 3.0;  // inv a_w = 0.0149 - 2 tan 20 deg 2.55/54 < 0
  const auto result = evaluate(d);
  ASSERT_TRUE(std::holds_alternative<NotDefined>(result));
  const std::string message = std::get<NotDefined>(result).message;
  EXPECT_NE(message.find("P1-R1"), std::string::npos) << message;
  EXPECT_NE(message.find("center_distance_mm"), std::string::npos) << message;
}

TEST(Evaluation, RingNotLargerThanItsPlanetIsNotDefinedWithTheMesh) {
  Design d = low_backlash();
  d.train.teeth.R2 = 36;
  d.center_distance_given = true;
  d.train.center_distance_m = 16.18e-3;
  const auto result = evaluate(d);
  ASSERT_TRUE(std::holds_alternative<NotDefined>(result));
  EXPECT_NE(std::get<NotDefined>(result).message.find("P2-R2"), std::string::npos);
}

TEST(Evaluation, BrokenPreconditionsAreRefused) {
  Design d = low_backlash();
  d.train.module_m[0] = -1e-3;
  EXPECT_THROW(evaluate(d), std::invalid_argument);
  d = low_backlash();
  d.train.teeth = {.S = 12, .P1 = 40, .R1 = 92, .P2 = 20, .R2 = 46};  // the output stands still
  EXPECT_THROW(evaluate(d), std::invalid_argument);
}

TEST(Evaluation, OutputTurnsBackwardsWhenG2ExceedsOne) {
  const Evaluation e = evaluated(reversed());
  EXPECT_GT(e.g2, 1.0);
  EXPECT_LT(e.ratio, 0.0);
  EXPECT_GT(e.efficiency.forward.value(), 0.0);
  EXPECT_LT(e.efficiency.forward.value(), 1.0);
  EXPECT_EQ(e.lost_motion.input_kinematic_rad, e.lost_motion.kinematic_rad * std::abs(e.ratio));
}

TEST(Evaluation, LockedTrainIsAResultWithItsMargin) {
  Design d = low_backlash();
  d.friction.coefficient = 1.0;
  const Evaluation e = evaluated(d);
  EXPECT_FALSE(e.efficiency.backdrivable);
  EXPECT_LT(e.efficiency.backdriving_margin, 0.0);
  EXPECT_LT(e.efficiency.backward.value(), 0.0);
  EXPECT_GT(e.efficiency.forward.value(), 0.0);
}

TEST(Evaluation, FrictionlessTrainIsLossless) {
  Design d = low_backlash();
  d.friction.coefficient = 0.0;
  const Evaluation e = evaluated(d);
  EXPECT_NEAR(e.efficiency.forward.value(), 1.0, 4.0 * kEps * e.ratio);
  EXPECT_NEAR(e.efficiency.backward.value(), 1.0, 4.0 * kEps * e.ratio);
  EXPECT_TRUE(e.efficiency.backdrivable);
  for (const MeshResult& m : e.meshes) EXPECT_EQ(m.efficiency_forward, 1.0);
}

TEST(Evaluation, ClosedFormOutsideItsRangeIsNotedMeshByMesh) {
  Design d = low_backlash();
  d.friction.model = LossModel::kOhlendorf;
  const Evaluation e = evaluated(d);
  for (const MeshResult& m : e.meshes) {
    const bool inside = m.approach_contact_ratio >= 0.0 && m.approach_contact_ratio <= 1.0 &&
                        m.recess_contact_ratio >= 0.0 && m.recess_contact_ratio <= 1.0;
    EXPECT_EQ(m.loss_model_in_range, inside) << m.name;
    EXPECT_EQ(has_note(e.notes, "outside its range at mesh " + m.name), !inside) << m.name;
  }
  EXPECT_FALSE(e.meshes[1].loss_model_in_range);
  d.friction.model = LossModel::kSliding;
  EXPECT_FALSE(has_note(evaluated(d).notes, "outside its range"));
}

TEST(Evaluation, ApproachAndRecessAddUpToTheContactRatio) {
  for (const Design& d : {low_backlash(), bilateral(), reversed()}) {
    for (const MeshResult& m : evaluated(d).meshes) {
      EXPECT_NEAR(m.approach_contact_ratio + m.recess_contact_ratio, m.contact_ratio, 4.0 * kEps);
    }
  }
}

TEST(Evaluation, GearsAndMeshesAreNamedAndInTheirOrder) {
  const Evaluation e = evaluated(bilateral());
  ASSERT_EQ(e.gears.size(), 5U);
  ASSERT_EQ(e.meshes.size(), 3U);
  const std::array<int, 5> teeth{12, 39, 90, 32, 81};
  const std::array<double, 5> module{0.8e-3, 0.8e-3, 0.8e-3, 0.8467e-3, 0.8467e-3};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(e.gears[i].name, train::kGearNames[i]);
    EXPECT_EQ(e.gears[i].teeth, teeth[i]);
    const double pitch = teeth[i] * module[i];
    EXPECT_NEAR(e.gears[i].pitch_diameter_m, pitch, 4.0 * kEps * pitch);
    EXPECT_NEAR(e.gears[i].base_diameter_m, pitch * std::cos(kPi / 9.0), 4.0 * kEps * pitch);
  }
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(e.meshes[k].name, train::kMeshNames[k]);
}

TEST(Evaluation, ChecksAreOkExactlyWithinToleranceOfTheirLimits) {
  for (Design d : {low_backlash(), bilateral(), reversed()}) {
    for (auto& limit : d.limits.limit) limit = limit.value_or(0.0);
    const Evaluation e = evaluated(d);
    const auto instances = list_checks(
        d.limits,
        train_layout({.planets = d.train.planets, .stage1_module_m = d.train.module_m[0]}));
    ASSERT_EQ(e.checks.size(), instances.size());
    for (std::size_t i = 0; i < e.checks.size(); ++i) {
      const CheckResult& c = e.checks[i];
      EXPECT_EQ(c.record, instances[i].record);
      EXPECT_EQ(c.margin, c.record->at_least ? c.value - c.limit : c.limit - c.value);
      EXPECT_EQ(c.ok, c.margin >= -kFeasibilityTolerance * instances[i].scale) << c.record->name;
    }
  }
}

TEST(Evaluation, PublishedAssemblyIsChecked) {
  const Evaluation proposed = evaluated(low_backlash());
  EXPECT_TRUE(find_check(proposed.checks, CheckId::kEqualSpacing).ok);
  EXPECT_FALSE(find_check(proposed.checks, CheckId::kIdenticalPlanets).ok);
  const Evaluation other = evaluated(bilateral());
  EXPECT_TRUE(find_check(other.checks, CheckId::kEqualSpacing).ok);
  EXPECT_TRUE(find_check(other.checks, CheckId::kIdenticalPlanets).ok);
}

TEST(Evaluation, SizeChangesLengthsAndInertiasButNoAnglesRatiosOrEfficiencies) {
  std::mt19937_64 generator(13);
  std::uniform_real_distribution<double> shift(0.0, 0.6), scale(0.3, 3.0);
  for (int i = 0; i < 200; ++i) {
    Design d = i % 2 == 0 ? low_backlash() : reversed();
    for (double& x : d.train.profile_shift) x = shift(generator);
    d.masses.density_kgm3 = 7800.0;
    d.masses.face_width_m = {8e-3, 9e-3};
    d.masses.ring2_outer_radius_m = 35e-3;
    d.masses.carrier_kgm2 = 1e-5;
    const double s = scale(generator);
    Design large = d;
    for (double& m : large.train.module_m) m *= s;
    large.masses.face_width_m = {8e-3 * s, 9e-3 * s};
    large.masses.ring2_outer_radius_m = 35e-3 * s;
    large.masses.carrier_kgm2 = 1e-5 * std::pow(s, 5);
    const auto first = evaluate(d);
    const auto second = evaluate(large);
    ASSERT_EQ(first.index(), second.index());
    if (!std::holds_alternative<Evaluation>(first)) continue;
    const auto& a = std::get<Evaluation>(first);
    const auto& b = std::get<Evaluation>(second);
    constexpr double kRounding = 1e-11;  // of the backlash, a small difference of lengths
    EXPECT_NEAR(b.efficiency.forward.value(), a.efficiency.forward.value(), kRounding);
    EXPECT_NEAR(b.efficiency.backward.value(), a.efficiency.backward.value(), kRounding);
    EXPECT_NEAR(b.lost_motion.kinematic_rad, a.lost_motion.kinematic_rad, kRounding);
    EXPECT_NEAR(b.center_distance_m, a.center_distance_m * s, kRounding);
    ASSERT_TRUE(a.inertia && b.inertia);
    EXPECT_NEAR(b.inertia->lossless_kgm2 / a.inertia->lossless_kgm2 / std::pow(s, 5), 1.0,
                kRounding);
    ASSERT_EQ(a.inertia->backward_kgm2.has_value(), b.inertia->backward_kgm2.has_value());
    if (a.inertia->backward_kgm2) {
      EXPECT_NEAR(*b.inertia->backward_kgm2 / *a.inertia->backward_kgm2 / std::pow(s, 5), 1.0,
                  kRounding);
    }
  }
}

TEST(Evaluation, WithoutMassesNamesTheMissingInertiaKeys) {
  const Evaluation e = evaluated(low_backlash());
  EXPECT_FALSE(e.inertia);
  for (const char* key : {"S_kgm2", "P1_kgm2", "P2_kgm2", "R2_kgm2", "planet_mass_kg"}) {
    EXPECT_NE(e.inertia_missing.find(key), std::string::npos) << key << ": " << e.inertia_missing;
  }
  Design d = low_backlash();
  d.masses.sun_kgm2 = 1e-6;
  const std::string missing = evaluated(d).inertia_missing;
  EXPECT_EQ(missing.find("inertia.S_kgm2"), std::string::npos) << missing;
  EXPECT_NE(missing.find("inertia.R2_kgm2"), std::string::npos) << missing;
}

TEST(Evaluation, GivenInertiasTakePrecedenceOverTheGeometry) {
  Design d = low_backlash();
  d.masses.density_kgm3 = 7800.0;
  d.masses.face_width_m = {8e-3, 9e-3};
  d.masses.ring2_outer_radius_m = 35e-3;
  const Evaluation geometric = evaluated(d);
  ASSERT_TRUE(geometric.inertia);
  EXPECT_TRUE(has_note(geometric.notes, "carrier"));
  d.masses.carrier_kgm2 = 0.0;
  d.masses.sun_kgm2 = 1e-3;  // dominates: i^2 1e-3
  const Evaluation given = evaluated(d);
  ASSERT_TRUE(given.inertia);
  EXPECT_FALSE(has_note(given.notes, "carrier"));
  EXPECT_NEAR(given.inertia->lossless_kgm2 / (given.ratio * given.ratio * 1e-3), 1.0, 0.05);
}

TEST(Evaluation, InertiaIsHeavierThanLosslessInBothDirections) {
  Design d = low_backlash();
  d.masses.density_kgm3 = 7800.0;
  d.masses.face_width_m = {8e-3, 9e-3};
  d.masses.ring2_outer_radius_m = 35e-3;
  d.masses.carrier_kgm2 = 1e-5;
  const Evaluation e = evaluated(d);
  ASSERT_TRUE(e.inertia && e.inertia->backward_kgm2 && e.inertia->forward_kgm2);
  EXPECT_GT(*e.inertia->backward_kgm2, e.inertia->lossless_kgm2);
  EXPECT_GT(*e.inertia->forward_kgm2 * e.ratio * e.ratio, e.inertia->lossless_kgm2);
}

TEST(Evaluation, LockedTrainHasNoBackwardInertia) {
  Design d = low_backlash();
  d.friction.coefficient = 1.0;
  d.masses.density_kgm3 = 7800.0;
  d.masses.face_width_m = {8e-3, 9e-3};
  d.masses.ring2_outer_radius_m = 35e-3;
  d.masses.sun_kgm2 = 1e-3;
  const Evaluation e = evaluated(d);
  ASSERT_FALSE(e.efficiency.backdrivable);
  ASSERT_TRUE(e.inertia);
  EXPECT_GT(e.inertia->lossless_kgm2, 0.0);
  EXPECT_FALSE(e.inertia->backward_kgm2);
}

PairDesign pair_of(int z1, int z2, GearKind second) {
  PairDesign p;
  p.pressure_angle_rad = 20.0 * kPi / 180.0;
  p.gear1 = {.teeth = z1,
             .kind = GearKind::kExternal,
             .module_m = 1e-3,
             .profile_shift = 0.0,
             .machining_allowance = 0.0,
             .tip_shortening = 0.0,
             .rack = {}};
  p.gear2 = p.gear1;
  p.gear2.teeth = z2;
  p.gear2.kind = second;
  return p;
}

// A Y_M is said to be of no use where no safety changes with it.
TEST(Evaluation, AStatedReversalFactorIsSaidWhereNoSafetyReadsIt) {
  int said = 0, used = 0;
  for (const bool above_one : {false, true}) {
    for (const bool of_planet : {false, true}) {
      for (const int reversing : {-1, static_cast<int>(train::kP1), static_cast<int>(train::kR2)}) {
        Design d = above_one ? reversed() : low_backlash();
        d.rating.emplace();
        d.rating->material.fill(strength::steel_700_290());
        d.rating->torque_Nm = 1.0;
        d.rating->face_width_m = {8e-3, 8e-3};
        d.rating->teeth.load_reversal = false;
        if (reversing >= 0) {
          d.rating->gear_teeth[static_cast<std::size_t>(reversing)].load_reversal = true;
        }
        const auto safeties = [](const Evaluation& e) {
          std::vector<double> all;
          for (const auto& mesh : e.strength.value().forward.mesh) {
            for (const auto& tooth : mesh.teeth) all.push_back(tooth.root_safety);
          }
          return all;
        };
        const Evaluation unstated = evaluated(d);
        EXPECT_FALSE(has_note(unstated.notes, "Y_M"));
        (of_planet ? d.rating->gear_teeth[train::kP1] : d.rating->teeth).reversal = 0.9;
        const Evaluation stated = evaluated(d);
        const bool no_use = safeties(stated) == safeties(unstated);
        EXPECT_EQ(has_note(stated.notes, of_planet ? "Y_M of P1 is" : "Y_M of all gears"), no_use)
            << above_one << of_planet << reversing;
        ++(no_use ? said : used);
      }
    }
  }
  EXPECT_GE(said, 3);
  EXPECT_GE(used, 3);
}

// S_F falls as 1/T and S_H as its root: the capacity follows from any rating and the least
// safeties.
TEST(Evaluation, ALeastSafetyOfOneGearIsThatOfItsChecksAndOfTheCapacity) {
  Design d = low_backlash();
  d.rating.emplace();
  d.rating->material.fill(strength::steel_700_290());
  d.rating->torque_Nm = 1.0;
  d.rating->face_width_m = {8e-3, 8e-3};
  d.rating->teeth.root_safety_min = 1.5;
  d.rating->teeth.flank_safety_min = 1.2;
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    for (const auto& [root, flank] : {std::pair(6.0, 1.2), std::pair(1.5, 4.0)}) {
      d.rating->gear_teeth.fill({});
      d.rating->gear_teeth[gear].root_safety_min = root;
      d.rating->gear_teeth[gear].flank_safety_min = flank;
      const Evaluation e = evaluated(d);
      double capacity = std::numeric_limits<double>::infinity();
      for (const auto* rating : {&e.strength->forward, &e.strength->backward}) {
        for (std::size_t k = 0; k < train::kMeshCount; ++k) {
          for (std::size_t i = 0; i < 2; ++i) {
            const bool own = static_cast<std::size_t>(train::kMeshGears[k][i]) == gear;
            const auto& tooth = rating->mesh[k].teeth[i];
            const double flank_ratio = tooth.flank_safety / (own ? flank : 1.2);
            capacity = std::min(
                {capacity, tooth.root_safety / (own ? root : 1.5), flank_ratio * flank_ratio});
          }
        }
      }
      EXPECT_NEAR(e.strength->least_capacity()->capacity.torque_Nm, capacity, 1e-9 * capacity)
          << gear;
      int of_gear = 0;
      for (const CheckResult& check : e.checks) {
        const bool of_root = check.record->id == CheckId::kRootSafety;
        if (!of_root && check.record->id != CheckId::kFlankSafety) continue;
        const bool own = check.gear == train::kGearNames[gear];
        EXPECT_EQ(check.limit, of_root ? (own ? root : 1.5) : (own ? flank : 1.2));
        of_gear += own ? 1 : 0;
      }
      EXPECT_GE(of_gear, 2);
    }
  }
}

TEST(PairEvaluation, OfStandardGearsIsAtTheReferenceDistanceWithoutBacklash) {
  const auto e = std::get<PairEvaluation>(evaluate(pair_of(20, 41, GearKind::kExternal)));
  EXPECT_NEAR(e.center_distance_m, 30.5e-3, 1e-14 * 30.5e-3 * 4.0);
  EXPECT_NEAR(e.mesh.normal_backlash_m, 0.0, 1e-14 * 30.5e-3 * 4.0);
  EXPECT_FALSE(e.center_distance_given);
  EXPECT_EQ(e.mesh.hunting_period_teeth, 820);
  ASSERT_EQ(e.gears.size(), 2U);
  EXPECT_EQ(e.gears[0].teeth, 20);
  EXPECT_EQ(e.gears[1].teeth, 41);
  EXPECT_TRUE(has_note(e.notes, "center_distance_mm"));
}

TEST(PairEvaluation, Of20In60FailsInvoluteInterference) {
  PairDesign p = pair_of(20, 60, GearKind::kRing);
  const auto e = std::get<PairEvaluation>(evaluate(p));
  const CheckResult& c = find_check(e.checks, CheckId::kInvoluteInterference, "1-2", "2");
  EXPECT_LT(c.margin, 0.0);
  EXPECT_FALSE(c.ok);
  EXPECT_FALSE(all_ok(e.checks));
  p.gear1.teeth = 21;
  const auto next = std::get<PairEvaluation>(evaluate(p));
  EXPECT_TRUE(find_check(next.checks, CheckId::kInvoluteInterference, "1-2", "2").ok);
}

TEST(PairEvaluation, GivenDistanceIsKept) {
  PairDesign p = pair_of(20, 40, GearKind::kExternal);
  p.center_distance_m = 30.1e-3;
  const auto e = std::get<PairEvaluation>(evaluate(p));
  EXPECT_EQ(e.center_distance_m, 30.1e-3);
  EXPECT_TRUE(e.center_distance_given);
  EXPECT_GT(e.mesh.normal_backlash_m, 0.0);
  EXPECT_TRUE(e.notes.empty());
}

TEST(PairEvaluation, WithoutAWorkingAngleIsNotDefinedAndNamesTheBound) {
  PairDesign p = pair_of(20, 40, GearKind::kExternal);
  p.center_distance_m = 28e-3;  // base radii add to 30 cos 20 deg = 28.19 mm
  const auto result = evaluate(p);
  ASSERT_TRUE(std::holds_alternative<NotDefined>(result));
  const std::string message = std::get<NotDefined>(result).message;
  EXPECT_NE(message.find("1-2"), std::string::npos) << message;
  EXPECT_NE(message.find("28.19"), std::string::npos) << message;
}

TEST(PairEvaluation, OfARingNotLargerThanItsMateIsNotDefined) {
  for (const int teeth : {20, 30}) {
    const auto result = evaluate(pair_of(30, teeth, GearKind::kRing));
    ASSERT_TRUE(std::holds_alternative<NotDefined>(result));
    EXPECT_NE(std::get<NotDefined>(result).message.find("ring"), std::string::npos);
  }
}

TEST(Evaluation, EfficiencyIsUndefinedWhereAMeshHasNoContact) {
  Design d = bilateral();
  d.center_distance_given = true;
  d.train.center_distance_m = 40e-3;  // twice the distance at which the teeth reach each other
  const auto result = evaluate(d);
  const Evaluation& e = std::get<Evaluation>(result);
  ASSERT_LT(e.meshes[0].contact_ratio, 0.0);
  EXPECT_FALSE(e.efficiency.forward.has_value());
  EXPECT_FALSE(e.efficiency.backward.has_value());
  EXPECT_FALSE(e.efficiency.backdrivable);
  EXPECT_FALSE(e.meshes[0].loss_model_in_range);
  EXPECT_TRUE(std::isnan(e.meshes[0].efficiency_forward));
  EXPECT_TRUE(std::isnan(e.meshes[0].efficiency_backward));
  EXPECT_FALSE(e.notes.empty());
}

// 20 teeth with x = 1.6: the flanks cross before the tip circle.
TEST(PairEvaluation, SaysThatTeethArePointedBelowTheirTips) {
  PairDesign p = pair_of(20, 40, GearKind::kExternal);
  const auto pointed = [](const PairEvaluation& e) {
    return std::ranges::count_if(e.notes, [](const std::string& note) {
      return note.find("before the tip circle") != std::string::npos;
    });
  };
  EXPECT_EQ(pointed(std::get<PairEvaluation>(evaluate(p))), 0);
  p.gear1.profile_shift = 1.6;
  const auto e = std::get<PairEvaluation>(evaluate(p));
  ASSERT_LT(e.gears[0].tip_thickness_m, 0.0);
  EXPECT_EQ(pointed(e), 1);
}

TEST(Evaluation, SaysWhereMatesHaveLessInCommonThanTheFaceWidth) {
  Design d = bilateral();
  d.masses.face_width_m = {8e-3, 8e-3};
  d.axial.extent[train::kS] = train::AxialInterval{.from_m = 0.0, .to_m = 8e-3};
  d.axial.extent[train::kP1] = train::AxialInterval{.from_m = 6e-3, .to_m = 14e-3};
  const auto result = evaluate(d);
  const auto& notes = std::get<Evaluation>(result).notes;
  EXPECT_EQ(std::ranges::count_if(notes,
                                  [](const std::string& note) {
                                    return note.find("S and P1 have 2 mm in common") == 0;
                                  }),
            1);
}

}  // namespace
}  // namespace gear3k::design::evaluation_test
