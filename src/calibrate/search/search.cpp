#include "calibrate/search/search.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/fit/holdout.hpp"
#include "calibrate/search/better_names.hpp"
#include "calibrate/search/free_shapes.hpp"
#include "calibrate/search/linear_sets.hpp"
#include "calibrate/search/replacements.hpp"
#include "calibrate/search/rows_together.hpp"
#include "calibrate/search/second_names.hpp"

namespace gear3k::calibrate {

namespace {

/// Share of the rate that each further effect gets: what one cause leaves by its form is small.
constexpr double kFurtherShare = 0.4;
constexpr int kSimulations = 768;
constexpr double kManySearchedRows = 5000.0;
constexpr int kFitsPerStep = 5;
constexpr int kSetsPerStep = 8;
constexpr std::size_t kRefinedPerStep = 4;
/// Scatter of rows over what they state: they miss something, and they miss nothing.
constexpr double kFarBeyond = 2.0, kNearStated = 1.25;

/// Proposals of one step of the search.
class Proposals {
 public:
  [[nodiscard]] bool empty() const { return sets_.empty(); }
  void add(Hypothesis h) {
    if (h.value.size() > static_cast<std::size_t>(kMostParameters)) return;
    if (std::ranges::any_of(sets_, [&](const Hypothesis& s) { return same_forms(s, h); })) return;
    sets_.push_back(std::move(h));
  }
  /// The fit of the best score among those that predict rows held out of the fit no worse than the
  /// last fit does.  Where none does: empty, or of an empty last fit the best in score: that
  /// something is there has been tested, and the held-out error will say how little it helps.
  /// @param all  candidates, with the forms of free shape
  /// @param scale  of the last fit, which misses what is looked for
  /// @param least  below which no scale falls
  [[nodiscard]] std::optional<Fit> best_fit(const Problem& problem,
                                            const std::vector<Candidate>& all,
                                            const Hypothesis& last,
                                            const std::vector<Levels>& levels, double scale,
                                            double least) const {
    std::vector<Fit> fits = fit_all(problem, sets_, scale);
    std::vector<double> score;
    score.reserve(fits.size());
    for (const Fit& f : fits) score.push_back(score_of(problem, f, scale));
    std::vector<std::size_t> order(fits.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order,
                             [&](std::size_t a, std::size_t b) { return score[a] > score[b]; });
    std::erase_if(order, [&](std::size_t k) { return !std::isfinite(score[k]); });
    // By the scale of a fit that misses the effect no row is an outlier, and the best sets would be
    // told apart by how they go through those: they are compared by what they leave themselves.
    const auto refined =
        order.begin() + static_cast<std::ptrdiff_t>(std::min(order.size(), kRefinedPerStep));
    double fine = scale;
    for (auto k = order.begin(); k != refined; ++k) {
      fine = std::min(fine, std::max(least, problem.noise.deviation_of(fits[*k].residual)));
    }
    // Laws of fixed shape leave a residue by which a wrong set may look better.
    for_fits(problem, static_cast<std::size_t>(refined - order.begin()), [&](std::size_t rank) {
      const std::size_t k = order[rank];
      fits[k] = with_free_shapes(problem, all, fit(problem, fits[k].hypothesis, fine), fine);
      score[k] = score_of(problem, fits[k], fine);
    });
    std::stable_sort(order.begin(), refined,
                     [&](std::size_t a, std::size_t b) { return score[a] > score[b]; });
    Blocks blocks;
    Eigen::VectorXd by_last;
    for (const std::size_t k : order) {
      Blocks own = holdout_blocks(problem.data, levels, fits[k].hypothesis);
      if (own.name.empty()) own = parts_of_rows(problem.data);  // for what else the set holds
      if (own.name != blocks.name) {
        blocks = std::move(own);
        by_last = predict_held_out(problem, last, blocks);
      }
      const Eigen::VectorXd predicted = predict_held_out(problem, fits[k].hypothesis, blocks);
      if (predicts_no_worse(problem, predicted, by_last, fine)) return fits[k];
    }
    if (order.empty() || !last.effects.empty()) return std::nullopt;
    return fits[order.front()];
  }

