// The interference checks against gears cut and rolled point by point (tests/geometry/
// rolling_simulation.hpp): random pairs, a third of them moved to the limit of one check.
//
//   rolling_truth [pairs = 12000] [seed = 1]
//
// Prints what each check raised and what the simulation saw, and exits with 1 when a pair that
// every check passes is seen to interfere, when false alarms reach 1 % of the pairs away from the
// limits, or when fewer than a fifth of the pairs lie near one.  The same output for any number of
// threads.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "benchmarks/program.hpp"
#include "design/evaluation.hpp"
#include "tests/geometry/rolling_simulation.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program

constexpr double kModule_m = 1e-3;
constexpr double kAllowedFalseAlarms = 0.01;  // share of the pairs away from every limit
constexpr double kWantedNearLimits = 0.2;     // share of all pairs
constexpr int kAssemblyPhases = 8;

bool counts(std::string_view name) {
  return name == "trimming" ||
         std::find(test::kInterferenceChecks.begin(), test::kInterferenceChecks.end(), name) !=
             test::kInterferenceChecks.end();
}

/// Only the checks of interference, at their default limits; those that are off by default at 0.
design::Limits interference_limits() {
  design::Limits limits;
  for (const design::CheckRecord& record : design::check_records()) {
    if (counts(record.name)) {
      limits[record.id] = units::to_si(record.default_limit.value_or(0.0), record.unit);
    }
  }
  return limits;
}

std::vector<test::NamedMargin> margins_of(const test::SimulatedPair& pair) {
  static const design::Limits limits = interference_limits();
  design::PairDesign p;
  p.name = "pair";
  p.pressure_angle_rad = pair.pressure_angle_rad;
  p.center_distance_m = pair.center_distance * kModule_m;
  p.gear1 = pair.gear1;
  p.gear2 = pair.gear2;
  p.gear1.module_m = p.gear2.module_m = kModule_m;
  p.limits = limits;
  const auto result = design::evaluate(p);
  std::vector<test::NamedMargin> margins;
  const auto* evaluation = std::get_if<design::PairEvaluation>(&result);
  if (evaluation == nullptr) return margins;
  for (const design::CheckResult& check : evaluation->checks) {
    if (!counts(check.record->name)) continue;
    double scale = 1.0;
    switch (check.record->unit) {
      case units::Unit::kNone:
      case units::Unit::kModule:
        break;
      case units::Unit::kMillimetre:
      case units::Unit::kMicrometre:
        scale = 1.0 / kModule_m;
        break;
      case units::Unit::kArcmin:
      case units::Unit::kDegree:
        scale = 0.5 * pair.gear2.teeth;
        break;
      default:
        throw std::logic_error("rolling_truth: " + std::string(check.record->name) +
                               " is neither a length nor an angle");
    }
    int gear = 0;
    for (int k = 0; k < 2 && k < static_cast<int>(evaluation->gears.size()); ++k) {
      if (check.gear == evaluation->gears[static_cast<std::size_t>(k)].name) gear = k + 1;
    }
    margins.push_back({check.record->name, gear, check.margin * scale});
  }
  return margins;
}

struct Record {
  test::SimulatedPair pair;
  std::vector<test::NamedMargin> margins;
  test::RollingResult result;
  test::Comparison comparison;
  bool rolled = false, near_limit = false;
  double assembly_overlap = -1.0;  // < 0: not tried
  std::string error;
};

