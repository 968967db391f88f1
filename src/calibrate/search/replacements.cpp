#include "calibrate/search/replacements.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>

#include "calibrate/causes/friction_change.hpp"
#include "calibrate/causes/reading_change.hpp"
#include "calibrate/search/free_shapes.hpp"

namespace gear3k::calibrate {

const Candidate* level_of(const SearchResult& result) {
  const auto at = std::ranges::find_if(result.candidates,
                                       [](const Candidate& c) { return is_level(*c.cause); });
  return at == result.candidates.end() ? nullptr : &*at;
}

namespace {

/// Share of what an effect explains below which two are alike, as kSameChi.
constexpr double kRoundedShare = 1e-9;
/// So few forms are all fitted in the place of an effect, without screening.
constexpr std::size_t kFewForms = 12;

/// Forms of a cause that are fitted in the place of an effect.
constexpr std::ptrdiff_t kTriedForms = 3;
/// Parameters that a law of another condition may have more than the effect whose place it takes.
constexpr std::size_t kFreedom = 3;

/// Whether a form in the place of an effect is another condition's with a freer shape: of sessions
/// and time in the place of a law, or the other way round.  Two laws of one condition may draw the
/// same line by their shapes alone, and then the plainer one is meant.
bool bends_more(const Candidate& c, const Candidate& own) {
  const auto in_time = [](const Candidate& x) { return x.cause->remedy == Remedy::kProcedure; };
  return c.form.order == 0.0 && own.form.order == 0.0 && in_time(c) != in_time(own) &&
         c.parameters.size() <= own.parameters.size() + kFreedom;
}

bool fits_variables(const Hypothesis& h) {
  return h.value.size() <= static_cast<std::size_t>(kMostParameters);
}

/// An effect to be replaced, and the fit without it.
struct Gap {
  Candidate own;
  Hypothesis rest;  ///< the other effects with their values beside the effect
  Fit fit_rest;
};

/// Forms that may be put in the place of an effect.  One with a constant of its own explains what
/// that constant explains, whatever its law: a law with a level of friction is two, another
/// coefficient and the law, unless the level is there anyway.
/// @param may_have_level  whether forms with a level of friction may be among them
std::vector<Candidate> replacing_forms(const std::vector<Candidate>& all, const Hypothesis& h,
                                       bool may_have_level) {
  std::vector<Candidate> forms = candidates_beside(all, h);
  std::erase_if(forms, [&](const Candidate& c) {
    const bool has_level = !is_parameter(*c.cause) && has_level_parameter(c.parameters);
    return has_start_parameter(c.parameters) || (has_level && !may_have_level);
  });
  return forms;
}

Hypothesis without_cause(const Hypothesis& h, const Cause* cause) {
  for (std::size_t e = 0; e < h.effects.size(); ++e) {
    if (h.effects[e].cause == cause) return without(h, e);
  }
  return h;
}

/// A hypothesis with the level of friction, and a candidate that may have it as a parameter: then
/// in the place of the level.
Hypothesis with_level_and(const Hypothesis& h, const Candidate& level, const Candidate& added) {
  if (has_level_parameter(added.parameters)) return with(without_cause(h, level.cause), added);
  return with(has_cause(h, level.cause) ? h : with(h, level), added);
}

/// Forms of a cause that a screening without an effect says could do what that does.
struct FormsOfCause {
  std::vector<Candidate> likeliest;  ///< the best three at most, the best one first
  /// Beyond them the one that could do most, of more parameters: whether an effect follows another
  /// condition data say whatever the law's shape.
  std::optional<Candidate> freest{};
};
/// By cause in the order of the library.
using FormsByCause = std::vector<FormsOfCause>;
FormsByCause likely_forms(const Judge& judge, const std::vector<Candidate>& others, const Gap& gap,
                          const Fit& start) {
  // The effect itself, last in the pool, says what a replacement has to do: judged alike, by
  // columns that hold for small changes only and with the same rows clipped.
  std::vector<Candidate> pool = candidates_beside(others, start.hypothesis);
  pool.push_back(gap.own);
  const Problem& problem = judge.problem();
  const double wide = std::max(judge.scale(), robust_deviation(start.residual));
  const Columns columns = columns_at(problem, start.hypothesis, pool, wide);
  if (columns.own.cols() >= columns.own.rows()) return {};
  const Screen screen(columns.own, columns.other, blocks_of(pool), problem.noise.known_scale());
  const std::vector<Gain> gains = screen.gains(columns.residual);
  constexpr double kBent = 0.05;  // of what the effect explains: the columns are tangents
  const double needed =
      (1.0 - kBent) * gains.back().sum_of_squares - 3.0 * kAsWell * judge.variance();
  std::vector<std::size_t> order(pool.size() - 1);
  std::iota(order.begin(), order.end(), std::size_t{0});
  // An exponent or a scale of what is 0 does nothing: what such a form can do its columns do not
  // say.
  const auto is_bent = [&](std::size_t k) {
    const Block& block = screen.blocks()[k];
    const auto own = columns.other.middleCols(block.first, block.count);
    return (own.colwise().squaredNorm().array() == 0.0).any();
  };
  constexpr double kOfBent = 0.5;
  std::erase_if(order, [&](std::size_t k) {
    const double gain = gains[k].sum_of_squares;
    const bool may =
        gain >= needed || (gain >= kOfBent * gains.back().sum_of_squares && is_bent(k));
    return !(gain > 0.0 && may) && pool.size() > kFewForms;
  });
  const double unit =
      std::max(kRoundedShare * gains.back().sum_of_squares, std::numeric_limits<double>::min());
  const auto worth = [&](std::size_t k) {
    const double value = gains[k].sum_of_squares -
                         static_cast<double>(pool[k].parameters.size()) *
                             std::log(static_cast<double>(columns.own.rows())) * judge.variance();
    return std::round(value / unit);
  };
  // The pool lists the causes one after the other.
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return pool[a].cause == pool[b].cause ? worth(a) > worth(b) : a < b;
  });
  const double needed_of_freest = gains.back().sum_of_squares - kAsWell * judge.variance();
  const auto gain = [&](std::size_t k) { return gains[k].sum_of_squares; };
  FormsByCause likely;
  for (auto first = order.begin(); first != order.end();) {
    const auto end = std::find_if(
        first, order.end(), [&](std::size_t k) { return pool[k].cause != pool[*first].cause; });
    const auto tried = std::min(end, first + std::min(kTriedForms, end - first));
    FormsOfCause& cause = likely.emplace_back();
    for (auto k = first; k != tried; ++k) cause.likeliest.push_back(pool[*k]);
    double most = needed_of_freest;
    for (auto k = tried; k != end; ++k) {
      if (!bends_more(pool[*k], gap.own) || !(gain(*k) > most)) continue;
      most = gain(*k);
      cause.freest = pool[*k];
    }
    first = end;
  }
  return likely;
}

