#include "calibrate/search/search_with_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "calibrate/measurement/row_selection.hpp"

namespace gear3k::calibrate {

namespace {

/// Readings count as independent where such look like these by luck more often.
constexpr double kMemoryChance = 0.03;
/// Where causes were found, memory in their place is tried from here on: the likelihood chooses.
constexpr double kTriedChance = 0.2;

/// What was found under a noise model.
struct SearchUnderNoise {
  SearchResult found{};
  NoiseModel noise{};
  SessionScatter sessions{};
  MemoryEstimate memory{};
};

/// Searches under the problem's noise, and again where sessions scatter.
SearchUnderNoise search_sessions(Problem& problem, const std::vector<Candidate>& candidates,
                                 const SearchOptions& options) {
  SearchUnderNoise result{.found = search_causes(problem, candidates, options)};
  result.sessions = session_scatter(problem, result.found);
  if (result.sessions.guarded > 0.0) {
    problem.noise.session_variance = result.sessions.guarded;
    result.found = search_causes(problem, candidates, options, &result.found);
  }
  result.noise = problem.noise;
  return result;
}

/// What the choice of each cause costs: −2 ln of the share that its form has in the weight before
/// the data of all forms that were looked through.
double choice_cost(const SearchResult& found) {
  double all = 0.0;
  for (const Candidate& c : found.candidates) {
    if (c.form.weight > 0.0) all += std::exp(log_weight_of(c));
  }
  double cost = 0.0;
  for (const Candidate& c : found.fit.hypothesis.effects) {
    cost += 2.0 * std::max(0.0, std::log(all) - log_weight_of(c));
  }
  return cost;
}

/// −2 ln of the likelihood of what was found under its noise, and what its parameters cost, those
/// of the memory and the choice of each cause among them.
double criterion(const Problem& problem, const SearchUnderNoise& s) {
  const auto n = static_cast<double>(problem.data.rows.size());
  const Eigen::VectorXd residual =
      winsorised(s.found.fit.residual, robust_deviation(s.found.fit.residual));
  const double parameters = static_cast<double>(s.found.fit.hypothesis.value.size()) +
                            (s.noise.remembers() ? 2.0 : 0.0) +
                            (s.noise.session_variance > 0.0 ? 1.0 : 0.0);
  return s.noise.log_determinant() + n * std::log(residual.squaredNorm() / n) +
         parameters * std::log(n) + choice_cost(s.found);
}

bool same_causes(const SearchResult& a, const SearchResult& b) {
  const auto& of_a = a.fit.hypothesis.effects;
  const auto& of_b = b.fit.hypothesis.effects;
  return of_a.size() == of_b.size() && std::ranges::all_of(of_a, [&](const Candidate& c) {
           return std::ranges::find(of_b, c.cause, &Candidate::cause) != of_b.end();
         });
}

/// Searches anew under a memory, until what is found has that memory.
SearchUnderNoise search_remembering(Problem& problem, const std::vector<Candidate>& candidates,
                                    const SearchOptions& options, MemoryEstimate memory) {
  constexpr int kPasses = 3;
  SearchUnderNoise result;
  for (int pass = 0; pass < kPasses; ++pass) {
    problem.noise.memory = memory.memory;
    problem.noise.session_variance = 0.0;
    SearchUnderNoise next = search_sessions(problem, candidates, options);
    const bool settled = pass > 0 && same_causes(next.found, result.found);
    result = std::move(next);
    result.memory = memory;
    if (settled || pass + 1 == kPasses) break;
    const MemoryEstimate again = memory_of(problem, result.found.fit.hypothesis, kMemoryChance);
    if (!(again.memory.share > 0.0)) break;
    constexpr double kSame = 0.05;
    if (std::abs(again.memory.correlation() - memory.memory.correlation()) < kSame) break;
    memory = again;
  }
  return result;
}

/// Whether a search under a memory may come out as the better one: readings that remember explain
/// better than what was found, or a part of several causes as well.
bool may_replace(Problem& problem, const NoiseMemory& memory, const SearchUnderNoise& found) {
  if (found.found.effects.size() > 1) return true;
  problem.noise = found.noise;
  problem.noise.memory = memory;
  problem.noise.session_variance = 0.0;
  SearchUnderNoise none{.found = {}, .noise = problem.noise};
  none.found.fit = fit(problem, {}, found.found.scale);
  return criterion(problem, none) < criterion(problem, found);
}

/// The memory that may stand in the place of all that was found; none where the readings do not
/// show one, or where what was found is likelier, whatever the noise remembers, its parameters and
/// the choice of its causes paid for.
std::optional<MemoryEstimate> memory_instead(const Problem& problem,
                                             const SearchUnderNoise& found) {
  const NoiseModel& noise = found.noise;
  const Hypothesis& h = found.found.fit.hypothesis;
  if (!noise.order.known() || noise.weight.size() < kFewestRememberingRows || h.effects.empty()) {
    return std::nullopt;
  }
  const Linearisation causes_at = linearise(problem, h, {});
  const Linearisation given = linearise(problem, {}, {});
  // The same rows are far off with the causes and without.
  const Eigen::VectorXd weighted =
      (measured(problem.data) - causes_at.simulated).cwiseProduct(noise.weight);
  const Eigen::VectorXd missed =
      winsorised(weighted, robust_deviation(weighted)).cwiseQuotient(noise.weight);
  const MemoryEvidence with_causes = memory_evidence(noise, missed, causes_at.own, kTriedChance);
  NoiseModel alone = noise;
  alone.session_variance = 0.0;
  const MemoryEvidence without = memory_evidence(
      alone, missed + causes_at.simulated - given.simulated, given.own, kTriedChance);
  if (!(without.likeliest.memory.share > 0.0)) return std::nullopt;
  const double log_n = std::log(static_cast<double>(missed.size()));
  const double cost =
      (static_cast<double>(h.value.size()) + (noise.session_variance > 0.0 ? 1.0 : 0.0)) * log_n +
      choice_cost(found.found);
  if (with_causes.twice_log_likelihood - cost > without.twice_log_likelihood) return std::nullopt;
  return without.likeliest;
}

/// The search in all rows of a problem.
SearchResult search_in_all(Problem& problem, const std::vector<Candidate>& candidates,
                           const SearchOptions& options, const std::function<bool(double)>& tell,
                           SessionScatter& sessions, MemoryEstimate& memory,
                           std::vector<std::string>& notes) {
  SearchResult first = search_causes(problem, candidates, options);
  if (!tell(0.4)) return first;
  if (const auto weights = weights_by_response(problem, first)) {
    problem.noise.weight = *weights;
    notes.emplace_back("the noise grows with the response: rows are weighted accordingly");
    first = search_causes(problem, candidates, options);
  }
  SearchUnderNoise best{.found = std::move(first)};
  best.sessions = session_scatter(problem, best.found);
  if (best.sessions.guarded > 0.0) {
    problem.noise.session_variance = best.sessions.guarded;
    best.found = search_causes(problem, candidates, options, &best.found);
  }
  best.noise = problem.noise;
  // Of what was found, and of all that the simulation as given misses: causes may have taken up
  // what the noise remembers, and noise may seem to remember what causes do.
  const MemoryEstimate beside = memory_of(problem, best.found.fit.hypothesis, kMemoryChance);
  const bool remembers = beside.memory.share > 0.0;
  const MemoryEstimate alone =
      best.found.effects.empty() ? beside : memory_of(problem, Hypothesis{}, kTriedChance);
  if (remembers) best = search_remembering(problem, candidates, options, beside);
  if (alone.memory.share > 0.0 && !best.found.effects.empty() &&
      may_replace(problem, alone.memory, best)) {
    SearchUnderNoise other = search_remembering(problem, candidates, options, alone);
    if (!same_causes(other.found, best.found) &&
        criterion(problem, other) < criterion(problem, best)) {
      best = std::move(other);
    }
  }
  // What memory alone explains as well is said only where it stands out under that memory, too; not
  // where what looks like memory is a wave.
  const bool waves = (beside.p_value <= kMemoryChance && !remembers) ||
                     (alone.p_value <= kMemoryChance && !(alone.memory.share > 0.0));
  const auto instead = waves ? std::nullopt : memory_instead(problem, best);
  if (instead) {
    problem.noise = best.noise;
    problem.noise.memory = instead->memory;
    problem.noise.session_variance = 0.0;
    SearchUnderNoise other = search_sessions(problem, candidates, options);
    if (other.found.effects.size() < best.found.effects.size()) {
      other.memory = *instead;
      best = std::move(other);
    }
  }
  problem.noise = best.noise;
  sessions = best.sessions;
  memory = best.memory;
  return std::move(best.found);
}

/// Random places of rows, as many as a search needs: what so many do not show is nothing.
std::vector<std::size_t> thinned(std::size_t count, std::size_t wanted, std::uint64_t seed) {
  // Selection sampling: each set of so many rows is as likely, and their order stays.
  std::vector<std::size_t> places;
  places.reserve(wanted);
  RandomBits random(seed + 99);
  for (std::size_t i = 0; i < count; ++i) {
    const auto more = static_cast<double>(wanted - places.size());
    if (random.uniform() * static_cast<double>(count - i) < more) places.push_back(i);
  }
  return places;
}

}  // namespace

SearchResult search_with_noise(Problem& problem, const std::vector<Candidate>& candidates,
                               const SearchOptions& options,
                               const std::function<bool(double)>& tell, SessionScatter& sessions,
                               MemoryEstimate& memory, std::vector<std::string>& notes) {
  constexpr std::size_t kEnough = 12000;
  if (problem.data.rows.size() <= 2 * kEnough) {
    return search_in_all(problem, candidates, options, tell, sessions, memory, notes);
  }
  const std::vector<std::size_t> places = thinned(problem.data.rows.size(), kEnough, options.seed);
  const MeasurementSet some = select_rows(problem.data, places);
  Problem part{.simulation = problem.simulation, .data = some, .noise = make_noise_model(some)};
  part.noise.order = subset_of(problem.noise.order, places);
  SearchResult found = search_in_all(part, candidates, options, tell, sessions, memory, notes);
  problem.noise.session_variance = part.noise.session_variance;
  problem.noise.memory = part.noise.memory;
  found.fit = fit(problem, found.fit.hypothesis, found.scale);
  if (const auto weights = weights_by_response(problem, found)) {
    problem.noise.weight = *weights;
    found.fit = fit(problem, found.fit.hypothesis, found.scale);
  }
  notes.push_back(
      fmt::format("causes were searched for in {} of {} rows, at random places, and "
                  "fitted to all",
                  kEnough, problem.data.rows.size()));
  return found;
}

}  // namespace gear3k::calibrate
