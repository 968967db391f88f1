#include "papers/paper_figures_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/display.hpp"
#include "report/text_table.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::papers {

namespace {

using optimize::RefinedSet, optimize::Status;
using report::arcmin, report::clean, report::csv_line, report::exact, report::fixed, report::mm,
    report::percent, report::teeth_fields, report::teeth_text;

/// Range of what a function gives for some items, with fixed decimals.
template <class Items, class Function>
std::string range_text(const Items& items, Function value, int decimals) {
  if (items.empty()) return "none";
  double least = value(items.front());
  double greatest = least;
  for (const auto& item : items) {
    least = std::min(least, value(item));
    greatest = std::max(greatest, value(item));
  }
  return fmt::format("{} to {}", fixed(least, decimals), fixed(greatest, decimals));
}

std::string friction_text(const optimize::Specification& task) {
  return fmt::format("mu = {:g}, mesh loss \"{}\"", task.friction.coefficient,
                     efficiency::kLossModelNames[static_cast<std::size_t>(task.friction.model)]);
}
std::string allowance_text(const optimize::Specification& task) {
  return fmt::format("machining allowance {:g} modules on every gear",
                     task.machining_allowance.front());
}

std::string notes_text(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += "# " + note + '\n';
  return text;
}

void append(std::vector<std::string>& fields, const std::vector<std::string>& more) {
  fields.insert(fields.end(), more.begin(), more.end());
}
template <std::size_t n>
void append_numbers(std::vector<std::string>& fields, const std::array<double, n>& values) {
  for (const double value : values) fields.push_back(exact(value));
}

std::string scatter_csv(const PaperFigures& f) {
  const auto& points = f.scatter.points;
  std::string text = notes_text(
      {"Low-backlash paper, Fig. 6: gear ratio against backlash, with backward efficiency, at zero",
       "profile shift; from gear3k's own models.",
       fmt::format(
           "As in the paper: every tooth combination, module for about {} mm outer diameter.",
           fixed(mm(f.statements.figure_outer_diameter_m), 0)),
       "The paper leaves open (see examples/paper-figures.toml):",
       fmt::format("- the ranges of ratio (here {:g} within {:g} %) and of tooth numbers",
                   f.task.ratio.target, percent(kScatterTolerance)),
       fmt::format("- friction (here {}) and {}", friction_text(f.task), allowance_text(f.task)),
       "- centre distance and m2 (here those that close P1-R1 and P2-R2 but for the allowance)",
       "backlash_arcmin is eq. 17.  The outer diameter sets the scale alone: around the larger",
       fmt::format("ring's root circle comes the published prototype's rim of {} mm.",
                   fixed(mm(f.rim_m), 2)),
       fmt::format("{} tooth sets within the ratio, {} with equally spaced planets; {} of these",
                   f.scatter.within_ratio, f.scatter.assembled, points.size()),
       "mesh (no interference, contact ratios 1 or more) and are listed."});
  text +=
      "zS,zP1,zR1,zP2,zR2,ratio,eta_b,eta_f,backlash_arcmin,eps1,eps2,eps3,m1_mm,m2_mm,"
      "center_distance_mm\n";
  for (const ZeroShiftPoint& p : points) {
    std::vector<std::string> fields = teeth_fields(p.candidate.teeth);
    append(fields,
           {exact(p.ratio), exact(p.eta_b), exact(p.eta_f), exact(arcmin(p.lost_motion_rad))});
    append_numbers(fields, p.contact_ratio);
    append(fields,
           {exact(mm(p.module_m[0])), exact(mm(p.module_m[1])), exact(mm(p.center_distance_m))});
    text += csv_line(fields);
  }
  return text;
}

/// A refined set's row from its status on.
std::vector<std::string> refined_fields(const PaperFigures& f, const RefinedPoint& set,
                                        std::size_t limit) {
  const RefinedSet& refined = set.refined[limit];
  std::vector<std::string> fields{
      std::string(optimize::kStatusNames[static_cast<std::size_t>(refined.status)]),
      std::string(optimize::reason_of(refined))};
  constexpr std::size_t kNumbers = 15;
  if (!optimize::has_design(refined.status)) {
    fields.resize(fields.size() + kNumbers);
    return fields;
  }
  const double scale =
      (f.statements.figure_outer_diameter_m - 2.0 * f.rim_m) / refined.ring_root_diameter_m;
  append(fields,
         {exact(refined.eta_b), exact(refined.eta_f), exact(arcmin(refined.lost_motion_rad)),
          exact(arcmin(set.refined_kinematic_rad[limit]))});
  append_numbers(fields, refined.contact_ratio);
  append_numbers(fields, refined.train.profile_shift);
  append(fields, {exact(mm(scale * refined.train.module_m[0])),
                  exact(mm(scale * refined.train.module_m[1])),
                  exact(mm(scale * refined.train.center_distance_m))});
  return fields;
}

std::string refined_csv(const PaperFigures& f) {
  std::string limits;
  for (const double limit : kRefinementLimits_arcmin) {
    limits += fmt::format("{}{:g}", limits.empty() ? "" : ", ", limit);
  }
  std::string text = notes_text(
      {"Low-backlash paper, Fig. 7: backward efficiency against backlash;",
       "from gear3k's own models.",
       fmt::format(
           "The tooth sets of Fig. 6 within {:g} % of {:g}:1, each at zero profile shift and",
           percent(f.task.ratio.tolerance), f.task.ratio.target),
       "refined (SLSQP, largest eta_b, eqs. 34-37) over five profile shifts, m2 and the centre",
       "distance, under limit_arcmin on eq. 17 (backlash_arcmin).",
       "The paper leaves open (see examples/paper-figures.toml), beside what Fig. 6 leaves open:",
       fmt::format("- phi_U (here {} arcmin), phi_L (none), x_U (here {:g})", limits,
                   f.task.profile_shift.max),
       "Added to eqs. 35-37: no interference, no undercut, tip thickness, planet gap.",
       "status of a zero-shift row: ok, or fails where it misses checks that the refinement has to",
       "meet (reason), the limit on the lost motion apart.",
       fmt::format("Modules and distance are scaled to about {} mm outer diameter as in Fig. 6.",
                   fixed(mm(f.statements.figure_outer_diameter_m), 0))});
  text +=
      "zS,zP1,zR1,zP2,zR2,ratio,state,limit_arcmin,status,reason,eta_b,eta_f,backlash_arcmin,"
      "kinematic_arcmin,eps1,eps2,eps3,xS,xP1,xR1,xP2,xR2,m1_mm,m2_mm,center_distance_mm\n";
  for (const RefinedPoint& set : f.refined) {
    const ZeroShiftPoint& p = f.scatter.points[set.scatter_index];
    std::vector<std::string> fields = teeth_fields(p.candidate.teeth);
    fields.push_back(exact(p.ratio));
    std::vector<std::string> zero = fields;
    const auto& fails = set.zero_shift_fails;
    append(zero, {"zero_shift", "", fails.empty() ? "ok" : "fails",
                  fmt::format("{}", fmt::join(fails, " ")), exact(p.eta_b), exact(p.eta_f),
                  exact(arcmin(p.lost_motion_rad)), exact(arcmin(set.zero_shift_kinematic_rad))});
    append_numbers(zero, p.contact_ratio);
    append_numbers(zero, std::array<double, train::kGearCount>{});
    append(zero,
           {exact(mm(p.module_m[0])), exact(mm(p.module_m[1])), exact(mm(p.center_distance_m))});
    text += csv_line(zero);
    for (std::size_t i = 0; i < kLimits; ++i) {
      std::vector<std::string> row = fields;
      append(row, {"refined", exact(kRefinementLimits_arcmin[i])});
      append(row, refined_fields(f, set, i));
      text += csv_line(row);
    }
  }
  return text;
}

std::string column(const VariedInput& input) {
  return input.unit == units::Unit::kMillimetre ? input.name + "_mm" : input.name;
}
std::string axis_value(const VariedInput& input, double value) {
  return exact(clean(units::from_si(value, input.unit)));
}

std::string map_csv(const PaperFigures& f, const FigureMap& map, const std::string& letter) {
  const std::string varied = map.y ? map.x.name + " and " + map.y->name : map.x.name;
  const auto& t = f.published.train;
  std::string text = notes_text(
      {fmt::format("Low-backlash paper, Fig. 8 ({}): backward efficiency over {};", letter, varied),
       "from gear3k's own models.",
       fmt::format(
           "Held at the published values (Table II): teeth {}, all other shifts and modules,",
           teeth_text(t.teeth)),
       fmt::format(
           "and the centre distance {} mm, where P1-R1 of the published gear has no backlash",
           fixed(mm(f.published_center_distance_m), 4)),
       "without allowance.", "The paper leaves open (see examples/paper-figures.toml):",
       fmt::format("- centre distance, ranges, friction (here {}),", friction_text(f.task)),
       fmt::format("  {}", allowance_text(f.task)),
       "backlash_arcmin is eq. 17, kinematic_arcmin the exact angle of rigid bodies.",
       "status: ok; undefined (a mesh has no working angle or no contact); else the check that",
       "fails first, the limit on the lost motion apart."});
  text += column(map.x);
  if (map.y) text += ',' + column(*map.y);
  text += ",status,eta_b,eta_f,backlash_arcmin,kinematic_arcmin\n";
  for (std::size_t k = 0; k < map.points.size(); ++k) {
    const FigureMapPoint& p = map.points[k];
    std::vector<std::string> fields{axis_value(map.x, map.x.values[k / map.rows()])};
    if (map.y) fields.push_back(axis_value(*map.y, map.y->values[k % map.rows()]));
    fields.push_back(p.status);
    if (p.status == "ok") {
      append(fields, {exact(p.eta_b), exact(p.eta_f), exact(arcmin(p.paper_rad)),
                      exact(arcmin(p.kinematic_rad))});
    } else {
      fields.resize(fields.size() + 4);
    }
    text += csv_line(fields);
  }
  return text;
}

/// The set with the published teeth among Fig. 7's; null where it is not.
const RefinedPoint* published_teeth(const PaperFigures& f) {
  const auto at = std::ranges::find_if(f.refined, [&](const RefinedPoint& set) {
    return f.scatter.points[set.scatter_index].candidate.teeth == f.published.train.teeth;
  });
  return at == f.refined.end() ? nullptr : &*at;
}

std::size_t feasible_count(const PaperFigures& f, std::size_t limit) {
  return static_cast<std::size_t>(std::ranges::count_if(f.refined, [&](const RefinedPoint& set) {
    return optimize::has_design(set.refined[limit].status);
  }));
}

/// Points of a map that are feasible.
std::vector<const FigureMapPoint*> feasible_points(const FigureMap& map) {
  std::vector<const FigureMapPoint*> points;
  for (const FigureMapPoint& p : map.points) {
    if (p.status == "ok") points.push_back(&p);
  }
  return points;
}

FigureStatement ring_shift_statement(const PaperFigures& f) {
  const auto points = feasible_points(f.ring_shifts);
  const auto most_efficient = [&](double lost_motion_rad) {
    double greatest = 0.0;
    for (const FigureMapPoint* p : points) {
      if (p->paper_rad <= lost_motion_rad) greatest = std::max(greatest, p->eta_b);
    }
    return fmt::format("eta_b at most {} up to {} arcmin",
                       greatest > 0.0 ? fixed(percent(greatest), 1) + " %" : "nothing",
                       fixed(arcmin(lost_motion_rad), 0));
  };
  const PaperStatements& s = f.statements;
  return {.figure = "8a",
          .paper = fmt::format(
              "profile shift reduces backlash from around {} to {} arcmin, eta_b about {} % there",
              fixed(arcmin(s.lost_motion_before_rad), 0), fixed(arcmin(s.lost_motion_after_rad), 0),
              fixed(percent(s.efficiency_after), 0)),
          .ours = {fmt::format(
              "lost motion {} arcmin over x_R1, x_R2; {}; {}",
              range_text(
                  points, [](const FigureMapPoint* p) { return arcmin(p->paper_rad); }, 1),
              most_efficient(s.lost_motion_after_rad), most_efficient(s.lost_motion_before_rad))}};
}

FigureStatement module_statement(const PaperFigures& f) {
  const FigureMap& map = f.modules;
  struct At {
    double m1, m2, eta_b;
  };
  std::vector<At> feasible;
  for (std::size_t k = 0; k < map.points.size(); ++k) {
    if (map.points[k].status != "ok") continue;
    feasible.push_back({.m1 = mm(map.x.values[k / map.rows()]),
                        .m2 = mm(map.y->values[k % map.rows()]),
                        .eta_b = map.points[k].eta_b});
  }
  FigureStatement statement{.figure = "8b",
                            .paper = "eta_b peaks within a highly localized range of the modules",
                            .ours = {"no module is feasible"}};
  if (feasible.empty()) return statement;
  const At best = *std::ranges::max_element(feasible, {}, &At::eta_b);
  const auto m1 = [](const At& at) { return at.m1; };
  const auto m2 = [](const At& at) { return at.m2; };
  const auto eta = [](const At& at) { return percent(at.eta_b); };
  statement.ours = {
      fmt::format("of the map m1 {} mm and m2 {} mm are feasible", range_text(feasible, m1, 4),
                  range_text(feasible, m2, 4)),
      fmt::format("eta_b {} % there, greatest at m1 {} mm, m2 {} mm", range_text(feasible, eta, 2),
                  fixed(best.m1, 4), fixed(best.m2, 4))};
  return statement;
}

/// Whether η_b bends downwards at all inner feasible points.
FigureStatement planet_shift_statement(const PaperFigures& f) {
  const FigureMap& map = f.planet_shift;
  std::vector<double> shifts;
  std::vector<double> eta;
  for (std::size_t k = 0; k < map.points.size(); ++k) {
    if (map.points[k].status != "ok") continue;
    shifts.push_back(map.x.values[k]);
    eta.push_back(map.points[k].eta_b);
  }
  FigureStatement statement{
      .figure = "8c", .paper = "the problem is convex in x_P1", .ours = {"no shift is feasible"}};
  if (shifts.empty()) return statement;
  std::size_t down = 0;
  std::size_t up = 0;
  for (std::size_t k = 1; k + 1 < eta.size(); ++k) {
    const double bend = eta[k - 1] - 2.0 * eta[k] + eta[k + 1];
    ++(bend <= 0.0 ? down : up);
  }
  const auto best = static_cast<std::size_t>(std::ranges::max_element(eta) - eta.begin());
  std::optional<std::size_t> best_allowed;  // by eq. 35
  for (std::size_t k = 0; k < eta.size(); ++k) {
    if (shifts[k] < f.task.profile_shift.min) continue;
    if (!best_allowed || eta[k] > eta[*best_allowed]) best_allowed = k;
  }
  statement.ours = {
      fmt::format("x_P1 {} is feasible, eta_b {} %, bent down at {} of {} inner points",
                  range_text(
                      shifts, [](double x) { return x; }, 3),
                  range_text(
                      eta, [](double e) { return percent(e); }, 2),
                  down, down + up),
      fmt::format("greatest at x_P1 = {}{}", fixed(shifts[best], 3),
                  best_allowed
                      ? fmt::format(", within eq. 35 at {}", fixed(shifts[*best_allowed], 3))
                      : "")};
  return statement;
}

}  // namespace

