#pragma once
// Rows of one level of a covariate, and the senses in which they may be off.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrate/measurement/covariate_levels.hpp"

namespace gear3k::calibrate {

/// A level, or a level in one direction.
struct LevelGroup {
  std::string along;  ///< name of the covariate
  int level = 0;
  double at = kUnknown;  ///< mean value of the level, in the column's unit
  bool binned = false;
  int direction = 0;  ///< ±1, 0: both
};

/// Groups of rows for rows_together().
struct LevelGroups {
  std::vector<LevelGroup> group;  ///< of each column
  Eigen::MatrixXd columns;
};

/// Each level of each covariate, sessions one by one, and each twelfth of a turn of the output,
/// both ways and in each direction, with the senses in which its rows may be off: of the reading,
/// of what is lost, and of a sensor, which turn with the direction, the rotation or both.  Not of a
/// covariate whose groups would take more than 20 million entries: rows × levels × (senses + 2).
/// @param sessions  whether sessions are among them
LevelGroups level_groups(const MeasurementSet& data, const std::vector<Levels>& levels,
                         bool sessions = true);

/// "session wed_pm, forward", "speed 1238", "direction backward".
std::string level_text(const MeasurementSet& data, const LevelGroup& group);

}  // namespace gear3k::calibrate
