#include "optimize/rounding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "numerics/parallel.hpp"
#include "optimize/blocking.hpp"
#include "optimize/lattice.hpp"
#include "optimize/limit_prices.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/set_bounds.hpp"
#include "optimize/starting_points.hpp"

namespace gear3k::optimize {

namespace {

/// Two ends of a box are one: their scaled objectives, or by which share of it they miss the
/// limits.
constexpr double kSameEnd = 1e-6, kSameMiss = 0.01;
/// Relaxations that a choice of modules has in the first pass, and by how much more in each further
/// one: no choice uses up what all of them have before the others were looked at.
constexpr std::size_t kFirstPass = 500, kMoreByPass = 4;

enum class AxisOf { kShift, kTip, kPressureAngle, kFaceWidth, kDistance };

/// A value that is to be on the lattice.
struct Axis {
  AxisOf of{};
  std::size_t place = 0;  ///< of the variable; the distance's is the angle of its mesh
  std::size_t index = 0;  ///< gear or stage
  Multiples multiples;
};

/// One choice of modules with its allowances, and one branch of the problem.
class RoundingTask {
 public:
  RoundingTask(std::shared_ptr<const Specification> spec, const RefinedSet& set,
               const ProblemBranch& branch)
      : spec_(std::move(spec)),
        set_(set),
        problem_(make_refinement_problem(
            *spec_, set.candidate,
            {spec_->module[0].range_m ? spec_->module[0].range_m->min : set.train.module_m[0],
             spec_->module[1].range_m ? spec_->module[1].range_m->min : set.train.module_m[1]},
            branch)) {
    problem_.cutter_teeth = set.train.cutter_teeth;
    add_axes();
  }

  [[nodiscard]] const RefinementProblem& problem() const { return problem_; }
  [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }

  /// The whole lattice; empty where an axis has no multiple in its range.
  [[nodiscard]] std::optional<LatticeBox> whole() const {
    LatticeBox box;
    for (const Axis& axis : axes_) {
      const auto [least, most] = ends_of(axis);
      box.push_back({axis.multiples.first_from(least), axis.multiples.last_to(most)});
      if (box.back()[0] > box.back()[1]) return std::nullopt;
    }
    return box;
  }

  /// Where to begin: the free optimum, its distance wide enough for these modules.
  [[nodiscard]] Point beginning() const {
    auto train = train_of(*spec_, set_);
    double wider = 0.0;
    for (std::size_t stage = 0; stage < 2; ++stage) {
      wider = std::max(wider, *problem_.fixed_module_m[stage] / train.module_m[stage]);
      train.module_m[stage] = *problem_.fixed_module_m[stage];
    }
    train.center_distance_m *= wider;
    return point_of(problem_, train,
                    {.face_width_m = set_.train.face_width_m,
                     .torque_Nm = set_.torque_capacity_Nm.value_or(0.0)});
  }

  /// The problem with all values free within a box.
  [[nodiscard]] RefinementProblem within(const LatticeBox& box) const {
    RefinementProblem p = problem_;
    confine(box, p);
    return p;
  }

  /// Whether it is proven that no design with these modules meets all limits.
  [[nodiscard]] bool proven_empty() const {
    Progress progress;
    const std::array one{set_.candidate};
    SetBounds bounds(*spec_, one, progress);
    bounds.tie(std::array{std::uint32_t{0}}, progress);
    return bounds.of(0).infeasible.has_value();
  }

  /// A scaled objective of this task in SI, to be minimised: tasks of sizes have a scale each.
  [[nodiscard]] double least_si(double objective) const {
    return objective * problem_.objective_scale;
  }

  /// How many steps an axis is at a point.
  [[nodiscard]] double steps_at(const Axis& axis, const Point& v) const {
    return axis.multiples.count(value_at(axis, v));
  }

