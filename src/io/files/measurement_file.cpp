#include "io/files/measurement_file.hpp"

#include "io/files/measurement_pool.hpp"
#include "io/text/file_reader.hpp"

namespace gear3k::io {

namespace {

constexpr std::size_t kMostMeasurementBytes = std::size_t{1} << 30U;  ///< of a measurement file

}  // namespace

Measurements read_measurements(const std::vector<std::string>& paths) {
  MeasurementPool pool(paths.size());
  for (const std::string& path : paths) {
    const FileBytes file = read_bytes(path, "a CSV file", kMostMeasurementBytes);
    if (file.failure.empty()) {
      pool.add(path, file.bytes);
    } else {
      pool.add_unreadable(path, file.failure);
    }
  }
  return pool.finish();
}

Measurements parse_measurements(const std::vector<FileText>& files) {
  MeasurementPool pool(files.size());
  for (const FileText& file : files) pool.add(file.path, file.text);
  return pool.finish();
}

}  // namespace gear3k::io
