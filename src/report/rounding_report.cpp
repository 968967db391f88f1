#include "report/rounding_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "report/display.hpp"
#include "report/limits_report.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using optimize::RoundedDesign, optimize::Rounding, optimize::Specification, units::Unit;

const optimize::ObjectiveRecord& rounded_objective(const Specification& spec) {
  return optimize::objective_record(optimize::first_objective(spec));
}

bool of_efficiency(const Specification& spec) {
  return optimize::is_efficiency(optimize::first_objective(spec));
}

/// What the objective is worse by, in its unit.
double loss_of(const Specification& spec, double free_objective, const RoundedDesign& design) {
  const optimize::ObjectiveRecord& record = rounded_objective(spec);
  return optimize::sense_of(record.id) * (free_objective - design.objective) / record.per_unit;
}

std::string shown_objective(const Specification& spec, double value_si) {
  if (of_efficiency(spec)) return fmt::format("{:.3f} %", 100.0 * value_si);
  return with_unit(fmt::format("{:.6g}", value_si / rounded_objective(spec).per_unit),
                   rounded_objective(spec).unit);
}

/// The allowances as lengths [um]; of a gear with A_sn what its middle thins the tooth by.
std::array<double, train::kGearCount> allowances_um(const RoundedDesign& design) {
  std::array<double, train::kGearCount> lengths{};
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const std::size_t stage = i == train::kP2 || i == train::kR2 ? 1 : 0;
    const double module_m = design.set.train.module_m[stage];
    const double q = optimize::machining_allowance(design.spec, i,
                                                   design.set.train.pressure_angle_rad, module_m);
    lengths[i] = clean(um(q * module_m));
  }
  return lengths;
}

double in_file(double si, Unit unit) { return units::decimal_from_si(si, unit); }

template <class Values>
std::string numbers_text(const Values& values) {
  std::vector<std::string> texts;
  texts.reserve(std::size(values));
  for (const double value : values) texts.push_back(fmt::format("{:g}", value));
  return fmt::format("{}", fmt::join(texts, " "));
}

std::string allowances_text(const RoundedDesign& design) {
  std::vector<std::string> texts;
  for (const double length : allowances_um(design)) texts.push_back(fmt::format("{:.4g}", length));
  return fmt::format("{}", fmt::join(texts, " "));
}

std::string misses_text(const RoundedDesign& design) {
  std::vector<std::string> misses;
  misses.reserve(design.missed.size());
  for (const optimize::Miss& miss : design.missed) {
    misses.push_back(fmt::format("{} by {}", miss.name,
                                 with_unit(fmt::format("{:.4g}", miss.amount), miss.unit)));
  }
  return fmt::format("{}", fmt::join(misses, ", "));
}

std::string values_text(const Specification& spec, const RoundedDesign& design) {
  const optimize::RefinedTrain& t = design.set.train;
  std::string text = fmt::format(
      "  modules {} mm, shifts S P1 R1 P2 R2 {}, centre distance {:g} mm, allowances {} um",
      numbers_text(std::array{in_file(t.module_m[0], Unit::kMillimetre),
                              in_file(t.module_m[1], Unit::kMillimetre)}),
      numbers_text(t.profile_shift), in_file(t.center_distance_m, Unit::kMillimetre),
      allowances_text(design));
  if (spec.free.tip_shortening) text += ", tip shortenings " + numbers_text(t.tip_shortening);
  if (spec.free.pressure_angle_rad) {
    text += fmt::format(", pressure angle {:g} deg", in_file(t.pressure_angle_rad, Unit::kDegree));
  }
  for (const std::size_t stage : {std::size_t{0}, std::size_t{1}}) {
    if (!spec.free.face_width_m[stage]) continue;
    text += fmt::format(", face width of stage {} {:g} mm", stage + 1,
                        in_file(t.face_width_m[stage], Unit::kMillimetre));
  }
  return text + "\n";
}

io::Json rounded_values_json(const RoundedDesign& design) {
  const optimize::RefinedTrain& t = design.set.train;
  const auto face_width_json = [&](std::size_t stage) {
    const std::optional<double> width_m = t.face_width_m[stage] > 0.0
                                              ? std::optional(t.face_width_m[stage])
                                              : design.spec.bodies.face_width_m[stage];
    return width_m ? io::Json(in_file(*width_m, Unit::kMillimetre)) : io::Json();
  };
  return {{"module_mm",
           {in_file(t.module_m[0], Unit::kMillimetre), in_file(t.module_m[1], Unit::kMillimetre)}},
          {"profile_shift", t.profile_shift},
          {"center_distance_mm", in_file(t.center_distance_m, Unit::kMillimetre)},
          {"machining_allowance_um", allowances_um(design)},
          {"tip_shortening", t.tip_shortening},
          {"pressure_angle_deg", in_file(t.pressure_angle_rad, Unit::kDegree)},
          {"face_width_mm", {face_width_json(0), face_width_json(1)}}};
}

