#include "report/mass_report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace gear3k::report::mass_report_test {
namespace {

using design::Evaluation, design::MassOrigin, design::PartMass;

/// Three parts, of which the last is not known.
Evaluation three_parts() {
  Evaluation e{};
  e.parts = {PartMass{.name = "S",
                      .count = 1,
                      .mass_kg = 0.0625,
                      .inertia_kgm2 = 0.5,
                      .mass_origin = MassOrigin::kGeometry,
                      .inertia_origin = MassOrigin::kStated},
             PartMass{.name = "planet",
                      .count = 3,
                      .mass_kg = 0.25,
                      .inertia_kgm2 = {},
                      .mass_origin = MassOrigin::kStated},
             PartMass{.name = "R1", .count = 1, .mass_kg = {}, .inertia_kgm2 = {}}};
  e.total_mass_missing = "R1 (its rim)";
  return e;
}

TEST(MassReport, JsonHoldsEveryPartWithNullForWhatIsNotKnown) {
  const auto expected = nlohmann::json::parse(R"({"masses": [
    {"name": "S", "count": 1, "mass_kg": 0.0625, "mass_from": "geometry",
     "inertia_kgm2": 0.5, "inertia_from": "stated"},
    {"name": "planet", "count": 3, "mass_kg": 0.25, "mass_from": "stated",
     "inertia_kgm2": null, "inertia_from": null},
    {"name": "R1", "count": 1, "mass_kg": null, "mass_from": null,
     "inertia_kgm2": null, "inertia_from": null}],
    "total_mass_kg": null})");
  EXPECT_EQ(nlohmann::json::parse(mass_fields(three_parts()).json().text()), expected);
  Evaluation complete = three_parts();
  complete.total_mass_kg = 1.5;
  EXPECT_EQ(mass_fields(complete).json().at("total_mass_kg").text(), "1.5\n");
}

TEST(MassReport, CsvHoldsWhatIsKnown) {
  Evaluation e = three_parts();
  EXPECT_EQ(mass_fields(e).csv_rows(),
            "S,count,1,,,\nS,mass,0.0625,kg,,\nS,inertia,0.5,kg m2,,\n"
            "planet,count,3,,,\nplanet,mass,0.25,kg,,\n");
  e.total_mass_kg = 1.5;
  EXPECT_NE(mass_fields(e).csv_rows().find("train,mass,1.5,kg,,\n"), std::string::npos);
}

TEST(MassReport, TableLeavesOutWhatIsNotKnownAndSaysWhatTheTotalLacks) {
  Evaluation e = three_parts();
  const std::string text = mass_table(e);
  EXPECT_NE(text.find("\nMasses ("), std::string::npos) << text;
  EXPECT_NE(text.find("planet"), std::string::npos) << text;
  EXPECT_EQ(text.find("\n  R1"), std::string::npos) << text;
  EXPECT_NE(text.find("all parts: not known: lacks R1 (its rim)"), std::string::npos) << text;
  e.total_mass_kg = 1.5;
  EXPECT_NE(mass_table(e).find("all parts: 1.5 kg"), std::string::npos);
}

TEST(MassReport, NothingKnownIsNoTable) {
  Evaluation e{};
  EXPECT_EQ(mass_table(e), "");
  e.parts = {PartMass{.name = "S", .count = 1, .mass_kg = {}, .inertia_kgm2 = {}}};
  EXPECT_EQ(mass_table(e), "");
  EXPECT_EQ(mass_fields(e).csv_rows(), "");
}

}  // namespace
}  // namespace gear3k::report::mass_report_test
