#pragma once
// A designed 3K train as the gearbox of an actuator.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "actuator/gear_model.hpp"
#include "design/accelerated_train.hpp"
#include "design/design.hpp"

namespace gear3k::actuator {

/// A design with what an actuator takes from it.
class DesignTrain {
 public:
  /// @throws std::invalid_argument where the design is not defined (design::why_undefined())
  explicit DesignTrain(const design::Design& design);

  [[nodiscard]] double ratio() const;  ///< signed
  /// J of twice the kinetic energy of its gears over the output's speed squared.
  [[nodiscard]] double inertia_kgm2() const;
  /// What its inertia lacks: "" where it is known.
  [[nodiscard]] const std::string& inertia_missing() const { return inertia_missing_; }
  /// Whether the inertia of its bodies has that of the carrier.
  [[nodiscard]] bool counts_carrier() const { return counts_carrier_; }
  /// Titles of the checks that the design fails.
  [[nodiscard]] const std::vector<std::string_view>& failed_checks() const { return failed_; }
  [[nodiscard]] std::optional<double> mass_kg() const { return mass_kg_; }
  /// At the output with the sun locked, meshes and springs; empty without [strength].
  [[nodiscard]] std::optional<double> stiffness_nm_rad() const { return stiffness_Nm_rad_; }
  /// Lost motion at the output with the sun locked, rigid bodies; 0 where teeth interfere.
  [[nodiscard]] double backlash_rad() const;
  [[nodiscard]] const std::string& name() const { return name_; }

  design::ShaftLosses<double> shafts;  ///< drags and bearings
  design::Friction friction;
  std::array<bool, train::kMeshCount> lossless_mesh{};
  double least_friction_speed_rad_s = 0.0;  ///< of the output, design::TrainMotion
  /// Of the moving bodies; zero where not known.
  inertia::BodyInertias<double> bodies{};

  [[nodiscard]] const train::TrainGeometry<double>& geometry() const { return geometry_; }
  [[nodiscard]] const std::array<double, 2>& face_width_m() const { return face_width_m_; }
  [[nodiscard]] double temperature_k() const { return temperature_K_; }

 private:
  std::string name_;
  train::TrainGeometry<double> geometry_;
  std::array<double, 2> face_width_m_{};
  double temperature_K_;
  std::string inertia_missing_;
  bool counts_carrier_ = false;
  std::vector<std::string_view> failed_;
  std::optional<double> mass_kg_, stiffness_Nm_rad_;
};

/// What results of a design do not show by themselves: checks that fail, gears without inertia.
std::vector<std::string> notes_of(const DesignTrain& train);

/// Names of its losses in the ledger: S-P1, P1-R1, P2-R2, bearing, drag_S, ...
const std::vector<std::string>& design_gear_causes();

/// The train without one cause of loss, or with "inertia" without the inertia of its bodies.
std::shared_ptr<const DesignTrain> without(const DesignTrain& train, const std::string& cause);

/// The gearbox of an actuator with a train.
std::unique_ptr<GearModel> design_gear(const Actuator& actuator);

/// The train for many instants; refers to it.
design::PreparedTrain prepared(const DesignTrain& train);

/// A train that is moved from the output against a given torque at the sun's end; for the first
/// harmonic of a free or braked motor.
///
/// @param motion  load_Nm is not used
/// @param input_Nm  u, of the fast side on the gearbox, reflected
/// @returns losses by design_gear_causes(), and as mesh_Nm the torque of the gearbox on the output
/// body behind R2; empty where the train locks
std::optional<GearInstant> moved_from_output(const design::PreparedTrain& prepared,
                                             const DesignTrain& train, const OutputMotion& motion,
                                             double input_Nm);
std::optional<double> output_torque(const DesignTrain& train, const OutputMotion& motion,
                                    double input_Nm);

}  // namespace gear3k::actuator
