#pragma once
// The motor that is chosen with a gearbox, and what both need for their cycles.

#include <optional>
#include <string>
#include <vector>

#include "actuator/co_design.hpp"
#include "actuator/duty_cycle.hpp"
#include "io/text/json.hpp"

namespace gear3k::report {

/// A motor with the best gearbox.
struct CoDesignMotor {
  actuator::PairResult result;  ///< with the inertia of its gears, where it is known
  std::string name;
  std::vector<actuator::Unknown> unknown;  ///< of the motor
};

struct CoDesignReport {
  std::vector<CoDesignMotor> motors;  ///< the chosen one, then the next best within their limits
  /// The chosen one as `gear3k actuator` runs it.
  double run_J = 0.0;
  bool gear_inertia = false;  ///< it has one
  /// What is felt of it, as `gear3k actuator` has it, against the limits; empty without limits.
  std::vector<actuator::LimitCheck> felt_checks;
  /// No motor with any gearbox needs less; empty without a certificate.
  std::optional<double> bound_J;
  std::size_t motors_considered = 0, cycles = 0;
  double peak_torque_Nm = 0.0, rms_torque_Nm = 0.0;  ///< of the mesh on the output
  std::optional<double> stated_torque_Nm;            ///< of [strength]
  bool lossless_drive = true;
};

io::Json co_design_json(const CoDesignReport& report);
std::string co_design_table(const CoDesignReport& report);

/// Why no gearbox that was refined is a result: no motor drives it within its limits.
std::string no_motor_text(const actuator::CoDesign& co_design, std::size_t gearboxes,
                          const actuator::PairResult& nearest);

}  // namespace gear3k::report
