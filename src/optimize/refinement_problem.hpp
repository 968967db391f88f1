#pragma once
// The nonlinear programme behind one tooth set: shifts, modules and centre distance for the best
// value of an objective under the checks.  Independent of any solver.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "optimize/problem_branch.hpp"
#include "optimize/shift_range.hpp"
#include "optimize/specification.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// An objective that has to reach a value, or (without one) a branch of the objective that is the
/// larger one.
struct ObjectiveRow {
  Objective objective{};
  std::optional<double> limit;  ///< SI
  int branch = 0;               ///< see objective_value()
  double scale = 1.0;
};

/// One inequality g ≥ 0: a check, an objective, a limit of what is felt, or a bound on a module
/// that is a dependent quantity.
struct ConstraintRow {
  std::optional<design::CheckInstance> check;
  std::optional<ObjectiveRow> objective;
  std::optional<FeltLimit> felt{};
  int stage = 0;         ///< module bound: 0 or 1
  double bound_m = 0.0;  ///< module bound [m]
  bool at_least = true;  ///< module bound: module ≥ bound, else ≤
  std::string_view
      name;  ///< of the check, objective or what is felt, or stage1_module / stage2_module
};

/// Most variables of a problem: five shifts, two working angles, a module, five tip shortenings,
/// the pressure angle, two face widths and the torque.
inline constexpr std::size_t kMostUnknowns = 17;
/// Values of the variables; a problem uses the first `variables` of them.
using Point = std::array<double, kMostUnknowns>;
/// Places of the variables after the five shifts (in the order of train::GearId).
inline constexpr std::size_t kAngleA = train::kGearCount;      ///< a
inline constexpr std::size_t kAngleB = train::kGearCount + 1;  ///< b, if any

/// One tooth set with its modules, as a programme in at most kMostUnknowns variables of order 1:
///
///   v = (x_S, x_P1, x_R1, x_P2, x_R2, a [, b] [, m1/scale] [, k_S .. k_R2] [, α]
///        [, b_1/b_1max] [, b_2/b_2max] [, T/T_stated])
///
/// a = working pressure angle [rad] of the mesh with the largest base-circle sum among those whose
/// module is known with a, b = that of mesh P2-R2 when stage 2's module is free and not that of
/// stage 1.  Angles instead of
/// (m, d) keep every point of the box inside the model's domain: with
///   d = m z_sum cos α/(2 cos α_w)
/// the meshes of smaller base sums have cos α_w < 1 whenever a > 0.
/// Minimise f subject to g_k ≥ 0 and the box; f is the objective, negative where it is maximised,
/// in units of its scale: −η for efficiencies.  Source: own derivation, docs/theory §12.
struct RefinementProblem {
  Candidate candidate;
  const Specification* spec = nullptr;  ///< must outlive the problem
  std::array<std::optional<double>, 2> fixed_module_m;
  std::array<int, 2> cutter_teeth{};  ///< of R1 and R2; 0: as stated
  int angle_mesh = 0;                 ///< mesh whose working angle is v[5]
  int variables = 0;
  std::size_t scale = 0;           ///< place of m1/length_scale_m; 0: given, or from m2 and b
  std::size_t first_tip = 0;       ///< place of k_S; 0: tips are as stated
  std::size_t pressure_angle = 0;  ///< place of α [rad]; 0: as stated
  /// Places of the face widths over their greatest, by stage; 0: as stated.
  std::array<std::size_t, 2> face_width{};
  std::size_t torque = 0;  ///< place of T/T_stated; 0: as stated
  std::array<double, kMostUnknowns> lower{}, upper{};
  double length_scale_m = 1e-3;
  Objective objective = Objective::kBackwardEfficiency;
  double objective_scale = 1.0;
  ProblemBranch branch;
  std::vector<ConstraintRow> rows;
};

/// The specification's train with these teeth before refinement: one shift for all gears, the least
/// modules, no centre distance.
train::TrainParameters<double> unrefined_train(const Specification& spec,
                                               const Candidate& candidate,
                                               double profile_shift = 0.0);

/// z1 + z2, or zR − zP, by mesh.
std::array<double, train::kMeshCount> tooth_sums(const train::ToothSet& z);

/// @param fixed_module_m  a module for each stage that is not refined continuously
RefinementProblem make_refinement_problem(const Specification& spec, const Candidate& candidate,
                                          std::array<std::optional<double>, 2> fixed_module_m,
                                          const ProblemBranch& branch = {});

/// The same in two steps, for many tooth sets: the rows, less those that shift ranges see to; then
/// the tooth set with its shift ranges as a box.
RefinementProblem make_problem_rows(const Specification& spec, int planets,
                                    std::array<std::optional<double>, 2> fixed_module_m,
                                    const ProblemBranch& branch = {});
void set_teeth(RefinementProblem& problem, const Candidate& candidate, const ShiftRanges& shifts);
/// As make_refinement_problem() makes it: every check a row, the whole shift range the box.
RefinementProblem with_all_rows(const RefinementProblem& problem);

/// The train at a point of the box.
template <class T>
train::TrainParameters<T> parameters_at(const RefinementProblem& problem, std::span<const T> v);

/// What the gears carry and how wide they are, at a point of the box.
template <class T>
struct LoadAt {
  std::array<T, 2> face_width_m{};  ///< by stage; 0 where it is not stated
  T torque_Nm{};                    ///< at R2; 0 without a rating
};
template <class T>
LoadAt<T> load_at(const RefinementProblem& problem, std::span<const T> v);

/// The point of a train with its load: what parameters_at() and load_at() make of it again, to
/// rounding.
Point point_of(const RefinementProblem& problem, const train::TrainParameters<double>& train,
               const LoadAt<double>& load);

/// f at v, scaled to order 1, and g into the caller's buffer (the solvers call this without
/// allocating); constraints.size() must be rows.size().
/// @returns f; empty where the model is not defined or anything is not finite
template <class T>
std::optional<T> evaluate(const RefinementProblem& problem, std::span<const T> v,
                          std::span<T> constraints);

/// The same with some of the rows only; constraints.size() must be selection.size().
/// @param selection  rising indices into problem.rows
template <class T>
std::optional<T> evaluate(const RefinementProblem& problem, std::span<const T> v,
                          std::span<const std::uint16_t> selection, std::span<T> constraints);

/// Largest violation max(0, −g_k); infinite when a g_k is NaN.
double worst_violation(std::span<const double> constraints);

/// The variables in use.
template <class T>
std::span<const T> used(const RefinementProblem& problem,
                        const std::array<T, kMostUnknowns>& values) {
  return {values.data(), static_cast<std::size_t>(problem.variables)};
}

}  // namespace gear3k::optimize
