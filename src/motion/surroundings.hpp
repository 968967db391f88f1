#pragma once
// What acts on the two sides from outside: motor with drive, and load.

#include <array>

#include "actuator/actuator.hpp"
#include "motion/scenario.hpp"

namespace gear3k::motion {

/// Angle and speed of both sides, at the output.
struct Sides {
  double fast_rad = 0.0, fast_rad_s = 0.0;
  double output_rad = 0.0, output_rad_s = 0.0;
};

/// Torques and the motor's electrical side at an instant.
struct Outside {
  double motor_Nm = 0.0;       ///< T_em
  double reflected_Nm = 0.0;   ///< τ = i T_em
  double load_Nm = 0.0;        ///< T_L, of all parts of the load
  double prescribed_Nm = 0.0;  ///< its part that is prescribed over time
  double current_A = 0.0, voltage_V = 0.0;
  double electrical_W = 0.0;  ///< V I
  double copper_W = 0.0;      ///< R I²
};

class Surroundings {
 public:
  Surroundings(const actuator::Actuator& actuator, const Scenario& scenario);

  /// From now on the rows of the tables that hold after a time.
  void enter(double time_s);
  /// The next row of a table; infinity after the last one.
  [[nodiscard]] double next_row_s(double time_s) const;
  [[nodiscard]] Outside at(double time_s, const Sides& sides) const;

  /// Inertia of the scenario's load [kg m²], its pendulum's with it.
  [[nodiscard]] double load_inertia_kgm2() const;
  /// Energy in the spring and of the pendulum [J], zero where either pulls nowhere.
  [[nodiscard]] double spring_j(double output_rad) const;
  [[nodiscard]] double gravity_j(double output_rad) const;
  /// Greatest stiffness at the output [N m/rad].
  [[nodiscard]] double stiffness_nm_rad() const;

 private:
  [[nodiscard]] double motor_torque(double time_s, const Sides& sides) const;

  actuator::Motor motor_;
  double ratio_;
  const Scenario& scenario_;
  std::size_t command_piece_ = 0, load_piece_ = 0;
};

}  // namespace gear3k::motion
