// optimize --resume: what a run that was killed or interrupted leaves, and how it is completed.

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/run_program.hpp"
#include "tests/sample.hpp"

namespace gear3k::resume_test {
namespace {

using nlohmann::json;
using std::chrono::milliseconds, std::chrono::seconds;
using test::example, test::ProgramResult, test::read_text, test::replaced, test::RunningProgram,
    test::Workplace;

constexpr int kInvalidInput = 2;
constexpr int kInterrupted = 130;

const std::string kEfficiency = "backward_efficiency";
/// Its bounds leave --certify half of the sets to refine, and ask for no sharpened ones afterwards.
const std::string kLostMotion = "lost_motion";

/// Some hundreds of tooth sets or more in several waves, half a second in all; the path model,
/// whose bounds leave --certify enough to refine.
std::string long_task(const std::string& tolerance, const std::string& objective = kEfficiency) {
  std::string spec = replaced(example("rp96.toml"), "planets = 3", "planets = [3, 4]");
  spec = replaced(spec, "tolerance = 0.005", "tolerance = " + tolerance);
  spec = replaced(spec, "\"ohlendorf\"", "\"coulomb_path\"");
  spec = replaced(spec, kEfficiency, objective);
  return replaced(spec, "starts = 4", "starts = 1");
}

struct ResultFiles {
  std::string best, refined, pareto;
  json summary;
};
ResultFiles results_in(const Workplace& place, const std::string& folder) {
  ResultFiles files{.best = place.read(folder + "/best.toml"),
                    .refined = place.read(folder + "/refined.csv"),
                    .pareto = place.read(folder + "/pareto.csv"),
                    .summary = json::parse(place.read(folder + "/summary.json"))};
  for (const char* key : {"wall_time_s", "threads"}) {
    EXPECT_EQ(files.summary.erase(key), 1U) << key;
  }
  return files;
}

void expect_same_files(const ResultFiles& a, const ResultFiles& b) {
  EXPECT_EQ(a.best, b.best);
  EXPECT_TRUE(a.refined == b.refined) << "refined.csv differs";
  EXPECT_TRUE(a.pareto == b.pareto) << "pareto.csv differs";
  EXPECT_EQ(a.summary, b.summary);
}

std::uintmax_t size_of(const std::filesystem::path& path) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(path, none);
  return none ? 0 : size;
}

/// Sends a signal as soon as the journal holds more than so many bytes.
/// @returns the result; empty where the program did not end
std::optional<ProgramResult> ended_by(RunningProgram& program, const std::filesystem::path& journal,
                                      std::uintmax_t bytes, int signal) {
  const auto limit = std::chrono::steady_clock::now() + seconds(20);
  while (size_of(journal) <= bytes && std::chrono::steady_clock::now() < limit) {
    if (auto ended = program.wait(milliseconds(0))) return ended;
    std::this_thread::sleep_for(milliseconds(1));
  }
  program.send(signal);
  return program.wait(seconds(20));
}

using Arguments = std::vector<std::string>;

Arguments optimize_arguments(const std::string& folder, bool certify, Arguments more = {}) {
  Arguments arguments{"optimize", "spec.toml", "--out", folder, "--quiet"};
  if (certify) arguments.emplace_back("--certify");
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// With and without --certify.
class Resume : public testing::TestWithParam<bool> {
 protected:
  // 417 sets in four waves, in the long run 2200; with --certify about 230 in four, in the long run
  // 120 in three, whose bounds are sharpened.
  static std::string task() {
    if (GetParam()) return long_task(sample("0.004", "0.005"), sample(kLostMotion, kEfficiency));
    return long_task(sample("0.004", "0.02"));
  }
};

TEST_P(Resume, AfterAKillGivesTheBytesOfAnUndisturbedRun) {
  const Workplace place;
  place.write("spec.toml", task());
  ASSERT_EQ(place.run(optimize_arguments("whole", GetParam())).exit_code, 0);
  const ResultFiles whole = results_in(place, "whole");
  EXPECT_FALSE(place.has("whole/optimize.journal"));
  // In the first wave, in the second, and later.
  for (const std::uintmax_t bytes : {0U, 100U, GetParam() ? 12000U : 80000U}) {
    const std::string folder = "killed" + std::to_string(bytes);
    RunningProgram program = place.start(optimize_arguments(folder, GetParam()));
    const auto killed = ended_by(program, place.file(folder) / "optimize.journal", bytes, SIGKILL);
    ASSERT_TRUE(killed);
    ASSERT_EQ(killed->signal, SIGKILL) << "it ended before it was killed";
    ASSERT_TRUE(place.has(folder + "/optimize.journal"));
    EXPECT_FALSE(place.has(folder + "/summary.json"));
    const auto resumed = place.run(optimize_arguments(folder, GetParam(), {"--resume"}));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    expect_same_files(results_in(place, folder), whole);
    EXPECT_FALSE(place.has(folder + "/optimize.journal"));
  }
}

TEST_P(Resume, MayBeKilledAgainAndAgain) {
  const Workplace place;
  place.write("spec.toml", task());
  ASSERT_EQ(place.run(optimize_arguments("whole", GetParam())).exit_code, 0);
  const auto journal = place.file("out") / "optimize.journal";
  for (int run = 0; run < 2; ++run) {
    RunningProgram program = place.start(
        optimize_arguments("out", GetParam(), run > 0 ? Arguments{"--resume"} : Arguments{}));
    const auto killed = ended_by(program, journal, size_of(journal) + 1000, SIGKILL);
    ASSERT_TRUE(killed);
    ASSERT_EQ(killed->signal, SIGKILL) << "run " << run << " ended before it was killed";
    // As a disk that was full would leave it: a record cut short.
    std::filesystem::resize_file(journal, size_of(journal) - 3);
  }
  EXPECT_EQ(place.run(optimize_arguments("out", GetParam(), {"--resume"})).exit_code, 0);
  expect_same_files(results_in(place, "out"), results_in(place, "whole"));
}

TEST_P(Resume, AfterCtrlCCompletesUsableFiles) {
  const Workplace place;
  place.write("spec.toml", task());
  ASSERT_EQ(place.run(optimize_arguments("whole", GetParam())).exit_code, 0);
  RunningProgram program = place.start(optimize_arguments("out", GetParam()));
  const auto stopped = ended_by(program, place.file("out") / "optimize.journal", 1000, SIGINT);
  ASSERT_TRUE(stopped);
  ASSERT_EQ(stopped->exit_code, kInterrupted) << stopped->err;
  EXPECT_NE(stopped->err.find("--resume"), std::string::npos) << stopped->err;
  ResultFiles partial = results_in(place, "out");
  EXPECT_EQ(partial.summary.at("interrupted"), true);
  EXPECT_EQ(place.run({"analyze", "out/best.toml", "--strict"}).exit_code, 0);
  EXPECT_TRUE(place.has("out/optimize.journal"));
  EXPECT_EQ(place.run(optimize_arguments("out", GetParam(), {"--resume"})).exit_code, 0);
  expect_same_files(results_in(place, "out"), results_in(place, "whole"));
  EXPECT_FALSE(place.has("out/optimize.journal"));
}

INSTANTIATE_TEST_SUITE_P(Runs, Resume, testing::Bool(), [](const auto& certify) {
  return std::string(certify.param ? "Certified" : "Full");
});

/// A folder out/ with the journal of a run that was killed.
void leave_a_killed_run(const Workplace& place, const std::string& task) {
  place.write("spec.toml", task);
  RunningProgram program = place.start(optimize_arguments("out", false));
  const auto killed = ended_by(program, place.file("out") / "optimize.journal", 1000, SIGKILL);
  ASSERT_TRUE(killed);
  ASSERT_EQ(killed->signal, SIGKILL);
}

TEST(ResumeOption, WithoutAJournalStartsAnewAndSaysSo) {
  const Workplace place;
  place.write("spec.toml", replaced(example("rp96.toml"), "S = [10, 20]", "S = [12, 12]"));
  const auto plain = place.run({"optimize", "spec.toml", "--out", "plain"});
  const auto resumed = place.run({"optimize", "spec.toml", "--out", "out", "--resume"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_NE(resumed.err.find("anew"), std::string::npos) << resumed.err;
  expect_same_files(results_in(place, "out"), results_in(place, "plain"));
}

TEST(Optimize, SetsAsideWhatNoRunWroteUnderTheNamesOfItsResults) {
  const Workplace place;
  place.write("spec.toml", replaced(example("rp96.toml"), "S = [10, 20]", "S = [12, 12]"));
  std::filesystem::create_directory(place.file("out"));
  place.write("out/best.toml", "drawn by hand");
  place.write("out/pareto.csv", "from elsewhere");
  place.write("out/best.toml.previous", "older");
  const std::vector<std::string> words{"optimize", "spec.toml", "--out", "out"};
  const auto result = place.run(words);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(place.read("out/best.toml.previous"), "older");
  EXPECT_EQ(place.read("out/best.toml.previous.2"), "drawn by hand");
  EXPECT_EQ(place.read("out/pareto.csv.previous"), "from elsewhere");
  EXPECT_NE(result.err.find("best.toml.previous.2"), std::string::npos) << result.err;
  // What a run wrote is replaced where that is asked for.
  std::vector<std::string> forced = words;
  forced.push_back("--force");
  EXPECT_EQ(place.run(forced).exit_code, 0);
  EXPECT_FALSE(place.has("out/best.toml.previous.3"));
}

TEST(ResumeOption, RefusesTheJournalOfAChangedSpecificationAndLeavesIt) {
  const Workplace place;
  const std::string task = long_task("0.004");
  ASSERT_NO_FATAL_FAILURE(leave_a_killed_run(place, task));
  const std::string journal = place.read("out/optimize.journal");
  place.write("spec.toml", replaced(task, "coefficient = 0.1", "coefficient = 0.11"));
  const auto resumed = place.run(optimize_arguments("out", false, {"--resume"}));
  EXPECT_EQ(resumed.exit_code, kInvalidInput);
  EXPECT_NE(resumed.err.find("another task"), std::string::npos) << resumed.err;
  EXPECT_NE(resumed.err.find("allowed:"), std::string::npos) << resumed.err;
  EXPECT_TRUE(place.read("out/optimize.journal") == journal);
  EXPECT_FALSE(place.has("out/summary.json"));
}

TEST(ResumeOption, NewRunWithoutItKeepsTheOldJournalUnderAnotherName) {
  const Workplace place;
  ASSERT_NO_FATAL_FAILURE(leave_a_killed_run(place, long_task("0.004")));
  const std::string journal = place.read("out/optimize.journal");
  place.write("spec.toml", replaced(example("rp96.toml"), "S = [10, 20]", "S = [12, 12]"));
  const auto fresh = place.run({"optimize", "spec.toml", "--out", "out"});
  EXPECT_EQ(fresh.exit_code, 0) << fresh.err;
  EXPECT_NE(fresh.err.find("--resume"), std::string::npos) << fresh.err;
  EXPECT_TRUE(place.read("out/optimize.journal.previous") == journal);
  EXPECT_FALSE(place.has("out/optimize.journal"));
}

TEST(Optimize, RefusesAFolderThatAnotherRunIsWriting) {
  const Workplace place;
  place.write("spec.toml", long_task(sample("0.005", "0.02")));
  RunningProgram first = place.start({"optimize", "spec.toml", "--out", "out", "--quiet"});
  const auto limit = std::chrono::steady_clock::now() + seconds(20);
  while (!std::filesystem::exists(place.file("out/optimize.journal")) &&
         std::chrono::steady_clock::now() < limit) {
    std::this_thread::sleep_for(milliseconds(1));
  }
  for (const bool resume : {false, true}) {
    std::vector<std::string> arguments{"optimize", "spec.toml", "--out", "out", "--quiet"};
    if (resume) arguments.emplace_back("--resume");
    const ProgramResult second = place.run(arguments);
    EXPECT_EQ(second.exit_code, kInvalidInput);
    EXPECT_NE(second.err.find("another run is writing it"), std::string::npos) << second.err;
  }
  const auto done = first.wait(seconds(60));
  ASSERT_TRUE(done);
  EXPECT_EQ(done->exit_code, 0) << done->err;
}

TEST(ResumeOption, RefusesAJournalThatIsNoFile) {
  const Workplace place;
  place.write("spec.toml", example("rp96.toml"));
  std::filesystem::create_directories(place.file("out/optimize.journal"));
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--resume", "--quiet"});
  EXPECT_EQ(result.exit_code, kInvalidInput);
  EXPECT_NE(result.err.find("optimize.journal: cannot be read"), std::string::npos) << result.err;
}

TEST(Optimize, RefusesAFolderWhoseResultsWouldReplaceItsInput) {
  const Workplace place;
  std::filesystem::create_directory(place.file("out"));
  place.write("out/best.toml", example("rp96.toml"));
  const ProgramResult result = place.run({"optimize", "out/best.toml", "--out", "out", "--quiet"});
  EXPECT_EQ(result.exit_code, kInvalidInput);
  EXPECT_NE(result.err.find("--out out: out/best.toml is an input file"), std::string::npos)
      << result.err;
  EXPECT_EQ(place.read("out/best.toml"), example("rp96.toml"));
}

TEST(CertifyOption, StatesBoundsRoundedSoThatTheyHold) {
  const Workplace place;
  place.write("spec.toml", example("rp96.toml"));
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--certify", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json certificate = json::parse(result.out).at("certificate");
  // "... has more than 0.923964; ..."
  const std::string words = "bounded sets has more than ";
  const auto at = result.err.find(words);
  ASSERT_NE(at, std::string::npos) << result.err;
  EXPECT_GE(std::stod(result.err.substr(at + words.size())),
            certificate.at("largest_unrefined_bound").get<double>());
  EXPECT_GE(certificate.at("global_bound"), certificate.at("best"));
  EXPECT_LT(certificate.at("largest_unrefined_bound"), certificate.at("best"));
}

TEST(CertifyOption, ExcludesAModelAtAnOperatingPoint) {
  const Workplace place;
  place.write("spec.toml", replaced(example("rp96.toml"), "S = [10, 20]", "S = [12, 12]") +
                               "\n[operating_point]\nsun_speed_rpm = 600\noutput_torque_nm = 20\n"
                               "temperature_c = 30\n");
  place.write("model.toml",
              "[transmission]\nname = \"any\"\n[transmission.range]\nsun_speed_rpm = [200, 1000]\n"
              "output_torque_nm = [5, 50]\ntemperature_c = [25, 45]\n"
              "[transmission.causes.drag_constant]\nform = \"sun\"\nbody = \"sun\"\n"
              "torque_nm = 0.01\ntorque_nm_sd = 0.001\n");
  const auto result =
      place.run({"optimize", "spec.toml", "--out", "out", "--certify", "--model", "model.toml"});
  EXPECT_EQ(result.exit_code, kInvalidInput);
  EXPECT_NE(result.err.find("--certify"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("--model"), std::string::npos) << result.err;
  EXPECT_FALSE(place.has("out/summary.json"));
  const auto without =
      place.run({"optimize", "spec.toml", "--out", "out", "--model", "model.toml"});
  EXPECT_EQ(without.exit_code, 0) << without.err;
}

TEST(ResumeOption, JournalOfOneSearchServesTheOther) {
  // Sets are refined alike with and without --certify.
  const Workplace place;
  const std::string objective = sample(kLostMotion, kEfficiency);
  ASSERT_NO_FATAL_FAILURE(leave_a_killed_run(place, long_task("0.004", objective)));
  ASSERT_EQ(place.run(optimize_arguments("whole", true)).exit_code, 0);
  EXPECT_EQ(place.run(optimize_arguments("out", true, {"--resume"})).exit_code, 0);
  expect_same_files(results_in(place, "out"), results_in(place, "whole"));
}

TEST(Resume, OfAFrontGoesOnWithItsSearches) {
  const Workplace place;
  std::string spec = replaced(example("rp96.toml"), "\"backward_efficiency\"",
                              "[\"backward_efficiency\", \"lost_motion\", \"outer_diameter\"]");
  place.write("spec.toml", replaced(spec, "tolerance = 0.005", "tolerance = 0.001"));
  ASSERT_EQ(place.run(optimize_arguments("whole", false)).exit_code, 0);
  RunningProgram program = place.start(optimize_arguments("out", false));
  const auto killed = ended_by(program, place.file("out/front.journal"), 2000, SIGKILL);
  ASSERT_TRUE(killed);
  EXPECT_EQ(killed->signal, SIGKILL);
  ASSERT_TRUE(std::filesystem::exists(place.file("out/front.journal")));
  const ProgramResult resumed =
      place.run({"optimize", "spec.toml", "--out", "out", "--resume", "--columns", "100"});
  EXPECT_EQ(resumed.exit_code, 0);
  EXPECT_NE(resumed.err.find("searches of the front"), std::string::npos) << resumed.err;
  expect_same_files(results_in(place, "whole"), results_in(place, "out"));
  EXPECT_FALSE(std::filesystem::exists(place.file("out/front.journal")));
}

// Whatever a signal meets, the searches beyond bounds and the files too: who is told that a run is
// done has all of it, and an interrupted one can be gone on with.
TEST(Interrupted, RunsAreToldAsDoneOnlyWhenAllIsDone) {
  const Workplace place;
  place.write("spec.toml", replaced(long_task("0.001"), "S = [10, 20]", "S = [12, 14]"));
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(place.run(optimize_arguments("whole", true)).exit_code, 0);
  const auto whole = std::chrono::steady_clock::now() - begin;
  const ResultFiles files = results_in(place, "whole");
  const int times = sample(12, 24);
  int interrupted = 0;
  for (int k = 1; k <= times; ++k) {
    const std::string folder = "out" + std::to_string(k);
    RunningProgram program = place.start(optimize_arguments(folder, true));
    std::this_thread::sleep_for(whole * k / times);
    program.send(SIGINT);
    const auto ended = program.wait(seconds(20));
    ASSERT_TRUE(ended);
    if (!place.has(folder + "/summary.json")) {  // it had not begun
      EXPECT_EQ(ended->signal, SIGINT);
      continue;
    }
    const json summary = json::parse(place.read(folder + "/summary.json"));
    if (summary.at("interrupted") == true) {
      ++interrupted;
      EXPECT_EQ(ended->exit_code, kInterrupted);
      EXPECT_TRUE(place.has(folder + "/optimize.journal")) << ended->err;
    } else {  // 130 after, or while, what was found was told
      EXPECT_TRUE(ended->exit_code == kInterrupted || ended->exit_code == 0) << ended->signal;
      expect_same_files(results_in(place, folder), files);
      EXPECT_FALSE(place.has(folder + "/optimize.journal"));
    }
  }
  EXPECT_GT(interrupted, 0);
}

TEST(ResumeOption, TakesAFinishedResultForThatOfItsTaskOnly) {
  const Workplace place;
  const std::string task = replaced(example("rp96.toml"), "S = [10, 20]", "S = [12, 12]");
  place.write("spec.toml", task);
  ASSERT_EQ(place.run(optimize_arguments("out", false)).exit_code, 0);
  const auto again = place.run({"optimize", "spec.toml", "--out", "out", "--resume"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.err.find("out/summary.json: the result of this task, which ended"),
            std::string::npos)
      << again.err;
  const std::string best = place.read("out/best.toml");
  place.write("spec.toml", replaced(task, "coefficient = 0.1", "coefficient = 0.11"));
  const auto other = place.run(optimize_arguments("out", false, {"--resume"}));
  EXPECT_EQ(other.exit_code, kInvalidInput);
  EXPECT_NE(other.err.find("--resume: out/summary.json is the result of another task"),
            std::string::npos)
      << other.err;
  EXPECT_NE(other.err.find("allowed:"), std::string::npos) << other.err;
  EXPECT_EQ(place.read("out/best.toml"), best);
  EXPECT_EQ(place.run(optimize_arguments("out", false, {"--force"})).exit_code, 0);
}

/// The searches for K_gamma of the tolerances differ: they leave no journal.
TEST(Interrupted, RunsWithoutAJournalBeginAnew) {
  const Workplace place;
  const std::string load =
      "\n[stage1]\nface_width_mm = 8.0\n[stage2]\nface_width_mm = 8.0\n[material]\n"
      "name = \"34CrNiMo6 through hardened\"\n[tolerances]\nsamples = 1000\npin_position_um = 5\n"
      "[tolerances.P1]\ntooth_thickness_um = [-3, 0]\n[strength]\noutput_torque_nm = 100.0\n"
      "s_f_min = 1.5\nk_gamma = \"tolerances\"\n";
  place.write("spec.toml", long_task("0.02") + load);
  RunningProgram program = place.start({"optimize", "spec.toml", "--out", "out"});
  ASSERT_TRUE(program.wait_until_it_catches(SIGINT, seconds(20)));
  std::this_thread::sleep_for(milliseconds(300));
  program.send(SIGINT);
  const auto stopped = program.wait(seconds(20));
  ASSERT_TRUE(stopped);
  EXPECT_EQ(stopped->exit_code, kInterrupted) << stopped->err;
  EXPECT_NE(stopped->err.find("--resume begins anew\n"), std::string::npos) << stopped->err;
  EXPECT_EQ(json::parse(place.read("out/summary.json")).at("interrupted"), true);
  RunningProgram again = place.start({"optimize", "spec.toml", "--out", "out", "--resume"});
  ASSERT_TRUE(again.wait_until_it_catches(SIGINT, seconds(20)));
  again.send(SIGINT);
  const auto resumed = again.wait(seconds(20));
  ASSERT_TRUE(resumed);
  EXPECT_NE(resumed->err.find("which was interrupted and left nothing to go on with"),
            std::string::npos)
      << resumed->err;
}

}  // namespace
}  // namespace gear3k::resume_test
