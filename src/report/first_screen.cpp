#include "report/first_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/text/printable.hpp"
#include "report/analysis_report.hpp"
#include "report/check_subject.hpp"
#include "report/display.hpp"
#include "report/operation_report.hpp"
#include "report/strength_report.hpp"
#include "report/thermal_report.hpp"

namespace gear3k::report {

namespace {

using design::CheckResult, design::Evaluation, design::PairEvaluation, design::TightestCheck;
using units::Unit;

constexpr std::size_t kIndent = 4;  ///< of what follows a broken line

std::string percent_text(const std::optional<double>& efficiency) {
  const bool defined = efficiency && std::isfinite(*efficiency);
  return defined ? fmt::format("{:.2f} %", 100.0 * *efficiency) : std::string("undefined");
}

std::string value_text(const CheckResult& c, double value) {
  const Unit unit = c.record->unit;
  const std::string_view name = units::unit_name(unit);
  const int digits = unit == Unit::kMicrometre || unit == Unit::kArcmin ? 2 : 4;
  return fmt::format("{}{}{}", fixed(value, digits), name.empty() ? "" : " ", name);
}

std::string tip_text(const TightestCheck& t) {
  if (!t.tip) return "";
  constexpr double kNothing_m = 0.5e-6;
  if (std::abs(t.tip->shorter_m) < kNothing_m) {
    return t.check->ok ? t.tip->gear + " tip at its limit" : "";
  }
  return t.tip->shorter_m > 0.0
             ? fmt::format("shorten the tip of {} by {:.3f} mm", t.tip->gear, mm(t.tip->shorter_m))
             : fmt::format("tip of {} may be {:.3f} mm longer", t.tip->gear, mm(-t.tip->shorter_m));
}

/// How many checks failed, as drawn and as built.
std::string counts_text(const std::vector<CheckResult>& checks,
                        const std::optional<design::ToleranceLimits>& built) {
  const auto failed = std::ranges::count(checks, false, &CheckResult::ok);
  std::string text = failed > 0 ? fmt::format("Checks: {} of {} failed", failed, checks.size())
                                : fmt::format("Checks: all {} passed", checks.size());
  if (!built) return text;
  const auto failing = std::ranges::count(built->checks, false, &design::CheckLimits::holds);
  if (failed == 0 && failing == 0) return text + ", as drawn and within [tolerances]";
  const std::size_t all = built->checks.size();
  return fmt::format(
      "{} as drawn, within [tolerances] {} (--show tolerances)", text,
      failing == 0 ? fmt::format("all {} hold", all) : fmt::format("{} of {} fail", failing, all));
}

/// Failed checks, and the tightest of those that passed.
std::string tightest_text(const std::vector<CheckResult>& checks,
                          const std::optional<design::ToleranceLimits>& built,
                          const std::vector<TightestCheck>& tightest, int columns) {
  const auto failed = std::ranges::count(checks, false, &CheckResult::ok);
  const auto shown =
      std::ranges::count_if(tightest, [](const TightestCheck& t) { return !t.check->ok; });
  constexpr double kAtLimit = 1e-6;
  const std::string counts = counts_text(checks, built);
  const char* const nearest = failed > 0              ? ""
                              : counts.ends_with(')') ? "; nearest:"
                                                      : "; the nearest to their limits";
  std::string text = broken(counts + nearest, columns, kIndent);
  bool of_passed = failed == 0;
  for (const TightestCheck& t : tightest) {
    const CheckResult& c = *t.check;
    if (c.ok && !of_passed) {
      of_passed = true;
      if (failed > shown) text += fmt::format("  and {} more (--show checks)\n", failed - shown);
      text += "Passed; the nearest to their limits\n";
    }
    std::string line = fmt::format("  {}{}", c.ok ? "" : "FAILED ", c.record->title);
    if (const std::string subject = subject_of(c); !subject.empty()) line += " " + subject;
    line += fmt::format(
        ": {} {} {}", value_text(c, units::from_si(c.value, c.record->unit)),
        c.record->at_least ? ">=" : "<=", value_text(c, units::from_si(c.limit, c.record->unit)));
    if (c.ok && t.share <= kAtLimit) line += " (at its limit)";
    if (const std::string tip = tip_text(t); !tip.empty()) line += ", " + tip;
    text += broken(line, columns, kIndent);
  }
  if (failed > shown && !of_passed)
    text += fmt::format("  and {} more (--show checks)\n", failed - shown);
  return text;
}

/// Of the whole, else of the gears, where a part such as the carrier has no mass stated.
std::string mass_text(const Evaluation& e) {
  if (e.total_mass_kg) return fmt::format("mass {:.4g} kg", *e.total_mass_kg);
  const std::optional<double> of_gears = gears_mass_kg(e);
  return of_gears ? fmt::format("mass of the gears {:.4g} kg (--show masses)", *of_gears)
                  : std::string("mass not known (--show masses)");
}

std::string size_text(const Evaluation& e, const std::optional<double>& outer_diameter_m) {
  double root_m = 0.0;
  for (const int ring : {train::kR1, train::kR2}) {
    root_m = std::max(root_m, e.gears[static_cast<std::size_t>(ring)].root_diameter_m);
  }
  return fmt::format(
      "{}ring roots {:.2f} mm, centre distance {:.4f} mm, modules {:.5g} and {:.5g} mm, {}",
      outer_diameter_m ? fmt::format("outer diameter {:.2f} mm, ", mm(*outer_diameter_m)) : "",
      mm(root_m), mm(e.center_distance_m), mm(e.module_m[0]), mm(e.module_m[1]), mass_text(e));
}

std::string lost_motion_text(const Evaluation& e, const design::BuiltSeries* built) {
  std::string text =
      fmt::format("{} arcmin as drawn", fixed(arcmin(e.lost_motion.kinematic_rad), 2));
  if (built != nullptr) {
    const auto& most = built->result.limit_of_99_percent_rad;
    text += most ? fmt::format(", at most {} for 99 % of the built ones", fixed(arcmin(*most), 2))
                 : std::string(", more than 1 % of the built ones jam");
  }
  if (const auto& measured = e.lost_motion.measured_rad) {
    text += fmt::format(", measured {} with the model ({})", fixed(arcmin(*measured), 2),
                        e.operation ? "between +T and -T" : "at T = 0 and 20 C");
  }
  text += "; backlash";
  for (const design::MeshResult& m : e.meshes) {
    text += fmt::format(" {} {}{}", m.name, fixed(um(m.normal_backlash_m), 1),
                        &m == &e.meshes.back() ? " um" : ",");
  }
  return text;
}

std::string contact_text(const std::vector<design::MeshResult>& meshes) {
  const auto& least = *std::ranges::min_element(meshes, {}, &design::MeshResult::contact_ratio);
  return fmt::format("least contact ratio {:.3f} ({})", least.contact_ratio, least.name);
}

/// The cutters of the rings, "" where none is stated.
std::string cutters_text(const Evaluation& e) {
  std::string text;
  for (const int ring : {train::kR1, train::kR2}) {
    const design::GearResult& g = e.gears[static_cast<std::size_t>(ring)];
    if (g.tooth.cutter_teeth == 0) continue;
    text += fmt::format("{}{} by {} teeth", text.empty() ? "" : ", ", g.name, g.tooth.cutter_teeth);
  }
  return text;
}

std::string notes_text(const std::vector<std::string>& notes, int columns) {
  constexpr std::size_t kShown = 2;
  std::string text;
  for (std::size_t k = 0; k < std::min(kShown, notes.size()); ++k) {
    text += broken("Note: " + io::printable(notes[k]), columns, kIndent);
  }
  if (notes.size() > kShown) {
    text += fmt::format("{} more notes: --show notes\n", notes.size() - kShown);
  }
  return text;
}

constexpr std::string_view kMore =
    "More: --full, or --show with gears, teeth, meshes, strength, checks, sensitivities, ...\n";

}  // namespace

std::string broken(const std::string& text, int columns, std::size_t indent) {
  const auto width = static_cast<std::size_t>(columns);
  std::string result, line;
  std::size_t begin = 0;
  const std::size_t last = text.ends_with('\n') ? text.size() - 1 : text.size();
  while (begin < last) {
    // Blanks before a word belong to it.
    std::size_t end = text.find_first_not_of(' ', begin);
    end = end == std::string::npos ? last : std::min(text.find(' ', end), last);
    const std::string word = text.substr(begin, end - begin);
    if (!line.empty() && line.size() + word.size() > width) {
      result += line + '\n';
      line = std::string(indent, ' ') + word.substr(word.find_first_not_of(' '));
    } else {
      line += word;
    }
    begin = end;
  }
  return result + line + '\n';
}

std::string folded(const std::string& text, int columns, std::size_t indent) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    result += line.size() > static_cast<std::size_t>(columns) ? broken(line, columns, indent)
                                                              : line + '\n';
    begin = end + 1;
  }
  return result;
}

