#include "calibrate/search.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>

namespace gear3k::calibrate {

namespace {

/// χ² by which an explanation may be worse than the best and still count as one: two hypotheses at
/// any distance are then confused with the truth left out in less than 1 % (z = √6 = 2.4).
constexpr double kAsWell = 6.0;
/// χ² within which the coefficient of friction, a parameter, is preferred to a missing effect; and
/// a step between sessions to a law.
constexpr double kParameter = 4.0;
constexpr double kPreferred = 2.0;
/// Share of the rate that each further effect gets: what one cause leaves by its form is small.
constexpr double kFurtherShare = 0.4;
constexpr int kSimulations = 768;
constexpr int kFitsPerStep = 5;
/// So few forms are all fitted in the place of an effect, without screening.
constexpr std::size_t kFewForms = 12;

bool preferred(const Cause& cause) {
  return cause.remedy == Remedy::kFrictionValue || cause.id == "run_step";
}

/// Laws of load, speed or temperature, which a session measured in order may imitate.
bool is_law(const Cause& cause) {
  return cause.remedy == Remedy::kFlanks || cause.remedy == Remedy::kDrag ||
         cause.remedy == Remedy::kBearings || cause.remedy == Remedy::kStiffness;
}

bool has_cause(const Hypothesis& h, const Cause* cause) {
  return std::ranges::any_of(h.effects, [&](const Candidate& c) { return c.cause == cause; });
}

std::size_t value_offset(const Hypothesis& h, std::size_t effect) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < effect; ++k) first += h.effects[k].parameters.size();
  return first;
}

Hypothesis without(const Hypothesis& h, std::size_t effect) {
  Hypothesis result = h;
  const auto first = static_cast<std::ptrdiff_t>(value_offset(h, effect));
  const auto count = static_cast<std::ptrdiff_t>(h.effects[effect].parameters.size());
  result.effects.erase(result.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  result.value.erase(result.value.begin() + first, result.value.begin() + first + count);
  return result;
}

Hypothesis with(Hypothesis h, const Candidate& candidate) {
  h.effects.push_back(candidate);
  h.value.insert(h.value.end(), candidate.parameters.size(), 0.0);
  return h;
}

std::vector<Candidate> others_than(const std::vector<Candidate>& all, const Hypothesis& h) {
  std::vector<Candidate> result;
  for (const Candidate& c : all) {
    if (!has_cause(h, c.cause)) result.push_back(c);
  }
  return result;
}

/// Whether the last effect has values that a gearbox may show.
bool last_is_plausible(const Hypothesis& h) {
  const auto& records = h.effects.back().parameters;
  const std::size_t first = h.value.size() - records.size();
  for (std::size_t k = 0; k < records.size(); ++k) {
    const double value = h.value[first + k];
    if (!(value >= records[k].plausible_low && value <= records[k].plausible_high)) return false;
  }
  return true;
}

/// Order of the best evidence, at most `forms` forms of a cause.
std::vector<std::size_t> ranked(const std::vector<Candidate>& candidates,
                                const std::vector<Gain>& gains, int forms) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return gains[a].evidence > gains[b].evidence; });
  std::map<const Cause*, int> taken;
  std::erase_if(order, [&](std::size_t k) {
    return gains[k].statistic <= 0.0 || taken[candidates[k].cause]++ >= forms;
  });
  return order;
}

/// Likelihood of a set with a price for its parameters and the choice of its forms.
double score_of(const Problem& problem, const Fit& fit, double scale, double log_weight) {
  const auto n = static_cast<double>(problem.data.rows.size());
  const auto p = static_cast<double>(fit.hypothesis.value.size());
  const double known = known_scale(problem);
  const double likelihood = known > 0.0
                                ? -0.5 * fit.sum_of_squares * scale * scale / (known * known)
                                : -0.5 * n * std::log(std::max(fit.sum_of_squares, 1e-12));
  return likelihood - 0.5 * p * std::log(std::max(n, 2.0)) + log_weight;
}

/// Sums of squares of sets of blocks along one linearisation.
class LinearSets {
 public:
  LinearSets(const Columns& columns, std::vector<Block> blocks, const Problem& problem)
      : blocks_(std::move(blocks)),
        gram_(columns.other.transpose() * columns.other),
        moment_(columns.other.transpose() * columns.residual),
        total_(columns.residual.squaredNorm()),
        rows_(static_cast<double>(columns.residual.size())),
        known_(known_scale(problem)) {}

