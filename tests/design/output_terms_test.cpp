// Terms per torque at the output, by balances of planet, output and sun.

#include "design/output_terms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "io/files/design_file.hpp"

namespace gear3k::design::output_terms_test {
namespace {

Design example(const std::string& name) {
  return io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/" + name);
}

Evaluation evaluated(const Design& design) { return std::get<Evaluation>(evaluate(design)); }

OutputTerms terms_of(const Design& design) { return output_terms(design, evaluated(design)); }

TEST(OutputTerms, KeepThePlanetAndTheShaftsInBalance) {
  for (const char* name : {"bilateral_drive_gear.toml", "loaded.toml"}) {
    const Design design = example(name);
    const Evaluation e = evaluated(design);
    const OutputTerms terms = output_terms(design, e);
    const auto base_m = [&](std::size_t gear) { return 0.5 * e.gears[gear].base_diameter_m; };
    const auto& force = terms.tooth_force_per_torque_1_m;
    // Moments on a planet, G2 < 1, and the output's own, of all planets.
    EXPECT_NEAR(base_m(train::kP1) * (force[1] - force[0]) / (base_m(train::kP2) * force[2]), 1.0,
                1e-12);
    EXPECT_NEAR(force[2] * base_m(train::kR2) * e.planets, 1.0, 1e-12);
    // The sun's torque without losses is what the ratio says.
    EXPECT_NEAR(force[0] * base_m(train::kS) * e.planets * std::abs(e.ratio), 1.0, 1e-12);
    ASSERT_TRUE(terms.driving_torque_share && terms.friction_torque_share);
    EXPECT_NEAR(*terms.driving_torque_share - *terms.friction_torque_share, 1.0 / std::abs(e.ratio),
                1e-15);
    // Work: what the sun gives is what the output takes over the efficiency.
    EXPECT_NEAR(*terms.driving_torque_share * std::abs(e.ratio) * *e.efficiency.forward, 1.0,
                1e-12);
    EXPECT_NEAR(*terms.back_driven_torque_share * std::abs(e.ratio), *e.efficiency.backward, 1e-12);
  }
}

TEST(OutputTerms, TakeTheOuterSurfaceWhereItIsStated) {
  Design design = example("bilateral_drive_gear.toml");
  EXPECT_NEAR(terms_of(design).outer_diameter_m, 77.2e-3, 1e-12);  // root of R1
  EXPECT_FALSE(terms_of(design).outer_surface_stated);
  design.masses.ring1_outer_radius_m = 40e-3;
  design.masses.ring2_outer_radius_m = 41e-3;
  EXPECT_DOUBLE_EQ(terms_of(design).outer_diameter_m, 82e-3);
  EXPECT_TRUE(terms_of(design).outer_surface_stated);
}

}  // namespace
}  // namespace gear3k::design::output_terms_test
