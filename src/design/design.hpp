#pragma once
// What a user describes: one gearbox (Design) or one pair of gears (PairDesign).  SI units inside.

#include <array>
#include <optional>
#include <string>

#include "backlash/lost_motion.hpp"
#include "design/checks.hpp"
#include "efficiency/mesh_loss.hpp"
#include "inertia/effective_inertia.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::design {

struct Friction {
  double coefficient = 0.1;  ///< μ
  efficiency::LossModel model = efficiency::LossModel::kSliding;
};

/// What is known of the moving masses.  A body's inertia is the value given or, without one,
/// follows from face width, density and the gear's bore or outer radius.
struct Masses {
  std::optional<double> sun_kgm2, planet1_kgm2, planet2_kgm2, planet_mass_kg, carrier_kgm2,
      ring2_kgm2;
  std::optional<double> density_kgm3;
  std::array<std::optional<double>, 2> face_width_m;  ///< by stage
  std::array<double, train::kGearCount> bore_radius_m{};
  std::optional<double> ring2_outer_radius_m;
};

struct Design {
  std::string name;
  train::TrainParameters<double> train;  ///< center_distance_m as given, or resolved by evaluate()
  bool center_distance_given = false;
  Friction friction;
  Masses masses;
  train::AxialLayout axial;
  /// Measuring pins, by gear; empty: chosen by geometry::pin_measure().
  std::array<std::optional<double>, train::kGearCount> pin_diameter_m;
  Limits limits = default_limits();
};

struct PairDesign {
  std::string name;
  double pressure_angle_rad = 0.0;
  std::optional<double> center_distance_m;
  geometry::Gear<double> gear1, gear2;
  std::array<bool, 2> khk_tip{};  ///< tip shortened by the KHK rule, external pairs only
  std::array<std::optional<double>, 2> pin_diameter_m;
  Friction friction;
  Limits limits = default_limits();
};

}  // namespace gear3k::design
