// Small tasks with modules from lists, shifts on a grid and cutters at hand, searched by `optimize`
// and by a plain loop over everything that they allow.
//
//     every_point [TASKS [FIRST]]
//
// Until 20 tasks have a design by default, about a minute of one core; tasks without one are
// compared too, and told only where they disagree.  The loop knows nothing of the search: of all
// tooth numbers in the ranges, modules, cutters and shifts it writes down the design, scans its
// centre distance, and judges it as `gear3k analyze` does.  Ends with 1 where a tooth set or the
// best of a task disagrees.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "benchmarks/cpu_time.hpp"
#include "benchmarks/program.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/optimizer.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program
using rig::DeterministicRandom;
using train::kS, train::kP1, train::kR1, train::kP2, train::kR2;

constexpr double kNone = -std::numeric_limits<double>::infinity();
constexpr double kPi = 3.14159265358979323846;
constexpr double kShiftStep = 0.2;
constexpr int kLeastDifference = 9, kMostOffset = 1;
constexpr double kRatioTolerance = 0.02;
/// Efficiencies that are equal: what limits may be missed by is worth less than this.
constexpr double kSameEfficiency = 2e-6;

struct TeethDrawn {
  int least = 0, most = 0;
};

/// What both files of a task say.
struct DrawnTask {
  TeethDrawn S, P1, P2;
  int R1_most = 0, R2_most = 0, planets = 3;
  double ratio = 0.0;
  std::array<std::vector<double>, 2> modules_mm;
  std::array<std::vector<int>, 2> cutters;           ///< of R1 and R2; empty: none stated
  std::array<long, 2> gear_shifts{}, ring_shifts{};  ///< first and last, in steps
  double least_backlash_um = 0.0, most_arcmin = 0.0, friction = 0.1, contact_ratio = 1.0;
  bool forward = false, is_kinematic = true, are_identical = true;
};

std::vector<double> list_with(DeterministicRandom& random, double module_mm) {
  std::vector<double> list{module_mm};
  for (const double other : {0.5, 0.6, 0.8, 1.0}) {
    if (other != module_mm && random.uniform() < 0.35) list.push_back(other);
  }
  std::ranges::sort(list);
  return list;
}

double ratio_of(int S, int P1, int R1, int P2, int R2) {
  const double to_ring = static_cast<double>(P2) * R1 / (static_cast<double>(P1) * R2);
  return (1.0 + static_cast<double>(R1) / S) / (1.0 - to_ring);
}

DrawnTask draw_task(std::uint64_t seed) {
  DeterministicRandom random(seed);
  const auto integer = [&](int least, int most) {
    return least + static_cast<int>(random.index(static_cast<std::size_t>(most - least + 1)));
  };
  DrawnTask task;
  for (;;) {
    const int S = integer(10, 16), P1 = integer(18, 32), R1 = S + 2 * P1 + integer(-1, 1);
    const std::array<double, 4> modules{0.5, 0.6, 0.8, 1.0};
    const double m1 = modules[random.index(4)], m2 = modules[random.index(4)];
    const int P2 = integer(14, 36);
    const int R2 = P2 + static_cast<int>(std::lround((R1 - P1) * m1 / m2)) + integer(0, 1);
    if (R1 - P1 < kLeastDifference || R2 - P2 < kLeastDifference || P1 * R2 == P2 * R1) continue;
    task.ratio = ratio_of(S, P1, R1, P2, R2);
    if (!(std::abs(task.ratio) > 12.0 && std::abs(task.ratio) < 150.0)) continue;
    task.S = {S, S + integer(0, 1)};
    task.P1 = {P1 - integer(0, 1), P1 + 1};
    task.P2 = {P2 - integer(0, 1), P2 + 1};
    task.R1_most = R1 + 2;
    task.R2_most = R2 + 3;
    task.modules_mm = {list_with(random, m1), list_with(random, m2)};
    break;
  }
  for (auto& cutters : task.cutters) {
    if (random.uniform() < 0.3) cutters = {13, 17, 25};
    if (random.uniform() < 0.3) cutters = {20};
  }
  task.planets = integer(3, 4);
  const long first = integer(-1, 1);
  task.gear_shifts = {first, first + integer(2, 3)};
  task.ring_shifts = {first, first + integer(3, 4)};
  task.least_backlash_um = random.uniform() < 0.7 ? random.between(0.0, 15.0) : 0.0;
  task.most_arcmin = random.between(30.0, 120.0);
  task.are_identical = random.uniform() < 0.3;
  task.friction = random.between(0.05, 0.15);
  task.contact_ratio = random.between(0.9, 1.15);
  task.forward = random.uniform() < 0.4;
  task.is_kinematic = random.uniform() < 0.7;
  return task;
}

