#include "sweep/process.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace gear3k::sweep {

namespace {

std::string content_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The 22nd field of /proc/N/stat; the second may hold blanks and ends with the last parenthesis.
/// A process that has ended and is not yet waited for has none.
std::int64_t began(std::int64_t number) {
  const std::string stat = content_of(fmt::format("/proc/{}/stat", number));
  const auto end = stat.rfind(')');
  if (end == std::string::npos) return 0;
  std::istringstream fields(stat.substr(end + 1));
  std::string field;
  constexpr int kState = 3, kStart = 22;
  for (int k = kState; k <= kStart; ++k) {
    if (!(fields >> field)) return 0;
    if (k == kState && (field == "Z" || field == "X")) return 0;
  }
  return std::stoll(field);
}

const std::string& this_host() {
  static const std::string host = [] {
    std::string boot = content_of("/proc/sys/kernel/random/boot_id");
    while (!boot.empty() && boot.back() == '\n') boot.pop_back();
    std::error_code none;
    const std::string space = std::filesystem::read_symlink("/proc/self/ns/pid", none).string();
    return fmt::format("{} {} {}", host_name(), boot, space);
  }();
  return host;
}

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.data();
}

Process this_process() { return process_of(::getpid()); }

Process process_of(std::int64_t number) {
  return {.host = this_host(), .number = number, .began = began(number)};
}

bool is_dead(const Process& process) { return process.host == this_host() && !is_alive(process); }

bool is_alive(const Process& process) {
  return process.host == this_host() && process.began != 0 &&
         began(process.number) == process.began;
}

}  // namespace gear3k::sweep
