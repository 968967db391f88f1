#pragma once
// The sun's torque of a train of fixed geometry with its derivatives by what it loses.

#include <array>
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

/// operate()'s sun_torque_Nm with its derivatives by the losses.
///
///   τ = F(τ, p):   dT/dp = ∂T/∂p + ∂T/∂τ (I − ∂F/∂τ)⁻¹ ∂F/∂p
///
/// The mesh torques τ that friction is taken at are iterated as plain numbers until they repeat to
/// rounding, with the efficiency in the direction of each mesh's power only, and the derivatives
/// follow from the balance there: twenty times as fast as to iterate them too.
/// Source: theorem of implicit functions; docs/theory §24-§26 as operate().
/// Accuracy: as operate() to rounding, which it was tested against.
/// @returns empty also where operate() has to decide: it does not settle in a few passes, or
/// another combination of driving members is in balance too
std::optional<Jet1> sun_torque(const FixedTrain& train, const VariedLosses& losses,
                               const OperatingPoint<double>& point, Direction direction);

}  // namespace gear3k::design
