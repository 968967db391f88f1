#pragma once
// Campaigns of the wide rig put before `diagnose`, as files, and whether its answer is right.

#include <string>

#include "tests/wide_rig/wide_rig.hpp"

namespace gear3k::wide_rig {

struct Score {
  /// Every hidden effect is named by an effect of its own, by its cause or one that explains the
  /// data as well, and nothing else is; of a null: nothing is found at all.  Where the effect is
  /// none of the library: it is left unexplained, or only an alternative with a remainder.
  bool right = false;
  bool wrong_name = false;       ///< an effect that belongs to no hidden one
  bool false_remainder = false;  ///< a remainder beside names that are all right
  bool disclosed = false;        ///< every hidden cause is a name or an alternative
  bool lists_excluded = false;   ///< a name or an alternative that the data rule out
  /// Root mean square error on rows at unseen conditions, and that of the best model with one
  /// refitted parameter; NaN where the campaign has none.
  double unseen = 0.0, unseen_refit = 0.0;
  int intervals = 0, inside = 0;  ///< of parameters that have a truth
  double strength = 0.0;
  std::string answer;
};

/// @throws io::InvalidInput for files that cannot be read
Score score(const Campaign& campaign);

}  // namespace gear3k::wide_rig
