#pragma once
// Stresses, safeties, stiffness and capacity, as `analyze` and `mesh` print them.

#include <optional>
#include <string>

#include "design/evaluation.hpp"
#include "report/fields.hpp"

namespace gear3k::report {

/// `strength` of a train, and its rows: meshes, teeth, stiffness, planet, capacity, factors.
/// @throws std::bad_optional_access without a rating
Fields strength_fields(const design::Evaluation& e);
/// `strength` of a pair: mesh, teeth, factors.  @throws std::bad_optional_access without a rating
Fields strength_fields(const design::PairEvaluation& e);

/// Stresses and safeties by tooth, capacity, stiffness, bearing loads, factors and what was not
/// stated; nothing without a rating.
std::string strength_table(const design::Evaluation& e);
std::string strength_table(const design::PairEvaluation& e);

/// Torque capacity and what governs it, of the stated load: a line.
/// @throws std::bad_optional_access without a rating
std::string capacity_summary(const design::Evaluation& e);
std::string capacity_summary(const design::PairEvaluation& e);

/// What is not judged as no limit stress of its material is stated: "root and flank of P2".
std::vector<std::string> not_judged(const design::Evaluation& e);
std::vector<std::string> not_judged(const design::PairEvaluation& e);

/// Capacity over the mass of all parts [N m/kg]; empty without either.
std::optional<double> torque_density(const design::Evaluation& e);

/// Mass of S, R1, R2 and all planets' steps [kg], as the objectives mass and torque_density count
/// it; empty where one is not known.
std::optional<double> gears_mass_kg(const design::Evaluation& e);

/// Capacity over that mass [N m/kg]; empty without either.
std::optional<double> gears_torque_density(const design::Evaluation& e);

}  // namespace gear3k::report
