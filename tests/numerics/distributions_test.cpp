#include "numerics/distributions.hpp"

#include <gtest/gtest.h>

namespace gear3k::numerics::distributions_test {
namespace {

TEST(Hypergeometric, CountsChoices) {
  // 3 of 8, 4 of which are marked: C(4, k) C(4, 3 − k) of the 56 choices.
  EXPECT_NEAR(hypergeometric_probability(8, 4, 3, 0), 4.0 / 56.0, 1e-13);
  EXPECT_NEAR(hypergeometric_probability(8, 4, 3, 1), 24.0 / 56.0, 1e-13);
  EXPECT_NEAR(hypergeometric_probability(8, 4, 3, 2), 24.0 / 56.0, 1e-13);
  EXPECT_NEAR(hypergeometric_probability(8, 4, 3, 3), 4.0 / 56.0, 1e-13);
}

TEST(Hypergeometric, IsZeroOfWhatCannotBe) {
  EXPECT_EQ(hypergeometric_probability(8, 4, 3, 4), 0.0);
  EXPECT_EQ(hypergeometric_probability(8, 2, 3, 3), 0.0);
  EXPECT_EQ(hypergeometric_probability(8, 7, 3, 1), 0.0);  // one is not marked
  EXPECT_EQ(hypergeometric_probability(8, 4, 3, -1), 0.0);
}

TEST(Hypergeometric, AddsUpToOneForManyRows) {
  double sum = 0.0;
  for (int k = 0; k <= 300; ++k) sum += hypergeometric_probability(20000, 5000, 300, k);
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(BinomialUpperTail, CountsOutcomes) {
  // 4 + 1 of the 16 of four coins.
  EXPECT_NEAR(binomial_upper_tail(4, 0.5, 3), 5.0 / 16.0, 1e-15);
  EXPECT_NEAR(binomial_upper_tail(2, 0.15, 2), 0.0225, 1e-15);
  EXPECT_EQ(binomial_upper_tail(4, 0.5, 0), 1.0);
  EXPECT_EQ(binomial_upper_tail(4, 0.5, 5), 0.0);
}

}  // namespace
}  // namespace gear3k::numerics::distributions_test
