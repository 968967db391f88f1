#include "report/relaxed_limits_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "design/measured_lost_motion.hpp"
#include "optimize/limit_prices.hpp"
#include "report/display.hpp"
#include "report/limits_report.hpp"
#include "report/text_table.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::report {

namespace {

using optimize::Freed, optimize::LimitOf, optimize::RelaxedLimit, optimize::Specification;
using optimize::key_of_limit;

const design::CheckRecord& record_of(const RelaxedLimit& limit) {
  return design::check_record(*limit.of.check);
}

double in_unit_of(const RelaxedLimit& limit, double value_si) {
  return units::decimal_from_si(value_si, record_of(limit).unit);
}

/// Presets state no limit of one mesh.
bool of_preset(const Specification& spec, const LimitOf& limit) {
  return limit.place < 0 && is_of_preset(spec.limits, *limit.check);
}

std::string limit_text(const Specification& spec, const RelaxedLimit& limit) {
  const std::string unit{units::unit_name(record_of(limit).unit)};
  const std::string value =
      limit.relaxed_si
          ? fmt::format("= {}",
                        with_unit(fmt::format("{:g}", in_unit_of(limit, *limit.relaxed_si)), unit))
          : std::string("off");
  return fmt::format("{} {} instead of {:g}{}", key_of_limit(limit.of), value,
                     in_unit_of(limit, limit.stated_si),
                     of_preset(spec, limit.of) ? " (preset)" : "");
}

/// What is left out of a design's objective that the task's model adds; "" where nothing is.
std::string left_out(const Specification& spec) {
  if (optimize::judged_by_model(spec)) return "the model's losses at the operating point";
  const bool moves = spec.model && design::changes_lost_motion(spec.model->lost_motion);
  if (moves && optimize::first_objective(spec) == optimize::Objective::kLostMotion) {
    return "the model's lost motion";
  }
  return "";
}

std::string objective_text(const Specification& spec, const optimize::RefinedSet& set) {
  const optimize::Objective first = optimize::first_objective(spec);
  const optimize::ObjectiveRecord& record = optimize::objective_record(first);
  const double value = optimize::objective_of(spec, set, first) / record.per_unit;
  if (optimize::is_efficiency(first))
    return fmt::format("{} {:.2f} %", record.title, 100.0 * value);
  return fmt::format("{} {}", record.title, with_unit(fmt::format("{:.4g}", value), record.unit));
}

/// The limits tried that are in no line.
std::vector<std::string> keys_without_design(const optimize::RelaxedLimits& relaxed) {
  std::vector<std::string> keys;
  for (const LimitOf& limit : relaxed.alone) {
    const bool frees = std::ranges::any_of(relaxed.freed, [&](const Freed& freed) {
      return freed.limits.size() == 1 && freed.limits.front().of == limit;
    });
    if (!frees) keys.push_back(key_of_limit(limit));
  }
  return keys;
}

bool has_bores(const Specification& spec) {
  return std::ranges::any_of(spec.bodies.bore_radius_m,
                             [](double radius_m) { return radius_m > 0.0; });
}

}  // namespace

std::string relaxed_limits_text(const Specification& spec, const optimize::RelaxedLimits& relaxed) {
  const std::string without = left_out(spec);
  std::string text;
  for (const Freed& freed : relaxed.freed) {
    std::string limits;
    for (const RelaxedLimit& limit : freed.limits) {
      limits += (limits.empty() ? "" : " and ") + limit_text(spec, limit);
    }
    text +=
        fmt::format("  {}: {}, {}{}\n", limits, teeth_text(freed.set.candidate.teeth),
                    objective_text(spec, freed.set), without.empty() ? "" : " without " + without);
  }
  const std::vector<std::string> others = keys_without_design(relaxed);
  if (!text.empty()) {
    const bool pairs = relaxed.freed.front().limits.size() > 1;
    text =
        fmt::format("there is a design, all other limits kept, with {}\n",
                    pairs ? "two limits relaxed (none was found with one)" : "one limit relaxed") +
        text;
    if (!pairs && !others.empty()) {
      text +=
          fmt::format("  none was found with another one left out: {}\n", fmt::join(others, ", "));
    }
  } else if (!others.empty()) {
    text = fmt::format(
        "no design was found with one limit left out ({}){}: {}ranges of teeth, modules and shifts "
        "or the number of planets have to give way\n",
        fmt::join(others, ", "),
        relaxed.paired.empty()
            ? ""
            : fmt::format(", nor with two of those that block most sets ({} pairs)",
                          relaxed.paired.size()),
        has_bores(spec) ? "stated bores, " : "");
  }
  if (relaxed.interrupted) text += "  interrupted: not all limits were tried\n";
  return text;
}

io::Json relaxed_limits_json(const Specification& spec, const optimize::RelaxedLimits& relaxed) {
  io::Json freed = list_json(relaxed.freed, [&](const Freed& one) -> io::Json {
    const optimize::Objective first = optimize::first_objective(spec);
    return {{"limits", list_json(one.limits,
                                 [&](const RelaxedLimit& limit) -> io::Json {
                                   const design::CheckRecord& r = record_of(limit);
                                   const bool preset = of_preset(spec, limit.of);
                                   return {{"key", key_of_limit(limit.of)},
                                           {"check", r.name},
                                           {"stated", in_unit_of(limit, limit.stated_si)},
                                           {"relaxed",
                                            limit.relaxed_si
                                                ? io::Json(in_unit_of(limit, *limit.relaxed_si))
                                                : nullptr},
                                           {"unit", units::unit_name(r.unit)},
                                           {"at_least", r.at_least},
                                           {"of_preset", preset}};
                                 })},
            {"planets", one.set.candidate.planets},
            {"teeth", train::teeth_of(one.set.candidate.teeth)},
            {"ratio", train::ratio(one.set.candidate.teeth)},
            {"objective", optimize::objective_of(spec, one.set, first) /
                              optimize::objective_record(first).per_unit},
            {"objective_without_model", !left_out(spec).empty()}};
  });
  return {{"freed", std::move(freed)},
          {"tried_alone",
           list_json(relaxed.alone, [](const LimitOf& limit) { return key_of_limit(limit); })},
          {"tried_in_pairs", list_json(relaxed.paired,
                                       [](const std::array<LimitOf, 2>& pair) -> io::Json {
                                         return {key_of_limit(pair[0]), key_of_limit(pair[1])};
                                       })},
          {"interrupted", relaxed.interrupted}};
}

}  // namespace gear3k::report
