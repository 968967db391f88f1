#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sweep/rows.hpp"

namespace gear3k::sweep {

/// What a merge found in one database.
struct Merged {
  std::int64_t added = 0;      ///< results that were not known
  std::int64_t known = 0;      ///< the same result was there
  std::int64_t differing = 0;  ///< another result was there, and is kept
  std::int64_t open = 0;       ///< tasks without a result
};

/// Takes runs and results of another database over as it is at one moment, by their keys: all of it
/// or nothing, and nothing the second time.
/// @throws io::InvalidInput as Database
Merged merge(Database& into, const std::string& path);

/// The same of several databases into a file, made when missing: a row for each.  Where it had to
/// be made and nothing came into it, it is removed again.
/// @throws io::InvalidInput as Database, before anything is written for a file that is no database
///   of a sweep
Rows merge(const std::vector<std::string>& paths, const std::string& into);

}  // namespace gear3k::sweep
