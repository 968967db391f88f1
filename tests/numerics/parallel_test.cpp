#include "numerics/parallel.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace gear3k::numerics::parallel_test {
namespace {

TEST(ParallelFor, CallsEveryIndexOnce) {
  std::vector<std::atomic<int>> calls(1000);
  parallel_for(calls.size(), [&](std::size_t k) { ++calls[k]; });
  for (const auto& count : calls) EXPECT_EQ(count.load(), 1);
}

TEST(ParallelFor, RethrowsAnExceptionAndBeginsNothingMore) {
  std::atomic<int> calls{0};
  try {
    parallel_for(100000, [&](std::size_t k) {
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

TEST(ParallelFor, RethrowsTheExceptionOfTheLowestIndexThoughAGreaterOneCameFirst) {
  // Where OMP_THREAD_LIMIT allows no second thread the lowest index comes first.
  const bool alone = omp_get_thread_limit() < 2;
  const int before = omp_get_max_threads();
  omp_set_num_threads(2);
  std::atomic<bool> greater{false};
  std::string told;
  try {
    parallel_for(8, [&](std::size_t k) {
      if (k == 5) {
        greater = true;
        throw std::runtime_error("five");
      }
      if (k == 2) {
        for (int wait = 0; wait < 5000 && !greater && !alone; ++wait) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        // Until that is caught.
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        throw std::runtime_error("two");
      }
    });
  } catch (const std::runtime_error& error) {
    told = error.what();
  }
  omp_set_num_threads(before);
  EXPECT_EQ(greater, !alone);
  EXPECT_EQ(told, "two");
}

}  // namespace
}  // namespace gear3k::numerics::parallel_test
