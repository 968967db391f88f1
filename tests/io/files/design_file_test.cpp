#include "io/files/design_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/text/diagnostics.hpp"

namespace gear3k::io::design_file_test {
namespace {

using design::CheckId, design::Design;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kArcmin = kDegree / 60.0;

const std::string kBilateral =
    "planets = 3\n"
    "[stage1]\nmodule_mm = 0.8\n"
    "[stage2]\nmodule_mm = 0.8467\n"
    "[gears]\n"
    "S = { teeth = 12, profile_shift = 0.476 }\n"
    "P1 = { teeth = 39, profile_shift = 0.762 }\n"
    "R1 = { teeth = 90, profile_shift = 2.0 }\n"
    "P2 = { teeth = 32, profile_shift = 0.536 }\n"
    "R2 = { teeth = 81, profile_shift = 1.21 }\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::invalid_argument("no \"" + from + "\" in the text");
  return text.replace(at, from.size(), to);
}

Design parse(const std::string& text) { return parse_design(text, "gear.toml"); }

std::string errors_of(const std::string& text) {
  try {
    static_cast<void>(parse(text));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// One unit in the last place: a length in SI that is no decimal in mm.
void expect_ulp(double a, double b, const std::string& what) {
  EXPECT_LE(std::nextafter(a, -INFINITY), b) << what;
  EXPECT_GE(std::nextafter(a, INFINITY), b) << what;
}

void expect_ulp(const std::optional<double>& a, const std::optional<double>& b,
                const std::string& what) {
  ASSERT_EQ(a.has_value(), b.has_value()) << what;
  if (a) expect_ulp(*a, *b, what);
}

void expect_same_masses(const design::Masses& a, const design::Masses& b) {
  expect_ulp(a.sun_kgm2, b.sun_kgm2, "S");
  expect_ulp(a.planet1_kgm2, b.planet1_kgm2, "P1");
  expect_ulp(a.planet2_kgm2, b.planet2_kgm2, "P2");
  expect_ulp(a.planet_mass_kg, b.planet_mass_kg, "planet mass");
  expect_ulp(a.carrier_kgm2, b.carrier_kgm2, "carrier");
  expect_ulp(a.ring2_kgm2, b.ring2_kgm2, "R2");
  expect_ulp(a.density_kgm3, b.density_kgm3, "density");
  for (std::size_t stage = 0; stage < 2; ++stage) {
    expect_ulp(a.face_width_m[stage], b.face_width_m[stage], "face width");
  }
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    expect_ulp(a.bore_radius_m[i], b.bore_radius_m[i], "bore");
  }
  expect_ulp(a.ring2_outer_radius_m, b.ring2_outer_radius_m, "outer radius");
}

void expect_same_limits(const design::Limits& a, const design::Limits& b) {
  EXPECT_EQ(a.model, b.model);
  for (const design::CheckRecord& record : design::check_records()) {
    expect_ulp(a[record.id], b[record.id], std::string(record.name));
  }
}

/// Everything but masses.
void expect_same_design(const Design& a, const Design& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.train.planets, b.train.planets);
  EXPECT_EQ(train::teeth_of(a.train.teeth), train::teeth_of(b.train.teeth));
  expect_ulp(a.train.pressure_angle_rad, b.train.pressure_angle_rad, "pressure angle");
  EXPECT_EQ(a.center_distance_given, b.center_distance_given);
  if (a.center_distance_given) {
    expect_ulp(a.train.center_distance_m, b.train.center_distance_m, "centre distance");
  }
  for (std::size_t stage = 0; stage < 2; ++stage) {
    expect_ulp(a.train.module_m[stage], b.train.module_m[stage], "module");
  }
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    EXPECT_EQ(a.train.profile_shift[i], b.train.profile_shift[i]);
    EXPECT_EQ(a.train.machining_allowance[i], b.train.machining_allowance[i]);
    EXPECT_EQ(a.train.tip_shortening[i], b.train.tip_shortening[i]);
    EXPECT_EQ(a.train.rack[i].addendum, b.train.rack[i].addendum);
    EXPECT_EQ(a.train.rack[i].dedendum, b.train.rack[i].dedendum);
    EXPECT_EQ(a.train.rack[i].root_radius, b.train.rack[i].root_radius);
    EXPECT_EQ(a.train.khk_tip[i], b.train.khk_tip[i]);
    EXPECT_EQ(a.train.cutter[i].teeth, b.train.cutter[i].teeth);
    EXPECT_EQ(a.train.cutter[i].profile_shift, b.train.cutter[i].profile_shift);
    EXPECT_EQ(a.train.cutter[i].tip_radius, b.train.cutter[i].tip_radius);
    expect_ulp(a.pin_diameter_m[i], b.pin_diameter_m[i], "pin diameter");
  }
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    ASSERT_EQ(a.axial.extent[i].has_value(), b.axial.extent[i].has_value());
    if (!a.axial.extent[i]) continue;
    expect_ulp(a.axial.extent[i]->from_m, b.axial.extent[i]->from_m, "axial from");
    expect_ulp(a.axial.extent[i]->to_m, b.axial.extent[i]->to_m, "axial to");
  }
  expect_ulp(a.axial.carrier_radius_m, b.axial.carrier_radius_m, "carrier radius");
  EXPECT_EQ(a.friction.coefficient, b.friction.coefficient);
  EXPECT_EQ(a.friction.model, b.friction.model);
  expect_same_limits(a.limits, b.limits);
}

