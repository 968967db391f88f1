#include "optimize/zero_shift.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "efficiency/train_efficiency.hpp"
#include "numerics/parallel.hpp"
#include "optimize/refinement_problem.hpp"

namespace gear3k::optimize {

namespace {

/// Sets that are at hand when they are visited.
constexpr std::size_t kVisitedTogether = 16'384;

/// Calls body(k) for k in [0, count) in OpenMP threads, some at a time.
template <class Body>
void parallel_in_blocks(std::size_t count, const Body& body) {
  constexpr std::size_t kBlock = 256;
  numerics::parallel_for((count + kBlock - 1) / kBlock, [&](std::size_t block) {
    for (std::size_t k = block * kBlock; k < std::min(count, (block + 1) * kBlock); ++k) body(k);
  });
}

ZeroShiftSet at_zero_shift(const Specification& spec, const Candidate& candidate) {
  const train::ToothSet& z = candidate.teeth;
  const double m1 = length_scale_m(spec);
  const double d = 0.5 * m1 * (z.R1 - z.P1);
  const double m2 = 2.0 * d / (z.R2 - z.P2);
  ZeroShiftSet set{.candidate = candidate, .ratio = train::ratio(z), .module_ratio = m2 / m1};
  train::TrainParameters<double> parameters = unrefined_train(spec, candidate);
  parameters.center_distance_m = d;
  parameters.module_m = {m1, m2};
  const auto train = train::make_train_geometry(parameters);
  if (!train) return set;
  set.defined = true;
  const auto j = backlash::normal_backlashes(*train);
  // At this distance P1-R1 and P2-R2 close exactly; what is left of them is rounding.
  set.meshes = *std::min_element(j.begin(), j.end()) >= -1e-9 * m1;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    set.contact_ratio[k] = train->meshes[k].contact_ratio;
    set.meshes = set.meshes && set.contact_ratio[k] >= 1.0;
  }
  set.sun_backlash = j[0] / m1;
  set.lost_motion_rad = backlash::output_lost_motion(*train, j, spec.limits.model);
  const auto eta = [&](bool forward) {
    return efficiency::mesh_efficiencies(
        *train, efficiency::constant_friction<double>(spec.friction, train->teeth, forward),
        spec.friction.model, forward);
  };
  set.eta_b = efficiency::backward_efficiency(z, eta(false));
  set.eta_f = efficiency::forward_efficiency(z, eta(true));
  return set;
}

}  // namespace

ZeroShiftRanking::ZeroShiftRanking(Specification spec, std::size_t most)
    : spec_(std::move(spec)), most_(most) {}

bool ZeroShiftRanking::before(const Place& a, const Place& b) {
  const auto key = [](const Place& p) {
    return std::tuple(!p.meshes, !p.defined, p.cost, p.candidate.planets, p.candidate.teeth);
  };
  return key(a) < key(b);
}

void ZeroShiftRanking::drop_last() {
  const auto end = places_.begin() + static_cast<std::ptrdiff_t>(most_);
  std::nth_element(places_.begin(), end, places_.end(), before);
  places_.erase(end, places_.end());
}

void ZeroShiftRanking::add(std::span<const Candidate> candidates) {
  const bool forward = first_objective(spec_) == Objective::kForwardEfficiency;
  const std::size_t held = places_.size();
  places_.resize(held + candidates.size());
  parallel_in_blocks(candidates.size(), [&](std::size_t k) {
    const ZeroShiftSet set = at_zero_shift(spec_, candidates[k]);
    const double cost = forward ? -set.eta_f : -set.eta_b;
    places_[held + k] = {.candidate = candidates[k],
                         .cost = std::isnan(cost) ? std::numeric_limits<double>::infinity() : cost,
                         .meshes = set.meshes,
                         .defined = set.defined};
  });
  added_ += candidates.size();
  if (places_.size() / 2 > most_) drop_last();
}

void ZeroShiftRanking::for_each(const std::function<void(const ZeroShiftSet&)>& visit) {
  if (places_.size() > most_) drop_last();
  std::sort(places_.begin(), places_.end(), before);
  std::vector<ZeroShiftSet> piece;
  for (std::size_t begin = 0; begin < places_.size(); begin += piece.size()) {
    piece.resize(std::min(kVisitedTogether, places_.size() - begin));
    parallel_in_blocks(piece.size(), [&](std::size_t k) {
      piece[k] = at_zero_shift(spec_, places_[begin + k].candidate);
    });
    for (const ZeroShiftSet& set : piece) visit(set);
  }
}

std::vector<ZeroShiftSet> rank_at_zero_shift(const Specification& spec,
                                             const std::vector<Candidate>& candidates) {
  ZeroShiftRanking ranking(spec);
  ranking.add(candidates);
  std::vector<ZeroShiftSet> sets;
  sets.reserve(candidates.size());
  ranking.for_each([&](const ZeroShiftSet& set) { sets.push_back(set); });
  return sets;
}

}  // namespace gear3k::optimize
