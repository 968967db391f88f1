#include "optimize/energy_box.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "design/checks.hpp"
#include "design/design.hpp"
#include "efficiency/friction_law.hpp"
#include "geometry/involute.hpp"
#include "inertia/effective_inertia.hpp"
#include "inertia/mass_properties.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/shift_range.hpp"

namespace gear3k::optimize {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Base pitches from the pitch point at which teeth touch at most, by the limit of the contact
/// ratio, or what no involute exceeds.
double farthest_contact(const Specification& spec) {
  constexpr double kGreatestContactRatio = 3.0;
  return std::min(kGreatestContactRatio,
                  spec.limits[design::CheckId::kContactRatioMax].value_or(kGreatestContactRatio) +
                      design::kFeasibilityTolerance);
}

/// The longest addendum of the rack, in modules.
double longest_addendum(const Specification& spec) {
  const auto& shortening = spec.free.tip_shortening;
  return spec.rack.addendum + (shortening ? std::max(0.0, -shortening->min) : 0.0);
}

/// The same of the sun's mesh: to the tips. Without negative backlash,
///   inv α_w ≥ inv α + (2 tan α (x1 + x2) − (q1 + q2)/cos α)/(z1 + z2)
/// and each side is longest with the greatest shift of its own gear and the least of the other.
double farthest_sun_contact(const Specification& spec, const train::ToothSet& z) {
  const double usual = farthest_contact(spec);
  const auto least = design::least_backlash_m(spec.limits, train::kMeshSP1);
  if (spec.free.pressure_angle_rad || !least || *least < 0.0) return usual;
  const double alpha = spec.pressure_angle_rad;
  const double module = module_range(spec.module[0]).lo;
  const double thinner = machining_allowance(spec, train::kS, alpha, module) +
                         machining_allowance(spec, train::kP1, alpha, module);
  constexpr double kRoom = 1e-5;
  double farthest = 0.0;
  for (const auto& [own, other] :
       {std::pair(train::kS, train::kP1), std::pair(train::kP1, train::kS)}) {
    const double most = shift_limits(spec, static_cast<int>(own)).max;
    const double shifts = most + shift_limits(spec, static_cast<int>(other)).min;
    const double value =
        geometry::involute(alpha) +
        (2.0 * std::tan(alpha) * shifts - thinner / std::cos(alpha)) / (z.S + z.P1);
    const double working =
        value > 0.0 ? std::max(0.0, geometry::inverse_involute(value) - kRoom) : 0.0;
    // In modules.
    const double teeth = train::teeth_of(z)[own];
    const double tip = (1.0 + kRoom) * (0.5 * teeth + most + longest_addendum(spec));
    const double base = 0.5 * teeth * std::cos(alpha);
    const double side =
        std::sqrt(std::max(0.0, tip * tip - base * base)) - base * std::tan(working);
    farthest = std::max(farthest, side / (std::numbers::pi * std::cos(alpha)));
  }
  return std::min(usual, farthest);
}

/// Least efficiency of a mesh, whichever gear drives; 0 where nothing is known.
/// @param sides  on how many sides of the pitch point contact may be as far, 1 where `farthest` is
/// that of both together
/// @param sign  −1 of a ring as the second
double least_efficiency(const Specification& spec, double farthest, int sides, double first,
                        double second, double sign) {
  double friction = 0.0;
  for (const bool forward : {false, true}) {
    for (const auto& flank : efficiency::constant_frictions(spec.friction, forward)) {
      friction =
          std::max(friction,
                   flank.coefficient * std::max({1.0, flank.approach_factor, flank.recess_factor}));
    }
  }
  const double left = 1.0 - friction * (1.0 + kTurn * farthest / std::min(first, second));
  if (!(left > 0.0)) return 0.0;
  // Of the contact's path, and of the mean loss factor pi (1 - e1 - e2 + e1^2 + e2^2).
  const double path = kTurn * farthest / left;
  const double mean = std::numbers::pi * (1.0 + sides * std::max(0.0, farthest * (farthest - 1.0)));
  return std::max(0.0, 1.0 - friction * std::max(path, mean) * (1.0 / first + sign / second));
}

struct MostInertia {
  double total_kgm2 = 0.0, ring2_kgm2 = 0.0;
};

MostInertia most_inertia(const Specification& spec, const train::ToothSet& z, int planets) {
  using train::kP1, train::kP2, train::kR1, train::kR2, train::kS;
  constexpr double kMore = 1.0 + 4.0 * design::kFeasibilityTolerance;
  std::array<double, 2> module{module_range(spec.module[0]).hi, module_range(spec.module[1]).hi};
  if (const auto limit = most_ring_root_diameter_m(spec)) {
    for (const std::size_t ring : {kR1, kR2}) {
      const double least_shift = std::min(0.0, shift_limits(spec, static_cast<int>(ring)).min);
      double& most = module[ring == kR1 ? 0 : 1];
      most = std::min(most, kMore * *limit / (train::teeth_of(z)[ring] + 2.0 * least_shift));
    }
  }
  const auto cylinder = [&](std::size_t gear, double teeth_m) {
    const auto stage = static_cast<std::size_t>(train::stage_of(static_cast<int>(gear)));
    const auto& free = spec.free.face_width_m[stage];
    const double width = free ? free->max : spec.bodies.face_width_m[stage].value_or(0.0);
    const auto density =
        design::density_of(spec.bodies.density_kgm3, spec.bodies.gear_density_kgm3, gear);
    return inertia::hollow_cylinder<double>({.outer_radius_m = teeth_m,
                                             .inner_radius_m = 0.0,
                                             .width_m = width * kMore,
                                             .density_kgm3 = density.value_or(0.0)});
  };
  const auto reach = [&](std::size_t gear, double depth) {
    const auto stage = static_cast<std::size_t>(train::stage_of(static_cast<int>(gear)));
    return kMore * module[stage] *
           (0.5 * train::teeth_of(z)[gear] + shift_limits(spec, static_cast<int>(gear)).max +
            depth);
  };
  const double addendum = longest_addendum(spec);
  const auto sun = cylinder(kS, reach(kS, addendum));
  const auto planet1 = cylinder(kP1, reach(kP1, addendum));
  const auto planet2 = cylinder(kP2, reach(kP2, addendum));
  const auto ring2 = cylinder(kR2, reach(kR2, spec.rack.dedendum) + spec.bodies.ring_rim_m);
  const double orbit = reach(kS, addendum) + reach(kP1, addendum);
  return {.total_kgm2 = inertia::lossless_inertia<double>(
              {.teeth = z,
               .planets = planets,
               .center_distance_m = orbit,
               .bodies = {.sun_kgm2 = sun.inertia_kgm2,
                          .planet1_kgm2 = planet1.inertia_kgm2,
                          .planet2_kgm2 = planet2.inertia_kgm2,
                          .planet_mass_kg = planet1.mass_kg + planet2.mass_kg,
                          .carrier_kgm2 = 0.0,
                          .ring2_kgm2 = ring2.inertia_kgm2}}),
          .ring2_kgm2 = ring2.inertia_kgm2};
}

}  // namespace