 private:
  std::vector<Hypothesis> sets_;
};

/// Candidates that the sets of a size are made of: the best by themselves, and those of the last
/// fit.
std::vector<std::size_t> pool_of(const SearchResult& result, const Hypothesis& last, int size) {
  const std::vector<Candidate>& candidates = result.candidates;
  std::vector<std::size_t> pool = ranked(candidates, result.first_gains, size == 2 ? 6 : 2);
  constexpr std::size_t kPool = 28;
  if (size > 2 && pool.size() > kPool) pool.resize(kPool);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const bool in_fit = std::ranges::any_of(last.effects, [&](const Candidate& c) {
      return same_forms({.effects = {c}, .value = {}}, {.effects = {candidates[k]}, .value = {}});
    });
    if (in_fit && std::ranges::find(pool, k) == pool.end()) pool.push_back(k);
  }
  return pool;
}

/// The search step by step: each adds one effect, or exchanges those that are there for a set of
/// one more, while what is left is more than luck.
class Growth {
 public:
  Growth(const Problem& problem, const std::vector<Candidate>& all, const SearchOptions& options,
         SearchResult& result);
  /// @param size  effects after it
  /// @returns whether it found any
  bool step(int size);
  /// Takes what another search found where it has a clearly better score.
  void offer(const SearchResult& known);

  [[nodiscard]] const Fit& best() const { return best_; }
  [[nodiscard]] double scale() const { return scale_; }
  /// Candidates that refine no other.
  [[nodiscard]] const std::vector<Candidate>& simple() const { return simple_; }

 private:
  [[nodiscard]] double rows() const { return static_cast<double>(problem_.data.rows.size()); }
  [[nodiscard]] bool is_luck(int size, const Screen& screen, const Columns& columns,
                             const std::vector<Candidate>& others, const std::vector<Gain>& gains,
                             double greatest);
  [[nodiscard]] std::pair<Proposals, double> pairs_to_stated_noise() const;
  [[nodiscard]] Proposals proposals(int size, const std::vector<Candidate>& others,
                                    const Screen& screen, const Columns& columns,
                                    const std::vector<std::size_t>& order) const;
  [[nodiscard]] bool adds_enough(const Fit& winner) const;

