#pragma once
// An operating map as `map` prints and writes it.

#include <string>

#include "design/operating_map.hpp"
#include "io/text/json.hpp"
#include "report/model_report.hpp"

namespace gear3k::report {

/// What a cell of table or figure says in place of an efficiency.
const char* absence(design::MapStatus status);

/// Efficiency grids in percent, torques over speed, breakaway, margin, heat.  Of a large grid every
/// n-th line and column, and the last.
/// @param model  with which the map was made; null: none
std::string map_table(const design::OperatingMap& map, const ModelUse* model = nullptr);

/// docs/interface.md, "map".
io::Json map_json(const design::OperatingMap& map, const ModelUse* model = nullptr);

/// One row per direction, speed and torque, a measurement file of kind `transmission` at that:
/// where there is no operation, its fields are empty.
std::string map_csv(const design::OperatingMap& map);

}  // namespace gear3k::report
