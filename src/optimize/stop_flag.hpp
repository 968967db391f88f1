#pragma once

#include <atomic>

namespace gear3k::optimize {

/// The switch that ends a run, and one beside it that ends a part of it: a part that has a budget
/// ends when that is spent, and the run goes on.  Whoever ends the run ends the part with it, and
/// its end outlasts that of the part.
///
/// Any thread may call any of it, a signal handler too: one lock-free byte holds all.
class StopFlag {
 public:
  StopFlag() = default;
  explicit StopFlag(bool ended) : state_(ended ? kRunEnded : 0U) {}

  /// Ends the run, or takes that back.
  StopFlag& operator=(bool ended) {
    ended ? state_.fetch_or(kRunEnded) : state_.fetch_and(static_cast<Byte>(~kRunEnded));
    return *this;
  }
  /// Whether what runs is to end.
  [[nodiscard]] bool load(std::memory_order order = std::memory_order_seq_cst) const {
    return (state_.load(order) & (kRunEnded | kPartEnded)) != 0;
  }
  operator bool() const { return load(); }  // NOLINT(google-explicit-constructor): as atomic<bool>

  void open_part() { state_.fetch_or(kPartOpen); }
  [[nodiscard]] bool part_is_open() const { return (state_.load() & kPartOpen) != 0; }
  /// Ends the part that is open; without one nothing.
  void end_part() {
    Byte now = state_.load();
    while ((now & kPartOpen) != 0 &&
           !state_.compare_exchange_weak(now, static_cast<Byte>(now | kPartEnded))) {
    }
  }
  /// @returns whether its budget ended it
  bool close_part() { return (state_.fetch_and(kRunEnded) & kPartEnded) != 0; }

 private:
  using Byte = unsigned char;
  static constexpr Byte kRunEnded = 1U, kPartOpen = 2U, kPartEnded = 4U;
  std::atomic<Byte> state_{0};
  static_assert(std::atomic<Byte>::is_always_lock_free);
};

}  // namespace gear3k::optimize
