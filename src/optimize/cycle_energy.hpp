#pragma once
// The energy of a duty cycle as an objective: what the search knows of motors and loads.

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "design/design.hpp"
#include "geometry/scalar.hpp"

namespace gear3k::optimize {

/// A gearbox with load-proportional losses.
struct EnergyGearbox {
  double ratio = 1.0;                    ///< signed
  double forward = 1.0, backward = 1.0;  ///< η_f > 0, η_b
  double inertia_kgm2 = 0.0;             ///< of the gears at the output, as if on the motor's side
};

/// The back-drivable gearboxes of a tooth set, see energy_box().
struct EnergyBox {
  double ratio = 1.0;
  double most_forward = 1.0, most_backward = 1.0;
  double least_inertia_kgm2 = 0.0, most_inertia_kgm2 = 0.0;  ///< lossless, at the output
  /// Least and greatest torque of the gears' inertia at the motor's side over that without losses.
  std::array<double, 2> inertia_factor{1.0, 1.0};
  bool known = true;  ///< else losses leave no factors, and nothing is claimed
};

/// What the motor that needs least takes from the bus with a gearbox, and how that changes with it.
struct EnergyAt {
  double energy_J = 0.0;
  /// First and second derivative over 1/η_f and over η_b, which nothing mixes.
  std::array<double, 2> slope{}, curvature{};
  /// The same over the inertia, and its mixed derivatives with both.
  double inertia_slope = 0.0, inertia_curvature = 0.0;
  std::array<double, 2> mixed{};
  std::size_t motor = 0;
  /// Else no motor keeps its limits: the values are those of the one that misses them by least.
  bool within_limits = true;
};

/// Energy of a load over its cycles with the best of some motors.
class CycleEnergy {
 public:
  CycleEnergy() = default;
  CycleEnergy(const CycleEnergy&) = delete;
  CycleEnergy& operator=(const CycleEnergy&) = delete;
  virtual ~CycleEnergy() = default;

  [[nodiscard]] virtual EnergyAt at(const EnergyGearbox& gearbox) const = 0;
  /// By the power flow of a design with the inertia of its gears; derivatives are not set.
  [[nodiscard]] virtual EnergyAt of(const design::Design& design) const = 0;
  /// Least energy of any motor within its limits with any back-drivable gearbox of a box; infinite
  /// where no motor keeps its limits.
  [[nodiscard]] virtual double least(const EnergyBox& box) const = 0;
  /// A magnitude of the energies [J], > 0.
  [[nodiscard]] virtual double scale_j() const = 0;
};

/// A gearbox with derivatives.
template <class T>
struct EnergyGearboxOf {
  double ratio = 1.0;
  T forward{}, backward{}, inertia_kgm2{};
};

/// The energy with derivatives: at() expanded to second order about its own place.
template <class T>
T cycle_energy(const CycleEnergy& energy, const EnergyGearboxOf<T>& g) {
  const double eta_f = value_of(g.forward);
  const double eta_b = value_of(g.backward);
  if (!(eta_f > 0.0)) return constant<T>(std::numeric_limits<double>::quiet_NaN());
  const double inertia = value_of(g.inertia_kgm2);
  const EnergyAt at =
      energy.at({.ratio = g.ratio, .forward = eta_f, .backward = eta_b, .inertia_kgm2 = inertia});
  const T by_forward = 1.0 / g.forward - 1.0 / eta_f;
  const T by_backward = g.backward - eta_b;
  T losses = by_forward * (at.slope[0] + by_forward * (0.5 * at.curvature[0])) +
             by_backward * (at.slope[1] + by_backward * (0.5 * at.curvature[1])) + at.energy_J;
  if (inertia == 0.0) return losses;
  const T more = g.inertia_kgm2 - inertia;
  return losses + more * (at.inertia_slope + more * (0.5 * at.inertia_curvature) +
                          by_forward * at.mixed[0] + by_backward * at.mixed[1]);
}

}  // namespace gear3k::optimize