Record simulate(std::uint64_t seed, std::uint64_t number) {
  test::RandomPair random(seed, number);
  Record record;
  record.pair = random.pair();
  if (number % 3 == 0) {
    // Wanted: one check at its limit and no other one failing, so that a miss there would show.
    for (int attempt = 0; attempt < 40; ++attempt) {
      const test::SimulatedPair base = attempt % 4 == 0 ? random.pair() : record.pair;
      const auto margins = margins_of(base);
      if (margins.empty()) continue;
      // Each check in turn, as far as the pair has it.
      const std::string_view turn =
          test::kInterferenceChecks[number / 3 % test::kInterferenceChecks.size()];
      std::vector<test::NamedMargin> choice;
      for (const auto& m : margins) {
        if (m.name == turn) choice.push_back(m);
      }
      if (choice.empty()) continue;
      const auto& check =
          choice[static_cast<std::size_t>(random.count(0, static_cast<int>(choice.size()) - 1))];
      const auto found = random.move_near_limit(base, check, margins_of);
      if (!found) continue;
      record.pair = *found;
      record.near_limit = true;
      const auto there = margins_of(*found);
      const bool others_pass = std::all_of(there.begin(), there.end(), [&](const auto& m) {
        return m.margin >= 0.0 || m.name == "trimming" || m.name == check.name;
      });
      if (others_pass) break;
    }
  }
  record.margins = margins_of(record.pair);
  const double alpha = record.pair.pressure_angle_rad;
  const auto cut1 = test::cut_gear(record.pair.gear1, alpha);
  const auto cut2 = test::cut_gear(record.pair.gear2, alpha);
  if (!cut1 || !cut2 || record.margins.empty()) return record;
  const auto result = test::roll(record.pair, *cut1, *cut2);
  if (!result) return record;
  record.rolled = true;
  record.result = *result;
  record.comparison = test::compare(*result, record.margins);
  if (cut2->ring && test::seen(*result).empty()) {
    record.assembly_overlap =
        test::radial_assembly_overlap(record.pair, *cut1, *cut2, kAssemblyPhases);
  }
  return record;
}

std::string kind_of(const test::SimulatedPair& pair) {
  if (pair.gear2.kind == geometry::GearKind::kExternal) return "external";
  return pair.gear2.cutter.teeth == 0 ? "ring, arc roots" : "ring, shaped";
}

void describe(std::size_t number, const Record& r) {
  fmt::print(
      "  pair {} ({}): saw {}; mesh {:.2e} at r {:.4f} {:.4f}, tips {:.2e}, root {:.3f} "
      "{:.3f}, missing {:.1e} {:.1e}, feed {:.1e}, contact at r {:.4f} {:.4f}\n",
      number, kind_of(r.pair), test::seen(r.result).empty() ? "nothing" : test::seen(r.result),
      r.result.mesh.depth, r.result.mesh.radius1, r.result.mesh.radius2, r.result.tips.depth,
      r.result.root1, r.result.root2, r.result.missing[0], r.result.missing[1],
      r.result.cutter_feed, r.result.contact_radius[0], r.result.contact_radius[1]);
  fmt::print("    alpha {:.6f} deg, distance {:.7f}\n",
             r.pair.pressure_angle_rad * 180.0 / 3.14159265358979323846, r.pair.center_distance);
  for (const auto* g : {&r.pair.gear1, &r.pair.gear2}) {
    fmt::print("    z {} x {:.5f} q {:.5f} k {:.5f} haP {:.5f} hfP {:.5f} rhofP {:.5f}", g->teeth,
               g->profile_shift, g->machining_allowance, g->tip_shortening, g->rack.addendum,
               g->rack.dedendum, g->rack.root_radius);
    if (g->cutter.teeth > 0) {
      fmt::print(" cutter z0 {} x0 {:.5f} rho0 {:.5f}", g->cutter.teeth, g->cutter.profile_shift,
                 g->cutter.tip_radius);
    }
    fmt::print("\n");
  }
  fmt::print("   ");
  for (const auto& m : r.margins)
    fmt::print(" {}{}{} {:.4f}", m.name, m.gear ? "/" : "", m.gear ? std::to_string(m.gear) : "",
               m.margin);
  fmt::print("\n");
}

