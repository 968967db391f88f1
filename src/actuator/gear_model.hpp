#pragma once
// What a gearbox asks of the motor's side at an instant: by catalogue values, or a designed train.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "actuator/chain.hpp"
#include "actuator/cycle.hpp"

namespace gear3k::actuator {

/// The output at an instant.
struct OutputMotion {
  double speed_rad_s = 0.0, acceleration_rad_s2 = 0.0;
  double load_Nm = 0.0;  ///< T_L
  double sense = 1.0;    ///< s; at w = 0 the side from which it is looked at
};

inline constexpr std::size_t kMostGearLosses = 8;

/// Torques at the output, and where power is lost.
template <std::size_t kCauses>
struct GearInstantOf {
  double mesh_Nm = 0.0;                  ///< m, of the mesh on the output body
  double input_Nm = 0.0;                 ///< u, of the fast side on the gearbox, reflected
  std::array<double, kCauses> loss_W{};  ///< by GearModel::causes()
};
using GearInstant = GearInstantOf<kMostGearLosses>;

class GearModel {
 public:
  GearModel() = default;
  GearModel(const GearModel&) = delete;
  GearModel& operator=(const GearModel&) = delete;
  virtual ~GearModel() = default;

  /// Names of its losses in the ledger.
  [[nodiscard]] virtual const std::vector<std::string>& causes() const = 0;
  [[nodiscard]] virtual GearInstant at(const OutputMotion& motion) const = 0;
  /// Where within (x0, x1) of a piece the flow of a mesh changes its direction, appended ascending.
  virtual void append_flow_changes(const CyclePiece& piece, std::array<double, 2> range,
                                   double sense, std::vector<double>& roots) const = 0;
  /// Torques of the fast side, less the motor's friction, between which the output rests.
  [[nodiscard]] virtual RestBand band(double load_Nm) const = 0;
  /// Whether u is a polynomial of the motion between changes of the flow.
  [[nodiscard]] virtual bool constant_efficiencies() const = 0;
  /// Where within a piece at rest the band has its kinks, appended.
  virtual void append_band_kinks(const CyclePiece& piece, std::vector<double>& places) const = 0;
  /// J of twice the kinetic energy over w², gearbox and load.
  [[nodiscard]] virtual double inertia_kgm2() const = 0;
};

/// The gearbox of an actuator.
/// @throws std::runtime_error from at() and band() of a train that locks or has no friction there
std::unique_ptr<GearModel> gear_model(const Actuator& actuator);

/// The output at a place of a piece.
inline OutputMotion motion_at(const CyclePiece& piece, double x, double sense) {
  return {.speed_rad_s = value_at(piece.speed_rad_s, x),
          .acceleration_rad_s2 = piece.acceleration(x),
          .load_Nm = value_at(piece.load_Nm, x),
          .sense = sense};
}

}  // namespace gear3k::actuator
