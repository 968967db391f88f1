#pragma once
// Integration of ordinary differential equations with steps that are found by their error.

#include <array>
#include <cstddef>
#include <functional>
#include <memory>

namespace gear3k::motion {

inline constexpr std::size_t kStateSize = 20;
using State = std::array<double, kStateSize>;

/// dx/dt at a state and a time.
using Slopes = std::function<void(const State& x, State& dxdt, double time_s)>;

/// Dormand and Prince's pair of orders 5 and 4 with continuous output (Boost.Odeint).
///
/// A step is accepted where the estimated error of each component is at most
/// absolute + relative (|x| + h |dx/dt|).
/// Source: J. R. Dormand, P. J. Prince, A family of embedded Runge-Kutta formulae, J. Comp. Appl.
/// Math. 6 (1980) 19-26; E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential
/// Equations I, II.6 (continuous output of order 4).
class Stepper {
 public:
  Stepper(Slopes slopes, double absolute, double relative, double max_step_s);
  ~Stepper();
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// Forgets the step before: what follows begins at this state, even with other slopes.
  void restart(const State& x, double time_s, double step_s);
  /// One step, at most up to `limit_s`, which it then meets exactly.
  /// @throws std::runtime_error where no step is small enough
  void advance(double limit_s);

  [[nodiscard]] double from_s() const;
  [[nodiscard]] double to_s() const;
  [[nodiscard]] double next_step_s() const;
  [[nodiscard]] const State& state() const;  ///< at to_s()
  /// Within the last step, of order 4.
  [[nodiscard]] State between(double time_s) const;
  /// The same by a step of its own from from_s() on, of order 5.
  [[nodiscard]] State exact(double time_s) const;

 private:
  struct Method;
  std::unique_ptr<Method> method_;
};

/// The first place after a change of sign to rounding, of a function that is above zero at `low`
/// and not at `high`: value(result) ≤ 0.
double place_of_change(const std::function<double(double)>& value, double low, double high);

}  // namespace gear3k::motion