/// The best of some forms of a cause in the place of an effect.
/// @param level  of friction; null where the data have none
/// @param with_level  whether it is added; a form with a level of its own takes its place anyway
Replacement best_replacement(const Judge& judge, const Fit& best, const Hypothesis& beside,
                             const Candidate* level, bool with_level,
                             std::span<const Candidate> forms) {
  Replacement replacement;
  replacement.statistic = std::numeric_limits<double>::infinity();
  std::vector<Replacement> tried;
  std::vector<Hypothesis> starts;
  for (const Candidate& form : forms) {
    const bool has_level =
        level != nullptr &&
        (with_level || (has_level_parameter(form.parameters) && has_cause(beside, level->cause)));
    Hypothesis h = has_level ? with_level_and(beside, *level, form) : with(beside, form);
    if (!fits_variables(h)) continue;
    tried.push_back({.candidate = form, .with_level = has_level, .statistic = 0.0, .fit = {}});
    starts.push_back(std::move(h));
  }
  std::vector<Fit> fits = fit_all(judge.problem(), starts, judge.scale());
  for (std::size_t k = 0; k < tried.size(); ++k) {
    tried[k].statistic = judge.difference(fits[k], best);
    tried[k].fit = std::move(fits[k]);
    if (tried[k].statistic < replacement.statistic - kSameChi) replacement = std::move(tried[k]);
  }
  return replacement;
}

