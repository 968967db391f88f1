#include "calibrate/search/form_doubt.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "calibrate/search/free_shapes.hpp"
#include "calibrate/search/search.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::form_doubt_test {
namespace {

constexpr double kWide = 0.01;  // no row is three of it off

class FormDoubt : public Bench {
 protected:
  FormDoubt() {
    data_ = measured_grid({.sun_speeds_rpm = {600.0},
                           .output_torques_Nm = {2.0, 4.0, 8.0, 16.0, 32.0, 50.0},
                           .repeats = 3});
  }
  [[nodiscard]] Candidate form(const char* cause, const std::string& name) const {
    for (const Candidate& c : candidates_for(simulation_, data_)) {
      if (c.cause->id == cause && c.form.name == name) return c;
    }
    throw std::invalid_argument(name);
  }
  [[nodiscard]] Hypothesis drag_beside(const std::string& law, std::vector<double> values) const {
    Hypothesis h = with(with({}, form("drag_constant", "sun")), form("friction_load", law));
    h.value = std::move(values);
    return h;
  }
  [[nodiscard]] double deviation(const FinalFit& fit, Eigen::Index k) const {
    return std::sqrt(fit.covariance(k, k));
  }
};

TEST_F(FormDoubt, AddsWhatFreerFormsOfTheOtherLawMoveAParameterBy) {
  // The law bends a little: less than the plain form would have to be given up for.
  measure_evenly(drag_beside("any_curve", {0.005, -0.1, 0.05, 0.05}), 0.01, 3);
  const Problem p = problem();
  const FinalFit plain = final_fit(p, drag_beside("about_middle", {0.005, -0.1}), kWide);
  FinalFit wide = plain;
  widen_by_forms(p, candidates_for(simulation_, data_), kWide, wide);
  // By hand: the plain fit, three freer laws, and the plain law with the level beside it, and with
  // another seal.
  std::vector<Hypothesis> freer;
  for (const char* law : {"any_level", "any_curve", "any_shape"}) {
    Hypothesis h = drag_beside(law, {});
    h.value.assign(parameters_of(h).size(), 0.0);
    freer.push_back(h);
  }
  freer.push_back(with(plain.hypothesis, form("friction_level", "coefficient")));
  const auto aic = [&](const FinalFit& fit) {
    return (measured(data_) - fit.simulated).squaredNorm() / (plain.scale * plain.scale) +
           2.0 * static_cast<double>(fit.hypothesis.value.size());
  };
  // Of rows that scatter alike, as those of the plain fit do.
  const auto alike = [&](const FinalFit& fit, Eigen::Index k) {
    return plain.scale * std::sqrt(inverse_normal(p, fit.hypothesis).variance[k]);
  };
  const double own = aic(plain);
  double sum = 1.0;
  double drag = alike(plain, 0);
  double sum_of_others = 1.0;
  double exponent = alike(plain, 1);
  for (const Hypothesis& h : freer) {
    const FinalFit fit = final_fit(p, h, kWide);
    const double weight = std::exp(-0.5 * (aic(fit) - own));
    const auto of = [&](Eigen::Index k) {
      const auto at = static_cast<std::size_t>(k);
      return std::hypot(alike(fit, k), fit.hypothesis.value[at] - plain.hypothesis.value[at]);
    };
    sum += weight;
    drag += weight * of(0);
    // The exponent is another thing in a law of another form, but not beside the level,
    if (&h != &freer.back()) continue;
    sum_of_others += weight;
    exponent += weight * of(1);
  }
  // nor beside seals at both shafts.
  Hypothesis seals = with(with({}, form("drag_constant", "sun_and_output")),
                          form("friction_load", "about_middle"));
  seals.value.assign(3, 0.0);
  const FinalFit sealed = final_fit(p, seals, kWide);
  const double weight = std::exp(-0.5 * (aic(sealed) - own));
  sum_of_others += weight;
  exponent +=
      weight * std::hypot(alike(sealed, 2), sealed.hypothesis.value[2] - plain.hypothesis.value[1]);
  const auto wider = [&](Eigen::Index k) { return deviation(wide, k) / deviation(plain, k); };
  constexpr double kRounding = 1e-2;  // fits end short of the minimum, each at its own place
  EXPECT_NEAR(wider(0) / (drag / sum / alike(plain, 0)), 1.0, kRounding);
  EXPECT_NEAR(wider(1) / (exponent / sum_of_others / alike(plain, 1)), 1.0, kRounding);
  EXPECT_GT(wider(0), 1.2);
  EXPECT_EQ(wide.hypothesis.value, plain.hypothesis.value);
}

TEST_F(FormDoubt, LeavesOutALevelBesideADriftThatHasOneFromItsStart) {
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.time_s = 100.0 * static_cast<double>(i * 7 % data_.rows.size());
  }
  const Hypothesis drift = with(with({}, form("drag_constant", "sun")),
                                form("drift", "levelling_any_scale_any_start_time_friction"));
  Hypothesis truth = drift;
  truth.value = {0.005, -0.3, 0.0, 0.3};
  measure_evenly(truth, 0.01, 5);
  const Problem p = problem();
  const FinalFit plain = final_fit(p, truth, kWide);
  FinalFit wide = plain;
  widen_by_forms(p, candidates_for(simulation_, data_), kWide, wide);
  // With the level its values are any that make the same sum: some thousand times as wide.
  for (Eigen::Index k = 0; k < 4; ++k) EXPECT_LT(deviation(wide, k), 10.0 * deviation(plain, k));
}

