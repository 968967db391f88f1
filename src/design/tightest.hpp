#pragma once
// Which checks of a design are nearest to their limits, and what a shorter tip does for them.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "design/evaluation.hpp"

namespace gear3k::design {

/// The least change of a gear's tip radius, in whole micrometres, with which a check of
/// interference meets its limit.
struct TipRemedy {
  std::string gear;
  double shorter_m = 0.0;  ///< > 0: the tip has to be so much shorter; < 0: it may be longer
};

struct TightestCheck {
  const CheckResult* check = nullptr;  ///< of the evaluation
  /// Margin over the limit, or over 0.5 mm, 1 module, 1 arcmin or 1 where that is more.
  double share = 0.0;
  std::optional<TipRemedy> tip;
};

/// What a margin is small against: the limit, or 0.5 mm, 1 module, 1 arcmin or 1 where that is 0.
double margin_scale(const CheckResult& check);

/// The check of every record that has the least share; failed ones first, then by rising share.
/// Records that are met or not (assembly) are listed where they fail.  Tips are solved by
/// evaluating the design with a tip up to half a module shorter, or 0.3 modules longer, for the
/// first three checks of the group "interference" within 5 %, to 1e-4 modules.
/// @param count  entries at most
std::vector<TightestCheck> tightest_checks(const Design& design, const Evaluation& evaluation,
                                           std::size_t count);
std::vector<TightestCheck> tightest_checks(const PairDesign& design,
                                           const PairEvaluation& evaluation, std::size_t count);

}  // namespace gear3k::design
