#pragma once
// Measurement files together: those of one kind are one set.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "io/files/measurement_file.hpp"
#include "io/files/measurement_text.hpp"
#include "io/text/fnv_hash.hpp"

namespace gear3k::io {

/// Files one after the other, then all together, as read_measurements() states.
class MeasurementPool {
 public:
  explicit MeasurementPool(std::size_t files) { files_.reserve(files); }

  void add(const std::string& path, std::string_view text);
  void add_unreadable(const std::string& path, const std::string& reason);

  /// @throws InvalidInput with the errors of all files
  Measurements finish();

 private:
  struct File {
    std::string path;
    std::size_t size = 0;
    std::uint64_t hash = kHashBasis;  ///< of its bytes
    MeasurementText content = {};
  };
  using ByKind = std::array<std::vector<File*>, calibrate::kKindNames.size()>;

  static calibrate::MeasurementSet pooled(calibrate::Kind kind, const std::vector<File*>& files);
  ByKind by_kind();
  /// Complains of files without a unit where others of their kind state one.
  static void require_units(const ByKind& by_kind);
  [[nodiscard]] std::string errors() const;

  std::vector<File> files_;
  std::array<std::uint64_t, calibrate::kKindNames.size()> fingerprint_{kHashBasis, kHashBasis,
                                                                       kHashBasis, kHashBasis};
};

}  // namespace gear3k::io
