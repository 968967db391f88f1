#include "report/reproduce.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "efficiency/train_efficiency.hpp"
#include "geometry/involute.hpp"
#include "optimize/optimizer.hpp"
#include "report/display.hpp"

namespace gear3k::report {

namespace {

using backlash::LostMotionModel;
using design::Design, design::Evaluation;
using efficiency::LossModel;

constexpr double kTableFriction = 0.1;  // where the paper gives no μ, the value of the tables

/// The root of an increasing function by bisection to rounding; empty when [low, high] holds none.
template <class Function>
std::optional<double> root_of_increasing(Function f, double low, double high) {
  if (!(f(low) <= 0.0 && f(high) >= 0.0)) return std::nullopt;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (f(middle) < 0.0 ? low : high) = middle;
  }
}

double or_nan(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
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
std::optional<double> explaining_allowance(const Design& design, double lost_motion_rad,
                                           LostMotionModel model) {
  return root_of_increasing(
      [&](double q) {
        return lost_motion(evaluated(with_allowance(design, q)), model) - lost_motion_rad;
      },
      0.0, 1.0);
}

enum class Direction { kForward, kBackward };

double efficiency_at(const Design& design, double mu, LossModel model, Direction direction) {
  const Evaluation e = evaluated(with_friction(design, mu, model));
  return or_nan(direction == Direction::kForward ? e.efficiency.forward : e.efficiency.backward);
}

/// The friction that gives a measured efficiency (efficiency falls with μ).
std::optional<double> fitted_friction(const Design& design, LossModel model, Direction direction,
                                      double measured) {
  return root_of_increasing(
      [&](double mu) { return measured - efficiency_at(design, mu, model, direction); }, 0.0, 0.5);
}

std::string model_name(LossModel model) {
  return std::string(efficiency::kLossModelNames[static_cast<std::size_t>(model)]);
}

/// Contact ratio of S-P1 with tips at m (z/2 + 1 + y - x of the mate), y = d/m - (zS + zP1)/2: the
/// tip rule of KHK Gear Technical Data for profile-shifted external gears.
double contact_ratio_with_shortened_tips(Design design, const Evaluation& e) {
  const auto& t = design.train;
  const double y = e.center_distance_m / t.module_m[0] - 0.5 * (t.teeth.S + t.teeth.P1);
  const double shortening = t.profile_shift[train::kS] + t.profile_shift[train::kP1] - y;
  design.train.tip_shortening[train::kS] = shortening;
  design.train.tip_shortening[train::kP1] = shortening;
  return evaluated(at_distance(design, e.center_distance_m)).meshes[train::kMeshSP1].contact_ratio;
}

void append_geometry_rows(const PublishedGearbox& gearbox, const Evaluation& e,
                          std::vector<ComparedRow>& rows) {
  const std::string at = fmt::format(" at d = {:.4f} mm", mm(e.center_distance_m));
  const auto add = [&](ComparedRow row) { rows.push_back(std::move(row)); };
  add({.quantity = "ratio",
       .unit = "",
       .paper = gearbox.stated_ratio,
       .equations = e.ratio,
       .exact = {},
       .measured = {},
       .decimals = 3});
  for (const design::MeshResult& m : e.meshes) {
    std::optional<double> distance = m.zero_backlash_center_distance_m;
    if (distance) distance = mm(*distance);
    add({.quantity = "zero-backlash centre distance " + m.name,
         .unit = "mm",
         .paper = {},
         .equations = distance,
         .exact = {},
         .measured = {},
         .decimals = 4});
  }
  for (std::size_t k = 0; k < e.meshes.size(); ++k) {
    std::optional<double> stated;
    // The original prints S-P1 with shortened tips: a row of its own, below.
    if (gearbox.stated_contact_ratio && k != train::kMeshSP1) {
      stated = (*gearbox.stated_contact_ratio)[k];
    }
    add({.quantity = "contact ratio " + e.meshes[k].name + ", full teeth" + at,
         .unit = "",
         .paper = stated,
         .equations = e.meshes[k].contact_ratio,
         .exact = {},
         .measured = {},
         .decimals = 3});
  }
  if (gearbox.stated_contact_ratio) {
    add({.quantity = "contact ratio S-P1, both tips shortened by the KHK rule" + at,
         .unit = "",
         .paper = (*gearbox.stated_contact_ratio)[train::kMeshSP1],
         .equations = contact_ratio_with_shortened_tips(gearbox.design, e),
         .exact = {},
         .measured = {},
         .decimals = 3});
  }
  for (const design::MeshResult& m : e.meshes) {
    add({.quantity = "normal backlash " + m.name + ", q = 0" + at,
         .unit = "um",
         .paper = {},
         .equations = um(m.normal_backlash_m),
         .exact = {},
         .measured = {},
         .decimals = 2});
  }
}

/// Lost motion by eq. 17 (equations) and by the exact kinematics, and the allowances that explain
/// the measured one at mesh 2's zero-backlash distance.
void append_lost_motion_rows(const PublishedGearbox& gearbox, const Evaluation& e,
                             std::vector<ComparedRow>& rows) {
  const std::string at = fmt::format(" at d = {:.4f} mm", mm(e.center_distance_m));
  const auto in_arcmin = [](std::optional<double> rad) {
    if (rad) rad = arcmin(*rad);
    return rad;
  };
  rows.push_back({.quantity = "lost motion, q = 0" + at,
                  .unit = "arcmin",
                  .paper = in_arcmin(gearbox.stated_lost_motion_rad),
                  .equations = arcmin(e.backlash.paper_rad),
                  .exact = arcmin(e.backlash.kinematic_rad),
                  .measured = in_arcmin(gearbox.measured_lost_motion_rad),
                  .decimals = 2});
  if (!gearbox.measured_lost_motion_rad) return;
  const double measured = *gearbox.measured_lost_motion_rad;
  const Design fixed = at_distance(gearbox.design, e.center_distance_m);
  const auto q17 = explaining_allowance(fixed, measured, LostMotionModel::kPaper);
  const auto q = explaining_allowance(fixed, measured, LostMotionModel::kKinematic);
  rows.push_back({.quantity = fmt::format("allowance q of every gear that explains {:.3g} arcmin{}",
                                          arcmin(measured), at),
                  .unit = "module",
                  .paper = {},
                  .equations = q17,
                  .exact = q,
                  .measured = {},
                  .decimals = 5});
  const auto least_backlash = [&](const std::optional<double>& allowance) {
    std::optional<double> least;
    if (!allowance) return least;
    for (const auto& m : evaluated(with_allowance(fixed, *allowance)).meshes) {
      least = std::min(least.value_or(m.normal_backlash_m), m.normal_backlash_m);
    }
    return std::optional<double>(um(*least));
  };
  rows.push_back({.quantity = "least normal backlash of a mesh with that q",
                  .unit = "um",
                  .paper = {},
                  .equations = least_backlash(q17),
                  .exact = least_backlash(q),
                  .measured = {},
                  .decimals = 2});
}

/// The factors with which J_S and J_P (one planet, both steps) appear in the output's inertia.
void append_inertia_rows(const Evaluation& e, std::vector<ComparedRow>& rows) {
  const train::SpeedRatios w = train::speed_ratios(e.teeth);
  const double rolling2 = w.planet_rolling * w.planet_rolling;
  const double spin2 = w.planet * w.planet;
  rows.push_back(
      {.quantity = fmt::format("J_S factor, mu = {:g} (eq. 32 | i^2/eta_b)", kTableFriction),
       .unit = "",
       .paper = {},
       .equations =
           w.sun * w.sun / (e.meshes[0].efficiency_backward * e.meshes[1].efficiency_backward),
       .exact = w.sun * w.sun / or_nan(e.efficiency.backward),
       .measured = {},
       .decimals = 1});
  rows.push_back({.quantity = "J_S factor, lossless",
                  .unit = "",
                  .paper = {},
                  .equations = w.sun * w.sun,
                  .exact = w.sun * w.sun,
                  .measured = {},
                  .decimals = 1});
  rows.push_back({.quantity = "J_P factor per planet, lossless, eq. 32 read literally",
                  .unit = "",
                  .paper = {},
                  .equations = rolling2,
                  .exact = spin2,
                  .measured = {},
                  .decimals = 2});
  rows.push_back({.quantity = "J_P factor with the carrier's absolute speed (eqs. 32-33)",
                  .unit = "",
                  .paper = {},
                  .equations = rolling2 + w.carrier * w.carrier,
                  .exact = spin2,
                  .measured = {},
                  .decimals = 2});
}

FrictionFit friction_fit(const PublishedGearbox& gearbox, LossModel model) {
  FrictionFit fit{
      .model = model_name(model),
      .measured_forward = *gearbox.measured_forward,
      .measured_backward = *gearbox.measured_backward,
      .mu = fitted_friction(gearbox.design, model, Direction::kForward, *gearbox.measured_forward),
      .backward_mu =
          fitted_friction(gearbox.design, model, Direction::kBackward, *gearbox.measured_backward),
      .backward = {}};
  if (fit.mu) fit.backward = efficiency_at(gearbox.design, *fit.mu, model, Direction::kBackward);
  return fit;
}

/// Loss model `directional` with friction (1 + a) mu in approach and (1 - a) mu in recess; a = -1,
/// 1: all of it on one side of the pitch point.
class AsymmetricFriction {
 public:
  explicit AsymmetricFriction(const PublishedGearbox& gearbox) : gearbox_(gearbox) {}

  /// mu with which it gives the measured forward efficiency.
  [[nodiscard]] std::optional<double> forward_mu(double a) const {
    return root_of_increasing(
        [&](double mu) { return *gearbox_.measured_forward - or_nan(efficiency(mu, a).forward); },
        0.0, 0.5);
  }
  /// Backward efficiency with that mu.
  [[nodiscard]] std::optional<double> backward(double a) const {
    const auto mu = forward_mu(a);
    return mu ? efficiency(*mu, a).backward : std::nullopt;
  }

 private:
  [[nodiscard]] design::EfficiencyResult efficiency(double mu, double a) const {
    Design design = with_friction(gearbox_.design, mu, LossModel::kDirectional);
    design.friction.approach_factor = 1.0 + a;
    design.friction.recess_factor = 1.0 - a;
    return evaluated(design).efficiency;
  }
  const PublishedGearbox& gearbox_;
};

/// Friction in approach and in recess that explains the measured efficiencies in both directions.
std::optional<DirectionalFit> directional_fit(const PublishedGearbox& gearbox) {
  const AsymmetricFriction friction(gearbox);
  const auto excess = [&](double a) {
    return or_nan(friction.backward(a)) - *gearbox.measured_backward;
  };
  std::optional<double> a = root_of_increasing(excess, -1.0, 1.0);
  if (!a) a = root_of_increasing([&](double x) { return -excess(x); }, -1.0, 1.0);
  if (!a) return std::nullopt;
  return DirectionalFit{
      .mu = *friction.forward_mu(*a), .approach_factor = 1.0 + *a, .recess_factor = 1.0 - *a};
}

GearboxComparison compare(const PublishedGearbox& gearbox) {
  const Evaluation e =
      evaluated(with_friction(gearbox.design, kTableFriction, LossModel::kOhlendorf));
  GearboxComparison comparison{.name = e.name,
                               .rows = {},
                               .efficiency = {},
                               .fits = {},
                               .directional = {},
                               .recess_only_backward = {}};
  append_geometry_rows(gearbox, e, comparison.rows);
  append_lost_motion_rows(gearbox, e, comparison.rows);
  append_inertia_rows(e, comparison.rows);
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
    for (const LossModel model :
         {LossModel::kOhlendorf, LossModel::kSliding, LossModel::kCoulombPath}) {
      comparison.fits.push_back(friction_fit(gearbox, model));
    }
    comparison.directional = directional_fit(gearbox);
    comparison.recess_only_backward = AsymmetricFriction(gearbox).backward(-1.0);
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
    const double stated = or_nan(s_.low_backlash.stated_ratio);
    add({.where = "Table II, ratio",
         .paper = fmt::format("{:g}:1 for both gears", stated),
         .finding = "the printed teeth give other ratios",
         .figures = {{.name = "low-backlash prototype", .unit = "", .value = proposed_.ratio},
                     {.name = "off by",
                      .unit = "%",
                      .value = 100.0 * (proposed_.ratio / stated - 1.0),
                      .decimals = 2},
                     {.name = "bilateral drive gear", .unit = "", .value = bilateral_.ratio},
                     {.name = "off by",
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
    const double stated = or_nan(s_.low_backlash.stated_lost_motion_rad);
    add({.where = "Sec. II, IV, VI: backlash of the proposed gear",
         .paper =
             fmt::format("approximately {:g} arcmin by the model, {:g} measured, accuracy "
                         "{:g} %; neither q, d nor the effective radii of eq. 16",
                         arcmin(stated), arcmin(measured), s_.statements.backlash_accuracy_percent),
         .finding = "one carrier has one distance: with q = 0 some mesh interferes; the accuracy "
                    "cannot be re-derived",
         .figures = {
             {"zero-backlash S-P1", "mm", zero_distance_mm(proposed_, 0), 4},
             {"P1-R1", "mm", zero_distance_mm(proposed_, 1), 4},
             {"P2-R2", "mm", zero_distance_mm(proposed_, 2), 4},
             {"best common distance", "mm", mm(or_nan(d)), 3},
             {"interference there", "um", or_nan(interference), 1},
             {"interference at mesh 2's own", "um", -um(proposed_.meshes[0].normal_backlash_m), 1},
             {"measured lost motion at R2's pitch radius", "um",
              um(measured * 0.5 * proposed_.gears[train::kR2].pitch_diameter_m), 1},
             {"measured below stated", "%", 100.0 * (1.0 - measured / stated), 1}}});
  }

  void add_assembly() {
    std::vector<Figure> figures;
    const auto append = [&](const Evaluation& e) {
      const auto& z = e.teeth;
      const long long difference = std::abs(1LL * z.R2 * z.P1 - 1LL * z.R1 * z.P2);
      const auto whole = [](long long value) { return static_cast<double>(value); };
      figures.push_back({e.name + ": zS + zR1", "", whole(z.S + z.R1), 0});
      figures.push_back({"|zR2 zP1 - zR1 zP2|", "", whole(difference), 0});
      figures.push_back({"N gcd(zP1, zP2)", "", whole(1LL * e.planets * std::gcd(z.P1, z.P2)), 0});
    };
    append(proposed_);
    append(bilateral_);
    const auto verdict = [](const Evaluation& e) {
      return fmt::format("{}: {} identical planets {}", e.name, e.planets,
                         e.assembly.identical_planets ? "fit" : "do not fit");
    };
    add({.where = "Table II, Fig. 1: planets",
         .paper = "3 planets",
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
    const auto& share = e.backlash.kinematic_share_rad;
    add({.where = "eq. 17",
         .paper = "phi_1 + max(phi_2, phi_3)",
         .finding = "rigid bodies with the sun locked add the shares of all three meshes",
         .figures = {{"q of the example", "module", or_nan(q), 4},
                     {"eq. 17", "arcmin", arcmin(e.backlash.paper_rad), 2},
                     {"kinematic", "arcmin", arcmin(e.backlash.kinematic_rad), 2},
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
      figures.push_back({g->design.name + ": mu from forward", "", or_nan(fit.mu), 3});
      figures.push_back({"backward predicted", "%", 100.0 * or_nan(fit.backward), 1});
      figures.push_back({"backward measured", "%", 100.0 * fit.measured_backward, 1});
      figures.push_back({"mu from backward", "", or_nan(fit.backward_mu), 3});
    }
    for (const design::MeshResult& m : proposed_.meshes) {
      if (m.loss_model_in_range) continue;
      figures.push_back({m.name + " approach", "", m.approach_contact_ratio, 2});
    }
    add({.where = "Sec. V: efficiency",
         .paper = "no friction coefficient is published",
         .finding = "one friction value does not explain both directions, and the loss formula is "
                    "outside its range (0 to 1) on the proposed gear",
         .figures = std::move(figures)});
  }

  void add_optimum() {
    const optimize::RefinedSet set =
        optimize::refine(s_.task, {.teeth = proposed_.teeth, .planets = proposed_.planets});
    std::optional<double> reached;
    if (set.status == optimize::Status::kOptimal) reached = set.eta_b;
    add({.where = "Sec. IV, Table II",
         .paper = "\"optimal parameter set\"",
         .finding = fmt::format(
             "its own tooth counts reach more under its own objective (task rp96: x in [{:g}, "
             "{:g}], at most {:.3g} arcmin by eq. 17, mu = {:g})",
             s_.task.profile_shift.min, s_.task.profile_shift.max,
             arcmin(s_.task.limits[design::CheckId::kOutputBacklashMax].value_or(0.0)),
             s_.task.friction.coefficient),
         .figures = {{"eta_b published", "%", 100.0 * or_nan(proposed_.efficiency.backward), 1},
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
    add({.where = "Sec. V.B: back-drive starting torque",
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

Reproduction reproduce(const PublishedSources& sources) {
  return {.gearboxes = {compare(sources.low_backlash), compare(sources.bilateral)},
          .ledger = Ledger(sources).entries(),
          .thesis = compare_thesis(sources.thesis)};
}

}  // namespace gear3k::report
