#include "report/selection_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "io/text/printable.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using actuator::Pair, actuator::PairResult, actuator::PairVerdict, actuator::Selection,
    actuator::SelectionTask;
using io::Json;

std::string_view limit_name(actuator::PairLimit limit) {
  return actuator::kPairLimitNames[static_cast<std::size_t>(limit)];
}

/// A name as a field of a CSV, ready for many lines.
std::string field(const std::string& name) {
  std::string line = csv_line({name});
  line.pop_back();
  return line;
}

/// A value that is limited, nothing where it has no bound.
std::optional<double> finite(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Names of what is not known of a pair.
std::vector<std::string_view> unknown_names(const SelectionTask& task, const Pair& pair) {
  std::vector<std::string_view> names;
  for (const actuator::Unknown what : actuator::unknown_of(task, pair)) {
    names.push_back(actuator::kUnknownNames[static_cast<std::size_t>(what)]);
  }
  return names;
}

/// Inertia, breakaway, transparency.
std::vector<std::optional<double>> felt_values(const actuator::Felt& felt) {
  return {finite(felt.inertia_kgm2), finite(felt.breakaway_Nm), finite(felt.transparency)};
}

Json felt_values_json(const actuator::Felt& felt) {
  const auto values = felt_values(felt);
  return {{"inertia_kgm2", values[0]}, {"breakaway_nm", values[1]}, {"transparency", values[2]}};
}

/// Where breakaway is an objective or limited: how many pairs of the front lack friction in it.
std::string breakaway_note(const SelectionTask& task, const Selection& selection) {
  using actuator::Unknown;
  const bool asked = task.felt.max_breakaway_Nm.has_value() ||
                     std::ranges::count(task.objectives, actuator::Objective::kBreakaway) > 0;
  const auto lacking = std::ranges::count_if(selection.front, [&](const PairResult& r) {
    return std::ranges::any_of(actuator::unknown_of(task, r.pair), [](Unknown what) {
      return what == Unknown::kMotorFriction || what == Unknown::kMotorCoulomb ||
             what == Unknown::kGearboxDrag;
    });
  });
  if (!asked || lacking == 0) return "";
  return fmt::format(
      "Note: breakaway of {} pairs of the front is without friction that is not known (of the "
      "motor at rest, or the gearbox's drag), and is the better for it\n",
      lacking);
}

Json pair_json(const SelectionTask& task, const PairResult& r) {
  // The limit with the least to spare is no limit that is exceeded.
  const bool exceeded = r.limit && r.excess > 0.0;
  Json json{{"motor", task.motors[r.pair.motor].name},
            {"gearbox", task.gearboxes[r.pair.gearbox].name},
            {"ratio", task.gearboxes[r.pair.gearbox].gearbox.ratio},
            {"energy_j", r.energy_J},
            {"mass_kg", r.mass_kg},
            {"peak_current_a", r.peak_current_A},
            {"rms_current_a", r.rms_current_A},
            {"peak_voltage_v", r.peak_voltage_V},
            {"rms_torque_nm", r.rms_torque_Nm},
            {"peak_torque_nm", r.peak_torque_Nm},
            {"breakaway_nm", r.breakaway_Nm},
            {"inertia_kgm2", r.inertia_kgm2},
            {"winding_c",
             r.winding_K ? Json(units::from_si(*r.winding_K, units::Unit::kCelsius)) : Json()},
            {"limit", exceeded ? Json(limit_name(*r.limit)) : Json()},
            {"excess", exceeded ? Json(r.excess) : Json()},
            {"unknown", unknown_names(task, r.pair)}};
  if (r.felt) json["felt"] = felt_values_json(*r.felt);
  return json;
}

std::string optional_cell(const std::optional<double>& value) {
  return value ? exact(*value) : std::string();
}

}  // namespace

