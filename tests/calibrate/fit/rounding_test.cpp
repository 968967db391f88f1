#include "calibrate/fit/rounding.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "calibrate/search/search.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "calibrate/verdict/noise_level.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::rounding_test {
namespace {

/// A sensor whose noise is a share of the reading, read in steps that are coarse at small loads.
class Rounding : public Bench {
 protected:
  static constexpr double kNoise = 0.004, kStep = 0.0071;

  Rounding() {
    data_ = measured_grid(
        {.sun_speeds_rpm = {600.0}, .output_torques_Nm = {4.0, 20.0, 60.0}, .repeats = 8});
    measure({}, 0.0, 1);
  }
  void read(const Hypothesis& truth, double step, std::uint64_t seed) {
    measure(truth, 0.0, seed);
    rig::DeterministicRandom random(seed);
    for (Observation& row : data_.rows) {
      const double analog = row.response * (1.0 + kNoise * random.normal());
      row.response = step > 0.0 ? step * std::round(analog / step) : analog;
    }
  }
};

TEST_F(Rounding, StepsAreFoundWhateverTheirSize) {
  read({}, kStep, 2);
  const auto steps = reading_steps(data_);
  ASSERT_TRUE(steps);
  EXPECT_NEAR(steps->step, kStep, 1e-9);
  // From a zero that is off.
  for (Observation& row : data_.rows) row.response += 0.0033;
  ASSERT_TRUE(reading_steps(data_));
  EXPECT_NEAR(reading_steps(data_)->step, kStep, 1e-9);
  read({}, 0.0, 2);
  EXPECT_FALSE(reading_steps(data_));
  EXPECT_FALSE(before_rounding(data_, clean_, 1));
}

TEST_F(Rounding, WhatMayHaveBeenReadBeforeItIsNormalInEachState) {
  read({}, kStep, 3);
  const auto before = before_rounding(data_, clean_, 1);
  ASSERT_TRUE(before);
  struct Sums {
    double n = 0.0, z = 0.0, zz = 0.0, rounded = 0.0;
  };
  std::map<double, Sums> states;  // by the clean response
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    const double clean = clean_[static_cast<Eigen::Index>(i)], sigma = kNoise * clean;
    const double z = (before->rows[i].response - clean) / sigma;
    Sums& s = states[std::round(clean * 1e6)];
    s.n += 1.0;
    s.z += z;
    s.zz += z * z;
    s.rounded += (data_.rows[i].response - clean) / sigma;
    EXPECT_LE(std::abs(before->rows[i].response - data_.rows[i].response), 0.5001 * kStep);
  }
  ASSERT_EQ(states.size(), 6U);
  double farthest = 0.0;
  for (const auto& [clean, s] : states) {
    const double error = 1.0 / std::sqrt(s.n);
    farthest = std::max(farthest, std::abs(s.rounded / s.n) / error);
    EXPECT_LT(std::abs(s.z / s.n), 4.5 * error) << clean;
    // Readings that are all one say of their noise that it is small.
    if (1e-6 * clean * kNoise < 0.15 * kStep) continue;
    EXPECT_GT(s.zz / s.n, 0.3) << clean;
    EXPECT_LT(s.zz / s.n, 2.5) << clean;
  }
  // While the readings themselves are off by many standard errors.
  EXPECT_GT(farthest, 10.0);
  const auto again = before_rounding(data_, clean_, 1);
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    EXPECT_EQ(again->rows[i].response, before->rows[i].response);
  }
}

TEST_F(Rounding, IsNotOfTorquesThatWereSet) {
  // Few values of the sun's torque, and a load of its own in each row: that was read.
  read({}, kStep, 2);
  ASSERT_TRUE(before_rounding(data_, clean_, 1));
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.output_torque_Nm += 1e-3 * static_cast<double>(i);
  }
  EXPECT_FALSE(before_rounding(data_, clean_, 1));
}

