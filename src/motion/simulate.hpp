#pragma once
// Motion of an actuator over time, with its events and where its energy goes.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "actuator/actuator.hpp"
#include "actuator/duty_cycle.hpp"
#include "motion/hybrid.hpp"
#include "motion/scenario.hpp"

namespace gear3k::motion {

/// Both sides at an instant, at the output; before and after an event a row each.
struct MotionRow {
  double time_s = 0.0;
  Sides sides{};
  double acceleration_rad_s2 = 0.0;  ///< of the output
  Mode mode{};
  Outside outside{};
  std::optional<double> mesh_Nm{};  ///< empty at rest, where friction leaves it open
};

struct MotionEvent {
  double time_s = 0.0;
  std::string what;  ///< one of event_names()
  Mode before{}, after{};
  double angle_rad = 0.0, speed_rad_s = 0.0;  ///< of the output, after it
  double loss_J = 0.0;                        ///< that the moment takes
};

/// Where the energy went.
struct Ledger {
  double drawn_J = 0.0, regenerated_J = 0.0;  ///< from the bus, to the bus
  double positive_J = 0.0, negative_J = 0.0;  ///< that the prescribed load receives, that it gives
  std::vector<actuator::LossEnergy> losses{};
  double kinetic_J = 0.0, spring_J = 0.0, gravity_J = 0.0;  ///< changes of what is stored
  /// |drawn − regenerated − positive + negative − losses − stored| over the sum of magnitudes.
  double balance_error = 0.0;
};

/// How long a mode held, and how often it was entered.
struct ModeShare {
  std::string name;  ///< stick, forward, backward, gap; by the flow where the output turns
  double time_s = 0.0;
  int entries = 0;
};

struct Motion {
  std::vector<MotionRow> rows{};
  std::vector<MotionEvent> events{};
  Ledger ledger{};
  std::vector<ModeShare> shares{};
  MotionRow end{};
  std::size_t steps = 0, cuts = 0;
  bool complete = true;      ///< false: solver.max_events or max_steps were passed, or interrupted
  bool interrupted = false;  ///< the progress ended it
  /// Of the rows and of four points of each step.
  double peak_current_A = 0.0, peak_voltage_V = 0.0, peak_motor_speed_rad_s = 0.0;
  std::vector<actuator::LimitCheck> checks{};  ///< of the peaks; the motion is not held to them
  std::string ended_early{};  ///< why, and when; "" of a complete one.  Among the notes too
  std::vector<std::string> notes{};
};

/// Called after each step with the share of the time that is past; false ends the motion there.
using MotionProgress = std::function<bool(double share)>;

/// Simulates a scenario.
///
/// Within a mode the motion follows ordinary differential equations (docs/theory §66), integrated
/// by Stepper.  A mode ends where a speed, the lead of one side over the other, the excess of a
/// torque over static friction or the room in the gap passes zero: seen at four points of each
/// step, placed by steps that end there, to rounding.  Rows of tables end steps.
/// Source: own derivation, docs/theory §66 to §68.
/// Accuracy: the ledger closes to 1e-9 of the energy moved at the tolerances that are the default.
/// Does not account for: inductance, cogging, the winding's temperature in R, elasticity.
/// @throws std::invalid_argument where a side lacks inertia; std::runtime_error where a step finds
/// no end
Motion simulate(const actuator::Actuator& actuator, const Scenario& scenario,
                const MotionProgress& progress = {});

}  // namespace gear3k::motion
