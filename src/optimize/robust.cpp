#include "optimize/robust.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include "design/evaluation.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

constexpr int kWorstCasePasses = 8;
constexpr int kYieldPasses = 7;  // the share to 1/128

/// By how much each limit is tightened [SI], by check.
using Tightening = std::array<double, design::kCheckCount>;

double& at(Tightening& tightening, CheckId id) { return tightening[static_cast<std::size_t>(id)]; }

bool is_backlash(CheckId id) {
  return id == CheckId::kNormalBacklash || id == CheckId::kOutputBacklashMin ||
         id == CheckId::kOutputBacklashMax;
}

/// Limits tightened by all of what other checks lose, and by a share of what backlash does.
design::Limits tightened(design::Limits limits, const Tightening& tightening, double share) {
  for (const design::CheckRecord& r : design::check_records()) {
    std::optional<double>& limit = limits[r.id];
    if (!limit) continue;
    const double by =
        tightening[static_cast<std::size_t>(r.id)] * (is_backlash(r.id) ? share : 1.0);
    *limit += r.at_least ? by : -by;
  }
  const double normal = tightening[static_cast<std::size_t>(CheckId::kNormalBacklash)] * share;
  for (std::optional<double>& limit : limits.mesh_backlash_m) {
    if (limit) *limit += normal;
  }
  return limits;
}

/// A design as it will be built.
struct Built {
  design::ToleranceLimits limits;
  backlash::WorstCase worst;
  BuiltOutcome outcome;
};

bool corners_hold(const design::ToleranceLimits& limits) {
  return std::ranges::all_of(limits.checks, [](const auto& check) {
    return is_backlash(check.record->id) || check.holds;
  });
}

/// Empty where the tolerances leave a mesh without a working pressure angle.
std::optional<Built> build(const design::Design& design, std::uint64_t samples,
                           std::uint64_t seed) {
  if (!design.tolerances) throw std::invalid_argument("built_outcome: a design without tolerances");
  auto evaluated = design::evaluate(design);
  auto* evaluation = std::get_if<design::Evaluation>(&evaluated);
  const auto model =
      backlash::clearance_model(design::resolved_parameters(design), *design.tolerances);
  if (evaluation == nullptr || !model || !evaluation->tolerance_limits) return std::nullopt;
  Built built{.limits = *std::move(evaluation->tolerance_limits),
              .worst = backlash::worst_case(*model),
              .outcome = {}};
  const std::optional<double>& limit = design.limits[CheckId::kOutputBacklashMax];
  const auto series =
      backlash::monte_carlo(*model, {.samples = samples,
                                     .seed = seed,
                                     .scatter = {.scatter = design.tolerances->scatter,
                                                 .sigma_level = design.tolerances->sigma_level},
                                     .limit_rad = limit});
  built.outcome = {.yield = series.yield.value,
                   .jammed = series.jammed.value,
                   .beyond_limit = series.beyond_limit.value,
                   .limit_of_99_percent_rad = series.limit_of_99_percent_rad,
                   .greatest_rad = built.worst.greatest_rad,
                   .least_margin_m = built.worst.least_margin_m,
                   .checks_hold = corners_hold(built.limits)};
  return built;
}

/// What keeps a design from holding in the worst case [SI, ≥ 0], by check.
Tightening missing(const Built& built, const design::Limits& stated) {
  Tightening result{};
  for (const design::CheckLimits& check : built.limits.checks) {
    const CheckId id = check.record->id;
    // What holds does so to the tolerance of its own scale: no limit asks for more.
    if (id == CheckId::kOutputBacklashMax || id == CheckId::kOutputBacklashMin ||
        (check.holds && !is_backlash(id)) || !std::isfinite(check.margin.least)) {
      continue;
    }
    double& by = at(result, id);
    by = std::max(by, -check.margin.least);
  }
  if (const auto& most = stated[CheckId::kOutputBacklashMax]) {
    at(result, CheckId::kOutputBacklashMax) = std::max(0.0, built.worst.greatest_rad - *most);
  }
  if (const auto& least = stated[CheckId::kOutputBacklashMin]) {
    at(result, CheckId::kOutputBacklashMin) = std::max(0.0, *least - built.worst.least_rad);
  }
  // A chain of two meshes opens by about twice what each of them does.
  double& normal = at(result, CheckId::kNormalBacklash);
  normal = std::max(normal, -0.5 * built.worst.least_margin_m);
  return result;
}

bool is_zero(const Tightening& tightening) {
  // Lengths to 0.01 µm, angles to 0.01 µrad, ratios to 1e-8: well below what is printed.
  return std::ranges::all_of(tightening, [](double by) { return by < 1e-8; });
}

class RobustSearch {
 public:
  RobustSearch(const Specification& spec,
               const std::function<SearchOutcome(const Specification&)>& search)
      : spec_(spec), search_(search) {
    // Assembly needs room in every mesh, whether or not a limit asks for it.
    if (!stated_[CheckId::kNormalBacklash]) stated_[CheckId::kNormalBacklash] = 0.0;
  }