std::string selection_csv(const SelectionTask& task, const Selection& selection) {
  std::vector<std::string> motors;
  motors.reserve(task.motors.size());
  for (const auto& motor : task.motors) motors.push_back(field(motor.name));
  std::vector<std::string> gearboxes;
  gearboxes.reserve(task.gearboxes.size());
  for (const auto& gearbox : task.gearboxes) gearboxes.push_back(field(gearbox.name));
  std::string text = "motor,gearbox,status,reason,excess,run\n";
  constexpr std::size_t kUsualLine = 70;
  text.reserve(text.size() + kUsualLine * selection.verdicts.size());
  for (const PairVerdict& v : selection.verdicts) {
    text += motors[v.pair.motor];
    text += ',';
    text += gearboxes[v.pair.gearbox];
    text += ',';
    text += actuator::kPairStatusNames[static_cast<std::size_t>(v.status)];
    text += ',';
    if (v.status == actuator::PairStatus::kInfeasible && v.limit) {
      text += limit_name(*v.limit);
      fmt::format_to(std::back_inserter(text), ",{:.6g}", v.excess);
    } else {
      text += ',';
    }
    text += v.run ? ",1\n" : ",0\n";
  }
  return text;
}

std::string selection_front_csv(const SelectionTask& task, const Selection& selection) {
  std::string text =
      "motor,gearbox,ratio,energy_j,mass_kg,peak_current_a,rms_current_a,peak_voltage_v,"
      "rms_torque_nm,peak_torque_nm,breakaway_nm,inertia_kgm2,winding_c,unknown,felt_inertia_kgm2,"
      "transparency\n";
  for (const PairResult& r : selection.front) {
    text += csv_line({task.motors[r.pair.motor].name, task.gearboxes[r.pair.gearbox].name,
                      exact(task.gearboxes[r.pair.gearbox].gearbox.ratio), exact(r.energy_J),
                      optional_cell(r.mass_kg), exact(r.peak_current_A), exact(r.rms_current_A),
                      exact(r.peak_voltage_V), exact(r.rms_torque_Nm), exact(r.peak_torque_Nm),
                      optional_cell(r.breakaway_Nm), exact(r.inertia_kgm2),
                      r.winding_K ? exact(units::from_si(*r.winding_K, units::Unit::kCelsius)) : "",
                      fmt::format("{}", fmt::join(unknown_names(task, r.pair), " ")),
                      r.felt ? optional_cell(finite(r.felt->inertia_kgm2)) : "",
                      r.felt ? optional_cell(finite(r.felt->transparency)) : ""});
  }
  return text;
}

io::Json selection_json(const SelectionTask& task, const Selection& selection) {
  Json rejected = Json::object();
  for (std::size_t k = 0; k < selection.rejected.size(); ++k) {
    rejected[actuator::kPairLimitNames[k]] = selection.rejected[k];
  }
  Json objectives = Json::array();
  for (const actuator::Objective objective : task.objectives) {
    objectives.push_back(actuator::kObjectiveNames[static_cast<std::size_t>(objective)]);
  }
  std::array<std::size_t, actuator::kPairStatusNames.size()> counts{};
  for (const PairVerdict& v : selection.verdicts) ++counts[static_cast<std::size_t>(v.status)];
  Json front = Json::array();
  for (const PairResult& r : selection.front) front.push_back(pair_json(task, r));
  return Json{{"tool", tool_json()},
              {"name", task.name},
              {"objectives", objectives},
              {"motors", task.motors.size()},
              {"gearboxes", task.gearboxes.size()},
              {"pairs", selection.verdicts.size()},
              {"run", selection.run},
              {"front_pairs", counts[0]},
              {"dominated", counts[1]},
              {"infeasible", counts[2]},
              {"rejected", rejected},
              {"front", front},
              {"nearest", selection.nearest ? pair_json(task, *selection.nearest) : Json()}};
}