/// The tables that a task and a design have in common.
std::string tables_of(const DrawnTask& task) {
  return fmt::format(
      "[friction]\ncoefficient = {}\nloss_model = \"sliding\"\n"
      "[backlash]\nmodel = \"{}\"\nmin_normal_um = {}\nmax_output_arcmin = {}\n"
      "[contact_ratio]\nrange = [{}, 2.6]\n"
      "[limits]\ntip_thickness = 0.2\nplanet_gap = 0.2\n",
      task.friction, task.is_kinematic ? "kinematic" : "paper", task.least_backlash_um,
      task.most_arcmin, task.contact_ratio);
}

std::string task_text(const DrawnTask& task) {
  std::string text =
      fmt::format("planets = {}\nidentical_planets = {}\nobjective = \"{}\"\n", task.planets,
                  task.are_identical, task.forward ? "forward_efficiency" : "backward_efficiency");
  text += fmt::format("[ratio]\ntarget = {}\ntolerance = {}\n", task.ratio, kRatioTolerance);
  text += fmt::format(
      "[teeth]\nS = [{}, {}]\nP1 = [{}, {}]\nP2 = [{}, {}]\nR1_max = {}\nR2_max = {}\n"
      "max_coaxial_offset = {}\nmin_internal_difference = {}\n",
      task.S.least, task.S.most, task.P1.least, task.P1.most, task.P2.least, task.P2.most,
      task.R1_most, task.R2_most, kMostOffset, kLeastDifference);
  text += fmt::format("[module]\nstage1_mm = {{ series = {} }}\nstage2_mm = {{ series = {} }}\n",
                      task.modules_mm[0], task.modules_mm[1]);
  const auto range = [](const std::array<long, 2>& shifts) {
    return fmt::format("[{:.1f}, {:.1f}]", kShiftStep * static_cast<double>(shifts[0]),
                       kShiftStep * static_cast<double>(shifts[1]));
  };
  text += fmt::format("[profile_shift]\nrange = {}\nring_range = {}\nstep = {}\n",
                      range(task.gear_shifts), range(task.ring_shifts), kShiftStep);
  for (std::size_t ring = 0; ring < 2; ++ring) {
    if (task.cutters[ring].empty()) continue;
    text +=
        fmt::format("[cutter.R{}]\nteeth = {}\ntip_radius = 0.2\n", ring + 1, task.cutters[ring]);
  }
  return text + tables_of(task);
}

/// A design of the task with any teeth, modules and cutters.
design::Design any_design(const DrawnTask& task) {
  std::string text = fmt::format(
      "planets = {}\nidentical_planets = {}\ncenter_distance_mm = 20.0\n[stage1]\nmodule_mm = 0.5\n"
      "[stage2]\nmodule_mm = 0.5\n",
      task.planets, task.are_identical);
  const std::array<int, 5> teeth{task.S.least, task.P1.least, task.R1_most, task.P2.least,
                                 task.R2_most};
  for (std::size_t gear = 0; gear < 5; ++gear) {
    text += fmt::format("[gears.{}]\nteeth = {}\n", train::kGearNames[gear], teeth[gear]);
    const std::size_t ring = gear == kR1 ? 0 : 1;
    if ((gear == kR1 || gear == kR2) && !task.cutters[ring].empty()) {
      text +=
          fmt::format("cutter = {{ teeth = {}, tip_radius = 0.2 }}\n", task.cutters[ring].front());
    }
  }
  return io::parse_design(text + tables_of(task), "design");
}

double involute_of(double angle) { return std::tan(angle) - angle; }

/// Normal backlash over the distance, (4.2) to (4.5), written down once more: only to know where to
/// look, with room on both sides.
double backlash_at(double distance, double module, int teeth, double shifts, bool external) {
  const double alpha = 20.0 * kPi / 180.0;
  const double base = 0.5 * module * teeth * std::cos(alpha);
  const double opened = 2.0 * base * (involute_of(std::acos(base / distance)) - involute_of(alpha));
  const double held = 2.0 * module * std::sin(alpha) * shifts;
  return external ? opened - held : held - opened;
}