std::string_view why_false(std::string_view check) {
  if (check == "ring_tip_outside_base") return "the planet's tip does not reach the ring's tip";
  if (check == "involute_interference") return "no flank is wanted there";
  if (check == "form_circle")
    return "fillet leaves the flank so slowly that < 1e-4 modules overlap";
  if (check == "tip_fouling") return "the corner's path stays clear of the fillet that was cut";
  if (check == "root_clearance") return "what is left of the tooth is shorter than its tip circle";
  if (check == "trochoid_interference") return "backlash or relieved tips let the corners pass";
  if (check == "ring_cutter") return "the cutter's fault lies where the planet does not reach";
  return "";
}

bool number_of(const char* text, std::uint64_t& value) {
  const char* end = text + std::strlen(text);
  const auto [at, error] = std::from_chars(text, end, value);
  return error == std::errc{} && at == end;
}

}  // namespace

PROGRAM(rolling_truth)(int argc, char** argv) {
  std::uint64_t pairs = 12000, seed = 1;
  if (argc > 3 || (argc > 1 && (!number_of(argv[1], pairs) || pairs == 0)) ||
      (argc > 2 && !number_of(argv[2], seed))) {
    fmt::print(stderr, "usage: rolling_truth [pairs] [seed]\n");
    return 2;
  }
  std::vector<Record> records(pairs);
#pragma omp parallel for schedule(dynamic, 16)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(pairs); ++i) {
    Record& record = records[static_cast<std::size_t>(i)];
    try {
      record = simulate(seed, static_cast<std::uint64_t>(i));
    } catch (const std::exception& e) {
      record.error = e.what();
    }
  }

  struct PerCheck {
    int pairs = 0, near_limit = 0, failed = 0, beyond_band = 0, confirmed = 0, false_alarms = 0;
  };
  std::map<std::string_view, PerCheck> per_check;
  struct PerKind {
    int pairs = 0, free = 0, lost = 0, root = 0, tips = 0, mesh = 0, feed = 0, missed = 0,
        false_alarms = 0;
  };
  std::map<std::string, PerKind> per_kind;
  std::vector<std::size_t> missed, alarms, trim_missed, trim_alarms;
  int rolled = 0, away = 0, near_limits = 0, errors = 0, assemblies = 0, assemblies_free = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Record& r = records[i];
    if (!r.error.empty() && errors++ < 3) fmt::print("pair {}: {}\n", i, r.error);
    if (!r.rolled) continue;
    ++rolled;
    away += r.comparison.away_from_limits ? 1 : 0;
    near_limits += r.comparison.away_from_limits ? 0 : 1;
    PerKind& kind = per_kind[kind_of(r.pair)];
    ++kind.pairs;
    const std::string_view what = test::seen(r.result);
    ++(what.empty()           ? kind.free
       : what == "flank lost" ? kind.lost
       : what == "root"       ? kind.root
       : what == "tips"       ? kind.tips
       : what == "mesh"       ? kind.mesh
                              : kind.feed);
    // A check counts once a pair, with the smaller margin of its two gears.
    std::map<std::string_view, double> smallest;
    for (const auto& m : r.margins) {
      const auto [at, added] = smallest.try_emplace(m.name, m.margin);
      if (!added) at->second = std::min(at->second, m.margin);
    }
    for (const auto& [name, margin] : smallest) {
      PerCheck& check = per_check[name];
      ++check.pairs;
      if (std::abs(margin) <= test::near_limit(name)) ++check.near_limit;
      if (margin < 0.0) ++check.failed;
      if (name != "trimming" && margin < -test::near_limit(name)) {
        ++check.beyond_band;
        if (!test::seen(r.result, test::kFaint).empty()) ++check.confirmed;
      }
      if (name == "trimming" && r.assembly_overlap >= 0.0) {
        ++assemblies;
        const bool free = r.assembly_overlap <= test::kPlain.overlap;
        assemblies_free += free ? 1 : 0;
        if (!free && margin >= 0.0) trim_missed.push_back(i);
        if (free && margin < -test::near_limit(name)) trim_alarms.push_back(i);
      }
    }
    if (r.comparison.agreement == test::Agreement::kMissed) {
      missed.push_back(i);
      ++kind.missed;
    }
    if (r.comparison.agreement == test::Agreement::kFalseAlarm) {
      alarms.push_back(i);
      ++kind.false_alarms;
      ++per_check[r.comparison.worst->name].false_alarms;
    }
  }
  const auto away_alarms = std::count_if(alarms.begin(), alarms.end(), [&](std::size_t i) {
    return records[i].comparison.away_from_limits;
  });

  fmt::print("seed {}, {} pairs, {} rolled, {} refused or without line of action\n", seed, pairs,
             rolled, static_cast<int>(pairs) - rolled);
  fmt::print(
      "seen: overlap > {:g} or flank missing > {:g} modules (confirming an alarm: {:g}, {:g}); "
      "near a limit: within "
      "{:g}, gaps {:g}\n\n",
      test::kPlain.overlap, test::kPlain.missing, test::kFaint.overlap, test::kFaint.missing,
      test::kNearLimit, test::kNearGap);
  fmt::print("{:<18}{:>7}{:>7}{:>12}{:>7}{:>7}{:>7}{:>7}{:>9}{:>14}\n", "simulated", "pairs",
             "free", "flank lost", "root", "tips", "mesh", "feed", "missed", "false alarms");
  for (const auto& [name, k] : per_kind) {
    fmt::print("{:<18}{:>7}{:>7}{:>12}{:>7}{:>7}{:>7}{:>7}{:>9}{:>14}\n", name, k.pairs, k.free,
               k.lost, k.root, k.tips, k.mesh, k.feed, k.missed, k.false_alarms);
  }
  fmt::print("\n{:<24}{:>7}{:>12}{:>8}{:>13}{:>11}{:>14}  {}\n", "check", "pairs", "near limit",
             "failed", "beyond band", "confirmed", "false alarms", "why");
  for (const auto& [name, k] : per_check) {
    fmt::print("{:<24}{:>7}{:>12}{:>8}{:>13}{:>11}{:>14}  {}\n", name, k.pairs, k.near_limit,
               k.failed, k.beyond_band, k.confirmed, k.false_alarms,
               k.false_alarms > 0 ? why_false(name) : "");
  }
  fmt::print(
      "\nradial assembly (trimming), pairs that run free: {}, of which {} assemble; "
      "missed {}, false alarms {} (flanks touching on one side have less room than backlash "
      "halved between both)\n",
      assemblies, assemblies_free, trim_missed.size(), trim_alarms.size());

  constexpr std::size_t kShown = 8;
  const auto show = [&](const char* title, const std::vector<std::size_t>& list) {
    if (list.empty()) return;
    fmt::print("\n{} ({}, first {}):\n", title, list.size(), std::min(kShown, list.size()));
    for (std::size_t k = 0; k < std::min(kShown, list.size()); ++k)
      describe(list[k], records[list[k]]);
  };
  show("missed", missed);
  show("false alarms", alarms);

  const double alarm_share = away > 0 ? static_cast<double>(away_alarms) / away : 0.0;
  const double near_share = rolled > 0 ? static_cast<double>(near_limits) / rolled : 0.0;
  bool kept = true;
  const auto bound = [&](bool ok, const std::string& text) {
    fmt::print("{}  {}\n", ok ? "ok  " : "FAIL", text);
    kept = kept && ok;
  };
  fmt::print("\n");
  bound(errors == 0, fmt::format("{} pairs threw", errors));
  bound(missed.empty(), fmt::format("{} interferences missed, none allowed", missed.size()));
  bound(alarm_share < kAllowedFalseAlarms,
        fmt::format("{} false alarms in {} pairs away from the limits = {:.2f} %, below {:g} %",
                    away_alarms, away, 100.0 * alarm_share, 100.0 * kAllowedFalseAlarms));
  bound(near_share >= kWantedNearLimits,
        fmt::format("{:.1f} % of the pairs near a limit, at least {:g} %", 100.0 * near_share,
                    100.0 * kWantedNearLimits));
  return kept ? 0 : 1;
}