  /// The point of a box next to v, evaluated.
  [[nodiscard]] RoundedDesign rounded(const LatticeBox& box, const Point& v) const {
    RoundedDesign design{.spec = {}, .set = set_};
    RefinedTrain& train = design.set.train;
    train.module_m = {*problem_.fixed_module_m[0], *problem_.fixed_module_m[1]};
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      const Axis& axis = axes_[k];
      const long at = std::clamp(axis.multiples.nearest(value_at(axis, v)), box[k][0], box[k][1]);
      member_of(axis, train) = axis.multiples.at(at);
    }
    judge(v, design);
    return design;
  }

  /// The design with its specification, as it is handed out.
  [[nodiscard]] RoundedDesign finished(RoundedDesign design) const {
    design.spec = *spec_;
    design.set.kkt_residual = std::numeric_limits<double>::quiet_NaN();
    design.set.torque_capacity_Nm.reset();
    design.set.torsional_stiffness_Nm_rad.reset();
    return design;
  }

 private:
  void add_axes() {
    const RoundSteps& steps = spec_->round;
    if (problem_.pressure_angle > 0) {
      axes_.push_back({.of = AxisOf::kPressureAngle,
                       .place = problem_.pressure_angle,
                       .index = 0,
                       .multiples = {steps.pressure_angle_rad, units::Unit::kDegree}});
    }
    axes_.push_back({.of = AxisOf::kDistance,
                     .place = kAngleA,
                     .index = 0,
                     .multiples = {steps.center_distance_m, units::Unit::kMillimetre}});
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      axes_.push_back({.of = AxisOf::kShift,
                       .place = i,
                       .index = i,
                       .multiples = {steps.profile_shift, units::Unit::kModules}});
    }
    for (std::size_t i = 0; problem_.first_tip > 0 && i < train::kGearCount; ++i) {
      axes_.push_back({.of = AxisOf::kTip,
                       .place = problem_.first_tip + i,
                       .index = i,
                       .multiples = {steps.tip_shortening, units::Unit::kModules}});
    }
    for (std::size_t stage = 0; stage < 2; ++stage) {
      if (problem_.face_width[stage] == 0) continue;
      axes_.push_back({.of = AxisOf::kFaceWidth,
                       .place = problem_.face_width[stage],
                       .index = stage,
                       .multiples = {steps.face_width_m, units::Unit::kMillimetre}});
    }
  }

  static double& member_of(const Axis& axis, RefinedTrain& train) {
    switch (axis.of) {
      case AxisOf::kShift:
        return train.profile_shift[axis.index];
      case AxisOf::kTip:
        return train.tip_shortening[axis.index];
      case AxisOf::kPressureAngle:
        return train.pressure_angle_rad;
      case AxisOf::kFaceWidth:
        return train.face_width_m[axis.index];
      case AxisOf::kDistance:
        break;
    }
    return train.center_distance_m;
  }

  [[nodiscard]] double value_at(const Axis& axis, const Point& v) const {
    if (axis.of == AxisOf::kDistance) {
      return parameters_at(problem_, used(problem_, v)).center_distance_m;
    }
    return v[axis.place] * width_scale(axis);
  }
  [[nodiscard]] double width_scale(const Axis& axis) const {
    return axis.of == AxisOf::kFaceWidth ? spec_->free.face_width_m[axis.index]->max : 1.0;
  }

  /// Distances of both ends of the angle: the greatest angle belongs to the greatest distance.
  [[nodiscard]] std::pair<double, double> ends_of(const Axis& axis) const {
    Point v = problem_.lower;
    if (axis.of != AxisOf::kDistance) {
      const double scale = width_scale(axis);
      return {problem_.lower[axis.place] * scale, problem_.upper[axis.place] * scale};
    }
    // Of a free pressure angle the least distance is at its greatest value.
    if (problem_.pressure_angle > 0) {
      v[problem_.pressure_angle] = problem_.upper[problem_.pressure_angle];
    }
    const double least = value_at(axis, v);
    v[kAngleA] = problem_.upper[kAngleA];
    if (problem_.pressure_angle > 0) {
      v[problem_.pressure_angle] = problem_.lower[problem_.pressure_angle];
    }
    return {least, value_at(axis, v)};
  }