  /// Score of a set; −∞ where its columns are dependent or a sided parameter has the wrong sign.
  [[nodiscard]] double score(const std::vector<std::size_t>& set) const {
    constexpr double kNever = -std::numeric_limits<double>::infinity();
    std::array<Eigen::Index, kMaxVariables> column{};
    Eigen::Index count = 0;
    double log_weight = 0.0;
    for (const std::size_t b : set) {
      for (Eigen::Index k = 0; k < blocks_[b].count; ++k) {
        if (count == kMaxVariables) return kNever;
        column[static_cast<std::size_t>(count++)] = blocks_[b].first + k;
      }
      log_weight += blocks_[b].log_weight;
    }
    using Small =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxVariables, kMaxVariables>;
    using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxVariables, 1>;
    Small a(count, count);
    SmallVector m(count);
    SmallVector length(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index at = column[static_cast<std::size_t>(i)];
      length[i] = std::sqrt(gram_(at, at));
      if (!(length[i] > 0.0)) return kNever;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index at = column[static_cast<std::size_t>(i)];
      m[i] = moment_[at] / length[i];
      for (Eigen::Index j = 0; j < count; ++j) {
        a(i, j) = gram_(at, column[static_cast<std::size_t>(j)]) / (length[i] * length[j]);
      }
    }
    const Eigen::LLT<Small> factor(a);
    constexpr double kDependent = 1e-4;
    if (factor.info() != Eigen::Success ||
        factor.matrixL().toDenseMatrix().diagonal().minCoeff() < kDependent) {
      return kNever;
    }
    const SmallVector x = factor.solve(m);
    Eigen::Index first = 0;
    for (const std::size_t b : set) {
      if (blocks_[b].side != 0 && x[first] * blocks_[b].side <= 0.0) return kNever;
      first += blocks_[b].count;
    }
    const double left = std::max(total_ - m.dot(x), 1e-12 * total_);
    const double likelihood =
        known_ > 0.0 ? -0.5 * left / (known_ * known_) : -0.5 * rows_ * std::log(left);
    return likelihood - 0.5 * static_cast<double>(count) * std::log(rows_) + log_weight;
  }

 private:
  std::vector<Block> blocks_;
  Eigen::MatrixXd gram_;
  Eigen::VectorXd moment_;
  double total_, rows_, known_;
};

/// The best sets of a size along a linearisation at the baseline.
std::vector<std::vector<std::size_t>> best_linear_sets(const std::vector<Candidate>& candidates,
                                                       const std::vector<std::size_t>& pool,
                                                       const LinearSets& sets, int size) {
  struct Ranked {
    double score;
    std::vector<std::size_t> set;
  };
  std::vector<Ranked> best;
  const auto consider = [&](std::vector<std::size_t> set) {
    const double score = sets.score(set);
    if (!std::isfinite(score)) return;
    if (static_cast<int>(best.size()) == kFitsPerStep && score <= best.back().score) return;
    const auto at = std::ranges::upper_bound(best, score, std::greater<>(), &Ranked::score);
    best.insert(at, {.score = score, .set = std::move(set)});
    if (static_cast<int>(best.size()) > kFitsPerStep) best.pop_back();
  };
  const auto alike = [&](std::size_t a, std::size_t b) {
    return candidates[a].cause == candidates[b].cause;
  };
  for (std::size_t i = 0; i < pool.size(); ++i) {
    for (std::size_t j = i + 1; j < pool.size(); ++j) {
      if (alike(pool[i], pool[j])) continue;
      if (size == 2) {
        consider({pool[i], pool[j]});
        continue;
      }
      for (std::size_t k = j + 1; k < pool.size(); ++k) {
        if (alike(pool[i], pool[k]) || alike(pool[j], pool[k])) continue;
        consider({pool[i], pool[j], pool[k]});
      }
    }
  }
  std::vector<std::vector<std::size_t>> result;
  result.reserve(best.size());
  for (Ranked& r : best) result.push_back(std::move(r.set));
  return result;
}

double log_weight_of(const Hypothesis& h) {
  double sum = 0.0;
  for (const Candidate& c : h.effects) sum += std::log(c.form.weight * c.cause->weight);
  return sum;
}

