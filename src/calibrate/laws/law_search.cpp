#include "calibrate/laws/law_search.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "calibrate/fit/screen.hpp"
#include "calibrate/laws/law_fit.hpp"
#include "calibrate/laws/law_scan.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "numerics/distributions.hpp"
#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate {

namespace {

/// Forms that are refined, and how much better a law must be than none.
constexpr std::size_t kRefined = 24;
constexpr double kClearBic = 10.0;
/// The same where nothing else tells of structure, and the least share of what is explained.
constexpr double kSureBic = 20.0;
constexpr double kLeastLawShare = 0.02;
/// What a law that is better by kSureBic than all others refined may do between its rows, over what
/// it differs by in them.
constexpr double kPeakBetween = 1.0;
/// A share of a response that is the same everywhere is the response itself: the plainer law is
/// preferred where the data cannot tell.
constexpr double kShareCosts = 1.0;

/// Σ min(r²/s², 3²): rows further off count as these.
double capped_sum(const Eigen::VectorXd& whitened, double scale) {
  return (whitened / scale).array().square().min(kWinsor * kWinsor).sum();
}

/// A law as rows leave it behind: over time and cycles as it is used in later ones.
AppliedLaw left_by(const std::vector<Observation>& rows, const AppliedLaw& law) {
  if (!is_of_campaign(law.law)) return law;
  return as_left_behind(applied_law(law.law, law.value, rows)).value_or(law);
}

class LawSearch {
 public:
  LawSearch(const Problem& problem, const Hypothesis& hypothesis, LawScope scope,
            double scale = 0.0)
      : d_(law_data(problem, hypothesis, scope)), scale_(scale) {}

  /// The best form, refined; its value holds the changes of the hypothesis' own parameters first.
  std::optional<LawTrial> best() {
    std::vector<LawTrial> trials = scan_forms(d_);
    forms_ = static_cast<int>(trials.size());
    const double ln = std::log(static_cast<double>(d_.data.rows.size()));
    const Eigen::VectorXd left = left_by_own(d_);
    const double total = left.squaredNorm();
    const auto n = static_cast<double>(left.size());
    const auto score = [&](const LawTrial& t) {
      return n * std::log(std::max(1.0 - t.gain / total, 1e-12)) + law_cost(t.law) * ln +
             2.0 * std::log(static_cast<double>(t.orders));
    };
    std::ranges::stable_sort(trials, {}, score);
    if (trials.empty()) return std::nullopt;
    trials.resize(std::min(trials.size(), kRefined));
    const std::vector<Eigen::Index> all = all_rows();
    const LawFit squares(d_, 0.0);
    double best_deviation = HUGE_VAL;
    for (LawTrial& t : trials) {
      squares.start(t, all);
      const Eigen::VectorXd r = squares.refine(t, all);
      best_deviation = std::min(best_deviation, robust_deviation(r));
    }
    scale_ = std::max(best_deviation, d_.noise.least_scale());
    if (const double known = d_.noise.known_scale(); known > 0.0) scale_ = known;
    const LawFit fit(d_, scale_);
    for (LawTrial& t : trials) {
      fit.refine(t, all);
      fit.polish(t, all);
    }
    add_without_idle_factors(trials);
    std::optional<LawTrial> best = best_within_rows(trials);
    if (best) {
      scale_ = scale_about(*best);
      judge(*best);
    }
    return best;
  }

  /// Fits a law that is known, beside the hypothesis, at the scale as it is.
  /// @param forms  that it was chosen from
  void judge_known(LawTrial& t, int forms) {
    forms_ = forms;
    judge(t);
  }

  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] double delta_bic(const LawTrial& t) const { return sum_without_ - t.sum - cost(t); }
  /// The same with rows far off as three deviations, whether or not a law describes them.
  [[nodiscard]] double sure_bic(const LawTrial& t) const {
    const auto [without, with_law] = capped_sums(t);
    return without - with_law - cost(t);
  }
  /// The probability that the best of all forms takes off as much where there is nothing: of N
  /// forms and orders at most N times that of one, whose numbers, chosen or fitted, are as many
  /// degrees of freedom.
  [[nodiscard]] double p_value(const LawTrial& t) const {
    const auto [without, with_law] = capped_sums(t);
    const double degrees = degrees_of(t);
    const double statistic = d_.noise.known_scale() > 0.0
                                 ? without - with_law
                                 : std::max(degrees - 0.5, 0.0) * std::log(without / with_law);
    const double choices = static_cast<double>(std::max(forms_, 1)) * t.orders;
    return std::min(1.0, choices * std::exp(-chi_square_evidence(statistic, law_cost(t.law))));
  }
  [[nodiscard]] int forms() const { return forms_; }

