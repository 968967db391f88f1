#pragma once
// What the output feels like when it is moved to and fro from outside.

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "actuator/actuator.hpp"

namespace gear3k::actuator {

enum class MotorTerminals {
  kOpen,     ///< no current
  kShorted,  ///< brakes by its own voltage
  kLocked    ///< the rotor is held
};

struct ImpedanceTask {
  double low_Hz = 1.0, high_Hz = 1.0;  ///< ends included, evenly spaced on a logarithmic scale
  int points = 1;
  double amplitude_rad = 0.0;  ///< of the output; 0: without the first harmonic
  MotorTerminals motor = MotorTerminals::kOpen;
};

/// What a cause adds to an impedance.
struct ImpedanceCause {
  std::string name;
  std::complex<double> impedance_Nms;
};

struct ImpedancePoint {
  double frequency_Hz = 0.0;
  /// Dynamic stiffness S(jω) [N m/rad] of inertias, dampings and springs without losses and
  /// friction; empty where the rotor is locked and nothing yields.
  std::optional<std::complex<double>> stiffness_Nm_rad{};
  std::optional<std::complex<double>> impedance_Nms{};  ///< Z = S/(jω)
  /// First harmonic of the torque over that of the speed at an amplitude, rigid chain with losses
  /// and friction; empty where the train locks or the rotor is locked.
  std::optional<std::complex<double>> first_harmonic_Nms{};
  /// Complex power of each cause over half the square of the output's speed: real parts are what it
  /// dissipates, imaginary ones what it stores.  They add up to impedance_Nms and to
  /// first_harmonic_Nms, whose list stands beside; empty where those are.
  std::vector<ImpedanceCause> causes{}, harmonic_causes{};
  /// Where in the half period from −90° to 90° of the angle the flow turns forward.
  std::optional<double> flow_change_rad{};
};

/// Impedance of the output at every frequency of a task.
///
///   rotor −ω² i² J_m + jω D1  →  in series with i² K_m  →  + gear input −ω² i² J_I
///     →  in series with K_g  →  + output −ω² J2 + jω D2
///
/// A shorted motor adds (i K_t)²/R to D1.
///
/// By cause: an element of dynamic stiffness s whose ends move by θ_e while the output moves by θ
/// adds s |θ_e/θ|²/(jω), which sums up to Z for any chain (Tellegen).  Of the first harmonic, a
/// rigid chain, inertias and dampings add what they are, Coulomb torques 4 c/(π W), each loss of
/// the gearbox the first harmonic of its power over the speed. Source: own derivation, docs/theory
/// §62.
/// @throws std::invalid_argument unless 0 < low ≤ high, points ≥ 1 and amplitude ≥ 0
std::vector<ImpedancePoint> impedance(const Actuator& actuator, const ImpedanceTask& task);

}  // namespace gear3k::actuator
