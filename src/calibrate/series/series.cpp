#include "calibrate/series/series.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "calibrate/measurement/commanded_torque.hpp"
#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/measurement/row_selection.hpp"
#include "calibrate/model/model_range.hpp"
#include "calibrate/series/series_model.hpp"
#include "calibrate/series/series_search.hpp"
#include "calibrate/series/unit_differences.hpp"
#include "numerics/parallel.hpp"

namespace gear3k::calibrate {

namespace {

/// Of the rate of false discoveries: for causes, for differences without a cause, and for telling
/// whose a cause is that has been found.
constexpr double kSeriesCauseShare = 0.85;
constexpr double kDifferenceShare = 0.15;
constexpr double kOriginShare = 0.1;

/// A set of causes with final values in each gearbox.
struct FinalSeries {
  JointFit joint;
  std::vector<FinalFit> units;
  std::vector<SeriesCause> causes;  ///< by effect
};

std::vector<FinalFit> final_fits(const std::deque<SeriesUnit>& units, const JointFit& joint) {
  std::vector<FinalFit> result(units.size());
  numerics::parallel_for(
      units.size(),
      [&](std::size_t u) {
        const UnitFit& f = joint.units[u];
        result[u] = final_fit(units[u].problem, f.fit.hypothesis, f.scale);
      },
      has_many_rows(units));
  return result;
}

std::optional<Origin> origin(bool mean, bool between) {
  if (mean && between) return Origin::kBoth;
  if (between) return Origin::kPart;
  if (mean) return Origin::kDesign;
  return std::nullopt;
}

/// Whose each parameter is, at a level that holds for all of them together.
/// @returns by cause: whether it is anybody's
std::vector<bool> tell_origins(std::vector<SeriesCause>& causes, double level) {
  std::vector<double> p;
  for (const SeriesCause& cause : causes) {
    for (const SeriesParameter& parameter : cause.parameters) {
      p.push_back(parameter.effects.p_mean);
      p.push_back(parameter.effects.p_between);
    }
  }
  const std::vector<double> adjusted = holm_adjusted(p);
  std::vector<bool> told;
  std::size_t next = 0;
  for (SeriesCause& cause : causes) {
    bool mean = false;
    bool between = false;
    for (SeriesParameter& parameter : cause.parameters) {
      parameter.p_mean_adjusted = adjusted[next++];
      parameter.p_between_adjusted = adjusted[next++];
      parameter.of =
          origin(parameter.p_mean_adjusted <= level, parameter.p_between_adjusted <= level);
      mean = mean || parameter.p_mean_adjusted <= level;
      between = between || parameter.p_between_adjusted <= level;
    }
    const std::optional<Origin> of = origin(mean, between);
    told.push_back(of.has_value());
    if (of) cause.of = *of;
  }
  return told;
}

/// Final values, and whose they are.  Causes that are nobody's are dropped, the least likely first.
FinalSeries finished(const std::deque<SeriesUnit>& units, JointFit joint,
                     std::vector<std::vector<std::string>> alternatives, double level) {
  while (true) {
    FinalSeries result{.joint = std::move(joint), .units = {}, .causes = {}};
    result.units = final_fits(units, result.joint);
    std::optional<std::size_t> undetermined;
    std::size_t at = 0;
    for (std::size_t e = 0; e < result.joint.effects.size(); ++e) {
      const Candidate& c = result.joint.effects[e];
      SeriesCause cause{
          .id = std::string(c.cause->id),
          .title = std::string(c.cause->title),
          .form = c.form,
          .remedy = c.cause->remedy,
          .alternatives = e < alternatives.size() ? alternatives[e] : std::vector<std::string>{}};
      for (const ParameterRecord& record : c.parameters) {
        auto parameter = series_parameter(result.units, record, at++);
        if (parameter) {
          cause.parameters.push_back(std::move(*parameter));
        } else {
          undetermined = e;
        }
      }
      result.causes.push_back(std::move(cause));
    }
    std::optional<std::size_t> drop = undetermined;
    if (!drop) {
      const std::vector<bool> told = tell_origins(result.causes, level);
      double greatest = 0.0;
      for (std::size_t e = 0; e < told.size(); ++e) {
        if (told[e]) continue;
        double p = 1.0;
        for (const SeriesParameter& parameter : result.causes[e].parameters) {
          p = std::min({p, parameter.effects.p_mean, parameter.effects.p_between});
        }
        if (drop && p <= greatest) continue;
        greatest = p;
        drop = e;
      }
    }
    if (!drop) return result;
    joint = joint_fit(units, start_without(start_at(result.joint), *drop));
    if (*drop < alternatives.size()) {
      alternatives.erase(alternatives.begin() + static_cast<std::ptrdiff_t>(*drop));
    }
  }
}

/// What of the values is the part's own: best linear predictions of b_u; 0 for other parameters.
std::vector<double> own_part(const FinalSeries& series, std::size_t unit) {
  std::vector<double> own;
  for (const SeriesCause& cause : series.causes) {
    for (const SeriesParameter& p : cause.parameters) {
      const UnitEstimate& u = p.units[unit];
      const bool differs = p.of && *p.of != Origin::kDesign && std::isfinite(u.sd);
      const double variance = p.effects.deviation * p.effects.deviation;
      own.push_back(differs ? variance / (variance + u.sd * u.sd) * (u.value - p.effects.mean)
                            : 0.0);
    }
  }
  return own;
}

/// What the parts' own adds to each row of the data; 0 in rows that are not simulated.
Eigen::VectorXd own_in_rows(const std::deque<SeriesUnit>& units, const FinalSeries& series,
                            std::size_t rows) {
  Eigen::VectorXd added = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(rows));
  for (std::size_t u = 0; u < units.size(); ++u) {
    const Hypothesis& own = series.units[u].hypothesis;
    Hypothesis common = own;
    const std::vector<double> part = own_part(series, u);
    bool any = false;
    for (std::size_t k = 0; k < part.size(); ++k) {
      common.value[k] -= part[k];
      any = any || part[k] != 0.0;
    }
    if (!any) continue;
    const Linearisation with_it = linearise(units[u].problem, own, {});
    const Linearisation without_it = linearise(units[u].problem, common, {});
    if (!with_it.runs || !without_it.runs) continue;
    const Eigen::VectorXd difference = with_it.simulated - without_it.simulated;
    for (std::size_t i = 0; i < units[u].place.size(); ++i) {
      added[static_cast<Eigen::Index>(units[u].place[i])] =
          difference[static_cast<Eigen::Index>(i)];
    }
  }
  return added;
}

/// Notes on what a series cannot tell.
void add_notes(const std::deque<SeriesUnit>& units, const MeasurementSet& data,
               const UnitSeries& series, std::vector<std::string>& notes) {
  std::vector<std::set<int>> runs(units.size());
  std::vector<int> gearboxes_of_run(data.runs.size(), 0);
  for (std::size_t u = 0; u < units.size(); ++u) {
    for (const std::size_t i : units[u].place) {
      const int run = data.rows[i].condition.run;
      if (run >= 0 && runs[u].insert(run).second) {
        ++gearboxes_of_run[static_cast<std::size_t>(run)];
      }
    }
  }
  const bool shared = std::ranges::any_of(gearboxes_of_run, [](int n) { return n > 1; });
  for (const SeriesCause& cause : series.causes) {
    const bool of_rig = cause.remedy == Remedy::kSensor || cause.remedy == Remedy::kProcedure;
    if (!of_rig) continue;
    notes.push_back(fmt::format(
        "series: {} belongs to the rig, not to a gearbox{}", cause.id,
        cause.of != Origin::kDesign && !shared
            ? ": each gearbox was measured in sessions of its own, so that what differs is the "
              "session's as well as the gearbox'"
            : ""));
  }
  const bool one_each =
      !shared && std::ranges::all_of(runs, [](const std::set<int>& own) { return own.size() < 2; });
  const bool differs = std::ranges::any_of(
      series.causes, [](const SeriesCause& c) { return c.of != Origin::kDesign; });
  if (one_each && differs) {
    notes.emplace_back(
        "series: each gearbox was measured in one session: what differs between sessions counts as "
        "the part's (measure one of them again, taken off and mounted anew)");
  }
  for (const SeriesCause& cause : series.causes) {
    for (const SeriesParameter& p : cause.parameters) {
      const auto bound = std::ranges::count(p.at_bound, true);
      if (bound == 0) continue;
      notes.push_back(
          fmt::format("series: {} {} is at a bound of its range in {} of {} gearboxes: "
                      "its deviation is understated",
                      cause.id, p.name, bound, p.units.size()));
    }
  }
  for (const SeriesMember& m : series.units) {
    if (!m.unexplained_along) continue;
    notes.push_back(fmt::format(
        "series: {} differs from the others{} by what no cause explains "
        "(p = {:.2g})",
        m.name,
        m.unexplained_along->empty() ? " alike in all its rows" : " along " + *m.unexplained_along,
        m.p_value));
  }
}

/// Whether a gearbox' own values differ from the simulation as given.
bool is_off(const FinalSeries& series, std::size_t unit) {
  constexpr double kDeviations = 3.0;
  return std::ranges::any_of(series.causes, [&](const SeriesCause& cause) {
    return std::ranges::any_of(cause.parameters, [&](const SeriesParameter& p) {
      return std::abs(p.units[unit].value) > kDeviations * p.units[unit].sd;
    });
  });
}

/// Causes of all gearboxes together, each with values of its own.
struct Study {
  FinalSeries final;
  double session_variance = 0.0;
};
Study studied(std::deque<SeriesUnit>& units, const Simulation& simulation,
              const MeasurementSet& data, const DiagnoseOptions& options) {
  const double rate = options.false_discovery_rate;
  const SearchOptions search_options{.rate = kSeriesCauseShare * rate, .seed = options.seed};
  const std::vector<Candidate> candidates = series_candidates(simulation, data);
  Study study;
  SeriesSearch search = search_series(units, candidates, search_options);
  study.session_variance = series_session_variance(units, search.fit);
  if (study.session_variance > 0.0) {
    for (SeriesUnit& unit : units) unit.problem.noise.session_variance = study.session_variance;
    search = search_series(units, candidates, search_options);
  }
  study.final = finished(units, search.fit, search.alternatives, kOriginShare * rate);
  return study;
}

UnitSeries series_of(const std::deque<SeriesUnit>& units, const Study& study,
                     const DiagnoseOptions& options) {
  const std::vector<UnitDifference> differences = unit_differences(
      units, study.final.joint, kDifferenceShare * options.false_discovery_rate, options.seed + 31);
  UnitSeries series{.units = {},
                    .causes = study.final.causes,
                    .session_ratio = std::sqrt(study.session_variance)};
  for (std::size_t u = 0; u < units.size(); ++u) {
    SeriesMember m{
        .name = units[u].name,
        .rows = units[u].data.rows.size(),
        .sessions = static_cast<int>(units[u].data.runs.size()),
        .verdict = is_off(study.final, u) ? Verdict::kExplained : Verdict::kNoDiscrepancy,
        .unexplained_along = differences[u].along,
        .p_value = differences[u].p_value};
    if (m.unexplained_along) m.verdict = Verdict::kUnexplained;
    series.units.push_back(std::move(m));
  }
  return series;
}

/// A set of causes for a series, and what each could be as well.
struct Explained {
  JointFit joint;
  std::vector<std::vector<std::string>> alternatives;  ///< by effect
};

/// What else each effect of a joint fit could be: what the search knows of those that were there
/// before; of others what the diagnosis says, and the causes that they took the place of.
std::vector<std::vector<std::string>> other_names(const JointFit& joint, const Diagnosis& d,
                                                  const FinalSeries& before) {
  std::vector<std::vector<std::string>> result;
  for (const Candidate& c : joint.effects) {
    const auto same = std::ranges::find(before.causes, c.cause->id, &SeriesCause::id);
    if (same != before.causes.end()) {
      result.push_back(same->alternatives);
      continue;
    }
    std::vector<std::string> ids;
    const auto add = [&](const std::string& id) {
      const bool stays = std::ranges::any_of(
          joint.effects, [&](const Candidate& other) { return other.cause->id == id; });
      if (!stays && std::ranges::find(ids, id) == ids.end()) ids.push_back(id);
    };
    for (const SeriesCause& cause : before.causes) {
      if (std::ranges::find(cause.alternatives, c.cause->id) == cause.alternatives.end()) continue;
      add(cause.id);
      for (const std::string& id : cause.alternatives) add(id);
    }
    for (const Effect& effect : d.effects) {
      if (effect.id != c.cause->id) continue;
      for (const Alternative& a : effect.alternatives) add(a.id);
    }
    result.push_back(std::move(ids));
  }
  return result;
}

/// The joint fit of a diagnosis' causes beside those that are the parts', where the series is
/// explained by them as well as by the search's own: the diagnosis' names count then.
std::optional<Explained> by_diagnosis(const std::deque<SeriesUnit>& units,
                                      const std::vector<Candidate>& all, const Diagnosis& d,
                                      const FinalSeries& now) {
  const JointStart at = start_at(now.joint);
  JointStart start = at;
  for (Hypothesis& h : start.hypothesis) h = {};
  std::vector<std::string> taken;
  for (const Effect& effect : d.effects) {
    const auto same = [&](const Candidate& c) {
      return c.cause->id == effect.id && c.form.name == effect.form.name &&
             c.form.body == effect.form.body && c.form.order == effect.form.order &&
             std::ranges::equal(c.form.constants, effect.form.constants, {}, &FormConstant::value,
                                &FormConstant::value);
    };
    const auto candidate = std::ranges::find_if(all, same);
    if (candidate == all.end() || effect.id == "run_step") continue;
    start = start_with(std::move(start), *candidate);
    taken.push_back(effect.id);
  }
  for (std::size_t e = 0; e < now.joint.effects.size(); ++e) {
    const bool differs = now.causes[e].of != Origin::kDesign;
    if (!differs || std::ranges::find(taken, now.causes[e].id) != taken.end()) continue;
    // A cause that a new one stands for would be counted twice.
    const bool replaced = std::ranges::any_of(now.causes[e].alternatives, [&](const auto& id) {
      return std::ranges::find(taken, id) != taken.end() &&
             std::ranges::find(now.causes, id, &SeriesCause::id) == now.causes.end();
    });
    if (replaced) continue;
    start = start_with(std::move(start), now.joint.effects[e]);
  }
  const Hypothesis& first = start.hypothesis.front();
  if (first.effects.empty() || first.value.size() > static_cast<std::size_t>(kMostParameters) ||
      same_forms(first, at.hypothesis.front())) {
    return std::nullopt;
  }
  const JointFit trial = joint_fit(units, start);
  const JointFit same_scale = joint_fit(units, at);
  if (!(trial.score < same_scale.score + kSeriesAsWell)) return std::nullopt;
  Explained result{.joint = needed(units, joint_fit(units, start_at(trial))), .alternatives = {}};
  if (result.joint.effects.empty() ||
      same_forms(result.joint.units.front().fit.hypothesis, at.hypothesis.front())) {
    return std::nullopt;
  }
  result.alternatives = other_names(result.joint, d, now);
  return result;
}

UnitSeries lone_unit(const SeriesUnit& unit, Verdict verdict) {
  UnitSeries series;
  series.units.push_back({.name = unit.name,
                          .rows = unit.data.rows.size(),
                          .sessions = static_cast<int>(unit.data.runs.size()),
                          .verdict = verdict});
  return series;
}

}  // namespace

