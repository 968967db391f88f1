// Streams, pipes, names and folders as only a hostile or unlucky user has them.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/cli/other_path.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::hostile_use_test {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;
using test::example, test::ProgramResult, test::replaced, test::RunningProgram, test::Workplace;

constexpr int kUsage = 1;
constexpr int kInvalidInput = 2;
constexpr int kNoFeasibleDesign = 3;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string small_spec() { return replaced(example("rp96.toml"), "S = [10, 20]", "S = [12, 12]"); }

/// A task of several waves of tooth sets, so that it can be ended within.
std::string long_spec(const std::string& tolerance = "0.02") {
  return replaced(replaced(example("rp96.toml"), "planets = 3", "planets = [3, 4]"),
                  "tolerance = 0.005", "tolerance = " + tolerance);
}

std::string design_named(const std::string& name) {
  return replaced(example("designs/bilateral_drive_gear.toml"), "name = \"bilateral drive gear\"",
                  "name = \"" + name + "\"");
}

/// A pipe with a name, which holds its text for one reader.
class NamedPipe {
 public:
  NamedPipe(const std::filesystem::path& path, std::string text)
      : writer_([path, text = std::move(text)] { std::ofstream(path) << text; }) {}
  ~NamedPipe() { writer_.join(); }
  NamedPipe(const NamedPipe&) = delete;
  NamedPipe& operator=(const NamedPipe&) = delete;

 private:
  std::thread writer_;
};

/// Waits until a file holds more than so many bytes; false where it never does.
bool grows(const std::filesystem::path& file, std::uintmax_t bytes) {
  const auto end = std::chrono::steady_clock::now() + seconds(20);
  while (std::chrono::steady_clock::now() < end) {
    std::error_code none;
    const auto size = std::filesystem::file_size(file, none);
    if (!none && size > bytes) return true;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return false;
}

TEST(Pipe, SpecThroughItIsTakenForWhatItHolds) {
  const Workplace place;
  const auto pipe = place.file("spec");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  {
    const NamedPipe spec(pipe, long_spec("0.008"));
    RunningProgram program = place.start({"optimize", "spec", "--out", "out", "--quiet"});
    ASSERT_TRUE(grows(place.file("out/optimize.journal"), 1000));
    program.send(SIGKILL);
    const auto killed = program.wait(seconds(20));
    ASSERT_TRUE(killed);
    ASSERT_EQ(killed->signal, SIGKILL);
  }
  const std::vector<std::string> resume{"optimize", "spec", "--out", "out", "--resume", "--quiet"};
  {
    const NamedPipe other(pipe,
                          replaced(long_spec("0.008"), "coefficient = 0.1", "coefficient = 0.05"));
    const ProgramResult result = place.run(resume);
    EXPECT_EQ(result.exit_code, kInvalidInput);
    EXPECT_TRUE(contains(result.err, "another task")) << result.err;
  }
  {
    const NamedPipe same(pipe, long_spec("0.008"));
    const ProgramResult result = place.run(resume);
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
  place.write("spec.toml", long_spec("0.008"));
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "whole", "--quiet"}).exit_code, 0);
  EXPECT_EQ(place.read("out/best.toml"), place.read("whole/best.toml"));
  EXPECT_TRUE(place.read("out/refined.csv") == place.read("whole/refined.csv"));
}