  RobustResult run() {
    std::optional<Built> built = pass(0.0, spec_.limits);
    if (built && !holds(*built)) {
      if (spec_.robust.hold == Hold::kWorstCase) {
        tighten_until_worst_case_holds(std::move(*built));
      } else {
        bisect_share(*built);
      }
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool holds(const Built& built) const {
    if (!built.outcome.checks_hold) return false;
    if (spec_.robust.hold == Hold::kYield) return built.outcome.yield >= spec_.robust.yield;
    return is_zero(missing(built, stated_));
  }

  /// Searches under these limits; what is built to the best design, if there is one and its
  /// tolerances leave a gearbox.
  std::optional<Built> pass(double share, const design::Limits& limits) {
    Specification spec = spec_;
    spec.limits = limits;
    SearchOutcome found = search_(spec);
    result_.interrupted = found.interrupted;
    result_.passes.push_back({.share = share,
                              .limits = limits,
                              .best = std::move(found.best),
                              .grid_cut = found.grid_cut,
                              .outcome = {}});
    RobustPass& pass = result_.passes.back();
    if (found.interrupted || !pass.best) return std::nullopt;
    const auto samples =
        std::min<std::uint64_t>(kRobustSamples, static_cast<std::uint64_t>(spec_.sampling.samples));
    design::Design design = design_of(spec, *pass.best);
    design.limits = stated_;
    std::optional<Built> built = build(design, samples, spec_.sampling.seed);
    if (!built) return std::nullopt;
    pass.outcome = built->outcome;
    if (holds(*built) &&
        (!result_.chosen ||
         merit_of(spec_, *pass.best) > merit_of(spec_, *result_.passes[*result_.chosen].best))) {
      result_.chosen = result_.passes.size() - 1;
    }
    return built;
  }

  void tighten_until_worst_case_holds(Built built) {
    Tightening by{};
    for (int k = 0; k < kWorstCasePasses && !result_.chosen; ++k) {
      const Tightening more = missing(built, stated_);
      for (std::size_t i = 0; i < by.size(); ++i) by[i] += more[i];
      std::optional<Built> next = pass(1.0, tightened(stated_, by, 1.0));
      if (!next) return;
      built = std::move(*next);
    }
  }

  void bisect_share(const Built& nominal) {
    Tightening by = missing(nominal, stated_);
    double fails = 0.0;
    double too_much = 1.0;
    // Where the deviations of the worst case would add as random ones do.
    const double widest = nominal.worst.greatest_rad - nominal.worst.middle_rad;
    double share = widest > 0.0 ? nominal.worst.root_sum_square_rad / widest : 0.5;
    for (int k = 0; k < kYieldPasses; ++k) {
      const std::optional<Built> built = pass(share, tightened(stated_, by, share));
      if (result_.interrupted) return;
      if (built && !built->outcome.checks_hold) {
        // Again with the same share: its other limits were too wide.
        const Tightening more = missing(*built, stated_);
        for (const design::CheckRecord& r : design::check_records()) {
          if (!is_backlash(r.id)) at(by, r.id) += at_const(more, r.id);
        }
        if (built->outcome.yield >= spec_.robust.yield) continue;
      }
      const bool nothing_feasible = !result_.passes.back().best;
      (nothing_feasible || (built && holds(*built)) ? too_much : fails) = share;
      share = 0.5 * (fails + too_much);
    }
  }
  static double at_const(const Tightening& tightening, CheckId id) {
    return tightening[static_cast<std::size_t>(id)];
  }

  const Specification& spec_;
  const std::function<SearchOutcome(const Specification&)>& search_;
  design::Limits stated_ = spec_.limits;
  RobustResult result_;
};

}  // namespace

RobustResult robust_limits(const Specification& spec,
                           const std::function<SearchOutcome(const Specification&)>& search) {
  return RobustSearch(spec, search).run();
}

std::size_t most_robust_passes(Hold hold) {
  switch (hold) {
    case Hold::kNominal:
      return 0;
    case Hold::kWorstCase:
      return 1 + kWorstCasePasses;
    case Hold::kYield:
      return 1 + kYieldPasses;
  }
  return 0;
}

bool checks_hold(const design::Design& design) {
  const auto evaluated = design::evaluate(design);
  const auto* evaluation = std::get_if<design::Evaluation>(&evaluated);
  return evaluation != nullptr && evaluation->tolerance_limits &&
         corners_hold(*evaluation->tolerance_limits);
}

BuiltOutcome built_outcome(const design::Design& design, std::uint64_t samples,
                           std::uint64_t seed) {
  const std::optional<Built> built = build(design, samples, seed);
  if (!built) {
    throw std::invalid_argument(
        "built_outcome: at an end of the centre distance's limits a mesh has no working pressure "
        "angle, allowed: limits that leave one");
  }
  return built->outcome;
}

}  // namespace gear3k::optimize