std::vector<std::string> units_of_few_rows(const MeasurementSet& data) {
  std::vector<std::string> lines;
  const std::vector<std::string> names = unit_names(data);
  if (names.size() < 2) return lines;
  const std::vector<int> unit = units_of_rows(data);
  for (std::size_t u = 0; u < names.size(); ++u) {
    const auto rows = static_cast<std::size_t>(std::ranges::count(unit, static_cast<int>(u)));
    if (rows >= kFewestUnitRows) continue;
    std::vector<std::string> files;
    for (std::size_t f = 0; f < data.files.size(); ++f) {
      if (data.units[f] == names[u]) files.push_back(data.files[f]);
    }
    lines.push_back(
        fmt::format("{}: unit {} has {} row{} of {}, allowed: at least {} of each "
                    "gearbox of a series",
                    fmt::join(files, ", "), names[u], rows, rows == 1 ? "" : "s",
                    kKindNames[static_cast<std::size_t>(data.kind)], kFewestUnitRows));
  }
  return lines;
}

namespace {

/// The gearboxes of a series; each needs rows enough that the simulation runs at.
std::deque<SeriesUnit> checked_units(const Simulation& simulation, const MeasurementSet& data) {
  std::deque<SeriesUnit> units = series_units(simulation, data);
  if (units.size() < 2) return units;
  std::string few;
  for (const SeriesUnit& unit : units) {
    const std::size_t rows = unit.data.rows.size();
    if (rows >= kFewestUnitRows) continue;
    few += fmt::format("{}unit {} has {} row{} of {} that the simulation runs at",
                       few.empty() ? "" : ", ", unit.name, rows, rows == 1 ? "" : "s",
                       kKindNames[static_cast<std::size_t>(data.kind)]);
  }
  if (!few.empty()) {
    throw std::invalid_argument(
        fmt::format("{}, allowed: at least {} of each gearbox of a series", few, kFewestUnitRows));
  }
  return units;
}

MeasurementSet without_own(MeasurementSet data, const Eigen::VectorXd& own) {
  // The last digit is that of the readings.
  data.readings = Readings{.resolution = resolution_of(data), .commanded = is_commanded(data)};
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    data.rows[i].response -= own[static_cast<Eigen::Index>(i)];
  }
  return data;
}

