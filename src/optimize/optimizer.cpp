#include "optimize/optimizer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "numerics/parallel.hpp"
#include "optimize/objective_value.hpp"

namespace gear3k::optimize {

namespace {

/// The refinement of one task's sets.
class Run {
 public:
  Run(const Specification& spec, Progress& progress, const OptimizeOptions& options,
      OptimizeResult& result)
      : spec_(spec),
        progress_(progress),
        options_(options),
        result_(result),
        refiner_(spec),
        no_gain_(is_efficiency(first_objective(spec))
                     ? 0.0
                     : 4.0 * design::kFeasibilityTolerance *
                           objective_scale(first_objective(spec), spec)) {}

  /// Leaves out the sets that are no better than the design to begin with.
  void screen() {
    std::vector<Candidate>& all = result_.search.candidates;
    std::vector<char> open(all.size(), 1);
    before_.assign(options_.bound_before ? all.size() : 0, kInfinity);
    const auto& incumbent = options_.incumbent;
    const double floor = incumbent ? merit_of(spec_, *incumbent) + no_gain_ : -kInfinity;
    if (options_.bound_before) {
      numerics::parallel_for(all.size(), [&](std::size_t k) {
        const bool own = incumbent && all[k] == incumbent->candidate;
        before_[k] = options_.bound_before(all[k]);
        open[k] = own || before_[k] > floor ? 1 : 0;
      });
      std::size_t kept = 0;
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (open[k] == 0) continue;
        before_[kept] = before_[k];
        all[kept++] = all[k];
      }
      all.resize(kept);
    }
    if (!incumbent) return;
    const auto own = std::ranges::find(all, incumbent->candidate);
    if (own == all.end()) return;
    result_.best = incumbent;
    result_.best->index = static_cast<std::uint32_t>(own - all.begin());
  }

  void bound() {
    progress_.total = 0;  // while done and phase change, nothing is known
    progress_.done = 0;
    progress_.phase = Progress::Phase::kBounds;
    bounds_ = std::make_shared<SetBounds>(spec_, result_.search.candidates, progress_);
    result_.bounds = bounds_;
    if (options_.best_only || !bounds_->ties() || progress_.stop.load()) return;
    std::vector<std::uint32_t> all(result_.search.candidates.size());
    std::iota(all.begin(), all.end(), 0U);
    bounds_->tie(all, progress_);
  }

  /// The sets in the order in which they are to be refined.
  std::vector<std::uint32_t> ordered() {
    const std::size_t count = result_.search.candidates.size();
    std::vector<std::uint32_t> order;
    order.reserve(count);
    bound_.resize(count);
    infeasible_.resize(count);
    to_beat_.assign(count, std::numeric_limits<double>::quiet_NaN());
    numerics::parallel_for((count + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t k = block * kBlock; k < std::min(count, (block + 1) * kBlock); ++k) {
        take_bound(k);
      }
    });
    for (std::size_t k = 0; k < count; ++k) {
      if (may_have_design(k)) order.push_back(static_cast<std::uint32_t>(k));
    }
    progress_.open = order.size();
    if (options_.best_only) sort_by_bound(order);
    return order;
  }

  /// Of a run that was ended: the sets that are known, as far as it did not come to them.
  void take_known() {
    std::vector<RefinedSet>& refined = result_.refined;
    for (const RefinedSet& set : options_.known) {
      if (set.index >= result_.search.candidates.size()) continue;
      const auto same = std::ranges::lower_bound(refined, set.index, {}, &RefinedSet::index);
      if (same != refined.end() && same->index == set.index) continue;
      refined.insert(same, set);
      offer(set, result_.best);
    }
  }

  void refine_all() {
    Contest all{.planets = std::nullopt, .order = ordered()};
    begin_refinement(all.order.size());
    progress_.to_sharpen = progress_.later_sets = progress_.later_bounds = 0;
    progress_.feasible = 0;
    progress_.best_merit = -std::numeric_limits<double>::infinity();
    const ObjectiveRecord& first = objective_record(first_objective(spec_));
    progress_.shown_per_merit = sense_of(first.id) / first.per_unit;
    all.best = result_.best;
    refine(all);
    result_.best = all.best;
    result_.interrupted = progress_.stop.load();
    std::ranges::sort(result_.refined, {}, &RefinedSet::index);
    if (!options_.best_only || !options_.certify || result_.interrupted || !result_.best) return;
    result_.certificate = certificate_of(all);
    if (progress_.stop.load()) {
      result_.certificate.reset();
      result_.interrupted = true;
    } else if (options_.per_planets) {
      prove_each_number_of_planets();
    }
  }

