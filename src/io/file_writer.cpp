#include "io/file_writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "io/diagnostics.hpp"

namespace gear3k::io {

namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& cause) {
  throw InvalidInput(fmt::format("{}: cannot be written: {}", path, cause));
}

void write_through(const std::string& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  file.flush();
  if (!file) refuse(path, std::strerror(errno));
}

}  // namespace

void write_file(const std::string& path, const std::string& content) {
  std::error_code unknown;
  const auto target = std::filesystem::status(path, unknown);
  if (std::filesystem::is_other(target)) {
    write_through(path, content);
    return;
  }
  const std::string temporary = fmt::format("{}.{}.tmp", path, ::getpid());
  {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file << content;
    file.flush();
    if (!file) {
      const std::string cause = std::strerror(errno);
      std::error_code ignored;
      std::filesystem::remove(temporary, ignored);
      refuse(path, cause);
    }
  }
  std::error_code status;
  std::filesystem::rename(temporary, path, status);
  if (status) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
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