  void confine(const LatticeBox& box, RefinementProblem& p) const {
    bool angle_known = true;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      const Axis& axis = axes_[k];
      if (axis.of == AxisOf::kDistance) continue;
      if (axis.of == AxisOf::kPressureAngle) angle_known = box[k][0] == box[k][1];
      p.lower[axis.place] = axis.multiples.at(box[k][0]) / width_scale(axis);
      p.upper[axis.place] = axis.multiples.at(box[k][1]) / width_scale(axis);
    }
    const auto distance = std::ranges::find(axes_, AxisOf::kDistance, &Axis::of) - axes_.begin();
    if (!angle_known) return;
    const auto place = static_cast<std::size_t>(distance);
    // d = c/cos a, c the distance at the least angle times its cosine.
    Point v = p.lower;
    const double c = value_at(axes_[place], v) * std::cos(v[kAngleA]);
    const auto angle = [&](long k) {
      return std::acos(std::min(1.0, c / axes_[place].multiples.at(k)));
    };
    p.lower[kAngleA] = std::max(p.lower[kAngleA], angle(box[place][0]));
    p.upper[kAngleA] = std::max(p.lower[kAngleA], std::min(p.upper[kAngleA], angle(box[place][1])));
  }

  void judge(const Point& relaxed, RoundedDesign& design) const {
    Point v = point_of(problem_, train_of(*spec_, design.set),
                       {.face_width_m = design.set.train.face_width_m, .torque_Nm = 0.0});
    if (problem_.torque > 0) {
      v[problem_.torque] =
          std::min(problem_.upper[problem_.torque], 2.0 * relaxed[problem_.torque]);
      lower_to_carried_torque(problem_, v);
    }
    std::vector<double> g(problem_.rows.size());
    const auto f = evaluate<double>(problem_, used(problem_, v), g);
    if (!f) {
      design.violation = std::numeric_limits<double>::infinity();
      return;
    }
    design.objective = -sense_of(problem_.objective) * problem_.objective_scale * *f;
    design.violation = worst_violation(g);
    if (is_feasible(design.violation)) return;
    design.missed = misses_of(problem_, g);
  }

  std::shared_ptr<const Specification> spec_;
  const RefinedSet& set_;
  RefinementProblem problem_;
  std::vector<Axis> axes_;
};

/// The search over all tasks.
class LatticeSearch {
 public:
  /// @param scale  of the objective, of all tasks
  LatticeSearch(double scale, const StopFlag& stop, const RoundingOptions& options)
      : scale_(scale), stop_(stop), options_(options) {}

  void add(RoundingTask task) { tasks_.push_back(std::move(task)); }

  Rounding run() {
    std::set<std::array<double, 2>> tried, with_design;
    const std::vector<char> proven_empty = prove_empty();
    std::vector<OpenTask> open;
    for (std::size_t k = 0; k < tasks_.size() && !cut(); ++k) {
      const RoundingTask& task = tasks_[k];
      const std::array<double, 2> modules{*task.problem().fixed_module_m[0],
                                          *task.problem().fixed_module_m[1]};
      tried.insert(modules);
      if (proven_empty[k] != 0) continue;
      if (auto root = root_of(task)) {
        with_design.insert(modules);
        open.push_back({.task = &task, .bound = root->bound, .boxes = {}});
        open.back().boxes.push_back(std::move(*root));
      }
    }
    const bool all_begun = !cut();
    result_.module_pairs = tried.size();
    result_.module_pairs_with_design = with_design.size();
    std::ranges::stable_sort(open, {}, &OpenTask::bound);
    for (std::size_t most = kFirstPass; !open.empty() && !cut(); most *= kMoreByPass) {
      std::erase_if(open, [&](OpenTask& one) { return descend(one, most); });
    }
    result_.complete = all_begun && open.empty();
    // What a point misses is told though none can be without it.
    for (std::size_t k = 0; k < tasks_.size() && !cut(); ++k) {
      if (result_.best || result_.nearest) break;
      if (proven_empty[k] != 0) root_of(tasks_[k]);
    }
    if (result_.best) result_.nearest.reset();
    return std::move(result_);
  }

