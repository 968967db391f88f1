// What a calibrated model is worth to a designer: a gearbox is designed, built and measured in the
// rig, where something is hidden; one half of the campaign calibrates the model, and the gearbox is
// designed again with it.  Both designs are then built and measured.
//
//   calibrated_design [SEED]

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "benchmarks/program.hpp"
#include "io/files/design_file.hpp"
#include "tests/calibrate/built_design.hpp"
#include "tests/calibrate/redesign_spec.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace
using nlohmann::json;

struct Scenario {
  const char* name;
  std::vector<rig::HiddenCause> causes;
};

/// The radius of the pins is 0.3 base radii of P1.
std::vector<Scenario> scenarios() {
  return {
      {"planets on plain bushings (friction 0.1 on the pins)",
       {{.id = "bearing_load", .variant = "pins", .amplitude = 0.1}}},
      {"the same with a seal that drags on the sun",
       {{.id = "bearing_load", .variant = "pins", .amplitude = 0.1},
        {.id = "drag_constant", .variant = "sun", .amplitude = 0.01}}},
      {"planets on needles (friction 0.005 on the pins)",
       {{.id = "bearing_load", .variant = "pins", .amplitude = 0.005}}},
      {"friction_level: mu is 0.15, not 0.1", {{.id = "friction_level", .amplitude = 0.5}}},
      {"drag of 0.01 Nm at the sun", {{.id = "drag_constant", .amplitude = 0.01}}},
  };
}

/// A working folder, in which the program runs.
class Folder {
 public:
  Folder() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "gear3k_calibrated_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(path_ / name);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  void run(const std::string& arguments) const {
    const std::string command = fmt::format("cd '{}' && '{}' {} --quiet > stdout", path_.string(),
                                            GEAR3K_PROGRAM, arguments);
    if (std::system(command.c_str()) != 0) throw std::runtime_error(command);
  }

 private:
  std::filesystem::path path_;
};

rig::Gearbox built(const Folder& folder, const std::string& design) {
  return rig::built(io::read_design(folder.path(design)));
}

std::string teeth_text(const rig::Gearbox& gearbox) {
  return fmt::format("{}", fmt::join(gearbox.teeth, "/"));
}

std::string effects_text(const json& diagnosis) {
  std::string text = diagnosis["verdict"].get<std::string>();
  text += ':';
  for (const json& effect : diagnosis["effects"]) {
    text += ' ';
    text += effect["id"].get<std::string>();
    const json& p = effect["parameters"][0];
    text += fmt::format(" {} {:.4g} {}", p["name"].get<std::string>(), p["value"].get<double>(),
                        p["unit"].get<std::string>());
    if (effect["alternatives"].empty()) continue;
    std::vector<std::string> ids = effect["alternatives"];
    text += fmt::format(" (or {})", fmt::join(ids, ", "));
  }
  return text;
}

void print(const Scenario& scenario, std::uint64_t seed) {
  const Folder folder;
  folder.write("spec.toml", rig::kRedesignSpec);
  folder.run("optimize spec.toml --out first");
  const rig::Gearbox first = built(folder, "first/best.toml");
  const rig::Dataset campaign =
      rig::measure(first, rig::transmission_plan(), scenario.causes, seed);
  const auto halves = rig::halves_by_session(campaign.csv);
  folder.write("half1.csv", halves[0]);
  folder.write("half2.csv", halves[1]);
  folder.run("diagnose first/best.toml half1.csv --out found");
  const json found = json::parse(folder.read("found/diagnosis.json"));
  // On the other half, as given and with the model.
  std::array<double, 2> error{};
  folder.run("diagnose first/best.toml half2.csv --format json");
  error[0] = json::parse(folder.read("stdout"))["rmse"]["baseline_train"];
  folder.run("diagnose first/best.toml half2.csv --model found/model.toml --format json");
  error[1] = json::parse(folder.read("stdout"))["rmse"]["baseline_train"];
  folder.run("optimize spec.toml --model found/model.toml --out second");
  const rig::Gearbox second = built(folder, "second/best.toml");
  fmt::print("{}\n  diagnose, first half    {}\n", scenario.name, effects_text(found));
  fmt::print(
      "  error on the other half {:.5f} Nm as given, {:.5f} Nm with the model (noise {:.5f})\n",
      error[0], error[1], campaign.noise_sd);
  fmt::print("  teeth                   {} without, {} with the model\n", teeth_text(first),
             teeth_text(second));
  for (const bool forward : {false, true}) {
    const rig::Condition point{.forward = forward,
                               .sun_speed_rpm = 600.0,
                               .output_torque_Nm = 20.0,
                               .temperature_c = 35.0};
    const double before = rig::measured_efficiency(first, point, campaign.causes);
    const double after = rig::measured_efficiency(second, point, campaign.causes);
    fmt::print(
        "  built and measured      {:<8} {:.2f} % without, {:.2f} % with: gain {:+.2f} "
        "points, {:+.1f} % of the loss\n",
        forward ? "forward" : "backward", 100.0 * before, 100.0 * after, 100.0 * (after - before),
        100.0 * (after - before) / (1.0 - before));
  }
  std::fflush(stdout);
}

}  // namespace

PROGRAM(calibrated_design)(int argc, char** argv) {
  const std::uint64_t seed = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 3;
  for (const Scenario& scenario : scenarios()) print(scenario, seed);
  return 0;
}
