#include "motion/stepper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/dense_output_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace gear3k::motion {

namespace {

namespace odeint = boost::numeric::odeint;
using Dopri5 = odeint::runge_kutta_dopri5<State>;
using Dense = odeint::result_of::make_dense_output<Dopri5>::type;

/// Where two values belong to one side of a change.
double not_zero(double value) {
  return value > 0.0 ? value : std::min(value, -std::numeric_limits<double>::min());
}

}  // namespace

struct Stepper::Method {
  Slopes slopes;
  Dense dense;
  double met_s = std::numeric_limits<double>::quiet_NaN();  ///< a limit, where a step ended there
  bool stepped = false;
};

Stepper::Stepper(Slopes slopes, double absolute, double relative, double max_step_s)
    : method_(new Method{
          .slopes = std::move(slopes),
          .dense = odeint::make_dense_output(absolute, relative, max_step_s, Dopri5())}) {}
Stepper::~Stepper() = default;

void Stepper::restart(const State& x, double time_s, double step_s) {
  method_->dense.initialize(x, time_s, step_s);
  method_->met_s = std::numeric_limits<double>::quiet_NaN();
  method_->stepped = false;
}

void Stepper::advance(double limit_s) {
  Method& m = *method_;
  const double now = to_s();
  // A step that would leave next to nothing of the way takes all of it.
  constexpr double kStretch = 1.01;
  if (now + kStretch * m.dense.current_time_step() >= limit_s) {
    const State x = m.dense.current_state();
    m.dense.initialize(x, now, limit_s - now);
  }
  try {
    m.dense.do_step(std::ref(m.slopes));
  } catch (const odeint::odeint_error& error) {
    throw std::runtime_error(fmt::format("no step is small enough at {:g} s", now));
  }
  m.stepped = true;
  const double left = limit_s - m.dense.current_time();
  constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
  m.met_s = left <= kRounding * std::max(std::abs(limit_s), 1e-300)
                ? limit_s
                : std::numeric_limits<double>::quiet_NaN();
}

double Stepper::from_s() const {
  return method_->stepped ? method_->dense.previous_time() : method_->dense.current_time();
}
double Stepper::to_s() const {
  return std::isnan(method_->met_s) ? method_->dense.current_time() : method_->met_s;
}
double Stepper::next_step_s() const { return method_->dense.current_time_step(); }
const State& Stepper::state() const { return method_->dense.current_state(); }

State Stepper::between(double time_s) const {
  State x{};
  method_->dense.calc_state(time_s, x);
  return x;
}

State Stepper::exact(double time_s) const {
  const Method& m = *method_;
  State x{};
  Dopri5 method;
  method.do_step(std::ref(m.slopes), m.dense.previous_state(), from_s(), x, time_s - from_s());
  return x;
}

double place_of_change(const std::function<double(double)>& value, double low, double high) {
  const auto signed_value = [&](double x) { return not_zero(value(x)); };
  const double at_low = signed_value(low);
  const double at_high = signed_value(high);
  if (!(at_low > 0.0)) return low;
  if (at_high > 0.0) return high;
  std::uintmax_t tries = 200;
  constexpr int kBits = 52;
  const auto [before, after] =
      boost::math::tools::toms748_solve(signed_value, low, high, at_low, at_high,
                                        boost::math::tools::eps_tolerance<double>(kBits), tries);
  return after;
}

}  // namespace gear3k::motion
