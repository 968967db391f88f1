// Gives a fuzzer the inputs of folders, for builds without libFuzzer: a crash or an exception is
// the finding, and of fuzz/corpus an input that is refused, or is not and named refused_*.
//   fuzz_replay NAME FOLDER...

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "entry.hpp"

namespace gear3k::fuzz {
namespace {

std::map<std::string, Entry>& entries() {
  static std::map<std::string, Entry> by_name;
  return by_name;
}

std::vector<std::filesystem::path> files_of(const char* folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

Registered::Registered(const char* name, Entry entry) { entries()[name] = entry; }

}  // namespace gear3k::fuzz

int main(int argc, char** argv) {
  using namespace gear3k;
  const auto& fuzzers = fuzz::entries();
  const auto fuzzer = argc > 1 ? fuzzers.find(argv[1]) : fuzzers.end();
  if (fuzzer == fuzzers.end()) {
    std::printf("usage: fuzz_replay NAME FOLDER...; NAME is one of");
    for (const auto& [name, entry] : fuzzers) std::printf(" %s", name.c_str());
    std::printf("\n");
    return 1;
  }
  std::size_t inputs = 0, refused = 0, wrongly = 0;
  for (int k = 2; k < argc; ++k) {
    for (const std::filesystem::path& path : fuzz::files_of(argv[k])) {
      std::printf("%s\n", path.c_str());
      std::fflush(stdout);  // the last one is the one that crashed
      std::ifstream file(path, std::ios::binary);
      const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
      const bool refuses =
          fuzzer->second(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) != 0;
      ++inputs;
      refused += refuses ? 1 : 0;
      const bool kept = path.parent_path().parent_path().filename() == "corpus";
      const bool wrong = kept && refuses != path.filename().string().starts_with("refused_");
      wrongly += wrong ? 1 : 0;
      if (refuses || wrong) {
        std::printf("  %s%s\n", refuses ? "refused" : "accepted", wrong ? ", unlike its name" : "");
      }
    }
  }
  std::printf("%zu inputs, %zu refused\n", inputs, refused);
  return inputs > 0 && wrongly == 0 ? 0 : 1;
}
