#include "calibrate/series/series_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibrate/fit/columns.hpp"
#include "calibrate/fit/screen.hpp"
#include "calibrate/search/replacements.hpp"
#include "numerics/parallel.hpp"

namespace gear3k::calibrate {

namespace {

constexpr int kMostSeriesEffects = 4;
/// Share of the rate that each further effect gets, as in the search of one gearbox.
constexpr double kFurtherSeriesShare = 0.4;
constexpr int kSeriesDraws = 192;
constexpr std::size_t kSeriesFitsPerStep = 5;

/// All gearboxes' rows, one after the other, in standard deviations: what is fitted has a column
/// for each gearbox, candidates have one for all (first half of the blocks) and one for each.
struct Stacked {
  Eigen::VectorXd residual;
  Eigen::MatrixXd own, columns;
  std::vector<Block> blocks;  ///< two of each candidate: common, by gearbox
  double known_scale = 0.0;   ///< 1 where all gearboxes state theirs
};

/// Rows of all gearboxes that a screening looks at; of more, as many at random places: what they do
/// not show is nothing, and the columns of each gearbox would take gigabytes.
constexpr std::size_t kScreenedRows = 12000;

/// A share of the rows of one gearbox at random places, in their order.
Columns thinned_columns(Columns c, double share, std::uint64_t seed) {
  const std::vector<Eigen::Index> kept = places_at_random(c.residual.size(), share, seed);
  return {.residual = c.residual(kept),
          .raw = c.raw(kept),
          .own = c.own(kept, Eigen::all),
          .other = c.other(kept, Eigen::all)};
}

Stacked stacked(const std::deque<SeriesUnit>& units, const JointStart& at,
                const std::vector<Candidate>& candidates) {
  std::vector<Columns> of(units.size());
  std::size_t all_rows = 0;
  for (const SeriesUnit& unit : units) all_rows += unit.data.rows.size();
  const double share = static_cast<double>(kScreenedRows) / static_cast<double>(all_rows);
  numerics::parallel_for(
      units.size(),
      [&](std::size_t u) {
        of[u] = columns_at(units[u].problem, at.hypothesis[u], candidates, at.scale[u]);
        if (share < 1.0) of[u] = thinned_columns(std::move(of[u]), share, 77 + u);
      },
      has_many_rows(units));
  const std::vector<Block> single = blocks_of(candidates);
  Eigen::Index rows = 0;
  for (const Columns& c : of) rows += c.residual.size();
  const auto count = static_cast<Eigen::Index>(units.size());
  const Eigen::Index own = of.front().own.cols();
  const Eigen::Index other = of.front().other.cols();
  Stacked all{.residual = Eigen::VectorXd(rows),
              .own = Eigen::MatrixXd::Zero(rows, own * count),
              .columns = Eigen::MatrixXd::Zero(rows, other * (count + 1)),
              .blocks = {}};
  Eigen::Index row = 0;
  all.known_scale = 1.0;
  for (Eigen::Index u = 0; u < count; ++u) {
    const auto place = static_cast<std::size_t>(u);
    const Columns& c = of[place];
    const double scale = at.scale[place];
    const Eigen::Index n = c.residual.size();
    all.residual.segment(row, n) = c.residual / scale;
    all.own.block(row, own * u, n, own) = c.own / scale;
    all.columns.block(row, 0, n, other) = c.other / scale;
    for (const Block& b : single) {
      // By gearbox: the columns of one candidate stand together.
      all.columns.block(row, other + b.first * count + b.count * u, n, b.count) =
          c.other.middleCols(b.first, b.count) / scale;
    }
    if (!(units[place].problem.noise.known_scale() > 0.0)) all.known_scale = 0.0;
    row += n;
  }
  for (const Block& b : single) all.blocks.push_back(b);
  for (const Block& b : single) {
    all.blocks.push_back({.first = other + b.first * count,
                          .count = b.count * count,
                          .side = 0,
                          .log_weight = b.log_weight});
  }
  return all;
}

/// The greater gain of both ways in which a candidate may act.
std::vector<Gain> best_gains(const std::vector<Gain>& gains) {
  const std::size_t count = gains.size() / 2;
  std::vector<Gain> best(gains.begin(), gains.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t k = 0; k < count; ++k) {
    if (gains[count + k].evidence > best[k].evidence) best[k] = gains[count + k];
  }
  return best;
}

Hypothesis hypothesis_of(const JointFit& fit) { return fit.units.front().fit.hypothesis; }

/// Candidates of other causes by their evidence in what a start leaves.
struct Proposed {
  std::vector<Candidate> others;
  std::vector<std::size_t> order;
  double p_value = 1.0;  ///< of the greatest evidence
};
Proposed proposals(const std::deque<SeriesUnit>& units, const JointStart& at,
                   const std::vector<Candidate>& candidates, const SearchOptions* test,
                   std::uint64_t stream) {
  Proposed result{.others = candidates_beside(candidates, at.hypothesis.front()), .order = {}};
  if (result.others.empty()) return result;
  Stacked all = stacked(units, at, result.others);
  if (all.own.cols() >= all.residual.size()) return result;
  const Screen screen(all.own, std::move(all.columns), all.blocks, all.known_scale);
  const std::vector<Gain> gains = best_gains(screen.gains(all.residual));
  result.order = ranked(result.others, gains, 2);
  if (test == nullptr || result.order.empty()) return result;
  result.p_value = screen.luck(all.residual, test->rate, kSeriesDraws, test->seed + stream)
                       .p_value(gains[result.order.front()].evidence);
  return result;
}

/// Adds causes as long as they are more than luck and the score falls.
JointFit grown(const std::deque<SeriesUnit>& units, const std::vector<Candidate>& candidates,
               const SearchOptions& options, JointFit best, JointStart at) {
  while (static_cast<int>(best.effects.size()) < kMostSeriesEffects) {
    const bool first = best.effects.empty();
    const Proposed next = proposals(units, at, candidates, &options, 40 + best.effects.size());
    const double rate = first ? options.rate : kFurtherSeriesShare * options.rate;
    if (next.order.empty() || next.p_value > rate) break;
    std::optional<JointFit> winner;
    for (std::size_t k = 0; k < next.order.size() && k < kSeriesFitsPerStep; ++k) {
      const Candidate& candidate = next.others[next.order[k]];
      if (hypothesis_of(best).value.size() + candidate.parameters.size() >
          static_cast<std::size_t>(kMostParameters)) {
        continue;
      }
      JointFit trial = joint_fit(units, start_with(at, candidate));
      if (!winner || trial.score < winner->score) winner = std::move(trial);
    }
    if (!winner || !(winner->score < best.score)) break;
    at = start_at(*winner);
    best = joint_fit(units, at);  // at the scales of its own
  }
  return best;
}

/// Every effect against the best other causes in its place.
bool exchanged(const std::deque<SeriesUnit>& units, const std::vector<Candidate>& candidates,
               SeriesSearch& search) {
  JointFit& best = search.fit;
  search.alternatives.assign(best.effects.size(), {});
  const JointStart at = start_at(best);
  best = joint_fit(units, at);  // at the scales of what it is compared with
  std::optional<JointFit> better;
  for (std::size_t e = 0; e < best.effects.size(); ++e) {
    JointStart rest = start_without(at, e);
    const JointFit without_it = joint_fit(units, rest);
    for (std::size_t u = 0; u < units.size(); ++u) {
      rest.hypothesis[u] = without_it.units[u].fit.hypothesis;
    }
    const Proposed next = proposals(units, rest, candidates, nullptr, 0);
    std::size_t tried = 0;
    for (const std::size_t k : next.order) {
      if (tried == kSeriesFitsPerStep) break;
      const Candidate& candidate = next.others[k];
      const Hypothesis own{.effects = {best.effects[e]}, .value = {}};
      if (same_forms({.effects = {candidate}, .value = {}}, own) &&
          candidate.form.body == best.effects[e].form.body) {
        continue;
      }
      ++tried;
      JointFit trial = joint_fit(units, start_with(rest, candidate));
      const std::string id(candidate.cause->id);
      std::vector<std::string>& as_well = search.alternatives[e];
      if (trial.score < best.score + kSeriesAsWell && candidate.cause != best.effects[e].cause &&
          std::ranges::find(as_well, id) == as_well.end()) {
        as_well.push_back(id);
      }
      const double least = better ? better->score : best.score;
      if (trial.score < least - 1e-6) better = std::move(trial);
    }
  }
  if (!better) return false;
  best = joint_fit(units, start_at(*better));
  return true;
}

}  // namespace

std::vector<Candidate> series_candidates(const Simulation& simulation, const MeasurementSet& data) {
  std::vector<Candidate> all = candidates_for(simulation, data);
  std::erase_if(all, [](const Candidate& c) {
    return c.cause->remedy == Remedy::kProcedure || !(c.form.weight > 0.0);
  });
  return all;
}

JointFit needed(const std::deque<SeriesUnit>& units, JointFit fit) {
  for (bool again = !fit.effects.empty(); again;) {
    again = false;
    const JointStart at = start_at(fit);
    fit = joint_fit(units, at);
    for (std::size_t e = 0; e < fit.effects.size() && !again; ++e) {
      JointFit trial = joint_fit(units, start_without(at, e));
      again = trial.score < fit.score;
      if (again) fit = std::move(trial);
    }
    again = again && !fit.effects.empty();
  }
  return fit;
}

SeriesSearch search_series(const std::deque<SeriesUnit>& units,
                           const std::vector<Candidate>& candidates, const SearchOptions& options) {
  const JointStart start = unfitted(units);
  SeriesSearch search{.fit = joint_fit(units, start), .alternatives = {}};
  search.fit = grown(units, candidates, options, std::move(search.fit), start);
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds && !search.fit.effects.empty(); ++round) {
    if (!exchanged(units, candidates, search)) break;
    search.fit = needed(units, std::move(search.fit));
    const JointStart at = start_at(search.fit);
    search.fit = grown(units, candidates, options, joint_fit(units, at), at);
  }
  const std::size_t effects = search.fit.effects.size();
  search.fit = needed(units, std::move(search.fit));
  const bool known = search.fit.effects.size() == effects && search.alternatives.size() == effects;
  for (int round = 0; round < kRounds && !known; ++round) {
    if (!exchanged(units, candidates, search)) break;
  }
  return search;
}

