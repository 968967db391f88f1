// `gear3k diagnose`: what is printed, files, figures, exit codes, bad input.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/calibrate/built_design.hpp"
#include "tests/cli/other_path.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/rig/rig.hpp"
#include "tests/rig/rig_train.hpp"

namespace gear3k::diagnose_test {
namespace {

using nlohmann::json;
using test::lines_of, test::OtherPath, test::ProgramResult, test::replaced, test::Workplace;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string design() { return rig::design_toml(rig::bilateral_drive_gear()); }

rig::Plan small_plan() {
  rig::Plan plan = rig::transmission_plan();
  plan.sun_speeds_rpm = {200.0, 600.0, 1000.0};
  plan.torques_Nm = {5.0, 20.0, 50.0};
  return plan;
}

/// What a bench measures whose sun drags by 20 mNm.
std::string dragged_data() {
  return rig::measure(rig::bilateral_drive_gear(), small_plan(),
                      {{.id = "drag_constant", .variant = "sun", .amplitude = 0.02}}, 7)
      .csv;
}

std::string faultless_data() {
  return rig::measure(rig::bilateral_drive_gear(), small_plan(), {}, 7).csv;
}

/// A folder with the design and the data of a dragging sun.
void prepare(const Workplace& place) {
  place.write("gear.toml", design());
  place.write("data.csv", dragged_data());
}

/// The same with a sun that turns one way only: its drag is like an offset of the sensor.
void prepare_one_rotation(const Workplace& place) {
  place.write("gear.toml", design());
  rig::Plan plan = small_plan();
  plan.both_rotations = false;
  place.write("data.csv",
              rig::measure(rig::bilateral_drive_gear(), plan,
                           {{.id = "drag_constant", .variant = "sun", .amplitude = 0.02}}, 7)
                  .csv);
}

const std::vector<std::string> kFigures{"evidence.svg", "measured_vs_simulated.svg",
                                        "periodogram.svg", "residuals.svg"};

TEST(Diagnose, FindsTheDragAndSaysSoInWords) {
  const Workplace place;
  prepare(place);
  const ProgramResult result = place.run({"diagnose", "gear.toml", "data.csv"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* part : {"The simulation is ", " % off where noise is ",
                           "Cause: load-independent drag at the sun: torque 0.0", "held out"}) {
    EXPECT_TRUE(contains(result.out, part)) << part << '\n' << result.out;
  }
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"data.csv", "gear.toml"}))
      << "nothing is written without --out";
}