bool same_set(const Hypothesis& a, const Hypothesis& b) {
  if (a.effects.size() != b.effects.size()) return false;
  return std::ranges::all_of(a.effects, [&](const Candidate& c) {
    return std::ranges::any_of(b.effects, [&](const Candidate& d) {
      return c.cause == d.cause && c.form.name == d.form.name && c.form.order == d.form.order &&
             std::ranges::equal(c.form.constants, d.form.constants, {}, &FormConstant::value,
                                &FormConstant::value);
    });
  });
}

}  // namespace

double known_scale(const Problem& problem) {
  // Few rows say nothing of their own scatter; then the stated one must do.
  constexpr std::size_t kFewRows = 15;
  return problem.noise.source == NoiseSource::kStated && problem.data.rows.size() < kFewRows ? 1.0
                                                                                             : 0.0;
}

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

Columns columns_at(const Problem& problem, const Hypothesis& hypothesis,
                   const std::vector<Candidate>& others, double scale) {
  const Linearisation at = linearise(problem, hypothesis, others);
  Eigen::MatrixXd all(at.own.rows(), 1 + at.own.cols() + at.other.cols());
  all << measured(problem.data) - at.simulated, at.own, at.other;
  problem.noise.whiten(all);
  return {.residual = winsorised(all.col(0), scale),
          .own = all.middleCols(1, at.own.cols()),
          .other = all.rightCols(at.other.cols()),
          .runs = at.runs};
}

std::vector<Block> blocks_of(const std::vector<Candidate>& candidates) {
  std::vector<Block> blocks;
  blocks.reserve(candidates.size());
  Eigen::Index first = 0;
  for (const Candidate& c : candidates) {
    const auto count = static_cast<Eigen::Index>(c.parameters.size());
    int side = 0;
    if (count == 1) side = c.parameters[0].lower >= 0.0 ? 1 : c.parameters[0].upper <= 0.0 ? -1 : 0;
    blocks.push_back({.first = first,
                      .count = count,
                      .side = side,
                      .log_weight = std::log(c.form.weight * c.cause->weight)});
    first += count;
  }
  return blocks;
}

