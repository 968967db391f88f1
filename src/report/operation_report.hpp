#pragma once
// A gearbox at its operating point, as `analyze` prints it.

#include <string>

#include "design/evaluation.hpp"
#include "report/fields.hpp"

namespace gear3k::report {

/// One operation: torques, efficiency, powers, what each mesh, shaft and bearing loses.
/// @param item  of the rows
Fields operation_fields(const std::string& item, const design::Operation<double>& operation);
/// `operating_point`: the point and what happens there in both drive directions.
Fields operating_point_fields(const design::OperatingResult& operation);

/// Torques, efficiency and losses in both drive directions; nothing without an operating point.
std::string operation_table(const design::Evaluation& e);

/// Both efficiencies with all losses, in one line.  @throws std::bad_optional_access without an
/// operating point
std::string operation_summary(const design::Evaluation& e);

}  // namespace gear3k::report
