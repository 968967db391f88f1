#include "calibrate/diagnosis.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include "calibrate/experiment.hpp"
#include "calibrate/holdout.hpp"
#include "calibrate/remainder.hpp"
#include "calibrate/response_unit.hpp"
#include "calibrate/search.hpp"

namespace gear3k::calibrate {

namespace {

/// Of the stated rate of false discoveries, what the search for causes and that for remainders get.
constexpr double kCauseShare = 0.85;
constexpr double kRemainderShare = 0.15;

double root_mean_square(const Eigen::VectorXd& x) {
  return x.size() == 0 ? 0.0 : std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
}

double f_tail(double f, int degrees1, int degrees2) {
  if (!(f > 0.0) || degrees1 < 1 || degrees2 < 1) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(degrees1, degrees2), f));
}

/// Factor of a standard deviation for a 95 % interval.
double interval_factor(int degrees) {
  constexpr double kNormal = 1.959963984540054;
  if (degrees < 1) return kNormal;
  return boost::math::quantile(boost::math::students_t(degrees), 0.975);
}

/// Rows that the baseline simulates; the others are left out and named.
MeasurementSet simulated_rows(const Simulation& simulation, const MeasurementSet& data,
                              std::vector<std::string>& notes, std::vector<std::size_t>& kept) {
  MeasurementSet result = data;
  result.rows.clear();
  std::vector<int> lines;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const Condition& c = data.rows[i].condition;
    if (simulation.response(c, simulation.unmodified(c))) {
      result.rows.push_back(data.rows[i]);
      kept.push_back(i);
    } else {
      lines.push_back(data.rows[i].line);
    }
  }
  if (kept.size() != data.rows.size()) {
    for (Covariate& c : result.covariates) {
      std::vector<double> values;
      values.reserve(kept.size());
      for (const std::size_t i : kept) values.push_back(c.value[i]);
      c.value = std::move(values);
    }
    notes.push_back(fmt::format(
        "{} of {} rows are left out, as the simulation does not run there (the first in line {})",
        lines.size(), data.rows.size(), lines.front()));
  }
  return result;
}

/// Weights rows by a power of the simulated response where the scatter about the fit clearly
/// follows it; a stated σ is left as it is.
bool weigh_by_response(Problem& problem, const SearchResult& found) {
  if (problem.noise.source == NoiseSource::kStated) return false;
  const Eigen::VectorXd simulated = found.fit.simulated.cwiseAbs();
  const double middle = simulated.mean();
  constexpr double kLeast = 0.05;
  const Eigen::VectorXd size = (simulated / middle).cwiseMax(kLeast);
  const Eigen::VectorXd residual = winsorised(found.fit.residual, found.scale);
  const auto n = static_cast<double>(residual.size());
  const auto likelihood = [&](double power) {
    const Eigen::VectorXd weight = size.array().pow(-power);
    return weight.array().log().sum() -
           0.5 * n * std::log(residual.cwiseProduct(weight).squaredNorm() / n);
  };
  double best = 0.0;
  for (const double power : {0.5, 1.0}) {
    if (likelihood(power) > likelihood(best)) best = power;
  }
  constexpr double kClearly = 4.0;
  if (likelihood(best) < likelihood(0.0) + kClearly) return false;
  problem.noise.weight = size.array().pow(-best);
  return true;
}