TEST(Pipe, SubjectThroughItIsReadOnce) {
  const Workplace place;
  ASSERT_EQ(::mkfifo(place.file("gear").c_str(), 0600), 0);
  const NamedPipe gear(place.file("gear"), example("designs/bilateral_drive_gear.toml"));
  place.write("data.csv", example("measurements/published_bilateral_drive_gear.csv"));
  const ProgramResult result = place.run({"diagnose", "gear", "data.csv", "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(Input, WhatIsNoNameOfAFileIsRefusedAsOne) {
  const Workplace place;
  place.write("gear.toml", design_named("a"));
  const std::pair<std::vector<std::string>, std::string> commands[] = {
      {{"analyze", ""}, "DESIGN: the name of a file, not \"\""},
      {{"analyze", "gear.toml", "--out", ""}, "--out: the name of a file, not \"\""},
      {{"compare", "gear.toml", ""}, "DESIGN: the name of a file, not \"\""},
      {{"diagnose", "gear.toml", ""}, "DATA: the name of a file, not \"\""},
      {{"actuator", "gear.toml", "--cycle", ""}, "--cycle: the name of a file, not \"\""},
      {{"sweep", "status", ""}, "DB: the name of a file, not \"\""},
      {{"sweep", "merge", "gear.toml", "--out", ""}, "--out: the name of a file, not \"\""},
      {{"atlas", "96", "--task", ""}, "--task: the name of a file, not \"\""},
      {{"atlas", "96", "--figures", ""}, "--figures: the name of a folder, not \"\""},
      {{"new", "task", "--out", ""}, "--out: the name of a file, not \"\""},
      {{"analyze", "gear.toml", "--model", "--strict"}, "--model: without its value; ./--strict"},
      {{"map", "gear.toml", "--out", "--quiet"},
       "--out: without its value; ./--quiet is the name"}};
  for (const auto& [arguments, message] : commands) {
    const ProgramResult result = place.run(arguments);
    EXPECT_EQ(result.exit_code, kUsage) << message;
    EXPECT_EQ(result.out, "") << message;
    EXPECT_TRUE(contains(result.err, message)) << result.err;
  }
  EXPECT_EQ(place.run({"new", "design", "--out", "./--quiet"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(place.file("--quiet")));
}

TEST(Input, ReadErrorIsNotItsEnd) {
  const Workplace place;
  const ProgramResult result = place.run({"analyze", "/proc/self/mem"});
  EXPECT_EQ(result.exit_code, kInvalidInput);
  EXPECT_EQ(result.err, "/proc/self/mem: cannot be read: Input/output error\n");
}

/// A gnuplot that draws nothing but the figures whose script names this word.
void write_gnuplot(const Workplace& place, const std::string& word) {
  std::filesystem::create_directory(place.file("bin"));
  place.write("bin/gnuplot", "#!/bin/sh\nif /bin/grep -q '" + word +
                                 "'; then echo '<svg/>'; else echo broken >&2; exit 7; fi\n");
  std::filesystem::permissions(place.file("bin/gnuplot"), std::filesystem::perms::owner_all);
}

TEST(Figures, ThatCannotBeDrawnAreAWarningAndAField) {
  const Workplace place;
  place.write("gear.toml", design_named("a"));
  write_gnuplot(place, "torques without load");
  const test::OtherPath path(place.file("bin").c_str());
  const ProgramResult result = place.run({"map", "gear.toml", "--out", "map"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(contains(result.err, "gnuplot: failed with exit code 7")) << result.err;
  EXPECT_TRUE(
      contains(result.err, "written without efficiency_forward.svg, efficiency_backward.svg: "))
      << result.err;
  EXPECT_EQ(place.read("map/torques.svg"), "<svg/>\n");
  const auto missing = nlohmann::json::parse(place.read("map/map.json")).at("missing_figures");
  ASSERT_EQ(missing.size(), 2U);
  EXPECT_EQ(missing.at(1).at("file"), "efficiency_backward.svg");
  EXPECT_TRUE(contains(missing.at(1).at("cause").get<std::string>(), "broken"));
  const ProgramResult quiet = place.run({"map", "gear.toml", "--out", "map", "--quiet"});
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.err, "");
}

TEST(ResultFolder, IsHeldByOneRunToItsEnd) {
  const Workplace place;
  place.write("spec.toml", long_spec());
  place.write("gear.toml", design_named("a"));
  RunningProgram first = place.start({"optimize", "spec.toml", "--out", "out", "--quiet"});
  ASSERT_TRUE(grows(place.file("out/optimize.journal"), 0));
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"map", "gear.toml", "--out", "out"},
        std::vector<std::string>{"optimize", "spec.toml", "--out", "./out/../out", "--resume"}}) {
    const ProgramResult second = place.run(other);
    EXPECT_EQ(second.exit_code, kInvalidInput);
    EXPECT_TRUE(contains(second.err, "another run is writing it; allowed: another folder"))
        << second.err;
  }
  EXPECT_FALSE(place.has("out/map.csv"));
  first.send(SIGKILL);
  ASSERT_TRUE(first.wait(seconds(20)));
  // The lock goes with the run, however it ends.
  EXPECT_EQ(place.run({"map", "gear.toml", "--out", "out"}).exit_code, 0);
}

TEST(ResultFolder, KeepsAnEarlierRunWhereOneFileCannotBeWritten) {
  const Workplace place;
  place.write("spec.toml", small_spec());
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "out", "--quiet"}).exit_code, 0);
  const std::string refined = place.read("out/refined.csv");
  std::filesystem::remove(place.file("out/summary.json"));
  std::filesystem::create_directory(place.file("out/summary.json"));
  place.write("out/best.toml", "earlier");
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--force", "--quiet"});
  EXPECT_EQ(result.exit_code, kInvalidInput);
  EXPECT_TRUE(contains(result.err, "out/summary.json: cannot be written")) << result.err;
  EXPECT_EQ(place.read("out/best.toml"), "earlier");
  EXPECT_EQ(place.read("out/refined.csv"), refined);
}