EnergyBox energy_box(const Specification& spec, const train::ToothSet& z, int planets,
                     double most_forward, double most_backward) {
  EnergyBox box{
      .ratio = train::ratio(z), .most_forward = most_forward, .most_backward = most_backward};
  if (!knows_inertia(spec)) return box;
  box.least_inertia_kgm2 = best_value(Objective::kInertia, spec, z, planets);
  const MostInertia most = most_inertia(spec, z, planets);
  box.most_inertia_kgm2 = std::max(most.total_kgm2, box.least_inertia_kgm2);
  const double eta1 = least_efficiency(spec, farthest_sun_contact(spec, z), 2, z.S, z.P1, 1.0);
  const double eta2 = least_efficiency(spec, farthest_contact(spec), 1, z.P1, z.R1, -1.0);
  const double eta3 = least_efficiency(spec, farthest_contact(spec), 1, z.P2, z.R2, -1.0);
  if (!(eta1 > 0.0 && eta2 > 0.0 && eta3 > 0.0)) {
    box.known = false;
    return box;
  }
  const double l1 = static_cast<double>(z.P1) / z.S;
  const double l2 = static_cast<double>(z.P1) / z.R1;
  const double l3 = static_cast<double>(z.P2) / z.R2;
  const auto planet = [&](double f1, double f2) {
    return (l1 + l2) * (1.0 - l2 * f2) / ((1.0 - l2) * (l1 * f1 + l2 * f2));
  };
  const auto carrier = [&](double f1, double f2) { return (l1 + l2) * f2 / (l1 * f1 + l2 * f2); };
  const auto ring2 = [&](double f1, double f2, double f3) {
    return (l3 * f3 - l2 * f2) / (l3 - l2) * (l1 + l2) / (l1 * f1 + l2 * f2);
  };
  // Each is monotonic in each f: its ends are among the corners.
  double low = 1.0;
  double high = 1.0;
  double ring_low = 1.0;
  double ring_high = 1.0;
  for (const double f1 : {eta1, 1.0 / eta1}) {
    for (const double f2 : {eta2, 1.0 / eta2}) {
      for (const double a : {planet(f1, f2), carrier(f1, f2)}) {
        low = std::min(low, a);
        high = std::max(high, a);
      }
      for (const double f3 : {eta3, 1.0 / eta3}) {
        ring_low = std::min(ring_low, ring2(f1, f2, f3));
        ring_high = std::max(ring_high, ring2(f1, f2, f3));
      }
    }
  }
  const double share = std::min(1.0, most.ring2_kgm2 / box.least_inertia_kgm2);
  box.inertia_factor = {low - share * (low - std::min(low, ring_low)),
                        high + share * (std::max(high, ring_high) - high)};
  return box;
}

}  // namespace gear3k::optimize