/// Scatter between sessions over that of rows, where it is more than chance and no step.
double session_variance(const Problem& problem, const SearchResult& found) {
  constexpr int kFewestRuns = 4;
  const NoiseModel& noise = problem.noise;
  if (noise.runs < kFewestRuns) return 0.0;
  Hypothesis h;
  std::size_t first = 0;
  for (const Candidate& c : found.fit.hypothesis.effects) {
    const std::size_t count = c.parameters.size();
    if (c.cause->id != "run_step" && c.cause->id != "drift") {
      h.effects.push_back(c);
      const auto at = found.fit.hypothesis.value.begin() + static_cast<std::ptrdiff_t>(first);
      h.value.insert(h.value.end(), at, at + static_cast<std::ptrdiff_t>(count));
    }
    first += count;
  }
  std::vector<Candidate> steps;
  for (const Candidate& c : found.candidates) {
    if (c.cause->id == "run_step" || c.cause->id == "drift") steps.push_back(c);
  }
  const Columns columns = columns_at(problem, h, steps, found.scale);
  const Screen screen(columns.own, columns.other, blocks_of(steps), 0.0);
  const auto gains = screen.gains(columns.residual);
  const auto best = std::ranges::max_element(gains, {}, &Gain::sum_of_squares) - gains.begin();
  const Block& block = screen.blocks()[static_cast<std::size_t>(best)];
  Eigen::MatrixXd own(columns.own.rows(), columns.own.cols() + block.count);
  own << columns.own, columns.other.middleCols(block.first, block.count);
  const Eigen::MatrixXd basis = orthonormal_basis(own);
  const Eigen::VectorXd left = columns.residual - basis * (basis.transpose() * columns.residual);
  Eigen::MatrixXd sessions = Eigen::MatrixXd::Zero(left.size(), noise.runs);
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    const int r = noise.run[static_cast<std::size_t>(i)];
    if (r >= 0) sessions(i, r) = 1.0;
  }
  sessions -= basis * (basis.transpose() * sessions);
  const Eigen::MatrixXd session_basis = orthonormal_basis(sessions);
  const auto degrees = static_cast<int>(session_basis.cols());
  const auto rest = static_cast<int>(left.size() - basis.cols() - session_basis.cols());
  if (degrees < 1 || rest < 4) return 0.0;
  const double between = (session_basis.transpose() * left).squaredNorm();
  const double within = (left.squaredNorm() - between) / rest;
  const double f = between / degrees / within;
  // A few sessions that scatter are hardly told from one step; with more of them it is the rule
  // that they do, until the data say otherwise.
  constexpr double kChance = 0.01;
  constexpr int kSeveralRuns = 5;
  if (noise.runs < kSeveralRuns && f_tail(f, degrees, rest) > kChance) return 0.0;
  // The twentieth of values that chance makes smallest is guarded against: few sessions say little
  // of how much sessions scatter.
  const double guard =
      boost::math::quantile(boost::math::complement(boost::math::fisher_f(rest, degrees), 0.05));
  const double rows = static_cast<double>(left.size()) / noise.runs;
  return std::max(0.0, (f * std::max(1.0, guard) - 1.0) / rows);
}

ParameterResult parameter_result(const ParameterRecord& record, double value, double deviation,
                                 double factor, bool at_bound) {
  return {.name = std::string(record.name),
          .unit = std::string(record.unit),
          .value = value,
          .low = value - factor * deviation,
          .high = value + factor * deviation,
          .at_bound = at_bound,
          .plausible = value >= record.plausible_low && value <= record.plausible_high,
          .plausible_low = record.plausible_low,
          .plausible_high = record.plausible_high};
}

/// Friction at the slowest over that at the fastest sliding speed of the data: what the forms of
/// the law have in common.
ParameterResult slow_over_fast(const Candidate& effect, const Eigen::VectorXd& value,
                               const Eigen::MatrixXd& covariance, double factor) {
  std::vector<Scalar> p;
  for (Eigen::Index k = 0; k < value.size(); ++k) p.emplace_back(value[k], static_cast<int>(k));
  Modification m;
  effect.cause->apply(effect.form, p, {}, Kind::kTransmission, m);
  const auto friction = [&](const char* speed) {
    return friction_factor(m.gearbox.friction, Scalar(1.0), Scalar(effect.form.constant(speed)),
                           Scalar(m.gearbox.friction.reference_temperature_K), true);
  };
  const Scalar ratio = friction("slowest") / friction("fastest");
  const Eigen::VectorXd slope = ratio.v.head(value.size());
  const double deviation = std::sqrt(std::max(0.0, slope.dot(covariance * slope)));
  return {.name = "slow_over_fast",
          .unit = "",
          .value = ratio.a,
          .low = ratio.a - factor * deviation,
          .high = ratio.a + factor * deviation,
          .plausible_low = 0.0,
          .plausible_high = HUGE_VAL,
          .derived = true};
}

