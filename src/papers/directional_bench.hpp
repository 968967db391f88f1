#pragma once
// The directional-impedance thesis's bench as an actuator: what is felt at its output with each
// pair of gears of Table 3.1, and its experiments as simulated motion.

#include <string>
#include <vector>

#include "actuator/actuator.hpp"
#include "motion/scenario.hpp"
#include "motion/simulate.hpp"
#include "papers/compared_row.hpp"
#include "papers/ledger.hpp"
#include "papers/thesis_comparison.hpp"

namespace gear3k::papers {

/// examples/actuators/directional_bench*.toml.
struct DirectionalBenchSources {
  actuator::Actuator actuator;  ///< its gears are one choice of those of Table 3.1
  motion::Scenario load;        ///< constant speed under a load that rises, then drives (sec. 3.2)
  motion::Scenario push;        ///< a spring that the motor plays, pushed in and let out
  motion::Scenario braking;     ///< a load sped up and braked (secs. 2.2, 4.1)
  double steel_kg_m3 = 0.0;     ///< of the gears, for their inertia
};

/// What is felt at the output with a pair of gears measured in both directions; the pinion is on
/// the motor's shaft.
struct FeltGears {
  int pinion = 0, gear = 0;
  double forward = 0.0, backward = 0.0;                    ///< η_f, η_b of Table 3.1
  double speeding_up_kgm2 = 0.0, slowing_down_kgm2 = 0.0;  ///< J2 + J1/η_b, J2 + η_f J1
  double plain_kgm2 = 0.0;                                 ///< J2 + J1
  double transparency = 0.0;                               ///< width over mean of what is felt
  [[nodiscard]] double ratio() const { return static_cast<double>(gear) / pinion; }
  /// A virtual spring feels 1/η_b times as stiff pushed in, η_f times let out.
  [[nodiscard]] double pushed_in() const { return 1.0 / backward; }
  [[nodiscard]] double let_out() const { return forward; }
};

/// Torques at the output while the motor holds a torque.
struct HeldTorque {
  int pinion = 0, gear = 0;
  double motor_Nm = 0.0;  ///< at the motor's shaft
  double moving_with_Nm = 0.0, pushed_back_Nm = 0.0;
};

/// One motion with the losses of both directions, and with one efficiency for both, their mean.
struct BrakingRun {
  motion::Motion directional, fixed;
  double backward_share = 0.0;  ///< of the time, flow of the mesh
  double opposite_share = 0.0;  ///< of the time, the motor gives power and the mesh drives back
  double speed_error = 0.0;     ///< rms of the difference of speeds over rms speed
};

struct DirectionalBench {
  std::vector<ComparedRow> rows;  ///< printed, by its equations, simulated (in `exact`)
  std::vector<FeltGears> felt;
  std::vector<HeldTorque> held;  ///< of the pairs with the least and the greatest asymmetry
  motion::Motion load, push;
  BrakingRun braking;
  /// Face width of gears of steel above which the inertia that larger gears of a ratio add is more
  /// than what their losses save [m].
  double even_width_m = 0.0;
  std::vector<LedgerEntry> ledger;  ///< numbered from 1
};

/// Evaluates everything.
/// @throws std::invalid_argument where the actuator's gears are not in Table 3.1 both ways
DirectionalBench directional_bench(const ThesisSources& thesis,
                                   const DirectionalBenchSources& sources);

/// Losses from slopes at constant speed as its section 3.2 takes them: 1 − slope of τ2/N over τ1
/// while the flow is forward, of τ1 over τ2/N while it is backward.
struct SlopeLosses {
  double forward = 0.0, backward = 0.0;
};
SlopeLosses slope_losses(const motion::Motion& motion);

/// Slopes of the load over the angle of a spring that the motor plays, over its stiffness.
struct SpringSlopes {
  double pushed_in = 0.0, let_out = 0.0;
};
SpringSlopes spring_slopes(const motion::Motion& motion, double stiffness_Nm_rad);

/// The statements of its sections 2.2, 3.4.1 and chapter 4 beside what the bench gives.
std::vector<LedgerEntry> directional_bench_ledger(const ThesisSources& thesis,
                                                  const DirectionalBenchSources& sources,
                                                  const DirectionalBench& bench);

/// The bench with another pair of gears in it.
actuator::Actuator with_gears(const actuator::Actuator& bench, const FeltGears& gears);

/// The pair of a bench.  @throws std::invalid_argument where it was not measured
const FeltGears& gears_of(const std::vector<FeltGears>& felt, int pinion, int gear);

}  // namespace gear3k::papers