TEST_F(FormDoubt, OfALawAloneIsNone) {
  Hypothesis load = with({}, form("friction_load", "about_middle"));
  load.value = {-0.1};
  measure_evenly(load, 0.01, 4);
  const Problem p = problem();
  const FinalFit plain = final_fit(p, load, kWide);
  FinalFit wide = plain;
  widen_by_forms(p, candidates_for(simulation_, data_), kWide, wide);
  EXPECT_EQ(wide.covariance, plain.covariance);
}

TEST(FormDoubtOfAReference, AddsWhatAConstantBesideTheLawMovesItBy) {
  // A housing that expands from 27 C on, measured far from there, under a form that takes 20 C.
  constexpr double kTruth = 40.0;  // um/m/K
  const Simulation simulation(design_of(rig::bilateral_drive_gear()), Kind::kLostMotion);
  MeasurementSet data;
  data.kind = Kind::kLostMotion;
  for (int k = 0; k < 60; ++k) {
    data.rows.push_back({.condition = {.test_torque_Nm = 1.0, .temperature_K = 313.15 + 0.2 * k}});
  }
  const auto candidates = candidates_for(simulation, data);
  const auto form = [&](const char* cause, const char* name) {
    return *std::ranges::find_if(candidates, [&](const Candidate& c) {
      return c.cause->id == cause && c.form.name == name;
    });
  };
  const Candidate from_design = form("thermal_expansion", "from_design");
  Candidate elsewhere = from_design;
  elsewhere.form.constants.front().value += 7.0;
  const Eigen::VectorXd clean =
      simulated(simulation, data, hypothesis({elsewhere}, {kTruth})).value();
  rig::DeterministicRandom random(5);
  const double most = 0.02 * std::abs(clean[0] - simulated(simulation, data, {}).value()[0]);
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    data.rows[i].response = clean[static_cast<Eigen::Index>(i)] + random.between(-most, most);
  }
  const Problem p{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
  const double scale = 10.0 * most;  // no row is three of it off
  const FinalFit plain = final_fit(p, hypothesis({from_design}, {30.0}), scale);
  FinalFit wide = plain;
  widen_by_forms(p, candidates, scale, wide);
  const auto half = [&](const FinalFit& fit) { return 2.0 * std::sqrt(fit.covariance(0, 0)); };
  const double off = std::abs(plain.hypothesis.value[0] - kTruth);
  EXPECT_GT(off, half(plain));
  EXPECT_LT(off, half(wide));
  // By hand.
  Hypothesis both = with(plain.hypothesis, form("clearance", "constant"));
  const FinalFit freer = final_fit(p, both, scale);
  const double variance = plain.scale * plain.scale;
  const auto aic = [&](const FinalFit& fit) {
    return (measured(data) - fit.simulated).squaredNorm() / variance +
           2.0 * static_cast<double>(fit.hypothesis.value.size());
  };
  const double weight = std::exp(-0.5 * (aic(freer) - aic(plain)));
  const double alike = std::sqrt(variance * inverse_normal(p, plain.hypothesis).variance[0]);
  const double moved =
      std::hypot(std::sqrt(variance * inverse_normal(p, freer.hypothesis).variance[0]),
                 freer.hypothesis.value[0] - plain.hypothesis.value[0]);
  const double expected = (alike + weight * moved) / (1.0 + weight) / alike;
  EXPECT_NEAR(half(wide) / half(plain) / expected, 1.0, 1e-2);
}

}  // namespace
}  // namespace gear3k::calibrate::form_doubt_test
