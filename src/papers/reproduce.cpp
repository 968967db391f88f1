#include "papers/reproduce.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "papers/paper_ledger.hpp"
#include "papers/published_fits.hpp"
#include "report/display.hpp"

namespace gear3k::papers {

namespace {

using backlash::LostMotionModel;
using design::Design, design::Direction, design::Evaluation;
using efficiency::LossModel;
using report::arcmin, report::mm, report::or_nan, report::percent, report::um;

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

std::string source_of(const std::optional<Stated>& stated) {
  return stated ? stated->source : std::string();
}

/// Contact ratios at the common distance, and of a mesh whose own is printed at the distance where
/// it has no backlash.
void append_contact_ratio_rows(const PublishedGearbox& gearbox, const Evaluation& e,
                               std::vector<ComparedRow>& rows) {
  const auto add = [&](const std::string& what, double distance_m, double ratio,
                       const std::optional<Stated>& stated) {
    rows.push_back(
        {.quantity = fmt::format("contact ratio {} at d = {:.4f} mm", what, mm(distance_m)),
         .unit = "",
         .paper = value_of(stated),
         .equations = ratio,
         .exact = {},
         .measured = {},
         .decimals = 3,
         .source = source_of(stated)});
  };
  const double common_m = e.center_distance_m;
  for (std::size_t k = 0; k < e.meshes.size(); ++k) {
    // The original prints S-P1 with shortened tips: a row of its own, below.
    const auto& stated =
        k == train::kMeshSP1 ? std::optional<Stated>() : gearbox.stated_contact_ratio[k];
    const std::string what = e.meshes[k].name + ", full teeth";
    add(what, common_m, e.meshes[k].contact_ratio, stated);
    const auto own_m = e.meshes[k].zero_backlash_center_distance_m;
    constexpr double kShownDistance_m = 0.5e-7;
    if (!stated || !own_m || std::abs(*own_m - common_m) < kShownDistance_m) continue;
    add(what, *own_m, evaluated(at_distance(gearbox.design, *own_m)).meshes[k].contact_ratio,
        stated);
  }
  if (const auto& stated = gearbox.stated_contact_ratio[train::kMeshSP1]) {
    add("S-P1, both tips shortened by the KHK rule", common_m,
        contact_ratio_with_shortened_tips(gearbox.design, e), stated);
  }
}

void append_geometry_rows(const PublishedGearbox& gearbox, const Evaluation& e,
                          std::vector<ComparedRow>& rows) {
  const std::string at = fmt::format(" at d = {:.4f} mm", mm(e.center_distance_m));
  const auto add = [&](ComparedRow row) { rows.push_back(std::move(row)); };
  add({.quantity = "ratio",
       .unit = "",
       .paper = value_of(gearbox.stated_ratio),
       .equations = e.ratio,
       .exact = {},
       .measured = {},
       .decimals = 3,
       .source = source_of(gearbox.stated_ratio)});
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
  append_contact_ratio_rows(gearbox, e, rows);
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

std::optional<double> in_arcmin(std::optional<double> rad) {
  if (rad) rad = arcmin(*rad);
  return rad;
}

/// Lost motion by eq. 17 (equations) and by the exact kinematics, and what is said of it.
void append_lost_motion_rows(const PublishedGearbox& gearbox, const Evaluation& e,
                             std::vector<ComparedRow>& rows) {
  if (gearbox.stated_lost_motion_rad) {
    rows.push_back({.quantity = "lost motion by the paper's model, q, d and radii not stated",
                    .unit = "arcmin",
                    .paper = in_arcmin(value_of(gearbox.stated_lost_motion_rad)),
                    .equations = {},
                    .exact = {},
                    .measured = in_arcmin(gearbox.measured_lost_motion_rad),
                    .decimals = 2,
                    .source = source_of(gearbox.stated_lost_motion_rad)});
  }
  rows.push_back(
      {.quantity = fmt::format("lost motion, q = 0 at d = {:.4f} mm", mm(e.center_distance_m)),
       .unit = "arcmin",
       .paper = {},
       .equations = arcmin(e.lost_motion.paper_rad),
       .exact = arcmin(e.lost_motion.kinematic_rad),
       .measured = in_arcmin(gearbox.measured_lost_motion_rad),
       .decimals = 2});
  if (gearbox.lost_motion_bracket_rad) {
    rows.push_back({.quantity = "lost motion, in brackets after the measured one",
                    .unit = "arcmin",
                    .paper = {},
                    .equations = {},
                    .exact = {},
                    .measured = in_arcmin(gearbox.lost_motion_bracket_rad),
                    .decimals = 2});
  }
  if (gearbox.stated_lost_motion_accuracy) {
    std::optional<double> own;
    if (gearbox.stated_lost_motion_rad && gearbox.measured_lost_motion_rad) {
      own = percent(
          1.0 - std::abs(gearbox.stated_lost_motion_rad->value / *gearbox.measured_lost_motion_rad -
                         1.0));
    }
    rows.push_back({.quantity = "accuracy of the model of the lost motion (its own stated value)",
                    .unit = "%",
                    .paper = percent(gearbox.stated_lost_motion_accuracy->value),
                    .equations = own,
                    .exact = {},
                    .measured = {},
                    .decimals = 1,
                    .source = gearbox.stated_lost_motion_accuracy->source});
  }
}

/// The allowances that explain the measured lost motion at mesh 2's zero-backlash distance.
void append_allowance_rows(const PublishedGearbox& gearbox, const Evaluation& e,
                           std::vector<ComparedRow>& rows) {
  if (!gearbox.measured_lost_motion_rad) return;
  const double measured = *gearbox.measured_lost_motion_rad;
  const Design fixed = at_distance(gearbox.design, e.center_distance_m);
  const auto add = [&](const std::string& quantity, const char* unit, int decimals, auto value) {
    rows.push_back({.quantity = quantity,
                    .unit = unit,
                    .paper = {},
                    .equations = value(LostMotionModel::kPaper),
                    .exact = value(LostMotionModel::kKinematic),
                    .measured = {},
                    .decimals = decimals});
  };
  add(fmt::format("allowance q of every gear that explains {:.3g} arcmin at d = {:.4f} mm",
                  arcmin(measured), mm(e.center_distance_m)),
      "module", 5,
      [&](LostMotionModel model) { return explaining_allowance(fixed, measured, model); });
  if (gearbox.lost_motion_bracket_rad) {
    const double bracket = *gearbox.lost_motion_bracket_rad;
    add(fmt::format("half the range of that q over +-{:g} arcmin", arcmin(bracket)), "module", 5,
        [&](LostMotionModel model) {
          const auto least = explaining_allowance(fixed, measured - bracket, model);
          const auto greatest = explaining_allowance(fixed, measured + bracket, model);
          return least && greatest ? std::optional(0.5 * (*greatest - *least)) : std::nullopt;
        });
  }
  add("least normal backlash of a mesh with that q", "um", 2, [&](LostMotionModel model) {
    std::optional<double> least;
    const auto q = explaining_allowance(fixed, measured, model);
    if (!q) return least;
    for (const auto& m : evaluated(with_allowance(fixed, *q)).meshes) {
      least = std::min(least.value_or(um(m.normal_backlash_m)), um(m.normal_backlash_m));
    }
    return least;
  });
}

void append_efficiency_row(const PublishedGearbox& gearbox, const Evaluation& e,
                           std::vector<ComparedRow>& rows) {
  const auto in_percent = [](std::optional<double> eta) {
    if (eta) eta = percent(*eta);
    return eta;
  };
  rows.push_back(
      {.quantity = fmt::format("backward efficiency (eq. 19), mu = {:g}", kTableFriction),
       .unit = "%",
       .paper = in_percent(value_of(gearbox.stated_backward)),
       .equations = in_percent(e.efficiency.backward),
       .exact = {},
       .measured = in_percent(gearbox.measured_backward),
       .decimals = 1,
       .source = source_of(gearbox.stated_backward)});
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
  append_allowance_rows(gearbox, e, comparison.rows);
  append_efficiency_row(gearbox, e, comparison.rows);
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
    comparison.recess_only_backward = recess_only_backward(gearbox);
  }
  return comparison;
}

}  // namespace

Reproduction reproduce(const PublishedSources& sources) {
  Reproduction r{.gearboxes = {compare(sources.low_backlash), compare(sources.bilateral)},
                 .ledger = paper_ledger(sources),
                 .thesis = compare_thesis(sources.thesis),
                 .directional_bench = directional_bench(sources.thesis, sources.directional_bench),
                 .backdrivability = compare_backdrivability(sources.backdrivability)};
  for (LedgerEntry entry : r.directional_bench.ledger) {
    entry.number = static_cast<int>(r.thesis.ledger.size()) + 1;
    r.thesis.ledger.push_back(std::move(entry));
  }
  return r;
}

}  // namespace gear3k::papers
