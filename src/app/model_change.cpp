#include "app/model_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "app/robust_run.hpp"
#include "calibrate/model/law_doubt.hpp"
#include "calibrate/model/model_range.hpp"
#include "calibrate/model/parameter_draws.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "design/evaluation.hpp"
#include "design/measured_lost_motion.hpp"
#include "efficiency/train_efficiency.hpp"
#include "numerics/parallel.hpp"
#include "optimize/objective_value.hpp"

namespace gear3k::app {

namespace {

using optimize::Objective;
using report::ModelEstimate;

/// Draws without a value that an interval of the others is still stated beside.
constexpr double kMostUndefined = 0.01;
/// Gains of equal teeth up to so many of the objective's resolutions are those of two runs of a
/// solver to the same optimum.
constexpr double kNoGain = 10.0;

/// Where designs of a task are judged, and by what.
struct Judge {
  Objective objective = Objective::kBackwardEfficiency;
  std::optional<design::OperatingPoint<double>> point;
};

/// A best design with what does not depend on the model.
struct Contender {
  const design::Design* stated = nullptr;
  train::TrainParameters<double> parameters;
  train::TrainGeometry<double> geometry;
  double objective = 0.0;  ///< of the teeth alone, SI
};

/// What a model says of a design; empty where it does not run, or a test has nothing to measure.
struct Values {
  std::optional<double> eta_b, eta_f, lost_motion_rad, objective;
};

/// Efficiency of the meshes alone, at a friction that is the same everywhere.
std::optional<double> mesh_efficiency(const design::Design& design,
                                      const train::TrainGeometry<double>& geometry, bool forward) {
  const auto eta = efficiency::mesh_efficiencies(
      geometry, efficiency::constant_friction<double>(design.friction, geometry.teeth, forward),
      design.friction.model, forward);
  if (!std::ranges::all_of(eta, [](double e) { return e > 0.0; })) return std::nullopt;
  return forward ? efficiency::forward_efficiency(geometry.teeth, eta)
                 : efficiency::backward_efficiency(geometry.teeth, eta);
}

Values values_of(const Judge& judge, const Contender& contender,
                 const design::Extension<double>& extension) {
  const design::Design design = design::extended(*contender.stated, extension);
  const auto lossy = design::lossy_train(design, contender.geometry);
  const auto efficiency = [&](design::Direction direction) -> std::optional<double> {
    if (!judge.point) {
      return mesh_efficiency(design, contender.geometry, direction == design::Direction::kForward);
    }
    const auto result = design::operate(lossy, *judge.point, direction);
    return result.operation ? result.operation->efficiency : std::nullopt;
  };
  Values values{.eta_b = efficiency(design::Direction::kBackward),
                .eta_f = efficiency(design::Direction::kForward),
                .lost_motion_rad = std::nullopt,
                .objective = contender.objective};
  const auto& e = extension.lost_motion;
  const auto point = judge.point.value_or(design::OperatingPoint<double>{});
  if (design::changes_lost_motion(e)) {
    values.lost_motion_rad = design::measured_lost_motion<double>(
        contender.parameters, contender.geometry, e,
        {.torque_Nm = point.output_torque_Nm, .temperature_K = point.temperature_K});
  }
  switch (judge.objective) {
    case Objective::kBackwardEfficiency:
      values.objective = values.eta_b;
      break;
    case Objective::kForwardEfficiency:
      values.objective = values.eta_f;
      break;
    case Objective::kLostMotion:
      *values.objective += e.clearance_rad + backlash::windup(e, point.output_torque_Nm);
      break;
    default:
      break;
  }
  return values;
}

/// Losses of the meshes in a direction; none where the gearbox does not run, or without a point.
std::optional<calibrate::MeshLosses> losses_of(const Judge& judge, const Contender& contender,
                                               const design::Extension<double>& extension,
                                               design::Direction direction) {
  if (!judge.point) return std::nullopt;
  const design::Design design = design::extended(*contender.stated, extension);
  const auto result =
      design::operate(design::lossy_train(design, contender.geometry), *judge.point, direction);
  if (!result.operation) return std::nullopt;
  return calibrate::mesh_losses(*result.operation, direction, extension.friction,
                                judge.point->temperature_K);
}

/// What the campaign leaves open about the efficiency of the second design less that of the first.
double doubt_of(const Judge& judge, const Contender& first, const Contender& second,
                const Model& model, design::Direction direction) {
  const auto before = losses_of(judge, first, model.extension, direction);
  const auto after = losses_of(judge, second, model.extension, direction);
  const bool ambiguous = std::ranges::any_of(
      model.use.models, [](const auto& m) { return m.verdict == calibrate::Verdict::kAmbiguous; });
  return before && after ? calibrate::gain_doubt(*before, *after, ambiguous) : 0.0;
}

/// The model with each mesh's own force in the place of the torque that all share: at the operating
/// point of a gearbox the same on the whole, and what a campaign with that gearbox alone hardly
/// tells from it.  None of other laws, and where the gearbox does not run.
std::optional<design::Extension<double>> by_own_force(const Judge& judge, const Contender& measured,
                                                      const design::Extension<double>& extension) {
  if (!extension.friction.load_is_torque || !judge.point) return std::nullopt;
  const design::Design design = design::extended(*measured.stated, extension);
  const auto result = design::operate(design::lossy_train(design, measured.geometry), *judge.point,
                                      design::Direction::kForward);
  if (!result.operation || !(judge.point->output_torque_Nm > 0.0)) return std::nullopt;
  design::Extension<double> own = extension;
  own.friction.load_is_torque = own.friction.share_is_of_force = false;
  own.friction.reference_force_N *=
      calibrate::mean_force(*result.operation) / judge.point->output_torque_Nm;
  return own;
}

/// Quantile of sorted values, linear between them.
double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

/// A value with the interval of its draws; none where too many of them have none.
/// @param drawn  a draw's value, in any order; none at all: no interval is known
std::optional<ModelEstimate> estimate(const std::optional<double>& value,
                                      const std::vector<std::optional<double>>& drawn) {
  if (!value) return std::nullopt;
  ModelEstimate result{.value = *value, .ci90 = std::nullopt};
  std::vector<double> defined;
  defined.reserve(drawn.size());
  for (const auto& d : drawn) {
    if (d) defined.push_back(*d);
  }
  const double undefined = static_cast<double>(drawn.size() - defined.size());
  if (defined.empty() || undefined > kMostUndefined * static_cast<double>(drawn.size())) {
    return result;
  }
  std::ranges::sort(defined);
  constexpr double kTail = 0.05;
  result.ci90 = {quantile(defined, kTail), quantile(defined, 1.0 - kTail)};
  return result;
}

/// An interval with a normal deviation of its own beside what it holds already.
/// @param deviation  standard; @param least  either half of the interval, at least
void widen(std::optional<ModelEstimate>& estimate, double deviation, double least = 0.0) {
  if (!estimate || !estimate->ci90) return;
  if (!std::isfinite(deviation)) {
    estimate->ci90 = std::nullopt;
    return;
  }
  constexpr double kQuantile95 = 1.6448536269514722;
  const auto half = [&](double own) {
    return std::max(std::hypot(std::max(0.0, own), kQuantile95 * deviation), least);
  };
  const double value = estimate->value;
  auto& [low, high] = *estimate->ci90;
  low = std::min(low, value - half(value - low));
  high = std::max(high, value + half(high - value));
}

template <class Member>
std::optional<ModelEstimate> estimate_of(const Values& values, const std::vector<Values>& drawn,
                                         Member member) {
  std::vector<std::optional<double>> each(drawn.size());
  std::ranges::transform(drawn, each.begin(), member);
  return estimate(values.*member, each);
}

std::optional<double> difference(const std::optional<double>& a, const std::optional<double>& b) {
  if (!a || !b) return std::nullopt;
  return *a - *b;
}

/// Equal teeth, and lengths to 0.1 µm: what no drawing and no shop would tell apart.
bool same_lengths(const design::Design& a, const design::Design& b) {
  const auto& p = a.train;
  const auto& q = b.train;
  if (train::teeth_of(p.teeth) != train::teeth_of(q.teeth) || p.planets != q.planets) return false;
  constexpr double kLength_m = 1e-7;
  constexpr double kAngle_rad = 1e-6;
  const auto close = [](double x, double y) { return std::abs(x - y) <= kLength_m; };
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const double module_m =
        p.module_m[static_cast<std::size_t>(train::stage_of(static_cast<int>(i)))];
    const double addendum = p.rack[i].addendum - p.tip_shortening[i];
    const double other = q.rack[i].addendum - q.tip_shortening[i];
    if (!close(module_m * p.profile_shift[i], module_m * q.profile_shift[i]) ||
        !close(module_m * addendum, module_m * other)) {
      return false;
    }
  }
  return close(p.module_m[0], q.module_m[0]) && close(p.module_m[1], q.module_m[1]) &&
         close(p.center_distance_m, q.center_distance_m) &&
         std::abs(p.pressure_angle_rad - q.pressure_angle_rad) <= kAngle_rad;
}

/// Equal in every number that decides efficiency and lost motion.
bool identical_trains(const design::Design& a, const design::Design& b) {
  const auto& p = a.train;
  const auto& q = b.train;
  bool same = train::teeth_of(p.teeth) == train::teeth_of(q.teeth) && p.planets == q.planets &&
              p.profile_shift == q.profile_shift && p.module_m == q.module_m &&
              p.tip_shortening == q.tip_shortening && p.center_distance_m == q.center_distance_m &&
              p.pressure_angle_rad == q.pressure_angle_rad;
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    same = same && p.rack[i].addendum == q.rack[i].addendum;
  }
  return same;
}

