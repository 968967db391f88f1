// Time and memory of `gear3k diagnose` on long campaigns of the rig.
//
//   many_rows [ROWS...]       (by default 1000 10000 100000)

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

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

}  // namespace

int main(int argc, char** argv) {
  std::vector<int> counts;
  for (int k = 1; k < argc; ++k) counts.push_back(std::atoi(argv[k]));
  if (counts.empty()) counts = {1000, 10000, 100000};
  std::string pattern =
      (std::filesystem::temp_directory_path() / "gear3k_many_rows_XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) return 1;
  const std::filesystem::path folder = pattern;
  const rig::Gearbox gearbox = rig::bilateral_drive_gear();
  std::ofstream(folder / "gear.toml") << rig::design_toml(gearbox);
  fmt::print("{:>8} {:>9} {:>9} {:>9} {:>12} {:>9} {:>9}  {}\n", "rows", "wall s", "CPU s",
             "peak MB", "kB per row", "progress", "figures", "verdict");
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
    const std::filesystem::path results = folder / "results";
    const Usage use = run({GEAR3K_PROGRAM, "diagnose", (folder / "gear.toml").string(),
                           (folder / "data.csv").string(), "--out", results.string()},
                          folder);
    const std::string talk = read(folder / "stderr");
    const std::string table = read(folder / "stdout");
    std::uintmax_t figures = 0;
    for (const auto& entry : std::filesystem::directory_iterator(results)) {
      if (entry.path().extension() == ".svg") figures += entry.file_size();
    }
    const auto from = table.find("Verdict: ");
    const std::string verdict = from == std::string::npos
                                    ? "none"
                                    : table.substr(from + 9, table.find('\n', from) - from - 9);
    const auto rows = static_cast<double>(data.measured.size());
    fmt::print("{:>8} {:>9.1f} {:>9.1f} {:>9.1f} {:>12.2f} {:>9} {:>6} kB  {}\n",
               data.measured.size(), use.seconds, use.processor_s, use.peak_MB,
               1024.0 * use.peak_MB / rows, std::ranges::count(talk, '\n'), figures / 1024,
               verdict);
    std::fflush(stdout);
    right = right && use.exit_code == 0;
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return right ? 0 : 1;
}