TEST_F(Rounding, IsNoDiscrepancyAndHidesNone) {
  read({}, kStep, 1);
  EXPECT_NE(diagnose_as_read(simulation_, data_, {})->verdict, Verdict::kNoDiscrepancy);
  EXPECT_EQ(diagnose(simulation_, data_, {})->verdict, Verdict::kNoDiscrepancy);
  Hypothesis rough;
  for (const Candidate& c : candidates_for(simulation_, data_)) {
    if (c.cause->id == "friction_level" && c.form.name == "coefficient") rough = with({}, c);
  }
  rough.value = {0.15};
  read(rough, kStep, 1);
  EXPECT_FALSE(diagnose(simulation_, data_, {})->effects.empty());
}

TEST_F(Rounding, ErrorsAndSigmaAreOfTheReadingsWhateverRowCannotBeSimulated) {
  read({}, kStep, 1);
  const std::size_t rows = data_.rows.size();
  data_.rows.push_back(data_.rows.front());
  data_.rows.back().condition.output_torque_Nm = 1.7e308;
  double told = 0.0;
  DiagnoseOptions options;
  options.progress = [&](double share) {
    EXPECT_GE(share, told);
    told = share;
    return true;
  };
  const auto d = diagnose(simulation_, data_, options);
  EXPECT_EQ(told, 1.0);
  ASSERT_EQ(d->verdict, Verdict::kNoDiscrepancy);
  ASSERT_TRUE(std::isnan(d->rows.back().baseline));
  double squares = 0.0, held = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    const RowResult& row = d->rows[i];
    squares += std::pow(data_.rows[i].response - row.baseline, 2);
    held += std::pow(data_.rows[i].response - row.holdout, 2);
    EXPECT_GE(row.sigma, 0.2886 * kStep);
  }
  const auto n = static_cast<double>(rows);
  EXPECT_NEAR(d->errors.baseline_train, std::sqrt(squares / n), 1e-12);
  EXPECT_NEAR(d->errors.extended_holdout, std::sqrt(held / n), 1e-12);
  EXPECT_GE(d->errors.noise_floor, 0.2886 * kStep);
}

TEST_F(Rounding, OneThingIsSaidOfAStatedSigma) {
  // The scatter of the readings, rounding included, and three times of it; before rounding they
  // scatter by less than either.
  for (const double factor : {1.0, 3.0}) {
    read({}, kStep, 1);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].sigma = factor * std::hypot(kNoise * clean_[static_cast<Eigen::Index>(i)],
                                                kStep / std::sqrt(12.0));
    }
    const auto d = diagnose(simulation_, data_, {});
    EXPECT_EQ(d->verdict, Verdict::kNoDiscrepancy) << factor;
    EXPECT_EQ(d->noise_source == NoiseSource::kStated, factor == 1.0) << factor;
    EXPECT_EQ(std::ranges::count_if(d->notes, tells_of_stated_level), factor == 1.0 ? 0 : 1);
    EXPECT_LE(d->errors.noise_floor, d->stated_noise) << factor;
  }
}

TEST_F(Rounding, WhatWouldBeFoundBeforeItIsTold) {
  // A drag of a quarter of a step, which rounding makes a law of load in most campaigns.
  Hypothesis drag;
  for (const Candidate& c : candidates_for(simulation_, data_)) {
    if (c.cause->id == "drag_constant" && c.form.name == "sun") drag = with({}, c);
  }
  drag.value = {0.0018};
  int otherwise = 0, told = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    read(drag, kStep, seed);
    const auto d = diagnose(simulation_, data_, {});
    ASSERT_NE(d->verdict, Verdict::kNoDiscrepancy) << seed;
    if (std::ranges::find(d->effects, "drag_constant", &Effect::id) != d->effects.end()) continue;
    ++otherwise;
    told += std::ranges::any_of(d->notes,
                                [](const std::string& note) {
                                  return note.find("before it drag_constant would be found") !=
                                         std::string::npos;
                                })
                ? 1
                : 0;
  }
  EXPECT_GE(otherwise, 3);
  EXPECT_GT(2 * told, otherwise);
}

}  // namespace
}  // namespace gear3k::calibrate::rounding_test
