#pragma once
// The relaxed problems of a specification's stages: which of its limits each stage has by itself.

#include <array>
#include <limits>
#include <optional>

#include "optimize/shift_range.hpp"
#include "optimize/stage_relaxation.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// Least loss of a mesh over that of the first-order model, as a coefficient of friction.
///
/// Path models: the loss of a pair at a point is the first-order one over 1 − σ μ ρ_d/r_bd, at
/// least that over 1 + μ ρ_d/r_bd.  Factors on a first-order model add the difference of two such
/// losses, which may be negative even where no factor is below 1.
/// Source: own derivation, docs/theory §32 (32.9, 32.10).
/// Valid: tip pressure angles of the driving gears up to that of the lever 5.9 = ρ_d/r_bd.
/// @returns μ of the bound; 0 where it says nothing
double least_friction(const Specification& spec, bool forward);

/// Makes the tasks of relax_stage() for the stages of a specification.  Every limit is given way by
/// what feasible designs may miss it by; what ties the stages is dropped.
/// Source: own derivation, docs/theory §32.
class StageTasks {
 public:
  /// @param spec  must outlive the tasks' maker
  explicit StageTasks(const Specification& spec);

  /// Whether the meshes of both stages add to one limited lost motion (the kinematic model).
  [[nodiscard]] bool shares_lost_motion() const;
  /// S, P1, R1 with their shifts.
  /// @param share  of the lost motion that S-P1 and P1-R1 may have, 0 to 1
  [[nodiscard]] StageTask stage1(const Candidate& c, const std::array<Interval, 3>& shifts,
                                 double share) const;
  /// P2, R2 with their shifts.
  /// @param most_distance  greatest centre distance of any stage 1, in its modules
  [[nodiscard]] StageTask stage2(const Candidate& c, const std::array<Interval, 2>& shifts,
                                 double share, double most_distance) const;

 private:
  [[nodiscard]] double loss(double teeth) const;
  [[nodiscard]] StageGear gear(int id, int teeth, const Interval& shift) const;
  /// Least normal backlash of a mesh, in its modules.
  [[nodiscard]] Interval backlash_floor(std::size_t mesh) const;
  /// Least 1/w of every flank; empty: any.
  [[nodiscard]] std::optional<double> rolling_share() const;
  /// Least root clearance of a stage's meshes, in its modules; empty: any.
  [[nodiscard]] std::optional<double> root_clearance(std::size_t stage) const;
  [[nodiscard]] StageTask common(const Candidate& c, int planet, int ring, const Interval& planet_x,
                                 const Interval& ring_x) const;

  const Specification& spec_;
  std::array<Interval, 2> module_;
  Interval ratio_{};
  double friction_ = 0.0;
  /// Of the lost motion, for the meshes of one stage [rad].
  double budget_ = std::numeric_limits<double>::infinity();
};

}  // namespace gear3k::optimize
