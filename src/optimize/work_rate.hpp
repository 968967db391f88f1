#pragma once
// How fast work is done, and how long the rest of it will take.

#include <cstddef>
#include <optional>
#include <vector>

namespace gear3k::optimize {

/// Rate of work over the last half of the time that it has taken so far: items whose cost drifts
/// are told by the latest of them, and half of the time is enough of them for those whose cost
/// scatters.  Time is the caller's.
///
/// Accuracy: from a tenth of the work on, within a factor of two of what is left where the cost of
/// an item grows or shrinks evenly by up to three over the work, or scatters about a mean.
class WorkRate {
 public:
  /// Work begins (again) with so many items done.
  void restart(double now_s, std::size_t done);
  void observe(double now_s, std::size_t done);
  /// Items per second; empty while nothing was done.
  [[nodiscard]] std::optional<double> per_second() const;
  /// Time until `total` items are done; empty while nothing was done.
  [[nodiscard]] std::optional<double> seconds_left(std::size_t total) const;

 private:
  struct Seen {
    double at_s = 0.0;
    std::size_t done = 0;
  };
  std::vector<Seen> seen_;  ///< the beginning first, thinned where they are many
};

}  // namespace gear3k::optimize
