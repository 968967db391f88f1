#include "io/keys/mass_keys.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io::mass_keys_test {
namespace {

const std::string kGears =
    "[stage1]\nmodule_mm = 0.8\nface_width_mm = 8.0\n"
    "[stage2]\nmodule_mm = 0.8467\nface_width_mm = 9.0\n"
    "[gears]\n"
    "S = { teeth = 12, profile_shift = 0.476 }\n"
    "P1 = { teeth = 39, profile_shift = 0.762, bore_mm = 8.0 }\n"
    "R1 = { teeth = 90, profile_shift = 2.0, outer_diameter_mm = 86.0 }\n"
    "P2 = { teeth = 32, profile_shift = 0.536, bore_mm = 7.0 }\n"
    "R2 = { teeth = 81, profile_shift = 1.21, outer_diameter_mm = 80.0 }\n";
const std::string kPlates = "carrier_outer_diameter_mm = 56.0\ncarrier_thickness_mm = 8.0\n";
const std::string kPins = "pin_diameter_mm = 6.0\npin_length_mm = 19.0\n";

std::string design_with(const std::string& inertia, const std::string& gears = kGears) {
  return gears + "[inertia]\n" + inertia;
}

design::Masses masses_of(const std::string& text) { return parse_design(text, "gear.toml").masses; }

/// What is wrong with a design; "" when nothing is.
std::string errors_of(const std::string& text) {
  try {
    static_cast<void>(masses_of(text));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

void expect_error(const std::string& text, const std::string& message) {
  const std::string errors = errors_of(text);
  EXPECT_NE(errors.find(message), std::string::npos) << "got: " << errors;
}

TEST(MassKeys, SizesBecomeRadiiAndLengthsInMetres) {
  const auto m =
      masses_of(design_with("density_kg_m3 = 7850.0\ncarrier_density_kg_m3 = 2700.0\n"
                            "carrier_bore_mm = 20.0\n" +
                            kPlates + kPins));
  EXPECT_DOUBLE_EQ(m.carrier_outer_radius_m.value(), 0.028);
  EXPECT_DOUBLE_EQ(m.carrier_bore_radius_m.value(), 0.010);
  EXPECT_DOUBLE_EQ(m.carrier_thickness_m.value(), 0.008);
  EXPECT_DOUBLE_EQ(m.carrier_density_kgm3.value(), 2700.0);
  EXPECT_DOUBLE_EQ(m.planet_pin_radius_m.value(), 0.003);
  EXPECT_DOUBLE_EQ(m.planet_pin_length_m.value(), 0.019);
  EXPECT_DOUBLE_EQ(m.ring1_outer_radius_m.value(), 0.043);
  EXPECT_DOUBLE_EQ(m.ring2_outer_radius_m.value(), 0.040);
}

TEST(MassKeys, AreAllOptional) {
  EXPECT_EQ(errors_of(kGears), "");
  EXPECT_EQ(errors_of(design_with("density_kg_m3 = 7850.0\n" + kPlates)), "");
  EXPECT_EQ(errors_of(design_with("density_kg_m3 = 7850.0\n" + kPins)), "");
  EXPECT_EQ(errors_of(design_with("carrier_density_kg_m3 = 2700.0\n" + kPlates)), "");
  const auto m = masses_of(kGears);
  for (const Key<design::Masses>& key : mass_keys()) {
    EXPECT_FALSE(key.state(key.record, m, 0)) << key.record.path;
  }
}

TEST(MassKeys, DesignTextKeepsEverySize) {
  const auto d = parse_design(design_with("density_kg_m3 = 7850.0\ncarrier_density_kg_m3 = 2711.3\n"
                                          "carrier_bore_mm = 20.7\ncarrier_thickness_mm = 8.31\n"
                                          "carrier_outer_diameter_mm = 56.17\n"
                                          "pin_diameter_mm = 6.03\npin_length_mm = 19.9\n"),
                              "gear.toml");
  const std::string text = design_text(d);
  const auto again = parse_design(text, "best.toml");
  EXPECT_EQ(d.masses.carrier_outer_radius_m.value(), again.masses.carrier_outer_radius_m);
  EXPECT_EQ(d.masses.carrier_bore_radius_m.value(), again.masses.carrier_bore_radius_m);
  EXPECT_EQ(d.masses.carrier_thickness_m.value(), again.masses.carrier_thickness_m);
  EXPECT_EQ(d.masses.carrier_density_kgm3.value(), again.masses.carrier_density_kgm3);
  EXPECT_EQ(d.masses.planet_pin_radius_m.value(), again.masses.planet_pin_radius_m);
  EXPECT_EQ(d.masses.planet_pin_length_m.value(), again.masses.planet_pin_length_m);
  EXPECT_DOUBLE_EQ(again.masses.ring1_outer_radius_m.value(), 0.043);
}

TEST(MassKeys, StatedCarrierInertiaExcludesItsGeometry) {
  const std::string stated = "density_kg_m3 = 7850.0\ncarrier_kgm2 = 1e-5\n";
  EXPECT_EQ(errors_of(design_with(stated)), "");
  expect_error(design_with(stated + kPlates),
               "gear.toml:16:1: inertia.carrier_outer_diameter_mm and inertia.carrier_kgm2");
  expect_error(design_with(stated + kPlates),
               "gear.toml:17:1: inertia.carrier_thickness_mm and inertia.carrier_kgm2");
  expect_error(design_with(stated + kPins),
               "gear.toml:16:1: inertia.pin_diameter_mm and inertia.carrier_kgm2");
}

TEST(MassKeys, PairsOfSizesAreStatedTogether) {
  const std::string density = "density_kg_m3 = 7850.0\n";
  expect_error(design_with(density + "carrier_outer_diameter_mm = 56.0\n"),
               "gear.toml:15:1: inertia.carrier_outer_diameter_mm without "
               "inertia.carrier_thickness_mm: allowed: both or neither");
  expect_error(design_with(density + "carrier_thickness_mm = 8.0\n"),
               "inertia.carrier_thickness_mm without inertia.carrier_outer_diameter_mm: allowed: "
               "both or neither");
  expect_error(design_with(density + "carrier_bore_mm = 8.0\n"),
               "inertia.carrier_bore_mm without inertia.carrier_outer_diameter_mm");
  expect_error(design_with(density + "carrier_density_kg_m3 = 2700.0\n"),
               "inertia.carrier_density_kg_m3 without inertia.carrier_outer_diameter_mm");
  expect_error(design_with(density + "pin_diameter_mm = 6.0\n"),
               "inertia.pin_diameter_mm without inertia.pin_length_mm: allowed: both or neither");
  expect_error(design_with(density + "pin_length_mm = 6.0\n"),
               "inertia.pin_length_mm without inertia.pin_diameter_mm: allowed: both or neither");
}

TEST(MassKeys, SizesNeedADensity) {
  expect_error(design_with(kPlates),
               "inertia.carrier_outer_diameter_mm without inertia.density_kg_m3: allowed: with it "
               "or with carrier_density_kg_m3");
  expect_error(design_with("carrier_density_kg_m3 = 2700.0\n" + kPlates + kPins),
               "inertia.pin_diameter_mm without inertia.density_kg_m3: allowed: with it or with "
               "pin_density_kg_m3");
  EXPECT_EQ(errors_of(design_with("pin_density_kg_m3 = 7800.0\n" + kPins)), "");
  expect_error(design_with("pin_density_kg_m3 = 7800.0\n"),
               "inertia.pin_density_kg_m3 without inertia.pin_diameter_mm: allowed: with it");
}

TEST(MassKeys, CarrierBoreIsBelowItsOuterDiameter) {
  const std::string start = "density_kg_m3 = 7850.0\n" + kPlates;
  EXPECT_EQ(errors_of(design_with(start + "carrier_bore_mm = 55.9\n")), "");
  for (const char* bore : {"56.0", "60.0"}) {
    expect_error(design_with(start + "carrier_bore_mm = " + bore + "\n"),
                 "gear.toml:17:1: inertia.carrier_bore_mm = ");
  }
  expect_error(design_with(start + "carrier_bore_mm = 60.0\n"),
               "= 60: allowed: below inertia.carrier_outer_diameter_mm = 56");
}

TEST(MassKeys, PinsFitTheStatedBoresOfThePlanets) {
  const std::string start = "density_kg_m3 = 7850.0\npin_length_mm = 19.0\n";
  EXPECT_EQ(errors_of(design_with(start + "pin_diameter_mm = 7.0\n")), "");
  const std::string p2_only = errors_of(design_with(start + "pin_diameter_mm = 7.5\n"));
  EXPECT_NE(p2_only.find("gear.toml:16:1: inertia.pin_diameter_mm = 7.5: allowed: at most "
                         "gears.P2.bore_mm = 7"),
            std::string::npos)
      << p2_only;
  EXPECT_EQ(p2_only.find("P1"), std::string::npos) << p2_only;
  std::string gears = kGears;
  const std::string bore = ", bore_mm = 7.0";
  gears.erase(gears.find(bore), bore.size());
  EXPECT_EQ(errors_of(design_with(start + "pin_diameter_mm = 7.5\n", gears)), "");
}

TEST(MassKeys, RangesAreStated) {
  expect_error(design_with("carrier_thickness_mm = 0.0\n"),
               "inertia.carrier_thickness_mm = 0.0: allowed: a number in mm, above 0 to 10000");
  expect_error(design_with("pin_diameter_mm = -1.0\n"), "inertia.pin_diameter_mm = -1.0: allowed");
  expect_error(design_with("carrier_bore_mm = -1.0\n"),
               "inertia.carrier_bore_mm = -1.0: allowed: a number in mm, 0 to 10000");
  expect_error(design_with("pin_lenght_mm = 1.0\n"), "did you mean inertia.pin_length_mm");
}

TEST(MassKeys, RimOfTheRestingRingLiesOutsideItsTeeth) {
  std::string gears = kGears;
  const std::string outer = "outer_diameter_mm = 86.0";
  gears.replace(gears.find(outer), outer.size(), "outer_diameter_mm = 70.0");
  expect_error(gears, "gears.R1.outer_diameter_mm = 70: allowed: above the root diameter");
}

}  // namespace
}  // namespace gear3k::io::mass_keys_test
