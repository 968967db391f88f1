#include "app/analyze.hpp"

#include <gtest/gtest.h>

#include <string>

#include "io/files/design_file.hpp"
#include "io/files/model_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::app::analyze_test {
namespace {

design::Design bilateral() {
  return io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/bilateral_drive_gear.toml");
}

/// Friction that is half as much again as the design says, and a drag that needs an operating
/// point.
Model measured_model() {
  return model_of(
      io::parse_model("[transmission]\nname = \"another\"\n[transmission.range]\n"
                      "sun_speed_rpm = [200, 1000]\noutput_torque_nm = [5, 50]\n"
                      "temperature_c = [25, 45]\n[transmission.causes.drag_constant]\n"
                      "form = \"sun\"\nbody = \"sun\"\ntorque_nm = 0.01\ntorque_nm_sd = 0.001\n",
                      "model.toml"),
      "model.toml");
}

TEST(Analyze, IsTheEvaluationOfTheDesign) {
  const Analysis analysis = analyze({.design = bilateral()});
  EXPECT_EQ(analysis.evaluation.name, "bilateral drive gear");
  EXPECT_TRUE(analysis.evaluation.efficiency.backdrivable);
  EXPECT_FALSE(analysis.evaluation.operation);
  EXPECT_FALSE(analysis.series) << "no tolerances";
  EXPECT_TRUE(analysis.model_notes.empty());
}

TEST(Analyze, TakesAModelAtTheMiddleOfItsRangeAndSaysSo) {
  const Analysis analysis = analyze({.design = bilateral(), .model = measured_model()});
  ASSERT_TRUE(analysis.evaluation.operation);
  EXPECT_NEAR(analysis.evaluation.operation->point.output_torque_Nm, 27.5, 1e-9);
  ASSERT_EQ(analysis.model_notes.size(), 2U);
  EXPECT_EQ(analysis.model_notes[0],
            "model.toml: measured on \"another\", applied to \"bilateral drive gear\"");
  EXPECT_NE(analysis.model_notes[1].find("the middle of the model's range"), std::string::npos);
  EXPECT_EQ(analysis.evaluation.notes.back(), analysis.model_notes.back());
}

TEST(Analyze, NamesItsSourceWhereTheGeometryIsNotDefined) {
  design::Design design = bilateral();
  design.train.center_distance_m = 0.015;
  design.center_distance_given = true;
  try {
    analyze({.design = design, .source = "my gearbox"});
    FAIL() << "no exception";
  } catch (const io::InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()).find("my gearbox: "), 0U) << error.what();
  }
}

TEST(Mesh, IsTheEvaluationOfThePair) {
  const design::PairEvaluation pair =
      mesh({.pair = io::read_pair(GEAR3K_SOURCE_DIR "/examples/pair_internal.toml")});
  EXPECT_EQ(pair.gears.size(), 2U);
  EXPECT_GT(pair.mesh.contact_ratio, 1.0);
}

}  // namespace
}  // namespace gear3k::app::analyze_test
