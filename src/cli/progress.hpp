#pragma once

#include <memory>
#include <string>

#include "optimize/progress.hpp"

namespace gear3k::cli {

/// Lets Ctrl-C and SIGTERM end a command without ProgressDisplay: with kInterrupted and a word on
/// stderr.
void end_on_interrupt();

/// Shows the progress of a run on stderr while it exists, and turns Ctrl-C into progress.stop.
///
/// On a terminal a bar with rate and remaining time, else a plain line every few seconds; nothing
/// when quiet.  A second Ctrl-C ends the program at once.  At most one may exist at a time.
class ProgressDisplay {
 public:
  ProgressDisplay(optimize::Progress& progress, bool quiet);
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
