#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "actuator/reflected.hpp"
#include "numerics/square.hpp"
#include "papers/backdrivability_ledger.hpp"
#include "report/display.hpp"

namespace gear3k::papers {

namespace {

using numerics::square, report::percent;

LedgerEntry table_damping_erratum(const BackdrivabilityStatements& s) {
  const double viscous = viscous_by_eq24(s);
  constexpr double kMicro = 1e6;
  return {.where = "Table I: D_mD; eqs. 38, 45",
          .paper = fmt::format("{:g} N m s/rad; {:g} and {:g} N m s/rad", s.motor_viscous_Nms,
                               s.eq38_viscous_Nms, s.eq45_viscous_Nms),
          .finding = "eq. 24 with Table I gives a tenth",
          .figures = {{"D_mD", "1e-6 N m s/rad", kMicro * viscous, 1},
                      {"eq. 38", "N m s/rad", square(s.ratio) * viscous, 3},
                      {"eq. 45", "N m s/rad", square(s.ratio) * viscous + s.gear_viscous_Nms, 3}}};
}

LedgerEntry eq37_erratum(const BackdrivabilityStatements& s) {
  const double printed = s.resistance_ohm / square(s.ratio * s.efficiency * s.torque_constant_Nm_A);
  return {.where = "eq. 37",
          .paper = fmt::format("R/(120 x 0.75 x K_t)^2 / eta' = {:g}/eta'", s.eq37_factor),
          .finding =
              "the fraction has eta' once more than eq. 15; the stated number is that with "
              "0.75 outside the square, which eq. 15 gives",
          .figures = {{"fraction as printed", "", printed, 4},
                      {"with 0.75 outside the square", "", s.efficiency * printed, 4},
                      {"eq. 15 with 0.75", "", printed, 4},
                      {"stated, with its 1/eta'", "", s.eq37_factor / s.efficiency, 4},
                      {"printed, with its 1/eta'", "", printed / s.efficiency, 4}}};
}

LedgerEntry reflected_inertia_erratum(const BackdrivabilityStatements& s) {
  const actuator::Reflected r = actuator::reflected(knee_actuator(s, KneeNumbers::kEquations));
  return {
      .where = "eqs. 41, 42, 45",
      .paper = fmt::format("{:g}, {:g} and {:g} kg m2", s.eq41_inertia_kgm2, s.eq42_inertia_kgm2,
                           s.eq45_inertia_kgm2),
      .finding = "120^2 times Table I's inertias is a tenth of each; eq. 2 would divide by eta'",
      .figures = {{"gearbox", "kg m2", r.gearbox_kgm2, 4},
                  {"motor", "kg m2", r.motor_kgm2, 4},
                  {"both", "kg m2", r.total_kgm2, 4},
                  {"both over 0.75", "kg m2", report::or_nan(r.speeding_up_kgm2), 4}}};
}

LedgerEntry parallel_spring_erratum(const BackdrivabilityStatements& s) {
  actuator::Actuator a = knee_actuator(s, KneeNumbers::kEquations);
  a.motor.shaft_stiffness_Nm_rad = s.motor_stiffness_Nm_rad / square(s.ratio);
  a.gearbox.stiffness_Nm_rad = s.gear_stiffness_Nm_rad;
  const actuator::Reflected r = actuator::reflected(a);
  const double in_series = report::or_nan(r.total_Nm_rad);
  return {.where = "eqs. 1, 45: stiffness",
          .paper = fmt::format("+ {:g} theta beside the inertia", s.eq45_stiffness_Nm_rad),
          .finding =
              "the springs are in series with the rotor: the term is right with the motor "
              "locked only, a free motor gives none",
          .figures = {{"in series", "N m/rad", in_series, 0},
                      {"torque at 1 rad", "N m", in_series, 0},
                      {"largest torque of the knee as printed", "N m", s.knee_torque_Nm, 0}}};
}

/// The gearbox's own balance at its acceleration torque: i T_in = T/η = (T + c2)/η_f.
LedgerEntry double_drag_erratum(const BackdrivabilityStatements& s) {
  const auto both = [&](double torque) {
    return torque * s.efficiency / (torque + s.eq39_coulomb_Nm);
  };
  return {.where = "eqs. 40, 45: 0.2 and 17 N m",
          .paper = "75 % efficiency, 0.2 of the load lost, and 17 N m of drag",
          .finding =
              "a maker's efficiency has the drag in it: with both the friction counts twice. "
              "0.2 is neither 1 - 0.75 nor what the mesh loses if 75 % holds at 54 N m",
          .figures = {
              {"forward at 46 N m with both", "%", percent(both(s.knee_torque_Nm)), 1},
              {"at 54 N m", "%", percent(both(s.acceleration_torque_Nm)), 1},
              {"mesh alone", "%", percent(mesh_efficiency(s)), 1},
              {"its loss driven backward", "%", percent(1.0 - backward_mesh_efficiency(s)), 1}}};
}

LedgerEntry breakaway_erratum(const BackdrivabilitySources& sources) {
  const BackdrivabilityStatements& s = sources.statements;
  const actuator::Reflected r = actuator::reflected(knee_actuator(s, KneeNumbers::kEquations));
  // The catalogue: backdriving torque = i starting torque/0.95.
  constexpr double kRatio = 100.0;
  constexpr double kAssumed = 0.95;
  double deviation = 0.0;
  double same_size = std::nan("");
  for (const StrainWaveGearbox& g : sources.strain_waves) {
    const double computed = kRatio * g.starting_Nm / kAssumed;
    deviation = std::max(deviation, std::abs(g.backdriving_Nm / computed - 1.0));
    if (g.size == 17.0) same_size = g.backdriving_Nm;
  }
  return {
      .where = "Table I, eq. 39: 34 N m",
      .paper = "maximum backdriving torque; half of \"the starting torque\" is Coulomb friction",
      .finding =
          "with it the motor at its nominal torque cannot start the unloaded gearbox; "
          "other gearboxes of its kind need far less. A catalogue's backdriving torque "
          "is computed (i times starting torque over 0.95), not measured",
      .figures = {{"motor torque that starts it", "N m", report::or_nan(r.breakaway_motor_Nm), 3},
                  {"nominal", "N m", s.motor_nominal_Nm, 3},
                  {"RT1 size 17, i = 100", "N m", same_size, 2},
                  {"CSG-25 in the low-backlash paper", "N m", sources.measured_strain_wave_Nm, 1},
                  {"RT1 off its rule, at most", "%", percent(deviation), 2}}};
}

LedgerEntry references_erratum(const BackdrivabilityStatements& s) {
  return {
      .where = "Secs. 3, 4.1: references",
      .paper =
          "subscripts a and g in eqs. 41 to 44; Table I from eqs. 7 and 23; eqs. 6 and 15 "
          "for inertia and stiffness; eq. 24 in section 3.3.1; eq. 35 from [17]; motor of "
          "90 W, in Table I 80 W",
      .finding =
          "gearbox (g) and motor (m); eqs. 18 and 24; eqs. 2 and 16; eq. 25; [18]. No "
          "shaft dimension is printed for eq. 44, whose stiffness is at the motor",
      .figures = {{"70000 over 120^2", "N m/rad", s.motor_stiffness_Nm_rad / square(s.ratio), 2}}};
}

// --- the stride

LedgerEntry negative_power_erratum(const KneeRun& run) {
  std::vector<Figure> figures{{"given back by the load", "J", run.duty.negative_J, 2}};
  if (run.duty.shares) {
    figures.push_back(
        {"while the mesh is driven backward", "%", percent(run.duty.shares->backdriven), 1});
    figures.push_back({"while the motor brakes", "%", percent(run.duty.shares->motor_braking), 1});
    figures.push_back({"while it gives current", "%", percent(run.duty.shares->regenerating), 1});
  }
  return {.where = "Sec. 4.1, Fig. 10",
          .paper = "negative power means that the actuator is backdriven",
          .finding =
              "its drag and inertia come first: the mesh turns round only where the load "
              "exceeds them. Of what the load gives back, corrected numbers",
          .figures = std::move(figures)};
}

LedgerEntry time_axis_erratum(const BackdrivabilityStatements& s, const KneeExample& knee) {
  const double stride = knee.cycle.time_s.back();
  const auto place = [&](double time_s) { return percent(time_s / stride); };
  std::vector<Figure> figures{
      {"stretches of negative power", "", static_cast<double>(knee.negative.size()), 0}};
  double at_zero_torque = 0.0;
  for (const NegativeStretch& n : knee.negative) at_zero_torque += n.begins_at_zero_torque;
  figures.push_back({"that begin at zero torque", "", at_zero_torque, 0});
  if (!knee.negative.empty()) {
    figures.push_back({"first from", "% of the stride", place(knee.negative.front().from_s), 1});
    figures.push_back({"to", "%", place(knee.negative.front().to_s), 1});
  }
  return {.where = "Sec. 4.1, Figs. 10, 11: sec.",
          .paper = fmt::format("points I at {:g} and II at {:g} sec.", s.point_i, s.point_ii),
          .finding =
              "a stride takes about one second: the axis is in per cent of it. Another "
              "source's curves have the same four stretches",
          .figures = std::move(figures)};
}

LedgerEntry passable_erratum(const BackdrivabilityStatements& s) {
  return {.where = "Sec. 4.1: I to II",
          .paper =
              fmt::format("backdriven during about 2/3 of the time from {:g} to {:g}, from {:g} on",
                          s.point_i, s.point_ii, s.enough_torque),
          .finding = "its own three instants give more",
          .figures = {
              {"share", "%", percent((s.point_ii - s.enough_torque) / (s.point_ii - s.point_i)), 1},
              {"stated", "%", percent(s.passable_share), 1}}};
}

LedgerEntry regeneration_erratum(const BackdrivabilityStatements& s, const KneeExample& knee) {
  std::vector<Figure> figures{{"friction, eq. 39", "N m", s.eq39_coulomb_Nm, 1}};
  for (std::size_t k = 1; k < knee.negative.size(); ++k) {
    figures.push_back({fmt::format("largest torque of stretch {}", k + 1), "N m",
                       knee.negative[k].peak_torque_Nm, 1});
  }
  for (const KneeRun& run : knee.runs) {
    figures.push_back({"regenerated, " + run.name, "J", run.duty.regenerated_J, 2});
  }
  figures.push_back({"of what the load gives back", "J", knee.runs.front().duty.negative_J, 2});
  return {
      .where = "Sec. 4.1, Fig. 11: III to VIII",
      .paper = "the torque is not enough to overcome friction: no regeneration",
      .finding =
          "the torque of these curves exceeds it in two of them, and slowing down gives back the "
          "rotor's own energy as well",
      .figures = std::move(figures)};
}

LedgerEntry magnitude_erratum(const KneeExample& knee) {
  const double peak = std::max(knee.peak_power_W, -knee.least_power_W);
  std::vector<Figure> figures{{"largest power of the knee", "W", peak, 1},
                              {"its work on the load", "J", knee.runs.front().duty.positive_J, 2}};
  for (const KneeRun& run : knee.runs) {
    figures.push_back({"electrical, " + run.name, "W", run.peak_electrical_W, 0});
    figures.push_back({"drawn, " + run.name, "J", run.duty.drawn_J, 1});
  }
  return {
      .where = "Sec. 4.1, Fig. 11: power",
      .paper = "the electrical power is an order of magnitude larger than the knee's",
      .finding =
          "so is the energy over the work; the power is three to four times the knee's, eqs. 38, "
          "41, 42 and 45 as printed make it almost two orders. Peaks hold the steps of "
          "acceleration of the digitised speed",
      .figures = std::move(figures)};
}

}  // namespace

std::vector<LedgerEntry> knee_number_errata(const BackdrivabilitySources& sources) {
  const BackdrivabilityStatements& s = sources.statements;
  return {table_damping_erratum(s),   eq37_erratum(s),        reflected_inertia_erratum(s),
          parallel_spring_erratum(s), double_drag_erratum(s), breakaway_erratum(sources),
          references_erratum(s)};
}

std::vector<LedgerEntry> stride_errata(const BackdrivabilitySources& sources,
                                       const BackdrivabilityComparison& comparison) {
  const BackdrivabilityStatements& s = sources.statements;
  const KneeExample& knee = comparison.knee;
  return {negative_power_erratum(knee.runs.back()), time_axis_erratum(s, knee), passable_erratum(s),
          regeneration_erratum(s, knee), magnitude_erratum(knee)};
}

}  // namespace gear3k::papers