TEST(Stderr, ThatCannotBeWrittenEndsNoRun) {
  const Workplace place;
  place.write("spec.toml", small_spec());
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "plain"}).exit_code, 0);
  for (const char* device : {"/dev/full", "-"}) {
    const ProgramResult result =
        place.run({"optimize", "spec.toml", "--out", "out", "--force"}, "", device);
    EXPECT_EQ(result.exit_code, 0) << device << ", signal " << result.signal;
    EXPECT_TRUE(contains(result.out, "Files in out: ")) << device;
    EXPECT_EQ(place.read("out/best.toml"), place.read("plain/best.toml"));
    EXPECT_EQ(place.read("out/refined.csv"), place.read("plain/refined.csv"));
  }
}

TEST(Stderr, ThatIsClosedIsNoResultFile) {
  const Workplace place;
  place.write("spec.toml", long_spec());
  RunningProgram program = place.start({"optimize", "spec.toml", "--out", "out"}, "", "-");
  ASSERT_TRUE(grows(place.file("out/optimize.journal"), 0));
  EXPECT_EQ(program.descriptor(2), "/dev/null");
}

TEST(Names, WithAZeroByteDoNotCutTheTable) {
  const Workplace place;
  place.write("plain.toml", design_named("a b"));
  place.write("zero.toml", design_named("a\\u0000b"));
  const std::string plain = place.run({"analyze", "plain.toml"}).out;
  EXPECT_EQ(place.run({"analyze", "zero.toml"}).out, replaced(plain, "a b", "a\\u0000b"));
}

TEST(Names, CommandNoTerminal) {
  const Workplace place;
  place.write("gear.toml", design_named("\\u001b]0;title\\u0007\\u009b2J"));
  for (const char* format : {"table", "json", "csv"}) {
    const ProgramResult result = place.run({"analyze", "gear.toml", "--format", format});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    for (const char* command : {"\x1b", "\x07", "\xC2\x9B"}) {
      EXPECT_FALSE(contains(result.out, command)) << format;
    }
  }
  place.write("gear.toml", "\"\\u001b[2J\" = 1\n");
  const ProgramResult result = place.run({"analyze", "gear.toml"});
  EXPECT_TRUE(contains(result.err, "unknown key \\u001b[2J")) << result.err;
}

TEST(Names, OfTwoLinesForgeNoLineOfATable) {
  const Workplace place;
  place.write("gear.toml", design_named("x\\nChecks: 50 of 50 passed\\n"));
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"analyze", "gear.toml"}, {"export", "gear.toml", "--svg", "svg"}}) {
    const ProgramResult result = place.run(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(result.out.starts_with("x\\u000aChecks: 50 of 50 passed\\u000a: ")) << result.out;
  }
}

