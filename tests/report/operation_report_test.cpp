#include "report/operation_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "io/files/design_file.hpp"
#include "io/text/csv_table.hpp"
#include "report/analysis_report.hpp"

namespace gear3k::report::operation_report_test {
namespace {

design::Design lossy_gearbox() {
  return io::read_design(std::string(GEAR3K_SOURCE_DIR) +
                         "/examples/designs/ratio_96_with_losses.toml");
}

design::Evaluation evaluated(const design::Design& design) {
  return std::get<design::Evaluation>(design::evaluate(design));
}

nlohmann::json json_of(const design::Design& design) {
  return nlohmann::json::parse(analysis_json(evaluated(design), {}).text()).at("operating_point");
}

TEST(OperationReport, IsNullAndSilentWithoutAnOperatingPoint) {
  design::Design design = lossy_gearbox();
  design.operating_point.reset();
  EXPECT_TRUE(json_of(design).is_null());
  EXPECT_EQ(operation_table(evaluated(design)), "");
  EXPECT_EQ(analysis_csv(evaluated(design), {}).find("operating point"), std::string::npos);
}

TEST(OperationReport, FrictionByLawIsUndefinedWithoutAnOperatingPoint) {
  design::Design design = lossy_gearbox();
  design.operating_point.reset();
  const auto e = evaluated(design);
  EXPECT_FALSE(e.efficiency.forward.has_value());
  EXPECT_FALSE(e.efficiency.backward.has_value());
}

TEST(OperationReport, PrintsTheOperatingPointAsItWasStated) {
  const auto json = json_of(lossy_gearbox());
  EXPECT_EQ(json.at("sun_speed_rpm"), 1000.0);
  EXPECT_EQ(json.at("output_torque_nm"), 20.0);
  EXPECT_EQ(json.at("temperature_c"), 40.0);
}

TEST(OperationReport, InputPowerIsOutputPowerAndAllLosses) {
  const auto json = json_of(lossy_gearbox());
  const auto e = evaluated(lossy_gearbox());
  const double sun_speed = 1000.0 * std::acos(-1.0) / 30.0;
  for (const char* direction : {"forward", "backward"}) {
    const auto& d = json.at(direction);
    double losses = d.at("bearing_loss_w").get<double>();
    for (const auto& mesh : d.at("meshes")) losses += mesh.at("heat_w").get<double>();
    for (const auto& shaft : d.at("drag_loss_w")) losses += shaft.get<double>();
    const double sun = d.at("sun_torque_nm").get<double>() * sun_speed;
    const double output = d.at("output_torque_nm").get<double>() * sun_speed / std::abs(e.ratio);
    const double lost = direction == std::string("forward") ? sun - output : output - sun;
    EXPECT_NEAR(d.at("loss_w").get<double>(), losses, 1e-12 * output);
    EXPECT_NEAR(lost, losses, 1e-11 * output);
  }
}

TEST(OperationReport, CsvHoldsTheNumbersOfTheJson) {
  const auto json = json_of(lossy_gearbox());
  const io::CsvTable table = io::parse_csv(
      kRowsHeader + operating_point_fields(*evaluated(lossy_gearbox()).operation).csv_rows(),
      "analysis.csv");
  std::map<std::string, double> csv;
  for (const auto& row : table.rows) {
    csv[table.text(row, "item").value() + "/" + table.text(row, "quantity").value()] =
        table.number(row, "value").value();
  }
  for (const std::string direction : {"forward", "backward"}) {
    const auto& d = json.at(direction);
    const std::string item = "operating point " + direction + "/";
    EXPECT_EQ(csv.at(item + "sun_torque"), d.at("sun_torque_nm"));
    EXPECT_EQ(csv.at(item + "efficiency"), d.at("efficiency"));
    EXPECT_EQ(csv.at(item + "loss"), d.at("loss_w"));
    EXPECT_EQ(csv.at(item + "heat P1-R1"), d.at("meshes").at(1).at("heat_w"));
    EXPECT_EQ(csv.at(item + "drag_loss carrier"), d.at("drag_loss_w").at("carrier"));
    EXPECT_EQ(csv.at(item + "bearing_loss"), d.at("bearing_loss_w"));
  }
}

TEST(OperationReport, HelpedSunIsNegativeAndSaidSo) {
  design::Design design = lossy_gearbox();
  design.shafts.drag[design::kSunShaft].constant_Nm = 1.0;
  const auto backward = json_of(design).at("backward");
  EXPECT_LT(backward.at("sun_torque_nm").get<double>(), 0.0);
  EXPECT_LT(backward.at("efficiency").get<double>(), 0.0);
  EXPECT_NE(operation_table(evaluated(design)).find("(helps)"), std::string::npos);
}

TEST(OperationReport, NoContactIsTheReasonAndIsNoted) {
  design::Design design = lossy_gearbox();
  design.train.center_distance_m = 22.6e-3;
  const auto e = evaluated(design);
  ASSERT_LT(e.meshes[train::kMeshSP1].contact_ratio, 0.0);
  const auto json = json_of(design);
  for (const char* direction : {"forward", "backward"}) {
    EXPECT_EQ(json.at(direction).at("runs"), false);
    EXPECT_EQ(json.at(direction).at("reason"), "a mesh has no contact");
  }
  EXPECT_FALSE(e.efficiency.forward.has_value());
  EXPECT_NE(analysis_table(e, {}).find("driven forward: a mesh has no contact"), std::string::npos);
}

}  // namespace
}  // namespace gear3k::report::operation_report_test
