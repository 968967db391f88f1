#include "papers/backdrivability.hpp"

#include <fmt/format.h>

#include "actuator/chain.hpp"
#include "actuator/reflected.hpp"
#include "numerics/square.hpp"
#include "papers/backdrivability_ledger.hpp"
#include "report/display.hpp"

namespace gear3k::papers {

using numerics::square, report::or_nan;

double viscous_by_eq24(const BackdrivabilityStatements& s) {
  return s.torque_constant_Nm_A * s.no_load_current_A / s.no_load_speed_rad_s;
}

double mesh_efficiency(const BackdrivabilityStatements& s) {
  return s.efficiency * (s.acceleration_torque_Nm + s.eq39_coulomb_Nm) / s.acceleration_torque_Nm;
}

double backward_mesh_efficiency(const BackdrivabilityStatements& s) {
  return 2.0 - 1.0 / mesh_efficiency(s);
}

namespace {

/// Eqs. 24 and 37 to 44: one term each.
///
/// Driven from the output with the motor off (docs/theory §58, flow of the mesh backward, τ = 0):
///   T = (J2 + J1/η_b) a + (D2 + D1/η_b) w + c2 + c1/η_b
/// and copper takes R (η_b m/(i K_t))² while the motor's torque holds a torque m of the mesh.
std::vector<ComparedRow> term_rows(const BackdrivabilityStatements& s) {
  const actuator::Actuator equations = knee_actuator(s, KneeNumbers::kEquations);
  const actuator::Actuator corrected = knee_actuator(s, KneeNumbers::kCorrected);
  const actuator::Reflected plain = actuator::reflected(equations);
  const double eta_b = corrected.gearbox.efficiency_backward;
  const double copper = s.resistance_ohm / square(s.ratio * s.torque_constant_Nm_A);
  const double viscous = viscous_by_eq24(s);
  return {{"Table I, eq. 24: D_mD", "N m s/rad", s.motor_viscous_Nms, viscous, viscous, {}, 7},
          {"eq. 37: fraction before tau^2/(eta' w)",
           "rad/(N m s)",
           s.eq37_factor,
           copper / square(s.efficiency),
           {},
           {},
           4},
          {"eq. 37: factor of tau^2/w (eq. 15; eta' = 0.75 put in)",
           "rad/(N m s)",
           s.eq37_factor / s.efficiency,
           copper / square(s.efficiency),
           copper * square(eta_b),
           {},
           4},
          {"eq. 38: motor's damping, factor of w",
           "N m s/rad",
           s.eq38_viscous_Nms,
           plain.motor_Nms,
           plain.motor_Nms / eta_b,
           {},
           3},
          {"eq. 39: Coulomb friction, half of the breakaway torque",
           "N m",
           s.eq39_coulomb_Nm,
           0.5 * s.max_backdriving_Nm,
           {},
           {},
           1},
          {"eq. 40: loss of the mesh over its torque",
           "",
           s.eq40_load_share,
           1.0 - s.efficiency,
           1.0 - eta_b,
           {},
           4},
          {"eq. 41: gearbox inertia",
           "kg m2",
           s.eq41_inertia_kgm2,
           plain.gearbox_kgm2,
           plain.gearbox_kgm2 / eta_b,
           {},
           4},
          {"eq. 42: motor inertia",
           "kg m2",
           s.eq42_inertia_kgm2,
           plain.motor_kgm2,
           plain.motor_kgm2 / eta_b,
           {},
           4},
          {"eq. 43: gearbox stiffness",
           "N m/rad",
           s.gear_stiffness_Nm_rad,
           s.gear_stiffness_Nm_rad,
           s.gear_stiffness_Nm_rad,
           {},
           0},
          {"eq. 44: motor stiffness (no dimension is printed)",
           "N m/rad",
           s.motor_stiffness_Nm_rad,
           {},
           {},
           {},
           0}};
}

/// Eq. 45, term by term.  Corrected, with the motor off and multiplied by η_b as it stands there:
///   η_b (T − c2 − D2 w) − D1 w = J1 a
/// Copper brakes no output, and a free motor has no stiffness against the frame.
std::vector<ComparedRow> eq45_rows(const BackdrivabilityStatements& s) {
  const actuator::Chain plain = actuator::chain_of(knee_actuator(s, KneeNumbers::kEquations));
  const actuator::Chain corrected = actuator::chain_of(knee_actuator(s, KneeNumbers::kCorrected));
  const double eta_b = corrected.efficiency_backward;
  const double copper = s.resistance_ohm / square(s.ratio * s.torque_constant_Nm_A);
  const double in_series = 1.0 / (1.0 / s.gear_stiffness_Nm_rad + 1.0 / s.motor_stiffness_Nm_rad);
  return {
      {"eq. 45: factor of tau", "", s.eq45_torque_factor, s.efficiency, eta_b, {}, 4},
      {"eq. 45: factor of tau^2/w (eta' = 0.75 put in)",
       "rad/(N m s)",
       s.eq37_factor / s.efficiency,
       copper / square(s.efficiency),
       0.0,
       {},
       4},
      {"eq. 45: Coulomb friction",
       "N m",
       s.eq39_coulomb_Nm,
       plain.c2_Nm,
       eta_b * corrected.c2_Nm,
       {},
       2},
      {"eq. 45: factor of w",
       "N m s/rad",
       s.eq45_viscous_Nms,
       plain.d1_Nms + plain.d2_Nms,
       corrected.d1_Nms + eta_b * corrected.d2_Nms,
       {},
       3},
      {"eq. 45: factor of the acceleration",
       "kg m2",
       s.eq45_inertia_kgm2,
       plain.j1_kgm2,
       corrected.j1_kgm2,
       {},
       3},
      {"eq. 45: factor of the angle", "N m/rad", s.eq45_stiffness_Nm_rad, in_series, 0.0, {}, 0}};
}

}  // namespace

BackdrivabilityComparison compare_backdrivability(const BackdrivabilitySources& sources) {
  BackdrivabilityComparison c;
  c.rows = term_rows(sources.statements);
  for (ComparedRow& row : eq45_rows(sources.statements)) c.rows.push_back(std::move(row));
  c.laws = scaling_laws(sources.scaling, sources.statements.fig9_exponent);
  c.knee = knee_example(sources.statements, sources.knee);
  c.ledger = backdrivability_ledger(sources, c);
  return c;
}

}  // namespace gear3k::papers
