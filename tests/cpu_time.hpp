#pragma once
// What a test takes, whatever else the machine does.

#include <ctime>

namespace gear3k::test {

/// Time of processors that this program has taken so far [s].
inline double cpu_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// Time of processors that a call takes [s].
template <class Work>
double cpu_seconds_of(Work work) {
  const double begin = cpu_seconds();
  work();
  return cpu_seconds() - begin;
}

}  // namespace gear3k::test