  /// A trial's values without each block.
  [[nodiscard]] std::vector<LawTrial> without_blocks(const LawTrial& trial,
                                                     const Blocks& all) const {
    const LawFit fit(d_, scale_);
    std::vector<LawTrial> result;
    for (int b = 0; b < all.count; ++b) {
      LawTrial refitted = trial;
      const std::vector<Eigen::Index> in = rows_of(d_, all, b, false);
      refitted.value.erase(refitted.value.begin(), refitted.value.begin() + own_size(trial));
      fit.start(refitted, in);
      fit.refine(refitted, in);
      result.push_back(std::move(refitted));
    }
    return result;
  }

  /// Whether rows of held-out blocks gain more than the standard error of that.
  /// @param refitted  without each block
  [[nodiscard]] bool predicts(const std::vector<LawTrial>& refitted, const Blocks& all) const {
    const LawFit fit(d_, scale_);
    std::vector<double> gain;
    double sum = 0.0;
    double squares_gained = 0.0;
    for (int b = 0; b < all.count; ++b) {
      const std::vector<Eigen::Index> in = rows_of(d_, all, b, false);
      const std::vector<Eigen::Index> out = rows_of(d_, all, b, true);
      if (out.empty() || in.empty()) continue;
      const Eigen::VectorXd without = fit.without_law(in);
      const Eigen::VectorXd with_law = fit.at(refitted[static_cast<std::size_t>(b)]).residual;
      double block = 0.0;
      for (const Eigen::Index i : out) {
        block += huber_square(without[i] / scale_) - huber_square(with_law[i] / scale_);
        squares_gained += without[i] * without[i] - with_law[i] * with_law[i];
      }
      gain.push_back(block);
      sum += block;
    }
    const auto count = static_cast<double>(gain.size());
    if (gain.size() < 2) return false;
    double square = 0.0;
    for (const double g : gain) square += (g - sum / count) * (g - sum / count);
    return squares_gained > 0.0 && sum > std::sqrt(square * count / (count - 1.0));
  }

  /// All rows of the data as trials without their blocks predict them [SI].
  static Eigen::VectorXd predicted(const Problem& problem, const Hypothesis& hypothesis,
                                   const std::vector<LawTrial>& refitted, const Blocks& blocks) {
    const Linearisation at = linearise(problem, hypothesis, {});
    Eigen::VectorXd result = at.simulated;
    const int last = last_session(problem.data, blocks);
    std::vector<Observation> others;
    for (std::size_t row = 0; last >= 0 && row < problem.data.rows.size(); ++row) {
      if (blocks.of[row] != last) others.push_back(problem.data.rows[row]);
    }
    for (Eigen::Index i = 0; i < result.size(); ++i) {
      const auto row = static_cast<std::size_t>(i);
      const LawTrial& t = refitted[static_cast<std::size_t>(blocks.of[row])];
      for (Eigen::Index k = 0; k < at.own.cols(); ++k) {
        result[i] += at.own(i, k) * t.value[static_cast<std::size_t>(k)];
      }
      const Condition& c = problem.data.rows[row].condition;
      AppliedLaw law{.law = t.law, .value = {t.value.begin() + at.own.cols(), t.value.end()}};
      if (blocks.of[row] == last) law = left_by(others, law);
      if (!acts_in(law.law, c)) continue;
      result[i] += law_change(law.law.action, c, result[i], response_unit(problem.data.kind).si) *
                   law_value(law.law, c, law.value.data());
    }
    return result;
  }