/// Whether the teeth keep the task's limits, which are lowered by what the model adds.
bool keeps_lost_motion_limits(const OptimizeTask& task, const optimize::RefinedSet& set) {
  using design::CheckId;
  const auto& least = task.stated_limits[CheckId::kOutputBacklashMin];
  const auto& most = task.stated_limits[CheckId::kOutputBacklashMax];
  const double slack =
      design::kFeasibilityTolerance * optimize::objective_scale(Objective::kLostMotion, task.spec);
  return (!least || set.lost_motion_rad >= *least - slack) &&
         (!most || set.lost_motion_rad <= *most + slack);
}

Contender contender_of(const OptimizeTask& task, const Optimization& run) {
  const design::Design& stated = run.best->stated;
  const auto parameters = design::resolved_parameters(stated);
  return {.stated = &stated,
          .parameters = parameters,
          .geometry = *train::make_train_geometry(parameters),
          .objective = optimize::objective_of(task.spec, *run.result.best,
                                              optimize::first_objective(task.spec))};
}

report::JudgedDesign judged(const OptimizeTask& task, const Optimization& run, const Values& values,
                            const std::vector<Values>& drawn) {
  const optimize::Candidate& candidate = run.result.best->candidate;
  return {.stated = run.best->stated,
          .teeth = candidate.teeth,
          .planets = candidate.planets,
          .eta_b = estimate_of(values, drawn, &Values::eta_b),
          .eta_f = estimate_of(values, drawn, &Values::eta_f),
          .lost_motion_rad = estimate_of(values, drawn, &Values::lost_motion_rad),
          .keeps_lost_motion_limits = keeps_lost_motion_limits(task, *run.result.best),
          .objective = estimate_of(values, drawn, &Values::objective)};
}

