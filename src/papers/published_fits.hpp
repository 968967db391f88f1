#pragma once
// A published gearbox under other assumptions, and the values that explain what was measured on it.

#include <optional>

#include "papers/reproduce.hpp"

namespace gear3k::papers {

/// Friction of the tables where the paper gives none.
inline constexpr double kTableFriction = 0.1;

/// The root of an increasing function by bisection to rounding; empty when [low, high] holds none.
template <class Function>
std::optional<double> root_of_increasing(Function f, double low, double high) {
  if (!(f(low) <= 0.0 && f(high) >= 0.0)) return std::nullopt;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (f(middle) < 0.0 ? low : high) = middle;
  }
}

/// @throws std::invalid_argument when the design has no defined geometry
design::Evaluation evaluated(const design::Design& design);

design::Design with_friction(design::Design design, double mu, efficiency::LossModel model);
/// With the same machining allowance on every gear.
design::Design with_allowance(design::Design design, double q);
design::Design at_distance(design::Design design, double center_distance_m);

/// The allowance, the same on every gear, with which the model gives a lost motion.
std::optional<double> explaining_allowance(const design::Design& design, double lost_motion_rad,
                                           backlash::LostMotionModel model);

/// Efficiency of the meshes; NaN where it is undefined.
double efficiency_at(const design::Design& design, double mu, efficiency::LossModel model,
                     design::Direction direction);

/// Friction that gives an efficiency (which falls with μ) in a direction; empty when none does.
std::optional<double> fitted_friction(const design::Design& design, efficiency::LossModel model,
                                      design::Direction direction, double efficiency);

/// One loss model with the friction that explains the measured forward efficiency.
/// Both efficiencies of the gearbox must have been measured.
FrictionFit friction_fit(const PublishedGearbox& gearbox, efficiency::LossModel model);

/// Friction in approach and in recess that explains the measured efficiencies in both directions.
std::optional<DirectionalFit> directional_fit(const PublishedGearbox& gearbox);

/// Backward efficiency with all friction in recess, as much as explains the forward efficiency.
std::optional<double> recess_only_backward(const PublishedGearbox& gearbox);

}  // namespace gear3k::papers
