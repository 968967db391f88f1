#pragma once
// Campaigns of the wide rig put before `diagnose`, as files, and whether its answer is right.

#include <limits>
#include <string>
#include <vector>

#include "app/diagnose.hpp"
#include "tests/wide_rig/wide_rig.hpp"

namespace gear3k::wide_rig {

/// A cause with the probability that the diagnosis gives it, and whether it is one of the truths.
struct Claim {
  double probability = 0.0;
  bool holds = false;
};

struct Score {
  /// Every hidden effect is named by an effect of its own, by its cause or one that explains the
  /// data as well, and nothing else is; of a null: nothing is found at all.  Where the effect is
  /// none of the library: it is left unexplained, or only an alternative with a remainder.
  bool right = false;
  bool wrong_name = false;       ///< an effect that belongs to no hidden one
  bool false_remainder = false;  ///< a remainder beside names that are all right
  bool disclosed = false;        ///< every hidden cause is a name or an alternative
  /// The verdict is one that fits: explained or ambiguous, nothing hidden no_discrepancy, an effect
  /// of no cause unexplained.
  bool verdict_fits = false;
  /// 1 - error of the extended model on held-out rows over that of the simulation as given, as the
  /// diagnosis states it; NaN where it states none.
  double gain = std::numeric_limits<double>::quiet_NaN();
  bool lists_excluded = false;  ///< a name or an alternative that the data rule out
  /// Root mean square error on rows at unseen conditions, and that of the refit of one parameter
  /// (coefficient of friction, clearance or gain) that fits the campaign best; NaN where there are
  /// none.
  double unseen = std::numeric_limits<double>::quiet_NaN(), unseen_refit = unseen;
  /// The same in a session after the campaign, as `--model` predicts it.
  double later = unseen, later_refit = unseen;
  int intervals = 0, inside = 0;  ///< of parameters that have a truth
  /// Every probability that the diagnosis states, of names, alternatives and of no cause.
  std::vector<Claim> claims{};
  double strength = 0.0, noise = 0.0;  ///< noise: standard deviation, unit of the response
  /// Of waves: bodies (and teeth) one of whose orders describes the rows as well, how many of them
  /// are named or listed, and whether the true one is.
  int orders = 0, orders_listed = 0;
  bool own_order_listed = false;
  /// Every effect: its name, then its alternatives.
  std::vector<std::vector<std::string>> explanations{};
  std::string verdict{}, answer{};

  /// Verdict, names, alternatives and held-out gain: right, the verdict fits, every hidden cause is
  /// a name or an alternative, nothing that the data rule out is, and the stated gain is above 0.
  bool all_right() const;
};

/// The text of a subject.toml of any kind, and its data, as `diagnose` gets them.
/// @throws io::InvalidInput for what cannot be read
calibrate::Subject subject_of(const std::string& text);
app::DiagnosisTask task_of(const calibrate::Subject& subject, const std::vector<File>& files);

/// @throws io::InvalidInput for files that cannot be read
Score score(const Campaign& campaign);

/// What becomes of the names when one of more than two sessions, or else a tenth of the rows in
/// their order, is left out.  Of a single step between sessions always a tenth: its only session on
/// one side would take the step with it.
struct LeftOut {
  bool same = false;  ///< the same names
  /// The same but for names that change places with one of their alternatives.
  bool same_or_alternatives = false;
  std::string answer{};
};
/// @param whole  the score of the campaign
/// @param part  which part; the remainder of the division by their number
/// @throws as score()
LeftOut leave_out(const Campaign& campaign, const Score& whole, std::size_t part);

}  // namespace gear3k::wide_rig