  const Problem& problem_;
  const SearchOptions& options_;
  SearchResult& result_;
  std::vector<Candidate> simple_;
  double known_, least_;  ///< scales of the noise
  Columns base_;          ///< of the simulation as given
  bool agrees_;           ///< as given it misses no more than rounding
  double scale_;
  double squares_ = 0.0;  ///< of what it misses
  // Rows far off are outliers, or they are where the effect is greatest: both are looked at.
  std::optional<LinearSets> linear_, linear_unclipped_;
  std::vector<Levels> levels_;
  Fit best_;
};

Growth::Growth(const Problem& problem, const std::vector<Candidate>& all,
               const SearchOptions& options, SearchResult& result)
    : problem_(problem),
      options_(options),
      result_(result),
      known_(problem.noise.known_scale()),
      least_(problem.noise.least_scale()),
      base_(columns_at(problem, {}, result.candidates, 0.0)),
      agrees_(problem.noise.within_rounding(base_.residual)),
      // Known scatter bounds outliers only once something is fitted: what the simulation misses is
      // far beyond it.
      scale_(std::max({known_, problem.noise.deviation_of(base_.residual), least_})),
      levels_(covariate_levels(problem.data)),
      best_(fit(problem, {}, scale_)) {
  std::ranges::copy_if(all, std::back_inserter(simple_),
                       [](const Candidate& c) { return !is_refinement(c.form); });
  base_.residual = winsorised(base_.residual, scale_);
  squares_ = base_.residual.squaredNorm();
  linear_.emplace(base_, blocks_of(result.candidates), problem);
  std::swap(base_.residual, base_.raw);
  linear_unclipped_.emplace(base_, blocks_of(result.candidates), problem);
  std::swap(base_.residual, base_.raw);
}

/// How often rows far off fall so together by luck, where one candidate of one parameter acts.
double chance_of_rows_off(const Columns& columns, const std::vector<Candidate>& others,
                          double scale) {
  std::vector<Eigen::Index> single;
  for (const Block& block : blocks_of(others)) {
    if (block.count == 1) single.push_back(block.first);
  }
  const auto found = rows_together(columns.raw, scale, columns.other(Eigen::all, single));
  return found ? found->p_value : 1.0;
}

/// Whether the greatest gain of a step is what chance gives.  Random signs do not tell where few
/// rows are off: in six of them every 32nd choice is the structure itself.
bool Growth::is_luck(int size, const Screen& screen, const Columns& columns,
                     const std::vector<Candidate>& others, const std::vector<Gain>& gains,
                     double greatest) {
  const int simulations = rows() > kManySearchedRows ? kSimulations / 4 : kSimulations;
  const Screen::Luck luck = screen.luck(columns.residual, options_.rate, simulations,
                                        options_.seed + static_cast<std::uint64_t>(size));
  const double rate = size == 1 ? options_.rate : kFurtherShare * options_.rate;
  double p_value = agrees_ ? 1.0 : luck.p_value(greatest);
  if (p_value > rate && !agrees_) {
    p_value = std::min(p_value, chance_of_rows_off(columns, others, scale_));
  }
  if (size == 1) {
    result_.first_gains = gains;
    result_.first_luck = luck;
    result_.first_p = p_value;
  }
  return p_value > rate;
}

/// Pairs of causes that no luck makes, by F's tail and as many as the pairs that were looked
/// through. Where no cause does more than luck by itself and the rows scatter far beyond what they
/// state: one that leaves them as they state is no luck of the choice.
std::pair<Proposals, double> Growth::pairs_to_stated_noise() const {
  std::pair<Proposals, double> some{{}, 1.0};
  if (agrees_ || problem_.noise.source != NoiseSource::kStated || scale_ < kFarBeyond) return some;
  const std::vector<std::size_t> pool = pool_of(result_, {}, 2);
  const auto others = static_cast<double>(pool.size());
  for (const auto& set : best_linear_sets(result_.candidates, pool, *linear_, 2, kSetsPerStep)) {
    const double chance = 0.5 * others * (others - 1.0) * linear_->chance(set);
    if (chance > kFurtherShare * options_.rate) continue;
    Hypothesis h;
    for (const std::size_t k : set) h = with(std::move(h), result_.candidates[k]);
    some.first.add(std::move(h));
    some.second = std::min(some.second, chance);
  }
  return some;
}

/// What is there with one more, and beyond the first the best sets of that size by linear fits.
Proposals Growth::proposals(int size, const std::vector<Candidate>& others, const Screen& screen,
                            const Columns& columns, const std::vector<std::size_t>& order) const {
  Proposals some;
  for (const auto& ranks : {order, ranked(others, screen.gains(columns.raw), 2)}) {
    for (std::size_t k = 0; k < ranks.size() && k < kFitsPerStep; ++k) {
      some.add(with(best_.hypothesis, others[ranks[k]]));
    }
  }
  if (size == 1) return some;
  const std::vector<Candidate>& candidates = result_.candidates;
  const std::vector<std::size_t> pool = pool_of(result_, best_.hypothesis, size);
  for (const LinearSets* sets : {&*linear_, &*linear_unclipped_}) {
    for (const auto& set : best_linear_sets(candidates, pool, *sets, size, kSetsPerStep)) {
      Hypothesis h;
      for (const std::size_t k : set) h = with(std::move(h), candidates[k]);
      some.add(std::move(h));
    }
  }
  return some;
}

/// Whether what a law of slightly another shape leaves of those of a hypothesis looks like no such
/// cause.  A drag is a friction that falls with the load or rises with the speed.
bool is_no_bend(const Cause& cause, const Hypothesis& h) {
  if (cause.remedy == Remedy::kDrag) {
    return std::ranges::none_of(h.effects, [](const Candidate& c) {
      return c.cause->id == "friction_load" || c.cause->id == "friction_speed";
    });
  }
  return cause.remedy == Remedy::kAccuracy || cause.remedy == Remedy::kClearance ||
         cause.remedy == Remedy::kStiffness;
}

/// A law of slightly wrong shape leaves more than noise where the effect is far above it: what adds
/// less than a share to what is explained is no cause of its own; a fifth of that share is enough
/// for what is_no_bend().
bool Growth::adds_enough(const Fit& winner) const {
  constexpr double kLeastShare = 0.015, kLeastOfOther = 0.003;
  const bool other = std::ranges::all_of(winner.hypothesis.effects, [&](const Candidate& c) {
    return has_cause(best_.hypothesis, c.cause) || is_no_bend(*c.cause, best_.hypothesis);
  });
  const Fit last = fit(problem_, best_.hypothesis, scale_);
  const Fit now = fit(problem_, winner.hypothesis, scale_);
  const double added = (last.sum_of_squares - now.sum_of_squares) * scale_ * scale_;
  const double least = other ? kLeastOfOther : kLeastShare;
  return !(added < least * (squares_ - rows() * scale_ * scale_));
}

bool Growth::step(int size) {
  const std::vector<Candidate> others = candidates_beside(result_.candidates, best_.hypothesis);
  const Columns columns =
      size == 1 ? std::exchange(base_, {}) : columns_at(problem_, best_.hypothesis, others, scale_);
  if (static_cast<double>(columns.own.cols()) >= rows()) return false;
  const Screen screen(columns.own, columns.other, blocks_of(others), known_);
  const std::vector<Gain> gains = screen.gains(columns.residual);
  const std::vector<std::size_t> order = ranked(others, gains, 2);
  const double greatest = order.empty() ? 0.0 : gains[order[0]].evidence;
  const bool luck = is_luck(size, screen, columns, others, gains, greatest);
  if (order.empty() || (luck && size > 1)) return false;
  auto [some, chance] = luck ? pairs_to_stated_noise()
                             : std::pair{proposals(size, others, screen, columns, order), 1.0};
  if (some.empty()) return false;
  std::optional<Fit> winner =
      some.best_fit(problem_, simple_, best_.hypothesis, levels_, scale_, std::max(known_, least_));
  if (!winner || (size > 1 && !adds_enough(*winner))) return false;
  if (luck && problem_.noise.deviation_of(winner->residual) > kNearStated) return false;
  result_.first_p = std::min(result_.first_p, chance);
  best_ = std::move(*winner);
  scale_ = std::max({known_, problem_.noise.deviation_of(best_.residual), least_});
  return true;
}

void Growth::offer(const SearchResult& known) {
  const Hypothesis& h = known.fit.hypothesis;
  if (h.effects.empty()) return;
  const auto own_scale = [&](const Fit& f) {
    return std::max({known_, problem_.noise.deviation_of(f.residual), least_});
  };
  const double scale = std::min(scale_, own_scale(fit(problem_, h, scale_)));
  Fit offered = fit(problem_, h, scale);
  constexpr double kClearly = 5.0;  // of a log likelihood: strong evidence
  if (score_of(problem_, offered, scale) <
      score_of(problem_, fit(problem_, best_.hypothesis, scale), scale) + kClearly) {
    return;
  }
  best_ = std::move(offered);
  scale_ = own_scale(best_);
  result_.first_p = std::min(result_.first_p, known.first_p);
}

/// The fit with other shapes and names for the same data where they say more, or as much with less.
Fit in_other_shapes(const Problem& problem, const std::vector<Candidate>& all,
                    const std::vector<Candidate>& simple, Fit best, double scale) {
  best =
      with_plain_shapes(problem, simple, fit(problem, best.hypothesis, scale), scale, kMostEffects);
  best = with_exchanges(problem, simple, std::move(best), scale);
  // Of what stands now, by each mesh's share of the load and in curves of any shape.
  const bool refines = std::ranges::any_of(all, [&](const Candidate& c) {
    return is_refinement(c.form) && has_cause(best.hypothesis, c.cause);
  });
  if (refines) best = with_free_shapes(problem, all, std::move(best), scale);
  best = with_smooth_laws(problem, all, std::move(best), scale);
  best = with_one_law_of_time(problem, all, std::move(best), scale);
  best = with_one_wave(problem, all, std::move(best), scale);
  best = with_freed_rests(problem, all, std::move(best), scale);
  best = with_named_starts(problem, all, std::move(best), scale, kMostEffects);
  return with_named_means(problem, all, std::move(best), scale, kMostEffects);
}

/// Takes what may carry no name out of the fit; of a step or drift without change, in its place
/// what all rows have in common, where the library has a cause of that which explains as well.
/// @returns whether there was one
bool takes_out_no_finding(const Problem& problem, const std::vector<Candidate>& all,
                          const Judge& judge, Fit& found) {
  for (std::size_t e = 0; e < found.hypothesis.effects.size(); ++e) {
    if (!is_no_finding(judge, found, e)) continue;
    const Hypothesis rest = without(found.hypothesis, e);
    const Candidate* const constant = found.hypothesis.effects[e].cause->as_constant != nullptr
                                          ? constant_of(all, found.hypothesis, e)
                                          : nullptr;
    if (constant != nullptr) {
      Fit named = fit(problem, with(rest, *constant), judge.scale());
      if (judge.explains_as_well(named, found)) {
        found = std::move(named);
        return true;
      }
    }
    found = with_free_shapes(problem, all, fit(problem, rest, judge.scale()), judge.scale());
    return true;
  }
  return false;
}

/// Judges the effects of the fit and takes out, the weakest first, those that do not pay.
void keep_what_pays(const Problem& problem, const std::vector<Candidate>& all, const Judge& judge,
                    double scale, SearchResult& result) {
  int names = 0;
  constexpr int kMostTakenOut = 2 * kMostEffects;  // what is renamed may be named anew
  for (int taken_out = 0;; ++taken_out) {
    std::vector<FoundEffect> judged(result.fit.hypothesis.effects.size());
    for_fits(problem, judged.size(),
             [&](std::size_t e) { judged[e] = judge_effect(judge, result, e); });
    result.effects = std::move(judged);
    take_better_names(judge, all, result);
    if (taken_out < kMostTakenOut && takes_out_no_finding(problem, all, judge, result.fit)) {
      continue;
    }
    // Each is ahead of the one before.
    constexpr int kMostNames = 4;
    if (names < kMostNames && take_likelier_name(judge, result)) {
      ++names;
      continue;
    }
    // A name has to pay for its parameters; beside another one its evidence has to be strong.
    const double least_gain = result.effects.size() > 1 ? kBesideAnother : 0.0;
    const auto weakest = std::ranges::min_element(result.effects, {}, &FoundEffect::delta_bic);
    if (weakest == result.effects.end() || weakest->delta_bic > least_gain) return;
    const auto effect = static_cast<std::size_t>(weakest - result.effects.begin());
    result.fit = with_free_shapes(
        problem, all, fit(problem, without(result.fit.hypothesis, effect), scale), scale);
  }
}

}  // namespace

