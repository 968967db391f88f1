#pragma once
// Designs side by side.

#include <string>
#include <vector>

#include "design/design.hpp"
#include "report/comparison_report.hpp"

namespace gear3k::app {

struct CompareRequest {
  struct Item {
    design::Design design;
    std::string source;  ///< its file
  };
  std::vector<Item> designs;  ///< two or more
};

/// Evaluates designs for a comparison.  Labels are their names where these are there and differ,
/// else their files, numbered where one is given twice.
/// @throws io::InvalidInput where a geometry is not defined, one message for all of them
/// @throws std::invalid_argument for fewer than two designs
std::vector<report::ComparedDesign> compare(const CompareRequest& request);

}  // namespace gear3k::app
