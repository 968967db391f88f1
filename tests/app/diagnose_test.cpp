#include "app/diagnose.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "io/files/model_file.hpp"
#include "io/files/subject_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::app::diagnose_test {
namespace {

DiagnoseRequest bilateral_request() {
  return {
      .subject = io::read_subject(GEAR3K_SOURCE_DIR "/examples/designs/bilateral_drive_gear.toml"),
      .source = "gear.toml",
      .data = io::read_measurements(
          {GEAR3K_SOURCE_DIR "/examples/measurements/published_bilateral_drive_gear.csv"})};
}

TEST(Diagnose, NamesTheGearboxAndCompletesTheModel) {
  const DiagnosisTask task = diagnosis_task(bilateral_request());
  ASSERT_EQ(task.sets.size(), 1U);
  EXPECT_EQ(task.subject, "bilateral drive gear");
  EXPECT_FALSE(task.orders.empty());
  const auto results = diagnose(task, {});
  ASSERT_TRUE(results);
  ASSERT_EQ(results->size(), 1U);
  const calibrate::Diagnosis& result = results->front();
  EXPECT_EQ(result.subject, task.subject);
  EXPECT_EQ(result.model.name, task.subject);
  EXPECT_EQ(result.model.verdict, result.verdict);
  EXPECT_EQ(result.rows.size(), task.sets.front().rows.size());
}

// A gearbox that loses 10 % forward and 11.3 % backward, whatever the load, measured at 2 to 6 N m:
// more than one cause explains it, and great torques tell them apart best.
io::Measurements losses_that_follow_the_load() {
  std::string text =
      "# kind: transmission\n"
      "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm,sigma_nm\n";
  constexpr double kRatio = 5967.0 / 62.0;
  for (int row = 0; row < 20; ++row) {
    const bool forward = row % 2 == 0;
    const double output_Nm = 2.0 + row / 2 % 5;
    const double noise_Nm = 1e-4 * (row * 7 % 11 - 5);
    text += fmt::format("{},500,{},{:.8f},3e-4\n", forward ? "forward" : "backward", output_Nm,
                        output_Nm / kRatio * (forward ? 1.0 / 0.9 : 0.887) + noise_Nm);
  }
  return io::parse_measurements({{"losses.csv", text}});
}

double greatest_output_torque_Nm(const calibrate::Diagnosis& result) {
  double most_Nm = 0.0;
  for (const auto& condition : result.next_experiment.value().conditions) {
    most_Nm = std::max(most_Nm, condition.condition.output_torque_Nm);
  }
  return most_Nm;
}

TEST(Diagnose, TheNextExperimentDoesNotLoadTheGearboxBeyondWhatItIsToCarry) {
  DiagnoseRequest request = bilateral_request();
  request.data = losses_that_follow_the_load();
  const auto most_Nm = [&](std::optional<double> rated_Nm, std::optional<double> stated_Nm) {
    auto& design = std::get<design::Design>(request.subject);
    design.rating.reset();
    if (rated_Nm) design.rating.emplace().torque_Nm = *rated_Nm;
    DiagnoseSettings settings;
    settings.output_torque_Nm.greatest = stated_Nm;
    const auto results = diagnose(diagnosis_task(request), settings);
    return greatest_output_torque_Nm(results.value().front());
  };
  EXPECT_NEAR(most_Nm({}, {}), 7.5, 1e-9) << "nobody states what it carries, the data have 6 N m";
  EXPECT_GT(most_Nm({}, 50.0), 30.0) << "as the user states";
  auto& map = std::get<design::Design>(request.subject).map;
  map.output_torque_Nm.to = 40.0;
  EXPECT_GT(most_Nm({}, {}), 30.0) << "to the end of the stated map";
  EXPECT_LE(most_Nm(9.0, {}), 9.0);
  EXPECT_LE(most_Nm(4.0, {}), 6.0) << "the data have 6 N m";
  EXPECT_GT(most_Nm(9.0, 20.0), 9.0) << "as the user states";
}

TEST(Diagnose, EndsWhenAsked) {
  const DiagnosisTask task = diagnosis_task(bilateral_request());
  DiagnoseSettings settings;
  settings.progress = [](double) { return false; };
  EXPECT_FALSE(diagnose(task, settings));
}

TEST(DiagnosisTask, RefusesDataThatTheSubjectCannotExplain) {
  DiagnoseRequest request = bilateral_request();
  request.subject = io::read_subject(GEAR3K_SOURCE_DIR "/examples/pair_internal.toml");
  try {
    diagnosis_task(request);
    FAIL() << "no exception";
  } catch (const io::InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()).find("gear.toml: a PAIR explains pair_loss data only"), 0U)
        << error.what();
  }
}

/// What is said to a black box with a model that has this text, "" where it is taken.
std::string said_of(const std::string& model) {
  DiagnoseRequest request = bilateral_request();
  request.subject = calibrate::BlackBox{.name = "box",
                                        .ratio = 102.0,
                                        .efficiency_forward = 0.9,
                                        .efficiency_backward = 0.9,
                                        .backlash_rad = 1e-3};
  request.source = "box.toml";
  request.model = model_of(io::parse_model(model, "model.toml"), "model.toml").use;
  try {
    diagnosis_task(request);
  } catch (const io::InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(DiagnosisTask, RefusesAModelOfWhatABlackBoxHasNot) {
  for (const char* cause :
       {"transmission.causes.friction_level]\nform = \"by_mesh\"\nrelative_change = 0.1\n"
        "relative_change_of_rings = -0.2\n",
        "transmission.causes.friction_direction]\nform = \"driving_inner\"\nasymmetry = 0.2\n",
        "transmission.causes.friction_direction]\nform = \"driving_outer\"\nasymmetry = 0.2\n",
        "transmission.causes.friction_direction]\nform = \"approach_recess\"\nasymmetry = 0.2\n",
        "transmission.causes.bearing_load]\nform = \"planet_bearings\"\nfriction_radius_mm = 0.1\n",
        "transmission.causes.friction_temperature]\nform = \"drag\"\n"
        "reference_temperature_c = 20.0\ncoefficient_per_k = 0.01\n",
        "lost_motion.causes.thermal_expansion]\nform = \"about_middle\"\n"
        "reference_temperature_c = 40.0\nexpansion_um_per_m_per_k = 20.0\n"}) {
    const std::string text(cause);
    const std::size_t begin = text.rfind('.', text.find(']')) + 1;
    EXPECT_EQ(said_of("[" + text),
              "model.toml: " + text.substr(begin, text.find(']') - begin) +
                  ": measured on a DESIGN, by what is inside (teeth, planets, centre distance or "
                  "stated drags), allowed for box.toml: a model that diagnose found with a black "
                  "box");
  }
}

TEST(DiagnosisTask, TakesAModelOfShaftsForABlackBox) {
  for (const char* cause :
       {"transmission.causes.friction_level]\nform = \"coefficient\"\nrelative_change = 0.1\n",
        "transmission.causes.drag_constant]\nform = \"sun\"\ntorque_nm = 0.01\n",
        "transmission.causes.bearing_load]\nform = \"output_bearing\"\nshare = 0.02\n"}) {
    EXPECT_EQ(said_of(std::string("[") + cause), "");
  }
}

}  // namespace
}  // namespace gear3k::app::diagnose_test
