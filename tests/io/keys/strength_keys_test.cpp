#include "io/keys/strength_keys.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/refined_set.hpp"

namespace gear3k::io::strength_keys_test {
namespace {

using strength::LimitLaw, strength::MaterialGroup, strength::MeshLoadSource, strength::RatingTask;

const std::string kGears =
    "[stage1]\nmodule_mm = 0.8\nface_width_mm = 8.0\n"
    "[stage2]\nmodule_mm = 0.8467\nface_width_mm = 9.0\n"
    "[gears.S]\nteeth = 12\nprofile_shift = 0.476\nbore_mm = 0.0\n"
    "[gears.P1]\nteeth = 39\nprofile_shift = 0.762\nbore_mm = 8.0\n"
    "[gears.R1]\nteeth = 90\nprofile_shift = 2.0\nouter_diameter_mm = 86.0\n"
    "[gears.P2]\nteeth = 32\nprofile_shift = 0.536\n"
    "[gears.R2]\nteeth = 81\nprofile_shift = 1.21\n";
const std::string kSteel = "[material]\nname = \"34CrNiMo6 through hardened\"\n";
const std::string kLoad = "[strength]\noutput_torque_nm = 20.0\n";
const std::string kPoint = "[operating_point]\nsun_speed_rpm = 600.0\noutput_torque_nm = 20.0\n";
const std::string kTolerances = "[tolerances]\ncenter_distance_um = [-5.0, 5.0]\n";
const std::string kSpec =
    "[ratio]\ntarget = 96.2\n"
    "[teeth]\nS = [12, 13]\nP1 = [50, 60]\nR1_max = 120\nP2 = [40, 60]\nR2_max = 121\n"
    "[module]\nstage1_mm = 1.0\nstage2_mm = 0.9\n";
const std::string kWidths = "[stage1]\nface_width_mm = 8.0\n[stage2]\nface_width_mm = 9.0\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

design::Design design_of(const std::string& rest) {
  return parse_design(kGears + rest, "gear.toml");
}
RatingTask task_of_design(const std::string& rest) { return design_of(rest).rating.value(); }
design::PairDesign pair_of(const std::string& rest, const std::string& first = "") {
  return parse_pair(first +
                        "kind = \"external\"\nmodule_mm = 4.5\n"
                        "[gear1]\nteeth = 16\n[gear2]\nteeth = 24\n" +
                        rest,
                    "pair.toml");
}

template <class Read>
std::string errors_of(Read read) {
  try {
    static_cast<void>(read());
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}
std::string design_errors(const std::string& rest) {
  return errors_of([&] { return design_of(rest); });
}
std::string specification_errors(const std::string& rest) {
  return errors_of([&] { return parse_specification(kSpec + rest, "spec.toml"); });
}

/// Messages, one for each line.
std::ptrdiff_t count_of(const std::string& errors) {
  return errors.empty() ? 0 : std::ranges::count(errors, '\n') + 1;
}

double um(double length_um) { return units::to_si(length_um, units::Unit::kMicrometre); }

void expect_same(const strength::StatedTeeth& a, const strength::StatedTeeth& b) {
  EXPECT_EQ(a.root_roughness_m, b.root_roughness_m);
  EXPECT_EQ(a.flank_roughness_m, b.flank_roughness_m);
  EXPECT_EQ(a.cycles, b.cycles);
  EXPECT_EQ(a.load_reversal, b.load_reversal);
  EXPECT_EQ(a.reversal, b.reversal);
  EXPECT_EQ(a.root_safety_min, b.root_safety_min);
  EXPECT_EQ(a.flank_safety_min, b.flank_safety_min);
}

void expect_only(const std::string& errors, const std::string& message) {
  EXPECT_NE(errors.find(message), std::string::npos) << "got: " << errors;
  EXPECT_EQ(count_of(errors), 1) << errors;
}

const strength::Material& named(const char* name) { return *strength::find_material(name); }

// --- what is read

TEST(StrengthKeys, WithoutThemNothingIsRated) {
  EXPECT_FALSE(design_of("").rating);
  EXPECT_FALSE(pair_of("").rating);
  EXPECT_FALSE(parse_specification(kSpec, "spec.toml").rating);
  EXPECT_FALSE(design_of(kSteel).rating);
}

TEST(StrengthKeys, DefaultsAreThoseOfTheTask) {
  const RatingTask task = task_of_design(kSteel + kLoad);
  const RatingTask unstated;
  EXPECT_EQ(task.torque_Nm, 20.0);
  EXPECT_FALSE(task.teeth.cycles);
  EXPECT_FALSE(task.life_s);
  EXPECT_FALSE(task.teeth.load_reversal);
  EXPECT_FALSE(task.factors.application);
  EXPECT_EQ(task.factors.mesh_load_source, MeshLoadSource::kNumber);
  EXPECT_FALSE(task.factors.mesh_load);
  EXPECT_FALSE(task.factors.dynamic);
  EXPECT_EQ(task.ambient_K, unstated.ambient_K);
  EXPECT_EQ(task.housing_surface_m2, unstated.housing_surface_m2);
  EXPECT_FALSE(task.supports);
  EXPECT_EQ(task.speed_rad_s, 0.0);
}

const std::string kEverything =
    kSteel + kPoint +
    "[strength]\noutput_torque_nm = 31.7\nlife_hours = 2000\nload_reversal = false\nk_a = 1.25\n"
    "k_gamma = \"m56\"\nk_v = 1.03\nk_h_beta = 1.15\nk_h_alpha = 1.02\nk_f_beta = 1.1\n"
    "k_f_alpha = 1.01\ny_m = 0.85\nf_beta_um = 7.3\naccuracy_grade = 6\ns_f_min = 1.5\ns_h_min = "
    "1.2\n"
    "virtual_root_radius = 0.38\noverload = 2.5\nroot_roughness_um = 16.1\n"
    "flank_roughness_um = 4.8\nviscosity40_mm2_s = 220\npitting_allowed = true\nambient_c = 35\n"
    "tooth_temperature_c = 60\nduty = 0.4\nhousing_resistance_k_m2_w = 0.06\n"
    "housing_surface_mm2 = 20000\nwear_coefficient_mm3_nm = 1e-6\n"
    "planet_torsion_nm_per_rad = 5000\nsun_shaft_nm_per_rad = 800\nring2_nm_per_rad = 9e4\n"
    "[axial]\nP1_mm = [0, 8]\nP2_mm = [10, 19]\n"
    "[bearings]\nplanet_positions_mm = [2, 17.3]\nplanet_stiffness_n_per_um = 50\n"
    "pin_stiffness_n_per_um = 30\n"
    "[inertia]\nplanet_mass_kg = 0.031\npin_diameter_mm = 6.0\npin_length_mm = 20.0\n";

TEST(StrengthKeys, UnitsBecomeSi) {
  const RatingTask task = task_of_design(kEverything);
  EXPECT_EQ(task.torque_Nm, 31.7);
  EXPECT_DOUBLE_EQ(task.life_s.value(), 7.2e6);
  EXPECT_FALSE(task.teeth.load_reversal.value());
  EXPECT_EQ(task.factors.application, 1.25);
  EXPECT_EQ(task.factors.mesh_load_source, MeshLoadSource::kM56);
  EXPECT_EQ(task.factors.dynamic, 1.03);
  EXPECT_EQ(task.factors.flank_face, 1.15);
  EXPECT_EQ(task.factors.flank_transverse, 1.02);
  EXPECT_EQ(task.factors.root_face, 1.1);
  EXPECT_EQ(task.factors.root_transverse, 1.01);
  EXPECT_EQ(task.teeth.reversal, 0.85);
  EXPECT_EQ(task.planet_torsion_Nm_rad, 5000.0);
  EXPECT_EQ(task.sun_shaft_Nm_rad, 800.0);
  EXPECT_EQ(task.ring2_Nm_rad, 9e4);
  EXPECT_DOUBLE_EQ(task.misalignment_m, 7.3e-6);
  EXPECT_EQ(task.accuracy_grade, 6);
  EXPECT_EQ(task.teeth.root_safety_min, 1.5);
  EXPECT_EQ(task.teeth.flank_safety_min, 1.2);
  EXPECT_EQ(task.virtual_root_radius, 0.38);
  EXPECT_EQ(task.overload, 2.5);
  EXPECT_DOUBLE_EQ(task.teeth.root_roughness_m.value(), 16.1e-6);
  EXPECT_DOUBLE_EQ(task.teeth.flank_roughness_m.value(), 4.8e-6);
  EXPECT_DOUBLE_EQ(task.viscosity40_m2_s.value(), 220e-6);
  EXPECT_TRUE(task.pitting_allowed);
  EXPECT_DOUBLE_EQ(task.ambient_K, 308.15);
  EXPECT_DOUBLE_EQ(task.tooth_temperature_K.value(), 333.15);
  EXPECT_EQ(task.duty, 0.4);
  EXPECT_EQ(task.housing_resistance, 0.06);
  EXPECT_DOUBLE_EQ(task.housing_surface_m2, 0.02);
  EXPECT_DOUBLE_EQ(task.wear_coefficient_m2_N.value(), 1e-15);
}

TEST(StrengthKeys, TheRestOfTheTaskComesFromWhatTheDesignStatesAnyway) {
  const RatingTask task = task_of_design(kEverything);
  EXPECT_DOUBLE_EQ(task.face_width_m[0], 0.008);
  EXPECT_DOUBLE_EQ(task.face_width_m[1], 0.009);
  EXPECT_DOUBLE_EQ(task.speed_rad_s, 20.0 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(task.pin_diameter_m.value(), 0.006);
  EXPECT_DOUBLE_EQ(task.supports.value().position_m[0], 0.002);
  EXPECT_DOUBLE_EQ(task.supports.value().position_m[1], 0.0173);
  EXPECT_DOUBLE_EQ(task.supports.value().plane_m[0], 0.004);
  EXPECT_DOUBLE_EQ(task.supports.value().plane_m[1], 0.0145);
  EXPECT_DOUBLE_EQ(task.supports.value().stiffness_N_m.value(), 50e6);
  // A bore of 0 is no bore, a ring without a stated surface has no rim.
  EXPECT_FALSE(task.rim_radius_m[train::kS]);
  EXPECT_DOUBLE_EQ(task.rim_radius_m[train::kP1].value(), 0.004);
  EXPECT_DOUBLE_EQ(task.rim_radius_m[train::kR1].value(), 0.043);
  EXPECT_FALSE(task.rim_radius_m[train::kP2]);
  EXPECT_FALSE(task.rim_radius_m[train::kR2]);
}

TEST(StrengthKeys, APairStatesItsTorqueSpeedAndFaceWidth) {
  const auto pair = pair_of(
      "[material]\nyoungs_modulus_mpa = 206000\npoisson_ratio = 0.3\n"
      "[strength]\ntorque_nm = 302\nspeed_rpm = 60\nlife_hours = 10\nk_gamma = 1.1\n",
      "face_width_mm = 14.0\n");
  const RatingTask& task = pair.rating.value();
  EXPECT_EQ(task.torque_Nm, 302.0);
  EXPECT_DOUBLE_EQ(task.face_width_m[0], 0.014);
  EXPECT_DOUBLE_EQ(task.speed_rad_s, 2.0 * std::numbers::pi);
  EXPECT_EQ(task.life_s, 36000.0);
  EXPECT_EQ(task.factors.mesh_load, 1.1);
  ASSERT_TRUE(task.material[0] && task.material[1]);
  EXPECT_EQ(task.material[1]->record.youngs_modulus_Pa, 206e9);
  EXPECT_FALSE(task.material[2]);
}

TEST(StrengthKeys, OfOneGearStandInPlaceOfThoseOfAll) {
  const std::string gears =
      "[gears.P1.strength]\ncycles = 3e6\nload_reversal = true\ny_m = 0.9\n"
      "root_roughness_um = 12.5\nflank_roughness_um = 3.2\ns_f_min = "
      "1.8\n[gears.R2]\nstrength.cycles = 2e5\n";
  const std::string common = "load_reversal = false\ny_m = 0.8\nroot_roughness_um = 16\n";
  const auto expect = [](const RatingTask& task) {
    const auto of = [&](std::size_t gear) { return strength::stated_teeth(task, gear); };
    expect_same(of(train::kP1), {.root_roughness_m = um(12.5),
                                 .flank_roughness_m = um(3.2),
                                 .cycles = 3e6,
                                 .load_reversal = true,
                                 .reversal = 0.9,
                                 .root_safety_min = 1.8,
                                 .flank_safety_min = task.teeth.flank_safety_min});
    for (const std::size_t gear : {train::kS, train::kR1, train::kP2, train::kR2}) {
      const std::optional<double> cycles = gear == train::kR2 ? std::optional(2e5) : std::nullopt;
      expect_same(of(gear), {.root_roughness_m = um(16),
                             .flank_roughness_m = {},
                             .cycles = cycles,
                             .load_reversal = false,
                             .reversal = 0.8,
                             .root_safety_min = task.teeth.root_safety_min,
                             .flank_safety_min = task.teeth.flank_safety_min});
      EXPECT_EQ(strength::has_life(task, gear), gear == train::kR2);
    }
  };
  const std::string design = replaced(kGears, "[gears.R2]\n", gears) + kSteel + kLoad + common;
  const auto read = parse_design(design, "gear.toml");
  expect(read.rating.value());
  expect(parse_design(design_text(read), "best.toml").rating.value());
  expect(parse_specification(kSpec + kWidths + kSteel + kLoad + common + gears, "spec.toml")
             .rating.value());
  const auto pair = pair_of(
      "[gear1.strength]\ncycles = 1e6\nflank_roughness_um = 4.8\n"
      "[gear2.strength]\nflank_roughness_um = 8\nload_reversal = true\n" +
          kSteel + "[strength]\ntorque_nm = 302\nload_reversal = false\n",
      "face_width_mm = 14.0\n");
  EXPECT_EQ(strength::stated_teeth(pair.rating.value(), 0).cycles, 1e6);
  EXPECT_EQ(strength::stated_teeth(*pair.rating, 0).load_reversal, false);
  EXPECT_EQ(strength::stated_teeth(*pair.rating, 1).load_reversal, true);
  EXPECT_DOUBLE_EQ(strength::stated_teeth(*pair.rating, 1).flank_roughness_m.value(), 8e-6);
}

// --- materials

TEST(MaterialKeys, ATextIsTheNameOfARow) {
  const RatingTask named_all =
      parse_design("material = \"34CrNiMo6 through hardened\"\n" + kGears + kLoad, "g")
          .rating.value();
  for (const auto& material : named_all.material) {
    EXPECT_EQ(material.value().record.name, "34CrNiMo6 through hardened");
    EXPECT_EQ(material.value().record.flank_limit.constant_Pa, 700e6);
    EXPECT_FALSE(material.value().hardness);
  }
}

TEST(MaterialKeys, AGearsMaterialTakesThePlaceOfTheOneOfAllAsAWhole) {
  const std::string gears =
      replaced(kGears, "[gears.S]\n", "[gears.S]\nmaterial = \"18CrNiMo7-6 case hardened\"\n");
  const RatingTask task =
      parse_design(gears + kSteel + "density_kg_m3 = 7000\n" + kLoad, "g").rating.value();
  EXPECT_EQ(task.material[train::kS].value().record.name, "18CrNiMo7-6 case hardened");
  EXPECT_EQ(task.material[train::kS].value().record.density_kgm3, 7830.0);
  for (const auto gear : {train::kP1, train::kR1, train::kP2, train::kR2}) {
    EXPECT_EQ(task.material[gear].value().record.name, "34CrNiMo6 through hardened");
    EXPECT_EQ(task.material[gear].value().record.density_kgm3, 7000.0);
  }
}

TEST(MaterialKeys, NumbersStandInPlaceOfThoseOfTheRow) {
  const RatingTask task = task_of_design(
      "[material]\nname = \"POM\"\nsigma_f_lim_mpa = 30\nyoungs_modulus_mpa = 2800\n"
      "[strength]\noutput_torque_nm = 2\ncycles = 1e6\n");
  const strength::Material& record = task.material[0].value().record;
  const strength::Material& row = named("POM");
  EXPECT_EQ(record.root_limit.law, LimitLaw::kLinear);
  EXPECT_EQ(record.root_limit.slope_Pa, 0.0);
  EXPECT_EQ(record.root_limit.constant_Pa, 30e6);
  EXPECT_EQ(record.flank_limit.law, LimitLaw::kPomFlank);
  EXPECT_EQ(record.youngs_modulus_Pa, 2800e6);
  EXPECT_EQ(record.poisson_ratio, row.poisson_ratio);
  EXPECT_EQ(record.group, MaterialGroup::kPom);
  EXPECT_EQ(record.life_curve, row.life_curve);
}

TEST(MaterialKeys, NumbersWithoutANameAreAMaterialOfTheirOwn) {
  const std::string numbers =
      "[material]\nyoungs_modulus_mpa = 206000.0\npoisson_ratio = 0.3\nsigma_h_lim_mpa = 700.0\n"
      "sigma_f_lim_mpa = 290.0\n";
  const RatingTask task = task_of_design(numbers + kLoad);
  const auto& material = task.material[3].value();
  EXPECT_EQ(material.record.name, "");
  EXPECT_EQ(material.record.group, MaterialGroup::kThroughHardened);
  EXPECT_EQ(material.record.life_curve, strength::LifeCurve::kSteel);
  EXPECT_EQ(material.record.flank_limit.constant_Pa, 700e6);
  EXPECT_FALSE(material.record.density_kgm3);
  const RatingTask soft = task_of_design(numbers + "group = \"NT\"\nhardness = 240\n" + kLoad);
  EXPECT_EQ(soft.material[0].value().record.group, MaterialGroup::kNitriding);
  EXPECT_EQ(soft.material[0].value().record.life_curve, strength::LifeCurve::kNitrided);
  EXPECT_EQ(soft.material[0].value().record.hardness_scale, strength::HardnessScale::kBrinell);
  EXPECT_EQ(soft.material[0].value().hardness, 240.0);
}

TEST(MaterialKeys, LifeCurvesOfTheGroupsAreThoseOfTheTable) {
  for (const strength::Material& row : strength::material_table()) {
    const auto name = strength::kMaterialGroupNames[static_cast<std::size_t>(row.group)];
    const RatingTask task =
        task_of_design("[material]\nyoungs_modulus_mpa = 1000\npoisson_ratio = 0.3\ngroup = \"" +
                       std::string(name) + "\"\n" + kLoad);
    EXPECT_EQ(task.material[0].value().record.life_curve, row.life_curve) << row.name;
  }
}

TEST(MaterialKeys, AHardnessIsNeededWhereALimitDependsOnIt) {
  const std::string row = "[material]\nname = \"through hardened alloy steel MQ\"\n";
  expect_only(design_errors(row + kLoad),
              "gear.toml:25:2: material.hardness is missing, which the limits of \"through "
              "hardened alloy steel MQ\" depend on: allowed: 200 to 360 HV");
  EXPECT_EQ(design_errors(row + "hardness = 200\n" + kLoad), "");
  EXPECT_EQ(design_errors(row + "sigma_h_lim_mpa = 700\nsigma_f_lim_mpa = 290\n" + kLoad), "");
  // A row of one value, or of limits that do not depend on it, needs none.
  EXPECT_EQ(design_errors("[material]\nname = \"18CrNiMo7-6 case hardened\"\n" + kLoad), "");
  EXPECT_EQ(design_errors("[material]\nname = \"case hardened steel MQ\"\n" + kLoad), "");
}

TEST(MaterialKeys, DensitiesAreThoseOfTheMassesUnlessTheFileStatesOne) {
  EXPECT_EQ(design_of(kSteel).masses.density_kgm3, 7830.0);
  EXPECT_EQ(design_of(kSteel + "[inertia]\ndensity_kg_m3 = 7000\n").masses.density_kgm3, 7000.0);
  EXPECT_FALSE(design_of(kSteel + "[gears.S.material]\nname = \"POM\"\n").masses.density_kgm3);
  EXPECT_FALSE(design_of("[gears.S.material]\nname = \"POM\"\n").masses.density_kgm3);
  const std::string planets_of_pom =
      kSteel + "[gears.P1.material]\nname = \"POM\"\n[gears.P2.material]\nname = \"POM\"\n";
  const design::GearDensities densities{7830.0, 1415.0, 7830.0, 1415.0, 7830.0};
  for (const std::string& load : {std::string(), kLoad + "cycles = 1e6\n"}) {
    const auto design = design_of(planets_of_pom + load);
    EXPECT_EQ(design.masses.gear_density_kgm3, densities);
    EXPECT_FALSE(design.masses.density_kgm3);
    EXPECT_EQ(parse_design(design_text(design), "g").masses.gear_density_kgm3, densities);
    const auto spec = parse_specification(kSpec + kWidths + planets_of_pom + load, "s");
    EXPECT_EQ(spec.bodies.gear_density_kgm3, densities);
    EXPECT_TRUE(optimize::knows_masses(spec));
  }
  // What needs a density takes this one.
  EXPECT_EQ(design_errors(kSteel + "[inertia]\npin_diameter_mm = 6\npin_length_mm = 20\n"
                                   "carrier_outer_diameter_mm = 60\ncarrier_thickness_mm = 4\n"),
            "");
  EXPECT_EQ(parse_specification(kSpec + kSteel, "s").bodies.density_kgm3, 7830.0);
  EXPECT_EQ(errors_of([] {
              return parse_specification("objective = \"mass\"\n" + kSpec + kWidths + kSteel, "s");
            }),
            "");
}

TEST(StrengthKeys, LimitsOfBearingsAndPinWantThemStated) {
  const std::string axial = "[axial]\nP1_mm = [0, 8]\nP2_mm = [10, 19]\n";
  const std::string limits = "[limits]\nbearing_load = 100\npin_stress = 50\n";
  const std::string all = design_errors(kSteel + kLoad + limits);
  EXPECT_NE(all.find("limits.bearing_load without bearings.planet_positions_mm"),
            std::string::npos);
  EXPECT_NE(all.find("limits.pin_stress without bearings.planet_positions_mm and "
                     "bearings.pin_diameter_mm"),
            std::string::npos);
  const std::string bearings = "[bearings]\nplanet_positions_mm = [2, 17.3]\n";
  EXPECT_EQ(design_errors(kSteel + kLoad + axial + bearings + "pin_diameter_mm = 4\n" + limits),
            "");
  EXPECT_NE(design_errors(kSteel + kLoad + axial + bearings +
                          "pin_diameter_mm = 4\n[inertia]\n"
                          "pin_diameter_mm = 4\n"
                          "pin_length_mm = 20\n")
                .find("bearings.pin_diameter_mm and inertia.pin_diameter_mm: allowed: one of them"),
            std::string::npos);
  EXPECT_NE(design_errors(kSteel + "[bearings]\npin_diameter_mm = 4\n")
                .find("bearings.pin_diameter_mm: allowed with [strength] only"),
            std::string::npos);
}

TEST(StrengthKeys, WearWantsALifeAndACapacityALimit) {
  // A plastic of stated limits has no curve that would ask for a life.
  const std::string plastic =
      "youngs_modulus_mpa = 3600\npoisson_ratio = 0.36\ngroup = \"plastic\"\n"
      "sigma_h_lim_mpa = 60\nsigma_f_lim_mpa = 40\n";
  const std::string worn = kSteel + "[gears.P2.material]\n" + plastic + kLoad;
  const std::string wear = "wear_coefficient_mm3_nm = 1e-6\n";
  const std::string of_sun = "[gears.S.strength]\ncycles = 1e6\n";
  const std::string of_planet = "[gears.P2.strength]\ncycles = 1e6\n";
  const std::string message =
      "strength.wear_coefficient_mm3_nm without a life of gears.P2: allowed: with "
      "strength.cycles, strength.life_hours or gears.P2.strength.cycles";
  expect_only(design_errors(worn + wear), message);
  expect_only(design_errors(worn + wear + of_sun), message);
  EXPECT_EQ(design_errors(worn + wear + of_planet), "");
  EXPECT_EQ(design_errors(worn + wear + "cycles = 1e6\n"), "");
  EXPECT_EQ(design_errors(worn + wear + "life_hours = 10\n" + kPoint), "");
  expect_only(design_errors(worn + wear + "[gears.P1.material]\n" + plastic),
              "without a life of gears.P1, gears.P2: allowed: with strength.cycles, "
              "strength.life_hours or gears.P1.strength.cycles, gears.P2.strength.cycles");
  for (const std::string objective : {"torque_capacity", "torque_density"}) {
    EXPECT_NE(errors_of([&] {
                return parse_specification("objective = \"" + objective + "\"\n" + kSpec + kWidths +
                                               "[material]\nname = \"PEEK\"\n" + kLoad,
                                           "s");
              }).find("with materials of which no limit stress is stated"),
              std::string::npos)
        << objective;
  }
}

// --- read = write

TEST(StrengthKeys, ReadBackFromTheTextOfADesignAsTheyWere) {
  const std::vector<std::string> files{
      kSteel,
      kSteel + kLoad,
      kSteel + "hardness = 240\ndensity_kg_m3 = 7700\n" + kLoad,
      kEverything,
      kEverything + "density_kg_m3 = 7830\n",
      kEverything + "density_kg_m3 = 7831.3\n",
      kEverything +
          "[gears.P1.strength]\ncycles = 1.7e5\nload_reversal = true\ny_m = 0.77\n"
          "root_roughness_um = 12.7\n[gears.S.strength]\nflank_roughness_um = 3.3\n",
      "[material]\nyoungs_modulus_mpa = 71000.3\npoisson_ratio = 0.331\n" + kLoad +
          "k_gamma = \"drivetrain\"\ncycles = 3.1e7\n",
      "[material]\nyoungs_modulus_mpa = 71000.3\npoisson_ratio = 0.331\nhardness = 241.5\n"
      "group = \"IF\"\nsigma_h_lim_mpa = 701.7\nsigma_f_lim_mpa = 290.1\n"
      "yield_strength_mpa = 900\ndensity_kg_m3 = 7801\n" +
          kLoad + "k_gamma = 1.17\n",
      kSteel + kLoad + "k_gamma = \"tolerances\"\nk_gamma_quantile = 0.973\n" + kTolerances,
      "[material]\nname = \"POM\"\nsigma_f_lim_mpa = 31.7\n"
      "[gears.S.material]\nname = \"through hardened alloy steel MQ\"\nhardness = 301.7\n"
      "[gears.R2.material]\nname = \"PA66\"\ngroup = \"PA\"\nyield_strength_mpa = 55.5\n" +
          kLoad + "cycles = 1e6\ntooth_temperature_c = 71.3\n"};
  for (const std::string& file : files) {
    const auto first = design_of(file);
    const std::string written = design_text(first);
    const auto second = parse_design(written, "best.toml");
    EXPECT_EQ(design_text(second), written);
    EXPECT_EQ(first.masses.density_kgm3, second.masses.density_kgm3) << written;
    ASSERT_EQ(first.rating.has_value(), second.rating.has_value()) << written;
    if (!first.rating) continue;
    const RatingTask& a = *first.rating;
    const RatingTask& b = *second.rating;
    for (std::size_t g = 0; g < train::kGearCount; ++g) {
      const auto& x = a.material[g].value();
      const auto& y = b.material[g].value();
      EXPECT_EQ(x.record.name, y.record.name);
      EXPECT_EQ(x.record.group, y.record.group) << written;
      EXPECT_EQ(x.record.life_curve, y.record.life_curve);
      EXPECT_EQ(x.record.hardness_scale, y.record.hardness_scale);
      EXPECT_EQ(x.hardness, y.hardness);
      EXPECT_EQ(x.record.youngs_modulus_Pa, y.record.youngs_modulus_Pa);
      EXPECT_EQ(x.record.poisson_ratio, y.record.poisson_ratio);
      EXPECT_EQ(x.record.density_kgm3, y.record.density_kgm3);
      EXPECT_EQ(x.record.yield_strength_Pa, y.record.yield_strength_Pa);
      for (const auto limit : {&strength::Material::flank_limit, &strength::Material::root_limit}) {
        EXPECT_EQ((x.record.*limit).law, (y.record.*limit).law);
        EXPECT_EQ((x.record.*limit).slope_Pa, (y.record.*limit).slope_Pa);
        EXPECT_EQ((x.record.*limit).constant_Pa, (y.record.*limit).constant_Pa);
      }
      EXPECT_EQ(a.rim_radius_m[g], b.rim_radius_m[g]);
    }
    EXPECT_EQ(a.torque_Nm, b.torque_Nm);
    EXPECT_EQ(a.face_width_m, b.face_width_m);
    EXPECT_EQ(a.speed_rad_s, b.speed_rad_s);
    EXPECT_EQ(a.life_s, b.life_s);
    expect_same(a.teeth, b.teeth);
    for (std::size_t g = 0; g < train::kGearCount; ++g) {
      expect_same(a.gear_teeth[g], b.gear_teeth[g]);
    }
    EXPECT_EQ(a.factors.application, b.factors.application);
    EXPECT_EQ(a.factors.mesh_load_source, b.factors.mesh_load_source);
    EXPECT_EQ(a.factors.mesh_load, b.factors.mesh_load);
    EXPECT_EQ(a.factors.mesh_load_quantile, b.factors.mesh_load_quantile);
    EXPECT_EQ(a.factors.dynamic, b.factors.dynamic);
    EXPECT_EQ(a.factors.root_transverse, b.factors.root_transverse);
    EXPECT_EQ(a.planet_torsion_Nm_rad, b.planet_torsion_Nm_rad);
    EXPECT_EQ(a.sun_shaft_Nm_rad, b.sun_shaft_Nm_rad);
    EXPECT_EQ(a.ring2_Nm_rad, b.ring2_Nm_rad);
    EXPECT_EQ(a.misalignment_m, b.misalignment_m);
    EXPECT_EQ(a.accuracy_grade, b.accuracy_grade);
    EXPECT_EQ(a.overload, b.overload);
    EXPECT_EQ(a.ambient_K, b.ambient_K);
    EXPECT_EQ(a.tooth_temperature_K, b.tooth_temperature_K);
    EXPECT_EQ(a.housing_surface_m2, b.housing_surface_m2);
    EXPECT_EQ(a.wear_coefficient_m2_N, b.wear_coefficient_m2_N);
    EXPECT_EQ(a.pin_diameter_m, b.pin_diameter_m);
    ASSERT_EQ(a.supports.has_value(), b.supports.has_value());
    if (!a.supports) continue;
    EXPECT_EQ(a.supports->position_m, b.supports->position_m);
    EXPECT_EQ(a.supports->plane_m, b.supports->plane_m);
    EXPECT_EQ(a.supports->stiffness_N_m, b.supports->stiffness_N_m);
    EXPECT_EQ(a.supports->pin_stiffness_N_m, b.supports->pin_stiffness_N_m);
  }
}

TEST(StrengthKeys, OneMaterialIsWrittenOnceAndSeveralByGear) {
  const std::string one = design_text(design_of(kSteel + kLoad));
  EXPECT_NE(one.find("\n[material]\nname = \"34CrNiMo6 through hardened\"\n"), std::string::npos)
      << one;
  EXPECT_EQ(one.find(".material]"), std::string::npos) << one;
  EXPECT_EQ(one.find("density"), std::string::npos) << one;
  const std::string several =
      design_text(design_of(kSteel + "[gears.S.material]\nname = \"16MnCr5\"\n" + kLoad));
  EXPECT_EQ(several.find("\n[material]"), std::string::npos) << several;
  for (const char* gear : {"S", "P1", "R1", "P2", "R2"}) {
    EXPECT_NE(several.find("[gears." + std::string(gear) + ".material]"), std::string::npos);
  }
}

TEST(StrengthKeys, ASpecTakesThemToo) {
  const auto spec = parse_specification(kSpec + kWidths + kSteel + kLoad +
                                            "k_gamma = \"m56\"\nlife_hours = 100\n" + kPoint +
                                            "[gears.S]\nmaterial = \"18CrNiMo7-6 case hardened\"\n",
                                        "spec.toml");
  const RatingTask& task = spec.rating.value();
  EXPECT_EQ(task.torque_Nm, 20.0);
  EXPECT_DOUBLE_EQ(task.face_width_m[0], 0.008);
  EXPECT_DOUBLE_EQ(task.face_width_m[1], 0.009);
  EXPECT_DOUBLE_EQ(task.speed_rad_s, 20.0 * std::numbers::pi);
  EXPECT_EQ(task.material[train::kS].value().record.name, "18CrNiMo7-6 case hardened");
  EXPECT_EQ(task.material[train::kR2].value().record.name, "34CrNiMo6 through hardened");
}

TEST(StrengthKeys, RimsOfTheRingsStandInADesignWithoutMassesAndLimitsToo) {
  const auto spec = parse_specification(kSpec + "[size]\nring_rim_mm = 3.0\n", "spec.toml");
  optimize::RefinedSet set;
  set.candidate.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118};
  set.train = {.profile_shift = {0.3, 0.4, 0.9, 0.4, 0.9},
               .module_m = {1e-3, 0.9e-3},
               .center_distance_m = 0.0335,
               .tip_shortening = {},
               .pressure_angle_rad = spec.pressure_angle_rad};
  const design::Design made = optimize::design_of(spec, set);
  // Root radius m (z/2 + x + 1.25) of a ring, and the rim.
  EXPECT_NEAR(made.masses.ring1_outer_radius_m.value(), 1e-3 * (60.0 + 0.9 + 1.25) + 3e-3, 1e-9);
  EXPECT_NEAR(made.masses.ring2_outer_radius_m.value(), 0.9e-3 * (59.0 + 0.9 + 1.25) + 3e-3, 1e-9);
}

TEST(StrengthKeys, TheDesignOfARefinedSetIsReadBackWithItsRating) {
  const auto spec =
      parse_specification(kSpec + kWidths + "[size]\nring_rim_mm = 3.0\n" + kSteel + kLoad +
                              "k_gamma = \"m56\"\nlife_hours = 100\ns_f_min = 1.5\n" + kPoint +
                              "[axial]\nP1_mm = [0, 8]\nP2_mm = [10, 19]\n"
                              "[bearings]\nplanet_positions_mm = [2, 17.3]\n",
                          "spec.toml");
  optimize::RefinedSet set;
  set.candidate.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118};
  set.train = {.profile_shift = {0.3, 0.4, 0.9, 0.4, 0.9},
               .module_m = {1e-3, 0.9e-3},
               .center_distance_m = 0.0335,
               .tip_shortening = {},
               .pressure_angle_rad = spec.pressure_angle_rad};
  const design::Design made = optimize::design_of(spec, set);
  ASSERT_TRUE(made.rating);
  const std::string written = design_text(made);
  for (const char* line :
       {"\n[material]\nname = \"34CrNiMo6 through hardened\"\n", "face_width_mm = 8.0\n",
        "face_width_mm = 9.0\n", "\n[strength]\noutput_torque_nm = 20.0\nlife_hours = 100.0\n",
        "k_gamma = \"m56\"\n", "s_f_min = 1.5\n", "planet_positions_mm = [2.0, 17.3]\n",
        "\n[operating_point]\nsun_speed_rpm = 600.0\n"}) {
    EXPECT_NE(written.find(line), std::string::npos) << line << written;
  }
  const design::Design read = parse_design(written, "best.toml");
  EXPECT_EQ(design_text(read), written);
  const RatingTask& a = *made.rating;
  const RatingTask& b = read.rating.value();
  EXPECT_EQ(a.torque_Nm, b.torque_Nm);
  EXPECT_EQ(a.face_width_m, b.face_width_m);
  EXPECT_EQ(a.speed_rad_s, b.speed_rad_s);
  EXPECT_EQ(a.supports.value().plane_m, b.supports.value().plane_m);
  for (const auto ring : {train::kR1, train::kR2}) {
    EXPECT_DOUBLE_EQ(a.rim_radius_m[ring].value(), b.rim_radius_m[ring].value());
  }
  EXPECT_EQ(made.masses.density_kgm3, 7830.0);
  EXPECT_EQ(read.masses.density_kgm3, 7830.0);
}

TEST(StrengthKeys, TheExampleCarriesATorque) {
  const auto design = read_design(std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/loaded.toml");
  const RatingTask& task = design.rating.value();
  EXPECT_EQ(task.torque_Nm, 20.0);
  EXPECT_DOUBLE_EQ(task.face_width_m[0], 0.008);
  EXPECT_DOUBLE_EQ(task.face_width_m[1], 0.008);
  EXPECT_EQ(task.material[train::kS].value().record.root_limit.constant_Pa, 290e6);
}

// --- bad input

struct BadCase {
  std::string rest, message;
};

TEST(StrengthKeys, ThatDoNotFitAreAnErrorEachAtItsPlace) {
  const std::string pom = "[material]\nname = \"POM\"\n";
  const std::string axial = "[axial]\nP1_mm = [0, 8]\nP2_mm = [10, 19]\n";
  const std::vector<BadCase> cases{
      {kSteel + "[strength]\nk_a = 1.0\n",
       "gear.toml:27:2: strength.output_torque_nm is missing, required by [strength]"},
      {kSteel + "[strength]\noutput_torque_nm = 0\n",
       "gear.toml:28:1: strength.output_torque_nm = 0: allowed: a number in N m, 1e-06 to "
       "10000000"},
      {kLoad, "gear.toml:25:2: material is missing, required by [strength]: allowed: [material]"},
      {"[gears.S.material]\nname = \"POM\"\n[gears.P1.material]\nname = \"POM\"\n" + kLoad +
           "cycles = 1e6\n",
       "gear.toml:29:2: gears.R1.material, gears.P2.material, gears.R2.material is missing, "
       "required by [strength]"},
      {kSteel + kLoad + "cycles = 0.5\n",
       "gear.toml:29:1: strength.cycles = 0.5: allowed: a number, 1 to 1e+18"},
      {kSteel + kLoad + "cycles = 1e6\nlife_hours = 10\n" + kPoint,
       "gear.toml:29:1: strength.cycles and strength.life_hours: allowed: one of them"},
      {kSteel + kLoad + "life_hours = 10\n",
       "gear.toml:29:1: strength.life_hours without operating_point.sun_speed_rpm: allowed: with "
       "it, or strength.cycles instead"},
      {kSteel + kLoad + "life_hours = 10\n" + replaced(kPoint, "600.0", "0"),
       "gear.toml:31:1: operating_point.sun_speed_rpm = 0: allowed: above 0 with "
       "strength.life_hours"},
      {kSteel + kLoad + "s_f_min = 0\n",
       "gear.toml:29:1: strength.s_f_min = 0: allowed: a number, above 0 to 100"},
      {kSteel + kLoad + "s_h_min = -1.2\n",
       "gear.toml:29:1: strength.s_h_min = -1.2: allowed: a number, above 0 to 100"},
      {kSteel + kLoad + "k_gamma = \"m57\"\n",
       "strength.k_gamma = \"m57\": allowed: a number, 1 to 1000, or \"m56\" or \"drivetrain\" or "
       "\"tolerances\"; did you mean \"m56\"?"},
      {kSteel + kLoad + "k_gamma = \"tolerances\"\n",
       "gear.toml:29:1: strength.k_gamma = \"tolerances\" without [tolerances]: allowed: with it"},
      {kSteel + kLoad + "k_gamma_quantile = 0.9\n",
       "gear.toml:29:1: strength.k_gamma_quantile without strength.k_gamma = \"tolerances\": "
       "allowed: "
       "with it"},
      {kSteel + kLoad + "k_gamma = \"tolerances\"\nk_gamma_quantile = 1.1\n" + kTolerances,
       "strength.k_gamma_quantile = 1.1: allowed: a number, 0.5 to 1"},
      {kSteel + kLoad + "k_v = 0.9\n", "strength.k_v = 0.9: allowed: a number, 1 to 1000"},
      {kSteel + kLoad + "accuracy_grade = 9\n",
       "strength.accuracy_grade = 9: allowed: an integer, 3 to 8"},
      {kSteel + kLoad + "overload = 0.9\n", "strength.overload = 0.9: allowed: a number, 1 to 100"},
      {kSteel + kLoad + "duty = 0\n", "strength.duty = 0: allowed: a number, above 0 to 1"},
      {kSteel + kLoad + "f_beta_um = -1\n", "strength.f_beta_um = -1: allowed: a number in um, 0"},
      {kSteel + kLoad + "housing_resistance_k_m2_w = 0.06\n",
       "strength.housing_resistance_k_m2_w without strength.housing_surface_mm2"},
      {kSteel + kLoad + "housing_surface_mm2 = 20000\n",
       "gear.toml:29:1: strength.housing_surface_mm2 without strength.housing_resistance_k_m2_w"},
      {kSteel + kLoad + "torque_nm = 3\n", "unknown key strength.torque_nm"},
      // Materials.
      {kSteel + "sigma_h_lim_mpa = 0\n" + kLoad,
       "gear.toml:27:1: material.sigma_h_lim_mpa = 0: allowed: a number in MPa, above 0"},
      {kSteel + "sigma_f_lim_mpa = -290.0\n" + kLoad,
       "gear.toml:27:1: material.sigma_f_lim_mpa = -290.0: allowed: a number in MPa, above 0"},
      {kSteel + "poisson_ratio = 0.5\n" + kLoad,
       "material.poisson_ratio = 0.5: allowed: a number, 0 to 0.499"},
      {kSteel + "group = \"Ht\"\n" + kLoad,
       "gear.toml:27:1: material.group = \"Ht\": allowed: \"St\" or \"V\" or \"Eh\""},
      {kSteel + "hardness = 300\n" + kLoad,
       "gear.toml:27:1: material.hardness = 300: allowed: 240 HBW, for which \"34CrNiMo6 through "
       "hardened\" holds"},
      {"[material]\nname = \"through hardened alloy steel MQ\"\nhardness = 361\n" + kLoad,
       "gear.toml:27:1: material.hardness = 361: allowed: 200 to 360 HV, for which"},
      {pom + "hardness = 80\n" + kLoad + "cycles = 1e6\n",
       "gear.toml:27:1: material.hardness = 80: allowed: of metals only"},
      {"[material]\nname = \"nodular cast iron ML MQ\"\nhardness = 200\npoisson_ratio = 0.27\n" +
           kLoad,
       "gear.toml:25:2: material.youngs_modulus_mpa is missing, required by [strength], which "
       "\"nodular cast iron ML MQ\" does not state"},
      {"[material]\nyoungs_modulus_mpa = 206000\nsigma_h_lim_mpa = 700\n" + kLoad,
       "gear.toml:25:2: material.poisson_ratio is missing, required by [strength]"},
      {kSteel + kLoad + "[gears.S.material]\npoisson_ratio = 0.3\n",
       "gear.toml:29:10: gears.S.material.youngs_modulus_mpa is missing, required by [strength]"},
      {"[material]\nname = \"34CrNiMo6 thruogh hardened\"\n" + kLoad,
       "gear.toml:26:1: material.name = \"34CrNiMo6 thruogh hardened\": allowed: one of the 39 "
       "names of docs/materials.md, or none and numbers in its place; did you mean \"34CrNiMo6 "
       "through hardened\""},
      {"[material]\nname = \"34CrNiMo7\"\n" + kLoad,
       "gear.toml:26:1: material.name = \"34CrNiMo7\": allowed: one of the 39 names of "
       "docs/materials.md, or none and numbers in its place; did you mean "
       "\"18CrNiMo7-6 case hardened\" or \"34CrNiMo6 through hardened\""},
      {"[gears.S.material]\nname = \"unobtainium\"\n" + kSteel + kLoad,
       "gear.toml:26:1: gears.S.material.name = \"unobtainium\": allowed: one of the 39 names"},
      // Plastics.
      {pom + kLoad,
       "gear.toml:27:2: strength.cycles is missing, which the limits of \"POM\" (gears.S) depend "
       "on: allowed: cycles or life_hours"},
      {kSteel + "[gears.P1.material]\nname = \"POM\"\n[gears.P2.material]\nname = \"PA66\"\n" +
           kLoad + "[gears.P1.strength]\ncycles = 1e6\n",
       "gear.toml:31:2: strength.cycles is missing, which the limits of \"PA66\" (gears.P2) depend "
       "on: allowed: cycles or life_hours"},
      {pom + kLoad + "cycles = 1e6\ntooth_temperature_c = 121\n",
       "gear.toml:30:1: strength.tooth_temperature_c = 121: allowed: at most 120, where the curves "
       "of \"POM\" end"},
      {pom + kLoad + "cycles = 1e6\nambient_c = 130\n",
       "gear.toml:30:1: strength.ambient_c = 130: allowed: at most 120, where the curves"},
      // Of one gear.
      {kSteel + "[gears.P1.strength]\ncycles = 1e6\n",
       "gear.toml:27:11: gears.P1.strength without [strength]: allowed: with it"},
      {kSteel + kLoad + "[gears.S.strength]\ncycles = 0\n",
       "gear.toml:30:1: gears.S.strength.cycles = 0: allowed: a number, 1 to 1e+18"},
      {kSteel + kLoad + "[gears.S.strength]\nroot_roughness = 3\n",
       "gear.toml:30:1: unknown key gears.S.strength.root_roughness; did you mean "
       "gears.S.strength.root_roughness_um?"},
      {kSteel + kLoad + "[gears.P3.strength]\ncycles = 1e6\n",
       "gear.toml:29:8: unknown table [gears.P3]"},
      {kSteel + kLoad + "load_reversal = false\n[gears.R1.strength]\ny_m = 0.9\n",
       "gear.toml:31:1: gears.R1.strength.y_m without load reversal: allowed: with "
       "gears.R1.strength.load_reversal = true"},
      {kSteel + kLoad + "[gears.R1.strength]\nload_reversal = false\ny_m = 0.9\n",
       "gears.R1.strength.y_m without load reversal: allowed: with"},
      // Bearings.
      {kSteel + kLoad + axial + "[bearings]\nplanet_positions_mm = [5, 5]\n",
       "gear.toml:33:1: bearings.planet_positions_mm = [5, 5]: both bearings are in one plane"},
      {kSteel + kLoad + "[bearings]\nplanet_positions_mm = [5, 9]\n",
       "gear.toml:30:1: bearings.planet_positions_mm without axial.P1_mm and axial.P2_mm"},
      {kSteel + kLoad + "[axial]\nP1_mm = [0, 8]\n[bearings]\nplanet_positions_mm = [5, 9]\n",
       "bearings.planet_positions_mm without axial.P2_mm: allowed: with it"},
      {kSteel + kLoad + "[bearings]\nplanet_stiffness_n_per_um = 50\n",
       "gear.toml:30:1: bearings.planet_stiffness_n_per_um without bearings.planet_positions_mm"},
      {kSteel + axial + "[bearings]\nplanet_positions_mm = [5, 9]\n",
       "gear.toml:31:1: bearings.planet_positions_mm: allowed with [strength] only"}};
  for (const BadCase& c : cases) {
    SCOPED_TRACE(c.rest);
    expect_only(design_errors(c.rest), c.message);
  }
}

TEST(MaterialKeys, AMaterialThatIsNeitherNameNorTableIsRefusedAtItsPlace) {
  const std::string gears = replaced(kGears, "[gears.S]\n", "[gears.S]\nmaterial = 5\n");
  expect_only(errors_of([&] { return parse_design(gears + kSteel + kLoad, "gear.toml"); }),
              "gear.toml:8:1: gears.S.material.name = 5: allowed: a text in quotes");
}

TEST(StrengthKeys, FaceWidthsArePartOfARating) {
  const std::string first = replaced(kGears, "face_width_mm = 8.0\n", "");
  expect_only(errors_of([&] { return parse_design(first + kSteel + kLoad, "gear.toml"); }),
              "gear.toml:1:2: stage1.face_width_mm is missing, required by [strength]");
  const std::string second = replaced(kGears, "face_width_mm = 9.0\n", "");
  expect_only(errors_of([&] { return parse_design(second + kSteel + kLoad, "gear.toml"); }),
              "gear.toml:4:2: stage2.face_width_mm is missing, required by [strength]");
  const std::string errors = specification_errors(kSteel + kLoad);
  EXPECT_EQ(count_of(errors), 2) << errors;
  for (const char* key : {"stage1.face_width_mm", "stage2.face_width_mm"}) {
    EXPECT_NE(errors.find(key), std::string::npos) << errors;
  }
}

TEST(StrengthKeys, TablesOfTheMeshLoadFactorBeginWithThreePlanets) {
  const std::string load = kSteel + kLoad;
  const std::string two = "planets = 2\n" + kGears + load;
  const std::string two_or_three = "planets = [2, 3]\n" + kSpec + kWidths + load;
  const std::string m56 = "k_gamma = \"m56\"\n";
  const std::string drivetrain = "k_gamma = \"drivetrain\"\n";
  expect_only(errors_of([&] { return parse_design(two + m56, "gear.toml"); }),
              "gear.toml:30:1: strength.k_gamma = \"m56\" with 2 planets: allowed: a number (the "
              "table begins with 3 planets)");
  expect_only(errors_of([&] { return parse_design(two + drivetrain, "gear.toml"); }),
              "gear.toml:30:1: strength.k_gamma = \"drivetrain\" with 2 planets: allowed");
  expect_only(errors_of([&] { return parse_specification(two_or_three + m56, "spec.toml"); }),
              "strength.k_gamma = \"m56\" with 2 planets: allowed: a number");
  expect_only(errors_of([&] {
                return parse_specification(
                    "planets = [3]\n" + kSpec + kWidths + load + "k_gamma = \"tolerances\"\n",
                    "spec.toml");
              }),
              "strength.k_gamma = \"tolerances\" without [tolerances]: allowed: with it");
  EXPECT_EQ(errors_of([&] {
              return parse_specification("planets = [3]\n" + kSpec + kWidths + load +
                                             "k_gamma = \"tolerances\"\n" + kTolerances,
                                         "spec.toml");
            }),
            "");
  EXPECT_EQ(design_errors(load + m56), "");
  EXPECT_EQ(design_errors(load + drivetrain), "");
  EXPECT_EQ(errors_of([&] { return parse_design(two + "k_gamma = 1.0\n", "g"); }), "");
}

TEST(StrengthKeys, OfAPairThatDoNotFitAreAnErrorEachAtItsPlace) {
  const std::string load = "[strength]\ntorque_nm = 302\n";
  const std::string steel = "material = \"34CrNiMo6 through hardened\"\n";
  const std::string width = "face_width_mm = 14\n";
  const auto errors = [](const std::string& rest, const std::string& first) {
    return errors_of([&] { return pair_of(rest, first); });
  };
  EXPECT_EQ(errors(load, steel + width), "");
  expect_only(errors(load, steel), "face_width_mm is missing, required by [strength]");
  expect_only(errors("[strength]\nk_a = 1\n", steel + width),
              "pair.toml:9:2: strength.torque_nm is missing, required by [strength]");
  expect_only(errors(load + "life_hours = 1\n", steel + width),
              "strength.life_hours without strength.speed_rpm");
  expect_only(errors(load + "k_gamma = \"m56\"\n", steel + width),
              "strength.k_gamma = \"m56\": allowed: a number, 1 to 1000");
  const std::string no_reversal = load + "load_reversal = false\ny_m = 0.9\n";
  expect_only(errors(no_reversal, steel + width),
              "strength.y_m without load reversal: allowed: with load_reversal = true of all gears "
              "or of one");
  EXPECT_EQ(errors(no_reversal + "[gear2.strength]\nload_reversal = true\n", steel + width), "");
  EXPECT_EQ(errors(load + "y_m = 0.9\n", steel + width), "");
  expect_only(errors(load + "[gear1.material]\nname = \"16MnCr5\"\n", width),
              "gear2.material is missing, required by [strength]");
}

TEST(StrengthKeys, AllErrorsAreToldAtOnce) {
  const std::string errors = design_errors(
      "[material]\nname = \"nodular cast iron ML MQ\"\nsigma_h_lim_mpa = 0\nhardness = 100\n"
      "group = \"Z\"\n"
      "[strength]\noutput_torque_nm = -1\ncycles = 0\ns_f_min = 0\ns_h_min = 0\nlife_hours = 5\n"
      "[bearings]\nplanet_positions_mm = [3, 3]\n");
  for (const char* part :
       {"material.sigma_h_lim_mpa = 0", "material.hardness = 100", "material.group = \"Z\"",
        "material.youngs_modulus_mpa is missing", "material.poisson_ratio is missing",
        "strength.output_torque_nm = -1", "strength.cycles = 0", "strength.s_f_min = 0",
        "strength.s_h_min = 0", "strength.cycles and strength.life_hours",
        "strength.life_hours without", "bearings.planet_positions_mm without",
        "both bearings are in one plane"}) {
    EXPECT_NE(errors.find(part), std::string::npos) << part << "\n" << errors;
  }
}

// Y_S of a sharp corner has no bound; the rack rounds what it generates, and so does a cutter.
TEST(StrengthKeys, ASharpCornerOfARatedRingIsRefused) {
  const std::string sharp = "[rack]\nroot_radius = 0.0\n";
  expect_only(design_errors(sharp + kSteel + kLoad),
              "gear.toml:26:1: rack.root_radius = 0 with [strength]: Y_S of a ring's sharp corner "
              "has no bound (stated for 1 <= q_s < 8): allowed: above 0, gears.R1.cutter.teeth and "
              "gears.R2.cutter.teeth of a cutter, or strength.virtual_root_radius");
  expect_only(design_errors("[gears.R1.cutter]\nteeth = 30\n" + sharp + kSteel + kLoad),
              "allowed: above 0, gears.R2.cutter.teeth of a cutter");
  expect_only(specification_errors(sharp + kWidths + kSteel + kLoad),
              "spec.toml:13:1: rack.root_radius = 0 with [strength]");
  const std::string pair =
      "kind = \"internal\"\nmodule_mm = 1.0\nface_width_mm = 8.0\n"
      "[gear1]\nteeth = 30\n[gear2]\nteeth = 80\n" +
      sharp + kSteel + "[strength]\ntorque_nm = 1.0\n";
  expect_only(errors_of([&] { return parse_pair(pair, "pair.toml"); }),
              "pair.toml:9:1: rack.root_radius = 0 with [strength]");
  const std::string cutters = "[gears.R1.cutter]\nteeth = 30\n[gears.R2.cutter]\nteeth = 30\n";
  EXPECT_EQ(design_errors(sharp), "") << "not rated";
  EXPECT_EQ(design_errors(cutters + sharp + kSteel + kLoad), "");
  EXPECT_EQ(design_errors(sharp + kSteel + kLoad + "virtual_root_radius = 0.0\n"), "");
  EXPECT_EQ(design_errors("[rack]\nroot_radius = 0.001\n" + kSteel + kLoad), "");
  EXPECT_EQ(errors_of([&] {
              return pair_of(sharp + kSteel + "[strength]\ntorque_nm = 1.0\n",
                             "face_width_mm = 8.0\n");
            }),
            "");
}

TEST(MaterialKeys, SimilarNamesAreTheClosestAndThoseThatShareWords) {
  EXPECT_EQ(similar_materials("POM C"), (std::vector<std::string>{"POM", "POM Delrin 100P"}));
  const auto steels = similar_materials("case hardened MQ");
  ASSERT_EQ(steels.size(), 3U);
  EXPECT_EQ(steels[0], "case hardened steel MQ");
  EXPECT_EQ(similar_materials("unobtainium").size(), 0U);
  EXPECT_EQ(similar_materials("").size(), 0U);
}

}  // namespace
}  // namespace gear3k::io::strength_keys_test