const RefinedSet* best_refined(const PaperFigures& figures, std::size_t limit) {
  const RefinedSet* best = nullptr;
  for (const RefinedPoint& set : figures.refined) {
    const RefinedSet& refined = set.refined[limit];
    if (!optimize::has_design(refined.status)) continue;
    if (best == nullptr || refined.eta_b > best->eta_b) best = &refined;
  }
  return best;
}

namespace {

std::vector<FigureStatement> figure_statements(const PaperFigures& f) {
  const PaperStatements& s = f.statements;
  const auto lost_motion = [](const ZeroShiftPoint& p) { return arcmin(p.lost_motion_rad); };
  const auto eta_b = [](const ZeroShiftPoint& p) { return percent(p.eta_b); };
  FigureStatement scatter{
      .figure = "6",
      .paper = fmt::format("zero shift, about {} mm outer diameter; around {} arcmin",
                           fixed(mm(s.figure_outer_diameter_m), 0),
                           fixed(arcmin(s.lost_motion_before_rad), 0)),
      .ours = {fmt::format(
          "{} tooth sets within {:g} % of {:g}:1: lost motion {} arcmin, eta_b {} %",
          f.scatter.points.size(), percent(kScatterTolerance), f.task.ratio.target,
          range_text(f.scatter.points, lost_motion, 1), range_text(f.scatter.points, eta_b, 1))}};

  std::vector<ZeroShiftPoint> before;
  before.reserve(f.refined.size());
  for (const RefinedPoint& set : f.refined) before.push_back(f.scatter.points[set.scatter_index]);
  FigureStatement refined{
      .figure = "7",
      .paper = "eta_b over backlash before and after refinement; no values",
      .ours = {fmt::format("{} sets within {:g} % at zero shift: lost motion {} arcmin, eta_b {} %",
                           before.size(), percent(f.task.ratio.tolerance),
                           range_text(before, lost_motion, 1), range_text(before, eta_b, 1))}};
  const RefinedPoint* own = published_teeth(f);
  if (own != nullptr) {
    const ZeroShiftPoint& p = f.scatter.points[own->scatter_index];
    refined.ours.push_back(fmt::format("of these the published teeth {}: {} arcmin, {} %",
                                       teeth_text(p.candidate.teeth), fixed(lost_motion(p), 1),
                                       fixed(eta_b(p), 1)));
  }
  for (std::size_t i = 0; i < kLimits; ++i) {
    std::string ours = fmt::format("refined to at most {:g} arcmin: {} sets feasible",
                                   kRefinementLimits_arcmin[i], feasible_count(f, i));
    if (const RefinedSet* best = best_refined(f, i)) {
      ours += fmt::format(", best eta_b {} % ({})", fixed(percent(best->eta_b), 1),
                          teeth_text(best->candidate.teeth));
    }
    if (own != nullptr && optimize::has_design(own->refined[i].status)) {
      ours += fmt::format(", published teeth {} %", fixed(percent(own->refined[i].eta_b), 1));
    }
    refined.ours.push_back(std::move(ours));
  }
  return {std::move(scatter), std::move(refined), ring_shift_statement(f), module_statement(f),
          planet_shift_statement(f)};
}

}  // namespace