 private:
  static constexpr std::size_t kBlock = 1024;
  /// Sets whose stages are tied at once, where only the best are.
  static constexpr std::size_t kTied = 512;

  /// Sets among which the best is sought.
  struct Contest {
    std::optional<int> planets;        ///< theirs; empty: of all
    std::vector<std::uint32_t> order;  ///< those that may have a design, in the order of refinement
    std::vector<std::uint32_t> waiting{};  ///< to be refined, in this order
    std::size_t taken = 0;                 ///< sets of the order that waited so far
    std::optional<RefinedSet> best{};
    std::size_t refined = 0;
  };

  /// What is known of a number of planets whose turn is to come.
  struct Later {
    double best = -kInfinity;
    std::size_t sets = 0;  ///< of its first wave
  };

  /// From how much above the best on a refined set may hold something better.
  [[nodiscard]] double proven_merit() const {
    return kProven * objective_scale(first_objective(spec_), spec_) + no_gain_;
  }

  void take_bound(std::size_t k) {
    const SetBound bound = bounds_->of(k);
    infeasible_[k] = bound.infeasible ? 1 : 0;
    bound_[k] = merit_within(k, bound);
  }

  /// As far as bounds and what the objectives are limited to tell.
  [[nodiscard]] bool may_have_design(std::size_t k) const {
    return infeasible_[k] == 0 && bound_[k] > -kInfinity;
  }

  [[nodiscard]] bool is_refined(std::size_t k) const { return !std::isnan(to_beat_[k]); }