/// Why intervals of a model cannot be stated; "" where they can.
std::string why_no_intervals(const Model& model) {
  const auto names = calibrate::parameters_without_scatter(model.use.models);
  if (names.empty()) return "";
  return fmt::format("{} states no standard deviation of {}", model.use.file,
                     fmt::join(names, ", "));
}

/// Widens the intervals of the second design and of the gain by what the campaign leaves open.
void add_doubt(const Judge& judge, const Contender& first, const Contender& second,
               const Model& model, report::ModelChange& change) {
  const auto doubt = [&](design::Direction direction) {
    return doubt_of(judge, first, second, model, direction);
  };
  const double backward = doubt(design::Direction::kBackward);
  const double forward = doubt(design::Direction::kForward);
  widen(change.after.eta_b, backward);
  widen(change.after.eta_f, forward);
  double own = 0.0;  // of the objective
  if (judge.objective == Objective::kBackwardEfficiency) own = backward;
  if (judge.objective == Objective::kForwardEfficiency) own = forward;
  widen(change.after.objective, own);
  widen(change.gain, own);
}

/// The gain of a design that stays is 0, known without draws; of another one it is not known more
/// closely than refined designs are compared.
void settle_gain(report::ModelChange& change) {
  if (!change.gain) return;
  const double resolution = optimize::objective_record(change.objective).resolution;
  const bool identical = identical_trains(change.before.stated, change.after.stated);
  const double computed = change.gain->value;
  change.same_design = identical || (same_lengths(change.before.stated, change.after.stated) &&
                                     std::abs(computed) <= kNoGain * resolution);
  if (change.same_design) {
    const double most = identical ? 0.0 : std::max(std::abs(computed), resolution);
    change.gain = ModelEstimate{.value = 0.0, .ci90 = {{-most, most}}};
    change.gain_by_parameters = change.gain->ci90;
  } else {
    widen(change.gain, 0.0, resolution);
  }
}