 private:
  [[nodiscard]] std::vector<Eigen::Index> all_rows() const {
    std::vector<Eigen::Index> all(static_cast<std::size_t>(d_.residual.size()));
    std::iota(all.begin(), all.end(), Eigen::Index{0});
    return all;
  }
  /// Rows less all that is fitted to them.
  [[nodiscard]] double degrees_of(const LawTrial& t) const {
    return static_cast<double>(d_.residual.size()) - static_cast<double>(t.value.size());
  }
  /// The robust deviation about a refined trial, what it was fitted by taken into account.
  [[nodiscard]] double scale_about(const LawTrial& t) const {
    if (const double known = d_.noise.known_scale(); known > 0.0) return known;
    const Eigen::VectorXd residual = LawFit(d_, scale_).at(t).residual;
    const double rows = static_cast<double>(residual.size());
    return std::max(robust_deviation(residual) * std::sqrt(rows / std::max(degrees_of(t), 1.0)),
                    d_.noise.least_scale());
  }
  void judge(LawTrial& t) {
    const std::vector<Eigen::Index> all = all_rows();
    const LawFit fit(d_, scale_);
    fit.refine(t, all);
    sum_without_ = fit.sum_of(fit.without_law(all), all);
  }
  /// capped_sum() without and with the law.
  [[nodiscard]] std::pair<double, double> capped_sums(const LawTrial& t) const {
    const LawFit fit(d_, scale_);
    return {capped_sum(fit.without_law(all_rows()), scale_),
            capped_sum(fit.at(t).residual, scale_)};
  }
  /// Of the refined, the best that does no more where nothing was measured than its rows hold; or
  /// one that does, between them by no more than they differ, where it is better by kSureBic: what
  /// the rows hold is then no law of another form among these.
  [[nodiscard]] std::optional<LawTrial> best_within_rows(std::vector<LawTrial> trials) const {
    const auto score = [&](const LawTrial& t) { return t.sum + cost(t); };
    std::ranges::stable_sort(trials, {}, score);
    const LawTrial* peak = nullptr;
    for (const LawTrial& t : trials) {
      if (peak != nullptr && score(t) - score(*peak) > kSureBic) break;
      if (!is_told(t)) continue;
      if (!exceeds_its_rows(d_, t)) return t;
      if (peak == nullptr && !exceeds_its_rows(d_, t, kPeakBetween)) peak = &t;
    }
    return peak == nullptr ? std::nullopt : std::optional(*peak);
  }

  /// Half the 95 % interval of each of a refined trial's values.
  [[nodiscard]] Eigen::VectorXd half_intervals(const LawTrial& t) const {
    const Eigen::MatrixXd jacobian = LawFit(d_, scale_).at(t).jacobian;
    // Each in a unit of its own.
    const Eigen::VectorXd unit =
        jacobian.colwise().norm().transpose().cwiseMax(std::numeric_limits<double>::min());
    const Eigen::MatrixXd scaled = jacobian * unit.cwiseInverse().asDiagonal();
    return numerics::kHalf95 * scale_ *
           numerics::pseudo_inverse(scaled.transpose() * scaled)
               .diagonal()
               .cwiseMax(0.0)
               .cwiseSqrt()
               .cwiseQuotient(unit);
  }
  /// Of a factor that is constant where its first value is 0, whether the interval holds that.
  [[nodiscard]] static bool is_idle(const LawTrial& t, std::size_t factor,
                                    const Eigen::VectorXd& half) {
    const LawShape shape = t.law.factors[factor].shape;
    if (shape != LawShape::kPower && shape != LawShape::kExponential) return false;
    const std::size_t at = first_value(t, factor);
    return std::abs(t.value[at]) <= half[static_cast<Eigen::Index>(at)];
  }
  /// Whether the rows tell amplitude and factors of a refined trial: that it is there, and that
  /// what it is said to follow makes a difference.
  [[nodiscard]] bool is_told(const LawTrial& t) const {
    const Eigen::VectorXd half = half_intervals(t);
    const auto amplitude = static_cast<std::size_t>(own_size(t));
    if (!(std::abs(t.value[amplitude]) > half[static_cast<Eigen::Index>(amplitude)])) return false;
    for (std::size_t f = 0; f < t.law.factors.size(); ++f) {
      if (is_idle(t, f, half)) return false;
    }
    if (t.law.factors.size() > 1) return true;
    // Against the same in all rows in which it acts, whatever it is the same of.
    LawTrial constant = t;
    constant.law.factors.clear();
    constant.law.offset = false;
    constant.value.resize(amplitude + 1);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t action = 0; action < kLawActionNames.size(); ++action) {
      constant.law.action = static_cast<LawAction>(action);
      constant.value[amplitude] = 0.0;
      LawFit(d_, scale_).refine(constant, all_rows());
      least = std::min(least, constant.sum);
    }
    const double more = law_cost(t.law) - 1.0;
    const double ln = std::log(static_cast<double>(d_.data.rows.size()));
    return least - t.sum > more * ln + kClearBic;
  }
  /// Products whose factor makes no difference, without it.
  void add_without_idle_factors(std::vector<LawTrial>& trials) const {
    const std::size_t count = trials.size();
    for (std::size_t k = 0; k < count; ++k) {
      if (trials[k].law.factors.size() < 2) continue;
      const Eigen::VectorXd half = half_intervals(trials[k]);
      for (std::size_t f = 0; f < trials[k].law.factors.size(); ++f) {
        if (!is_idle(trials[k], f, half)) continue;
        LawTrial plain = trials[k];
        const auto first = plain.value.begin() + static_cast<std::ptrdiff_t>(first_value(plain, f));
        plain.value.erase(first, first + parameter_count(plain.law.factors[f].shape));
        plain.law.factors.erase(plain.law.factors.begin() + static_cast<std::ptrdiff_t>(f));
        LawFit(d_, scale_).refine(plain, all_rows());
        trials.push_back(std::move(plain));
      }
    }
  }

  [[nodiscard]] double cost(const LawTrial& t) const {
    return law_cost(t.law) * std::log(static_cast<double>(d_.data.rows.size())) +
           2.0 * std::log(static_cast<double>(t.orders)) +
           (is_share(t.law.action) ? kShareCosts : 0.0) +
           2.0 * std::log(static_cast<double>(std::max(forms_, 1)));
  }

  LawData d_;
  double scale_ = 0.0, sum_without_ = 0.0;
  int forms_ = 0;
};