  /// Greatest bound first, the order of the search among equals.
  void sort_by_bound(std::vector<std::uint32_t>& sets) const {
    std::ranges::sort(sets, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(-bound_[a], a) < std::pair(-bound_[b], b);
    });
  }

  /// What a set's design can have at most, by its bound and by what is known before.
  [[nodiscard]] double merit_within(std::size_t k, const SetBound& bound) const {
    const double own = merit_bound(spec_, bound, result_.search.candidates[k]);
    return before_.empty() ? own : std::min(own, before_[k]);
  }

  [[nodiscard]] bool may_win(const Contest& contest, std::uint32_t k) const {
    if (!options_.best_only || !contest.best) return true;
    return bound_[k] > merit_of(spec_, *contest.best) + no_gain_;
  }

  void begin_refinement(std::size_t sets) {
    progress_.total = 0;
    progress_.done = 0;
    progress_.phase = Progress::Phase::kRefinement;
    progress_.total = sets;
  }

  void refine(Contest& contest) {
    std::size_t size = options_.best_only ? kFirstWave : kWave;
    while (!progress_.stop.load() && result_.refined.size() < options_.most_refined) {
      const std::vector<std::uint32_t> wave = next_wave(contest, size);
      if (wave.empty()) break;
      refine_wave(contest, wave);
      if (options_.any && contest.best) break;
      size = std::min(2 * size, kWave);
    }
  }

  /// Ties the next sets of the order, and puts those that may win among the waiting ones; a run
  /// that is stopped meanwhile leaves them where they are.
  void take_more(Contest& contest) {
    const std::size_t end = std::min(contest.order.size(), contest.taken + kTied);
    const std::span<const std::uint32_t> more{contest.order.data() + contest.taken,
                                              end - contest.taken};
    if (!bounds_->tie(more, progress_, false)) return;
    contest.taken = end;
    for (const std::uint32_t k : more) {
      take_bound(k);
      if (may_have_design(k)) contest.waiting.push_back(k);
    }
    sort_by_bound(contest.waiting);
  }

  /// The next sets to refine: by falling bound where only the best are, each tied before.
  std::vector<std::uint32_t> next_wave(Contest& contest, std::size_t size) {
    const std::vector<std::uint32_t>& order = contest.order;
    std::vector<std::uint32_t>& waiting = contest.waiting;
    const auto next = [&] {
      return contest.taken < order.size() && may_win(contest, order[contest.taken]);
    };
    if (options_.best_only && bounds_->ties()) {
      while (next() && !progress_.stop.load() &&
             (waiting.empty() || bound_[order[contest.taken]] > bound_[waiting.front()])) {
        take_more(contest);
      }
    } else if (waiting.empty() && contest.taken == 0) {
      waiting = order;
      contest.taken = order.size();
    }
    std::size_t count = 0;
    while (count < std::min(size, waiting.size()) && may_win(contest, waiting[count])) ++count;
    const auto end = waiting.begin() + static_cast<std::ptrdiff_t>(count);
    std::vector<std::uint32_t> wave(waiting.begin(), end);
    waiting.erase(waiting.begin(), end);
    const auto open = [&](std::span<const std::uint32_t> sets) {
      return static_cast<std::size_t>(
          std::ranges::partition_point(sets, [&](std::uint32_t k) { return may_win(contest, k); }) -
          sets.begin());
    };
    progress_.total =
        contest.refined + wave.size() +
        (options_.best_only
             ? open(waiting) + open({order.data() + contest.taken, order.size() - contest.taken})
             : waiting.size());
    return wave;
  }

  void refine_wave(Contest& contest, std::span<const std::uint32_t> wave) {
    std::vector<std::optional<RefinedSet>> refined(wave.size());
    std::vector<char> fresh(wave.size());
    const double to_beat =
        options_.best_only && contest.best ? merit_of(spec_, *contest.best) : -kInfinity;
    numerics::parallel_for(wave.size(), [&](std::size_t i) {
      const std::uint32_t k = wave[i];
      const bool again = is_refined(k);
      const auto known = std::ranges::lower_bound(options_.known, k, {}, &RefinedSet::index);
      if (!again && known != options_.known.end() && known->index == k) {
        refined[i] = *known;
      } else if (auto answer = options_.answer ? options_.answer(result_.search.candidates[k])
                                               : std::nullopt) {
        refined[i] = std::move(answer);
      } else {
        const Candidate& candidate = result_.search.candidates[k];
        refined[i] = refiner_.refine(
            candidate, bounds_->shifts().of(candidate.teeth), bounds_->by_modules(k),
            progress_.stop,
            {.to_beat = to_beat, .design = options_.design ? options_.design(candidate) : nullptr});
        fresh[i] = 1;
      }
      if (!refined[i]) return;
      refined[i]->index = k;
      if (has_design(refined[i]->status)) {
        const double value = merit_of(spec_, *refined[i]);
        double seen = progress_.best_merit.load();
        while (value > seen && !progress_.best_merit.compare_exchange_weak(seen, value)) {
        }
        ++progress_.feasible;
      }
      ++progress_.done;
    });
    std::vector<RefinedSet> news;
    for (std::size_t i = 0; i < wave.size(); ++i) {
      if (!refined[i]) continue;
      if (fresh[i] != 0) news.push_back(*refined[i]);
      offer(*refined[i], contest.best);
      keep(std::move(*refined[i]), to_beat);
      ++contest.refined;
    }
    foresee(contest);
    if (options_.on_wave && !news.empty()) options_.on_wave(news);
  }

  /// Tells progress what the certificate of a contest and the proofs after it will take, as the
  /// best of now stand.
  void foresee(const Contest& contest) {
    if (!options_.best_only || !options_.certify) return;
    const bool sharpens = follows_efficiency(first_objective(spec_));
    const double proven = proven_merit();
    const double best = contest.best ? merit_of(spec_, *contest.best) : kInfinity;
    std::map<int, Later> later;
    for (const int planets : spec_.planets) {
      if (options_.per_planets && planets > contest.planets.value_or(0)) later[planets];
    }
    const auto of = [&](const RefinedSet& set) { return later.find(set.candidate.planets); };
    for (const RefinedSet& set : result_.refined) {
      const auto own = of(set);
      if (own == later.end() || !has_design(set.status) || is_driven_by_none(set)) continue;
      own->second.best = std::max(own->second.best, merit_of(spec_, set));
    }
    std::size_t own_bounds = 0, later_bounds = 0, later_sets = 0;
    for (const RefinedSet& set : result_.refined) {
      const auto sharp = sharp_.find(set.index);
      if (!sharpens || (sharp != sharp_.end() && sharp->second.to_the_end)) continue;
      const double bound = sharp_bound(set.index);
      const bool running = !contest.planets || set.candidate.planets == *contest.planets;
      if (running && bound > best + proven) {
        ++own_bounds;
      } else if (const auto own = of(set);
                 own != later.end() && bound > own->second.best + proven) {
        ++later_bounds;
      }
    }
    const std::vector<Candidate>& candidates = result_.search.candidates;
    for (std::size_t k = 0; !later.empty() && k < candidates.size(); ++k) {
      if (is_refined(k) || !may_have_design(k)) continue;
      const auto own = later.find(candidates[k].planets);
      if (own == later.end() || !(bound_[k] > own->second.best + no_gain_)) continue;
      if (own->second.sets < kFirstWave) ++own->second.sets;
    }
    for (const auto& [planets, own] : later) later_sets += own.sets;
    progress_.to_sharpen = own_bounds;
    progress_.later_bounds = later_bounds;
    progress_.later_sets = later_sets;
  }

  /// Takes a refined set into the result, in the place of what it was refined to before.
  void keep(RefinedSet set, double to_beat) {
    const bool again = is_refined(set.index);
    to_beat_[set.index] = to_beat;
    if (again) {
      *std::ranges::find(result_.refined, set.index, &RefinedSet::index) = std::move(set);
    } else {
      result_.refined.push_back(std::move(set));
    }
  }

  void offer(const RefinedSet& set, std::optional<RefinedSet>& best) const {
    if (!has_design(set.status) || is_driven_by_none(set)) return;
    if (!best || merit_order(spec_, set) < merit_order(spec_, *best)) best = set;
  }

  /// Whether no motor of the specification drives a set within its limits.
  [[nodiscard]] bool is_driven_by_none(const RefinedSet& set) const {
    return spec_.cycle_energy && first_objective(spec_) == Objective::kCycleEnergy &&
           !std::isfinite(merit_of(spec_, set));
  }

  /// Whether the grid of a set was given up for what it had to beat (Status::kBounded), which is
  /// more than it has to beat now.
  [[nodiscard]] bool was_given_up(const RefinedSet& set, double to_beat) const {
    return !has_design(set.status) && (set.status == Status::kBounded || set.grid_cut) &&
           to_beat_[set.index] > to_beat;
  }

  /// The sets of a number of planets, with the best of those that are refined.
  Contest contest_of(int planets) const {
    Contest own{.planets = planets, .order = {}};
    for (const RefinedSet& set : result_.refined) {
      if (set.candidate.planets == planets) offer(set, own.best);
    }
    const double to_beat = own.best ? merit_of(spec_, *own.best) : -kInfinity;
    const std::vector<Candidate>& candidates = result_.search.candidates;
    auto refined = result_.refined.begin();
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      while (refined != result_.refined.end() && refined->index < k) ++refined;
      const bool there = refined != result_.refined.end() && refined->index == k;
      if (candidates[k].planets != planets || !may_have_design(k)) continue;
      if (!there || was_given_up(*refined, to_beat)) {
        own.order.push_back(static_cast<std::uint32_t>(k));
      }
    }
    sort_by_bound(own.order);
    return own;
  }

  /// Goes on with the sets that may be the best of their number of planets.
  void prove_each_number_of_planets() {
    std::vector<int> numbers = spec_.planets;
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    progress_.stage_done = 0;
    progress_.stage_total = numbers.size();
    progress_.stage = Progress::Stage::kPlanets;
    for (const int planets : numbers) {
      Contest own = contest_of(planets);
      ++progress_.searches;
      begin_refinement(own.order.size());
      foresee(own);
      refine(own);
      std::ranges::sort(result_.refined, {}, &RefinedSet::index);
      if (own.best) offer(*own.best, result_.best);
      const Certificate proof = certificate_of(own);
      if (progress_.stop.load()) {
        result_.interrupted = true;
        return;
      }
      result_.by_planets.push_back({.planets = planets, .proof = proof});
      ++progress_.stage_done;
    }
    result_.certificate =
        certificate_of({.planets = std::nullopt, .order = {}, .best = result_.best});
  }

  /// What is proven of the sets of a contest that is over.
  Certificate certificate_of(const Contest& contest) {
    Certificate c;
    const bool found = contest.best.has_value();
    c.best = found ? merit_of(spec_, *contest.best) : -kInfinity;
    c.objective_bounded = !is_of_load(first_objective(spec_));
    count_sets(contest, c);
    c.global_bound = std::max(c.best, c.largest_unrefined_bound.value_or(c.best));
    if (found) sharpen(contest, c);
    name_strength_limits(c);
    return c;
  }

  void count_sets(const Contest& contest, Certificate& c) const {
    const std::vector<Candidate>& candidates = result_.search.candidates;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      if (contest.planets && candidates[k].planets != *contest.planets) continue;
      if (is_refined(k)) {
        ++c.refined;
      } else if (infeasible_[k] != 0) {
        ++c.infeasible;
      } else {
        ++c.bounded;
        if (may_have_design(k)) {
          c.largest_unrefined_bound =
              std::max(c.largest_unrefined_bound.value_or(bound_[k]), bound_[k]);
        }
      }
    }
  }

  [[nodiscard]] double sharp_bound(std::uint32_t k) const {
    const auto sharp = sharp_.find(k);
    return sharp == sharp_.end() ? bound_[k] : sharp->second.bound;
  }

  /// Takes the bounds of the refined sets that could still hold something better, sharpened, into
  /// a certificate.
  void sharpen(const Contest& contest, Certificate& c) {
    const double proven = proven_merit();
    std::vector<std::uint32_t> own, open;
    for (const RefinedSet& set : result_.refined) {
      if (contest.planets && set.candidate.planets != *contest.planets) continue;
      own.push_back(set.index);
      c.grid_cut += set.grid_cut ? 1 : 0;
      const auto sharp = sharp_.find(set.index);
      const bool done = sharp != sharp_.end() && sharp->second.to_the_end;
      if (!done && follows_efficiency(first_objective(spec_)) &&
          sharp_bound(set.index) > c.best + proven) {
        open.push_back(set.index);
      }
    }
    progress_.total = 0;
    progress_.done = 0;
    progress_.phase = Progress::Phase::kCertificate;
    progress_.total = open.size();
    const double enough = is_efficiency(first_objective(spec_)) ? c.best : -kInfinity;
    std::vector<Sharp> sharp(open.size());
    numerics::parallel_for(open.size(), [&](std::size_t i) {
      if (progress_.stop.load()) return;
      sharp[i].bound = merit_bound(spec_, bounds_->sharpened(open[i], enough),
                                   result_.search.candidates[open[i]]);
      sharp[i].to_the_end = !bounds_->ties() || sharp[i].bound > enough;
      ++progress_.done;
    });
    for (std::size_t i = 0; i < open.size(); ++i) sharp_.insert_or_assign(open[i], sharp[i]);
    for (const std::uint32_t k : own) {
      c.global_bound = std::max(c.global_bound, sharp_bound(k));
      if (sharp_bound(k) > c.best + proven) ++c.open;
    }
  }

  /// Whether the tooth of a mesh that a check is about is a ring's.
  static bool is_ring(const design::CheckSubject& tooth) {
    const auto& gears = train::kMeshGears[static_cast<std::size_t>(tooth.member)];
    return train::kind_of(gears[static_cast<std::size_t>(tooth.which - 1)]) ==
           geometry::GearKind::kRing;
  }

  void name_strength_limits(Certificate& c) const {
    if (!spec_.rating) return;
    if (spec_.rating->factors.held_mesh_load) {
      c.strength_not_bounded.emplace_back("k_gamma of tolerances");
    }
    for (const ConstraintRow& row : make_problem_rows(spec_, spec_.planets.front(), {}).rows) {
      if (!row.check || !row.check->record->rating) continue;
      const design::CheckId id = row.check->record->id;
      const bool root = id == design::CheckId::kRootSafety && bounds_roots(spec_);
      const bool of_ring = root && is_ring(row.check->subject);
      const bool bounded =
          (root && !of_ring) || (id == design::CheckId::kFlankSafety && bounds_flanks(spec_));
      const std::string_view name = of_ring ? "root_safety of rings" : row.name;
      auto& names = bounded ? c.strength_bounded : c.strength_not_bounded;
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }

  const Specification& spec_;
  Progress& progress_;
  const OptimizeOptions& options_;
  OptimizeResult& result_;
  Refiner refiner_;
  /// What a design may gain by missing its limits as far as it may.
  double no_gain_;
  std::shared_ptr<SetBounds> bounds_;  ///< of the result
  std::vector<double> bound_;
  std::vector<double> before_;    ///< OptimizeOptions::bound_before, where that is known
  std::vector<char> infeasible_;  ///< proven to have no design
  std::vector<double> to_beat_;   ///< by set: what it had to beat when it was refined; nan: not yet
  /// A bound that was sharpened, to the end or to where that was enough.
  struct Sharp {
    double bound = kInfinity;
    bool to_the_end = false;
  };
  std::unordered_map<std::uint32_t, Sharp> sharp_;
};

}  // namespace

OptimizeResult optimize(const Specification& spec, Progress& progress,
                        const OptimizeOptions& options) {
  if (options.best_only && judged_by_model(spec)) {
    throw std::invalid_argument(
        "optimize: best_only with a calibrated model at an operating point, allowed: one of them");
  }
  if (options.best_only && !has_bounds(spec)) {
    throw std::invalid_argument(
        "optimize: best_only with a specification that has no bounds, allowed: one of them");
  }
  OptimizeResult result;
  result.search = search_teeth(spec, progress);
  if (result.search.interrupted) {
    result.interrupted = true;
    return result;
  }
  Run run(spec, progress, options, result);
  run.screen();
  run.bound();
  if (progress.stop.load()) {
    result.bounds = nullptr;
    result.interrupted = true;
  } else {
    run.refine_all();
  }
  if (result.interrupted) run.take_known();
  result.pareto = pareto_front(result.refined, judged_by_model(spec));
  return result;
}

}  // namespace gear3k::optimize
