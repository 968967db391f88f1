#include "papers/paper_ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "geometry/involute.hpp"
#include "optimize/optimizer.hpp"
#include "papers/published_fits.hpp"
#include "report/display.hpp"

namespace gear3k::papers {

namespace {

using backlash::LostMotionModel;
using design::Design, design::Direction, design::Evaluation;
using efficiency::LossModel;
using report::arcmin, report::mm, report::or_nan, report::percent, report::um;

constexpr double kHalfPercent = 0.005;

class Ledger {
 public:
  explicit Ledger(const PublishedSources& s)
      : s_(s),
        proposed_(
            evaluated(with_friction(s.low_backlash.design, kTableFriction, LossModel::kOhlendorf))),
        bilateral_(
            evaluated(with_friction(s.bilateral.design, kTableFriction, LossModel::kOhlendorf))) {}

  std::vector<LedgerEntry> entries() {
    add_misprinted_efficiency();
    add_ratio();
    add_planet_shift();
    add_common_distance();
    add_assembly();
    add_two_distances();
    add_ring_factor();
    add_added_angles();
    add_rolling_speeds();
    add_friction();
    add_optimum();
    add_tangent_length();
    add_starting_torque();
    return std::move(entries_);
  }

 private:
  void add(LedgerEntry entry) {
    entry.number = static_cast<int>(entries_.size()) + 1;
    entries_.push_back(std::move(entry));
  }

  static double zero_distance_mm(const Evaluation& e, std::size_t mesh) {
    auto distance = e.meshes[mesh].zero_backlash_center_distance_m;
    if (distance) distance = mm(*distance);
    return or_nan(distance);
  }

  void add_misprinted_efficiency() {
    const auto& m = proposed_.meshes;
    const double eta1 = m[0].efficiency_forward;
    const double eta2 = m[1].efficiency_forward;
    const double eta3 = m[2].efficiency_forward;
    const double g1 = proposed_.g1;
    const double g2 = proposed_.g2;
    const double printed =
        (1.0 + eta1 * eta2 * g1) * (1.0 - g2) / ((1.0 - eta2 * eta3 * g1) * (1.0 + g1));
    add({.where = "eq. 18",
         .paper = "denominator 1 - eta_P1R1 eta_P2R2 G1",
         .finding = "the torque balance gives G2 in its place; as printed eta_f is negative",
         .figures = {{.name = "eta_f as printed", .unit = "", .value = printed, .decimals = 4},
                     {.name = "eta_f with G2",
                      .unit = "",
                      .value = or_nan(proposed_.efficiency.forward),
                      .decimals = 4}}});
  }

  void add_ratio() {
    const double stated = or_nan(value_of(s_.low_backlash.stated_ratio));
    add({.where = "Table III: gear ratio",
         .paper = fmt::format("{:g}:1 for both gears", stated),
         .finding =
             "to the printed digit the teeth of Table II give it for the bilateral drive gear "
             "alone",
         .figures = {{.name = "low-backlash prototype", .unit = "", .value = proposed_.ratio},
                     {.name = "low-backlash prototype off by",
                      .unit = "%",
                      .value = 100.0 * (proposed_.ratio / stated - 1.0),
                      .decimals = 2},
                     {.name = "bilateral drive gear", .unit = "", .value = bilateral_.ratio},
                     {.name = "bilateral drive gear off by",
                      .unit = "%",
                      .value = 100.0 * (bilateral_.ratio / stated - 1.0),
                      .decimals = 2}}});
  }

  void add_planet_shift() {
    const double printed_shift = s_.statements.bilateral_xP2_printed;
    Design printed = s_.bilateral.design;
    printed.train.profile_shift[train::kP2] = printed_shift;
    const Evaluation p = evaluated(printed);
    add({.where = "Table II, x_P2 of the bilateral drive gear",
         .paper = fmt::format("{:g}", printed_shift),
         .finding = fmt::format("{:g} closes the three centre distances",
                                s_.bilateral.design.train.profile_shift[train::kP2]),
         .figures = {{"S-P1", "mm", zero_distance_mm(bilateral_, 0), 4},
                     {"P1-R1", "mm", zero_distance_mm(bilateral_, 1), 4},
                     {"P2-R2 as printed", "mm", zero_distance_mm(p, 2), 4},
                     {"P2-R2 mended", "mm", zero_distance_mm(bilateral_, 2), 4}}});
  }

