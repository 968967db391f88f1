#include "io/text/file_writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "io/text/diagnostics.hpp"
#include "io/text/held_signals.hpp"
#include "io/text/new_file.hpp"

namespace gear3k::io {

namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& cause) {
  throw InvalidInput(fmt::format("{}: cannot be written: {}", path, cause));
}

constexpr const char* kInTheWay = "a file is in the way; allowed: a folder, or a new name";

InvalidInput no_folder(const std::string& path, const std::string& cause) {
  return InvalidInput(fmt::format("{}: cannot be made a folder: {}", path, cause));
}

/// @param folder  what has to take the new name: that of the path, or one around it
void expect_writable(const std::string& path, const std::string& folder) {
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return;
  throw InvalidInput(fmt::format("{}: cannot be written to: {}", path, std::strerror(errno)));
}

/// Whether a path is written to as it stands, and not replaced by a new file: a pipe, a device, or
/// a link of the system to what a descriptor refers to (/dev/stdout), a regular file too.
bool belongs_to_system(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code unknown;
  if (fs::is_other(fs::status(path, unknown))) return true;
  if (!fs::is_symlink(fs::symlink_status(path, unknown))) return false;
  const fs::path folder = fs::weakly_canonical(fs::absolute(path).parent_path(), unknown);
  const fs::path target = (folder / fs::read_symlink(path, unknown)).lexically_normal();
  const auto of_system = [](const fs::path& p) {
    return p.string().starts_with("/proc/") || p.string().starts_with("/dev/");
  };
  return of_system(target) || of_system(folder / "");
}

using Produce = std::function<void(const std::function<void(std::string_view)>&)>;

void write_to_device(const std::string& path, const Produce& produce) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  produce([&](std::string_view piece) {
    file.write(piece.data(), static_cast<std::streamsize>(piece.size()));
  });
  file.flush();
  if (!file) refuse(path, std::strerror(errno));
}

}  // namespace

void write_file(const std::string& path, const std::string& content) {
  write_file_in_pieces(path, [&](const auto& out) { out(content); });
}

void write_file_in_pieces(const std::string& path, const Produce& produce) {
  if (belongs_to_system(path)) {
    write_to_device(path, produce);
    return;
  }
  const HeldSignals held;
  NewFile file(path);
  constexpr std::size_t kBlock = std::size_t{1} << 16U;
  std::string block;
  produce([&](std::string_view piece) {
    block += piece;
    if (block.size() < kBlock) return;
    file.write(block);
    block.clear();
  });
  file.write(block);
  file.sync();
  file.publish();
  file.keep();
}

void prepare_folder(const std::string& path) {
  std::error_code status;
  std::filesystem::create_directories(path, status);
  if (status || !std::filesystem::is_directory(path)) {
    throw no_folder(path, status ? status.message() : kInTheWay);
  }
  expect_writable(path, path);
}

void expect_folder(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code unknown;
  fs::path there = path;  // it, or the innermost folder around it that there is
  // A link to nothing is there: it is in the way.
  while (!there.empty() && !fs::exists(fs::symlink_status(there, unknown)) &&
         there != there.parent_path()) {
    there = there.parent_path();
  }
  if (there.empty()) there = ".";
  if (!fs::is_directory(there, unknown)) throw no_folder(path, kInTheWay);
  expect_writable(path, there.string());
}

void expect_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code unknown;
  if (belongs_to_system(path)) return;
  if (fs::is_directory(path, unknown)) refuse(path, "a folder has this name");
  // The last dot makes a file in the place of the folder an error too.
  if (::access((fs::path(path).parent_path() / ".").c_str(), W_OK | X_OK) != 0) {
    refuse(path, std::strerror(errno));
  }
}

}  // namespace gear3k::io
