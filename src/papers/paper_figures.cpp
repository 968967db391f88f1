#include "papers/paper_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "design/evaluation.hpp"
#include "numerics/parallel.hpp"
#include "optimize/zero_shift.hpp"
#include "papers/published_fits.hpp"

namespace gear3k::papers {

namespace {

using design::CheckId, units::Unit;
using optimize::Specification, optimize::ZeroShiftSet;

/// The lost motion is what the figures show, not what they reject.
design::Limits without_lost_motion(design::Limits limits) {
  limits[CheckId::kOutputBacklashMin].reset();
  limits[CheckId::kOutputBacklashMax].reset();
  return limits;
}

double largest_ring_root_diameter(const design::Evaluation& e) {
  return std::max(e.gears[train::kR1].root_diameter_m, e.gears[train::kR2].root_diameter_m);
}

/// Module of stage 1 with which the larger ring's root circle at zero shift has a diameter:
/// d_f = m (z + 2 h_f).
double module_for_root_diameter(const Specification& spec, const ZeroShiftSet& set,
                                double diameter_m) {
  const double dedendum = 2.0 * spec.rack.dedendum;
  const auto& z = set.candidate.teeth;
  return diameter_m / std::max(z.R1 + dedendum, (z.R2 + dedendum) * set.module_ratio);
}

RatioScatter ratio_scatter(const Specification& task, double root_diameter_m) {
  Specification wide = task;
  wide.ratio.tolerance = kScatterTolerance;
  optimize::Progress progress;
  const optimize::ToothSearchResult search = optimize::search_teeth(wide, progress);
  RatioScatter scatter{
      .within_ratio = search.within_ratio, .assembled = search.candidates.size(), .points = {}};
  for (const ZeroShiftSet& set : optimize::rank_at_zero_shift(wide, search.candidates)) {
    if (!set.meshes) break;  // those that mesh come first
    const double m1 = module_for_root_diameter(wide, set, root_diameter_m);
    scatter.points.push_back(
        {.candidate = set.candidate,
         .ratio = set.ratio,
         .eta_b = set.eta_b,
         .eta_f = set.eta_f,
         .lost_motion_rad = set.lost_motion_rad,
         .contact_ratio = set.contact_ratio,
         .module_m = {m1, m1 * set.module_ratio},
         .center_distance_m = 0.5 * m1 * (set.candidate.teeth.R1 - set.candidate.teeth.P1)});
  }
  std::ranges::sort(scatter.points, [](const ZeroShiftPoint& a, const ZeroShiftPoint& b) {
    const auto key = [](const ZeroShiftPoint& p) {
      return std::tuple(p.ratio, p.candidate.planets, train::teeth_of(p.candidate.teeth));
    };
    return key(a) < key(b);
  });
  return scatter;
}

design::Design zero_shift_design(const Specification& task, const ZeroShiftPoint& point) {
  design::Design design;
  design.name = task.name;
  auto& t = design.train;
  t.teeth = point.candidate.teeth;
  t.planets = point.candidate.planets;
  t.pressure_angle_rad = task.pressure_angle_rad;
  t.center_distance_m = point.center_distance_m;
  design.center_distance_given = true;
  t.module_m = point.module_m;
  t.machining_allowance = task.machining_allowance;
  t.tip_shortening = task.tip_shortening;
  t.khk_tip = task.khk_tip;
  t.rack.fill(task.rack);
  t.cutter = task.cutter;
  design.axial = task.axial;
  design.friction = task.friction;
  design.limits = without_lost_motion(task.limits);
  return design;
}

double kinematic_lost_motion(const train::TrainParameters<double>& parameters) {
  const auto train = train::make_train_geometry(parameters);
  if (!train) return 0.0;
  return backlash::output_lost_motion(*train, backlash::normal_backlashes(*train),
                                      backlash::LostMotionModel::kKinematic);
}

std::vector<RefinedPoint> refined_points(const Specification& task, const RatioScatter& scatter) {
  std::vector<RefinedPoint> sets;
  for (std::size_t k = 0; k < scatter.points.size(); ++k) {
    if (!optimize::ratio_matches(scatter.points[k].ratio, task.ratio)) continue;
    sets.push_back({.scatter_index = k,
                    .zero_shift_fails = {},
                    .zero_shift_kinematic_rad = 0.0,
                    .refined = {},
                    .refined_kinematic_rad = {}});
  }
  constexpr std::size_t kLimits = kRefinementLimits_arcmin.size();
  std::array<Specification, kLimits> limited;
  for (std::size_t i = 0; i < kLimits; ++i) {
    limited[i] = task;
    limited[i].limits[CheckId::kOutputBacklashMax] =
        units::to_si(kRefinementLimits_arcmin[i], Unit::kArcmin);
  }
  numerics::parallel_for(sets.size(), [&](std::size_t k) {
    RefinedPoint& set = sets[k];
    const ZeroShiftPoint& point = scatter.points[set.scatter_index];
    const design::Evaluation before = evaluated(zero_shift_design(task, point));
    set.zero_shift_kinematic_rad = before.lost_motion.kinematic_rad;
    for (const design::CheckResult& check : before.checks) {
      const std::string name(check.record->name);
      const bool again = !set.zero_shift_fails.empty() && set.zero_shift_fails.back() == name;
      if (!check.ok && !again) set.zero_shift_fails.push_back(name);
    }
    for (std::size_t i = 0; i < kLimits; ++i) {
      set.refined[i] = optimize::refine(limited[i], point.candidate);
      if (optimize::has_design(set.refined[i].status)) {
        set.refined_kinematic_rad[i] =
            kinematic_lost_motion(optimize::train_of(limited[i], set.refined[i]));
      }
    }
  });
  return sets;
}

/// What becomes of the published gear with other inputs.
FigureMapPoint map_point(const design::Design& design) {
  FigureMapPoint point;
  const auto result = design::evaluate(design);
  const auto* e = std::get_if<design::Evaluation>(&result);
  if (e == nullptr || !e->efficiency.backward || !e->efficiency.forward) {
    point.status = "undefined";
    return point;
  }
  const auto failed = std::ranges::find(e->checks, false, &design::CheckResult::ok);
  if (failed != e->checks.end()) {
    point.status = failed->record->name;
    for (const std::string& member : {failed->mesh, failed->gear}) {
      if (!member.empty()) point.status += ' ' + member;
    }
    return point;
  }
  point.status = "ok";
  point.eta_b = *e->efficiency.backward;
  point.eta_f = *e->efficiency.forward;
  point.paper_rad = e->lost_motion.paper_rad;
  point.kinematic_rad = e->lost_motion.kinematic_rad;
  return point;
}

/// Where a design keeps an input, and the range around its published value.
struct Variation {
  const char* name;
  Unit unit;
  double* (*place)(train::TrainParameters<double>&);
  double step;       ///< in `unit`
  int below, above;  ///< steps
};

VariedInput varied_input(const Variation& v, design::Design design) {
  VariedInput input{
      .name = v.name, .unit = v.unit, .published = *v.place(design.train), .values = {}};
  input.values.reserve(static_cast<std::size_t>(v.below) + static_cast<std::size_t>(v.above) + 1);
  for (int k = -v.below; k <= v.above; ++k) {
    input.values.push_back(k == 0 ? input.published
                                  : input.published + units::to_si(k * v.step, v.unit));
  }
  return input;
}

FigureMap figure_map(const design::Design& published, const Variation& x,
                     const std::optional<Variation>& y) {
  FigureMap map{.x = varied_input(x, published), .y = {}, .points = {}};
  if (y) map.y = varied_input(*y, published);
  map.points.resize(map.x.values.size() * map.rows());
  numerics::parallel_for(map.points.size(), [&](std::size_t k) {
    design::Design design = published;
    *x.place(design.train) = map.x.values[k / map.rows()];
    if (y) *y->place(design.train) = map.y->values[k % map.rows()];
    map.points[k] = map_point(design);
  });
  return map;
}

}  // namespace

PaperFigures paper_figures(const PublishedSources& sources) {
  PaperFigures figures{.task = sources.figure_task,
                       .statements = sources.statements,
                       .published_center_distance_m = 0.0,
                       .published = {},
                       .rim_m = 0.0,
                       .scatter = {},
                       .refined = {},
                       .ring_shifts = {},
                       .modules = {},
                       .planet_shift = {}};
  const Specification& task = figures.task;
  const design::Evaluation published = evaluated(sources.low_backlash.design);
  figures.published_center_distance_m = published.center_distance_m;
  figures.published = at_distance(sources.low_backlash.design, published.center_distance_m);
  figures.published.train.machining_allowance = task.machining_allowance;
  figures.published.friction = task.friction;
  figures.published.limits = without_lost_motion(task.limits);
  const double root_diameter_m = largest_ring_root_diameter(published);
  figures.rim_m =
      0.5 * (sources.low_backlash.outer_diameter_m.value_or(root_diameter_m) - root_diameter_m);

  figures.scatter =
      ratio_scatter(task, sources.statements.figure_outer_diameter_m - 2.0 * figures.rim_m);
  figures.refined = refined_points(task, figures.scatter);

  using Parameters = train::TrainParameters<double>;
  figures.ring_shifts =
      figure_map(figures.published,
                 {.name = "x_R1",
                  .unit = Unit::kNone,
                  .place = [](Parameters& p) { return &p.profile_shift[train::kR1]; },
                  .step = 0.02,
                  .below = 22,
                  .above = 27},
                 Variation{.name = "x_R2",
                           .unit = Unit::kNone,
                           .place = [](Parameters& p) { return &p.profile_shift[train::kR2]; },
                           .step = 0.02,
                           .below = 14,
                           .above = 35});
  figures.modules = figure_map(figures.published,
                               {.name = "m1",
                                .unit = Unit::kMillimetre,
                                .place = [](Parameters& p) { return p.module_m.data(); },
                                .step = 0.0002,
                                .below = 25,
                                .above = 25},
                               Variation{.name = "m2",
                                         .unit = Unit::kMillimetre,
                                         .place = [](Parameters& p) { return &p.module_m[1]; },
                                         .step = 0.0002,
                                         .below = 25,
                                         .above = 25});
  figures.planet_shift =
      figure_map(figures.published,
                 {.name = "x_P1",
                  .unit = Unit::kNone,
                  .place = [](Parameters& p) { return &p.profile_shift[train::kP1]; },
                  .step = 0.005,
                  .below = 40,
                  .above = 40},
                 std::nullopt);
  return figures;
}

}  // namespace gear3k::papers
