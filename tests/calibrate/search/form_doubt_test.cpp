#include "calibrate/search/form_doubt.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
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
    return plain.scale * std::sqrt(inverse_normal(p, fit.hypothesis)(k, k));
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

}  // namespace
}  // namespace gear3k::calibrate::form_doubt_test
