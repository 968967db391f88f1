#pragma once
// What a sweep varies: table [vary] of SWEEP.toml.

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "io/keys/key_registry.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::sweep {

/// Keys that move together, and their values: point k has one for each key.
struct Axis {
  std::vector<std::string> paths;
  std::vector<std::vector<io::TomlValue>> points;
};

/// What [vary] states.
struct Vary {
  std::vector<Axis> axes;
  std::set<std::string> paths;  ///< that it varies, with values that are refused too
  bool paths_known = true;      ///< false: unknown keys, or rows that cannot be read, may be others
  io::CollectedErrors of_rows;  ///< what is wrong with files of rows
};

/// Values that one range, list or table of rows may give.
inline constexpr std::int64_t kMostOnAxis = 1'000'000;

/// Reads [vary]: a list of values or a range { min, max, step | count, log } for each key of a
/// SPEC, `zip` = tables of such lists that move together, `rows` = a CSV file whose header are
/// keys.
///
///   step: min, min + step, ... up to max;  count: min + k (max - min)/(count - 1),
///   with log = true min (max/min)^(k/(count - 1));  k = 0 .. count - 1, 12 significant digits.
///
/// Every value is checked as one of its key; what is wrong is told in `reading`.
/// @param folder   the one that `rows` is relative to
Vary read_vary(const io::TomlValue& vary, const std::string& folder, io::FileReading& reading);

/// How many combinations they have; the greatest number where they are more.
std::uint64_t combinations(const std::vector<Axis>& axes);

/// A member of nested tables, made where it is missing and replaced where it is there.
void set_at(io::TomlValue& document, const std::string& path, io::TomlValue value);
/// Whether a document has a member.
bool has_at(const io::TomlValue& document, const std::string& path);

}  // namespace gear3k::sweep