  /// Interference at the common distance that has least of it (q = 0).
  void add_common_distance() {
    const Design& design = s_.low_backlash.design;
    const auto meshes_at = [&](double d) { return evaluated(at_distance(design, d)).meshes; };
    const auto d = root_of_increasing(
        [&](double distance) {
          const auto m = meshes_at(distance);
          return m[0].normal_backlash_m - std::min(m[1].normal_backlash_m, m[2].normal_backlash_m);
        },
        0.99 * proposed_.center_distance_m, 1.01 * proposed_.center_distance_m);
    std::optional<double> interference;
    if (d) interference = -um(meshes_at(*d)[0].normal_backlash_m);
    const double measured = or_nan(s_.low_backlash.measured_lost_motion_rad);
    const double stated = or_nan(value_of(s_.low_backlash.stated_lost_motion_rad));
    const double bracket = or_nan(s_.low_backlash.lost_motion_bracket_rad);
    const double accuracy = or_nan(value_of(s_.low_backlash.stated_lost_motion_accuracy));
    const double bilateral = or_nan(s_.bilateral.measured_lost_motion_rad);
    const double bilateral_accuracy = or_nan(value_of(s_.bilateral.stated_lost_motion_accuracy));
    add({.where = "Secs. II, IV, V.A, VI; Table III: backlash of the proposed gear",
         .paper =
             fmt::format("approximately {:g} arcmin by the model, {:g} ({:g}) measured, accuracy "
                         "{:g} %, of the bilateral drive gear's {:g} arcmin {:g} %; neither q, d "
                         "nor the effective radii of eq. 16",
                         arcmin(stated), arcmin(measured), arcmin(bracket), percent(accuracy),
                         arcmin(bilateral), percent(bilateral_accuracy)),
         .finding =
             "one carrier has one distance: with q = 0 some mesh interferes; the accuracies "
             "cannot be re-derived. The prototype's is finer than the number in brackets, of "
             "which the paper does not say what it is, and the model's own stated value is "
             "outside of these",
         .figures = {
             {"zero-backlash S-P1", "mm", zero_distance_mm(proposed_, 0), 4},
             {"P1-R1", "mm", zero_distance_mm(proposed_, 1), 4},
             {"P2-R2", "mm", zero_distance_mm(proposed_, 2), 4},
             {"best common distance", "mm", mm(or_nan(d)), 3},
             {"interference there", "um", or_nan(interference), 1},
             {"interference at mesh 2's own", "um", -um(proposed_.meshes[0].normal_backlash_m), 1},
             {"measured lost motion at R2's pitch radius", "um",
              um(measured * 0.5 * proposed_.gears[train::kR2].pitch_diameter_m), 1},
             {"measured below stated", "%", 100.0 * (1.0 - measured / stated), 1},
             {"measured below stated, over the brackets", "", (stated - measured) / bracket, 1},
             {"brackets over measured", "%", percent(bracket / measured), 1},
             {"what the accuracy leaves", "arcmin", arcmin((1.0 - accuracy) * measured), 2},
             {"what the bilateral drive gear's leaves", "arcmin",
              arcmin((1.0 - bilateral_accuracy) * bilateral), 2}}});
  }