std::string first_screen(const Evaluation& e, const std::vector<TightestCheck>& tightest,
                         const design::BuiltSeries* built, int columns,
                         std::optional<double> outer_diameter_m) {
  std::string text;
  const auto add = [&](const std::string& line) { text += broken(line, columns, kIndent); };
  add(fmt::format("{}: S {} / P1 {} / R1 {} / P2 {} / R2 {}, {} {}planets",
                  e.name.empty() ? "gearbox" : io::printable(e.name), e.teeth.S, e.teeth.P1,
                  e.teeth.R1, e.teeth.P2, e.teeth.R2, e.planets,
                  e.assembly.equal_spacing && e.assembly.identical_planets ? "identical " : ""));
  add(fmt::format("  ratio        {:.4f}:1{}", e.ratio,
                  e.ratio < 0.0 ? ", output turns against the input" : ""));
  add("  size         " + size_text(e, outer_diameter_m));
  const auto& eta = e.efficiency;
  add(fmt::format("  efficiency   forward {}, backward {}", percent_text(eta.forward),
                  !eta.backward       ? std::string("undefined")
                  : !eta.backdrivable ? std::string("none: not back-drivable")
                                      : percent_text(eta.backward)));
  if (e.operation) add("  all losses   " + operation_summary(e));
  add("  lost motion  " + lost_motion_text(e, built));
  const std::string cutters = cutters_text(e);
  add("  contact      " + contact_text(e.meshes) +
      (cutters.empty() ? "" : "; pinion cutters: " + cutters));
  if (e.strength) add("  strength     " + capacity_summary(e));
  if (e.thermal) add("  temperature  " + thermal_summary(*e.thermal));
  text += '\n' + tightest_text(e.checks, e.tolerance_limits, tightest, columns) + '\n';
  if (const std::string not_checked = not_checked_text(e); !not_checked.empty()) add(not_checked);
  text += notes_text(e.notes, columns);
  add(std::string(kMore));
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

std::string first_screen(const PairEvaluation& e, const std::vector<TightestCheck>& tightest,
                         int columns) {
  std::string text;
  const auto add = [&](const std::string& line) { text += broken(line, columns, kIndent); };
  add(fmt::format("{}: {} and {} teeth, centre distance {:.4f} mm{}",
                  e.name.empty() ? "pair" : io::printable(e.name), e.gears[0].teeth,
                  e.gears[1].teeth, mm(e.center_distance_m),
                  e.center_distance_given ? "" : " (zero-backlash distance)"));
  for (const design::GearResult& g : e.gears) {
    add(
        fmt::format("  gear {}       tip {:.4f} mm, root {:.4f} mm, shift {:.4f}, tip thickness "
                    "{:.4f} mm",
                    g.name, mm(g.tip_diameter_m), mm(g.root_diameter_m), g.profile_shift,
                    mm(g.tip_thickness_m)));
  }
  add(fmt::format("  efficiency   {} with gear 1 driving, {} with gear 2",
                  percent_text(e.mesh.efficiency_forward),
                  percent_text(e.mesh.efficiency_backward)));
  add(fmt::format("  mesh         backlash {} um, contact ratio {:.3f}, working angle {:.4f} deg",
                  fixed(um(e.mesh.normal_backlash_m), 2), e.mesh.contact_ratio,
                  degrees(e.mesh.working_pressure_angle_rad)));
  if (e.strength) add("  strength     " + capacity_summary(e));
  text += '\n' + tightest_text(e.checks, e.tolerance_limits, tightest, columns) + '\n';
  if (const std::string not_checked = not_checked_text(e); !not_checked.empty()) add(not_checked);
  text += notes_text(e.notes, columns);
  add(std::string(kMore));
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

}  // namespace gear3k::report
