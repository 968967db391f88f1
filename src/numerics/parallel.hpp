#pragma once
// Loops in OpenMP threads out of which exceptions come as out of plain ones.

#include <atomic>
#include <cstddef>
#include <exception>

namespace gear3k::numerics {

/// Calls body(k) for k in [0, count) in OpenMP threads, in any order.
///
/// Nothing leaves the parallel region: after an exception no call of a greater k begins, and that
/// of the lowest k of all is rethrown when the others are done.
/// @param threads  false: too little work for threads; the calls are then made one after the other
template <class Body>
void parallel_for(std::size_t count, Body body, [[maybe_unused]] bool threads = true) {
  std::atomic<std::size_t> first_at{count};
  std::exception_ptr first;
#pragma omp parallel for schedule(dynamic) if (threads)
  for (std::size_t k = 0; k < count; ++k) {
    if (k > first_at.load(std::memory_order_relaxed)) continue;
    try {
      body(k);
    } catch (...) {
#pragma omp critical(gear3k_parallel_for_error)
      if (k < first_at) {
        first_at = k;
        first = std::current_exception();
      }
    }
  }
  if (first) std::rethrow_exception(first);
}

}  // namespace gear3k::numerics
