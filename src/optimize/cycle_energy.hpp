#pragma once
// The energy of a duty cycle as an objective: what the search knows of motors and loads.

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "geometry/scalar.hpp"

namespace gear3k::optimize {

/// What the motor that needs least takes from the bus with a gearbox, and how that changes with it.
struct EnergyAt {
  double energy_J = 0.0;
  /// First and second derivative over 1/η_f and over η_b; nothing mixes the two.
  std::array<double, 2> slope{}, curvature{};
  std::size_t motor = 0;
  /// Else no motor keeps its limits: the values are those of the one that misses them by least.
  bool within_limits = true;
};

/// Energy of a load over its cycles with the best of some motors; the gearbox has load-proportional
/// losses, and neither inertia nor drag.
class CycleEnergy {
 public:
  CycleEnergy() = default;
  CycleEnergy(const CycleEnergy&) = delete;
  CycleEnergy& operator=(const CycleEnergy&) = delete;
  virtual ~CycleEnergy() = default;

  /// @param ratio  signed  @param forward  η_f > 0  @param backward  η_b
  [[nodiscard]] virtual EnergyAt at(double ratio, double forward, double backward) const = 0;
  /// Least energy of any motor within its limits with any back-drivable gearbox of this ratio whose
  /// efficiencies are at most these; infinite where no motor keeps its limits.
  [[nodiscard]] virtual double least(double ratio, double most_forward,
                                     double most_backward) const = 0;
  /// A magnitude of the energies [J], > 0.
  [[nodiscard]] virtual double scale_j() const = 0;
};

/// The energy with derivatives: at() expanded to second order about its own place.
template <class T>
T cycle_energy(const CycleEnergy& energy, double ratio, const T& forward, const T& backward) {
  const double eta_f = value_of(forward);
  const double eta_b = value_of(backward);
  if (!(eta_f > 0.0)) return constant<T>(std::numeric_limits<double>::quiet_NaN());
  const EnergyAt at = energy.at(ratio, eta_f, eta_b);
  const T by_forward = 1.0 / forward - 1.0 / eta_f;
  const T by_backward = backward - eta_b;
  return by_forward * (at.slope[0] + by_forward * (0.5 * at.curvature[0])) +
         by_backward * (at.slope[1] + by_backward * (0.5 * at.curvature[1])) + at.energy_J;
}

}  // namespace gear3k::optimize
