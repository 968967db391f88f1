#pragma once

#include <cstddef>
#include <exception>
#include <vector>

namespace gear3k::optimize {

/// Calls body(k) for k in [0, count) in OpenMP threads, in any order.
///
/// Nothing leaves the parallel region: of the exceptions thrown, that of the lowest k is rethrown
/// when all calls are done, so that the outcome does not depend on timing.
template <class Body>
void parallel_for(std::size_t count, Body body) {
  std::vector<std::exception_ptr> errors(count);
#pragma omp parallel for schedule(dynamic)
  for (std::size_t k = 0; k < count; ++k) {
    try {
      body(k);
    } catch (...) {
      errors[k] = std::current_exception();
    }
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace gear3k::optimize