SearchResult search_causes(const Problem& problem, const std::vector<Candidate>& all,
                           const SearchOptions& options) {
  SearchResult result;
  std::ranges::copy_if(all, std::back_inserter(result.candidates),
                       [](const Candidate& c) { return c.form.weight > 0.0; });
  const std::vector<Candidate>& candidates = result.candidates;
  const double known = known_scale(problem);
  const Columns base = columns_at(problem, {}, candidates, 0.0);
  // Known scatter bounds outliers only once something is fitted: what the simulation misses is far
  // beyond it.
  double scale = std::max({known, robust_deviation(base.residual), 1e-300});
  const auto n = static_cast<double>(problem.data.rows.size());
  const int simulations = n > 5000.0 ? kSimulations / 4 : kSimulations;

  Fit best = fit(problem, {}, scale);
  Columns at_base = base;
  at_base.residual = winsorised(base.residual, scale);
  const LinearSets linear(at_base, blocks_of(candidates), problem);

  for (int size = 1; size <= options.most_effects; ++size) {
    const std::vector<Candidate> others = others_than(candidates, best.hypothesis);
    const Columns columns =
        size == 1 ? at_base : columns_at(problem, best.hypothesis, others, scale);
    if (static_cast<double>(columns.own.cols()) >= n) break;
    const Screen screen(columns.own, columns.other, blocks_of(others), known);
    const std::vector<Gain> gains = screen.gains(columns.residual);
    const Screen::Luck luck = screen.luck(columns.residual, options.rate, simulations,
                                          options.seed + static_cast<std::uint64_t>(size));
    const std::vector<std::size_t> order = ranked(others, gains, 2);
    const double greatest = order.empty() ? 0.0 : gains[order[0]].evidence;
    const double p_value = luck.p_value(greatest);
    if (size == 1) {
      result.first_gains = gains;
      result.first_luck = luck;
      result.first_p = p_value;
    }
    const double rate = size == 1 ? options.rate : kFurtherShare * options.rate;
    if (order.empty() || p_value > rate) break;

    std::vector<Hypothesis> sets;
    const auto propose = [&](Hypothesis h) {
      if (h.value.size() > static_cast<std::size_t>(kMaxVariables)) return;
      if (std::ranges::any_of(sets, [&](const Hypothesis& s) { return same_set(s, h); })) return;
      sets.push_back(std::move(h));
    };
    for (std::size_t k = 0; k < order.size() && k < kFitsPerStep; ++k) {
      propose(with(best.hypothesis, others[order[k]]));
    }
    if (size > 1) {
      std::vector<std::size_t> pool = ranked(candidates, result.first_gains, size == 2 ? 6 : 2);
      constexpr std::size_t kPool = 28;
      if (size > 2 && pool.size() > kPool) pool.resize(kPool);
      // What the last fit holds, and what adds most to it, belongs to the pool in any case.
      for (std::size_t k = 0; k < candidates.size(); ++k) {
        const bool in_fit = std::ranges::any_of(best.hypothesis.effects, [&](const Candidate& c) {
          return same_set({.effects = {c}, .value = {}}, {.effects = {candidates[k]}, .value = {}});
        });
        if (in_fit && std::ranges::find(pool, k) == pool.end()) pool.push_back(k);
      }
      for (const auto& set : best_linear_sets(candidates, pool, linear, size)) {
        Hypothesis h;
        for (const std::size_t k : set) h = with(std::move(h), candidates[k]);
        propose(std::move(h));
      }
    }
    Fit winner;
    double winner_score = -std::numeric_limits<double>::infinity();
    for (Hypothesis& h : sets) {
      Fit trial = fit(problem, std::move(h), scale);
      const double score = score_of(problem, trial, scale, log_weight_of(trial.hypothesis));
      if (score > winner_score) {
        winner_score = score;
        winner = std::move(trial);
      }
    }
    if (!std::isfinite(winner_score)) break;
    best = std::move(winner);
    scale = std::max({known, robust_deviation(best.residual), 1e-300});
  }

  // What each effect adds to the others, and what explains as well in its place.
  const auto parameters = static_cast<double>(best.hypothesis.value.size());
  const double degrees = std::max(1.0, n - parameters);
  double variance = 1.0;
  if (!(known > 0.0)) variance = winsorised(best.residual, scale).squaredNorm() / degrees;
  const auto chi = [&](const Fit& f) { return f.sum_of_squares * scale * scale / variance; };
  // All fits below at one scale.
  best = fit(problem, best.hypothesis, scale);
  double chi_best = chi(best);
  const auto level = std::ranges::find_if(
      candidates, [](const Candidate& c) { return c.cause->remedy == Remedy::kFrictionValue; });
  const std::size_t count = best.hypothesis.effects.size();
  for (std::size_t e = 0; e < count; ++e) {
    FoundEffect found;
    const Hypothesis rest = without(best.hypothesis, e);
    const Fit fit_rest = fit(problem, rest, scale);
    const Candidate own = best.hypothesis.effects[e];
    const double added = chi(fit_rest) - chi_best;
    const auto own_parameters = static_cast<Eigen::Index>(own.parameters.size());
    found.p_value = result.first_luck.p_value(chi_square_evidence(added, own_parameters) +
                                              std::log(own.form.weight * own.cause->weight));
    found.delta_bic = added - static_cast<double>(own_parameters) * std::log(n);
    // Screening along the linearisation without the effect, then fits of the likely ones.
    std::vector<Candidate> others = others_than(candidates, best.hypothesis);
    const bool level_free = level != candidates.end() && !has_cause(best.hypothesis, level->cause);
    for (const bool with_level : {false, true}) {
      if (with_level && !level_free) continue;
      const Hypothesis start = with_level ? with(fit_rest.hypothesis, *level) : fit_rest.hypothesis;
      const Fit fit_start = with_level ? fit(problem, start, scale) : fit_rest;
      const double chi_start = chi(fit_start);
      // Where the level alone explains, what is added to it explains nothing.
      if (with_level && chi_start <= chi_best + kAsWell) continue;
      // The effect itself, last in the pool, says what a replacement has to do: judged alike, by
      // columns that hold for small changes only and with the same rows clipped.
      std::vector<Candidate> pool = others_than(others, start);
      pool.push_back(own);
      const double wide = std::max(scale, robust_deviation(fit_start.residual));
      const Columns columns = columns_at(problem, fit_start.hypothesis, pool, wide);
      if (columns.own.cols() >= columns.own.rows()) continue;
      const Screen screen(columns.own, columns.other, blocks_of(pool), known);
      const std::vector<Gain> gains = screen.gains(columns.residual);
      std::map<const Cause*, std::vector<std::size_t>> forms;
      constexpr double kBent = 0.05;  // of what the effect explains: the columns are tangents
      const double needed = (1.0 - kBent) * gains.back().sum_of_squares - 3.0 * kAsWell * variance;
      for (std::size_t k = 0; k + 1 < pool.size(); ++k) {
        const double gain = gains[k].sum_of_squares;
        if ((gain > 0.0 && gain >= needed) || pool.size() <= kFewForms) {
          forms[pool[k].cause].push_back(k);
        }
      }
      for (auto& entry : forms) {
        const Cause* cause = entry.first;
        std::vector<std::size_t>& list = entry.second;
        const bool named = std::ranges::any_of(
            found.replacements, [&](const Replacement& r) { return r.candidate.cause == cause; });
        if (named) continue;
        std::ranges::stable_sort(list, [&](std::size_t a, std::size_t b) {
          return gains[a].sum_of_squares > gains[b].sum_of_squares;
        });
        Replacement replacement;
        replacement.statistic = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < list.size() && k < 2; ++k) {
          // From the values beside the effect: without it the others may lie far off.
          Hypothesis h = with(with_level ? with(rest, *level) : rest, pool[list[k]]);
          if (h.value.size() > static_cast<std::size_t>(kMaxVariables)) continue;
          Fit trial = fit(problem, std::move(h), scale);
          const double difference = chi(trial) - chi_best;
          if (difference < replacement.statistic) {
            replacement = {.candidate = pool[list[k]],
                           .with_level = with_level,
                           .statistic = difference,
                           .fit = std::move(trial)};
          }
        }
        if (replacement.statistic <= kAsWell) found.replacements.push_back(std::move(replacement));
      }
    }
    std::ranges::stable_sort(found.replacements, {}, &Replacement::statistic);
    result.effects.push_back(std::move(found));
  }
  // A parameter, or a step between sessions, goes before a missing effect that explains as well;
  // so does what stands earlier in the library at a tie.
  for (std::size_t e = 0; e < count; ++e) {
    FoundEffect& found = result.effects[e];
    const Candidate own = best.hypothesis.effects[e];
    if (preferred(*own.cause)) continue;
    const auto rank = [](const Candidate& c) {
      return std::ranges::find(causes(), c.cause) - causes().begin();
    };
    constexpr double kTie = 1e-3;
    const auto better = std::ranges::find_if(found.replacements, [&](const Replacement& r) {
      if (r.with_level) return false;
      if (r.candidate.cause->remedy == Remedy::kFrictionValue) {
        return r.statistic <= kParameter && last_is_plausible(r.fit.hypothesis);
      }
      if (preferred(*r.candidate.cause)) return is_law(*own.cause) && r.statistic <= kPreferred;
      return r.statistic <= kTie && rank(r.candidate) < rank(own);
    });
    if (better == found.replacements.end()) continue;
    Replacement taken = *better;
    found.replacements.erase(better);
    Replacement given{
        .candidate = own, .with_level = false, .statistic = -taken.statistic, .fit = best};
    // The replacement's fit has the effect at its end; keep the others in their order.
    Hypothesis h = taken.fit.hypothesis;
    std::rotate(h.effects.begin() + static_cast<std::ptrdiff_t>(e), h.effects.end() - 1,
                h.effects.end());
    const auto first = static_cast<std::ptrdiff_t>(value_offset(h, e));
    const auto own_count = static_cast<std::ptrdiff_t>(taken.candidate.parameters.size());
    std::rotate(h.value.begin() + first, h.value.end() - own_count, h.value.end());
    taken.fit.hypothesis = std::move(h);
    for (Replacement& r : found.replacements) r.statistic -= taken.statistic;
    found.replacements.insert(found.replacements.begin(), std::move(given));
    best = taken.fit;
    chi_best = chi(best);
    // What may stand in the place of the other effects now stands beside this one.
    for (std::size_t other = 0; other < count; ++other) {
      if (other == e) continue;
      std::vector<Replacement>& list = result.effects[other].replacements;
      for (Replacement& r : list) {
        Hypothesis beside = without(best.hypothesis, other);
        if (has_cause(beside, r.candidate.cause)) {
          r.statistic = std::numeric_limits<double>::infinity();
          continue;
        }
        if (r.with_level && !has_cause(beside, level->cause)) beside = with(beside, *level);
        r.fit = fit(problem, with(std::move(beside), r.candidate), scale);
        r.statistic = chi(r.fit) - chi_best;
      }
      std::erase_if(list, [](const Replacement& r) { return !(r.statistic <= kAsWell); });
    }
  }
  // Forms that were not searched for.
  for (std::size_t e = 0; e < count; ++e) {
    for (const Candidate& form : all) {
      const Candidate own = best.hypothesis.effects[e];
      if (form.form.weight > 0.0 || form.cause != own.cause) continue;
      // A form with a level of its own makes no sense beside the level.
      const bool refines = form.parameters.size() > own.parameters.size();
      const bool has_level = level == candidates.end() || has_cause(best.hypothesis, level->cause);
      if (form.form.name == "any_level" && has_level) continue;
      Hypothesis h = best.hypothesis;
      h.effects[e] = form;
      const std::size_t at = value_offset(best.hypothesis, e);
      h.value.insert(h.value.begin() + static_cast<std::ptrdiff_t>(at + own.parameters.size()),
                     form.parameters.size() - own.parameters.size(), 0.0);
      if (h.value.size() > static_cast<std::size_t>(kMaxVariables)) continue;
      Fit trial = fit(problem, std::move(h), scale);
      const double value = trial.hypothesis.value[at];
      const bool plausible =
          value >= form.parameters[0].plausible_low && value <= form.parameters[0].plausible_high;
      if ((refines || plausible) && chi(trial) <= chi(best) + kPreferred) best = std::move(trial);
    }
  }
  result.scale = std::sqrt(variance);
  result.fit = std::move(best);
  return result;
}