/// Both designs by the model and by `draws` others that it could be.
report::ModelChange change_of(const OptimizeTask& task, const Optimization& without,
                              const Optimization& with) {
  const Judge judge{.objective = optimize::first_objective(task.spec),
                    .point = task.spec.operating_point};
  report::ModelChange change{.objective = judge.objective,
                             .point = judge.point,
                             .before = {},
                             .after = {},
                             .gain = std::nullopt,
                             .gain_by_parameters = std::nullopt,
                             .same_design = false,
                             .draws = 0,
                             .seed = task.spec.solver.seed,
                             .no_intervals = why_no_intervals(*task.model)};
  const Contender first = contender_of(task, without);
  const Contender second = contender_of(task, with);
  if (change.no_intervals.empty()) change.draws = kModelDraws;
  std::vector<Values> before(change.draws);
  std::vector<Values> after(change.draws);
  std::vector<std::optional<double>> gain(change.draws);
  const calibrate::ParameterDraws draws(task.model->use.models, change.seed);
  numerics::parallel_for(change.draws, [&](std::size_t n) {
    const auto extension = calibrate::extension_of(draws.draw(n));
    before[n] = values_of(judge, first, extension);
    after[n] = values_of(judge, second, extension);
    gain[n] = difference(after[n].objective, before[n].objective);
  });
  const Values before_now = values_of(judge, first, task.model->extension);
  const Values after_now = values_of(judge, second, task.model->extension);
  change.before = judged(task, without, before_now, before);
  change.after = judged(task, with, after_now, after);
  change.gain = estimate(difference(after_now.objective, before_now.objective), gain);
  if (change.gain) change.gain_by_parameters = change.gain->ci90;
  add_doubt(judge, first, second, *task.model, change);
  if (const auto own = by_own_force(judge, first, task.model->extension)) {
    const auto gain_by_force = difference(values_of(judge, second, *own).objective,
                                          values_of(judge, first, *own).objective);
    if (change.gain && gain_by_force) {
      const double apart = std::abs(*gain_by_force - change.gain->value);
      widen(change.after.objective, apart);
      widen(change.gain, apart);
    }
  }
  settle_gain(change);
  return change;
}

/// Why the designs cannot be compared whatever the search finds; "" where they can.
std::string why_incomparable(const OptimizeTask& task) {
  if (task.spec.objectives.size() > 1) {
    return "a list of objectives asks for a front, not for one best design";
  }
  if (!task.spec.operating_point && (calibrate::needs_operating_point(task.model->extension) ||
                                     efficiency::depends_on_state(task.spec.friction))) {
    return "the model needs an operating point, and neither SPEC nor model states one";
  }
  return "";
}

}  // namespace

report::ModelComparison compare_with_model(const OptimizeTask& task, const Optimization& found,
                                           optimize::Progress& progress) {
  report::ModelComparison comparison;
  comparison.missing = why_incomparable(task);
  if (!comparison.missing.empty()) return comparison;
  if (found.interrupted || !found.best) {
    comparison.missing = found.interrupted ? "the search was interrupted"
                                           : "no feasible design was found with the model";
    return comparison;
  }
  OptimizeTask plain{.spec = *task.without_model,
                     .without_model = std::nullopt,
                     .stated_limits = task.without_model->limits,
                     .model = std::nullopt,
                     .model_notes = {},
                     .unreachable = {},
                     .source = task.source,
                     .certify = optimize::has_bounds(*task.without_model)};
  restart(progress);
  const Optimization without = optimize(plain, {}, progress);
  comparison.interrupted = without.interrupted;
  if (without.interrupted || !without.best) {
    comparison.missing = without.interrupted ? "the search without the model was interrupted"
                                             : "without the model no design is feasible";
    return comparison;
  }
  comparison.change = change_of(task, without, found);
  return comparison;
}

}  // namespace gear3k::app
