#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "numerics/square.hpp"
#include "papers/backdrivability_ledger.hpp"
#include "report/display.hpp"

namespace gear3k::papers {

namespace {

using numerics::square;

const ScalingLaw& law_named(const BackdrivabilityComparison& c, const std::string& name) {
  const auto at = std::ranges::find(c.laws, name, &ScalingLaw::name);
  if (at == c.laws.end()) throw std::invalid_argument("no scaling law " + name);
  return *at;
}

/// A fitted exponent with its band.
std::vector<Figure> exponent_figures(const ScalingLaw& law, const std::string& what) {
  std::vector<Figure> figures;
  for (const ScalingFactor& f : law.factors) {
    const std::string of = what + " over " + f.name;
    figures.push_back({of + ", fitted exponent", "", f.exponent, 2});
    figures.push_back({of + ", 95 % band +-", "", f.band, 2});
  }
  return figures;
}

void append_figures(std::vector<Figure>& figures, const std::vector<Figure>& more) {
  figures.insert(figures.end(), more.begin(), more.end());
}

LedgerEntry acceleration_erratum(const BackdrivabilitySources& sources,
                                 const BackdrivabilityComparison& c) {
  const actuator::Cycle& cycle = c.knee.cycle;
  double acceleration = 0.0;
  for (std::size_t k = 0; k + 1 < cycle.time_s.size(); ++k) {
    acceleration = std::max(acceleration, std::abs(cycle.motion[k + 1] - cycle.motion[k]) /
                                              (cycle.time_s[k + 1] - cycle.time_s[k]));
  }
  const auto& s = sources.statements;
  const double inertia = square(s.ratio) * (s.gear_inertia_kgm2 + s.rotor_inertia_kgm2);
  return {.where = "eqs. 1, 2",
          .paper = "the inertia times the angular speed",
          .finding = "times the angular acceleration. On the walking knee:",
          .figures = {{"inertia times largest speed", "N m", inertia * c.knee.peak_speed_rad_s, 2},
                      {"inertia times largest acceleration", "N m", inertia * acceleration, 2}}};
}

/// Energy of a planet: ½ J_P w_P² with the absolute spin w_P = w_C + w'_P.
std::vector<LedgerEntry> planet_errata(const BackdrivabilitySources& sources) {
  const train::SpeedRatios w = train::speed_ratios(sources.prototype);
  const double relative = w.planet - w.carrier;
  const double input_over_planet = std::abs(w.sun / relative);
  return {{.where = "eqs. 3 to 5, Fig. 2: planets",
           .paper = "J_P with the spin relative to the carrier; J_P again in the carrier's inertia",
           .finding = "kinetic energy needs the absolute spin: the product of both speeds is "
                      "missing. Factors of J_P at the output of the low-backlash prototype",
           .figures = {{"relative spin squared", "", square(relative), 0},
                       {"carrier's speed squared", "", square(w.carrier), 0},
                       {"their sum", "", square(relative) + square(w.carrier), 0},
                       {"absolute spin squared", "", square(w.planet), 0}}},
          {.where = "eq. 5 against eqs. 3, 4",
           .paper = "planet's speed = i'_P times the input's; inertias are divided by i'_P^2",
           .finding = "eq. 5 has to divide by i'_P too. On the same gear",
           .figures = {{"input's over planet's speed", "", input_over_planet, 2},
                       {"share of J_P at the input", "", 1.0 / square(input_over_planet), 4},
                       {"with i'_P as eq. 5 has it", "", square(input_over_planet), 2}}}};
}

/// Backward, the motor's torque follows from eq. 2's own i T_I = η' τ: I = η' τ/(i K_t).
std::vector<LedgerEntry> copper_errata(const BackdrivabilityStatements& s) {
  const double copper = s.resistance_ohm / square(s.ratio * s.torque_constant_Nm_A);
  const double printed = copper / square(s.efficiency);
  constexpr double kSlow_rad_s = 0.1;
  return {
      {.where = "eq. 15: copper",
       .paper = "R tau^2/(i^2 eta'^2 K_t^2 w)",
       .finding = "driven backward less than tau reaches the motor (eq. 2): eta'^2 belongs in "
                  "the numerator. Factor of tau^2/w with eta' = 0.75, in rad/(N m s)",
       .figures = {{"as printed", "", printed, 4},
                   {"right", "", copper * square(s.efficiency), 4},
                   {"printed over right", "", 1.0 / square(square(s.efficiency)), 2}}},
      {.where = "eqs. 8, 15, 37, 45: copper as a torque",
       .paper = "copper loss over the output's speed, among the torques that brake",
       .finding = "a winding brakes by its current alone: the loss is taken from what the motor "
                  "brakes with, and it stays at rest. At the paper's largest torque",
       .figures = {{"copper at rest, lossless gearbox", "W", copper * square(s.knee_torque_Nm), 1},
                   {"torque by eq. 37 at 0.1 rad/s", "N m",
                    s.eq37_factor / s.efficiency * square(s.knee_torque_Nm) / kSlow_rad_s, 0}}},
      {.where = "eq. 15: friction of the motor",
       .paper = "i T_c and i^2 D_m, no efficiency",
       .finding = "the mesh passes it on like inertia (eq. 2): both over eta'. Damping at the "
                  "output with eta' = 0.75",
       .figures = {
           {"as eq. 15", "N m s/rad", square(s.ratio) * viscous_by_eq24(s), 3},
           {"over eta'", "N m s/rad", square(s.ratio) * viscous_by_eq24(s) / s.efficiency, 3}}}};
}

LedgerEntry static_friction_erratum() {
  constexpr double kExponent = 5.0;
  return {.where = "eqs. 11, 15, 38, 40: exp(-beta w)",
          .paper = "D_S exp(-beta w), called a friction factor",
          .finding =
              "grows without bound for negative speeds; with |w| and the sign of w it is a "
              "torque, no damping. Times D_S at beta |w| = 5",
          .figures = {{"forward", "", std::exp(-kExponent), 4},
                      {"backward, as printed", "", std::exp(kExponent), 1}}};
}

/// A spring K on the fast side: u = i² K θ; backward u = η_b m, forward m = η_f u.
LedgerEntry spring_erratum(const BackdrivabilityStatements& s) {
  return {.where = "eqs. 16, 17, 19",
          .paper = "i^2 K eta; third term of eq. 19 with i'_P",
          .finding =
              "opposite to eq. 2: i^2 K/eta_b while the output loads the spring, eta_f i^2 K "
              "while it is let out; the third term needs i_C. Factor of i^2 K at 0.75",
          .figures = {{"as printed", "", s.efficiency, 2},
                      {"loading", "", 1.0 / s.efficiency, 3},
                      {"let out", "", s.efficiency, 2}}};
}

std::vector<LedgerEntry> stiffness_law_errata(const BackdrivabilityComparison& c) {
  std::vector<Figure> shaft{{"K of a shaft twice as long, eq. 18", "", 0.5, 1},
                            {"by eq. 25", "", 2.0, 1}};
  append_figures(shaft, exponent_figures(law_named(c, "strain_wave_stiffness"), "K1 of RT1"));
  append_figures(shaft, exponent_figures(law_named(c, "strain_wave_last_stiffness"), "K3 of RT1"));
  std::vector<Figure> quotient{{"K over T for similar shapes, eqs. 28, 31, 34", "", 5.0 / 3.0, 2},
                               {"corrected", "", 1.0, 2}};
  append_figures(quotient, exponent_figures(law_named(c, "stiffness_over_torque"), "K3 of RT1"));
  return {{.where = "eqs. 18, 25",
           .paper = "eq. 18 called a compliance; K ~ L d^4",
           .finding = "eq. 18 is a stiffness, and it falls with the length: K ~ d^4/L, for similar "
                      "shapes d^3 and not d^5",
           .figures = std::move(shaft)},
          {.where = "eqs. 28, 31, 34; Fig. 8",
           .paper = "K/T ~ d^2, L d, L^2 fits no gearbox; Fig. 8's K ~ T is empirical",
           .finding = "with eq. 25 corrected K/T ~ d^2/L^2, d/L and constant: for similar shapes "
                      "all of them are Fig. 8. Exponents of K over T; Fig. 8 has the acceleration "
                      "torque, RT1's is the rated one",
           .figures = std::move(quotient)}};
}

std::vector<LedgerEntry> motor_law_errata(const BackdrivabilityComparison& c) {
  std::vector<Figure> size = exponent_figures(law_named(c, "motor_inertia"), "inertia");
  append_figures(size, exponent_figures(law_named(c, "motor_torque"), "torque"));
  const ScalingLaw& all = law_named(c, "motor_inertia_over_torque");
  std::vector<Figure> torque{{"eqs. 23, 35 at L ~ d", "", *all.factors[0].equations, 2}};
  append_figures(torque, exponent_figures(all, "inertia of all frames"));
  append_figures(torque, exponent_figures(law_named(c, "motor_torque_per_inertia"),
                                          "torque per inertia of Megaflux"));
  return {{.where = "eqs. 22, 23, 35",
           .paper = "J ~ L d^3 or L d^4, T ~ L d^2.5",
           .finding =
               "of 23 frames of one series neither inertia law is within the band, and the "
               "torque's diameter is, not its length. Eq. 35 is of the stall torque; fitted is the "
               "continuous one (K_t times nominal current), the only one in the table",
           .figures = std::move(size)},
          {.where = "eq. 36, Fig. 9",
           .paper = "T/J ~ d^-1.5; J ~ T^1.5 \"does not directly correspond\" to it",
           .finding =
               "eqs. 23 and 35 give both, T^1.43 for similar shapes; the frames of one series "
               "miss eq. 36, as they miss eq. 23. The torque is the continuous one throughout: "
               "Fig. 9's is 2.5 times that, which leaves the exponent, eq. 36's the stall torque. "
               "The band over all frames holds Fig. 9's exponent, not that of eqs. 23, 35",
           .figures = std::move(torque)}};
}

LedgerEntry no_load_erratum(const BackdrivabilitySources& sources) {
  std::vector<double> shares;
  shares.reserve(sources.no_load_torques.size());
  for (const NoLoadTorque& t : sources.no_load_torques) {
    shares.push_back(t.coulomb_Nm / (t.coulomb_Nm + t.viscous_Nm));
  }
  if (shares.empty()) throw std::invalid_argument("no motor with both parts of no-load torque");
  std::ranges::sort(shares);
  const std::size_t half = shares.size() / 2;
  const double median =
      shares.size() % 2 == 1 ? shares[half] : 0.5 * (shares[half - 1] + shares[half]);
  const auto& s = sources.statements;
  return {.where = "eq. 24",
          .paper = "all no-load torque is viscous",
          .finding = "makers that give both parts have much Coulomb friction in it. Its share",
          .figures = {{"motors", "", static_cast<double>(shares.size()), 0},
                      {"median", "%", report::percent(median), 0},
                      {"least", "%", report::percent(shares.front()), 0},
                      {"largest", "%", report::percent(shares.back()), 0},
                      {"Table I's motor at the output, were it all Coulomb", "N m",
                       s.ratio * s.torque_constant_Nm_A * s.no_load_current_A, 3}}};
}

}  // namespace

std::vector<LedgerEntry> equation_errata(const BackdrivabilitySources& sources,
                                         const BackdrivabilityComparison& comparison) {
  std::vector<LedgerEntry> entries{acceleration_erratum(sources, comparison)};
  const auto add = [&](std::vector<LedgerEntry> more) {
    for (LedgerEntry& entry : more) entries.push_back(std::move(entry));
  };
  add(planet_errata(sources));
  add(copper_errata(sources.statements));
  entries.push_back(static_friction_erratum());
  entries.push_back(spring_erratum(sources.statements));
  add(stiffness_law_errata(comparison));
  add(motor_law_errata(comparison));
  entries.push_back(no_load_erratum(sources));
  return entries;
}

}  // namespace gear3k::papers