/// The law with the ends of what it is asked for: the range of its conditions in the rows where it
/// acts, and as much beyond as a law is held against (exceeds_its_rows).
Law within_its_rows(Law law, const MeasurementSet& data) {
  const Law plain = law;
  for (LawFactor& f : law.factors) {
    if (!has_limits(f)) continue;
    const LawCondition& condition = law_conditions()[f.condition];
    ValueRange range;
    for (const Observation& row : data.rows) {
      if (acts_in(plain, row.condition)) range.extend(condition.value(row.condition));
    }
    const double wider = kLawReach * (range.high - range.low);
    f.least = range.low - wider;
    if (condition.natural_zero) f.least = std::max(f.least, std::min(range.low, 0.0));
    f.greatest = range.high + wider;
  }
  return law;
}

/// What a law changes in each row of a fit with it [SI, not whitened].
Eigen::VectorXd change_of(const Problem& problem, const FoundLaw& found, const Fit& fit) {
  const auto parameters = parameters_of(found.law, problem.data.kind).size();
  const double* p = fit.hypothesis.value.data() + (fit.hypothesis.value.size() - parameters);
  const double si = response_unit(problem.data.kind).si;
  const Eigen::VectorXd plain = linearise(problem, {}, {}).simulated;
  Eigen::VectorXd change = Eigen::VectorXd::Zero(plain.size());
  for (Eigen::Index i = 0; i < change.size(); ++i) {
    const Condition& c = problem.data.rows[static_cast<std::size_t>(i)].condition;
    if (!acts_in(found.law, c)) continue;
    change[i] = law_change(found.law.action, c, plain[i], si) * law_value(found.law, c, p);
  }
  return change;
}

/// A law beside a hypothesis.
/// @param rate  of false laws where nothing else tells of structure
std::optional<FoundLaw> law_beside(const Problem& problem, const Hypothesis& hypothesis,
                                   const Blocks& blocks, LawScope scope, double rate = 1.0) {
  LawSearch search(problem, hypothesis, scope);
  std::optional<LawTrial> best = search.best();
  if (!best || search.delta_bic(*best) < kClearBic) return std::nullopt;
  const bool plain = scope == LawScope::kPlain;
  const double least = std::max(kSureBic, -2.0 * std::log(rate));
  if (plain && (search.sure_bic(*best) < least || search.p_value(*best) > rate)) {
    return std::nullopt;
  }
  const std::vector<LawTrial> refitted = search.without_blocks(*best, blocks);
  if (!search.predicts(refitted, blocks)) return std::nullopt;
  best->law = within_its_rows(best->law, problem.data);
  const Form form = form_of(best->law);
  FoundLaw found{.law = best->law,
                 .hypothesis = with(
                     hypothesis, {.cause = &law_cause(),
                                  .form = form,
                                  .parameters = law_cause().parameters(form, problem.data.kind)}),
                 .scale = search.scale(),
                 .predicted = LawSearch::predicted(problem, hypothesis, refitted, blocks),
                 .delta_bic = plain ? search.sure_bic(*best) : search.delta_bic(*best),
                 .p_value = search.p_value(*best),
                 .change = {},
                 .forms = search.forms(),
                 .orders = best->orders};
  const auto records = parameters_of(found.hypothesis);
  const std::size_t own = hypothesis.value.size();
  for (std::size_t k = 0; k < best->value.size(); ++k) {
    double& value = found.hypothesis.value[k];
    value = k < own ? value + best->value[k] : best->value[k];
    value = std::clamp(value, records[k].lower, records[k].upper);
  }
  const Fit at = fit(problem, found.hypothesis, found.scale);
  found.hypothesis = at.hypothesis;
  found.change = change_of(problem, found, at);
  return found;
}

