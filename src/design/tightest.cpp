#include "design/tightest.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <variant>

namespace gear3k::design {

namespace {

using units::Unit;

/// What a margin is small against where the limit is 0.
double least_scale(Unit unit) {
  switch (unit) {
    case Unit::kMillimetre:
    case Unit::kDiameterMillimetre:
    case Unit::kMicrometre:
      return 0.5e-3;
    case Unit::kArcmin:
      return units::to_si(1.0, Unit::kArcmin);
    default:
      return 1.0;
  }
}

double share_of(const CheckResult& c) {
  return c.margin / std::max(std::abs(c.limit), least_scale(c.record->unit));
}

/// Margin of a check with the tips of some gear shorter by so many modules; empty where it is gone.
using MarginAt = std::function<std::optional<double>(std::size_t gear, double shorter)>;

/// The change of one tip, in modules; empty where none within reach does it.
std::optional<double> solve_tip(const MarginAt& margin, std::size_t gear, double now) {
  constexpr double kShorter = 0.5, kLonger = -0.3, kTolerance = 1e-4;
  const bool failed = now < 0.0;
  double good = failed ? kShorter : 0.0;
  double bad = failed ? 0.0 : kLonger;
  const auto end = margin(gear, failed ? good : bad);
  if (!end || (*end >= 0.0) != failed) return std::nullopt;
  while (std::abs(good - bad) > kTolerance) {
    const double middle = 0.5 * (good + bad);
    const auto value = margin(gear, middle);
    if (!value) return std::nullopt;
    (*value >= 0.0 ? good : bad) = middle;
  }
  return good;
}

/// A change of the tip in whole micrometres [m], as it is told, with which the check is met; empty
/// where the ones above the change in modules do not meet it.
std::optional<double> whole_micrometres(const MarginAt& margin, std::size_t gear, double modules,
                                        double module_m) {
  constexpr double kStep_m = 1e-6;
  constexpr int kTried = 4;
  const double least = std::ceil(modules * module_m / kStep_m);
  for (int more = 0; more < kTried; ++more) {
    const double change_m = (least + more) * kStep_m;
    const auto value = margin(gear, change_m / module_m);
    if (value && *value >= 0.0) return change_m;
  }
  return std::nullopt;
}

/// The gear of `gears` whose tip changes least.
std::optional<std::pair<std::size_t, double>> least_change(const MarginAt& margin,
                                                           const std::vector<std::size_t>& gears,
                                                           double now) {
  std::optional<std::pair<std::size_t, double>> least;
  for (const std::size_t gear : gears) {
    const auto change = solve_tip(margin, gear, now);
    if (change && (!least || std::abs(*change) < std::abs(least->second))) {
      least = std::pair(gear, *change);
    }
  }
  return least;
}

std::optional<double> margin_of(const std::vector<CheckResult>& checks, const CheckResult& like) {
  for (const CheckResult& c : checks) {
    if (c.record == like.record && c.mesh == like.mesh && c.gear == like.gear) return c.margin;
  }
  return std::nullopt;
}

std::vector<TightestCheck> ranked(const std::vector<CheckResult>& checks, std::size_t count) {
  std::vector<TightestCheck> tightest;
  for (const CheckResult& c : checks) {
    if (c.ok && !c.record->threshold) continue;
    const double share = share_of(c);
    if (c.ok && !std::isfinite(share)) continue;
    const auto same = std::ranges::find_if(
        tightest, [&](const TightestCheck& t) { return t.check->record == c.record && c.ok; });
    if (same == tightest.end()) {
      tightest.push_back({.check = &c, .share = share, .tip = std::nullopt});
    } else if (same->check->ok && share < same->share) {
      *same = {.check = &c, .share = share, .tip = std::nullopt};
    }
  }
  std::ranges::stable_sort(tightest, [](const TightestCheck& a, const TightestCheck& b) {
    return std::pair(a.check->ok, a.share) < std::pair(b.check->ok, b.share);
  });
  if (tightest.size() > count) tightest.resize(count);
  return tightest;
}

constexpr std::size_t kSolved = 3;
constexpr double kNear = 0.05;

/// @param gears_of   gears of the mesh (or the gear) of a check
/// @param margin_at  of a check
/// @param module_of  of a gear [m]
/// @param name_of    of a gear
template <class GearsOf, class MarginOf, class ModuleOf, class NameOf>
void add_tips(std::vector<TightestCheck>& tightest, GearsOf gears_of, MarginOf margin_at,
              ModuleOf module_of, NameOf name_of) {
  std::size_t solved = 0;
  for (TightestCheck& t : tightest) {
    if (solved == kSolved) return;
    if (t.check->record->group != "interference" || !(t.share < kNear)) continue;
    ++solved;
    const MarginAt margin = [&](std::size_t gear, double shorter) {
      return margin_at(*t.check, gear, shorter);
    };
    const auto change = least_change(margin, gears_of(*t.check), t.check->margin);
    if (!change) continue;
    const auto [gear, modules] = *change;
    if (const auto shorter_m = whole_micrometres(margin, gear, modules, module_of(gear))) {
      t.tip = TipRemedy{.gear = std::string(name_of(gear)), .shorter_m = *shorter_m};
    }
  }
}

}  // namespace

double margin_scale(const CheckResult& check) {
  return check.limit != 0.0 ? std::abs(check.limit) : least_scale(check.record->unit);
}

std::vector<TightestCheck> tightest_checks(const Design& design, const Evaluation& evaluation,
                                           std::size_t count) {
  std::vector<TightestCheck> tightest = ranked(evaluation.checks, count);
  Design bare = design;
  bare.tolerances.reset();
  bare.rating.reset();
  bare.operating_point.reset();
  bare.train.center_distance_m = evaluation.center_distance_m;
  const auto gears_of = [&](const CheckResult& c) {
    std::vector<std::size_t> gears;
    for (std::size_t m = 0; m < train::kMeshGears.size(); ++m) {
      if (!c.mesh.empty() && c.mesh != train::kMeshNames[m]) continue;
      for (const auto id : train::kMeshGears[m]) {
        const auto gear = static_cast<std::size_t>(id);
        const bool foreign = c.mesh.empty() && c.gear != train::kGearNames[gear];
        if (!foreign && !design.train.khk_tip[gear]) gears.push_back(gear);
      }
    }
    return gears;
  };
  const auto margin_at = [&](const CheckResult& c, std::size_t gear,
                             double shorter) -> std::optional<double> {
    Design changed = bare;
    changed.train.tip_shortening[gear] += shorter;
    const auto result = evaluate(changed);
    const auto* e = std::get_if<Evaluation>(&result);
    return e == nullptr ? std::nullopt : margin_of(e->checks, c);
  };
  const auto module_of = [&](std::size_t gear) {
    return evaluation.module_m[static_cast<std::size_t>(train::stage_of(static_cast<int>(gear)))];
  };
  add_tips(tightest, gears_of, margin_at, module_of,
           [](std::size_t gear) { return train::kGearNames[gear]; });
  return tightest;
}

std::vector<TightestCheck> tightest_checks(const PairDesign& design,
                                           const PairEvaluation& evaluation, std::size_t count) {
  std::vector<TightestCheck> tightest = ranked(evaluation.checks, count);
  PairDesign bare = design;
  bare.tolerances.reset();
  bare.rating.reset();
  bare.center_distance_m = evaluation.center_distance_m;
  const auto gears_of = [&](const CheckResult&) {
    std::vector<std::size_t> gears;
    for (const std::size_t gear : {0U, 1U}) {
      if (!design.khk_tip[gear]) gears.push_back(gear);
    }
    return gears;
  };
  const auto margin_at = [&](const CheckResult& c, std::size_t gear,
                             double shorter) -> std::optional<double> {
    PairDesign changed = bare;
    (gear == 0 ? changed.gear1 : changed.gear2).tip_shortening += shorter;
    const auto result = evaluate(changed);
    const auto* e = std::get_if<PairEvaluation>(&result);
    return e == nullptr ? std::nullopt : margin_of(e->checks, c);
  };
  const auto module_of = [&](std::size_t gear) {
    return (gear == 0 ? design.gear1 : design.gear2).module_m;
  };
  add_tips(tightest, gears_of, margin_at, module_of,
           [&](std::size_t gear) { return evaluation.gears[gear].name; });
  return tightest;
}

}  // namespace gear3k::design
