// Writes one campaign to a folder, to be looked at with the command-line tool:
//   wide_rig_dump LINE STRENGTH SEED FOLDER      wide_rig_dump --lines
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include "tests/wide_rig/wide_rig.hpp"

namespace {

using namespace gear3k::wide_rig;

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += ' ' + word;
  return text;
}

std::string truth_text(const Line& line, const Campaign& campaign) {
  std::string text = "line: " + line.name + "\nkind: " + campaign.kind +
                     "\nplan: " + campaign.plan + "\nnoise: " + campaign.noise_model +
                     "\nnoise_sd: " + std::to_string(campaign.noise_sd) +
                     "\nstrength: " + std::to_string(campaign.strength) +
                     "\nexcluded:" + joined(campaign.excluded) +
                     "\ncompanions:" + joined(campaign.companions) + '\n';
  for (const Truth& truth : campaign.truths) {
    text += "\ncause: " + truth.cause + "\nlaw: " + truth.law + "\nacts on: " + truth.acts_on +
            "\nstrength: " + std::to_string(truth.strength) +
            "\nacceptable:" + joined(truth.acceptable) + '\n';
    for (const TruthParameter& p : truth.parameters) {
      text += p.name + " = " + std::to_string(p.value) + ' ' + p.unit + '\n';
    }
  }
  return text;
}

int dump(const std::string& name, double strength, std::uint64_t seed,
         const std::filesystem::path& folder) {
  for (const Line& line : lines()) {
    if (line.name != name) continue;
    const Campaign campaign = make_campaign(line, strength, seed);
    std::filesystem::create_directories(folder);
    write(folder / "subject.toml", campaign.subject_toml);
    for (const File& file : campaign.files) write(folder / file.name, file.text);
    for (const File& file : campaign.unseen) write(folder / file.name, file.text);
    for (const File& file : campaign.later) write(folder / file.name, file.text);
    write(folder / "truth.txt", truth_text(line, campaign));
    return EXIT_SUCCESS;
  }
  std::cerr << "no line named '" << name << "'; --lines lists them\n";
  return EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 2 && std::string(argv[1]) == "--lines") {
      for (const Line& line : lines()) std::cout << line.name << '\n';
      return EXIT_SUCCESS;
    }
    if (argc == 5) return dump(argv[1], std::stod(argv[2]), std::stoull(argv[3]), argv[4]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  std::cerr << "usage: wide_rig_dump LINE STRENGTH SEED FOLDER | --lines\n";
  return EXIT_FAILURE;
}