TEST(Diagnose, AFaultlessSimulationHasNoDiscrepancy) {
  const Workplace place;
  place.write("gear.toml", design());
  place.write("data.csv", faultless_data());
  const ProgramResult result = place.run({"diagnose", "gear.toml", "data.csv", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_EQ(data.at("verdict"), "no_discrepancy");
  EXPECT_TRUE(data.at("effects").empty());
}

TEST(Diagnose, RowsTooFewToTellTheirNoiseSayNothingOfIt) {
  const Workplace place;
  place.write("gear.toml", test::example("designs/loaded.toml"));
  place.write("data.csv",
              "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm\n"
              "backward,1000,35,0.3148\nforward,200,50,0.5859\nbackward,600,35,0.3063\n"
              "forward,800,20,0.2512\n");
  const ProgramResult result = place.run({"diagnose", "gear.toml", "data.csv", "--out", "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // One parameter predicts them better, which says nothing while what is noise is not known.
  EXPECT_FALSE(contains(result.out, "The model predicts by ")) << result.out;
  EXPECT_TRUE(contains(result.out, "Verdict: no discrepancy found, but too few rows to know"))
      << result.out;
  EXPECT_FALSE(contains(result.out, "beyond noise")) << result.out;
  const json data = json::parse(place.read("out/diagnosis.json"));
  EXPECT_EQ(data.at("verdict"), "no_discrepancy");
  EXPECT_TRUE(data.at("rmse").at("noise_floor").is_null());
  EXPECT_TRUE(data.at("correction").is_null());
  EXPECT_TRUE(data.at("best_refit").at("found_held_out_error").get<double>() >
              data.at("best_refit").at("held_out_error").get<double>());
  EXPECT_FALSE(data.at("best_refit").at("predicts").get<bool>());
  EXPECT_TRUE(data.at("data").at("noise").at("stated").is_null());
}

TEST(Diagnose, WritesResultsAndFigures) {
  const Workplace place;
  prepare(place);
  const ProgramResult result =
      place.run({"diagnose", "gear.toml", "data.csv", "--out", "a/b", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(place.listing(),
            (std::vector<std::string>{"a", "a/b", "a/b/diagnosis.json", "a/b/evidence.svg",
                                      "a/b/measured_vs_simulated.svg", "a/b/model.toml",
                                      "a/b/periodogram.svg", "a/b/residuals.csv",
                                      "a/b/residuals.svg", "data.csv", "gear.toml"}));
  EXPECT_EQ(place.read("a/b/diagnosis.json"), result.out);
  EXPECT_EQ(place.read("a/b/residuals.csv"),
            place.run({"diagnose", "gear.toml", "data.csv", "--format", "csv"}).out);
  for (const std::string& name : kFigures) {
    std::istringstream stream(place.read("a/b/" + name));
    boost::property_tree::ptree tree;
    ASSERT_NO_THROW(boost::property_tree::read_xml(stream, tree)) << name;
  }
}

TEST(Diagnose, JsonKeepsTheContract) {
  const Workplace place;
  prepare(place);
  const json data =
      json::parse(place.run({"diagnose", "gear.toml", "data.csv", "--format", "json"}).out);
  for (const char* key :
       {"verdict", "effects", "rmse", "gain", "remainder", "next_experiment", "tool", "subject"}) {
    EXPECT_TRUE(data.contains(key)) << key;
  }
  ASSERT_FALSE(data.at("effects").empty());
  const json& effect = data.at("effects").at(0);
  for (const char* key : {"id", "alternatives", "parameters", "evidence"}) {
    EXPECT_TRUE(effect.contains(key)) << key;
  }
  const json& parameter = effect.at("parameters").at(0);
  EXPECT_LT(parameter.at("ci95").at(0), parameter.at("value"));
  EXPECT_GT(parameter.at("ci95").at(1), parameter.at("value"));
  EXPECT_GT(data.at("gain").get<double>(), 0.3);
}

TEST(Diagnose, ResidualsAreMeasuredLessSimulated) {
  const Workplace place;
  prepare(place);
  const io::CsvTable rows = io::parse_csv(
      place.run({"diagnose", "gear.toml", "data.csv", "--format", "csv"}).out, "stdout");
  const io::CsvTable data = io::parse_csv(place.read("data.csv"), "data.csv");
  ASSERT_EQ(rows.rows.size(), data.rows.size());
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    const auto& row = rows.rows[k];
    EXPECT_EQ(rows.number(row, "line"), data.rows[k].line);
    EXPECT_NEAR(*rows.number(row, "measured"), *data.number(data.rows[k], "sun_torque_nm"), 1e-12);
    EXPECT_NEAR(*rows.number(row, "measured") - *rows.number(row, "extended"),
                *rows.number(row, "residual_extended"), 1e-11);
  }
}

TEST(Diagnose, ItsModelLeavesNothingToFind) {
  const Workplace place;
  prepare(place);
  ASSERT_EQ(place.run({"diagnose", "gear.toml", "data.csv", "--out", "first"}).exit_code, 0);
  const ProgramResult again =
      place.run({"diagnose", "gear.toml", "data.csv", "--model", "first/model.toml", "--format",
                 "json", "--out", "second"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const json data = json::parse(again.out);
  EXPECT_EQ(data.at("verdict"), "no_discrepancy");
  EXPECT_EQ(place.read("second/model.toml"), place.read("first/model.toml"));
}

TEST(Diagnose, TheResultSaysWithWhichModelItWasMade) {
  const Workplace place;
  prepare(place);
  place.write("other.toml", replaced(design(), "name = \"", "name = \"other "));
  ASSERT_EQ(place.run({"diagnose", "other.toml", "data.csv", "--out", "first"}).exit_code, 0);
  const std::string model = place.read("first/model.toml");
  EXPECT_TRUE(contains(model, "verdict = \"")) << model;
  place.write("model.toml",
              replaced(replaced(model, "verdict = \"explained\"", "verdict = \"ambiguous\""),
                       "form = \"sun\"\n", "form = \"sun\"\nalternatives = [\"sensor_offset\"]\n"));
  const std::vector<std::string> words{"diagnose", "gear.toml", "data.csv", "--model",
                                       "model.toml"};
  auto with = words;
  with.insert(with.end(), {"--format", "json", "--seed", "3", "--false-discovery-rate", "0.02"});
  const ProgramResult result = place.run(with);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_EQ(data.at("seed"), 3);
  EXPECT_EQ(data.at("false_discovery_rate"), 0.02);
  EXPECT_EQ(data.at("model").at("file"), "model.toml");
  EXPECT_EQ(data.at("model").at("causes").at(0).at("id"), "drag_constant");
  EXPECT_EQ(data.at("model").at("data").at(0).at("data_files"), json::array({"data.csv"}));
  for (const char* part :
       {"model: model.toml: measured on \"other ", "could as well be sensor_offset"}) {
    EXPECT_TRUE(contains(result.err, part)) << result.err;
  }
  EXPECT_TRUE(contains(data.at("notes").dump(), "could as well be sensor_offset"));
  const std::string table = place.run(words).out;
  EXPECT_TRUE(table.starts_with("With the model model.toml\n  transmission, measured on \"other "))
      << table;
  auto quiet = words;
  quiet.emplace_back("--quiet");
  EXPECT_EQ(place.run(quiet).err, "");
}

TEST(Diagnose, TheModelThatItReadIsNotReplaced) {
  const Workplace place;
  prepare(place);
  ASSERT_EQ(place.run({"diagnose", "gear.toml", "data.csv", "--out", "out"}).exit_code, 0);
  const std::string model = place.read("out/model.toml");
  const ProgramResult again =
      place.run({"diagnose", "gear.toml", "data.csv", "--model", "out/model.toml", "--out", "out"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_TRUE(contains(again.err, "out/model.toml is an input file")) << again.err;
  EXPECT_EQ(place.read("out/model.toml"), model);
}

TEST(Diagnose, SameInputGivesTheSameBytesWhateverTheThreads) {
  const Workplace place;
  prepare(place);
  ASSERT_EQ(
      place.run({"diagnose", "gear.toml", "data.csv", "--out", "1", "--threads", "1"}).exit_code,
      0);
  ASSERT_EQ(
      place.run({"diagnose", "gear.toml", "data.csv", "--out", "2", "--threads", "4"}).exit_code,
      0);
  for (const char* name : {"diagnosis.json", "model.toml", "residuals.csv", "residuals.svg",
                           "evidence.svg", "measured_vs_simulated.svg"}) {
    EXPECT_EQ(place.read(std::string("1/") + name), place.read(std::string("2/") + name)) << name;
  }
}

TEST(Diagnose, ABlackBoxStandsInForADesign) {
  // A catalogue that states the gearbox's own efficiencies: the drag is all that it misses.
  const rig::Gearbox gearbox = rig::bilateral_drive_gear();
  const auto efficiency = [&](bool forward) {
    return rig::measured_efficiency(gearbox, {.forward = forward}, {});
  };
  const Workplace place;
  place.write(
      "box.toml",
      fmt::format("name = \"box\"\n[gearbox]\nratio = {:.12g}\nefficiency_forward = "
                  "{:.12g}\nefficiency_backward = {:.12g}\n",
                  std::abs(rig::make_train(gearbox).ratio), efficiency(true), efficiency(false)));
  place.write("data.csv", dragged_data());
  const ProgramResult result = place.run({"diagnose", "box.toml", "data.csv", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_EQ(data.at("subject"), "box");
  ASSERT_EQ(data.at("effects").size(), 1U);
  const json& effect = data.at("effects").at(0);
  EXPECT_EQ(effect.at("id"), "drag_constant");
  const json& torque = effect.at("parameters").at(0);
  EXPECT_EQ(torque.at("name"), "torque");
  EXPECT_EQ(torque.at("unit"), "Nm");
  // Within its interval, which is no wider than a third of it.
  constexpr double kHidden = 0.02;
  const double low = torque.at("ci95").at(0).get<double>();
  const double high = torque.at("ci95").at(1).get<double>();
  EXPECT_LE(low, kHidden);
  EXPECT_GE(high, kHidden);
  EXPECT_LT(high - low, kHidden / 3.0);
}

TEST(Diagnose, TorqueAngleRecordsBecomeLostMotion) {
  const Workplace place;
  place.write("gear.toml", design());
  place.write("loops.csv", rig::measure(rig::bilateral_drive_gear(), rig::torque_angle_plan(),
                                        {{.id = "clearance", .amplitude = 6.0}}, 3)
                               .csv);
  const ProgramResult result =
      place.run({"diagnose", "gear.toml", "loops.csv", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_EQ(data.at("kind"), "torque_angle");
  EXPECT_EQ(data.at("rmse").at("unit"), "arcmin");
  ASSERT_FALSE(data.at("effects").empty());
  EXPECT_EQ(data.at("effects").at(0).at("id"), "clearance");
}

/// A dead band between two springs behind Coulomb friction, moved in triangles of torque.
struct WindUp {
  double dead_band_arcmin = 20.0;
  double positive_Nm_rad = 5000.0, negative_Nm_rad = 4000.0;
  double friction_Nm = 2.0, peak_Nm = 20.0;
  double creep_arcmin_s = 0.0;

  /// By hand: the springs carry the friction to either side where the torque is zero.
  [[nodiscard]] double lost_motion_arcmin() const {
    return dead_band_arcmin +
           friction_Nm * (1.0 / positive_Nm_rad + 1.0 / negative_Nm_rad) / kArcmin;
  }
  static constexpr double kArcmin = std::numbers::pi / 10800.0;
  static constexpr double kLoop_s = 40.0;

  /// Three loops after the first quarter, of 800 samples each, referred to the sun by a ratio.
  [[nodiscard]] std::string csv(const char* locked, double ratio) const {
    constexpr int kSamples = 800;
    std::string text =
        fmt::format("# kind: torque_angle\n# locked: {}\ntime_s,angle_deg,torque_nm\n", locked);
    double inside = 0.0;
    for (int k = 0; k <= 3 * kSamples + kSamples / 4; ++k) {
      const double time = kLoop_s * k / kSamples;
      const double phase = static_cast<double>(k) / kSamples + 0.25;
      const double torque = peak_Nm * (1.0 - 4.0 * std::abs(phase - std::floor(phase) - 0.5));
      inside = std::clamp(inside, torque - friction_Nm, torque + friction_Nm);
      const double side = inside > 0.0 ? 0.5 : (inside < 0.0 ? -0.5 : 0.0);
      const double angle = inside / (inside > 0.0 ? positive_Nm_rad : negative_Nm_rad) +
                           (side * dead_band_arcmin + creep_arcmin_s * time) * kArcmin;
      text += fmt::format("{:.6g},{:.12g},{:.12g}\n", time,
                          ratio * angle * 180.0 / std::numbers::pi, torque / ratio);
    }
    return text;
  }
};

TEST(Diagnose, TellsStiffnessAsymmetryAndCreepOfTheLoops) {
  constexpr double kRatio = 50.0;
  const WindUp record{.creep_arcmin_s = 0.005};
  const Workplace place;
  place.write("box.toml",
              fmt::format("[gearbox]\nratio = {}\nefficiency_forward = 0.9\nefficiency_backward = "
                          "0.9\nbacklash_arcmin = {}\n",
                          kRatio, record.dead_band_arcmin));
  place.write("output.csv", record.csv("sun", 1.0));
  place.write("sun.csv", record.csv("output", kRatio));
  const std::vector<std::string> words{"diagnose", "box.toml", "output.csv", "sun.csv"};
  auto as_json = words;
  as_json.insert(as_json.end(), {"--format", "json"});
  const ProgramResult result = place.run(as_json);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  const double rate_Nm_s = 4.0 * record.peak_Nm / WindUp::kLoop_s;
  const double creep_rad_s = record.creep_arcmin_s * WindUp::kArcmin;
  // Of neighbouring loops, which share a branch, every second one.
  ASSERT_EQ(data.at("loops").size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    const json& loop = data.at("loops").at(k);
    EXPECT_EQ(loop.at("file"), k < 3 ? "output.csv" : "sun.csv");
    EXPECT_EQ(loop.at("measured_at"), k < 3 ? "output" : "sun");
    EXPECT_EQ(loop.at("loop"), 2 + 2 * (k % 3));
    const auto number = [&](const char* key) { return loop.at(key).get<double>(); };
    // The creep goes with the rising flank and against the falling one.
    const double positive = rate_Nm_s / (rate_Nm_s / record.positive_Nm_rad + creep_rad_s);
    const double negative = rate_Nm_s / (rate_Nm_s / record.negative_Nm_rad - creep_rad_s);
    EXPECT_NEAR(number("stiffness_positive_nm_per_rad"), positive, 1e-6 * positive);
    EXPECT_NEAR(number("stiffness_negative_nm_per_rad"), negative, 1e-6 * negative);
    EXPECT_NEAR(number("asymmetry"), (positive - negative) / (0.5 * (positive + negative)), 1e-6);
    EXPECT_NEAR(number("creep_arcmin_per_s"), record.creep_arcmin_s, 1e-4 * record.creep_arcmin_s);
    EXPECT_NEAR(number("filter_cutoff_hz"), 120.0 / WindUp::kLoop_s, 0.05);
    // Falling to rising, half a loop apart; the filter's tail of the dead band's jump.
    EXPECT_NEAR(number("lost_motion_arcmin"),
                record.lost_motion_arcmin() - 0.5 * WindUp::kLoop_s * record.creep_arcmin_s,
                0.02 * record.dead_band_arcmin);
  }
  const std::string table = place.run(words).out;
  for (const char* part :
       {"measured at  loop  lost motion (arcmin)", "output.csv: filter cut-off 3",
        "sun.csv: filter cut-off 3", "; creep of 0.005"}) {
    EXPECT_TRUE(contains(table, part)) << part << '\n' << table;
  }
}

TEST(Diagnose, SeveralKindsAreDiagnosedOneByOne) {
  const Workplace place;
  prepare(place);
  place.write("lost.csv",
              rig::measure(rig::bilateral_drive_gear(), rig::lost_motion_plan(), {}, 3).csv);
  const ProgramResult result = place.run(
      {"diagnose", "gear.toml", "lost.csv", "data.csv", "--out", "out", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  ASSERT_EQ(data.at("kinds").size(), 2U);
  EXPECT_EQ(data.at("kinds").at(0).at("kind"), "transmission");
  EXPECT_EQ(data.at("kinds").at(1).at("kind"), "lost_motion");
  EXPECT_TRUE(place.has("out/residuals_lost_motion.svg"));
}

TEST(Diagnose, FiguresOfAnEarlierRunWithOtherKindsAreRemovedAndNothingElse) {
  const Workplace place;
  prepare(place);
  std::filesystem::create_directory(place.file("out"));
  place.write("out/evidence_lost_motion.svg", "");
  place.write("out/periodogram_pair_loss.svg", "");
  place.write("out/evidence_mine.svg", "");
  place.write("out/evidence_lost_motion.svg.previous", "");
  const ProgramResult result = place.run({"diagnose", "gear.toml", "data.csv", "--out", "out"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(place.has("out/evidence_lost_motion.svg"));
  EXPECT_FALSE(place.has("out/periodogram_pair_loss.svg"));
  EXPECT_TRUE(contains(result.err, "out/evidence_lost_motion.svg: was of an earlier run, removed"))
      << result.err;
  EXPECT_TRUE(place.has("out/evidence_mine.svg"));
  EXPECT_TRUE(place.has("out/evidence_lost_motion.svg.previous"));
  for (const std::string& name : kFigures) EXPECT_TRUE(place.has("out/" + name)) << name;
}

TEST(Diagnose, ALimitBeyondTheDataIsBothEnds) {
  const Workplace place;
  prepare_one_rotation(place);
  // The data end at 1000 rpm and begin at 5 Nm.
  const ProgramResult result =
      place.run({"diagnose", "gear.toml", "data.csv", "--format", "json", "--min-sun-speed-rpm",
                 "1500", "--max-output-torque-nm", "2", "--max-test-torque-nm", "3"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json next = json::parse(result.out).at("next_experiment");
  ASSERT_FALSE(next.is_null());
  for (const json& condition : next.at("conditions")) {
    EXPECT_NEAR(condition.at("sun_speed_rpm").get<double>(), 1500.0, 1e-9);
    EXPECT_NEAR(condition.at("output_torque_nm").get<double>(), 2.0, 1e-9);
  }
  EXPECT_TRUE(
      contains(result.err, "--max-test-torque-nm: no effect, as the data state no test_torque_nm"))
      << result.err;
  EXPECT_FALSE(contains(result.err, "sun_speed")) << result.err;
}

TEST(Diagnose, ALimitNearTheGreatestNumberIsOne) {
  const Workplace place;
  prepare_one_rotation(place);
  // A load without torques: the sums and products of the condition overflow.
  const ProgramResult result =
      place.run({"diagnose", "gear.toml", "data.csv", "--format", "json", "--max-output-torque-nm",
                 "1e308", "--max-sun-speed-rpm", "1e308"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(json::parse(result.out).at("next_experiment").is_null());
}

TEST(Diagnose, TheNextExperimentKeepsItsLimits) {
  const Workplace place;
  prepare_one_rotation(place);
  const ProgramResult result =
      place.run({"diagnose", "gear.toml", "data.csv", "--format", "json", "--max-sun-speed-rpm",
                 "450", "--max-output-torque-nm", "12"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json next = json::parse(result.out).at("next_experiment");
  ASSERT_FALSE(next.is_null());
  ASSERT_FALSE(next.at("conditions").empty());
  for (const json& condition : next.at("conditions")) {
    EXPECT_LE(condition.at("sun_speed_rpm").get<double>(), 450.0 + 1e-9);
    EXPECT_LE(condition.at("output_torque_nm").get<double>(), 12.0 + 1e-9);
    EXPECT_GE(condition.at("repeats").get<int>(), 1);
  }
}

/// A limit of the next experiment that nothing of the data keeps.
struct NextLimit {
  std::string option, column;
  double value = 0.0;
};
/// The conditions that are asked for with these limits keep each of them.
void expect_kept(const Workplace& place, const std::vector<NextLimit>& limits) {
  std::vector<std::string> words{"diagnose", "gear.toml", "data.csv", "--format", "json"};
  for (const NextLimit& limit : limits) {
    words.insert(words.end(), {limit.option, fmt::format("{}", limit.value)});
  }
  const ProgramResult result = place.run(words);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json next = json::parse(result.out).at("next_experiment");
  ASSERT_FALSE(next.is_null());
  ASSERT_FALSE(next.at("conditions").empty());
  for (const json& condition : next.at("conditions")) {
    for (const auto& [option, column, value] : limits) {
      const bool greatest = option.starts_with("--max");
      const auto asked = condition.at(column).get<double>();
      EXPECT_LE(greatest ? asked : value, (greatest ? value : asked) + 1e-9) << option;
    }
  }
}

TEST(Diagnose, TheNextLoadKeepsEveryLowerLimit) {
  const Workplace place;
  prepare_one_rotation(place);
  // The data end at 1000 rpm, 50 Nm and 45 C.
  expect_kept(place, {{"--min-sun-speed-rpm", "sun_speed_rpm", 1500.0},
                      {"--min-output-torque-nm", "output_torque_nm", 80.0},
                      {"--min-temperature-c", "temperature_c", 70.0}});
}

TEST(Diagnose, TheNextTestTorqueAndTemperatureKeepTheirLimits) {
  const Workplace place;
  place.write("gear.toml", design());
  // Two torques tell clearance hardly from compliance.
  rig::Plan plan = rig::lost_motion_plan();
  plan.rows = 60;
  plan.torques_Nm = {4.0, 5.0};
  place.write("data.csv", rig::measure(rig::bilateral_drive_gear(), plan,
                                       {{.id = "clearance", .amplitude = 0.5}}, 7)
                              .csv);
  // Each lies beyond the data, which are of 15 to 45 C.
  for (const NextLimit& limit :
       std::vector<NextLimit>{{"--min-test-torque-nm", "test_torque_nm", 9.0},
                              {"--max-test-torque-nm", "test_torque_nm", 1.0},
                              {"--min-temperature-c", "temperature_c", 70.0},
                              {"--max-temperature-c", "temperature_c", 10.0}}) {
    expect_kept(place, {limit});
  }
}

TEST(Diagnose, WithoutGnuplotTheResultsAreThereAndOldFiguresAreNot) {
  const Workplace place;
  prepare(place);
  ASSERT_EQ(place.run({"diagnose", "gear.toml", "data.csv", "--out", "out"}).exit_code, 0);
  ProgramResult result;
  {
    const OtherPath path("");
    result = place.run({"diagnose", "gear.toml", "data.csv", "--out", "out"});
  }
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(json::parse(place.read("out/diagnosis.json")).at("missing_figures").size(),
            kFigures.size());
  EXPECT_TRUE(contains(result.err,
                       "written without figures: out/diagnosis.json, out/model.toml, "
                       "out/residuals.csv"))
      << result.err;
  for (const std::string& name : kFigures) {
    EXPECT_FALSE(place.has("out/" + name)) << name;
    EXPECT_TRUE(place.has("out/" + name + ".previous")) << name;
  }
}

TEST(Diagnose, ErrorsOfAllFilesAreToldAtOnce) {
  const Workplace place;
  prepare(place);
  place.write("gear.toml", replaced(design(), "planets", "planetz"));
  place.write("data.csv", replaced(dragged_data(), "sun_torque_nm", "sun_torque_Nm"));
  const ProgramResult result =
      place.run({"diagnose", "gear.toml", "data.csv", "--model", "none.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  for (const char* part : {"gear.toml:", "planets", "data.csv:", "sun_torque_nm", "none.toml"}) {
    EXPECT_TRUE(contains(result.err, part)) << part << '\n' << result.err;
  }
  EXPECT_EQ(result.out, "");
  EXPECT_FALSE(place.has("out"));
}

TEST(Diagnose, AFewEfficienciesAboveOneAreLeftOutAndNamed) {
  const Workplace place;
  place.write("gear.toml", design());
  // Two rows as if the output had driven what took more from the sun than an ideal gearbox gives.
  const std::string good = dragged_data();
  std::vector<std::string> lines = lines_of(good);
  std::vector<std::size_t> wrong;
  for (std::size_t k = 0; k < lines.size() && wrong.size() < 2; ++k) {
    if (!lines[k].starts_with("forward,")) continue;
    lines[k] = replaced(lines[k], "forward", "backward");
    wrong.push_back(k + 1);
  }
  ASSERT_EQ(wrong.size(), 2U);
  std::string csv;
  for (const std::string& line : lines) csv += line + '\n';
  place.write("data.csv", csv);
  const std::string named =
      fmt::format("data.csv: lines {}, {}: rows left out, efficiency above 1 beyond the noise",
                  wrong[0], wrong[1]);
  const ProgramResult result =
      place.run({"diagnose", "gear.toml", "data.csv", "--out", "out", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_TRUE(contains(data.at("notes").dump(), named)) << data.at("notes");
  const std::size_t rows = io::parse_csv(good, "data.csv").rows.size();
  EXPECT_EQ(data.at("data").at("rows"), rows - 2);
  const io::CsvTable residuals = io::parse_csv(place.read("out/residuals.csv"), "residuals.csv");
  EXPECT_EQ(residuals.rows.size(), rows - 2);
  for (const auto& row : residuals.rows) {
    for (const std::size_t line : wrong) {
      EXPECT_NE(residuals.number(row, "line"), static_cast<double>(line));
    }
  }
  const ProgramResult table = place.run({"diagnose", "gear.toml", "data.csv"});
  EXPECT_TRUE(contains(table.out, "Note: " + named)) << table.out;
  EXPECT_EQ(table.err, "");
}

TEST(Diagnose, ManyEfficienciesAboveOneAreRefused) {
  const Workplace place;
  place.write("gear.toml", design());
  std::string swapped = dragged_data();
  const auto swap = [&](const std::string& from, const std::string& to) {
    for (auto at = swapped.find(from); at != std::string::npos; at = swapped.find(from, at)) {
      swapped.replace(at, from.size(), to);
    }
  };
  swap("\nforward,", "\n#,");
  swap("\nbackward,", "\nforward,");
  swap("\n#,", "\nbackward,");
  ASSERT_NE(swapped, dragged_data());
  place.write("data.csv", swapped);
  const ProgramResult result = place.run({"diagnose", "gear.toml", "data.csv"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "efficiency above 1")) << result.err;
}

TEST(Diagnose, DataThatTheSubjectCannotAnswerAreRefused) {
  const Workplace place;
  prepare(place);
  place.write("pair.toml", test::example("pair_internal.toml"));
  const ProgramResult result = place.run({"diagnose", "pair.toml", "data.csv"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err,
            "pair.toml: a PAIR explains pair_loss data only: transmission data (data.csv): allowed "
            "with a DESIGN or a black box\n");
  place.write("lost.csv",
              rig::measure(rig::bilateral_drive_gear(), rig::lost_motion_plan(), {}, 3).csv);
  place.write("box.toml",
              "[gearbox]\nratio = 96.24\nefficiency_forward = 0.9\nefficiency_backward = 0.88\n");
  EXPECT_EQ(place.run({"diagnose", "box.toml", "lost.csv"}).err,
            "box.toml: gearbox.backlash_arcmin is not stated and lost_motion data (lost.csv) need "
            "it: allowed: a number of at least 0\n");
}

TEST(Diagnose, FilesInTheWrongPlaceAreToldByWhatTheyLookLike) {
  const Workplace place;
  prepare(place);
  place.write("spec.toml", test::example("rp96.toml"));
  const ProgramResult result =
      place.run({"diagnose", "spec.toml", "gear.toml", "--model", "gear.toml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(lines_of(result.err).size(), 3U) << result.err;
  for (const char* part :
       {"spec.toml: looks like a SPEC: it has [ratio]; SUBJECT takes ",
        "gear.toml: looks like a DESIGN: it has [gears]; DATA takes ",
        "gear.toml: looks like a DESIGN: it has [gears]; --model takes a model.toml of diagnose"}) {
    EXPECT_TRUE(contains(result.err, part)) << part << '\n' << result.err;
  }
}

TEST(Diagnose, ARecordWithoutALoopIsAnError) {
  const Workplace place;
  place.write("gear.toml", design());
  std::string csv = "# kind: torque_angle\n# locked: sun\ntime_s,angle_deg,torque_nm\n";
  for (int k = 0; k < 400; ++k) {
    csv +=
        std::to_string(k) + "," + std::to_string(0.001 * k) + "," + std::to_string(0.01 * k) + "\n";
  }
  place.write("ramp.csv", csv);
  const ProgramResult result = place.run({"diagnose", "gear.toml", "ramp.csv"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "ramp.csv: no loop could be measured")) << result.err;
}

TEST(Diagnose, UsageErrors) {
  const Workplace place;
  prepare(place);
  EXPECT_EQ(place.run({"diagnose"}).exit_code, 1);
  EXPECT_EQ(place.run({"diagnose", "gear.toml"}).exit_code, 1) << "without data";
  EXPECT_EQ(place.run({"diagnose", "gear.toml", "data.csv", "--out", ""}).exit_code, 1);
  const ProgramResult typo = place.run({"diagnose", "gear.toml", "data.csv", "--modle", "m.toml"});
  EXPECT_EQ(typo.exit_code, 1);
  EXPECT_TRUE(contains(typo.err, "did you mean --model?")) << typo.err;
  const ProgramResult limits =
      place.run({"diagnose", "gear.toml", "data.csv", "--false-discovery-rate", "0",
                 "--min-sun-speed-rpm", "500", "--max-sun-speed-rpm", "100"});
  EXPECT_EQ(limits.exit_code, 1);
  EXPECT_TRUE(
      contains(limits.err, "--false-discovery-rate = 0: allowed: a number above 0, up to 0.5"))
      << limits.err;
  EXPECT_TRUE(contains(limits.err, "allowed: min <= max")) << limits.err;
  for (const std::string& seed :
       std::vector<std::string>{"-1", "18446744073709551616", "x", "1.5", "0x10"}) {
    const ProgramResult wrong = place.run({"diagnose", "gear.toml", "data.csv", "--seed", seed});
    EXPECT_EQ(wrong.exit_code, 1) << seed;
    EXPECT_TRUE(contains(
        wrong.err, "--seed = " + seed + ": allowed: a whole number, 0 to 18446744073709551615"))
        << wrong.err;
  }
  EXPECT_EQ(place.run({"diagnose", "--help"}).exit_code, 0);
}

TEST(Diagnose, AFolderThatCannotBeMadeLeavesNothingBehind) {
  const Workplace place;
  prepare(place);
  place.write("file", "");
  const ProgramResult result = place.run({"diagnose", "gear.toml", "data.csv", "--out", "file"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"data.csv", "file", "gear.toml"}));
}

TEST(DiagnoseInterrupt, EndsWithItsCodeAndLeavesNothing) {
  const Workplace place;
  place.write("gear.toml", design());
  rig::Plan plan = rig::transmission_plan();
  plan.repeats = 200;
  place.write("data.csv", rig::measure(rig::bilateral_drive_gear(), plan, {}, 7).csv);
  test::RunningProgram program =
      place.start({"diagnose", "gear.toml", "data.csv", "--out", "out", "--quiet"});
  ASSERT_TRUE(program.wait_until_it_catches(SIGTERM, std::chrono::seconds(10)));
  program.send(SIGTERM);
  const auto result = program.wait(std::chrono::seconds(50));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->signal, 0);
  EXPECT_EQ(result->exit_code, 130);
  EXPECT_EQ(result->out, "");
  EXPECT_FALSE(std::filesystem::exists(place.file("out")));
}

}  // namespace
}  // namespace gear3k::diagnose_test
