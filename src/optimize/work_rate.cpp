#include "optimize/work_rate.hpp"

#include <algorithm>

namespace gear3k::optimize {

void WorkRate::restart(double now_s, std::size_t done) {
  seen_.assign(1, {.at_s = now_s, .done = done});
}

void WorkRate::observe(double now_s, std::size_t done) {
  constexpr std::size_t kMost = 2048;
  if (seen_.size() >= kMost) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < seen_.size(); k += 2) seen_[kept++] = seen_[k];
    seen_.resize(kept);
  }
  seen_.push_back({.at_s = now_s, .done = done});
}

std::optional<double> WorkRate::per_second() const {
  if (seen_.size() < 2) return std::nullopt;
  const Seen& last = seen_.back();
  const double middle = 0.5 * (seen_.front().at_s + last.at_s);
  auto from = std::ranges::upper_bound(seen_, middle, {}, &Seen::at_s);
  // What was seen last before the middle; before that, should nothing be done since.
  if (from != seen_.begin()) --from;
  while (from != seen_.begin() && from->done >= last.done) --from;
  if (!(last.at_s > from->at_s) || last.done <= from->done) return std::nullopt;
  return static_cast<double>(last.done - from->done) / (last.at_s - from->at_s);
}

std::optional<double> WorkRate::seconds_left(std::size_t total) const {
  const std::optional<double> rate = per_second();
  if (!rate) return std::nullopt;
  const std::size_t done = std::min(total, seen_.back().done);
  return static_cast<double>(total - done) / *rate;
}

}  // namespace gear3k::optimize