void expect_round_trip(const Design& design) {
  const std::string text = design_text(design);
  SCOPED_TRACE(text);
  expect_same_design(design, parse_design(text, "best.toml"));
}

// --- reading

TEST(ReadDesign, ConvertsUnitsOnce) {
  const Design d = parse(
      "name = \"a gear\"\npressure_angle_deg = 25.0\ncenter_distance_mm = 21.5\n" +
      replaced(replaced(kBilateral, "module_mm = 0.8\n", "module_mm = 0.8\nface_width_mm = 9.0\n"),
               "teeth = 12,", "teeth = 12, bore_mm = 3.0,") +
      "[friction]\ncoefficient = 0.07\nloss_model = \"ohlendorf\"\n"
      "[inertia]\ndensity_kg_m3 = 7850.0\nplanet_mass_kg = 0.08\nR2_kgm2 = 9e-4\n");
  EXPECT_EQ(d.name, "a gear");
  EXPECT_EQ(d.train.planets, 3);
  EXPECT_EQ(train::teeth_of(d.train.teeth), (std::array<int, 5>{12, 39, 90, 32, 81}));
  EXPECT_DOUBLE_EQ(d.train.pressure_angle_rad, 25.0 * kDegree);
  EXPECT_TRUE(d.center_distance_given);
  EXPECT_DOUBLE_EQ(d.train.center_distance_m, 0.0215);
  EXPECT_DOUBLE_EQ(d.train.module_m[0], 0.0008);
  EXPECT_DOUBLE_EQ(d.train.module_m[1], 0.0008467);
  EXPECT_EQ(d.train.profile_shift, (std::array<double, 5>{0.476, 0.762, 2.0, 0.536, 1.21}));
  EXPECT_EQ(d.friction.coefficient, 0.07);
  EXPECT_EQ(d.friction.model, efficiency::LossModel::kOhlendorf);
  ASSERT_TRUE(d.masses.face_width_m[0]);
  EXPECT_DOUBLE_EQ(*d.masses.face_width_m[0], 0.009);
  EXPECT_FALSE(d.masses.face_width_m[1]);
  EXPECT_DOUBLE_EQ(d.masses.bore_radius_m[0], 0.0015);
  EXPECT_EQ(d.masses.density_kgm3, 7850.0);
  EXPECT_EQ(d.masses.planet_mass_kg, 0.08);
  EXPECT_EQ(d.masses.ring2_kgm2, 9e-4);
  EXPECT_FALSE(d.masses.carrier_kgm2);
}

TEST(ReadDesign, DefaultsAreTheStandardRackTwentyDegreesAndFullTeeth) {
  const Design d = parse(
      "stage1.module_mm = 1\nstage2.module_mm = 1\ngears.S.teeth = 12\ngears.P1.teeth = 39\n"
      "gears.R1.teeth = 90\ngears.P2.teeth = 32\ngears.R2.teeth = 81\n");
  EXPECT_EQ(d.name, "");
  EXPECT_EQ(d.train.planets, 3);
  EXPECT_DOUBLE_EQ(d.train.pressure_angle_rad, 20.0 * kDegree);
  EXPECT_FALSE(d.center_distance_given);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    EXPECT_EQ(d.train.rack[i].addendum, 1.0);
    EXPECT_EQ(d.train.rack[i].dedendum, 1.25);
    EXPECT_EQ(d.train.rack[i].root_radius, 0.38);
    EXPECT_EQ(d.train.profile_shift[i], 0.0);
    EXPECT_EQ(d.train.machining_allowance[i], 0.0);
    EXPECT_EQ(d.train.tip_shortening[i], 0.0);
  }
  EXPECT_EQ(d.friction.coefficient, 0.1);
  EXPECT_EQ(d.friction.model, efficiency::LossModel::kSliding);
  expect_same_limits(d.limits, design::default_limits());
}