/// Whether either makes another diagnosis: by a tenth of what rows scatter, in any of them.
bool differ(const Eigen::VectorXd& a, const Eigen::VectorXd& b,
            const std::vector<RowResult>& rows) {
  constexpr double kShare = 0.1;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (std::abs(a[k] - b[k]) > kShare * rows[i].sigma) return true;
  }
  return false;
}

/// Rows that were simulated.
MeasurementSet simulated_part(const MeasurementSet& data, const std::vector<RowResult>& rows) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (std::isfinite(rows[i].baseline)) places.push_back(i);
  }
  return select_rows(data, places);
}

/// Rows hold the parts' own again, and what the simulation as given misses is that of the data:
/// errors of the extended model are the same with the parts' own on both sides.
void add_own(Diagnosis& d, const MeasurementSet& data, const Eigen::VectorXd& own) {
  std::vector<double> off, off_then;  // of all rows, and of those with a prediction held out
  double held_squares = 0.0;
  double off_squares = 0.0;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    RowResult& row = d.rows[i];
    const double added = own[static_cast<Eigen::Index>(i)];
    row.extended += added;
    row.holdout += added;
    if (!std::isfinite(row.baseline)) continue;
    off.push_back(data.rows[i].response - row.baseline);
    if (!std::isfinite(row.holdout)) continue;
    off_then.push_back(off.back());
    off_squares += std::pow(off.back() / row.sigma, 2);
    held_squares += std::pow((data.rows[i].response - row.holdout) / row.sigma, 2);
  }
  const auto rms = [](const std::vector<double>& x) {
    return root_mean_square(
        Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())));
  };
  d.errors.baseline_train = rms(off);
  if (std::isfinite(d.errors.baseline_holdout)) d.errors.baseline_holdout = rms(off_then);
  if (std::isfinite(d.errors.weighted_gain)) {
    d.errors.weighted_gain = 1.0 - std::sqrt(held_squares / off_squares);
  }
  if (d.correction) {
    d.correction->held_out_gain = 1.0 - d.errors.extended_holdout / d.errors.baseline_holdout;
  }
  if (d.extrapolation.along.empty()) return;
  const std::vector<Levels> levels = covariate_levels(simulated_part(data, d.rows));
  const auto along = std::ranges::find(levels, d.extrapolation.along, &Levels::name);
  double squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; along != levels.end() && i < off.size(); ++i) {
    if (along->of[i] != along->count - 1) continue;
    squares += off[i] * off[i];
    ++count;
  }
  d.extrapolation.baseline = count > 0 ? std::sqrt(squares / count) : kUnknown;
}

}  // namespace

