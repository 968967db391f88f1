#pragma once
// Which limits a result was made for: those of a preset, those stated, those left bare.

#include <string>

#include "design/checks.hpp"
#include "io/text/json.hpp"

namespace gear3k::report {

/// One line: the preset with its limits and those that were stated instead; without a preset the
/// limits of a workshop that nobody stated.  Then the other limits that leave no reserve.
std::string limits_line(const design::Limits& limits, bool of_pair = false);

/// preset (null without), bare and at_zero (names), in_force (by name, in the unit of the check;
/// those of a load are in its own tables).
io::Json limits_json(const design::Limits& limits);

}  // namespace gear3k::report