double series_session_variance(const std::deque<SeriesUnit>& units, const JointFit& fit) {
  double between = 0.0;
  double within = 0.0;
  double rows = 0.0;
  int sessions = 0;
  int gearboxes = 0;
  for (std::size_t u = 0; u < units.size(); ++u) {
    const NoiseModel& noise = units[u].problem.noise;
    if (noise.runs < 2) continue;
    // Whitened by weights alone: what sessions share must stay in.
    Eigen::VectorXd r =
        (measured(units[u].data) - fit.units[u].fit.simulated).cwiseProduct(noise.weight) /
        fit.units[u].scale;
    r = winsorised(r, 1.0);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(noise.runs);
    double total = 0.0;
    double count = 0.0;
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const int run = noise.run[static_cast<std::size_t>(i)];
      if (run < 0) continue;
      sum[run] += r[i];
      total += r[i];
      count += 1.0;
    }
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const int run = noise.run[static_cast<std::size_t>(i)];
      if (run < 0) continue;
      const double d = r[i] - sum[run] / noise.rows_per_run[static_cast<std::size_t>(run)];
      within += d * d;
    }
    for (int s = 0; s < noise.runs; ++s) {
      const double n = noise.rows_per_run[static_cast<std::size_t>(s)];
      const double d = sum[s] / n - total / count;
      between += n * d * d;
    }
    rows += count;
    sessions += noise.runs;
    ++gearboxes;
  }
  const int degrees = sessions - gearboxes;
  const int pure = static_cast<int>(rows) - sessions;
  if (degrees < 1 || pure < 1 || !(within > 0.0)) return 0.0;
  const double f = between / degrees / (within / pure);
  constexpr double kRate = 0.01;
  if (f_tail(f, degrees, pure) > kRate) return 0.0;
  return std::max(0.0, f - 1.0) * sessions / rows;
}

}  // namespace gear3k::calibrate