/// Friction on either side of the pitch point that all causes of a fit make together.
std::vector<ParameterResult> flank_coefficients(const Simulation& simulation, const FinalFit& fit,
                                                double factor) {
  const auto& value = fit.hypothesis.value;
  std::vector<Scalar> p;
  p.reserve(value.size());
  for (std::size_t k = 0; k < value.size(); ++k) p.emplace_back(value[k], static_cast<int>(k));
  Modification m = simulation.unmodified({});
  std::size_t first = 0;
  for (const Candidate& c : fit.hypothesis.effects) {
    c.cause->apply(c.form, std::span(p).subspan(first, c.parameters.size()), {}, Kind::kPairLoss,
                   m);
    first += c.parameters.size();
  }
  const auto coefficients = simulation.flank_coefficients(m);
  // Clean metals without lubricant reach about 1; friction below 0 would drive.
  constexpr ParameterRecord kPlausible{.name = "",
                                       .unit = "",
                                       .lower = -HUGE_VAL,
                                       .upper = HUGE_VAL,
                                       .plausible_low = 0.0,
                                       .plausible_high = 1.0};
  std::vector<ParameterResult> result;
  for (const std::size_t side : {0U, 1U}) {
    const Eigen::VectorXd slope =
        coefficients[side].v.head(static_cast<Eigen::Index>(value.size()));
    const double deviation = std::sqrt(std::max(0.0, slope.dot(fit.covariance * slope)));
    result.push_back(parameter_result(kPlausible, coefficients[side].a, deviation, factor, false));
    result.back().name = side == 0 ? "friction_in_approach" : "friction_in_recess";
    result.back().derived = true;
  }
  return result;
}

/// Parameters of one effect of a fit, and what is derived from them: of a wave its amplitude.
std::vector<ParameterResult> effect_parameters(const Simulation& simulation, const FinalFit& fit,
                                               std::size_t effect) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < effect; ++k) {
    first += fit.hypothesis.effects[k].parameters.size();
  }
  const auto& records = fit.hypothesis.effects[effect].parameters;
  const double factor = interval_factor(fit.degrees);
  std::vector<ParameterResult> result;
  for (std::size_t k = 0; k < records.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(first + k);
    result.push_back(parameter_result(records[k], fit.hypothesis.value[first + k],
                                      std::sqrt(std::max(0.0, fit.covariance(at, at))), factor,
                                      fit.at_bound[first + k]));
  }
  if (records.size() == 2 && records[0].name == "cosine") {
    const double a = fit.hypothesis.value[first];
    const double b = fit.hypothesis.value[first + 1];
    const double amplitude = std::hypot(a, b);
    const auto at = static_cast<Eigen::Index>(first);
    const Eigen::Vector2d slope(a / amplitude, b / amplitude);
    const double variance = slope.dot(fit.covariance.block(at, at, 2, 2) * slope);
    ParameterResult derived =
        parameter_result(records[0], amplitude, std::sqrt(std::max(0.0, variance)), factor, false);
    derived.name = "amplitude";
    derived.derived = true;
    result.insert(result.begin(), derived);
  }
  const Candidate& own = fit.hypothesis.effects[effect];
  if (own.cause->id == "friction_direction" && simulation.kind() == Kind::kPairLoss) {
    for (ParameterResult& p : flank_coefficients(simulation, fit, factor)) {
      result.push_back(std::move(p));
    }
  }
  if (own.cause->id == "friction_speed") {
    const auto at = static_cast<Eigen::Index>(first);
    const auto count = static_cast<Eigen::Index>(records.size());
    const Eigen::VectorXd value =
        Eigen::Map<const Eigen::VectorXd>(fit.hypothesis.value.data(),
                                          static_cast<Eigen::Index>(fit.hypothesis.value.size()))
            .segment(at, count);
    result.push_back(
        slow_over_fast(own, value, fit.covariance.block(at, at, count, count), factor));
  }
  return result;
}