 private:
  /// A task with what is left of its lattice.
  struct OpenTask {
    const RoundingTask* task = nullptr;
    double bound = 0.0;  ///< of the whole
    std::vector<BoxNode> boxes;
  };

  [[nodiscard]] bool cut() const {
    return stop_.load(std::memory_order_relaxed) ||
           result_.relaxations >= options_.most_relaxations;
  }
  /// Which tasks are proven to have no design.
  [[nodiscard]] std::vector<char> prove_empty() const {
    std::vector<char> proven(tasks_.size());
    numerics::parallel_for(tasks_.size(), [&](std::size_t k) {
      proven[k] = !stop_.load(std::memory_order_relaxed) && tasks_[k].proven_empty() ? 1 : 0;
    });
    return proven;
  }
  /// The whole lattice of a task, from the free optimum and from starts of its own until two end
  /// alike: an end that is not the best loses the modules.
  /// @returns empty where no start has a feasible end
  std::optional<BoxNode> root_of(const RoundingTask& task) {
    const auto whole = task.whole();
    if (!whole) return std::nullopt;
    const RefinementProblem problem = task.within(*whole);
    BoxNode root{.box = *whole, .relaxed = relax(problem, task.beginning())};
    const Solver& solver = problem.spec->solver;
    std::vector<Point> starts = starting_points(problem, solver.starts, solver.seed);
    std::ranges::reverse(starts);
    for (const Point& start : starts) {
      if (cut()) break;
      SolveOutcome end = relax(problem, start);
      const bool alike = ends_alike(root.relaxed, end);
      if (is_better(end, root.relaxed)) root.relaxed = end;
      if (alike) break;
    }
    bound(task, root);
    offer(task, root);
    if (!root.relaxed.feasible()) return std::nullopt;
    return root;
  }
  static bool ends_alike(const SolveOutcome& a, const SolveOutcome& b) {
    if (a.feasible() != b.feasible()) return false;
    return a.feasible() ? std::abs(a.objective - b.objective) <= kSameEnd
                        : std::abs(a.violation - b.violation) <= kSameMiss * a.violation;
  }

  SolveOutcome relax(const RefinementProblem& problem, const Point& start, bool give_up = false) {
    ++result_.relaxations;
    return best_within(problem, start, give_up);
  }
  /// Once more from the middle before a half is left: the end of the box that it was cut from lies
  /// at its edge, where a search may stay.
  void relax_half(const RoundingTask& task, const Point& start, BoxNode& half) {
    const RefinementProblem problem = task.within(half.box);
    half.relaxed = relax(problem, start);
    bound(task, half);
    if (can_win(half)) return;
    SolveOutcome again = relax(problem, middle_of(problem), !half.relaxed.feasible());
    if (is_better(again, half.relaxed)) half.relaxed = again;
    bound(task, half);
  }
  static Point middle_of(const RefinementProblem& problem) {
    Point v{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
      v[k] = 0.5 * (problem.lower[k] + problem.upper[k]);
    }
    return v;
  }
  void bound(const RoundingTask& task, BoxNode& node) const {
    if (node.relaxed.feasible()) node.bound = task.least_si(node.relaxed.objective) / scale_;
  }
  [[nodiscard]] bool can_win(const BoxNode& node) const {
    return node.bound < best_ - kBetterOnLattice;
  }

  /// Goes on with a task's boxes, by so many relaxations at most.
  /// @returns whether none is left
  bool descend(OpenTask& one, std::size_t most) {
    const RoundingTask& task = *one.task;
    const std::size_t last = result_.relaxations + most;
    return search_boxes(
        {.relax = [&](const BoxNode& from,
                      BoxNode& half) { relax_half(task, from.relaxed.v, half); },
         .steps_at = [&](std::size_t axis,
                         const Point& v) { return task.steps_at(task.axes()[axis], v); },
         .axis_to_cut = [&](const BoxNode& node) { return axis_to_cut(task, node); },
         .offer = [&](const BoxNode& node) { offer(task, node); },
         .can_win = [&](const BoxNode& node) { return can_win(node); },
         .cut = [&] { return cut() || result_.relaxations >= last; }},
        one.boxes);
  }

