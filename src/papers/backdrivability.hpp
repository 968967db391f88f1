#pragma once
// The backdrivability-factors paper beside what its own equations give and what is right: its knee
// actuator (eqs. 37 to 45), its scaling laws, its ledger of errata.

#include <optional>
#include <string>
#include <vector>

#include "papers/compared_row.hpp"
#include "papers/knee_example.hpp"
#include "papers/ledger.hpp"
#include "papers/scaling_laws.hpp"
#include "train/tooth_set.hpp"

namespace gear3k::papers {

/// What the paper prints of its knee actuator, in SI units.
struct BackdrivabilityStatements {
  // Table I and section 4.1.
  double ratio, acceleration_torque_Nm, efficiency;
  double gear_inertia_kgm2, gear_stiffness_Nm_rad, max_backdriving_Nm, gear_viscous_Nms;
  double rotor_inertia_kgm2, motor_stiffness_Nm_rad, motor_viscous_Nms;
  double resistance_ohm, torque_constant_Nm_A, no_load_speed_rad_s, no_load_current_A;
  double motor_nominal_Nm, knee_torque_Nm, body_mass_kg;
  // Eqs. 37 to 45.
  double eq37_factor, eq38_viscous_Nms, eq39_coulomb_Nm, eq40_load_share;
  double eq41_inertia_kgm2, eq42_inertia_kgm2;
  double eq45_torque_factor, eq45_viscous_Nms, eq45_inertia_kgm2, eq45_stiffness_Nm_rad;
  // Of Figs. 9 to 11; places as printed, in "sec.".
  double point_i, enough_torque, point_ii, passable_share, fig9_exponent;
};

/// A motor's no-load torque by a maker that gives both of its parts.
struct NoLoadTorque {
  double coulomb_Nm, viscous_Nm;  ///< the latter at no-load speed
};

/// A maker's strain-wave gearbox.
struct StrainWaveGearbox {
  double size, pitch_radius_m, rated_Nm, backdriving_Nm, starting_Nm;
  double first_stiffness_Nm_rad, last_stiffness_Nm_rad;  ///< K1, K3
};

struct BackdrivabilitySources {
  BackdrivabilityStatements statements{};
  MotionCurves knee;
  std::vector<NoLoadTorque> no_load_torques;
  std::vector<StrainWaveGearbox> strain_waves;
  ScalingTables scaling;
  double measured_strain_wave_Nm = 0.0;  ///< starting torque of a CSG-25, in the low-backlash paper
  train::ToothSet prototype{};           ///< of the low-backlash gear, for a planet's energy
};

struct BackdrivabilityComparison {
  std::vector<ComparedRow> rows;  ///< eqs. 24 and 37 to 45
  std::vector<ScalingLaw> laws;
  KneeExample knee;
  std::vector<LedgerEntry> ledger;
};

/// Evaluates everything.
/// @throws std::invalid_argument when a table has too few rows for its law
BackdrivabilityComparison compare_backdrivability(const BackdrivabilitySources& sources);

/// D_mD = K_t I_0/w_0, eq. 24.
double viscous_by_eq24(const BackdrivabilityStatements& s);

/// Efficiency of the mesh alone, where `efficiency` is that of the whole gearbox at its
/// acceleration torque T with the drag c2 in it: η_f = η (T + c2)/T.
/// Source: own derivation, docs/theory §58.
double mesh_efficiency(const BackdrivabilityStatements& s);
/// The same driven backward, with the same loss per torque of the mesh: η_b = 2 − 1/η_f.
/// Source: own derivation, m − η_b m = m/η_f − m.
double backward_mesh_efficiency(const BackdrivabilityStatements& s);

}  // namespace gear3k::papers
