#pragma once
// Numbers of a tooth set that do not depend on what is refined before it.

#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// Counter-based uniform numbers in [0, 1): the same for a set whatever is refined before it.
class Uniform {
 public:
  explicit Uniform(unsigned long long seed) : state_(seed) {}
  double next() {
    // splitmix64 (Steele, Lea, Flood, 2014).
    state_ += 0x9E3779B97F4A7C15ULL;
    unsigned long long x = state_;
    x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
    x ^= x >> 31U;
    return static_cast<double>(x >> 11U) * 0x1.0p-53;
  }

 private:
  unsigned long long state_;
};

/// The stream of a tooth set.
inline unsigned long long stream_of(const Candidate& candidate, unsigned long long seed) {
  const train::ToothSet& z = candidate.teeth;
  unsigned long long stream = seed;
  for (const int count_of_teeth : {z.S, z.P1, z.R1, z.P2, z.R2, candidate.planets}) {
    stream = stream * 1000003ULL + static_cast<unsigned long long>(count_of_teeth);
  }
  return stream;
}

}  // namespace gear3k::optimize
