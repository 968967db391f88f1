#include "calibrate/verdict/posterior.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace gear3k::calibrate {

namespace {

// Odds of no cause and of the name fitted by likelihood to 9,322 effects that campaigns of the wide
// rig (seeds from 2001, 3001 and 4001 on, strengths 0 to 16) were said to have, what an alternative
// loses to how often such probabilities held in 11,232 campaigns (seeds from 5001 and 6001 on);
// benchmarks/must_show tells how often they are right on other seeds.

/// An alternative that is behind by χ² is less likely by (1 + χ²/kBehind)^-kTail, about as much as
/// exp(−χ²/2) says while it is near and ever less beyond: a law of slightly another shape than the
/// true one misses by more than noise.  One that is ahead counts as exp(−χ²/(2 kTemper)).
constexpr double kBehind = 5.7, kTail = 3.0, kTemper = 2.0;
/// ln of the odds of the name over an alternative that is as good: the search chose it by more than
/// χ², and prefers parameters.
constexpr double kNamed = 0.55;
/// ln of the odds of no cause: a − b ln ΔBIC, more where structure is left or several effects act.
constexpr double kNoCause = 4.14, kByBic = 1.78, kBesideStructure = 1.78, kOfSeveral = 2.16;

}  // namespace

std::vector<CauseEvidence> first_evidence(const SearchResult& found) {
  const double ln_rows = std::log(static_cast<double>(found.rows));
  std::vector<CauseEvidence> result;
  for (std::size_t k = 0; k < found.candidates.size(); ++k) {
    const Gain& gain = found.first_gains[k];
    const auto parameters = static_cast<double>(found.candidates[k].parameters.size());
    const CauseEvidence evidence{.id = std::string(found.candidates[k].cause->id),
                                 .delta_bic = gain.likelihood_ratio - parameters * ln_rows,
                                 .evidence = gain.evidence};
    const auto at = std::ranges::find(result, evidence.id, &CauseEvidence::id);
    if (at == result.end()) {
      result.push_back(evidence);
    } else if (evidence.evidence > at->evidence) {
      *at = evidence;
    }
  }
  std::ranges::stable_sort(result, std::greater<>(), &CauseEvidence::evidence);
  return result;
}

void set_posteriors(std::vector<Effect>& effects, bool structure) {
  const double odds =
      kNoCause + (structure ? kBesideStructure : 0.0) + (effects.size() > 1 ? kOfSeveral : 0.0);
  for (Effect& effect : effects) {
    // Beyond what explains as well the name is the one that the search took.
    constexpr double kAsWell = 6.0;
    const auto likelihood = [](double statistic) {
      return statistic > 0.0 ? std::pow(1.0 + statistic / kBehind, -kTail)
                             : std::exp(-0.5 * std::max(statistic, -kAsWell) / kTemper);
    };
    const double named = std::exp(kNamed);
    double sum = named;
    for (const Alternative& a : effect.alternatives) sum += likelihood(a.statistic);
    constexpr double kLeast = 0.1;
    effect.no_cause =
        1.0 / (1.0 + std::exp(kByBic * std::log(std::max(effect.delta_bic, kLeast)) - odds));
    const double some = 1.0 - effect.no_cause;
    effect.probability = some * named / sum;
    for (Alternative& a : effect.alternatives) a.probability = some * likelihood(a.statistic) / sum;
  }
}

}  // namespace gear3k::calibrate