/// The least distance at which a mesh has a working angle.
double closest(double module, int teeth) {
  return 0.5 * module * teeth * std::cos(20.0 * kPi / 180.0) * (1.0 + 1e-9);
}

/// The distance at which that backlash is so much.
double distance_at(double backlash, double module, int teeth, double shifts, bool external) {
  double lo = closest(module, teeth), hi = 2.5 * lo;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (lo + hi);
    const bool below =
        (backlash_at(middle, module, teeth, shifts, external) < backlash) == external;
    (below ? lo : hi) = middle;
  }
  return hi;
}

struct Judged {
  double efficiency = kNone;  ///< also of what misses a limit
  double violation = 0.0;     ///< sum of what limits are missed by; 0: a design
  bool is_hopeless = false;   ///< misses a limit that the distance has no say in
};

/// As `gear3k analyze` judges it.
Judged judge(const design::Design& design, bool forward) {
  using design::CheckId;
  const auto result = design::evaluate(design);
  const auto* evaluation = std::get_if<design::Evaluation>(&result);
  if (evaluation == nullptr) return {.violation = std::numeric_limits<double>::infinity()};
  Judged judged;
  const auto& efficiency = evaluation->efficiency;
  judged.efficiency = (forward ? efficiency.forward : efficiency.backward).value_or(kNone);
  for (const design::CheckResult& check : evaluation->checks) {
    if (check.ok) continue;
    const double scale = check.limit != 0.0 ? std::abs(check.limit) : 1.0;
    judged.violation += std::max(1e-9, std::isfinite(check.margin) ? -check.margin / scale : 1e3);
    const CheckId id = check.record->id;
    judged.is_hopeless = judged.is_hopeless || id == CheckId::kUndercut ||
                         id == CheckId::kTipThickness || id == CheckId::kRingTipThickness ||
                         id == CheckId::kRingTipOutsideBase || id == CheckId::kRingCutter ||
                         id == CheckId::kEqualSpacing || id == CheckId::kHuntingTooth;
  }
  return judged;
}

/// Distances from `lo` to `hi`, finer and finer about the best design, or about what misses least.
double best_over_distance(design::Design& design, double lo, double hi, bool forward,
                          double to_beat, std::size_t& judged_designs) {
  constexpr int kPoints = 24, kTimes = 6;
  constexpr double kLossOfScan = 1e-3;  // of an efficiency, between two points of the first scan
  double best = kNone, from = lo, to = hi;
  for (int time = 0; time < kTimes; ++time) {
    const double width = (to - from) / kPoints;
    double at = from, least = std::numeric_limits<double>::infinity(), greatest = kNone;
    double best_here = kNone;
    for (int k = 0; k <= kPoints; ++k) {
      design.train.center_distance_m = from + k * width;
      const Judged judged = judge(design, forward);
      ++judged_designs;
      if (judged.is_hopeless) return best;
      greatest = std::max(greatest, judged.efficiency);
      const bool is_design = judged.violation == 0.0 && judged.efficiency > kNone;
      if (is_design ? judged.efficiency > best_here
                    : best_here == kNone && judged.violation < least) {
        if (is_design) best_here = judged.efficiency;
        least = judged.violation;
        at = design.train.center_distance_m;
      }
    }
    best = std::max(best, best_here);
    if (greatest + kLossOfScan < to_beat) return best;
    from = std::max(lo, at - 2.0 * width);
    to = std::min(hi, at + 2.0 * width);
  }
  return best;
}

struct Found {
  double efficiency = kNone;
  std::size_t judged = 0;
};

