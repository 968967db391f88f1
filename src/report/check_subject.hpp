#pragma once

#include <fmt/format.h>

#include <string>

namespace gear3k::report {

/// What a check is about, as tables and CSV name it: "S", "P1-R1" or "P1-R1, R1"; "" for the train.
/// @param c  anything with the names of a mesh and a gear
template <class Check>
std::string subject_of(const Check& c) {
  if (!c.mesh.empty() && !c.gear.empty()) return fmt::format("{}, {}", c.mesh, c.gear);
  return c.mesh + c.gear;
}

}  // namespace gear3k::report
