#include "io/text/build_id.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

namespace gear3k::build_id_test {
namespace {

// readelf is of the same package as the linker.
TEST(BuildId, IsWhatReadelfReadsInTheProgram) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  std::FILE* pipe = ::popen(("readelf -n '" + program + "'").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string notes;
  std::array<char, 4096> part{};
  while (std::fgets(part.data(), part.size(), pipe) != nullptr) notes += part.data();
  ASSERT_EQ(::pclose(pipe), 0) << notes;
  std::string id;
  for (const char byte : io::build_id()) {
    id += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  }
  constexpr const char* kLabel = "Build ID: ";
  const auto at = notes.find(kLabel);
  const std::string expected =
      at == std::string::npos ? "" : notes.substr(at + 10, notes.find('\n', at) - at - 10);
  EXPECT_EQ(id, expected);
}

}  // namespace
}  // namespace gear3k::build_id_test