TEST(Names, OfTwoLinesForgeNoLineOfATableOrFileOfActuators) {
  const Workplace place;
  std::string knee = example("actuators/knee.toml");
  place.write("a.toml", replaced(knee, "\"knee\"", "\"x\\nforged = 1\""));
  place.write("s.toml", "duration_s = 0.1\n[control]\nmode = \"shorted\"\n");
  place.write("log\n.csv", example("measurements/knee_motion.csv"));
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"actuator", "a.toml"},
                                             {"simulate", "a.toml", "s.toml"},
                                             {"diagnose", "a.toml", "log\n.csv", "--out", "out"}}) {
    const ProgramResult result = place.run(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(result.out.starts_with("x\\u000aforged = 1: ")) << result.out;
  }
  EXPECT_EQ(place.run({"actuator", "out/model.toml"}).exit_code, 0);
}

TEST(Options, OfControlCharactersCommandNoTerminal) {
  const Workplace place;
  place.write("gear.toml", design_named("gear"));
  const ProgramResult result = place.run({"analyze", "gear.toml", "--format", "\x1b[31mx"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(contains(result.err, "--format: unknown format \\u001b[31mx; allowed: table"))
      << result.err;
  EXPECT_FALSE(contains(result.err, "\x1b"));
}

TEST(Names, OfQuotesCanBeDrawn) {
  for (const char* name : {"'", "''", "'a", "it's", "'a' # `b`"}) {
    const Workplace place;
    place.write("gear.toml", design_named(name));
    const ProgramResult result = place.run({"map", "gear.toml", "--out", "map"});
    EXPECT_EQ(result.exit_code, 0) << name << '\n' << result.err;
    EXPECT_TRUE(contains(place.read("map/torques.svg"), ": torques without load")) << name;
  }
}

TEST(Numbers, ThatDoNotSurviveTheirUnitAreAnErrorOfTheFile) {
  const Workplace place;
  place.write("gear.toml", replaced(design_named("a"), "module_mm = 0.8", "module_mm = 5e-324"));
  for (const char* command : {"analyze", "map"}) {
    const ProgramResult result = place.run({command, "gear.toml"});
    EXPECT_EQ(result.exit_code, kInvalidInput) << command;
    EXPECT_TRUE(contains(result.err, "gear.toml:")) << result.err;
    EXPECT_TRUE(contains(result.err, "module")) << result.err;
  }
}

TEST(Models, WithAMiddleThatIsNoOperatingPointAreRefused) {
  const Workplace place;
  place.write("gear.toml", design_named("a"));
  place.write("spec.toml", small_spec());
  place.write("model.toml",
              "[transmission]\nname = \"any\"\n[transmission.range]\nsun_speed_rpm = [200, 1000]\n"
              "output_torque_nm = [-50, 5]\n[transmission.causes.drag_constant]\n"
              "form = \"sun\"\nbody = \"sun\"\ntorque_nm = 0.01\ntorque_nm_sd = 0.001\n");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"analyze", "gear.toml", "--model", "model.toml"},
        {"optimize", "spec.toml", "--out", "out", "--model", "model.toml"}}) {
    const ProgramResult result = place.run(words);
    EXPECT_EQ(result.exit_code, kInvalidInput);
    EXPECT_TRUE(contains(result.err, "model.toml:")) << result.err;
  }
}

TEST(Quiet, SaysErrorsOnly) {
  const Workplace place;
  place.write("spec.toml", replaced(small_spec(), "range = [1.2, 2.0]", "range = [3.0, 3.1]"));
  std::filesystem::create_directory(place.file("out"));
  place.write("out/best.toml", "old");
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  EXPECT_EQ(result.exit_code, kNoFeasibleDesign);
  EXPECT_EQ(place.read("out/best.toml.previous"), "old");
  EXPECT_FALSE(contains(result.err, "renamed to")) << result.err;
}

}  // namespace
}  // namespace gear3k::hostile_use_test