/// The best design of a tooth set, by trying everything.
Found try_everything(const DrawnTask& task, const train::ToothSet& z, design::Design design) {
  Found found;
  design.train.teeth = z;
  const auto shifts_from = [](const std::array<long, 2>& range) {
    std::vector<double> shifts;
    for (long k = range[0]; k <= range[1]; ++k) {
      shifts.push_back(std::round(kShiftStep * static_cast<double>(k) * 10.0) / 10.0);
    }
    return shifts;
  };
  const std::vector<double> gears = shifts_from(task.gear_shifts);
  const std::vector<double> rings = shifts_from(task.ring_shifts);
  const auto cutters = [&](std::size_t ring, int teeth) {
    std::vector<int> fit;
    for (const int n : task.cutters[ring]) {
      if (n < teeth) fit.push_back(n);
    }
    return task.cutters[ring].empty() ? std::vector<int>{0} : fit;
  };
  const double least = 1e-6 * task.least_backlash_um;
  auto& x = design.train.profile_shift;
  for (const double m1_mm : task.modules_mm[0]) {
    for (const double m2_mm : task.modules_mm[1]) {
      const double m1 = 1e-3 * m1_mm, m2 = 1e-3 * m2_mm;
      design.train.module_m = {m1, m2};
      for (const double xS : gears) {
        for (const double xP1 : gears) {
          const double from = distance_at(least, m1, z.S + z.P1, xS + xP1, true);
          for (const double xR1 : rings) {
            const double to = distance_at(least, m1, z.R1 - z.P1, xR1 - xP1, false);
            if (to < from - 1e-8) continue;
            for (const double xP2 : gears) {
              for (const double xR2 : rings) {
                const double to2 = distance_at(least, m2, z.R2 - z.P2, xR2 - xP2, false);
                // Limits may be missed by a millionth; no mesh works within its base circles.
                const double lo = std::max(
                                 {from - 2e-9, closest(m1, z.R1 - z.P1), closest(m2, z.R2 - z.P2)}),
                             hi = std::min(to, to2) + 2e-9;
                if (hi < lo) continue;
                x = {xS, xP1, xR1, xP2, xR2};
                for (const int c1 : cutters(0, z.R1)) {
                  for (const int c2 : cutters(1, z.R2)) {
                    design.train.cutter[kR1].teeth = c1;
                    design.train.cutter[kR2].teeth = c2;
                    found.efficiency = std::max(found.efficiency,
                                                best_over_distance(design, lo, hi, task.forward,
                                                                   found.efficiency, found.judged));
                  }
                }
              }
            }
          }
        }
      }
    }
  }
  return found;
}

/// Tooth sets in the ranges, by counting.
std::vector<train::ToothSet> teeth_of_task(const DrawnTask& task) {
  std::vector<train::ToothSet> sets;
  for (int S = task.S.least; S <= task.S.most; ++S) {
    for (int P1 = task.P1.least; P1 <= task.P1.most; ++P1) {
      for (int R1 = P1 + kLeastDifference; R1 <= task.R1_most; ++R1) {
        if (std::abs(R1 - S - 2 * P1) > kMostOffset) continue;
        for (int P2 = task.P2.least; P2 <= task.P2.most; ++P2) {
          for (int R2 = P2 + kLeastDifference; R2 <= task.R2_most; ++R2) {
            if (P1 * R2 == P2 * R1) continue;
            if (std::abs(ratio_of(S, P1, R1, P2, R2) / task.ratio - 1.0) > kRatioTolerance)
              continue;
            sets.push_back({.S = S, .P1 = P1, .R1 = R1, .P2 = P2, .R2 = R2});
          }
        }
      }
    }
  }
  return sets;
}

struct Compared {
  int sets = 0, with_design = 0, differ = 0;
  double greatest = 0.0;  ///< difference of a set's efficiency
  bool best_differs = false, bound_fails = false;
  [[nodiscard]] bool agrees() const { return differ == 0 && !best_differs && !bound_fails; }
};

/// Whether the search's own design is one.
bool holds(const DrawnTask& task, const optimize::RefinedSet& set, design::Design design) {
  design.train.teeth = set.candidate.teeth;
  design.train.module_m = set.train.module_m;
  design.train.profile_shift = set.train.profile_shift;
  design.train.center_distance_m = set.train.center_distance_m;
  for (const std::size_t ring : {std::size_t{0}, std::size_t{1}}) {
    if (task.cutters[ring].size() > 1) {
      design.train.cutter[ring == 0 ? kR1 : kR2].teeth = set.train.cutter_teeth[ring];
    }
  }
  const Judged judged = judge(design, task.forward);
  const double own = task.forward ? set.eta_f : set.eta_b;
  return judged.violation == 0.0 && std::abs(judged.efficiency - own) <= kSameEfficiency;
}