/// Whether the data need an effect once the best empirical term is there.
bool needed_beside(const Problem& problem, const Hypothesis& h, std::size_t effect,
                   const EmpiricalTerm& term, double scale, double threshold) {
  const Columns columns = columns_at(problem, h, {}, scale);
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < effect; ++k) {
    first += static_cast<Eigen::Index>(h.effects[k].parameters.size());
  }
  const auto count = static_cast<Eigen::Index>(h.effects[effect].parameters.size());
  const Eigen::MatrixXd mine = columns.own.middleCols(first, count);
  Eigen::MatrixXd rest(columns.own.rows(), columns.own.cols() - count + term.columns.cols());
  rest << columns.own.leftCols(first), columns.own.rightCols(columns.own.cols() - first - count),
      term.columns;
  // The residual of the model without the effect, along the linearisation.
  Eigen::VectorXd without = columns.residual;
  for (Eigen::Index k = 0; k < count; ++k) {
    without += mine.col(k) * h.value[static_cast<std::size_t>(first + k)];
  }
  const Screen screen(rest, mine, {{.first = 0, .count = count}}, 0.0);
  return screen.gains(without)[0].evidence > threshold;
}

/// Mean residual and term by level, in SI.
void shape_of(const Problem& problem, const Columns& columns, const EmpiricalTerm& term,
              const std::vector<Levels>& levels, const Eigen::VectorXd& residual,
              Remainder& remainder) {
  const Eigen::MatrixXd basis = orthonormal_basis(term.columns);
  Eigen::VectorXd fitted = basis * (basis.transpose() * columns.residual);
  remainder.share = fitted.squaredNorm() / columns.residual.squaredNorm();
  fitted = fitted.cwiseQuotient(problem.noise.weight);
  const auto n = static_cast<std::size_t>(residual.size());
  Levels by;
  if (term.order > 0.0) {
    constexpr int kSectors = 12;
    by = {.name = term.along, .of = std::vector<int>(n, -1), .count = kSectors};
    for (int k = 0; k < kSectors; ++k) by.at.push_back(360.0 * (k + 0.5) / kSectors);
    double start = HUGE_VAL;
    double end = -HUGE_VAL;
    for (const Observation& row : problem.data.rows) {
      start = std::min(start, row.condition.time_s);
      end = std::max(end, row.condition.time_s);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Condition& c = problem.data.rows[i].condition;
      const double turn = term.along == "time"
                              ? term.order * (c.time_s - start) / (end - start)
                              : term.order * c.output_angle_rad / (2.0 * std::numbers::pi);
      if (std::isfinite(turn)) {
        by.of[i] = std::min(static_cast<int>((turn - std::floor(turn)) * kSectors), kSectors - 1);
      }
    }
  } else {
    const auto found = std::ranges::find(levels, term.along, &Levels::name);
    if (found == levels.end()) return;
    by = *found;
  }
  const auto count = static_cast<std::size_t>(by.count);
  remainder.at = by.at;
  remainder.mean.assign(count, 0.0);
  remainder.term.assign(count, 0.0);
  remainder.rows.assign(count, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (by.of[i] < 0) continue;
    const auto level = static_cast<std::size_t>(by.of[i]);
    remainder.mean[level] += residual[static_cast<Eigen::Index>(i)];
    remainder.term[level] += fitted[static_cast<Eigen::Index>(i)];
    ++remainder.rows[level];
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (remainder.rows[k] == 0) continue;
    remainder.mean[k] /= remainder.rows[k];
    remainder.term[k] /= remainder.rows[k];
  }
}