TEST(ReadDesign, IsoSignsDescribeTheSameGearbox) {
  std::string iso = "sign_convention = \"iso21771\"\n" + kBilateral;
  iso = replaced(iso, "teeth = 90, profile_shift = 2.0", "teeth = -90, profile_shift = -2.0");
  iso = replaced(iso, "teeth = 81, profile_shift = 1.21", "teeth = -81, profile_shift = -1.21");
  expect_same_design(parse(iso), parse(kBilateral));
  expect_same_design(parse("sign_convention = \"khk\"\n" + kBilateral), parse(kBilateral));
}

TEST(ReadDesign, NormalThinningIsTheAllowanceTimesTheModule) {
  // 16 um at module 0.8, and 0.02 of 0.8467 in the second stage.
  const Design length =
      parse(replaced(replaced(kBilateral, "teeth = 90,", "teeth = 90, normal_thinning_um = 16.0,"),
                     "teeth = 32,", "teeth = 32, normal_thinning_um = 16.934,"));
  const Design relative =
      parse(replaced(replaced(kBilateral, "teeth = 90,", "teeth = 90, machining_allowance = 0.02,"),
                     "teeth = 32,", "teeth = 32, machining_allowance = 0.02,"));
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    EXPECT_DOUBLE_EQ(length.train.machining_allowance[i], relative.train.machining_allowance[i]);
  }
  EXPECT_EQ(relative.train.machining_allowance[train::kR1], 0.02);
}

TEST(ReadDesign, NormalThinningOfZeroCountsAsStated) {
  const std::string errors =
      errors_of(replaced(kBilateral, "teeth = 12,",
                         "teeth = 12, normal_thinning_um = 0.0, machining_allowance = 0.0,"));
  EXPECT_NE(errors.find("gears.S.normal_thinning_um"), std::string::npos) << errors;
}

TEST(ReadDesign, RackHoldsForAllGears) {
  const Design d =
      parse(kBilateral + "[rack]\naddendum = 0.8\ndedendum = 1.0\nroot_radius = 0.2\n");
  for (const auto& rack : d.train.rack) {
    EXPECT_EQ(rack.addendum, 0.8);
    EXPECT_EQ(rack.dedendum, 1.0);
    EXPECT_EQ(rack.root_radius, 0.2);
  }
}