/// Σ ρ(r/s) + p ln n of a hypothesis, constants of laws among p, 2 ln M for each cause among M, and
/// 2 ln N for the law among N forms that `law` is; none where it is null.
/// @param candidates  M
double criterion(const Problem& problem, const Hypothesis& h, double scale, const FoundLaw* law,
                 std::size_t candidates) {
  const Fit at = fit(problem, h, scale);
  int parameters = 0;
  double choice = law == nullptr ? 0.0 : 2.0 * std::log(static_cast<double>(law->forms));
  for (const Candidate& c : h.effects) {
    if (c.cause != &law_cause()) choice += 2.0 * std::log(static_cast<double>(candidates));
    parameters +=
        c.cause == &law_cause() ? law_cost(law_of(c.form)) : static_cast<int>(c.parameters.size());
  }
  return at.sum_of_squares + parameters * std::log(static_cast<double>(problem.data.rows.size())) +
         choice;
}

/// The law that is the last effect of a fit, with its values, as a trial beside the causes.
LawTrial trial_of(const Hypothesis& hypothesis) {
  const std::size_t last = hypothesis.effects.size() - 1;
  const auto values = values_of(hypothesis, last);
  LawTrial trial{.law = law_of(hypothesis.effects[last].form), .value = {}};
  trial.value.assign(hypothesis.value.size() - values.size(), 0.0);
  trial.value.insert(trial.value.end(), values.begin(), values.end());
  return trial;
}

/// Takes out causes that beside the law do not pay for their parameters; what is said of the law is
/// then said of it beside those that stay.
void drop_superfluous(const Problem& problem, const Blocks& blocks, std::size_t candidates,
                      FoundLaw& found) {
  bool dropped = false;
  for (std::size_t k = 0; k < found.hypothesis.effects.size();) {
    if (found.hypothesis.effects[k].cause == &law_cause()) {
      ++k;
      continue;
    }
    const Hypothesis rest = fit(problem, without(found.hypothesis, k), found.scale).hypothesis;
    if (criterion(problem, rest, found.scale, &found, candidates) >
        criterion(problem, found.hypothesis, found.scale, &found, candidates)) {
      ++k;
      continue;
    }
    found.hypothesis = rest;
    dropped = true;
    k = 0;
  }
  if (!dropped) return;
  const Hypothesis& h = found.hypothesis;
  found.predicted = predict_law_held_out(problem, h, blocks, found.scale);
  found.change = change_of(problem, found, fit(problem, h, found.scale));
  LawSearch beside(problem, without(h, h.effects.size() - 1), LawScope::kEveryForm, found.scale);
  LawTrial trial = trial_of(h);
  trial.orders = found.orders;
  beside.judge_known(trial, found.forms);
  found.delta_bic = beside.delta_bic(trial);
  found.p_value = beside.p_value(trial);
}

/// Squares of a fit, rows far off as three deviations.
double capped_sum(const Problem& problem, const Hypothesis& h, double scale) {
  Eigen::MatrixXd white = measured(problem.data) - fit(problem, h, scale).simulated;
  problem.noise.whiten(white);
  return capped_sum(Eigen::VectorXd(white.col(0)), scale);
}

/// What there is to explain: squares of the simulation as given, rows far off as less far.
double squares_as_given(const Problem& problem, double scale) {
  Eigen::MatrixXd white = measured(problem.data) - linearise(problem, {}, {}).simulated;
  problem.noise.whiten(white);
  const Eigen::VectorXd r = white.col(0) / scale;
  return winsorised(r, robust_deviation(r)).squaredNorm();
}