  void add_assembly() {
    std::vector<Figure> figures;
    const auto append = [&](const Evaluation& e) {
      const auto& z = e.teeth;
      const long long difference = std::abs(1LL * z.R2 * z.P1 - 1LL * z.R1 * z.P2);
      const auto whole = [](long long value) { return static_cast<double>(value); };
      figures.push_back({e.name + ": zS + zR1", "", whole(z.S + z.R1), 0});
      figures.push_back({e.name + ": |zR2 zP1 - zR1 zP2|", "", whole(difference), 0});
      figures.push_back(
          {e.name + ": N gcd(zP1, zP2)", "", whole(1LL * e.planets * std::gcd(z.P1, z.P2)), 0});
    };
    append(proposed_);
    append(bilateral_);
    const auto verdict = [](const Evaluation& e) {
      return fmt::format("{}: {} identical planets {}", e.name, e.planets,
                         e.assembly.identical_planets ? "fit" : "do not fit");
    };
    add({.where = "eqs. 32, 33; Sec. IV: planets",
         .paper = fmt::format("{} planets; the best solution \"satisfying the assembly condition\"",
                              proposed_.planets),
         .finding = verdict(proposed_) + "; " + verdict(bilateral_),
         .figures = std::move(figures)});
  }

  void add_two_distances() {
    const double d1 = zero_distance_mm(proposed_, 0);
    const Evaluation at_d1 = evaluated(at_distance(s_.low_backlash.design, d1 * 1e-3));
    add({.where = "eqs. 14, 15; Table I",
         .paper = "d1 for mesh 1, d2 for meshes 2 and 3",
         .finding = "one carrier has one centre distance",
         .figures = {
             {"d1 - d2 of full teeth", "um", 1e3 * (d1 - zero_distance_mm(proposed_, 1)), 1},
             {"interference of P1-R1 at d1", "um", -um(at_d1.meshes[1].normal_backlash_m), 1}}});
  }

  /// The factor with which eq. 10 agrees with eqs. 11 and 12.
  void add_ring_factor() {
    const auto& t = s_.low_backlash.design.train;
    const double alpha = t.pressure_angle_rad;
    const double z = t.teeth.R1;
    const double x = t.profile_shift[train::kR1];
    const double alpha_s3 =
        -alpha + std::numbers::pi / (2.0 * z) + (1.0 + 2.0 * x / z) * std::tan(alpha);
    const double factor = (0.5 * z * std::cos(alpha) * (alpha + alpha_s3) -
                           0.25 * std::numbers::pi * std::cos(alpha) - x * std::sin(alpha)) /
                          (z * std::sin(alpha));
    add({.where = "eq. 10",
         .paper = fmt::format("factor {:g} before m z sin(alpha)", s_.statements.eq10_factor),
         .finding = "eq. 12 follows from eqs. 10-11 with another factor",
         .figures = {{"factor from eq. 12 (R1)", "", factor, 3}}});
  }

  void add_added_angles() {
    const Design fixed = at_distance(s_.low_backlash.design, proposed_.center_distance_m);
    const auto q = explaining_allowance(fixed, or_nan(s_.low_backlash.measured_lost_motion_rad),
                                        LostMotionModel::kPaper);
    const Evaluation e = evaluated(with_allowance(fixed, q.value_or(0.0)));
    const auto& share = e.lost_motion.kinematic_share_rad;
    add({.where = "eq. 17",
         .paper = "phi_1 + max(phi_2, phi_3)",
         .finding =
             "rigid bodies with the sun locked add the shares of all three meshes. The effective "
             "radii of eq. 16, which are not defined, are here |i| r_S, r_R1 and r_R2",
         .figures = {{"q of the example", "module", or_nan(q), 4},
                     {"eq. 17", "arcmin", arcmin(e.lost_motion.paper_rad), 2},
                     {"kinematic", "arcmin", arcmin(e.lost_motion.kinematic_rad), 2},
                     {"of it S-P1", "arcmin", arcmin(share[0]), 2},
                     {"P1-R1", "arcmin", arcmin(share[1]), 2},
                     {"P2-R2", "arcmin", arcmin(share[2]), 2}}});
  }