std::string selection_table(const SelectionTask& task, const Selection& selection) {
  std::string text = fmt::format(
      "{}: {} motors x {} gearboxes = {} pairs, {} cycles run; front of {}\n",
      task.name.empty() ? "selection" : io::printable(task.name), task.motors.size(),
      task.gearboxes.size(), selection.verdicts.size(), selection.run, selection.front.size());
  std::vector<std::string> heads{"motor",  "gearbox", "ratio",  "energy J", "mass kg",
                                 "A peak", "A rms",   "V peak", "J kg m2"};
  std::vector<std::string_view> unknown;  // each by a letter, told below the table
  const auto letters_of = [&](const PairResult& r) {
    std::string letters;
    for (const std::string_view name : unknown_names(task, r.pair)) {
      const auto place = std::ranges::find(unknown, name) - unknown.begin();
      if (place == std::ssize(unknown)) unknown.push_back(name);
      letters += static_cast<char>('a' + place);
    }
    std::ranges::sort(letters);
    return letters;
  };
  heads.emplace_back("?");
  TextTable table(heads);
  table.align_left(1);
  table.align_left(heads.size() - 1);
  // What is felt, where it is limited.
  const bool felt =
      std::ranges::any_of(selection.front, [](const PairResult& r) { return r.felt.has_value(); });
  TextTable felt_table({"motor", "gearbox", "felt kg m2", "breakaway N m", "transparency"});
  felt_table.align_left(1);
  const auto cell = [](double value) { return fmt::format("{:.4g}", value); };
  for (const PairResult& r : selection.front) {
    std::vector<std::string> cells{task.motors[r.pair.motor].name,
                                   task.gearboxes[r.pair.gearbox].name,
                                   cell(task.gearboxes[r.pair.gearbox].gearbox.ratio),
                                   cell(r.energy_J),
                                   r.mass_kg ? cell(*r.mass_kg) : "-",
                                   cell(r.peak_current_A),
                                   cell(r.rms_current_A),
                                   cell(r.peak_voltage_V),
                                   cell(r.inertia_kgm2)};
    cells.push_back(letters_of(r));
    table.add(cells);
    if (!felt) continue;
    cells.resize(2);
    for (const auto& value : felt_values(*r.felt)) cells.push_back(value ? cell(*value) : "-");
    felt_table.add(cells);
  }
  if (!selection.front.empty()) text += table.text(0);
  if (!unknown.empty()) {
    std::vector<std::string> legend;
    for (std::size_t k = 0; k < unknown.size(); ++k) {
      legend.push_back(fmt::format("{} {}", static_cast<char>('a' + k), unknown[k]));
    }
    text += fmt::format("?: not known of the pair: {}\n", fmt::join(legend, ", "));
  }
  if (felt) text += '\n' + felt_table.text(0);
  const auto frictionless = std::ranges::count_if(selection.front, [&](const PairResult& r) {
    return !task.motors[r.pair.motor].friction_known;
  });
  if (frictionless > 0) {
    text += fmt::format(
        "Note: {} pairs of the front have a motor of which no friction is published: it runs "
        "without, and is the better for it\n",
        frictionless);
  }
  text += breakaway_note(task, selection);
  for (std::size_t k = 0; k < selection.rejected.size(); ++k) {
    if (selection.rejected[k] == 0) continue;
    text +=
        fmt::format("rejected by {}: {}\n", actuator::kPairLimitNames[k], selection.rejected[k]);
  }
  return text;
}

std::string excess_text(double share) {
  return std::isfinite(share) ? fmt::format(" by {:.4g} % of the limit", 100.0 * share)
                              : " without bound";
}

std::string selection_blocking_text(const SelectionTask& task, const Selection& selection) {
  if (!selection.front.empty()) return "";
  if (!selection.nearest) {
    return task.gearboxes.empty() ? "no pair: there is no gearbox" : "no pair: there is no motor";
  }
  const PairResult& r = *selection.nearest;
  return fmt::format("no pair is feasible: the nearest, {} with {}, exceeds {}{}",
                     io::printable(task.motors[r.pair.motor].name),
                     io::printable(task.gearboxes[r.pair.gearbox].name),
                     r.limit ? limit_name(*r.limit) : "no limit", excess_text(r.excess));
}

}  // namespace gear3k::report
