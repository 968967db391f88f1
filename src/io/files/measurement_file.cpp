#include "io/files/measurement_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "io/files/measurement_pool.hpp"

namespace gear3k::io {

Measurements read_measurements(const std::vector<std::string>& paths) {
  MeasurementPool pool(paths.size());
  for (const std::string& path : paths) {
    std::error_code status;
    if (std::filesystem::is_directory(path, status)) {
      pool.add_unreadable(path, "is a directory, allowed: a CSV file");
      continue;
    }
    std::ifstream file(path, std::ios::binary);
    if (!file) {
      pool.add_unreadable(path, fmt::format("cannot be read: {}", std::strerror(errno)));
      continue;
    }
    std::ostringstream text;
    text << file.rdbuf();
    pool.add(path, std::move(text).str());
  }
  return pool.finish();
}

Measurements parse_measurements(const std::vector<FileText>& files) {
  MeasurementPool pool(files.size());
  for (const FileText& file : files) pool.add(file.path, file.text);
  return pool.finish();
}

}  // namespace gear3k::io