  void add_rolling_speeds() {
    const train::SpeedRatios w = train::speed_ratios(proposed_.teeth);
    const auto& m = proposed_.meshes;
    add({.where = "eqs. 30-33",
         .paper = "i_T as a ratio of rolling speeds; planets by their rolling speed",
         .finding = "eq. 31 is a ratio of absolute speeds; kinetic energy needs the planets' "
                    "absolute spin; w'_C is zero by definition",
         .figures = {{"w'_S/w'_R2 rolling", "", w.sun_rolling, 2},
                     {"w_S/w_R2 absolute", "", w.sun, 3},
                     {"J_P factor by eq. 32", "", w.planet_rolling * w.planet_rolling, 2},
                     {"J_P factor by energy", "", w.planet * w.planet, 1},
                     {"J_S factor by eq. 32", "",
                      w.sun * w.sun / (m[0].efficiency_backward * m[1].efficiency_backward), 0},
                     {"J_S factor i^2/eta_b", "",
                      w.sun * w.sun / or_nan(proposed_.efficiency.backward), 0}}});
  }

  void add_friction() {
    std::vector<Figure> figures;
    for (const PublishedGearbox* g : {&s_.low_backlash, &s_.bilateral}) {
      const FrictionFit fit = friction_fit(*g, LossModel::kOhlendorf);
      const std::string of = g->design.name + ": ";
      figures.push_back({of + "mu from forward", "", or_nan(fit.mu), 3});
      figures.push_back({of + "backward predicted", "%", 100.0 * or_nan(fit.backward), 1});
      figures.push_back({of + "backward measured", "%", 100.0 * fit.measured_backward, 1});
      figures.push_back({of + "mu from backward", "", or_nan(fit.backward_mu), 3});
    }
    for (const design::MeshResult& m : proposed_.meshes) {
      if (m.loss_model_in_range) continue;
      figures.push_back({m.name + " approach", "", m.approach_contact_ratio, 2});
    }
    // The simulated efficiency is printed to a whole per cent.
    const Design& design = s_.low_backlash.design;
    const auto simulated_friction = [&](double eta) {
      return or_nan(fitted_friction(design, LossModel::kOhlendorf, Direction::kBackward, eta));
    };
    const double simulated = or_nan(value_of(s_.low_backlash.stated_backward));
    const double mu = simulated_friction(simulated);
    figures.push_back({"mu of the simulated set", "", mu, 3});
    figures.push_back({"at least", "", simulated_friction(simulated + kHalfPercent), 3});
    figures.push_back({"at most", "", simulated_friction(simulated - kHalfPercent), 3});
    figures.push_back(
        {"forward with it", "%",
         percent(efficiency_at(design, mu, LossModel::kOhlendorf, Direction::kForward)), 1});
    add({.where = "Secs. IV, V.C, Table III: efficiency",
         .paper = fmt::format("no friction coefficient is published; the simulation of the set of "
                              "Table II gave {:g} % backward",
                              percent(simulated)),
         .finding =
             "one friction value does not explain both directions: that of the simulation, by "
             "eq. 19, lies between both fits and misses either measurement. The loss formula "
             "is outside its range (0 to 1) on the proposed gear",
         .figures = std::move(figures)});
  }

