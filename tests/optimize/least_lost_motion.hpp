#pragma once
// A task of 27 tooth sets for least lost motion and efficiency.

#include <string>

#include "io/files/specification_file.hpp"

namespace gear3k::optimize::test {

/// Lost motion hardly changes with what the efficiency asks for: designs of least lost motion may
/// be far from the best efficiency that it leaves.
inline const std::string kLeastLostMotion = R"(preset = "machined"
objective = ["lost_motion", "backward_efficiency"]
[pareto]
points = 4
[ratio]
target = 96.0
tolerance = 0.03
[teeth]
S = [18, 19]
P1 = [40, 48]
P2 = [42, 44]
R1_max = 130
R2_max = 130
min_internal_difference = 9
[module]
stage1_mm = { series = [0.5, 0.6, 0.7, 0.8] }
stage2_mm = { series = [0.5, 0.6, 0.7, 0.8] }
[profile_shift]
range = [-0.3, 1.0]
[size]
ring_rim_mm = 2.5
max_outer_diameter_mm = 76.0
[backlash]
max_output_arcmin = 12.0
min_normal_um = 8.0
machining_allowance = 0.01
)";

inline Specification of_least_lost_motion() {
  return io::parse_specification(kLeastLostMotion, "task.toml");
}

}  // namespace gear3k::optimize::test
