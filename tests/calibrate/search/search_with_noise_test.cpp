#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <string>

#include "calibrate/search/free_shapes.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "tests/calibrate/rig_campaign.hpp"

namespace gear3k::calibrate::search_with_noise_test {
namespace {

TEST(ManyRows, AreSearchedInSomeOfThemWithTheirMemoryAndTheirNumber) {
  // Readings of lost motion that remember, and a clearance of seven standard errors.
  constexpr int kRows = 24'010;
  constexpr double kSearched = 12'000.0, kSigma = 1e-4, kCorrelation = 0.5;
  const Simulation simulation(some_black_box(), Kind::kLostMotion);
  MeasurementSet data;
  data.kind = Kind::kLostMotion;
  for (int i = 0; i < kRows; ++i) {
    Observation row;
    row.condition.time_s = 10.0 * i;
    row.condition.test_torque_Nm = 5.0 * (1 + (3 * i) % 5);
    data.rows.push_back(row);
  }
  const Eigen::VectorXd clean = simulated(simulation, data, {}).value();
  RandomBits random(7);
  double before = random.normal();
  for (int i = 0; i < kRows; ++i) {
    data.rows[static_cast<std::size_t>(i)].response = clean[i] + kSigma * (before + 0.09);
    before = kCorrelation * before + std::sqrt(1.0 - kCorrelation * kCorrelation) * random.normal();
  }
  const auto d = diagnose_as_read(simulation, data, {});
  EXPECT_EQ(std::ranges::count_if(d->notes,
                                  [](const std::string& note) {
                                    return note.find("searched for in 12000 of 24010 rows") !=
                                           std::string::npos;
                                  }),
            1);
  EXPECT_NEAR(d->memory.memory.correlation(), kCorrelation, 0.1);
  EXPECT_EQ(d->rows.size(), data.rows.size());
  // E = −ln P(χ²_1 ≥ X) + ln w, X = −(ν − 1/2) ln(1 − R²): then ΔBIC = −n ln(1 − R²) − ln n.
  const auto found = std::ranges::find(d->evidence, "clearance", &CauseEvidence::id);
  ASSERT_NE(found, d->evidence.end());
  const std::vector<Candidate> all = candidates_for(simulation, data);
  const auto clearance =
      std::ranges::find_if(all, [](const Candidate& c) { return c.cause->id == "clearance"; });
  ASSERT_NE(clearance, all.end());
  const double p = std::exp(log_weight_of(*clearance) - found->evidence);
  const double statistic = quantile(complement(boost::math::chi_squared(1), p));
  ASSERT_GT(statistic, 10.0);
  EXPECT_NEAR(found->delta_bic,
              kSearched * statistic / (kSearched - 1.0 - 0.5) - std::log(kSearched), 0.02);
}

}  // namespace
}  // namespace gear3k::calibrate::search_with_noise_test