/// Whether a law without the causes does better than these, where nothing tells of structure beside
/// them.
bool replaces_causes(const Problem& problem, const Hypothesis& causes, const FoundLaw& law,
                     std::size_t candidates) {
  const double ln = std::log(static_cast<double>(problem.data.rows.size()));
  const double of_causes = capped_sum(problem, causes, law.scale);
  const double of_law = capped_sum(problem, law.hypothesis, law.scale);
  const double cost_of_causes =
      static_cast<double>(causes.value.size()) * ln +
      2.0 * std::log(static_cast<double>(candidates)) * static_cast<double>(causes.effects.size());
  const double cost_of_law =
      law_cost(law.law) * ln + 2.0 * std::log(static_cast<double>(std::max(law.forms, 1)));
  const double gain = of_causes - of_law;
  if (gain < kClearBic || gain < cost_of_law - cost_of_causes + kClearBic) return false;
  // Several causes, one of them of any shape, draw what they do not describe as well.
  const bool draw_anything =
      causes.effects.size() > 1 && std::ranges::any_of(causes.effects, [](const Candidate& c) {
        return c.form.name.find("any_") != std::string::npos;
      });
  return draw_anything || gain >= kLeastLawShare * squares_as_given(problem, law.scale);
}

/// Root mean square of whitened rows as predicted without their blocks.
double missed_held_out(const Problem& problem, const Eigen::VectorXd& predicted) {
  Eigen::MatrixXd white = measured(problem.data) - predicted;
  problem.noise.whiten(white);
  return std::sqrt(white.squaredNorm() / static_cast<double>(white.rows()));
}

/// Whether a law without the causes predicts held-out rows no worse than these do.
bool predicts_as_causes_do(const Problem& problem, const Hypothesis& causes, const FoundLaw& alone,
                           const Blocks& blocks) {
  const double by_causes = missed_held_out(problem, predict_held_out(problem, causes, blocks));
  return !(missed_held_out(problem, alone.predicted) > by_causes);
}

/// A law where nothing else tells of structure: without the causes, or beside them.
std::optional<FoundLaw> find_plain_law(const Problem& problem, const Hypothesis& hypothesis,
                                       const Blocks& blocks, std::size_t candidates, double rate) {
  std::optional<FoundLaw> alone = law_beside(problem, {}, blocks, LawScope::kPlain, rate);
  if (hypothesis.effects.empty()) return alone;
  if (alone && replaces_causes(problem, hypothesis, *alone, candidates) &&
      predicts_as_causes_do(problem, hypothesis, *alone, blocks)) {
    return alone;
  }
  std::optional<FoundLaw> beside = law_beside(problem, hypothesis, blocks, LawScope::kPlain, rate);
  if (!beside) return std::nullopt;
  const double gain = capped_sum(problem, hypothesis, beside->scale) -
                      capped_sum(problem, beside->hypothesis, beside->scale);
  if (gain < kLeastLawShare * squares_as_given(problem, beside->scale)) return std::nullopt;
  return beside;
}

}  // namespace

Eigen::VectorXd predict_law_held_out(const Problem& problem, const Hypothesis& hypothesis,
                                     const Blocks& blocks, double scale) {
  if (hypothesis.effects.empty()) {
    throw std::invalid_argument(
        "predict_law_held_out: the hypothesis has 0 effects, not 1 or more");
  }
  const std::size_t last = hypothesis.effects.size() - 1;
  if (const Cause* cause = hypothesis.effects[last].cause; cause != &law_cause()) {
    throw std::invalid_argument(
        fmt::format("predict_law_held_out: the last effect is {}, no law", cause->id));
  }
  const Hypothesis causes = without(hypothesis, last);
  const LawSearch search(problem, causes, LawScope::kEveryForm, scale);
  return LawSearch::predicted(problem, causes, search.without_blocks(trial_of(hypothesis), blocks),
                              blocks);
}

std::optional<FoundLaw> find_law(const Problem& problem, const Hypothesis& hypothesis,
                                 const Blocks& blocks, LawScope scope, std::size_t candidates,
                                 double rate) {
  if (scope == LawScope::kPlain)
    return find_plain_law(problem, hypothesis, blocks, candidates, rate);
  std::optional<FoundLaw> beside = law_beside(problem, hypothesis, blocks, scope);
  if (hypothesis.effects.empty()) return beside;
  if (beside) drop_superfluous(problem, blocks, candidates, *beside);
  std::optional<FoundLaw> alone = law_beside(problem, {}, blocks, scope);
  if (!alone) return beside;
  const double scale = beside ? std::min(beside->scale, alone->scale) : alone->scale;
  const double with_causes = criterion(problem, beside ? beside->hypothesis : hypothesis, scale,
                                       beside ? &*beside : nullptr, candidates);
  const bool causes_fall =
      criterion(problem, alone->hypothesis, scale, &*alone, candidates) + kClearBic < with_causes;
  return causes_fall && predicts_as_causes_do(problem, hypothesis, *alone, blocks) ? alone : beside;
}

}  // namespace gear3k::calibrate