std::vector<Candidate> candidates_for(const Simulation& simulation, const MeasurementSet& data) {
  const Occasion occasion = simulation.occasion(data);
  std::vector<Candidate> result;
  for (const Cause* cause : causes()) {
    // A model holds one form of such a cause, and a second one would take its place.
    if (cause->exclusive_forms && simulation.models_cause(cause->id)) continue;
    for (Form& form : cause->forms(occasion)) {
      auto parameters = cause->parameters(form, simulation.kind());
      result.push_back(
          {.cause = cause, .form = std::move(form), .parameters = std::move(parameters)});
    }
  }
  return result;
}

SearchResult search_causes(const Problem& problem, const std::vector<Candidate>& all,
                           const SearchOptions& options, const SearchResult* known) {
  SearchResult result;
  result.rows = problem.data.rows.size();
  std::ranges::copy_if(all, std::back_inserter(result.candidates),
                       [](const Candidate& c) { return c.form.weight > 0.0; });
  Growth growth(problem, all, options, result);
  for (int size = 1; size <= kMostEffects && growth.step(size);) {
    size = std::max(size, static_cast<int>(growth.best().hypothesis.effects.size())) + 1;
  }
  if (known != nullptr) growth.offer(*known);
  const double scale = growth.scale();
  const Fit best = in_other_shapes(problem, all, growth.simple(), growth.best(), scale);
  const Judge judge(problem, all, best, scale);
  result.fit = fit(problem, best.hypothesis, scale);  // all fits from here on at one scale
  keep_what_pays(problem, all, judge, scale, result);
  result.scale = std::sqrt(judge.variance());
  return result;
}

}  // namespace gear3k::calibrate
