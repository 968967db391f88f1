// main() of the benchmarks: the part that the program's own name, or its first argument, says.

#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

#include "benchmarks/program.hpp"

namespace gear3k::benchmarks {
namespace {

std::map<std::string, Main>& programs() {
  static std::map<std::string, Main> by_name;
  return by_name;
}

}  // namespace

Program::Program(const char* name, Main main) { programs()[name] = main; }

}  // namespace gear3k::benchmarks

int main(int argc, char** argv) {
  const auto& parts = gear3k::benchmarks::programs();
  for (int k = 0; k < 2 && k < argc; ++k) {
    const auto part = parts.find(std::filesystem::path(argv[k]).filename());
    if (part != parts.end()) return part->second(argc - k, argv + k);
  }
  std::printf("usage: gear3k_benchmarks NAME [ARGUMENT]...; NAME is one of\n");
  for (const auto& [name, part] : parts) std::printf("  %s\n", name.c_str());
  return 1;
}
