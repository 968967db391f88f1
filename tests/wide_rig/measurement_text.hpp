#pragma once

#include <string>
#include <vector>

#include "tests/wide_rig/bench_row.hpp"

namespace gear3k::wide_rig {

/// DATA.csv of a kind other than torque_angle. sigma: per row, used where a column states it.
std::string measurement_text(const std::string& kind, const BenchColumns& columns,
                             const std::vector<BenchRow>& rows, const std::vector<double>& readings,
                             const std::vector<double>& sigma);

}  // namespace gear3k::wide_rig
