#pragma once

#include <cstdint>
#include <string>

#include "sweep/database.hpp"

namespace gear3k::sweep {

/// What a merge found in one database.
struct Merged {
  std::int64_t added = 0;      ///< results that were not known
  std::int64_t known = 0;      ///< the same result was there
  std::int64_t differing = 0;  ///< another result was there, and is kept
  std::int64_t open = 0;       ///< tasks without a result
};

/// Takes runs and results of another database over, by their keys: all of it or nothing, and
/// nothing the second time.
/// @throws io::InvalidInput as Database
Merged merge(Database& into, const std::string& path);

}  // namespace gear3k::sweep