TEST(ReadDesign, ExamplesAreSound) {
  for (const char* name : {"low_backlash_prototype.toml", "bilateral_drive_gear.toml"}) {
    EXPECT_NO_THROW(static_cast<void>(
        read_design(std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/" + name)))
        << name;
  }
}

TEST(ReadDesign, ReportsErrorsOfTypeRangeAndRelationTogether) {
  const std::string errors =
      errors_of("planets = 0\ncolour = \"red\"\n" +
                replaced(replaced(kBilateral, "planets = 3\n", ""), "teeth = 81", "teeth = 32"));
  for (const char* fragment : {"gear.toml:1:1: planets = 0", "gear.toml:2:1: unknown key colour",
                               "gears.R2.teeth: 32 teeth, allowed: more than the 32 of gears.P2"}) {
    EXPECT_NE(errors.find(fragment), std::string::npos) << errors;
  }
}

// --- limits

std::optional<double> limit_of(const std::string& more, CheckId id) {
  return parse(kBilateral + more).limits[id];
}

TEST(DesignLimits, AreConvertedToSi) {
  const std::string stated =
      "[backlash]\nmin_output_arcmin = 1.5\nmax_output_arcmin = 8.0\nmin_normal_um = 12.0\n"
      "[size]\nmax_ring_root_diameter_mm = 76.0\n[contact_ratio]\nrange = [1.2, 2.0]\n";
  EXPECT_DOUBLE_EQ(*limit_of(stated, CheckId::kOutputBacklashMin), 1.5 * kArcmin);
  EXPECT_DOUBLE_EQ(*limit_of(stated, CheckId::kOutputBacklashMax), 8.0 * kArcmin);
  EXPECT_DOUBLE_EQ(*limit_of(stated, CheckId::kNormalBacklash), 12e-6);
  EXPECT_DOUBLE_EQ(*limit_of(stated, CheckId::kRingRootDiameter), 0.076);
  EXPECT_EQ(limit_of(stated, CheckId::kContactRatioMin), 1.2);
  EXPECT_EQ(limit_of(stated, CheckId::kContactRatioMax), 2.0);
}

TEST(DesignLimits, NumberSetsTheThreshold) {
  EXPECT_EQ(limit_of("[limits]\ntip_thickness = 0.3\n", CheckId::kTipThickness), 0.3);
  EXPECT_EQ(limit_of("[limits]\ntip_thickness = 0\n", CheckId::kTipThickness), 0.0);
  EXPECT_EQ(limit_of("[limits]\nundercut = -0.1\n", CheckId::kUndercut), -0.1);
}

TEST(DesignLimits, TrueKeepsTheDefaultAndFalseSwitchesOff) {
  EXPECT_EQ(limit_of("[limits]\ntip_thickness = true\n", CheckId::kTipThickness),
            design::default_limits()[CheckId::kTipThickness]);
  EXPECT_EQ(limit_of("[limits]\ntip_thickness = false\n", CheckId::kTipThickness), std::nullopt);
}

TEST(DesignLimits, FalseWinsOverAThresholdStatedElsewhere) {
  const std::string threshold = "[backlash]\nmax_output_arcmin = 8.0\nmin_normal_um = 5.0\n";
  EXPECT_EQ(
      limit_of(threshold + "[limits]\noutput_backlash_max = false\n", CheckId::kOutputBacklashMax),
      std::nullopt);
  EXPECT_EQ(limit_of(threshold + "[limits]\nnormal_backlash = false\n", CheckId::kNormalBacklash),
            std::nullopt);
  EXPECT_EQ(
      limit_of("[limits]\noutput_backlash_max = false\n" + threshold, CheckId::kOutputBacklashMax),
      std::nullopt)
      << "whichever comes first";
}

TEST(DesignLimits, TrueWithAThresholdKeepsIt) {
  EXPECT_DOUBLE_EQ(
      *limit_of("[backlash]\nmax_output_arcmin = 8.0\n[limits]\noutput_backlash_max = true\n",
                CheckId::kOutputBacklashMax),
      8.0 * kArcmin);
}

TEST(DesignLimits, TrueWithoutAnyThresholdIsAnErrorThatNamesItsKey) {
  std::size_t without_default = 0;
  for (const design::CheckRecord& record : design::check_records()) {
    if (record.default_limit || record.switched_limit) continue;
    ++without_default;
    const std::string name(record.name);
    const std::string errors = errors_of(kBilateral + "[limits]\n" + name + " = true\n");
    EXPECT_NE(errors.find("limits." + name + " = true"), std::string::npos) << errors;
    EXPECT_NE(errors.find(record.limit_key), std::string::npos) << errors;
  }
  EXPECT_EQ(without_default, 17U);
}

TEST(DesignLimits, IdenticalPlanetsHaveASwitchOfTheirOwn) {
  EXPECT_TRUE(parse("identical_planets = true\n" + kBilateral).limits[CheckId::kIdenticalPlanets]);
  EXPECT_FALSE(
      parse("identical_planets = false\n" + kBilateral).limits[CheckId::kIdenticalPlanets]);
  EXPECT_TRUE(parse(kBilateral).limits[CheckId::kIdenticalPlanets]);
}

TEST(DesignLimits, EveryCheckCanBeSwitchedOff) {
  for (const design::CheckRecord& record : design::check_records()) {
    if (record.id == CheckId::kIdenticalPlanets) continue;
    const std::string name(record.name);
    EXPECT_EQ(limit_of("[limits]\n" + name + " = false\n", record.id), std::nullopt) << name;
  }
}

TEST(DesignLimits, BacklashModelIsPartOfThem) {
  EXPECT_EQ(parse(kBilateral).limits.model, backlash::LostMotionModel::kKinematic);
  EXPECT_EQ(parse(kBilateral + "[backlash]\nmodel = \"paper\"\n").limits.model,
            backlash::LostMotionModel::kPaper);
}

// --- writing

TEST(DesignText, RoundTripsRandomDesigns) {
  std::mt19937_64 random(20240717);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto integer = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  for (int k = 0; k < 300 && !HasFailure(); ++k) {
    Design d = parse(kBilateral);
    d.name = "design " + std::to_string(k);
    d.train.planets = integer(1, 8);
    d.train.teeth = {
        .S = integer(8, 30), .P1 = integer(15, 60), .R1 = 0, .P2 = integer(15, 60), .R2 = 0};
    d.train.teeth.R1 = d.train.teeth.P1 + integer(9, 80);
    d.train.teeth.R2 = d.train.teeth.P2 + integer(9, 80);
    if (d.train.teeth.P1 * d.train.teeth.R2 == d.train.teeth.P2 * d.train.teeth.R1) continue;
    d.train.pressure_angle_rad = uniform(14.0, 30.0) * kDegree;
    d.center_distance_given = true;
    d.train.module_m = {uniform(1e-4, 5e-3), uniform(1e-4, 5e-3)};
    // Above the reference distance of every mesh, hence with a real working angle.
    const auto& z = d.train.teeth;
    const double reference = 0.5 * std::max(d.train.module_m[0] * std::max(z.S + z.P1, z.R1 - z.P1),
                                            d.train.module_m[1] * (z.R2 - z.P2));
    d.train.center_distance_m = reference * uniform(1.0, 1.2);
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      d.train.profile_shift[i] = uniform(-0.5, 1.5);
      d.train.machining_allowance[i] = uniform(0.0, 0.2);
      d.train.tip_shortening[i] = uniform(0.0, 0.3);
    }
    d.train.rack.fill({.addendum = uniform(0.8, 1.2),
                       .dedendum = uniform(1.1, 1.3),
                       .root_radius = uniform(0.0, 0.4)});
    for (const std::size_t i : {train::kS, train::kP1}) {
      if (integer(0, 2) > 0) continue;
      d.train.khk_tip[i] = true;
      d.train.tip_shortening[i] = 0.0;
    }
    for (const std::size_t i : {train::kR1, train::kR2}) {
      if (integer(0, 1) > 0) continue;
      d.train.cutter[i] = {.teeth = integer(6, 20),
                           .profile_shift = uniform(-0.3, 0.5),
                           .tip_radius = uniform(0.0, 0.3)};
    }
    d.pin_diameter_m[static_cast<std::size_t>(integer(0, 4))] = uniform(5e-4, 5e-3);
    // Mates about one plane, the planet's toothings and the rings side by side.
    const std::array<double, 2> plane{uniform(-0.02, 0.0), uniform(0.01, 0.02)};
    for (int i = 0; i < train::kBodyCount; ++i) {
      const bool beside = i != train::kS && i != train::kCarrier;
      const double most = beside ? 0.005 : 0.02;
      const double middle = plane[i == train::kP2 || i == train::kR2 ? 1 : 0];
      d.axial.extent[static_cast<std::size_t>(i)] = train::AxialInterval{
          .from_m = middle - uniform(1e-3, most), .to_m = middle + uniform(1e-3, most)};
    }
    d.axial.carrier_radius_m = uniform(0.01, 0.05);
    d.friction.coefficient = uniform(0.0, 0.3);
    d.friction.model =
        k % 2 == 0 ? efficiency::LossModel::kSliding : efficiency::LossModel::kOhlendorf;
    d.masses.face_width_m = {uniform(0.001, 0.05), uniform(0.001, 0.05)};
    d.limits.model =
        k % 5 == 0 ? backlash::LostMotionModel::kPaper : backlash::LostMotionModel::kKinematic;
    d.limits[CheckId::kTipThickness] = uniform(0.0, 0.5);
    d.limits[CheckId::kPlanetGap] = uniform(0.0, 2.0);
    d.limits[CheckId::kNormalBacklash] = uniform(-1e-5, 5e-5);
    d.limits[CheckId::kOutputBacklashMax] = uniform(1.0, 20.0) * kArcmin;
    d.limits[CheckId::kRingRootDiameter] = uniform(0.02, 0.2);
    d.limits[CheckId::kContactRatioMin] = uniform(1.0, 1.3);
    d.limits[CheckId::kContactRatioMax] = uniform(1.6, 2.5);
    expect_round_trip(d);
  }
}

TEST(ToothKeys, ThatContradictTheGearAreAnError) {
  // Gear, what is added to it, and what the message must say.
  struct Case {
    std::string gear, added, message;
  };
  const std::vector<Case> cases{
      {"S", "cutter = { teeth = 10 }", "gears.S.cutter.teeth: allowed for rings only"},
      {"R1", "cutter = { tip_radius = 0.2 }",
       "gears.R1.cutter.tip_radius without gears.R1.cutter.teeth"},
      {"R1", "cutter = { teeth = 90 }",
       "gears.R1.cutter.teeth = 90: allowed: below the 90 of the ring"},
      {"R2", "tip_rule = \"khk\"", "gears.R2.tip_rule = \"khk\": allowed: \"full\""},
      {"P2", "tip_rule = \"khk\"", "gears.P2.tip_rule = \"khk\": allowed: \"full\""},
      {"S", "tip_rule = \"khk\", tip_shortening = 0.1",
       "gears.S.tip_shortening and gears.S.tip_rule"},
      {"P1", "pin_diameter_mm = 0.0", "gears.P1.pin_diameter_mm = 0"}};
  for (const Case& c : cases) {
    const auto line = kBilateral.find("\n" + c.gear + " = ");
    ASSERT_NE(line, std::string::npos);
    const auto brace = kBilateral.find(" }", line);
    std::string text = kBilateral;
    text.insert(brace, ", " + c.added);
    EXPECT_NE(errors_of(text).find(c.message), std::string::npos) << errors_of(text);
  }
}

TEST(AxialKeys, ReversedAndHalfStatedOnesAreAnError) {
  const auto errors = [](const std::string& table) { return errors_of(kBilateral + table); };
  EXPECT_NE(errors("[axial]\nS_mm = [3, 3]\n").find("axial.S_mm = [3, 3]: allowed: from below to"),
            std::string::npos);
  EXPECT_NE(errors("[axial]\nS_mm = [5, 3]\n").find("axial.S_mm"), std::string::npos);
  EXPECT_NE(errors("[axial]\ncarrier_mm = [0, 3]\n")
                .find("axial.carrier_mm without axial.carrier_diameter_mm"),
            std::string::npos);
  EXPECT_NE(errors("[axial]\ncarrier_diameter_mm = 30\n")
                .find("axial.carrier_diameter_mm without axial.carrier_mm"),
            std::string::npos);
  EXPECT_NE(errors("[rack]\ndedendum = 2.5\n").find("rack.dedendum = 2.5: allowed: below 2.157"),
            std::string::npos);
}

TEST(AxialKeys, MatesThatDoNotFaceEachOtherAndToothingsInOnePlaceAreAnError) {
  const std::string both = errors_of(
      kBilateral + "[axial]\nS_mm = [0, 8]\nP1_mm = [8, 16]\nP2_mm = [12, 20]\nR2_mm = [30, 38]\n");
  EXPECT_NE(both.find("axial.S_mm = [0, 8] and axial.P1_mm = [8, 16]: allowed: a length in common, "
                      "as S and P1 mesh"),
            std::string::npos)
      << both;
  EXPECT_NE(both.find("axial.P2_mm = [12, 20] and axial.R2_mm = [30, 38]: allowed: a length in "
                      "common, as P2 and R2 mesh"),
            std::string::npos)
      << both;
  EXPECT_NE(both.find("axial.P1_mm = [8, 16] and axial.P2_mm = [12, 20]: allowed: side by side, as "
                      "both are toothings of one planet"),
            std::string::npos)
      << both;
  EXPECT_NO_THROW(parse(kBilateral + "[axial]\nS_mm = [0, 8]\nP1_mm = [-1, 9]\nP2_mm = [9, 17]\n"));
}

// R2 from 67.6 to 71.5 mm, R1 from 73.6 to 77.2: R2 fits into R1 if its rim does.
TEST(AxialKeys, RingsInOnePlaceAreAnErrorUnlessOneIsInsideTheOther) {
  const auto places = [](const char* r1, const char* r2) {
    return std::string("[axial]\nR1_mm = ") + r1 + "\nR2_mm = " + r2 + "\n";
  };
  const std::string crossed = places("[0, 9]", "[8.5, 16]");
  const Design design = parse(kBilateral);
  const auto& t = design.train;
  const double tip_mm = t.module_m[0] * 1e3 * (90 + 2 * (t.profile_shift[train::kR1] - 1.0));
  EXPECT_NE(errors_of(kBilateral + crossed)
                .find(fmt::format("axial.R1_mm = [0, 9] and axial.R2_mm = [8.5, 16]: two rings in "
                                  "one place: allowed: apart along the axis, or "
                                  "gears.R2.outer_diameter_mm of at most {:.6g}, the tip diameter "
                                  "of R1",
                                  tip_mm)),
            std::string::npos)
      << errors_of(kBilateral + crossed);
  const auto with_rim = [&](double outer_mm) {
    return errors_of(
        replaced(kBilateral, "profile_shift = 1.21",
                 fmt::format("profile_shift = 1.21, outer_diameter_mm = {}", outer_mm)) +
        crossed);
  };
  EXPECT_EQ(with_rim(tip_mm - 0.1), "");
  EXPECT_NE(with_rim(tip_mm + 0.1).find("two rings in one place"), std::string::npos);
  EXPECT_EQ(errors_of(kBilateral + places("[0, 8]", "[8, 16]")), "") << "faces may touch";
  const std::string alike = errors_of(
      replaced(kBilateral, "teeth = 81, profile_shift = 1.21", "teeth = 83, profile_shift = 2.5") +
      crossed);
  EXPECT_NE(alike.find("two rings in one place: allowed: apart along the axis"), std::string::npos)
      << alike;
  EXPECT_EQ(alike.find("outer_diameter_mm"), std::string::npos) << alike;
}

TEST(DesignText, RoundTripsWithoutACentreDistance) {
  const Design d = parse(kBilateral);
  EXPECT_EQ(design_text(d).find("center_distance_mm"), std::string::npos);
  expect_round_trip(d);
}

TEST(DesignText, RoundTripsEveryCheckOnAndOff) {
  for (const design::CheckRecord& record : design::check_records()) {
    Design d = parse(kBilateral);
    d.limits[record.id].reset();
    SCOPED_TRACE(record.name);
    expect_round_trip(d);
  }
}

TEST(DesignText, RoundTripsALowerContactRatioWithoutAnUpperOne) {
  const Design d = parse(
      kBilateral + "[contact_ratio]\nrange = [1.3, 2.0]\n[limits]\ncontact_ratio_max = false\n");
  ASSERT_EQ(d.limits[CheckId::kContactRatioMin], 1.3);
  expect_round_trip(d);
}

TEST(DesignText, RoundTripsAnUpperContactRatioWithoutALowerOne) {
  expect_round_trip(parse(
      kBilateral + "[contact_ratio]\nrange = [1.3, 2.0]\n[limits]\ncontact_ratio_min = false\n"));
}

TEST(DesignText, IsThatOfTheDesignAsWritten) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> millimetres(20.0, 40.0);
  int moved = 0;
  for (int k = 0; k < 200; ++k) {
    Design d = parse(kBilateral);
    d.center_distance_given = true;
    d.train.center_distance_m = millimetres(random) * 0.0010000001;
    const Design written = as_written(d);
    EXPECT_EQ(design_text(written), design_text(d));
    EXPECT_EQ(parse(design_text(d)).train.center_distance_m, written.train.center_distance_m);
    moved += written.train.center_distance_m != d.train.center_distance_m ? 1 : 0;
  }
  EXPECT_LT(moved, 40);
}

TEST(DesignText, ALimitAtTheEndOfItsRangeIsWrittenAsItWasRead) {
  const Design d = parse(kBilateral + "[backlash]\nmax_output_arcmin = 1000000.0\n");
  const std::string text = design_text(d);
  EXPECT_NE(text.find("max_output_arcmin = 1000000.0\n"), std::string::npos) << text;
  EXPECT_EQ(parse(text).limits[CheckId::kOutputBacklashMax], d.limits[CheckId::kOutputBacklashMax]);
}

TEST(DesignText, KeysOfTheFrictionLawStandInTheirTableBesideTolerances) {
  const Design d = parse(kBilateral +
                         "[friction]\nlaw = \"load_power\"\nload_exponent = 0.2\n"
                         "reference_force_n = 110\n[operating_point]\nsun_speed_rpm = 300\n"
                         "output_torque_nm = 5\n[tolerances]\npin_position_um = 5\n");
  const Design read = parse(design_text(d));
  EXPECT_EQ(read.friction.law, d.friction.law);
  EXPECT_EQ(read.friction.load_exponent, d.friction.load_exponent);
  EXPECT_EQ(read.tolerances.value().pin_position_m, d.tolerances.value().pin_position_m);
  EXPECT_EQ(read.operating_point.value().sun_speed_rad_s,
            d.operating_point.value().sun_speed_rad_s);
}

TEST(DesignText, WhatAFileStatesIsReadBackToTheLastBit) {
  const std::string text =
      "name = \"a gear\"\npressure_angle_deg = 23.0\ncenter_distance_mm = 21.51\n" +
      replaced(kBilateral, "module_mm = 0.8\n", "module_mm = 0.81\nface_width_mm = 9.3\n") +
      "[axial]\nS_mm = [0.1, 7.7]\n[inertia]\ndensity_kg_m3 = 7850.0\n"
      "[bearings]\nplanet_coefficient = 0.002\nplanet_radius_mm = 3.3\n"
      "[operating_point]\nsun_speed_rpm = 313\noutput_torque_nm = 5.7\ntemperature_c = 41.3\n"
      "[backlash]\nmax_output_arcmin = 7.7\nmin_normal_um = 9.7\n"
      "[tolerances]\nplanet_phase_arcmin = 0.7\n[tolerances.S]\ntooth_thickness_um = [-23, -7]\n";
  const Design a = parse(text);
  const Design b = parse(design_text(a));
  EXPECT_EQ(a.train.pressure_angle_rad, b.train.pressure_angle_rad);
  EXPECT_EQ(a.train.center_distance_m, b.train.center_distance_m);
  EXPECT_EQ(a.train.module_m, b.train.module_m);
  EXPECT_EQ(a.masses.face_width_m, b.masses.face_width_m);
  EXPECT_EQ(a.axial.extent[train::kS].value().to_m, b.axial.extent[train::kS].value().to_m);
  EXPECT_EQ(a.shafts.planet_bearing_radius_m, b.shafts.planet_bearing_radius_m);
  EXPECT_EQ(a.operating_point.value().sun_speed_rad_s, b.operating_point.value().sun_speed_rad_s);
  EXPECT_EQ(a.operating_point.value().temperature_K, b.operating_point.value().temperature_K);
  EXPECT_EQ(a.limits.limit, b.limits.limit);
  EXPECT_EQ(a.tolerances.value().planet_phase_rad.upper,
            b.tolerances.value().planet_phase_rad.upper);
  EXPECT_EQ(a.tolerances.value().gears[train::kS].tooth_thickness_m.lower,
            b.tolerances.value().gears[train::kS].tooth_thickness_m.lower);
}

TEST(DesignText, RoundTripsMasses) {
  const Design d =
      parse(replaced(replaced(replaced(kBilateral, "module_mm = 0.8\n",
                                       "module_mm = 0.8\nface_width_mm = 9.0\n"),
                              "teeth = 12,", "teeth = 12, bore_mm = 3.0,"),
                     "teeth = 81,", "teeth = 81, outer_diameter_mm = 80.0,") +
            "[inertia]\ndensity_kg_m3 = 7850.0\nS_kgm2 = 1e-6\nP1_kgm2 = 4e-6\nP2_kgm2 = 3e-6\n"
            "planet_mass_kg = 0.08\ncarrier_kgm2 = 5e-5\nR2_kgm2 = 9e-4\n");
  expect_same_masses(d.masses, parse_design(design_text(d), "best.toml").masses);
}

TEST(DesignText, RoundTripsAnyName) {
  for (const std::string& name :
       {std::string(), std::string("two \"quoted\" words"), std::string("back\\slash\\"),
        std::string("line\nbreak\ttab\r"),
        std::string("Zahnr\xc3\xa4"
                    "der \xe2\x82\xac"),
        std::string("bell \x07"), std::string("# no comment"), std::string("'''")}) {
    Design d = parse(kBilateral);
    d.name = name;
    expect_round_trip(d);
  }
}

TEST(DesignText, RoundTripsANameWithADeleteCharacter) {
  const Design d = parse("name = \"a\\u007fb\"\n" + kBilateral);
  ASSERT_EQ(d.name,
            "a\x7f"
            "b");
  expect_round_trip(d);
}

TEST(DesignText, IsInKhkSignsWhateverTheSource) {
  std::string iso = "sign_convention = \"iso21771\"\n" + kBilateral;
  iso = replaced(iso, "teeth = 90, profile_shift = 2.0", "teeth = -90, profile_shift = -2.0");
  iso = replaced(iso, "teeth = 81, profile_shift = 1.21", "teeth = -81, profile_shift = -1.21");
  EXPECT_EQ(design_text(parse(iso)), design_text(parse(kBilateral)));
}

// --- pairs

class PairFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "gear3k_test_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] design::PairDesign read(const std::string& text) const {
    const std::string path = folder_ / "pair.toml";
    std::ofstream(path, std::ios::binary) << text;
    return read_pair(path);
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(PairFile, InternalPairHasARing) {
  const auto pair = read(
      "kind = \"internal\"\nmodule_mm = 3.0\ncenter_distance_mm = 13.2\n[gear1]\nteeth = 16\n"
      "[gear2]\nteeth = 24\nprofile_shift = 0.5\nnormal_thinning_um = 30.0\ntip_shortening = "
      "0.1\n");
  EXPECT_EQ(pair.gear1.kind, geometry::GearKind::kExternal);
  EXPECT_EQ(pair.gear2.kind, geometry::GearKind::kRing);
  EXPECT_EQ(pair.gear1.teeth, 16);
  EXPECT_EQ(pair.gear2.teeth, 24);
  EXPECT_DOUBLE_EQ(pair.gear1.module_m, 0.003);
  EXPECT_DOUBLE_EQ(pair.gear2.module_m, 0.003);
  EXPECT_EQ(pair.gear2.profile_shift, 0.5);
  EXPECT_DOUBLE_EQ(pair.gear2.machining_allowance, 0.01);
  EXPECT_EQ(pair.gear2.tip_shortening, 0.1);
  ASSERT_TRUE(pair.center_distance_m);
  EXPECT_DOUBLE_EQ(*pair.center_distance_m, 0.0132);
}

TEST_F(PairFile, ExternalPairMayHaveAnySizes) {
  const auto pair =
      read("kind = \"external\"\nmodule_mm = 3.0\n[gear1]\nteeth = 24\n[gear2]\nteeth = 12\n");
  EXPECT_EQ(pair.gear2.kind, geometry::GearKind::kExternal);
  EXPECT_EQ(pair.gear2.teeth, 12);
  EXPECT_FALSE(pair.center_distance_m);
}

TEST_F(PairFile, IsoSignsDescribeTheSameRing) {
  const std::string khk =
      "kind = \"internal\"\nmodule_mm = 3.0\n[gear1]\nteeth = 16\nprofile_shift = 0.2\n"
      "[gear2]\nteeth = 24\nprofile_shift = 0.5\n";
  const auto a = read(khk);
  const auto b = read("sign_convention = \"iso21771\"\n" +
                      replaced(replaced(khk, "teeth = 24", "teeth = -24"), "profile_shift = 0.5",
                               "profile_shift = -0.5"));
  EXPECT_EQ(a.gear1.profile_shift, b.gear1.profile_shift);
  EXPECT_EQ(a.gear2.profile_shift, b.gear2.profile_shift);
  EXPECT_EQ(a.gear2.teeth, b.gear2.teeth);
  EXPECT_EQ(a.gear2.kind, b.gear2.kind);
}

}  // namespace
}  // namespace gear3k::io::design_file_test
