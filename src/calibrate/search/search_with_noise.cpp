#include "calibrate/search/search_with_noise.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace gear3k::calibrate {

namespace {

/// The search in all rows of a problem.
SearchResult search_in_all(Problem& problem, const std::vector<Candidate>& candidates,
                           const SearchOptions& options, const std::function<bool(double)>& tell,
                           SessionScatter& sessions, std::vector<std::string>& notes) {
  SearchResult found = search_causes(problem, candidates, options);
  if (!tell(0.4)) return found;
  if (const auto weights = weights_by_response(problem, found)) {
    problem.noise.weight = *weights;
    notes.emplace_back("the noise grows with the response: rows are weighted accordingly");
    found = search_causes(problem, candidates, options);
  }
  sessions = session_scatter(problem, found);
  if (sessions.guarded > 0.0) {
    problem.noise.session_variance = sessions.guarded;
    found = search_causes(problem, candidates, options);
  }
  return found;
}

/// Rows at random places, as many as a search needs: what so many do not show is nothing.
MeasurementSet thinned(const MeasurementSet& data, std::size_t rows, std::uint64_t seed) {
  MeasurementSet result = data;
  result.rows.clear();
  for (Covariate& c : result.covariates) c.value.clear();
  // Selection sampling: each set of so many rows is as likely, and their order stays.
  RandomBits random(seed + 99);
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const auto wanted = static_cast<double>(rows - result.rows.size());
    const auto left = static_cast<double>(data.rows.size() - i);
    if (!(random.uniform() * left < wanted)) continue;
    result.rows.push_back(data.rows[i]);
    for (std::size_t k = 0; k < data.covariates.size(); ++k) {
      result.covariates[k].value.push_back(data.covariates[k].value[i]);
    }
  }
  return result;
}

}  // namespace

SearchResult search_with_noise(Problem& problem, const std::vector<Candidate>& candidates,
                               const SearchOptions& options,
                               const std::function<bool(double)>& tell, SessionScatter& sessions,
                               std::vector<std::string>& notes) {
  constexpr std::size_t kEnough = 12000;
  if (problem.data.rows.size() <= 2 * kEnough) {
    return search_in_all(problem, candidates, options, tell, sessions, notes);
  }
  const MeasurementSet some = thinned(problem.data, kEnough, options.seed);
  Problem part{.simulation = problem.simulation, .data = some, .noise = make_noise_model(some)};
  SearchResult found = search_in_all(part, candidates, options, tell, sessions, notes);
  problem.noise.session_variance = part.noise.session_variance;
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