std::string figures_text(const std::string& paper, const std::vector<FigureStatement>& statements,
                         const std::string& assumptions) {
  std::string text = fmt::format("\nFigures of the {} from our own models\n", paper);
  if (!assumptions.empty()) text += fmt::format("  {}\n", assumptions);
  for (const FigureStatement& s : statements) {
    text += fmt::format("  Fig. {}\n    paper:   {}\n", s.figure, s.paper);
    for (std::size_t k = 0; k < s.ours.size(); ++k) {
      text += fmt::format("    {:8} {}\n", k == 0 ? "gear3k:" : "", s.ours[k]);
    }
  }
  return text;
}

std::string figures_table(const PaperFigures& figures) {
  return figures_text(
      "low-backlash paper", figure_statements(figures),
      fmt::format("{}; {}", friction_text(figures.task), allowance_text(figures.task)));
}

std::vector<FigureData> figure_data(const PaperFigures& figures) {
  return {{.name = kFigureNames[0], .csv = scatter_csv(figures)},
          {.name = kFigureNames[1], .csv = refined_csv(figures)},
          {.name = kFigureNames[2], .csv = map_csv(figures, figures.ring_shifts, "a")},
          {.name = kFigureNames[3], .csv = map_csv(figures, figures.modules, "b")},
          {.name = kFigureNames[4], .csv = map_csv(figures, figures.planet_shift, "c")}};
}

}  // namespace gear3k::papers
