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

/// The models have no range, and with it no point in its middle.
TEST(Analyze, FrictionByMeshNeedsNoOperatingPoint) {
  const auto with = [](const std::string& causes) {
    const Model model = model_of(io::parse_model(causes, "model.toml"), "model.toml");
    return analyze({.design = bilateral(), .model = model}).evaluation;
  };
  const std::string all =
      "[transmission.causes.friction_level]\nform = \"coefficient\"\nrelative_change = 0.2\n";
  const std::string rings =
      "[transmission.causes.friction_level]\nform = \"by_mesh\"\nrelative_change = 0.0\n"
      "relative_change_of_rings = 0.2\n";
  const auto driving = [](const std::string& side) {
    return "[transmission.causes.friction_direction]\nform = \"driving_" + side +
           "\"\nasymmetry = 0.2\n";
  };
  const auto worse = with(all);
  ASSERT_FALSE(worse.operation);
  const auto by_rings = with(rings);
  const auto inner = with(driving("inner"));
  const auto outer = with(driving("outer"));
  for (const auto& e : {by_rings, inner, outer}) {
    EXPECT_FALSE(e.operation);
    ASSERT_TRUE(e.efficiency.forward && e.efficiency.backward);
  }
  int inner_ones = 0;
  for (std::size_t k = 0; k < worse.meshes.size(); ++k) {
    const auto plain = analyze({.design = bilateral()}).evaluation.meshes[k];
    EXPECT_EQ(by_rings.meshes[k].friction_forward,
              k == train::kMeshSP1 ? plain.friction_forward : worse.meshes[k].friction_forward);
    // The sun drives forward; of P1-R1 and P2-R2 the planets of just one.
    const bool is_inner = inner.meshes[k].friction_forward == worse.meshes[k].friction_forward;
    inner_ones += is_inner ? 1 : 0;
    EXPECT_TRUE(is_inner || k != train::kMeshSP1);
    EXPECT_EQ(is_inner, outer.meshes[k].friction_forward == plain.friction_forward);
    EXPECT_EQ(is_inner, inner.meshes[k].friction_backward == plain.friction_backward);
  }
  EXPECT_EQ(inner_ones, 2);
}

design::Design loaded_example() {
  return io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/loaded.toml");
}

/// The note that holds a text; "" without one.
std::string note_with(const design::Evaluation& e, const std::string& text) {
  for (const std::string& note : e.notes) {
    if (note.find(text) != std::string::npos) return note;
  }
  return "";
}

TEST(Analyze, ATrainThatTurnsBackwardOnlyWithTheSunsHelpIsNoted) {
  design::Design d =
      io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/low_backlash_prototype.toml");
  d.rating = loaded_example().rating;
  int helped = 0, alone = 0;
  for (double mu = 0.03; mu < 1.5; mu += 0.06) {
    d.friction.coefficient = mu;
    const design::Evaluation e = analyze({.design = d}).evaluation;
    const bool locked = e.strength.value().backward.locked;
    EXPECT_FALSE(e.efficiency.backdrivable && locked) << mu;
    EXPECT_FALSE(e.strength->forward.locked) << mu;
    const bool needs_help = !e.efficiency.backdrivable && !locked;
    EXPECT_EQ(!note_with(e, "while the sun helps").empty(), needs_help) << mu;
    ++(needs_help ? helped : alone);
  }
  EXPECT_GT(helped, 5);
  EXPECT_GT(alone, 5);
}

TEST(Analyze, AGearShorterThanItsFaceWidthIsNoted) {
  design::Design d = loaded_example();
  EXPECT_EQ(note_with(analyze({.design = d}).evaluation, "mm long"), "");
  d.axial.extent[train::kP1] = {.from_m = 1e-3, .to_m = 8e-3};
  EXPECT_EQ(note_with(analyze({.design = d}).evaluation, "mm long"),
            "axial.P1_mm is 7 mm long, stage1.face_width_mm 8 mm: masses and strength have the "
            "face width");
  d.axial.extent[train::kP1] = {.from_m = -1e-3, .to_m = 8e-3};
  EXPECT_EQ(note_with(analyze({.design = d}).evaluation, "mm long"), "");
}

TEST(Analyze, ATorqueFarFromThatOfTheOperatingPointIsNoted) {
  design::Design d = loaded_example();
  const double rated_Nm = d.rating.value().torque_Nm;
  for (const double share : {0.0, 0.49, 0.5, 1.0, 1.01}) {
    d.operating_point = {.sun_speed_rad_s = 100.0, .output_torque_Nm = share * rated_Nm};
    const bool far = share < 0.5 || share > 1.0;
    EXPECT_EQ(
        !note_with(analyze({.design = d}).evaluation, "[strength] rates 20 N m at R2").empty(), far)
        << share;
  }
  d.operating_point.reset();
  EXPECT_EQ(note_with(analyze({.design = d}).evaluation, "[strength] rates"), "");
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
