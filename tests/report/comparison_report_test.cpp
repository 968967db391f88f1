// Designs side by side: what is told apart, and terms per output torque by other ways.

#include "report/comparison_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "io/files/design_file.hpp"

namespace gear3k::report::comparison_report_test {
namespace {

using Json = nlohmann::json;

design::Design example(const std::string& name) {
  return io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/" + name);
}

ComparedDesign compared(const design::Design& design, const std::string& label) {
  auto evaluation = std::get<design::Evaluation>(design::evaluate(design));
  const design::OutputTerms terms = design::output_terms(design, evaluation);
  return {.label = label, .file = label, .evaluation = std::move(evaluation), .terms = terms};
}

using Quantities = std::map<std::string, std::vector<Json>>;
Quantities quantities_of(const Json& json) {
  Quantities all;
  for (const Json& q : json.at("quantities")) {
    all[q.at("item").get<std::string>() + "," + q.at("quantity").get<std::string>()] =
        q.at("values").get<std::vector<Json>>();
  }
  return all;
}

TEST(OutputTerms, KeepThePlanetAndTheShaftsInBalance) {
  for (const char* name : {"bilateral_drive_gear.toml", "loaded.toml"}) {
    const design::Design design = example(name);
    const ComparedDesign one = compared(design, "one");
    const auto& e = one.evaluation;
    const auto base_mm = [&](std::size_t gear) { return 0.5e3 * e.gears[gear].base_diameter_m; };
    const auto& force = one.terms.tooth_force_per_torque_1_m;
    // Moments on a planet, G2 < 1, and the output's own, of all planets.
    EXPECT_NEAR(base_mm(train::kP1) * (force[1] - force[0]) / (base_mm(train::kP2) * force[2]), 1.0,
                1e-12);
    EXPECT_NEAR(force[2] * 1e-3 * base_mm(train::kR2) * e.planets, 1.0, 1e-12);
    // The sun's torque without losses is what the ratio says.
    EXPECT_NEAR(force[0] * 1e-3 * base_mm(train::kS) * e.planets * std::abs(e.ratio), 1.0, 1e-12);
    ASSERT_TRUE(one.terms.driving_torque_share && one.terms.friction_torque_share);
    EXPECT_NEAR(*one.terms.driving_torque_share - *one.terms.friction_torque_share,
                1.0 / std::abs(e.ratio), 1e-15);
    // Work: what the sun gives is what the output takes over the efficiency.
    EXPECT_NEAR(*one.terms.driving_torque_share * std::abs(e.ratio) * *e.efficiency.forward, 1.0,
                1e-12);
    EXPECT_NEAR(*one.terms.back_driven_torque_share * std::abs(e.ratio), *e.efficiency.backward,
                1e-12);
  }
}

TEST(OutputTerms, TakeTheOuterSurfaceWhereItIsStated) {
  design::Design design = example("bilateral_drive_gear.toml");
  EXPECT_NEAR(compared(design, "").terms.outer_diameter_m, 77.2e-3, 1e-12);  // roots of R1
  EXPECT_FALSE(compared(design, "").terms.outer_surface_stated);
  design.masses.ring1_outer_radius_m = 40e-3;
  design.masses.ring2_outer_radius_m = 41e-3;
  EXPECT_DOUBLE_EQ(compared(design, "").terms.outer_diameter_m, 82e-3);
  EXPECT_TRUE(compared(design, "").terms.outer_surface_stated);
}

TEST(Comparison, OfADesignWithItselfHasNoDifference) {
  const design::Design design = example("loaded.toml");
  const std::vector<ComparedDesign> same{compared(design, "a"), compared(design, "b")};
  const Json json = Json::parse(comparison_json(same));
  EXPECT_TRUE(json.at("quantities").empty());
  EXPECT_GT(json.at("alike"), 300);
  EXPECT_EQ(comparison_csv(same), "item,quantity,unit,a,b\n");
  EXPECT_NE(comparison_table(same).find("\n0 of "), std::string::npos);
}

// A wider stage 2 changes what hangs on its width, and nothing else.
TEST(Comparison, TellsWhatAChangedFaceWidthChanges) {
  const design::Design narrow = example("loaded.toml");
  design::Design wide = narrow;
  for (const std::size_t k : {1U}) {
    wide.masses.face_width_m[k] = 2.0 * *narrow.masses.face_width_m[k];
    wide.rating->face_width_m[k] = 2.0 * narrow.rating->face_width_m[k];
  }
  const std::vector<ComparedDesign> two{compared(narrow, "narrow"), compared(wide, "wide")};
  const Quantities all = quantities_of(Json::parse(comparison_json(two)));
  for (const char* alike :
       {"train,ratio", "S-P1,contact_ratio", "train,efficiency_backward", "S,mass",
        "P2-R2,tooth_force_per_output_torque", "P2,tip_diameter", "train,outer_diameter"}) {
    EXPECT_FALSE(all.contains(alike)) << alike;
  }
  ASSERT_TRUE(all.contains("P2,mass"));
  const auto& mass = all.at("P2,mass");
  EXPECT_NEAR(mass[1].get<double>() / mass[0].get<double>(), 2.0, 1e-9);
  ASSERT_TRUE(all.contains("train,output_stiffness"));
  EXPECT_GT(all.at("train,output_stiffness")[1], all.at("train,output_stiffness")[0]);
  const std::string table = comparison_table(two);
  EXPECT_NE(table.find("output stiffness"), std::string::npos);
  EXPECT_EQ(table.find("contact ratio  "), std::string::npos);
}

TEST(Comparison, KeepsAPlaceForWhatADesignLacks) {
  const std::vector<ComparedDesign> two{compared(example("bilateral_drive_gear.toml"), "bare"),
                                        compared(example("loaded.toml"), "loaded, 20 N m")};
  const Quantities all = quantities_of(Json::parse(comparison_json(two)));
  EXPECT_TRUE(all.at("train,torque_capacity")[0].is_null());
  EXPECT_NEAR(all.at("train,torque_capacity")[1].get<double>(), 40.3, 0.05);
  const std::string csv = comparison_csv(two);
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "item,quantity,unit,bare,\"loaded, 20 N m\"");
  EXPECT_NE(csv.find("\ntrain,torque_capacity,N m,,40."), std::string::npos);
  EXPECT_NE(comparison_table(two).find("none"), std::string::npos);
}

}  // namespace
}  // namespace gear3k::report::comparison_report_test
