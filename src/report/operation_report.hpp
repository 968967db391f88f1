#pragma once
// A gearbox at its operating point, as `analyze` prints it.

#include <string>

#include "design/evaluation.hpp"
#include "io/text/json.hpp"

namespace gear3k::report {

/// One operation as JSON: torques, efficiency, powers, what each mesh, shaft and bearing loses.
io::Json operation_json(const design::Operation<double>& operation);

/// Torques, efficiency and losses in both drive directions; nothing without an operating point.
std::string operation_table(const design::Evaluation& e);

/// Both efficiencies with all losses, in one line.  @throws std::bad_optional_access without an
/// operating point
std::string operation_summary(const design::Evaluation& e);

/// Adds `operating_point`: null without one.
void add_operation(io::Json& json, const design::Evaluation& e);

/// Lines of analysis_csv().
std::string operation_csv(const design::Evaluation& e);

}  // namespace gear3k::report
