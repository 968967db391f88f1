#pragma once
// What the model of a diagnosis predicts of rows that it has not seen.

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "calibrate/fit/holdout.hpp"

namespace gear3k::calibrate {

/// Rows as fits without their blocks predict them.
struct HeldOut {
  Blocks blocks;
  Eigen::VectorXd predicted;  ///< [SI]; NaN where the other rows say nothing of one
};
HeldOut held_out_rows(const Problem& problem, const Hypothesis& h,
                      const std::vector<Levels>& levels);

/// Said where holdout_blocks() has none.
std::string note_on_levels_in_sample();
/// Said where known_rows() are not all.
std::string note_on_known_rows(std::size_t known, std::size_t rows);

}  // namespace gear3k::calibrate
