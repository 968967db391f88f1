#include "calibrate/verdict/posterior.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/search/better_names.hpp"

namespace gear3k::calibrate::posterior_test {
namespace {

Effect effect(double delta_bic, std::vector<double> statistics) {
  Effect e;
  e.delta_bic = delta_bic;
  for (const double s : statistics) {
    Alternative a;
    a.statistic = s;
    e.alternatives.push_back(a);
  }
  return e;
}

double total(const Effect& e) {
  double sum = e.probability + e.no_cause;
  for (const Alternative& a : e.alternatives) sum += a.probability;
  return sum;
}

TEST(SetPosteriors, AddUpToOne) {
  for (const double bic : {-5.0, 0.0, 3.0, 50.0, 1e5}) {
    std::vector<Effect> effects{effect(bic, {}), effect(bic, {-2.0, 0.0, 5.9})};
    for (const bool structure : {false, true}) {
      set_posteriors(effects, structure);
      for (const Effect& e : effects) EXPECT_NEAR(total(e), 1.0, 1e-12) << bic;
    }
  }
}

TEST(SetPosteriors, OddsOfAnAlternativeFallLessAndLessByItsStatistic) {
  std::vector<Effect> effects{effect(200.0, {0.0, 5.7, 17.1})};
  set_posteriors(effects, false);
  const Effect& e = effects[0];
  EXPECT_GT(e.probability, e.alternatives[0].probability);
  // (1 + 5.7/5.7)^-3 and (1 + 17.1/5.7)^-3.
  EXPECT_NEAR(e.alternatives[0].probability / e.alternatives[1].probability, 8.0, 1e-9);
  EXPECT_NEAR(e.alternatives[0].probability / e.alternatives[2].probability, 64.0, 1e-9);
}

TEST(SetPosteriors, AnAlternativeIsLikelierThanTheNameFromWhereTheSearchTakesIt) {
  std::vector<Effect> effects{effect(200.0, {-kLikelier})};
  set_posteriors(effects, false);
  EXPECT_NEAR(effects[0].probability, effects[0].alternatives[0].probability, 1e-12);
}

TEST(SetPosteriors, WhatFitsFarBetterIsNotTakenAtItsStatistic) {
  std::vector<Effect> effects{effect(200.0, {-178.6})};
  set_posteriors(effects, false);
  EXPECT_GT(effects[0].probability, 0.2);
  EXPECT_NEAR(total(effects[0]), 1.0, 1e-12);
}

TEST(SetPosteriors, NoCauseIsLikelyWhereTheDataHardlyNeedOne) {
  const auto no_cause = [](double bic, bool structure, std::size_t effects) {
    std::vector<Effect> list(effects, effect(bic, {}));
    set_posteriors(list, structure);
    return list[0].no_cause;
  };
  EXPECT_GT(no_cause(2.0, false, 1), 0.8);
  EXPECT_LT(no_cause(300.0, false, 1), 0.02);
  EXPECT_GT(no_cause(60.0, true, 1), no_cause(60.0, false, 1));
  EXPECT_GT(no_cause(60.0, false, 2), no_cause(60.0, false, 1));
}

}  // namespace
}  // namespace gear3k::calibrate::posterior_test
