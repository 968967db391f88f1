#include "io/text/file_writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& cause) {
  throw InvalidInput(fmt::format("{}: cannot be written: {}", path, cause));
}

using Produce = std::function<void(const std::function<void(std::string_view)>&)>;

/// @returns whether all was written
bool write_to(const std::string& path, const Produce& produce) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  produce([&](std::string_view piece) {
    file.write(piece.data(), static_cast<std::streamsize>(piece.size()));
  });
  file.flush();
  return file.good();
}

}  // namespace

void write_file(const std::string& path, const std::string& content) {
  write_file_in_pieces(path, [&](const auto& out) { out(content); });
}

void write_file_in_pieces(const std::string& path, const Produce& produce) {
  std::error_code unknown;
  const auto target = std::filesystem::status(path, unknown);
  if (std::filesystem::is_other(target)) {
    if (!write_to(path, produce)) refuse(path, std::strerror(errno));
    return;
  }
  const std::string temporary = fmt::format("{}.{}.tmp", path, ::getpid());
  const auto remove_temporary = [&] {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
  };
  try {
    if (!write_to(temporary, produce)) refuse(path, std::strerror(errno));
  } catch (...) {
    remove_temporary();
    throw;
  }
  std::error_code status;
  std::filesystem::rename(temporary, path, status);
  if (status) {
    remove_temporary();
    refuse(path, status.message());
  }
}

void prepare_folder(const std::string& path) {
  std::error_code status;
  std::filesystem::create_directories(path, status);
  if (status || !std::filesystem::is_directory(path)) {
    throw InvalidInput(fmt::format("{}: cannot be made a folder: {}", path,
                                   status ? status.message() : "a file is in the way"));
  }
  if (::access(path.c_str(), W_OK) != 0) {
    throw InvalidInput(fmt::format("{}: cannot be written to: {}", path, std::strerror(errno)));
  }
}

}  // namespace gear3k::io