std::vector<double> inclusion_frequency(const Problem& problem, const SearchResult& result,
                                        const std::vector<std::vector<std::string_view>>& groups,
                                        const SearchOptions& options) {
  constexpr int kSamples = 40;
  std::vector<double> frequency(groups.size(), 0.0);
  if (groups.empty()) return frequency;
  const Columns columns = columns_at(problem, {}, result.candidates, 0.0);
  const Eigen::Index n = columns.residual.size();
  const Eigen::Index half = std::min<Eigen::Index>(n / 2, 500);
  constexpr Eigen::Index kFewRows = 8;
  if (half < kFewRows) return std::vector<double>(groups.size(), kUnknown);
  RandomBits random(options.seed + 77);
  std::vector<Eigen::Index> index(static_cast<std::size_t>(n));
  std::iota(index.begin(), index.end(), Eigen::Index{0});
  for (int sample = 0; sample < kSamples; ++sample) {
    for (Eigen::Index k = 0; k < half; ++k) {
      const auto left = static_cast<double>(n - k);
      const auto other = k + static_cast<Eigen::Index>(random.uniform() * left);
      std::swap(index[static_cast<std::size_t>(k)], index[static_cast<std::size_t>(other)]);
    }
    const std::vector<Eigen::Index> rows(index.begin(), index.begin() + half);
    const Eigen::VectorXd residual =
        winsorised(columns.residual(rows), robust_deviation(columns.residual(rows)));
    const Eigen::MatrixXd other = columns.other(rows, Eigen::all);
    Eigen::MatrixXd own(half, 0);
    std::vector<bool> hit(groups.size(), false);
    for (int size = 0; size < options.most_effects; ++size) {
      const Screen screen(own, other, blocks_of(result.candidates), 0.0);
      const auto gains = screen.gains(residual);
      const auto order = ranked(result.candidates, gains, 1);
      if (order.empty() || gains[order[0]].evidence < result.first_luck.threshold) break;
      const Candidate& c = result.candidates[order[0]];
      for (std::size_t g = 0; g < groups.size(); ++g) {
        hit[g] = hit[g] || std::ranges::find(groups[g], c.cause->id) != groups[g].end();
      }
      const Block block = screen.blocks()[order[0]];
      Eigen::MatrixXd grown(half, own.cols() + block.count);
      grown << own, other.middleCols(block.first, block.count);
      own = std::move(grown);
    }
    for (std::size_t g = 0; g < groups.size(); ++g) frequency[g] += hit[g] ? 1.0 : 0.0;
  }
  for (double& f : frequency) f /= kSamples;
  return frequency;
}

}  // namespace gear3k::calibrate