Extrapolation extrapolate(const Problem& problem, const Hypothesis& h,
                          const std::vector<Levels>& levels, const Eigen::VectorXd& y,
                          const Eigen::VectorXd& baseline) {
  Extrapolation result;
  for (const char* name : {"load", "speed", "test torque"}) {
    const auto at = std::ranges::find(levels, name, &Levels::name);
    if (at == levels.end() || at->count < 3) continue;
    Blocks blocks{.name = name, .of = {}, .count = 2};
    for (const int level : at->of) blocks.of.push_back(level == at->count - 1 ? 1 : 0);
    const Eigen::VectorXd predicted = predict_held_out(problem, h, blocks);
    double before = 0.0;
    double after = 0.0;
    for (std::size_t i = 0; i < blocks.of.size(); ++i) {
      if (blocks.of[i] == 0) continue;
      const auto k = static_cast<Eigen::Index>(i);
      before += (y[k] - baseline[k]) * (y[k] - baseline[k]);
      after += (y[k] - predicted[k]) * (y[k] - predicted[k]);
      ++result.rows;
    }
    result.along = name;
    result.left_out = at->at.back();
    result.baseline = std::sqrt(before / result.rows);
    result.extended = std::sqrt(after / result.rows);
    return result;
  }
  return result;
}

std::vector<ConditionRange> ranges_of(const MeasurementSet& data) {
  constexpr double kRpm = std::numbers::pi / 30.0;
  constexpr double kCelsius = 273.15;
  std::vector<ConditionRange> result;
  const auto add = [&](const char* name, const char* unit, double Condition::*member,
                       double per_unit, double offset) {
    double low = kUnknown;
    double high = kUnknown;
    for (const Observation& row : data.rows) {
      const double v = (row.condition.*member - offset) / per_unit;
      if (!std::isfinite(v)) continue;
      if (!(low <= v)) low = v;
      if (!(high >= v)) high = v;
    }
    if (!std::isfinite(low)) return;
    result.push_back({.name = name, .unit = unit, .low = low, .high = high});
  };
  if (data.kind == Kind::kTransmission) {
    add("sun_speed", "rpm", &Condition::sun_speed_rad_s, kRpm, 0.0);
    add("output_torque", "nm", &Condition::output_torque_Nm, 1.0, 0.0);
  }
  if (data.kind == Kind::kLostMotion || data.kind == Kind::kTorqueAngle) {
    add("test_torque", "nm", &Condition::test_torque_Nm, 1.0, 0.0);
  }
  add("temperature", "c", &Condition::temperature_K, 1.0, kCelsius);
  return result;
}

bool differ_in_remedy(const Effect& effect) {
  return std::ranges::any_of(effect.alternatives,
                             [&](const Alternative& a) { return a.remedy != effect.remedy; });
}

}  // namespace