/// Where it is the step of modules that leaves nothing; "": it is not.
std::string modules_text(const Specification& spec, const Rounding& rounding) {
  const auto in_range = [](const optimize::ModuleChoice& choice) {
    return choice.range_m && choice.range_m->min < choice.range_m->max;
  };
  if (std::ranges::none_of(spec.module, in_range) || !rounding.complete) return "";
  const double step_mm = in_file(spec.round.module_m, Unit::kMillimetre);
  if (rounding.module_pairs == 0) {
    return fmt::format(": no module in its range is a multiple of round.module_mm = {:g}", step_mm);
  }
  if (rounding.module_pairs_with_design > 0) return "";
  return fmt::format(
      ": with none of the modules tried in steps of {:g} mm (round.module_mm) was a design of "
      "these teeth found, whatever the shifts and the centre distance",
      step_mm);
}

std::string cut_text(const Rounding& rounding) {
  if (rounding.complete) return "";
  return fmt::format("; the search was cut short, there may be {}",
                     rounding.best ? "a better one" : "one");
}

}  // namespace

std::string rounding_blocked_text(const Specification& spec, const Rounding& rounding) {
  // Where no module fits, the nearest point is far off: what it misses is not what blocks.
  std::string blocked = modules_text(spec, rounding);
  std::vector<std::string_view> names;
  if (blocked.empty() && rounding.nearest) {
    for (const optimize::Miss& miss : rounding.nearest->missed) names.push_back(miss.name);
    blocked = fmt::format(": the nearest misses {}", misses_text(*rounding.nearest));
  }
  // Of a search that was cut short it is not known that there is none.
  return fmt::format("{}{}{}{}",
                     rounding.complete ? "no rounded design meets every check"
                                       : "no rounded design that meets every check was found",
                     blocked, preset_note(spec.limits, names), cut_text(rounding));
}

std::string unread_steps_text(const Specification& spec) {
  return spec.round.stated ? "the steps of [round] are read by optimize --round only: nothing was "
                             "rounded to them"
                           : "";
}

std::string rounding_table(const Specification& spec, double free_objective,
                           const Rounding& rounding) {
  const optimize::RoundSteps& steps = spec.round;
  std::string text = fmt::format(
      "\nRounded to what is made: shifts to {:g}, centre distance to {:g} mm, modules of a range "
      "to {:g} mm, allowances to {:g} um\n",
      steps.profile_shift, in_file(steps.center_distance_m, Unit::kMillimetre),
      in_file(steps.module_m, Unit::kMillimetre), in_file(steps.allowance_m, Unit::kMicrometre));
  if (!rounding.best) return text + "  " + rounding_blocked_text(spec, rounding) + "\n";
  const double loss = loss_of(spec, free_objective, *rounding.best);
  const double amount = std::abs(loss);
  const std::string lost =
      of_efficiency(spec) ? fmt::format("{:.4f} percent points", 100.0 * amount)
                          : with_unit(fmt::format("{:.4g}", amount), rounded_objective(spec).unit);
  // Allowances are rounded with the modules: what is made may be more than what was drawn.
  constexpr double kShown = 5e-7;  // of an efficiency, and of another value's own
  const double own = rounding.best->objective / rounded_objective(spec).per_unit;
  const bool better = loss < -kShown * (of_efficiency(spec) ? 1.0 : std::abs(own));
  text += fmt::format(
      "  {} {}, {} the free optimum{}\n", rounded_objective(spec).title,
      shown_objective(spec, rounding.best->objective),
      better ? fmt::format("{} better than", lost) : fmt::format("a loss of {} against", lost),
      cut_text(rounding));
  return text + values_text(spec, *rounding.best);
}

io::Json rounding_json(const Specification& spec, double free_objective, const Rounding& rounding) {
  const double per_unit = rounded_objective(spec).per_unit;
  io::Json json{{"feasible", rounding.best.has_value()},
                {"complete", rounding.complete},
                {"relaxations", rounding.relaxations},
                {"points", rounding.points},
                {"module_pairs", rounding.module_pairs},
                {"module_pairs_with_design", rounding.module_pairs_with_design}};
  if (rounding.best) {
    const double loss = loss_of(spec, free_objective, *rounding.best);
    json["objective"] = rounding.best->objective / per_unit;
    json["loss"] = loss;
    json["loss_percent_points"] = of_efficiency(spec) ? io::Json(100.0 * loss) : nullptr;
  }
  io::Json blocked = io::Json::array();
  if (!rounding.best && rounding.nearest) {
    for (const optimize::Miss& miss : rounding.nearest->missed) {
      blocked.push_back({{"name", miss.name}, {"amount", miss.amount}, {"unit", miss.unit}});
    }
  }
  json["blocked_by"] = std::move(blocked);
  const auto& design = rounding.best ? rounding.best : rounding.nearest;
  if (design) json.update(rounded_values_json(*design));
  return json;
}

}  // namespace gear3k::report
