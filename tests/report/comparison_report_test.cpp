// Designs side by side: what is told apart.

#include "report/comparison_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
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
  EXPECT_NE(table.find("output stiffness at rated output torque"), std::string::npos);
  // Without bodies of carrier and rings the gears' own density is not known either.
  EXPECT_EQ(table.find("torque density"), std::string::npos);
  EXPECT_EQ(table.find("contact ratio  "), std::string::npos);
}

// Of rings with rims the mass of the gears is known: theirs is the density, m_S + N m_P + m_R.
TEST(Comparison, HasTheTorqueDensityOfTheGears) {
  design::Design rimmed = example("loaded.toml");
  rimmed.masses.ring1_outer_radius_m = 0.5 * 84e-3;
  rimmed.masses.ring2_outer_radius_m = 0.5 * 84e-3;
  design::Design heavy = rimmed;
  heavy.masses.ring1_outer_radius_m = 0.5 * 90e-3;
  const std::vector<ComparedDesign> two{compared(rimmed, "thin"), compared(heavy, "thick")};
  const Quantities all = quantities_of(Json::parse(comparison_json(two)));
  ASSERT_TRUE(all.contains("train,gears_torque_density"));
  const auto& density = all.at("train,gears_torque_density");
  for (std::size_t k = 0; k < 2; ++k) {
    const design::Evaluation& e = two[k].evaluation;
    double mass_kg = 0.0;
    for (const design::PartMass& part : e.parts) {
      const bool gear = std::ranges::find(train::kGearNames, part.name) != train::kGearNames.end();
      if (gear) mass_kg += part.count * part.mass_kg.value();
    }
    const double capacity_Nm = e.strength->least_capacity()->capacity.torque_Nm;
    EXPECT_NEAR(density[k].get<double>(), capacity_Nm / mass_kg, 1e-9 * capacity_Nm / mass_kg);
  }
  EXPECT_NE(comparison_table(two).find("gears torque density"), std::string::npos);
}

TEST(Comparison, FitsTheColumnsOfTheScreen) {
  const std::vector<ComparedDesign> all{
      compared(example("bilateral_drive_gear.toml"), "in the envelope of another gearbox"),
      compared(example("loaded.toml"), "a design with a name of many words 12/64/141/52/132"),
      compared(example("low_backlash_prototype.toml"), "prototype"),
      compared(example("ratio_96_tolerances.toml"), "tolerances"),
      compared(example("loaded.toml"), "again"),
      compared(example("loaded.toml"), "and again"),
      compared(example("bilateral_drive_gear.toml"), "and the first once more")};
  for (const std::size_t count : {2U, 3U, 5U, 7U}) {
    for (const std::size_t columns : {80U, 100U, 120U, 400U}) {
      const std::string table = comparison_table({all.data(), count}, static_cast<int>(columns));
      std::istringstream lines(table);
      std::size_t longest = 0;
      for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
      EXPECT_LE(longest, columns) << count << '\n' << table;
      EXPECT_NE(table.find("\nB  a design with a name"), std::string::npos);
      // Every design has a column in some table.
      for (std::size_t k = 0; k < count; ++k) {
        EXPECT_NE(table.find(std::string("  ") + static_cast<char>('A' + k)), std::string::npos);
      }
      EXPECT_NE(table.find("0.951284"), std::string::npos);
    }
  }
}

// Inertia of a small sun is 1e-12 kg m²: still told apart.
TEST(Comparison, TellsSmallMassesApart) {
  design::Design solid = example("loaded.toml");
  for (double& m : solid.train.module_m) m *= 0.1;
  solid.train.center_distance_m *= 0.1;
  design::Design bored = solid;
  bored.masses.bore_radius_m[train::kS] = 0.1e-3;
  const std::vector<ComparedDesign> two{compared(solid, "solid"), compared(bored, "bored")};
  const Quantities all = quantities_of(Json::parse(comparison_json(two)));
  ASSERT_TRUE(all.contains("S,inertia"));
  EXPECT_LT(all.at("S,inertia")[0].get<double>(), 1e-11);
  EXPECT_LT(all.at("S,inertia")[1], all.at("S,inertia")[0]);
}

// What passes may miss its limit by rounding, which no reader takes for a failure.
TEST(Comparison, ShowsNoNegativeMarginOfACheckThatPasses) {
  std::vector<ComparedDesign> two{compared(example("loaded.toml"), "a"),
                                  compared(example("loaded.toml"), "b")};
  for (auto& check : two[1].evaluation.checks) {
    check.ok = true;
    check.margin = -1e-17;
  }
  const std::string text = comparison_table(two);
  const std::size_t margins = text.find("Margins of checks");
  ASSERT_NE(margins, std::string::npos);
  EXPECT_EQ(text.find("e-1", margins), std::string::npos) << text.substr(margins);
}

TEST(Comparison, ShowsNoBacklashThatIsTheRoundingOfPositions) {
  std::vector<ComparedDesign> two{compared(example("loaded.toml"), "a"),
                                  compared(example("loaded.toml"), "b")};
  two[0].evaluation.meshes[1].normal_backlash_m = 1.38778e-17;
  two[1].evaluation.meshes[1].normal_backlash_m = 12e-6;
  const std::string text = comparison_table(two);
  const std::size_t row = text.find("normal backlash");
  ASSERT_NE(row, std::string::npos) << text;
  const std::string line = text.substr(row, text.find('\n', row) - row);
  EXPECT_EQ(line.find("e-"), std::string::npos) << line;
  EXPECT_NE(line.find(" 0 "), std::string::npos) << line;
  EXPECT_NE(line.find(" 12"), std::string::npos) << line;
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

TEST(Comparison, ListsATightMarginWhoseLimitIsNothing) {
  std::vector<ComparedDesign> two{compared(example("loaded.toml"), "a"),
                                  compared(example("loaded.toml"), "b")};
  const auto margins = [&](double margin) {
    for (ComparedDesign& one : two) {
      for (auto& check : one.evaluation.checks) {
        check.ok = true;
        check.limit = 0.0;
        check.margin =
            check.record->id == design::CheckId::kUndercut && &one == &two[0] ? margin : 1e3;
      }
    }
    const std::string text = comparison_table(two);
    return text.find("Margins of checks") != std::string::npos;
  };
  EXPECT_TRUE(margins(0.01));
  EXPECT_FALSE(margins(0.2));
}

TEST(Comparison, SpeaksOfTheRimsOfOneAndOfSeveral) {
  const design::Design bare = example("loaded.toml");
  design::Design rims = bare;
  rims.masses.ring1_outer_radius_m = 0.05;
  rims.masses.ring2_outer_radius_m = 0.05;
  const std::vector<ComparedDesign> one{compared(bare, "a"), compared(rims, "c")};
  EXPECT_NE(comparison_table(one).find("stated of a: its outer diameter is"), std::string::npos);
  const std::vector<ComparedDesign> two{compared(bare, "a"), compared(bare, "b"),
                                        compared(rims, "c")};
  EXPECT_NE(comparison_table(two).find("stated of a, b: the outer diameter of each is"),
            std::string::npos);
}

}  // namespace
}  // namespace gear3k::report::comparison_report_test
