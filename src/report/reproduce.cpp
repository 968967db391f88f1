#include "report/reproduce.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "efficiency/train_efficiency.hpp"
#include "geometry/involute.hpp"
#include "optimize/optimizer.hpp"
#include "report/text_table.hpp"
#include "report/version.hpp"

namespace gear3k::report {

namespace {

using backlash::LostMotionModel;
using design::Design, design::Evaluation, design::Unit;
using efficiency::LossModel;

constexpr double kTableFriction = 0.1;  // where the paper gives no μ, the value of the tables

double mm(double m) { return design::in_unit(m, Unit::kMillimetre); }
double um(double m) { return design::in_unit(m, Unit::kMicrometre); }
double arcmin(double rad) { return design::in_unit(rad, Unit::kArcmin); }

/// The root of an increasing function by bisection to rounding.
template <class Function>
double root_of_increasing(Function f, double low, double high) {
  for (int k = 0; k < 200 && low < high; ++k) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Evaluation evaluated(const Design& design) {
  auto result = design::evaluate(design);
  if (const auto* undefined = std::get_if<design::NotDefined>(&result)) {
    throw std::invalid_argument(fmt::format("{}: {}", design.name, undefined->message));
  }
  return std::get<Evaluation>(std::move(result));
}

Design with_friction(Design design, double mu, LossModel model) {
  design.friction = {.coefficient = mu, .model = model};
  return design;
}

Design with_allowance(Design design, double q) {
  design.train.machining_allowance.fill(q);
  return design;
}

Design at_distance(Design design, double center_distance_m) {
  design.train.center_distance_m = center_distance_m;
  design.center_distance_given = true;
  return design;
}

double lost_motion(const Evaluation& e, LostMotionModel model) {
  return model == LostMotionModel::kPaper ? e.backlash.paper_rad : e.backlash.kinematic_rad;
}

/// The allowance, the same on every gear, with which the model gives a lost motion.
double explaining_allowance(const Design& design, double lost_motion_rad, LostMotionModel model) {
  return root_of_increasing(
      [&](double q) {
        return lost_motion(evaluated(with_allowance(design, q)), model) - lost_motion_rad;
      },
      0.0, 1.0);
}

enum class Direction { kForward, kBackward };

double efficiency_at(const Design& design, double mu, LossModel model, Direction direction) {
  const Evaluation e = evaluated(with_friction(design, mu, model));
  return direction == Direction::kForward ? e.efficiency.forward : e.efficiency.backward;
}

/// The friction that gives a measured efficiency (efficiency falls with μ).
double fitted_friction(const Design& design, LossModel model, Direction direction,
                       double measured) {
  return root_of_increasing(
      [&](double mu) { return measured - efficiency_at(design, mu, model, direction); }, 0.0, 0.5);
}

std::string model_name(LossModel model) {
  return std::string(efficiency::kLossModelNames[static_cast<std::size_t>(model)]);
}

void append_inertia_rows(const Evaluation& e, GearboxComparison& comparison) {
  // The factors with which J_S and J_P (one planet, both steps) appear in the output's inertia.
  const train::SpeedRatios w = train::speed_ratios(e.teeth);
  const auto& m = e.meshes;
  auto& rows = comparison.rows;
  rows.push_back({.quantity = "J_S factor at output, lossy (eq. 32 | exact i^2/eta_b)",
                  .unit = "",
                  .paper = w.sun * w.sun / (m[0].efficiency_backward * m[1].efficiency_backward),
                  .equations = w.sun * w.sun / e.efficiency.backward,
                  .measured = {},
                  .decimals = 1});
  rows.push_back({.quantity = "J_P factor per planet, rolling part (eq. 32 | kinetic energy)",
                  .unit = "",
                  .paper = w.planet_rolling * w.planet_rolling,
                  .equations = w.planet * w.planet,
                  .measured = {},
                  .decimals = 2});
  rows.push_back({.quantity = "J_P factor with the carrier's absolute speed (eqs. 32-33 | energy)",
                  .unit = "",
                  .paper = w.planet_rolling * w.planet_rolling + w.carrier * w.carrier,
                  .equations = w.planet * w.planet,
                  .measured = {},
                  .decimals = 2});
}

GearboxComparison compare(const PublishedGearbox& gearbox) {
  const Evaluation e =
      evaluated(with_friction(gearbox.design, kTableFriction, LossModel::kOhlendorf));
  GearboxComparison comparison{.name = e.name, .rows = {}, .efficiency = {}, .fits = {}};
  auto& rows = comparison.rows;
  rows.push_back({.quantity = "ratio",
                  .unit = "",
                  .paper = gearbox.stated_ratio,
                  .equations = e.ratio,
                  .measured = {},
                  .decimals = 3});
  for (const design::MeshResult& m : e.meshes) {
    std::optional<double> distance = m.zero_backlash_center_distance_m;
    if (distance) distance = mm(*distance);
    rows.push_back({.quantity = fmt::format("zero-backlash centre distance {}", m.name),
                    .unit = "mm",
                    .paper = {},
                    .equations = distance,
                    .measured = {},
                    .decimals = 4});
  }
  const std::string at = fmt::format(" at d = {:.4f} mm", mm(e.center_distance_m));
  for (std::size_t k = 0; k < e.meshes.size(); ++k) {
    const design::MeshResult& m = e.meshes[k];
    std::optional<double> stated;
    if (gearbox.stated_contact_ratio) stated = (*gearbox.stated_contact_ratio)[k];
    rows.push_back({.quantity = fmt::format("contact ratio {}{}", m.name, at),
                    .unit = "",
                    .paper = stated,
                    .equations = m.contact_ratio,
                    .measured = {},
                    .decimals = 3});
  }
  for (const design::MeshResult& m : e.meshes) {
    rows.push_back({.quantity = fmt::format("normal backlash {}, q = 0{}", m.name, at),
                    .unit = "um",
                    .paper = {},
                    .equations = um(m.normal_backlash_m),
                    .measured = {},
                    .decimals = 2});
  }
  const auto to_arcmin = [](std::optional<double> rad) {
    if (rad) rad = arcmin(*rad);
    return rad;
  };
  for (const LostMotionModel model : {LostMotionModel::kPaper, LostMotionModel::kKinematic}) {
    const std::string name = model == LostMotionModel::kPaper ? "eq. 17" : "kinematic";
    rows.push_back({.quantity = fmt::format("lost motion, {}, q = 0{}", name, at),
                    .unit = "arcmin",
                    .paper = to_arcmin(gearbox.stated_lost_motion_rad),
                    .equations = arcmin(lost_motion(e, model)),
                    .measured = to_arcmin(gearbox.measured_lost_motion_rad),
                    .decimals = 2});
    if (!gearbox.measured_lost_motion_rad) continue;
    const Design fixed = at_distance(gearbox.design, e.center_distance_m);
    const double q = explaining_allowance(fixed, *gearbox.measured_lost_motion_rad, model);
    rows.push_back({.quantity = fmt::format("allowance q that explains {:.3g} arcmin, {}{}",
                                            arcmin(*gearbox.measured_lost_motion_rad), name, at),
                    .unit = "module",
                    .paper = {},
                    .equations = q,
                    .measured = {},
                    .decimals = 5});
    const Evaluation explained = evaluated(with_allowance(fixed, q));
    rows.push_back({.quantity = fmt::format("  the least normal backlash then ({})", name),
                    .unit = "um",
                    .paper = {},
                    .equations = um(std::ranges::min(explained.meshes, {},
                                                     &design::MeshResult::normal_backlash_m)
                                        .normal_backlash_m),
                    .measured = {},
                    .decimals = 2});
  }
  append_inertia_rows(e, comparison);

  for (const double mu : {0.05, 0.075, 0.10, 0.125, 0.15}) {
    const auto eta = [&](LossModel model, Direction direction) {
      return efficiency_at(gearbox.design, mu, model, direction);
    };
    comparison.efficiency.push_back(
        {.mu = mu,
         .ohlendorf_forward = eta(LossModel::kOhlendorf, Direction::kForward),
         .ohlendorf_backward = eta(LossModel::kOhlendorf, Direction::kBackward),
         .sliding_forward = eta(LossModel::kSliding, Direction::kForward),
         .sliding_backward = eta(LossModel::kSliding, Direction::kBackward)});
  }
  if (gearbox.measured_forward && gearbox.measured_backward) {
    for (const LossModel model : {LossModel::kOhlendorf, LossModel::kSliding}) {
      const double mu =
          fitted_friction(gearbox.design, model, Direction::kForward, *gearbox.measured_forward);
      comparison.fits.push_back(
          {.model = model_name(model),
           .mu = mu,
           .backward = efficiency_at(gearbox.design, mu, model, Direction::kBackward),
           .backward_mu = fitted_friction(gearbox.design, model, Direction::kBackward,
                                          *gearbox.measured_backward),
           .measured_forward = *gearbox.measured_forward,
           .measured_backward = *gearbox.measured_backward});
    }
  }
  return comparison;
}

// --- the ledger

class Ledger {
 public:
  explicit Ledger(const PublishedSources& s)
      : s_(s),
        proposed_(
            evaluated(with_friction(s.low_backlash.design, kTableFriction, LossModel::kOhlendorf))),
        bilateral_(
            evaluated(with_friction(s.bilateral.design, kTableFriction, LossModel::kOhlendorf))) {}

  std::vector<LedgerEntry> entries() {
    add("eq. 18", "denominator 1 - eta_P1R1 eta_P2R2 G1", misprinted_efficiency());
    add("Table II, ratio", fmt::format("{:g}:1 for both gears", *s_.low_backlash.stated_ratio),
        fmt::format("{} teeth give {:.3f}:1 ({:+.2f} %), {} teeth {:.3f}:1 ({:+.2f} %)",
                    proposed_.name, proposed_.ratio, off(proposed_.ratio), bilateral_.name,
                    bilateral_.ratio, off(bilateral_.ratio)));
    add("Table II, x_P2 of the bilateral drive gear", "0.526", planet_shift());
    add("Sec. II, IV: backlash of the proposed gear",
        "approximately 8 arcmin by the model, 7.1 measured, accuracy 98.5 %; neither q, d nor the "
        "effective radii of eq. 16 are given",
        common_distance());
    add("Table II: assembly of the proposed gear", "3 planets", assembly());
    add("eqs. 14, 15", "d1 for mesh 1, d2 for meshes 2 and 3", two_distances());
    add("eq. 10", "factor 1.5 before m z sin(alpha)", ring_factor());
    add("eq. 17", "phi_1 + max(phi_2, phi_3)", added_angles());
    add("eqs. 30-33", "i_T as a ratio of rolling speeds; planets by their rolling speed",
        rolling_speeds());
    add("Sec. V: efficiency", "no friction coefficient is published", friction());
    add("Sec. IV, Table II", "\"optimal parameter set\"", optimum());
    add("eq. 2", "alpha + gamma_1 - alpha_s1", tangent_length());
    add("Sec. V.B: back-drive starting torque",
        fmt::format("{:g} Nm, about 1/450 of a strain wave gear", s_.backdrive_starting_torque_Nm),
        starting_torque());
    return std::move(entries_);
  }

 private:
  void add(std::string where, std::string paper, std::string computed) {
    entries_.push_back({.number = static_cast<int>(entries_.size()) + 1,
                        .where = std::move(where),
                        .paper = std::move(paper),
                        .computed = std::move(computed)});
  }

  [[nodiscard]] double off(double ratio) const {
    return 100.0 * (ratio / *s_.low_backlash.stated_ratio - 1.0);
  }

  [[nodiscard]] std::string misprinted_efficiency() const {
    const auto& m = proposed_.meshes;
    const double eta1 = m[0].efficiency_forward;
    const double eta2 = m[1].efficiency_forward;
    const double eta3 = m[2].efficiency_forward;
    const double g1 = proposed_.g1;
    const double g2 = proposed_.g2;
    const double printed =
        (1.0 + eta1 * eta2 * g1) * (1.0 - g2) / ((1.0 - eta2 * eta3 * g1) * (1.0 + g1));
    return fmt::format(
        "as printed eta_f = {:.4f} for the proposed gear at mu = {:g}; with G2 {:.4f}", printed,
        kTableFriction, proposed_.efficiency.forward);
  }

  [[nodiscard]] std::string planet_shift() const {
    constexpr double kPrintedShift = 0.526;
    Design printed = s_.bilateral.design;
    printed.train.profile_shift[train::kP2] = kPrintedShift;
    const Evaluation p = evaluated(printed);
    const auto distance = [](const Evaluation& e, std::size_t k) {
      return mm(*e.meshes[k].zero_backlash_center_distance_m);
    };
    return fmt::format(
        "centre distances {:.4f}, {:.4f} mm of stage 1 against {:.4f} mm with {:g}, {:.4f} mm with "
        "{:g}",
        distance(bilateral_, 0), distance(bilateral_, 1), distance(p, 2), kPrintedShift,
        distance(bilateral_, 2), s_.bilateral.design.train.profile_shift[train::kP2]);
  }

  /// Interference at the common distance that has least of it (q = 0).
  [[nodiscard]] std::string common_distance() const {
    const Design& design = s_.low_backlash.design;
    const auto meshes_at = [&](double d) { return evaluated(at_distance(design, d)).meshes; };
    const double d = root_of_increasing(
        [&](double distance) {
          const auto m = meshes_at(distance);
          return m[0].normal_backlash_m - std::min(m[1].normal_backlash_m, m[2].normal_backlash_m);
        },
        0.99 * proposed_.center_distance_m, 1.01 * proposed_.center_distance_m);
    const double measured = *s_.low_backlash.measured_lost_motion_rad;
    const double stated = *s_.low_backlash.stated_lost_motion_rad;
    const auto& m = proposed_.meshes;
    return fmt::format(
        "zero-backlash distances {:.4f}, {:.4f}, {:.4f} mm: with q = 0 some mesh interferes by "
        "{:.0f} um at the best common distance {:.3f} mm, by {:.0f} um at mesh 2's own; {:.2g} "
        "arcmin are {:.0f} um at R2's pitch radius; measured and modelled differ by {:.0f} %",
        mm(*m[0].zero_backlash_center_distance_m), mm(*m[1].zero_backlash_center_distance_m),
        mm(*m[2].zero_backlash_center_distance_m), -um(meshes_at(d)[0].normal_backlash_m), mm(d),
        -um(m[0].normal_backlash_m), arcmin(measured),
        um(measured * 0.5 * proposed_.gears[train::kR2].pitch_diameter_m),
        100.0 * (1.0 - measured / stated));
  }

  [[nodiscard]] std::string assembly() const {
    const auto describe = [](const Evaluation& e) {
      const auto& z = e.teeth;
      const long long difference = std::abs(1LL * z.R2 * z.P1 - 1LL * z.R1 * z.P2);
      const long long gcd = std::gcd(z.P1, z.P2);
      return fmt::format(
          "{}: zS + zR1 = {}, zR2 zP1 - zR1 zP2 = {}, N gcd = {}: {}", e.name, z.S + z.R1,
          difference, e.planets * gcd,
          e.assembly.identical_planets ? "identical planets fit" : "identical planets do not fit");
    };
    return describe(proposed_) + "; " + describe(bilateral_);
  }

  [[nodiscard]] std::string two_distances() const {
    const auto& m = proposed_.meshes;
    const double d1 = *m[0].zero_backlash_center_distance_m;
    const double d2 = *m[1].zero_backlash_center_distance_m;
    const Evaluation at_d1 = evaluated(at_distance(s_.low_backlash.design, d1));
    return fmt::format(
        "one carrier has one distance: with full teeth d1 and d2 differ by {:.1f} um, and at d1 "
        "mesh P1-R1 would interfere by {:.1f} um",
        um(d1 - d2), -um(at_d1.meshes[1].normal_backlash_m));
  }

  /// The factor c with which eq. 10 agrees with eqs. 11 and 12.
  [[nodiscard]] std::string ring_factor() const {
    const double alpha = s_.low_backlash.design.train.pressure_angle_rad;
    const double z = proposed_.teeth.R1;
    const double x = s_.low_backlash.design.train.profile_shift[train::kR1];
    const double alpha_s3 =
        -alpha + std::numbers::pi / (2.0 * z) + (1.0 + 2.0 * x / z) * std::tan(alpha);
    const double c = (0.5 * z * std::cos(alpha) * (alpha + alpha_s3) -
                      0.25 * std::numbers::pi * std::cos(alpha) - x * std::sin(alpha)) /
                     (z * std::sin(alpha));
    return fmt::format(
        "eq. 12 follows from eqs. 10-11 with the factor {:.3f} (for R1: z = {:g}, "
        "x = {:g})",
        c, z, x);
  }

  [[nodiscard]] std::string added_angles() const {
    const Design fixed = at_distance(s_.low_backlash.design, proposed_.center_distance_m);
    const double q = explaining_allowance(fixed, *s_.low_backlash.measured_lost_motion_rad,
                                          LostMotionModel::kPaper);
    const Evaluation e = evaluated(with_allowance(fixed, q));
    const auto& share = e.backlash.kinematic_share_rad;
    return fmt::format(
        "rigid bodies with the sun locked add: where eq. 17 gives {:.2f} arcmin (q = {:.4f}), the "
        "kinematics give {:.2f} + {:.2f} + {:.2f} = {:.2f}",
        arcmin(e.backlash.paper_rad), q, arcmin(share[0]), arcmin(share[1]), arcmin(share[2]),
        arcmin(e.backlash.kinematic_rad));
  }

  [[nodiscard]] std::string rolling_speeds() const {
    const train::SpeedRatios w = train::speed_ratios(proposed_.teeth);
    return fmt::format(
        "the rolling ratio w'_S/w'_R2 is {:.1f}, the absolute one {:.3f}; read literally eq. 32 "
        "gives a planet {:.1f} J_P where kinetic energy gives {:.0f} J_P, and w'_C = 0; its sun "
        "term is {:.0f} J_S where i^2/eta_b is {:.0f} J_S",
        w.sun_rolling, w.sun, w.planet_rolling * w.planet_rolling, w.planet * w.planet,
        w.sun * w.sun /
            (proposed_.meshes[0].efficiency_backward * proposed_.meshes[1].efficiency_backward),
        w.sun * w.sun / proposed_.efficiency.backward);
  }

  [[nodiscard]] std::string friction() const {
    std::string text;
    for (const PublishedGearbox* g : {&s_.low_backlash, &s_.bilateral}) {
      const double mu = fitted_friction(g->design, LossModel::kOhlendorf, Direction::kForward,
                                        *g->measured_forward);
      const double back = efficiency_at(g->design, mu, LossModel::kOhlendorf, Direction::kBackward);
      text += fmt::format(
          "{}{}: forward {:.1f} % needs mu = {:.3f}, which predicts backward {:.1f} % (measured "
          "{:.1f} %, which needs mu = {:.3f})",
          text.empty() ? "" : "; ", g->design.name, 100.0 * *g->measured_forward, mu, 100.0 * back,
          100.0 * *g->measured_backward,
          fitted_friction(g->design, LossModel::kOhlendorf, Direction::kBackward,
                          *g->measured_backward));
    }
    std::string outside;
    for (const design::MeshResult& m : proposed_.meshes) {
      if (m.loss_model_in_range) continue;
      outside += fmt::format("{}{} (approach {:.2f}, recess {:.2f})", outside.empty() ? "" : ", ",
                             m.name, m.approach_contact_ratio, m.recess_contact_ratio);
    }
    return text +
           fmt::format("; the loss formula is outside its range on the proposed gear: {}", outside);
  }

  [[nodiscard]] std::string optimum() const {
    const optimize::RefinedSet set =
        optimize::refine(s_.task, {.teeth = proposed_.teeth, .planets = proposed_.planets});
    return fmt::format(
        "at mu = {:g} the published set has eta_b = {:.1f} %; the same teeth reach {:.1f} % with x "
        "in [{:g}, {:g}] and at most {:.3g} arcmin by eq. 17 (task rp96)",
        kTableFriction, 100.0 * proposed_.efficiency.backward, 100.0 * set.eta_b,
        s_.task.profile_shift.min, s_.task.profile_shift.max,
        arcmin(s_.task.limits[design::CheckId::kOutputBacklashMax].value_or(0.0)));
  }

  /// Backlash of mesh 1 by eqs. 1-6, with eq. 2's first angle as printed and as it must be.
  [[nodiscard]] std::string tangent_length() const {
    const auto& t = s_.low_backlash.design.train;
    const double alpha = t.pressure_angle_rad;
    const double m = t.module_m[0];
    const double alpha_w = proposed_.meshes[0].working_pressure_angle_rad;
    const auto start_angle = [&](int z, double x) {  // eqs. 5, 6 at q = 0
      return alpha + std::numbers::pi / (2.0 * z) - (1.0 + 2.0 * x / z) * std::tan(alpha);
    };
    const int z_s = t.teeth.S;
    const int z_p = t.teeth.P1;
    const auto backlash = [&](double first_angle) {
      const double bp1 =
          0.5 * m * z_s * std::cos(alpha) *
          (first_angle + std::numbers::pi / z_s - start_angle(z_s, t.profile_shift[train::kS]));
      const double p2p3 = 0.5 * m * z_p * std::cos(alpha) *
                          (alpha_w - start_angle(z_p, t.profile_shift[train::kP1]));
      return 2.0 * (proposed_.center_distance_m * std::sin(alpha_w) - bp1 - p2p3);
    };
    return fmt::format(
        "eqs. 1-6 as printed give S-P1 a backlash of {:.1f} um, with alpha_w1 in its place {:.1f} "
        "um, which is eq. 13's {:.1f} um (proposed gear, d = {:.4f} mm)",
        um(backlash(alpha)), um(backlash(alpha_w)), um(proposed_.meshes[0].normal_backlash_m),
        mm(proposed_.center_distance_m));
  }

  [[nodiscard]] std::string starting_torque() const {
    return fmt::format(
        "read where the output first moves, possibly still inside the lost motion: it is {:.1f} % "
        "of the largest back-driving torque {:g} Nm; against the strain wave gear's {:g} Nm the "
        "ratios are 1/{:.0f} and 1/{:.0f}; not a friction datum",
        100.0 * s_.backdrive_starting_torque_Nm / s_.max_backdriving_torque_Nm,
        s_.max_backdriving_torque_Nm, s_.strain_wave_starting_torque_Nm,
        s_.strain_wave_starting_torque_Nm / s_.backdrive_starting_torque_Nm,
        s_.strain_wave_starting_torque_Nm / s_.max_backdriving_torque_Nm);
  }

  const PublishedSources& s_;
  Evaluation proposed_, bilateral_;
  std::vector<LedgerEntry> entries_;
};

std::string shown(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : std::string("-");
}

nlohmann::ordered_json or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

Reproduction reproduce(const PublishedSources& sources) {
  return {.gearboxes = {compare(sources.low_backlash), compare(sources.bilateral)},
          .ledger = Ledger(sources).entries()};
}

std::string reproduce_table(const Reproduction& r) {
  std::string text;
  for (const GearboxComparison& g : r.gearboxes) {
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", g.name);
    TextTable table({"quantity", "paper", "equations", "measured", "unit"});
    table.align_left(4);
    for (const ComparedRow& row : g.rows) {
      table.add({row.quantity, shown(row.paper, row.decimals), shown(row.equations, row.decimals),
                 shown(row.measured, row.decimals), row.unit});
    }
    text += table.text(2);
    text += "\n  Efficiency by the paper's formula (ohlendorf) and by mean sliding, in %\n";
    TextTable efficiency(
        {"mu", "ohlendorf forward", "ohlendorf backward", "sliding forward", "sliding backward"});
    const auto percent = [](double eta) { return fmt::format("{:.2f}", 100.0 * eta); };
    for (const EfficiencyPoint& p : g.efficiency) {
      efficiency.add({fmt::format("{:g}", p.mu), percent(p.ohlendorf_forward),
                      percent(p.ohlendorf_backward), percent(p.sliding_forward),
                      percent(p.sliding_backward)});
    }
    text += efficiency.text(4);
    for (const FrictionFit& f : g.fits) {
      text += fmt::format(
          "  {}: mu = {:.3f} gives the measured forward {:.1f} %; backward is then {:.1f} %, "
          "measured {:.1f} % ({:+.1f} points; that needs mu = {:.3f})\n",
          f.model, f.mu, 100.0 * f.measured_forward, 100.0 * f.backward,
          100.0 * f.measured_backward, 100.0 * (f.backward - f.measured_backward), f.backward_mu);
    }
  }
  text += "\nLedger of errata: low-backlash 3K gearbox paper\n";
  for (const LedgerEntry& entry : r.ledger) {
    text += fmt::format("{:>3}. {}\n     paper:    {}\n     computed: {}\n", entry.number,
                        entry.where, entry.paper, entry.computed);
  }
  return text;
}

std::string reproduce_json(const Reproduction& r) {
  using nlohmann::ordered_json;
  ordered_json gearboxes = ordered_json::array();
  for (const GearboxComparison& g : r.gearboxes) {
    ordered_json rows = ordered_json::array();
    for (const ComparedRow& row : g.rows) {
      rows.push_back({{"quantity", row.quantity},
                      {"unit", row.unit},
                      {"paper", or_null(row.paper)},
                      {"equations", or_null(row.equations)},
                      {"measured", or_null(row.measured)}});
    }
    ordered_json efficiency = ordered_json::array();
    for (const EfficiencyPoint& p : g.efficiency) {
      efficiency.push_back(
          {{"mu", p.mu},
           {"ohlendorf", {{"forward", p.ohlendorf_forward}, {"backward", p.ohlendorf_backward}}},
           {"sliding", {{"forward", p.sliding_forward}, {"backward", p.sliding_backward}}}});
    }
    ordered_json fits = ordered_json::array();
    for (const FrictionFit& f : g.fits) {
      fits.push_back({{"loss_model", f.model},
                      {"mu_forward", f.mu},
                      {"backward_predicted", f.backward},
                      {"backward_measured", f.measured_backward},
                      {"mu_backward", f.backward_mu}});
    }
    gearboxes.push_back({{"name", g.name},
                         {"rows", std::move(rows)},
                         {"efficiency", std::move(efficiency)},
                         {"friction_fits", std::move(fits)}});
  }
  ordered_json ledger = ordered_json::array();
  for (const LedgerEntry& entry : r.ledger) {
    ledger.push_back({{"number", entry.number},
                      {"where", entry.where},
                      {"paper", entry.paper},
                      {"computed", entry.computed}});
  }
  const ordered_json json{{"tool", {{"version", version()}, {"git", git_commit()}}},
                          {"gearboxes", std::move(gearboxes)},
                          {"ledger", std::move(ledger)}};
  return json.dump(2) + "\n";
}

std::string reproduce_csv(const Reproduction& r) {
  std::string text = "gearbox,quantity,unit,paper,equations,measured\n";
  const auto field = [](const std::optional<double>& v) { return v ? exact(*v) : std::string(); };
  for (const GearboxComparison& g : r.gearboxes) {
    for (const ComparedRow& row : g.rows) {
      text += csv_line({g.name, row.quantity, row.unit, field(row.paper), field(row.equations),
                        field(row.measured)});
    }
    for (const EfficiencyPoint& p : g.efficiency) {
      const auto line = [&](const char* what, double eta) {
        text +=
            csv_line({g.name, fmt::format("{} at mu = {:g}", what, p.mu), "", "", exact(eta), ""});
      };
      line("eta_f ohlendorf", p.ohlendorf_forward);
      line("eta_b ohlendorf", p.ohlendorf_backward);
      line("eta_f sliding", p.sliding_forward);
      line("eta_b sliding", p.sliding_backward);
    }
    for (const FrictionFit& f : g.fits) {
      text += csv_line(
          {g.name, fmt::format("mu fitted to forward, {}", f.model), "", "", exact(f.mu), ""});
      text += csv_line({g.name, fmt::format("eta_b with that mu, {}", f.model), "", "",
                        exact(f.backward), exact(f.measured_backward)});
    }
  }
  return text;
}

}  // namespace gear3k::report
