#pragma once

#include <cstdint>
#include <random>

namespace gear3k {

/// Random numbers for properties; the seed makes them the same in every run.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint_fast64_t seed) : generator_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

 private:
  std::mt19937_64 generator_;
};

}  // namespace gear3k
