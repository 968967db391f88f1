#include "numerics/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace gear3k::optimize::parallel_test {
namespace {

TEST(ParallelFor, CallsEveryIndexOnce) {
  std::vector<std::atomic<int>> calls(1000);
  numerics::parallel_for(calls.size(), [&](std::size_t k) { ++calls[k]; });
  for (const auto& count : calls) EXPECT_EQ(count.load(), 1);
}

TEST(ParallelFor, RethrowsAnExceptionAndBeginsNothingMore) {
  std::atomic<int> calls{0};
  try {
    numerics::parallel_for(100000, [&](std::size_t k) {
      ++calls;
      if (k == 3) throw std::runtime_error("three");
      // Long enough that no other thread does all the rest meanwhile.
      std::this_thread::sleep_for(std::chrono::microseconds(20));
    });
    FAIL() << "the exception was lost";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), "three");
  }
  EXPECT_LT(calls.load(), 100000);
}

}  // namespace
}  // namespace gear3k::optimize::parallel_test