  void add_optimum() {
    const optimize::RefinedSet set =
        optimize::refine(s_.task, {.teeth = proposed_.teeth, .planets = proposed_.planets});
    std::optional<double> reached;
    if (optimize::has_design(set.status)) reached = set.eta_b;
    const double stated_arcmin = arcmin(or_nan(value_of(s_.low_backlash.stated_lost_motion_rad)));
    const double after_arcmin = arcmin(s_.statements.lost_motion_after_rad);
    const double stated = or_nan(value_of(s_.low_backlash.stated_backward));
    const double after = s_.statements.efficiency_after;
    add({.where = "Sec. IV, Fig. 8a, Table II",
         .paper =
             fmt::format("\"optimal parameter set\" of Table II: approximately {:g} arcmin and "
                         "{:g} % backward; with x_R1 and x_R2 varied {:g} arcmin and about "
                         "{:g} %",
                         stated_arcmin, percent(stated), after_arcmin, percent(after)),
         .finding = fmt::format(
             "its own Fig. 8a is better in both, unless phi_L of eq. 37, which is not stated, "
             "forbids "
             "{:g} arcmin. And its own tooth counts reach more than the published set under its "
             "own "
             "objective (task rp96: x in [{:g}, {:g}], at most {:.3g} arcmin by eq. 17), both as "
             "evaluated here at mu = {:g}",
             after_arcmin, s_.task.profile_shift.min, s_.task.profile_shift.max,
             arcmin(s_.task.limits[design::CheckId::kOutputBacklashMax].value_or(0.0)),
             s_.task.friction.coefficient),
         .figures = {{"Fig. 8a below the set", "arcmin", stated_arcmin - after_arcmin, 0},
                     {"above it", "points", percent(after - stated), 0},
                     {"eta_b published", "%", 100.0 * or_nan(proposed_.efficiency.backward), 1},
                     {"eta_b reached", "%", 100.0 * or_nan(reached), 1}}});
  }

  /// Backlash of mesh 1 by eqs. 1-6, with eq. 2's first angle as printed and as it must be.
  void add_tangent_length() {
    const auto& t = s_.low_backlash.design.train;
    const double alpha = t.pressure_angle_rad;
    const double m = t.module_m[0];
    const double alpha_w = proposed_.meshes[0].working_pressure_angle_rad;
    const auto start_angle = [&](int z, double x) {  // eqs. 5, 6 at q = 0
      return alpha + std::numbers::pi / (2.0 * z) - (1.0 + 2.0 * x / z) * std::tan(alpha);
    };
    const int z_s = t.teeth.S;
    const int z_p = t.teeth.P1;
    const auto backlash_um = [&](double first_angle) {
      const double bp1 =
          0.5 * m * z_s * std::cos(alpha) *
          (first_angle + std::numbers::pi / z_s - start_angle(z_s, t.profile_shift[train::kS]));
      const double p2p3 = 0.5 * m * z_p * std::cos(alpha) *
                          (alpha_w - start_angle(z_p, t.profile_shift[train::kP1]));
      return um(2.0 * (proposed_.center_distance_m * std::sin(alpha_w) - bp1 - p2p3));
    };
    add({.where = "eq. 2",
         .paper = "alpha + gamma_1 - alpha_s1",
         .finding = "needs alpha_w1 at its first place to lead to eq. 13",
         .figures = {{"j of S-P1 by eqs. 1-6 as printed", "um", backlash_um(alpha), 2},
                     {"with alpha_w1", "um", backlash_um(alpha_w), 2},
                     {"by eq. 13", "um", um(proposed_.meshes[0].normal_backlash_m), 2}}});
  }

  void add_starting_torque() {
    const double start = s_.backdrive_starting_torque_Nm;
    const double strain_wave = s_.strain_wave_starting_torque_Nm;
    add({.where = "Secs. V.B, VI; Table III: back-drive starting torque",
         .paper = fmt::format("{:g} Nm, about 1/{:g} of a strain wave gear's", start,
                              s_.statements.starting_torque_ratio),
         .finding = "read where the output first moves, possibly still inside the lost motion: not "
                    "a friction datum",
         .figures = {{"share of the largest back-driving torque", "%",
                      100.0 * start / s_.max_backdriving_torque_Nm, 1},
                     {"strain wave over starting torque", "", strain_wave / start, 0},
                     {"strain wave over largest torque", "",
                      strain_wave / s_.max_backdriving_torque_Nm, 0}}});
  }

  const PublishedSources& s_;
  Evaluation proposed_, bilateral_;
  std::vector<LedgerEntry> entries_;
};

}  // namespace

std::vector<LedgerEntry> paper_ledger(const PublishedSources& sources) {
  return Ledger(sources).entries();
}

}  // namespace gear3k::papers