UnitSeries find_series(const Simulation& simulation, const MeasurementSet& data,
                       const DiagnoseOptions& options) {
  std::deque<SeriesUnit> units = checked_units(simulation, data);
  if (units.size() < 2) {
    throw std::invalid_argument(
        fmt::format("find_series: {} gearboxes, allowed: at least 2", units.size()));
  }
  return series_of(units, studied(units, simulation, data, options), options);
}

std::optional<Diagnosis> diagnose_series(const Simulation& simulation, const MeasurementSet& data,
                                         const DiagnoseOptions& options) {
  std::deque<SeriesUnit> units = checked_units(simulation, data);
  if (units.empty()) throw std::invalid_argument("diagnose: no row can be simulated");
  if (units.size() == 1) {
    std::optional<Diagnosis> d = diagnose(simulation, data, options);
    if (d) d->series = std::make_shared<UnitSeries>(lone_unit(units.front(), d->verdict));
    return d;
  }
  const auto tell = [&](double share) { return !options.progress || options.progress(share); };
  if (!tell(0.02)) return std::nullopt;

  Study study = studied(units, simulation, data, options);
  FinalSeries& final = study.final;
  if (!tell(0.5)) return std::nullopt;

  // All rows as gearboxes without anything of their own would have given them.
  Eigen::VectorXd own = own_in_rows(units, final, data.rows.size());
  DiagnoseOptions how = options;
  how.progress = [&](double share) { return tell(0.5 + 0.3 * share); };
  std::optional<Diagnosis> d = diagnose(simulation, without_own(data, own), how);
  if (!d) return std::nullopt;

  // Its laws may have a shape that the search for the series did not look through.
  if (auto other = by_diagnosis(units, candidates_for(simulation, data), *d, final)) {
    final = finished(units, std::move(other->joint), std::move(other->alternatives),
                     kOriginShare * options.false_discovery_rate);
    const Eigen::VectorXd of_others = own_in_rows(units, final, data.rows.size());
    if (differ(of_others, own, d->rows)) {
      own = of_others;
      how.progress = [&](double share) { return tell(0.8 + 0.15 * share); };
      d = diagnose(simulation, without_own(data, own), how);
      if (!d) return std::nullopt;
    }
  }
  const UnitSeries series = series_of(units, study, options);
  add_notes(units, data, series, d->notes);
  add_own(*d, data, own);
  std::vector<Eigen::MatrixXd> covariance;
  for (const FinalFit& fit : final.units) covariance.push_back(fit.covariance);
  d->model = series_model(final.causes, covariance, std::move(d->model));
  d->series = std::make_shared<UnitSeries>(series);
  if (!tell(1.0)) return std::nullopt;
  return d;
}

}  // namespace gear3k::calibrate
