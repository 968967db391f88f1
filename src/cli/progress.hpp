#pragma once

#include <memory>
#include <string>

#include "optimize/progress.hpp"

namespace gear3k::cli {

/// Lets Ctrl-C and SIGTERM end a command without ProgressDisplay: with kInterrupted and a word on
/// stderr, until results_begin() with the word that nothing is kept.
void end_on_interrupt();

/// Says that from here on results are printed or written.
void results_begin();

/// Shows the progress of a run on stderr while it exists, and turns Ctrl-C into progress.stop.
///
/// On a terminal a bar with rate and remaining time, else a plain line every few seconds; nothing
/// when quiet.  A second Ctrl-C ends the program at once.  At most one may exist at a time.  Where
/// signals are held (io::HeldSignals) before it ends, they stay so.
class ProgressDisplay {
 public:
  /// What the counters count.
  enum class Counts {
    kOfPhase,          ///< by Progress::phase
    kSharesDiagnosed,  ///< done of total is the share of a diagnosis; the phase means nothing
    kSharesSimulated,  ///< the same of a motion's time
  };

  /// @param front_budget_s  time after which the search of a front is ended; 0: none
  ProgressDisplay(optimize::Progress& progress, bool quiet, Counts counts = Counts::kOfPhase,
                  double front_budget_s = 0.0);
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// Seconds since construction.
  [[nodiscard]] double elapsed_s() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gear3k::cli
