#pragma once
// Bounds from below of what every motor does with one gearbox: internal to actuator/.

#include <cstddef>
#include <vector>

#include "actuator/selection.hpp"

namespace gear3k::actuator {

/// The actuator of a pair of a task.
Actuator actuator_of(const SelectionTask& task, const Pair& pair);

/// Sets what no cycle changes: mass, breakaway, inertia.
void set_constants(const Motor& motor, const Gearbox& gearbox, const Chain& chain,
                   PairResult& result);

/// Whether a task limits what is felt.
bool limits_felt(const FeltLimits& limits);

/// Time of all cycles, by their weights [s].
double total_time(const SelectionTask& task);

/// Moments of the cycles of a gearbox, and all motors of a task held against them at once: loops
/// over motors, which a compiler makes vectors of.
class Screening {
 public:
  /// @param task  must outlive it
  explicit Screening(const SelectionTask& task);

  /// Bounds from below of everything that the exact cycles of each motor give with a gearbox,
  /// judged; by motor.  Valid until the next call.
  const std::vector<PairResult>& bounds(std::size_t gearbox);
  /// The same with the gearbox of an actuator, such as a train; pairs name gearbox 0.
  const std::vector<PairResult>& bounds(const Actuator& first);

 private:
  using Column = std::vector<double>;
  /// Of the motors, and as they act through the gearbox at hand.
  struct Motors {
    Column rotor_kgm2, viscous_Nms, coulomb_Nm, resistance_ohm, constant_Nm_A;
    Column j1_kgm2, d1_Nms, c1_Nm, per_torque, back_emf;
  };
  struct Sums {
    Column square_A2, energy_J, magnitude_J;
  };

  const std::vector<PairResult>& bounds(const Actuator& first, std::size_t gearbox);
  void reflect_motors(double ratio);
  void add_cycle(const CycleMoments& moments, double weight);
  void set_peaks();
  [[nodiscard]] Felt felt_bound(const Chain& chain) const;

  const SelectionTask& task_;
  double time_s_;
  std::vector<std::vector<CyclePiece>> pieces_;  ///< by cycle
  Motors motors_;
  Sums sums_;
  std::vector<CycleMoments> moments_;  ///< by cycle, of the gearbox at hand
  std::vector<std::size_t> left_;      ///< motors whose peaks decide
  std::vector<PairResult> results_;
};

}  // namespace gear3k::actuator