/// Whether a form with a value for each session, the last effect of a fit, says what all sessions
/// have in common rather than how they differ: that is a constant, and no step.
bool says_what_all_share(const MeasurementSet& data, const Hypothesis& h) {
  if (!gives_each_session_a_value(h.effects.back().form)) return false;
  const auto values = values_of(h, h.effects.size() - 1);
  std::vector<double> rows(values.size(), 0.0);
  for (const Observation& row : data.rows) {
    const auto run = static_cast<std::size_t>(row.condition.run);
    if (row.condition.run >= 0 && run < rows.size()) rows[run] += 1.0;
  }
  const double count = std::accumulate(rows.begin(), rows.end(), 0.0);
  const double mean =
      std::inner_product(rows.begin(), rows.end(), values.begin(), 0.0) / std::max(count, 1.0);
  double squares = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    squares += rows[k] * (values[k] - mean) * (values[k] - mean);
  }
  return squares < count * mean * mean;
}

/// Friction on one side of the pitch point alone is an asymmetry and a level: in the place of the
/// level it explains what the level does.
bool holds_level(const Candidate& c, Kind kind) {
  return kind == Kind::kPairLoss && (c.form.name == "approach" || c.form.name == "recess");
}

/// Whether a replacement explains as well, or draws the same as a law of another condition: then
/// its statistic is that of any shape.
bool stands_as_well(const Judge& judge, const Fit& best, const Gap& gap, Replacement& r) {
  if (!std::isfinite(r.statistic)) return false;
  const bool draws_the_same = !is_level(*gap.own.cause) && bends_more(r.candidate, gap.own) &&
                              judge.draws_the_same(r.fit, best);
  if (draws_the_same) r.statistic = std::min(r.statistic, judge.of_any_shape(r.fit, best));
  return draws_the_same || judge.explains_as_well(r.fit, best);
}

/// What else explains as well in the place of an effect, by itself or with another level.
std::vector<Replacement> replacements_of(const Judge& judge, const SearchResult& result,
                                         const Gap& gap) {
  const Problem& problem = judge.problem();
  const Hypothesis& best = result.fit.hypothesis;
  const Candidate* level = level_of(result);
  std::vector<Replacement> found;
  for (const bool with_level : {false, true}) {
    if (with_level && (level == nullptr || has_cause(best, level->cause))) continue;
    const bool level_stands = level != nullptr && has_cause(gap.rest, level->cause);
    std::vector<Candidate> others =
        replacing_forms(judge.candidates(), best, with_level || level_stands);
    if (is_parameter(*gap.own.cause)) {
      std::erase_if(others,
                    [&](const Candidate& c) { return holds_level(c, problem.simulation.kind()); });
    }
    const Fit start = with_level
                          ? fit(problem, with(gap.fit_rest.hypothesis, *level), judge.scale())
                          : gap.fit_rest;
    // Where the level alone explains, what is added to it explains nothing.
    if (with_level && judge.chi(start) <= judge.chi(result.fit) + kAsWell) continue;
    // From the values beside the effect: without it the others may lie far off.
    for (const FormsOfCause& forms : likely_forms(judge, others, gap, start)) {
      const Cause* cause = forms.likeliest.front().cause;
      const bool named = std::ranges::any_of(
          found, [&](const Replacement& r) { return r.candidate.cause == cause; });
      if (named) continue;
      const auto replaced = [&](std::span<const Candidate> by) {
        return best_replacement(judge, result.fit, gap.rest, level, with_level, by);
      };
      Replacement replacement = replaced(forms.likeliest);
      bool stands = stands_as_well(judge, result.fit, gap, replacement);
      if (!stands && forms.freest) {
        replacement = replaced(std::span(&*forms.freest, 1));
        stands = stands_as_well(judge, result.fit, gap, replacement);
      }
      if (stands && !says_what_all_share(problem.data, replacement.fit.hypothesis) &&
          !is_no_finding(judge, replacement.fit, replacement.fit.hypothesis.effects.size() - 1)) {
        found.push_back(std::move(replacement));
      }
    }
  }
  std::ranges::stable_sort(found, {},
                           [](const Replacement& r) { return std::round(r.statistic / kSameChi); });
  return found;
}

}  // namespace

