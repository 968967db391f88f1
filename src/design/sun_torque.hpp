#pragma once
// The sun's torque of a train of fixed geometry with its derivatives by what it loses.

#include <array>
#include <optional>

#include "design/operation.hpp"
#include "design/train_motion.hpp"

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
///   τ = F(τ, p):   dT/dp = ∂T/∂p + ∂T/∂τ (I − ∂F/∂τ)⁻¹ ∂F/∂p
///
/// The mesh torques τ that friction is taken at are iterated as plain numbers until they repeat to
/// rounding, with the efficiency in the direction of each mesh's power only, and the derivatives
/// follow from the balance there: twenty times as fast as to iterate them too.  What no state
/// changes is made once.
/// Source: theorem of implicit functions; docs/theory §24-§26 as operate().
/// Accuracy: as operate() to rounding, which it was tested against.
class SunTorque {
 public:
  /// @param train  its geometry must outlive this
  SunTorque(const FixedTrain& train, VariedLosses losses);

  /// @returns empty also where operate() has to decide: it does not settle in a few passes, or
  /// another combination of driving members is in balance too
  [[nodiscard]] std::optional<Jet1> at(const OperatingPoint<double>& point,
                                       Direction direction) const;

 private:
  FixedTrain train_;
  VariedLosses losses_;
  /// The losses as numbers, of which `by_torque_` has no derivatives either: its scalar carries
  /// those by the three mesh torques.
  struct Numbers {
    efficiency::Friction<double> friction;
    ShaftLosses<double> shafts;
  } numbers_;
  struct ByTorque {
    efficiency::Friction<Jet3> friction;
    ShaftLosses<Jet3> shafts;
  } by_torque_;
  /// Of the meshes at any speed; and the sun's speed over the output's.
  std::array<MeshConstants<double>, train::kMeshCount> meshes_;
  double sun_speed_ = 0.0;
  bool meshes_run_ = true;  ///< all have a contact ratio
};

}  // namespace gear3k::design
