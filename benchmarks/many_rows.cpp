// Time and memory of `gear3k diagnose` on long campaigns of the rig: with constant friction, and
// with a friction law, drags and bearings, which the tooth forces are iterated for; the times of
// both as a ratio, side by side.
//
//   many_rows [ROWS...]       (by default 120 1000 10000 100000)

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/program.hpp"
#include "tests/rig/rig.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace

struct Usage {
  int exit_code = -1;
  double seconds = 0.0, processor_s = 0.0, peak_MB = 0.0;
};

/// Runs the program; what it prints goes to files.
Usage run(std::vector<std::string> words, const std::filesystem::path& folder) {
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string out = (folder / "stdout").string();
  const std::string err = (folder / "stderr").string();
  const auto start = std::chrono::steady_clock::now();
  std::fflush(nullptr);
  const pid_t process = ::fork();
  if (process == 0) {
    if (std::freopen(out.c_str(), "w", stdout) == nullptr ||
        std::freopen(err.c_str(), "w", stderr) == nullptr) {
      ::_exit(127);
    }
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  rusage use{};
  if (process < 0 || ::wait4(process, &status, 0, &use) != process) return {};
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  Usage usage;
  usage.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  usage.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  usage.processor_s = seconds(use.ru_utime) + seconds(use.ru_stime);
  usage.peak_MB = static_cast<double>(use.ru_maxrss) / 1024.0;
  return usage;
}

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The design with everything that it can lose.
std::string with_losses(std::string design) {
  const auto insert_after = [&](std::string_view line, std::string_view text) {
    design.insert(design.find(line) + line.size(), text);
  };
  insert_after("[stage1]\n", "face_width_mm = 8.0\n");
  insert_after("[stage2]\n", "face_width_mm = 10.0\n");
  design.erase(design.find("[friction]"));
  return design +
         "[friction]\nloss_model = \"coulomb_path\"\nlaw = \"schlenk\"\nroughness_um = 0.8\n"
         "lubricant_factor = 1.0\n"
         "[lubricant]\ntemperature1_c = 40.0\nviscosity1_mm2_s = 220.0\ntemperature2_c = 100.0\n"
         "viscosity2_mm2_s = 19.0\ndensity_kg_m3 = 890.0\n"
         "[drag.S]\nconstant_nm = 0.003\n[drag.carrier]\nviscous_nms_per_rad = 0.002\n"
         "[drag.R2]\nconstant_nm = 0.1\n"
         "[bearings]\nplanet_coefficient = 0.003\nplanet_radius_mm = 4.0\n"
         "[operating_point]\nsun_speed_rpm = 600.0\noutput_torque_nm = 20.0\n";
}

}  // namespace

PROGRAM(many_rows)(int argc, char** argv) {
  std::vector<int> counts;
  for (int k = 1; k < argc; ++k) counts.push_back(std::atoi(argv[k]));
  if (counts.empty()) counts = {120, 1000, 10000, 100000};
  std::string pattern =
      (std::filesystem::temp_directory_path() / "gear3k_many_rows_XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) return 1;
  const std::filesystem::path folder = pattern;
  const rig::Gearbox gearbox = rig::bilateral_drive_gear();
  struct Subject {
    const char* name;
    std::string design;
  };
  const std::string plain = rig::design_toml(gearbox);
  const std::array<Subject, 2> subjects{
      {{.name = "constant", .design = plain}, {.name = "losses", .design = with_losses(plain)}}};
  fmt::print("{:>8} {:>9} {:>9} {:>9} {:>9} {:>12} {:>9} {:>9}  {}\n", "rows", "friction", "wall s",
             "CPU s", "peak MB", "kB per row", "progress", "figures", "verdict");
  bool right = true;
  for (const int count : counts) {
    rig::Plan plan = rig::transmission_plan();
    constexpr int kConditions = 40;  // of the plan
    plan.repeats = std::max(1, count / kConditions);
    const rig::Dataset data = rig::measure(gearbox, plan,
                                           {{.id = "drag_constant", .rms_in_noise = 1.0},
                                            {.id = "friction_speed", .rms_in_noise = 1.0}},
                                           5);
    std::ofstream(folder / "data.csv") << data.csv;
    std::array<double, 2> processor_s{};
    for (std::size_t k = 0; k < subjects.size(); ++k) {
      std::ofstream(folder / "gear.toml") << subjects[k].design;
      const std::filesystem::path results = folder / subjects[k].name / std::to_string(count);
      const Usage use = run({GEAR3K_PROGRAM, "diagnose", (folder / "gear.toml").string(),
                             (folder / "data.csv").string(), "--out", results.string()},
                            folder);
      processor_s[k] = use.processor_s;
      const std::string talk = read(folder / "stderr");
      const std::string table = read(folder / "stdout");
      std::uintmax_t figures = 0;
      std::error_code none;
      for (const auto& entry : std::filesystem::directory_iterator(results, none)) {
        if (entry.path().extension() == ".svg") figures += entry.file_size();
      }
      const auto from = table.find("Verdict: ");
      const std::string verdict = from == std::string::npos
                                      ? "none"
                                      : table.substr(from + 9, table.find('\n', from) - from - 9);
      const auto rows = static_cast<double>(data.measured.size());
      fmt::print("{:>8} {:>9} {:>9.1f} {:>9.1f} {:>9.1f} {:>12.2f} {:>9} {:>6} kB  {}\n",
                 data.measured.size(), subjects[k].name, use.seconds, use.processor_s, use.peak_MB,
                 1024.0 * use.peak_MB / rows, std::ranges::count(talk, '\n'), figures / 1024,
                 verdict);
      std::fflush(stdout);
      right = right && use.exit_code == 0;
    }
    fmt::print("{:>8} CPU time with losses over that with constant friction: {:.2f}\n",
               data.measured.size(), processor_s[1] / processor_s[0]);
    std::fflush(stdout);
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return right ? 0 : 1;
}