  /// The axis to cut a box at: the pressure angle, then the distance, then the farthest one.
  static std::optional<std::size_t> axis_to_cut(const RoundingTask& task, const BoxNode& node) {
    std::vector<double> steps(task.axes().size());
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const Axis& axis = task.axes()[k];
      steps[k] = task.steps_at(axis, node.relaxed.v);
      if (node.box[k][0] == node.box[k][1]) continue;
      if (axis.of == AxisOf::kPressureAngle) return k;
      const double off = std::abs(steps[k] - std::round(steps[k]));
      if (axis.of == AxisOf::kDistance && off > kOnLattice) return k;
    }
    return farthest_axis(node.box, steps);
  }

  void offer(const RoundingTask& task, const BoxNode& node) {
    if (!std::isfinite(node.relaxed.violation)) return;
    ++result_.points;
    RoundedDesign design = task.rounded(node.box, node.relaxed.v);
    if (is_feasible(design.violation)) {
      const double f = -sense_of(task.problem().objective) * design.objective / scale_;
      if (result_.best && !(f < best_)) return;
      best_ = f;
      result_.best = task.finished(std::move(design));
    } else if (!result_.best && std::isfinite(design.violation) &&
               (!result_.nearest || design.violation < result_.nearest->violation)) {
      result_.nearest = task.finished(std::move(design));
    }
  }

  double scale_;
  const StopFlag& stop_;
  const RoundingOptions& options_;
  std::vector<RoundingTask> tasks_;
  Rounding result_;
  double best_ = std::numeric_limits<double>::infinity();  ///< in units of scale_, to be minimised
};

/// Modules of a stage about the optimum's: the multiples of its range, or the one that it has.
std::vector<double> rounded_modules(const Specification& spec, const RefinedSet& set,
                                    std::size_t stage, int steps) {
  const double module_m = set.train.module_m[stage];
  const auto& range = spec.module[stage].range_m;
  if (!range || !(range->min < range->max)) return {module_m};
  const Multiples multiples(spec.round.module_m, units::Unit::kMillimetre);
  const long middle = multiples.nearest(module_m);
  std::vector<double> modules;
  for (long k = std::max(middle - steps, multiples.first_from(range->min));
       k <= std::min(middle + steps, multiples.last_to(range->max)); ++k) {
    modules.push_back(multiples.at(k));
  }
  return modules;
}

/// The specification with given modules, and the allowances that are whole steps with them.
std::shared_ptr<const Specification> with_modules(const Specification& spec, double m1, double m2) {
  auto own = std::make_shared<Specification>(spec);
  for (const std::size_t stage : {std::size_t{0}, std::size_t{1}}) {
    const double module_m = stage == 0 ? m1 : m2;
    own->module[stage] = {.range_m = NumberRange{.min = module_m, .max = module_m}, .series_m = {}};
  }
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const double module_m = i == train::kP2 || i == train::kR2 ? m2 : m1;
    const double steps =
        std::round(spec.machining_allowance[i] * module_m / spec.round.allowance_m);
    own->machining_allowance[i] =
        units::meant_si(steps * spec.round.allowance_m / module_m, units::Unit::kModules);
  }
  return own;
}

}  // namespace

Rounding round_design(const Specification& spec, const RefinedSet& set, const StopFlag& stop,
                      const RoundingOptions& options) {
  const auto at_optimum = with_modules(spec, set.train.module_m[0], set.train.module_m[1]);
  LatticeSearch search(objective_scale(first_objective(spec), *at_optimum), stop, options);
  for (const double m1 : rounded_modules(spec, set, 0, options.module_steps)) {
    for (const double m2 : rounded_modules(spec, set, 1, options.module_steps)) {
      if (has_same_module(spec) && m1 != m2) continue;
      const auto own = with_modules(spec, m1, m2);
      for (const ProblemBranch& branch : branches_of(*own)) search.add({own, set, branch});
    }
  }
  return search.run();
}

}  // namespace gear3k::optimize
