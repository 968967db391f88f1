// Writes one series to a folder, to be looked at with the command-line tool:
//   series_rig_dump SCENARIO SEED FOLDER      series_rig_dump --scenarios
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include "tests/series_rig/series_rig.hpp"

namespace {

using namespace gear3k::series_rig;

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

int dump(const std::string& name, std::uint64_t seed, const std::filesystem::path& folder) {
  for (const SeriesScenario& scenario : scenarios()) {
    if (scenario.name != name) continue;
    const SeriesCampaign campaign = make_series(scenario, seed);
    std::filesystem::create_directories(folder);
    write(folder / "subject.toml", campaign.subject_toml);
    for (const auto& file : campaign.files) write(folder / file.name, file.text);
    std::string truth;
    for (const SeriesTruth& t : campaign.truths) {
      truth.append(t.cause).append(" ").append(t.parameter).append(":");
      for (const double v : t.values) truth.append(" ").append(std::to_string(v));
      truth += '\n';
    }
    write(folder / "truth.txt", truth);
    return 0;
  }
  std::cerr << "no scenario '" << name << "'\n";
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 2 && std::string(argv[1]) == "--scenarios") {
      for (const SeriesScenario& scenario : scenarios()) std::cout << scenario.name << '\n';
      return 0;
    }
    if (argc == 4) return dump(argv[1], std::strtoull(argv[2], nullptr, 10), argv[3]);
    std::cerr << "series_rig_dump SCENARIO SEED FOLDER\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
  }
  return 2;
}