std::optional<Diagnosis> diagnose(const Simulation& simulation, const MeasurementSet& all_data,
                                  const DiagnoseOptions& options) {
  const auto tell = [&](double share) { return !options.progress || options.progress(share); };
  Diagnosis d;
  d.kind = all_data.kind;
  std::vector<std::size_t> kept;
  const MeasurementSet data = simulated_rows(simulation, all_data, d.notes, kept);
  if (data.rows.empty()) throw std::invalid_argument("diagnose: no row can be simulated");
  Problem problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
  const Repeats repeats = find_repeats(data);
  const std::vector<Levels> levels = covariate_levels(data);
  const std::vector<Candidate> candidates = candidates_for(simulation, data);
  if (!tell(0.05)) return std::nullopt;

  const SearchOptions search_options{.rate = kCauseShare * options.false_discovery_rate,
                                     .most_effects = options.most_effects,
                                     .seed = options.seed};
  SearchResult found = search_causes(problem, candidates, search_options);
  if (!tell(0.4)) return std::nullopt;
  if (weigh_by_response(problem, found)) {
    d.notes.emplace_back("the noise grows with the response: rows are weighted accordingly");
    found = search_causes(problem, candidates, search_options);
  }
  const double scatter = session_variance(problem, found);
  if (scatter > 0.0) {
    problem.noise.session_variance = scatter;
    found = search_causes(problem, candidates, search_options);
  }
  if (!tell(0.6)) return std::nullopt;

  // Lack of fit of the baseline.
  const Eigen::VectorXd y = measured(data);
  const Eigen::VectorXd baseline = linearise(problem, {}, {}).simulated;
  const Eigen::VectorXd weighted = (y - baseline).cwiseProduct(problem.noise.weight);
  const PureError pure = pure_error(repeats, weighted);
  d.repeat_degrees = pure.degrees;
  if (pure.degrees > 0 && pure.sum_of_squares > 0.0) {
    d.pure_degrees = pure.degrees;
    d.lack_degrees = repeats.cells;
    d.lack_of_fit = (weighted.squaredNorm() - pure.sum_of_squares) / repeats.cells /
                    (pure.sum_of_squares / pure.degrees);
    d.lack_of_fit_p = f_tail(d.lack_of_fit, repeats.cells, pure.degrees);
  }

  // Structure without a cause, before and after.
  const double remainder_rate = kRemainderShare * options.false_discovery_rate;
  const double start_scale = robust_deviation(weighted);
  const Columns before = columns_at(problem, {}, {}, start_scale);
  const RemainderSearch remainder_before =
      search_remainder(problem, before, levels, remainder_rate, options.seed + 11);
  Columns after = columns_at(problem, found.fit.hypothesis, {}, found.scale);
  RemainderSearch remainder_after =
      found.effects.empty()
          ? remainder_before
          : search_remainder(problem, after, levels, remainder_rate, options.seed + 12);
  if (!tell(0.8)) return std::nullopt;
  d.covariates_before = remainder_before.tests;
  d.covariates_after = remainder_after.tests;
  d.periodogram = remainder_after.periodogram;
  d.p_value = std::min(found.first_p, remainder_before.p_value);

  // A term without a cause that explains clearly better than all causes together stands against
  // them: then the causes only imitate it.
  bool structure = remainder_after.p_value <= remainder_rate;
  const std::size_t count = found.fit.hypothesis.effects.size();
  std::vector<bool> stays(count, true);
  if (structure && count > 0) {
    for (std::size_t e = 0; e < count; ++e) {
      stays[e] = needed_beside(problem, found.fit.hypothesis, e, remainder_after.best, found.scale,
                               found.first_luck.threshold);
    }
  }
  if (count > 0 && remainder_before.p_value <= remainder_rate) {
    // χ² of the causes together, with the number of causes that each was chosen from.
    const auto offered = std::ranges::count_if(causes(), [&](const Cause* cause) {
      return std::ranges::find(candidates, cause, &Candidate::cause) != candidates.end();
    });
    const double after_squares = winsorised(after.residual, found.scale).squaredNorm();
    const double before_squares = before.residual.squaredNorm();
    const auto n = static_cast<double>(y.size());
    const auto p = static_cast<Eigen::Index>(found.fit.hypothesis.value.size());
    const double statistic =
        (n - static_cast<double>(p)) * std::log(std::max(before_squares / after_squares, 1.0));
    const double choices = static_cast<double>(count) * std::log(static_cast<double>(offered));
    const double causes_evidence = chi_square_evidence(statistic, p) - choices;
    constexpr double kClearly = 3.0;
    if (remainder_before.best.evidence > causes_evidence + kClearly) {
      structure = true;
      stays.assign(count, false);
      remainder_after = remainder_before;
    }
  }
  Hypothesis kept_effects;
  std::vector<FoundEffect> kept_found;
  std::size_t first = 0;
  for (std::size_t e = 0; e < count; ++e) {
    const Candidate& c = found.fit.hypothesis.effects[e];
    if (stays[e]) {
      kept_effects.effects.push_back(c);
      const auto at = found.fit.hypothesis.value.begin() + static_cast<std::ptrdiff_t>(first);
      kept_effects.value.insert(kept_effects.value.end(), at,
                                at + static_cast<std::ptrdiff_t>(c.parameters.size()));
      kept_found.push_back(found.effects[e]);
    }
    first += c.parameters.size();
  }

  const FinalFit final = final_fit(problem, kept_effects, found.scale);
  const double row_scale = final.scale > 0.0 ? final.scale : found.scale;

  for (std::size_t e = 0; e < kept_effects.effects.size(); ++e) {
    const Candidate& c = kept_effects.effects[e];
    Effect effect{.id = std::string(c.cause->id),
                  .title = std::string(c.cause->title),
                  .form = c.form,
                  .remedy = c.cause->remedy,
                  .parameters = effect_parameters(simulation, final, e),
                  .alternatives = {},
                  .delta_bic = kept_found[e].delta_bic,
                  .p_value = kept_found[e].p_value};
    for (const Replacement& r : kept_found[e].replacements) {
      const FinalFit other = final_fit(problem, r.fit.hypothesis, found.scale);
      const auto& effects = r.fit.hypothesis.effects;
      const auto at = static_cast<std::size_t>(
          std::ranges::find(effects, r.candidate.cause, &Candidate::cause) - effects.begin());
      effect.alternatives.push_back({.id = std::string(r.candidate.cause->id),
                                     .title = std::string(r.candidate.cause->title),
                                     .form = r.candidate.form,
                                     .with_level = r.with_level,
                                     .statistic = r.statistic,
                                     .parameters = effect_parameters(simulation, other, at),
                                     .remedy = r.candidate.cause->remedy});
    }
    effect.preferred_parameter =
        effect.remedy == Remedy::kFrictionValue && !effect.alternatives.empty();
    d.effects.push_back(std::move(effect));
  }
  std::vector<std::vector<std::string_view>> groups;
  for (const Effect& effect : d.effects) {
    groups.push_back({effect.id});
    for (const Alternative& a : effect.alternatives) groups.back().push_back(a.id);
  }
  const auto frequency = inclusion_frequency(problem, found, groups, search_options);
  for (std::size_t e = 0; e < d.effects.size(); ++e) {
    d.effects[e].inclusion_frequency = frequency[e];
  }
  for (std::size_t k = 0; k < found.candidates.size(); ++k) {
    const std::string id(found.candidates[k].cause->id);
    const Gain& gain = found.first_gains[k];
    const double bic = gain.statistic - static_cast<double>(found.candidates[k].parameters.size()) *
                                            std::log(static_cast<double>(y.size()));
    const auto at = std::ranges::find(d.evidence, id, &CauseEvidence::id);
    if (at == d.evidence.end()) {
      d.evidence.push_back({.id = id, .delta_bic = bic, .evidence = gain.evidence});
    } else if (gain.evidence > at->evidence) {
      *at = {.id = id, .delta_bic = bic, .evidence = gain.evidence};
    }
  }
  std::ranges::stable_sort(d.evidence, std::greater<>(), &CauseEvidence::evidence);

  // Errors, held out and beyond.
  const Eigen::VectorXd extended = final.simulated;
  d.errors.baseline_train = root_mean_square(y - baseline);
  d.errors.extended_train = root_mean_square(y - extended);
  const Blocks blocks = holdout_blocks(data, levels);
  d.holdout_blocks = blocks.name;
  const Eigen::VectorXd held_out = predict_held_out(problem, kept_effects, blocks);
  if (blocks.count >= 2 && held_out.allFinite()) {
    d.errors.baseline_holdout = d.errors.baseline_train;
    d.errors.extended_holdout = root_mean_square(y - held_out);
  }
  const double weight_rms = 1.0 / root_mean_square(problem.noise.weight.cwiseInverse());
  d.noise_source = problem.noise.source;
  double noise_scale = row_scale;
  if (problem.noise.source == NoiseSource::kStated) noise_scale = 1.0;
  constexpr int kEnoughRepeats = 10;
  if (problem.noise.source == NoiseSource::kResiduals && pure.degrees >= kEnoughRepeats) {
    const double of_repeats = std::sqrt(pure.sum_of_squares / pure.degrees);
    // Repeats at other angles or times scatter by what varies with those.
    if (of_repeats < 1.15 * row_scale) {
      noise_scale = of_repeats;
      d.noise_source = NoiseSource::kRepeats;
    }
  }
  d.errors.noise_floor = noise_scale / weight_rms;
  d.session_deviation = std::sqrt(problem.noise.session_variance) * row_scale / weight_rms;
  d.extrapolation = extrapolate(problem, kept_effects, levels, y, baseline);

  constexpr double kOutlier = 4.0;
  d.rows.resize(all_data.rows.size());
  for (RowResult& row : d.rows) row.baseline = row.extended = row.sigma = kUnknown;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    RowResult& row = d.rows[kept[i]];
    row = {.baseline = baseline[k],
           .extended = extended[k],
           .sigma = row_scale / problem.noise.weight[k],
           .holdout = held_out[k],
           .block = blocks.of[i]};
    row.outlier = std::abs(y[k] - extended[k]) > kOutlier * row.sigma;
  }

  // Few rows have no structure that a test could see, but the scatter that they state.
  if (!structure && known_scale(problem) > 0.0 && final.degrees > 0) {
    const double squares = (y - extended).cwiseProduct(problem.noise.weight).squaredNorm();
    const double chance = boost::math::gamma_q(0.5 * final.degrees, 0.5 * squares);
    if (chance <= remainder_rate) {
      structure = true;
      remainder_after.best = {};
      remainder_after.p_value = chance;
    }
  }
  d.remainder.significant = structure;
  d.remainder.p_value = remainder_after.p_value;
  if (structure && !remainder_after.best.along.empty()) {
    d.remainder.along = remainder_after.best.along;
    d.remainder.order = remainder_after.best.order;
    const Columns left = columns_at(problem, kept_effects, {}, found.scale);
    shape_of(problem, left, remainder_after.best, levels, y - extended, d.remainder);
  }
  if (structure) {
    d.verdict = Verdict::kUnexplained;
  } else if (d.effects.empty()) {
    d.verdict = Verdict::kNoDiscrepancy;
  } else {
    d.verdict = std::ranges::any_of(d.effects, differ_in_remedy) ? Verdict::kAmbiguous
                                                                 : Verdict::kExplained;
  }

  // The next experiment separates what explains the same part, the weightiest first.
  const auto open = std::ranges::find_if(
      kept_found, [](const FoundEffect& e) { return !e.replacements.empty(); });
  if (open != kept_found.end()) {
    const auto e = static_cast<std::size_t>(open - kept_found.begin());
    std::vector<Explanation> explanations{
        {.id = d.effects[e].id, .fit = fit(problem, kept_effects, found.scale)}};
    for (const Replacement& r : open->replacements) {
      explanations.push_back({.id = std::string(r.candidate.cause->id), .fit = r.fit});
    }
    d.next_experiment = plan_experiment(problem, explanations, d.errors.noise_floor, options);
  }

  d.model.kind = data.kind;
  d.model.fingerprint = data.fingerprint;
  d.model.files = data.files;
  d.model.range = ranges_of(data);
  first = 0;
  for (const Candidate& c : final.hypothesis.effects) {
    const auto begin = final.hypothesis.value.begin() + static_cast<std::ptrdiff_t>(first);
    d.model.causes.push_back(
        {.id = std::string(c.cause->id),
         .form = c.form,
         .value = {begin, begin + static_cast<std::ptrdiff_t>(c.parameters.size())}});
    first += c.parameters.size();
  }
  for (Eigen::Index i = 0; i < final.covariance.rows(); ++i) {
    for (Eigen::Index k = 0; k < final.covariance.cols(); ++k) {
      d.model.covariance.push_back(final.covariance(i, k));
    }
  }
  d.notes.insert(d.notes.begin(), data.notes.begin(), data.notes.end());
  if (!tell(1.0)) return std::nullopt;
  return d;
}

}  // namespace gear3k::calibrate
