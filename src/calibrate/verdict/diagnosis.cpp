#include "calibrate/verdict/diagnosis.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "calibrate/causes/angle_order.hpp"
#include "calibrate/fit/final_fit.hpp"
#include "calibrate/fit/holdout.hpp"
#include "calibrate/fit/row_friction.hpp"
#include "calibrate/laws/law_result.hpp"
#include "calibrate/model/model_range.hpp"
#include "calibrate/search/form_doubt.hpp"
#include "calibrate/search/noise_from_fit.hpp"
#include "calibrate/search/search.hpp"
#include "calibrate/search/search_with_noise.hpp"
#include "calibrate/search/stability.hpp"
#include "calibrate/verdict/correction.hpp"
#include "calibrate/verdict/experiment.hpp"
#include "calibrate/verdict/held_out.hpp"
#include "calibrate/verdict/left_behind.hpp"
#include "calibrate/verdict/noise_level.hpp"
#include "calibrate/verdict/posterior.hpp"
#include "calibrate/verdict/remainder.hpp"
#include "calibrate/verdict/rows_off.hpp"
#include "calibrate/verdict/session_conditions.hpp"
#include "calibrate/verdict/simulated_rows.hpp"
#include "calibrate/verdict/unexplained.hpp"

namespace gear3k::calibrate {

namespace {

/// Of the stated rate of false discoveries, what the search for causes and that for remainders get.
/// The rest is for second looks: weights, sessions and memory that chance gives the noise.
constexpr double kCauseShare = 0.55;
constexpr double kRemainderShare = 0.1;

std::vector<Alternative> alternatives_of(const Problem& problem,
                                         const std::vector<Replacement>& replacements,
                                         double scale) {
  std::vector<Alternative> result;
  result.reserve(replacements.size());
  for (const Replacement& r : replacements) {
    const FinalFit fit = final_fit(problem, r.fit.hypothesis, scale);
    const auto& effects = r.fit.hypothesis.effects;
    const auto at = static_cast<std::size_t>(
        std::ranges::find(effects, r.candidate.cause, &Candidate::cause) - effects.begin());
    result.push_back({.id = std::string(r.candidate.cause->id),
                      .title = std::string(r.candidate.cause->title),
                      .form = r.candidate.form,
                      .with_level = r.with_level,
                      .statistic = r.statistic,
                      .parameters = parameter_results(problem, fit, at),
                      .remedy = r.candidate.cause->remedy});
  }
  return result;
}

/// The effects of a final fit; `found` holds what the search knows of each.
std::vector<Effect> effects_of(const Problem& problem, const FinalFit& final,
                               const std::vector<FoundEffect>& found, const SearchResult& search,
                               const SearchOptions& options) {
  std::vector<Effect> effects;
  std::vector<std::vector<std::string_view>> groups;
  effects.reserve(found.size());
  groups.reserve(found.size());
  for (std::size_t e = 0; e < found.size(); ++e) {
    const Candidate& c = final.hypothesis.effects[e];
    effects.push_back(
        {.id = std::string(c.cause->id),
         .title = std::string(c.cause->title),
         .form = c.form,
         .remedy = c.cause->remedy,
         .parameters = parameter_results(problem, final, e),
         .alternatives = alternatives_of(problem, found[e].replacements, search.scale),
         .other_bodies = alternatives_of(problem, found[e].other_bodies, search.scale),
         .delta_bic = found[e].delta_bic,
         .p_value = found[e].p_value});
    Effect& effect = effects.back();
    effect.preferred_parameter =
        effect.remedy == Remedy::kFrictionValue && !effect.alternatives.empty();
    groups.push_back({effect.id});
    for (const Alternative& a : effect.alternatives) groups.back().push_back(a.id);
  }
  const auto frequency = inclusion_frequency(problem, search, groups, options);
  for (std::size_t e = 0; e < effects.size(); ++e) effects[e].inclusion_frequency = frequency[e];
  return effects;
}

/// Whether a parameter of an effect has a value that no gearbox shows.
bool is_implausible(const Effect& effect) {
  return std::ranges::any_of(effect.parameters,
                             [](const ParameterResult& p) { return !p.plausible; });
}

/// Whether an effect is how sessions differ: what is common to all is none.
bool is_of_sessions(const Effect& effect) { return effect.remedy == Remedy::kProcedure; }

/// Whether every session was measured at one load, speed, torque or direction of its own.  Of the
/// temperature, which is measured, the alternatives tell whether a law of it draws the same.
bool sessions_were_set_apart(const Diagnosis& d) {
  return std::ranges::any_of(d.conditions_by_session,
                             [](const std::string& name) { return name != "temperature"; });
}

Verdict verdict_of(const Diagnosis& d) {
  if (d.remainder.significant) return Verdict::kUnexplained;
  if (d.effects.empty()) return Verdict::kNoDiscrepancy;
  const bool ambiguous = std::ranges::any_of(d.effects, [&](const Effect& effect) {
    return effect.is_doubtful() || (is_of_sessions(effect) && sessions_were_set_apart(d)) ||
           std::ranges::any_of(effect.alternatives,
                               [&](const Alternative& a) { return a.remedy != effect.remedy; });
  });
  if (ambiguous) return Verdict::kAmbiguous;
  // A formula that fits with such values is no explanation.
  return std::ranges::any_of(d.effects, is_implausible) ? Verdict::kUnexplained
                                                        : Verdict::kExplained;
}

/// @param found  the effects that were found, with what explains as well
ExtendedModel model_of(const FinalFit& final, const Problem& problem,
                       const std::vector<Effect>& found) {
  const MeasurementSet& data = problem.data;
  ExtendedModel model;
  model.kind = data.kind;
  model.fingerprint = data.fingerprint;
  model.files = data.files;
  model.range = ranges_of(data);
  for (std::size_t e = 0; e < final.hypothesis.effects.size(); ++e) {
    const Candidate& c = final.hypothesis.effects[e];
    const auto values = values_of(final.hypothesis, e);
    if (is_law(c)) {
      model.laws.push_back(applied_law(law_of(c.form), values, data.rows));
      continue;
    }
    model.causes.push_back(
        {.id = std::string(c.cause->id), .form = c.form, .value = {values.begin(), values.end()}});
    if (const auto left = change_left_behind(problem, final.hypothesis, e, found)) {
      model.causes.back().left_behind = left->value;
      model.causes.back().left_behind_on = left->law;
    }
  }
  for (Eigen::Index i = 0; i < final.covariance.rows(); ++i) {
    for (Eigen::Index k = 0; k < final.covariance.cols(); ++k) {
      model.covariance.push_back(final.covariance(i, k));
    }
  }
  return model;
}

/// Measured rows and the simulation as given.
struct Baseline {
  Eigen::VectorXd measured, simulated;  ///< [SI]
  Eigen::VectorXd weighted;             ///< measured − simulated, weighted
};
Baseline baseline_of(const Problem& problem) {
  Baseline b{.measured = measured(problem.data),
             .simulated = linearise(problem, {}, {}).simulated,
             .weighted = {}};
  b.weighted = (b.measured - b.simulated).cwiseProduct(problem.noise.weight);
  return b;
}

/// Structure that no cause need explain, in what the simulation as given leaves and in what the
/// causes leave.
struct Remainders {
  Columns before, after;
  RemainderSearch of_baseline, of_fit;
  std::optional<std::string> level_off;  ///< said of rows far off that are the structure of the fit
};
Remainders search_remainders(const Problem& problem, const SearchResult& found,
                             const Baseline& baseline, const std::vector<Levels>& levels,
                             const DiagnoseOptions& options) {
  const double rate = kRemainderShare * options.false_discovery_rate;
  Remainders r{.before = columns_at(problem, {}, {}, problem.noise.deviation_of(baseline.weighted)),
               .after = columns_at(problem, found.fit.hypothesis, {}, found.scale),
               .of_baseline = {},
               .of_fit = {},
               .level_off = {}};
  r.of_baseline = search_remainder(problem, r.before, levels, rate, options.seed + 11);
  r.of_fit = found.effects.empty()
                 ? r.of_baseline
                 : search_remainder(problem, r.after, levels, rate, options.seed + 12);
  r.level_off =
      take_level_off(problem, found.effects.empty() ? r.before : r.after, levels, rate, r.of_fit);
  if (found.effects.empty()) r.of_baseline = r.of_fit;
  return r;
}

/// The effects that stand against structure without a cause.
struct StandingEffects {
  Hypothesis hypothesis;
  std::vector<FoundEffect> found;  ///< what the search knows of each
};
StandingEffects standing_effects(const SearchResult& search, const Contest& contest) {
  StandingEffects standing{.hypothesis = subset(search.fit.hypothesis, contest.stays), .found = {}};
  for (std::size_t e = 0; e < search.effects.size(); ++e) {
    if (contest.stays[e]) standing.found.push_back(search.effects[e]);
  }
  return standing;
}

/// Root mean squares; the noise floor is left to noise_level().
Errors errors_of(const Problem& problem, const Baseline& baseline, const FinalFit& final,
                 const HeldOut& held) {
  const Eigen::VectorXd& y = baseline.measured;
  Errors errors;
  errors.baseline_train = root_mean_square(y - baseline.simulated);
  errors.extended_train = root_mean_square(y - final.simulated);
  const std::vector<Eigen::Index> known = known_rows(held.predicted);
  if (held.blocks.count < 2 || known.empty()) return errors;
  const Eigen::VectorXd off = (y - baseline.simulated)(known),
                        off_held = (y - held.predicted)(known);
  errors.baseline_holdout = root_mean_square(off);
  errors.extended_holdout = root_mean_square(off_held);
  const Eigen::VectorXd weight = problem.noise.weight(known);
  if (!(weight.array() == weight[0]).all()) {
    errors.weighted_gain = 1.0 - root_mean_square(off_held.cwiseProduct(weight)) /
                                     root_mean_square(off.cwiseProduct(weight));
  }
  return errors;
}

/// Of all rows as given; those that were left out have no numbers.
/// @param whitened  residuals of the final fit; @param scale  their standard deviation
std::vector<RowResult> row_results(std::size_t count, const SimulatedRows& rows,
                                   const Problem& problem, const Baseline& baseline,
                                   const FinalFit& final, const HeldOut& held,
                                   const Eigen::VectorXd& whitened, double scale) {
  constexpr double kOutlier = 4.0;
  std::vector<RowResult> results(count);
  for (RowResult& row : results) row.baseline = row.extended = row.sigma = kUnknown;
  for (const auto& [place, value] : rows.wild) {
    results[place].baseline = value;
    results[place].outlier = true;
  }
  for (std::size_t i = 0; i < rows.place.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    results[rows.place[i]] = {.baseline = baseline.simulated[k],
                              .extended = final.simulated[k],
                              .sigma = scale / problem.noise.weight[k],
                              .holdout = held.predicted[k],
                              .block = held.blocks.of[i],
                              .outlier = std::abs(whitened[k]) > kOutlier * scale};
  }
  return results;
}

/// Structure that is left, and its shape where it follows a covariate.
Remainder remainder_of(const Problem& problem, const Contest& contest, const Hypothesis& effects,
                       double scale, const std::vector<Levels>& levels,
                       const Eigen::VectorXd& residual) {
  const EmpiricalTerm& term = contest.remainder.best;
  Remainder remainder;
  remainder.significant = contest.structure;
  remainder.p_value = contest.remainder.p_value;
  remainder.constant = contest.structure && term.along.empty() && term.columns.cols() > 0;
  if (contest.structure && !term.along.empty()) {
    describe_shape(problem, columns_at(problem, effects, {}, scale), term, levels, residual,
                   remainder);
  }
  return remainder;
}

std::string note_on_unknown_noise(std::size_t rows) {
  return fmt::format(
      "{} row{} without sigma or repeats: whether the simulation agrees within the noise is not "
      "known",
      rows, rows == 1 ? "" : "s");
}

/// Said where nothing tells in which order rows were read that could show how noise remembers.
void tell_unknown_order(const Problem& problem, std::vector<std::string>& notes) {
  const MeasurementSet& data = problem.data;
  if (problem.noise.order.known() || data.kind == Kind::kTorqueAngle ||
      data.rows.size() < kFewestRememberingRows) {
    return;
  }
  notes.push_back(
      fmt::format("the lines are sorted by {} and not all rows state time_s or cycles: their order "
                  "says nothing "
                  "of time, and readings are taken as independent",
                  lines_sorted_by(data)));
}

std::string note_on_orders(double highest) {
  return fmt::format(
      "orders of the angle above {:.4g} per turn of the output were not looked through: too many "
      "rows and turns; run-outs and mesh orders were tested all the same",
      highest);
}

/// What a prediction that is no finding is made of, beside the fit.
struct Measured {
  const Problem& problem;
  const std::vector<Levels>& levels;
  const SimulatedRows& rows;
  const Baseline& baseline;
  const PureError& pure;
};

/// Errors, rows and model become those of another fit than that of the causes found.
void predict_by(Diagnosis& d, const Measured& m, const FinalFit& final, const HeldOut& held) {
  const Problem& problem = m.problem;
  const double typical_weight = 1.0 / root_mean_square(problem.noise.weight.cwiseInverse());
  const NoiseLevel noise =
      noise_level(problem.noise, m.pure, final.scale, d.noise_source == NoiseSource::kStated);
  // What few rows do not tell they do not tell by another fit.
  const bool known = std::isfinite(d.errors.noise_floor);
  d.errors = errors_of(problem, m.baseline, final, held);
  d.errors.noise_floor = known ? noise.scale / typical_weight : kUnknown;
  d.noise_source = noise.source;
  d.extrapolation =
      extrapolate(problem, final.hypothesis, m.levels, m.baseline.measured, m.baseline.simulated);
  Eigen::MatrixXd whitened = m.baseline.measured - final.simulated;
  problem.noise.whiten(whitened);
  d.rows =
      row_results(d.rows.size(), m.rows, problem, m.baseline, final, held, whitened, final.scale);
  d.model = model_of(final, problem, d.effects);
}

/// What predicts against the refit of one parameter.
std::optional<RefitContest> contest_of(Diagnosis& d, const Measured& m, const Hypothesis& found,
                                       const std::vector<Candidate>& candidates, double scale) {
  auto contest = contest_with_refit(m.problem, found, candidates, m.levels, scale);
  // Rows at a level that alone shows a law say nothing against it.
  const bool of_law =
      std::ranges::any_of(found.effects, [](const Candidate& c) { return is_law(c); });
  d.refit.reset();
  if (contest) {
    d.refit = {.id = std::string(contest->refit.fit.hypothesis.effects.front().cause->id),
               .refit_error = contest->refit_error,
               .found_error = contest->error,
               .predicts = of_law ? contest->refit_is_better() : contest->refit_is_safer()};
  }
  return contest;
}

/// Looks for a law in what is left and, where there is one that predicts better than one refitted
/// parameter, fits and predicts with it.  Where no structure was found yet, it tells of some.
void add_law(Diagnosis& d, const Measured& m, const Hypothesis& causes, const Blocks& blocks,
             const std::vector<Candidate>& candidates, double false_discovery_rate) {
  const Problem& problem = m.problem;
  const bool structure = d.remainder.significant;
  const std::optional<FoundLaw> law =
      find_law(problem, causes, blocks, structure ? LawScope::kEveryForm : LawScope::kPlain,
               candidates.size(), false_discovery_rate);
  if (!law) return;
  const auto contest = contest_of(d, m, law->hypothesis, candidates, law->scale);
  if (contest && contest->refit_is_better()) return;
  // A formula that runs away without some rows is worse than none.
  const Eigen::VectorXd& y = m.baseline.measured;
  if (root_mean_square(y - law->predicted) > root_mean_square(y - m.baseline.simulated)) return;
  const FinalFit final = final_fit(problem, law->hypothesis, law->scale);
  if (!has_amplitude(problem, final)) {
    d.refit.reset();
    return;
  }
  const double error_without = d.errors.extended_holdout;
  predict_by(d, m, final, {.blocks = blocks, .predicted = law->predicted});
  // The law does better without some, and with them goes what would tell them apart.
  const std::size_t before = d.effects.size();
  std::erase_if(d.effects, [&](const Effect& effect) {
    return std::ranges::none_of(law->hypothesis.effects, [&](const Candidate& c) {
      return c.cause->id == effect.id && c.form.name == effect.form.name &&
             c.form.body == effect.form.body && c.form.order == effect.form.order;
    });
  });
  if (d.effects.size() < before) d.next_experiment.reset();
  for (std::size_t e = 0; e < d.effects.size(); ++e) {
    d.effects[e].parameters = parameter_results(problem, final, e);
  }
  d.laws.push_back(law_result(problem, *law, final, error_without, d.errors.extended_holdout));
  if (structure) return;
  // What was too little to matter is what the law tells of.
  std::erase_if(d.notes, tells_of_minor_remainder);
  d.remainder = structure_of(problem, *law, m.levels);
  d.p_value = std::min(d.p_value, d.remainder.p_value);
  set_posteriors(d.effects, true);
  d.verdict = verdict_of(d);
}

/// The noise, of a row of typical weight.
/// @param is_known  whether the rows say it
void tell_noise(Diagnosis& d, const Problem& problem, const NoiseLevel& noise,
                const SessionScatter& sessions, double row_scale, bool is_known) {
  const double typical_weight = 1.0 / root_mean_square(problem.noise.weight.cwiseInverse());
  d.noise_source = noise.source;
  d.errors.noise_floor = noise.scale / typical_weight;
  d.session_deviation = std::sqrt(sessions.estimate) * row_scale / typical_weight;
  if (problem.noise.source == NoiseSource::kStated) {
    d.stated_noise = 1.0 / typical_weight;
    if (noise.source != NoiseSource::kStated) d.notes.push_back(note_on_stated_level(noise.scale));
  }
  if (is_known || !d.effects.empty()) return;
  d.errors.noise_floor = kUnknown;
  d.notes.push_back(note_on_unknown_noise(problem.data.rows.size()));
}

/// Predicts by a cause as a formula, where nothing explains or what does predicts no better.
void add_correction(Diagnosis& d, const Measured& m, const std::optional<FoundCorrection>& found,
                    const Blocks& blocks, double scale) {
  const Problem& problem = m.problem;
  if (!found) return;
  const FinalFit final = final_fit(problem, found->fit.hypothesis, scale);
  predict_by(d, m, final, {.blocks = blocks, .predicted = found->predicted});
  for (AppliedCause& cause : d.model.causes) cause.empirical = true;
  const Candidate& c = final.hypothesis.effects.front();
  d.correction = {.id = std::string(c.cause->id),
                  .form = c.form,
                  .parameters = parameter_results(problem, final, 0),
                  .held_out_error = d.errors.extended_holdout,
                  .held_out_gain = 1.0 - d.errors.extended_holdout / d.errors.baseline_holdout};
}

/// Where no law is given: by the causes, else where structure is left by a correction, and by the
/// refit of one parameter where that predicts better; where nothing is found by the simulation as
/// given.
void predict_at_least_as_refit(Diagnosis& d, const Measured& m, const Hypothesis& causes,
                               const SearchResult& found, const Blocks& blocks, double row_scale) {
  std::optional<FoundCorrection> formula;
  double scale = row_scale;
  if (causes.effects.empty() && d.remainder.significant) {
    scale = found.scale;
    formula = find_correction(m.problem, found.candidates, blocks, scale);
  }
  const auto contest =
      contest_of(d, m, formula ? formula->fit.hypothesis : causes, found.candidates, scale);
  const bool nothing_found = causes.effects.empty() && !d.remainder.significant;
  if (contest && nothing_found) {
    // Luck makes one parameter better than none in every third campaign: a simulation that is found
    // to agree stays as it is.
    d.refit->predicts = false;
  }
  if (d.refit && d.refit->predicts) formula = contest->refit;
  add_correction(d, m, formula, blocks, scale);
}

/// Said of errors held out that are of some rows only.
void tell_known_rows(Diagnosis& d) {
  std::size_t known = 0, simulated = 0;
  for (const RowResult& row : d.rows) {
    if (!std::isfinite(row.extended)) continue;
    ++simulated;
    if (std::isfinite(row.holdout)) ++known;
  }
  if (std::isfinite(d.errors.extended_holdout) && known < simulated) {
    d.notes.push_back(note_on_known_rows(known, simulated));
  }
}

/// What the extended model misses at the means of repeats against their scatter.
/// @param place  of each row of the problem among those of the diagnosis
LackOfFit lack_of_model(const Problem& problem, const Repeats& repeats, const Diagnosis& d,
                        const std::vector<std::size_t>& place) {
  const auto parameters = static_cast<int>(parameter_count(d.model));
  if (parameters == 0) return {};
  Eigen::VectorXd missed = measured(problem.data);
  for (std::size_t i = 0; i < place.size(); ++i) {
    missed[static_cast<Eigen::Index>(i)] -= d.rows[place[i]].extended;
  }
  return lack_of_fit(repeats, missed.cwiseProduct(problem.noise.weight), parameters);
}

}  // namespace

std::optional<Diagnosis> diagnose_as_read(const Simulation& simulation,
                                          const MeasurementSet& all_data,
                                          const DiagnoseOptions& options) {
  bool goes_on = true;
  const std::function<bool(double)> tell = [&](double share) {
    goes_on = goes_on && (!options.progress || options.progress(share));
    return goes_on;
  };
  Diagnosis d;
  d.kind = all_data.kind;
  const SimulatedRows rows = simulated_rows(simulation, all_data, d.notes);
  const MeasurementSet& data = rows.data;
  if (data.rows.empty()) throw std::invalid_argument("diagnose: no row can be simulated");
  d.runs = data.runs;
  Problem problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
  const std::vector<Levels> levels = covariate_levels(data);
  if (!tell(0.05)) return std::nullopt;

  // Sets of causes that explain the discrepancy.
  const SearchOptions search_options{.rate = kCauseShare * options.false_discovery_rate,
                                     .seed = options.seed};
  SessionScatter sessions;
  const std::vector<Candidate> all_candidates = candidates_for(simulation, data);
  add_note_on_shafts(simulation.occasion(data), d.notes);
  const SearchResult found =
      search_with_noise(problem, all_candidates, search_options, tell, sessions, d.memory, d.notes);
  if (!tell(0.6)) return std::nullopt;

  // What repeats say of the simulation as given, and structure without a cause.
  const Baseline baseline = baseline_of(problem);
  const Repeats repeats = find_repeats(data);
  const PureError pure = pure_error(repeats, baseline.weighted);
  d.repeat_degrees = pure.degrees;
  d.lack_of_fit = lack_of_fit(repeats, baseline.weighted);
  const Remainders left = search_remainders(problem, found, baseline, levels, options);
  if (!tell(0.8)) return std::nullopt;
  d.covariates_before = left.of_baseline.tests;
  d.covariates_after = left.of_fit.tests;
  d.periodogram = left.of_fit.periodogram;
  d.p_value = std::min(found.first_p, left.of_baseline.p_value);
  d.evidence = first_evidence(found);

  // A cause stands where structure without one does not explain clearly more.
  const double remainder_rate = kRemainderShare * options.false_discovery_rate;
  Contest contest = causes_against_structure(found, left.before, left.after, left.of_baseline,
                                             left.of_fit, remainder_rate);
  const StandingEffects standing = standing_effects(found, contest);
  FinalFit final = final_fit(problem, standing.hypothesis, found.scale);
  widen_by_forms(problem, all_candidates, found.scale, final);
  d.effects = effects_of(problem, final, standing.found, found, search_options);

  // Errors, held out and beyond.
  const HeldOut held = held_out_rows(problem, standing.hypothesis, levels);
  d.errors = errors_of(problem, baseline, final, held);
  d.holdout_blocks = held.blocks.name;
  if (held.blocks.name.empty()) d.notes.push_back(note_on_levels_in_sample());
  d.extrapolation =
      extrapolate(problem, standing.hypothesis, levels, baseline.measured, baseline.simulated);

  const double row_scale = final.scale > 0.0 ? final.scale : found.scale;
  tell_unknown_order(problem, d.notes);
  if (left.of_fit.highest_order > 0.0) d.notes.push_back(note_on_orders(left.of_fit.highest_order));
  Eigen::MatrixXd whitened = baseline.measured - final.simulated;
  problem.noise.whiten(whitened);
  const Eigen::VectorXd whitened_left = whitened.col(0);
  d.rows =
      row_results(all_data.rows.size(), rows, problem, baseline, final, held, whitened, row_scale);

  // The verdict, and what would tell more.
  const LeftOver left_over{
      .whitened = whitened_left,
      .degrees = final.degrees,
      .scale = row_scale,
      .missed = mean_square_as_read(problem.noise, baseline.measured - baseline.simulated),
      .missed_by_effects = mean_square_as_read(problem.noise, baseline.measured - final.simulated),
      .noise = row_scale * row_scale * (1.0 + sessions.guarded),
      .of_time_alone = std::ranges::all_of(
          d.effects, [](const Effect& e) { return e.remedy == Remedy::kProcedure; })};
  const std::optional<std::string> minor = settle(contest, problem.noise, left_over, left.before,
                                                  remainder_rate, !standing.found.empty());
  if (minor) d.notes.push_back(*minor);
  // Those that were left out are none of these rows.
  const auto off = static_cast<std::size_t>(std::ranges::count_if(d.rows, &RowResult::outlier)) -
                   rows.wild.size();
  if (const double chance = chance_of_outliers(off, data.rows.size());
      !contest.structure && standing.found.empty() && chance <= remainder_rate) {
    contest = {.structure = true, .stays = {}, .remainder = {}};
    contest.remainder.p_value = chance;
  }
  const bool has_structure = contest.structure || minor;
  const NoiseLevel noise = noise_level(problem.noise, pure, row_scale,
                                       stated_level_holds(problem.noise, left_over, has_structure));
  tell_noise(d, problem, noise, sessions, row_scale, noise_is_known(noise.source, final));
  d.remainder = remainder_of(problem, contest, standing.hypothesis, found.scale, levels,
                             baseline.measured - final.simulated);
  d.remainder.minor = minor.has_value();
  if (left.level_off && contest.structure) d.notes.push_back(*left.level_off);
  set_posteriors(d.effects, contest.structure);
  if (std::ranges::any_of(d.effects, is_of_sessions)) {
    for (const Levels& condition : conditions_by_session(data, levels)) {
      d.conditions_by_session.push_back(condition.name);
      d.notes.push_back(note_on_sessions(condition));
    }
  }
  d.verdict = verdict_of(d);
  d.next_experiment = next_experiment(problem, standing.hypothesis, standing.found, d.effects,
                                      found.scale, noise.scale, options);
  d.model = model_of(final, problem, d.effects);
  const Measured all{
      .problem = problem, .levels = levels, .rows = rows, .baseline = baseline, .pure = pure};
  // Loops have noise in common, which looks like a law too easily.
  const bool predicts = !held.blocks.name.empty();
  if (predicts && (d.remainder.significant || data.kind != Kind::kTorqueAngle)) {
    add_law(d, all, standing.hypothesis, held.blocks, found.candidates,
            options.false_discovery_rate);
  }
  if (d.laws.empty()) {
    predict_at_least_as_refit(d, all, standing.hypothesis, found, held.blocks, row_scale);
  }
  tell_known_rows(d);
  d.lack_of_model = lack_of_model(problem, repeats, d, rows.place);
  d.notes.insert(d.notes.begin(), data.notes.begin(), data.notes.end());
  if (!tell(1.0)) return std::nullopt;
  return d;
}

}  // namespace gear3k::calibrate
