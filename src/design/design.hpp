#pragma once
// What a user describes: one gearbox (Design) or one pair of gears (PairDesign).  SI units inside.

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>

#include "backlash/lost_motion.hpp"
#include "backlash/lost_motion_extension.hpp"
#include "backlash/tolerances.hpp"
#include "design/checks.hpp"
#include "design/operating_point.hpp"
#include "efficiency/friction_law.hpp"
#include "inertia/effective_inertia.hpp"
#include "strength/rating_task.hpp"
#include "train/thermal_growth.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::design {

using Friction = efficiency::Friction<double>;

/// Greatest tip shortening of a gear that is described [modules].
inline constexpr double kGreatestTipShortening = 1.5;

/// Grid of an operating map: from, to and number of points, ends included.
struct GridAxis {
  double from = 0.0, to = 0.0;
  int points = 2;
};
/// By default the range of the low-backlash paper's experiment, 200-1000 rpm and 5-50 Nm.
struct MapGrid {
  GridAxis sun_speed_rad_s{
      .from = 200.0 * std::numbers::pi / 30.0, .to = 1000.0 * std::numbers::pi / 30.0, .points = 9};
  GridAxis output_torque_Nm{.from = 5.0, .to = 50.0, .points = 10};
};

/// Densities by gear, where they are known.
using GearDensities = std::array<std::optional<double>, train::kGearCount>;

/// Density of a gear [kg/m³]: that of all gears, else its own; empty where neither is known.
inline std::optional<double> density_of(const std::optional<double>& of_all,
                                        const GearDensities& by_gear, std::size_t gear) {
  return of_all ? of_all : by_gear[gear];
}

/// What is known of the masses.  A body's inertia is the value given or, without one, follows from
/// its geometry (mass_model.hpp): of a gear, face width, density and bore or outer radius.
struct Masses {
  std::optional<double> sun_kgm2, planet1_kgm2, planet2_kgm2, planet_mass_kg, carrier_kgm2,
      ring2_kgm2;
  std::optional<double> density_kgm3;                 ///< of all gears
  GearDensities gear_density_kgm3;                    ///< of one gear, where that of all is empty
  std::array<std::optional<double>, 2> face_width_m;  ///< by stage
  std::array<double, train::kGearCount> bore_radius_m{};
  std::optional<double> ring1_outer_radius_m, ring2_outer_radius_m;
  /// The carrier's plates, together one hollow cylinder.
  std::optional<double> carrier_outer_radius_m, carrier_bore_radius_m, carrier_thickness_m;
  std::optional<double> carrier_density_kgm3;  ///< of the plates; empty: density_kgm3
  /// One pin per planet, fixed in the carrier.
  std::optional<double> planet_pin_radius_m, planet_pin_length_m;
  std::optional<double> planet_pin_density_kgm3;  ///< empty: density_kgm3
};

/// Gearboxes built at random within their tolerances.
struct Sampling {
  std::int64_t samples = 1'000'000;
  std::uint64_t seed = 1;
};

/// Limits A_sni ≤ A_sn ≤ A_sne of the tooth thickness (arc on the reference circle) from that
/// without backlash, by gear.
using ThicknessAllowances = std::array<std::optional<backlash::DeviationLimits>, train::kGearCount>;

struct Design {
  std::string name;
  train::TrainParameters<double> train;  ///< center_distance_m as given, or resolved by evaluate()
  bool center_distance_given = false;
  Friction friction;
  ShaftLosses<double> shafts;
  /// Where the gearbox runs; required by friction laws other than kConstant.
  std::optional<OperatingPoint<double>> operating_point;
  /// Grid of the operating map.
  MapGrid map;
  backlash::LostMotionExtension<double> lost_motion;  ///< of a calibrated model
  Masses masses;
  train::AxialLayout axial;
  /// Measuring pins, by gear; empty: chosen by geometry::pin_measure().
  std::array<std::optional<double>, train::kGearCount> pin_diameter_m;
  Limits limits = default_limits();
  std::optional<backlash::Tolerances> tolerances;
  /// A_sn of gears as a file states them; what counts is train.machining_allowance and tolerances.
  ThicknessAllowances thickness_allowance_m;
  Sampling sampling;
  std::optional<train::ThermalRange> thermal;  ///< where it is to work
  std::optional<strength::RatingTask> rating;  ///< what it is to carry
};

/// What a design states of its bodies; must not outlive it.
inline TrainBodies<double> bodies_of(const Design& design) {
  const Masses& masses = design.masses;
  const auto rated = [&](std::size_t stage) {
    return design.rating ? design.rating->face_width_m[stage] : 0.0;
  };
  return {.bore_radius_m = masses.bore_radius_m,
          .ring_outer_radius_m = {masses.ring1_outer_radius_m, masses.ring2_outer_radius_m},
          .ring_rim_m = 0.0,
          .face_width_m = {masses.face_width_m[0].value_or(rated(0)),
                           masses.face_width_m[1].value_or(rated(1))},
          .allowed_teeth = &design.limits.allowed_teeth};
}

struct PairDesign {
  std::string name;
  double pressure_angle_rad = 0.0;
  std::optional<double> center_distance_m;
  geometry::Gear<double> gear1, gear2;
  std::array<bool, 2> khk_tip{};  ///< tip shortened by the KHK rule, external pairs only
  std::array<std::optional<double>, 2> pin_diameter_m;
  Friction friction;
  Limits limits = default_limits();
  std::optional<backlash::PairTolerances> tolerances;
  /// As Design::thickness_allowance_m.
  std::array<std::optional<backlash::DeviationLimits>, 2> thickness_allowance_m;
  std::optional<strength::RatingTask> rating;
};

}  // namespace gear3k::design