void refit_beside(const Judge& judge, const SearchResult& result, std::size_t other,
                  std::vector<Replacement>& list) {
  const Candidate* level = level_of(result);
  for (Replacement& r : list) {
    Hypothesis beside = without(result.fit.hypothesis, other);
    if (has_cause(beside, r.candidate.cause)) {
      r.statistic = std::numeric_limits<double>::infinity();
      continue;
    }
    r.fit = fit(judge.problem(),
                r.with_level ? with_level_and(beside, *level, r.candidate)
                             : with(std::move(beside), r.candidate),
                judge.scale());
    r.statistic = judge.difference(r.fit, result.fit);
  }
  std::erase_if(list, [&](const Replacement& r) {
    return !std::isfinite(r.statistic) || !judge.explains_as_well(r.fit, result.fit);
  });
}

std::vector<Candidate> candidates_beside(const std::vector<Candidate>& all, const Hypothesis& h) {
  std::vector<Candidate> result;
  for (const Candidate& c : all) {
    if (!has_cause(h, c.cause)) result.push_back(c);
  }
  return result;
}

namespace {

/// The fit without an effect.
Gap gap_of(const Judge& judge, const SearchResult& result, std::size_t effect) {
  const Hypothesis& best = result.fit.hypothesis;
  const Hypothesis rest = without(best, effect);
  return {.own = best.effects[effect],
          .rest = rest,
          .fit_rest = fit(judge.problem(), rest, judge.scale())};
}

/// p-value and BIC of an effect by what is left without it.
/// @param searched  the effect as it was searched for
void weigh(const Judge& judge, const SearchResult& result, const Gap& gap,
           const Candidate& searched, FoundEffect& found) {
  const double added = judge.chi(gap.fit_rest) - judge.chi(result.fit);
  const auto parameters = static_cast<Eigen::Index>(gap.own.parameters.size());
  const auto rows = static_cast<double>(judge.problem().data.rows.size());
  // Without a known scatter the likelihood is that of the variance which each fit leaves.
  double likelihood_ratio = added;
  double statistic = added;  // as Screen has it: the threshold is one of such statistics
  if (!(judge.problem().noise.known_scale() > 0.0)) {
    const double ln_ratio = std::log(gap.fit_rest.sum_of_squares / result.fit.sum_of_squares);
    const double degrees = rows - static_cast<double>(result.fit.hypothesis.value.size());
    likelihood_ratio = rows * ln_ratio;
    statistic = std::max(degrees - 0.5, 0.0) * ln_ratio;
  }
  const double of_side = blocks_of({searched}).front().side != 0 ? std::numbers::ln2 : 0.0;
  found.p_value = result.first_luck.p_value(chi_square_evidence(statistic, parameters) +
                                            log_weight_of(searched) + of_side);
  found.delta_bic = likelihood_ratio - static_cast<double>(parameters) * std::log(rows);
}

}  // namespace

void weigh_effect(const Judge& judge, const SearchResult& result, std::size_t effect,
                  const Candidate& searched, FoundEffect& found) {
  weigh(judge, result, gap_of(judge, result, effect), searched, found);
}

FoundEffect judge_effect(const Judge& judge, const SearchResult& result, std::size_t effect) {
  const Gap gap = gap_of(judge, result, effect);
  FoundEffect found;
  weigh(judge, result, gap, gap.own, found);
  found.replacements = replacements_of(judge, result, gap);
  return found;
}

}  // namespace gear3k::calibrate
