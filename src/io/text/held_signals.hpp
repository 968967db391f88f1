#pragma once
// Signals that wait until files are written.

#include <array>
#include <csignal>
#include <mutex>

namespace gear3k::io {

/// Holds back SIGHUP, SIGINT and SIGTERM while it exists, whichever thread they come to; those that
/// came are raised at its end, with whatever was set for them before.  What was ignored stays so.
///
/// Their handlers are those of the process: one thread holds them at a time, others wait.  What
/// comes to a holder within another one of its thread waits for the outer one.
class HeldSignals {
 public:
  HeldSignals();
  ~HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

 private:
  static constexpr std::array<int, 3> kSignals{SIGHUP, SIGINT, SIGTERM};

  std::unique_lock<std::recursive_mutex> only_one_;
  std::array<struct sigaction, kSignals.size()> before_{};
};

}  // namespace gear3k::io