Compared compare(const DrawnTask& task, std::uint64_t seed) {
  const std::string text = task_text(task);
  const optimize::Specification spec = io::parse_specification(text, "task");
  optimize::Progress progress;
  const double began_s = benchmarks::process_cpu_s();
  const optimize::OptimizeResult all = optimize::optimize(spec, progress);
  const optimize::OptimizeResult certified =
      optimize::optimize(spec, progress, {.best_only = true});
  const double searched_s = benchmarks::process_cpu_s() - began_s;

  std::map<train::ToothSet, optimize::RefinedSet> searched;
  for (const optimize::RefinedSet& set : all.refined) searched[set.candidate.teeth] = set;
  const design::Design any = any_design(task);
  Compared compared;
  double best = kNone;
  std::size_t judged = 0;
  for (const train::ToothSet& z : teeth_of_task(task)) {
    const Found found = try_everything(task, z, any);
    judged += found.judged;
    ++compared.sets;
    best = std::max(best, found.efficiency);
    const auto own = searched.find(z);
    const bool has = own != searched.end() && own->second.status == optimize::Status::kOptimal;
    const double of_search = !has ? kNone : task.forward ? own->second.eta_f : own->second.eta_b;
    if (found.efficiency > kNone) ++compared.with_design;
    const bool is_held = !has || holds(task, own->second, any);
    const double apart =
        of_search == found.efficiency ? 0.0 : std::abs(of_search - found.efficiency);
    if (std::isfinite(apart)) compared.greatest = std::max(compared.greatest, apart);
    if (apart <= kSameEfficiency && is_held) continue;
    ++compared.differ;
    fmt::print("    seed {} set {}/{}/{}/{}/{}: search {:.8f}{}, every point {:.8f}\n", seed, z.S,
               z.P1, z.R1, z.P2, z.R2, of_search, is_held ? "" : " (no design)", found.efficiency);
  }
  const auto best_of = [&](const optimize::OptimizeResult& result) {
    return result.best ? (task.forward ? result.best->eta_f : result.best->eta_b) : kNone;
  };
  for (const double own : {best_of(all), best_of(certified)}) {
    const bool is_same = own == best || std::abs(own - best) <= kSameEfficiency;
    compared.best_differs = compared.best_differs || !is_same;
  }
  compared.bound_fails =
      certified.certificate && certified.certificate->global_bound < best - kSameEfficiency;
  if (compared.with_design == 0 && compared.agrees()) return compared;
  fmt::print(
      "  {:4} {:3} sets {:2} with a design, {}x{} modules, {}x{} cutters, {:8} designs judged "
      "{:6.1f} s, search {:5.2f} s: best {:.7f} {:.7f} {:.7f}, sets apart by {:.0e}{}\n",
      seed, compared.sets, compared.with_design, task.modules_mm[0].size(),
      task.modules_mm[1].size(), task.cutters[0].size(), task.cutters[1].size(), judged,
      benchmarks::process_cpu_s() - began_s - searched_s, searched_s, best, best_of(all),
      best_of(certified), compared.greatest,
      compared.bound_fails ? " BOUND FAILS"
      : compared.agrees()  ? ""
                           : " DISAGREE");
  std::fflush(stdout);
  return compared;
}

}  // namespace

PROGRAM(every_point)(int argc, char** argv) {
  const int wanted = argc > 1 ? std::atoi(argv[1]) : 20;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  int tasks = 0, with_design = 0, disagree = 0, sets = 0, designs = 0;
  for (std::uint64_t seed = first; with_design < wanted; ++seed) {
    const DrawnTask task = draw_task(seed);
    const std::vector<train::ToothSet> teeth = teeth_of_task(task);
    const auto spaced = std::ranges::count_if(
        teeth, [&](const train::ToothSet& z) { return (z.S + z.R1) % task.planets == 0; });
    if (spaced < 2 || spaced > 8) continue;
    if (task.modules_mm[0].size() * task.modules_mm[1].size() < 2) continue;
    const Compared compared = compare(task, seed);
    ++tasks;
    sets += compared.sets;
    designs += compared.with_design;
    with_design += compared.with_design > 0 ? 1 : 0;
    disagree += compared.agrees() ? 0 : 1;
  }
  fmt::print(
      "{} tasks, {} of them with a design; {} sets, {} of them with a design; {} tasks "
      "disagree\n",
      tasks, with_design, sets, designs, disagree);
  return disagree == 0 ? 0 : 1;
}
