#pragma once
// The sun's torque of a train of fixed geometry with its derivatives by what it loses.

#include <array>
#include <memory>
#include <optional>

#include "design/operation.hpp"

namespace gear3k::design {

/// A train of fixed geometry; refers to it.
struct FixedTrain {
  const train::TrainGeometry<double>& geometry;
  std::array<double, 2> face_width_m{};
};

/// What a train loses.
struct VariedLosses {
  efficiency::Friction<Jet1> friction;
  ShaftLosses<Jet1> shafts;
};

/// operate()'s sun_torque_Nm with its derivatives by the losses, in many states of one train.
///
/// R2's mesh carries what R2 is loaded with, and the meshes of S and R1 together what R2 and the
/// carrier leave, whatever the friction: of three mesh torques friction decides one, τ that of S,
///
///   τ = F(τ, p):   dτ/dp = ∂F/∂p / (1 − ∂F/∂τ)
///
/// τ is found by Newton's method with F and ∂F/∂τ alone, with the efficiency in the direction of
/// each mesh's power only, and the derivatives by p follow from the balance there.  What no state
/// changes is made once.
/// Source: theorem of implicit functions; docs/theory §24-§26 as operate().
/// Accuracy: as operate() to rounding, which it was tested against.
class SunTorque {
 public:
  /// @param train  its geometry must outlive this
  SunTorque(const FixedTrain& train, const VariedLosses& losses);

  /// @returns empty also where operate() has to decide: it does not settle in a few passes, repels
  /// the passes of operate(), or the members that drive are not those of a train without losses
  /// @param more_output_torque_Nm  on top of the point's, of any sign
  [[nodiscard]] std::optional<Jet1> at(const OperatingPoint<double>& point, Direction direction,
                                       const Jet1& more_output_torque_Nm = Jet1(0.0)) const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace gear3k::design
