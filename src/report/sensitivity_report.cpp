#include "report/sensitivity_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "io/keys/design_keys.hpp"
#include "report/check_subject.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"
#include "report/thermal_report.hpp"

namespace gear3k::report {

namespace {

using design::QuantityId, design::Sensitivities, design::Sensitivity, design::TightCheck,
    units::Unit;

/// How a quantity is shown.
struct Column {
  QuantityId quantity;
  const char* title;
  double per_si;      ///< number in the table per SI
  const char* field;  ///< in JSON and CSV
  Unit field_unit;
  bool needs_operating_point;
};
constexpr int kDecimals = 4;
constexpr double kPercent = 100.0, kArcmin = 10800.0 / std::numbers::pi;
constexpr std::array<Column, design::kQuantityCount> kColumns{
    {{design::kEtaForward, "eta forward %", kPercent, "d_eta_f", Unit::kNone, false},
     {design::kEtaBackward, "eta backward %", kPercent, "d_eta_b", Unit::kNone, false},
     {design::kTotalEtaForward, "total forward %", kPercent, "d_total_eta_f", Unit::kNone, true},
     {design::kTotalEtaBackward, "total backward %", kPercent, "d_total_eta_b", Unit::kNone, true},
     {design::kLostMotion, "lost motion arcmin", kArcmin, "d_lost_motion_arcmin", Unit::kArcmin,
      false}}};

std::vector<Column> columns_of(const Sensitivities& s) {
  std::vector<Column> columns;
  columns.reserve(kColumns.size());
  for (const Column& c : kColumns) {
    if (!c.needs_operating_point || s.operating_point) columns.push_back(c);
  }
  return columns;
}

std::string signed_number(double value, int decimals) {
  if (std::abs(value) < 0.5 * std::pow(10.0, -decimals)) return "0";
  return fmt::format("{:+.{}f}", value, decimals);
}

std::string step_text(const Sensitivity& row) {
  return with_unit(fmt::format("{:+.3g}", row.step), units::unit_name(row.unit));
}

bool unstated(const Sensitivities& s, const Sensitivity& row) {
  return !s.center_distance_given && row.input.kind == design::InputKind::kCenterDistance;
}

std::string quantity_table(const Sensitivities& s) {
  const std::vector<Column> columns = columns_of(s);
  std::vector<std::string> header{"input", "value", "step"};
  for (const Column& c : columns) header.emplace_back(c.title);
  TextTable table(header);
  std::vector<std::string> idle;
  for (const Sensitivity& row : s.inputs) {
    const bool moves = std::ranges::any_of(
        columns, [&](const Column& c) { return row.effect(c.quantity).value_or(0.0) != 0.0; });
    if (!moves) {
      idle.push_back(io::key_of(row.input));
      continue;
    }
    std::vector<std::string> cells{
        io::key_of(row.input) + (unstated(s, row) ? " (not stated)" : ""),
        fmt::format("{:.5g}", row.value), step_text(row)};
    for (const Column& c : columns) {
      const auto effect = row.effect(c.quantity);
      cells.push_back(effect ? signed_number(*effect * c.per_si, kDecimals) : "none");
    }
    table.add(std::move(cells));
  }
  std::string text =
      "\nSensitivities (change per step of each input, to first order; the most effective on eta "
      "backward first)\n" +
      table.text(2);
  if (!s.center_distance_given) {
    text +=
        "  center_distance_mm is not stated: it follows mesh P1-R1, and the other rows count that; "
        "its own row is as if it were\n";
  }
  if (!idle.empty()) text += fmt::format("  no effect on these: {}\n", fmt::join(idle, ", "));
  return text;
}

/// Of a train over temperature: lost motion and the least backlash of each mesh at each end.
std::string thermal_ends_table(const Sensitivities& s) {
  if (s.ends.empty()) return "";
  std::vector<std::string> header{"input", "step"};
  for (const train::ThermalState& end : s.ends) {
    const std::string at = design::state_text(end);
    header.push_back(fmt::format("arcmin at {}", at));
    for (const std::string_view mesh : train::kMeshNames) {
      header.push_back(fmt::format("{} um", mesh));
    }
  }
  TextTable table(header);
  for (const Sensitivity& row : s.inputs) {
    std::vector<std::string> cells{io::key_of(row.input), step_text(row)};
    bool moves = false;
    const auto add = [&](const std::optional<double>& slope, double per_si, int decimals) {
      const std::string text =
          slope ? signed_number(*slope * row.step * per_si, decimals) : std::string("none");
      moves = moves || (slope && text != "0");
      cells.push_back(text);
    };
    for (const design::ThermalSlopes& at : row.thermal) {
      add(at.lost_motion, kArcmin, kDecimals);
      for (const auto& mesh : at.least_backlash) add(mesh, 1.0 / units::kMicrometre, 3);
    }
    if (moves) table.add(std::move(cells));
  }
  return "\nSensitivities at the ends of [thermal] (change per step of lost motion and of the "
         "least backlash of each mesh)\n" +
         table.text(2);
}

/// The inputs that move a margin most per step, at most three.
std::vector<const Sensitivity*> strongest_inputs(const Sensitivities& s, std::size_t check) {
  constexpr std::size_t kMost = 3;
  const auto size = [&](const Sensitivity* row) {
    return std::abs(row->margin_effect(check).value_or(0.0));
  };
  std::vector<const Sensitivity*> rows;
  rows.reserve(s.inputs.size());
  for (const Sensitivity& row : s.inputs) {
    if (size(&row) > 0.0) rows.push_back(&row);
  }
  std::ranges::stable_sort(rows, [&](const auto* a, const auto* b) { return size(a) > size(b); });
  if (rows.size() > kMost) rows.resize(kMost);
  return rows;
}

std::string check_table(const Sensitivities& s) {
  if (s.checks.empty()) return "";
  TextTable table({"check", "of", "margin", "moved most by", "step", "change"});
  for (const std::size_t column : {1U, 3U}) table.align_left(column);
  for (std::size_t i = 0; i < s.checks.size(); ++i) {
    const TightCheck& check = s.checks[i];
    const Unit unit = check.record->unit;
    const int decimals = unit == Unit::kMicrometre || unit == Unit::kArcmin ? 2 : 4;
    std::vector<std::string> cells{
        std::string(check.record->title), subject_of(check),
        with_unit(fixed(units::difference_from_si(check.margin, unit), decimals),
                  units::unit_name(unit))};
    for (const Sensitivity* row : strongest_inputs(s, i)) {
      cells.push_back(io::key_of(row->input));
      cells.push_back(step_text(*row));
      cells.push_back(signed_number(
          units::difference_from_si(row->margin_effect(i).value_or(0.0), unit), decimals));
      table.add(std::move(cells));
      cells = {"", "", ""};
    }
  }
  return "\nTightest checks (least margin over scale; what moves the margin most per step)\n" +
         table.text(2);
}

std::optional<double> in_unit_or_none(const std::optional<double>& si, Unit unit) {
  if (!si) return std::nullopt;
  return units::from_si(*si, unit);
}

/// The unit of a derivative: "arcmin/mm", "1/deg", "um/(kg m2)".
std::string derivative_unit(Unit of, Unit by_unit) {
  const std::string_view name = units::unit_name(of);
  const std::string_view by = units::unit_name(by_unit);
  if (by.empty()) return std::string(name);
  const bool product = by.find_first_of(" /") != std::string::npos;
  return fmt::format(fmt::runtime(product ? "{}/({})" : "{}/{}"), name.empty() ? "1" : name, by);
}

/// Derivatives at an end of the range of temperature.
Fields thermal_slope_fields(const Sensitivities& s, const Sensitivity& row, std::size_t end) {
  const design::ThermalSlopes& at = row.thermal[end];
  const std::string state = design::state_text(s.ends[end]);
  Fields f(fmt::format("{} at {}", io::key_of(row.input), state));
  f.add("temperature_c", celsius(s.ends[end].temperature_K));
  f.add("moisture", moisture_name(s.ends[end].moisture));
  f.add("d_lost_motion_arcmin", in_unit_or_none(at.lost_motion, Unit::kArcmin),
        {"d_lost_motion_arcmin", derivative_unit(Unit::kArcmin, row.unit)});
  const auto add = [&](const char* field, const auto& slopes) {
    f.add(field, io::Json::array());
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      f.append(field, in_unit_or_none(slopes[k], Unit::kMicrometre),
               {fmt::format("{} {}", field, train::kMeshNames[k]),
                derivative_unit(Unit::kMicrometre, row.unit)});
    }
  };
  add("d_normal_backlash_um", at.normal_backlash);
  add("d_least_backlash_um", at.least_backlash);
  return f;
}

Fields input_fields(const Sensitivities& s, const Sensitivity& row) {
  const std::string& key = io::key_of(row.input);
  Fields f(key);
  f.add("input", key);
  f.add("unit", units::unit_name(row.unit));
  f.add("stated", !unstated(s, row));
  f.add("value", row.value);
  f.add("step", row.step);
  for (const Column& c : columns_of(s)) {
    f.add(c.field, in_unit_or_none(row.slope[static_cast<std::size_t>(c.quantity)], c.field_unit),
          {c.field, derivative_unit(c.field_unit, row.unit)});
  }
  if (!s.ends.empty()) {
    f.add("thermal", io::Json::array());
    for (std::size_t end = 0; end < s.ends.size(); ++end) {
      f.append("thermal", thermal_slope_fields(s, row, end));
    }
  }
  f.add("d_margin", io::Json::array());
  for (std::size_t i = 0; i < s.checks.size(); ++i) {
    const TightCheck& check = s.checks[i];
    const Unit unit = check.record->unit;
    f.append("d_margin", in_unit_or_none(row.margin_slope[i], unit),
             {fmt::format("d_margin {} {}", check.record->name, subject_of(check)),
              derivative_unit(unit, row.unit)});
  }
  return f;
}

Fields tight_check_fields(const TightCheck& check) {
  Fields f;
  f.add("name", check.record->name);
  if (!check.mesh.empty()) f.add("mesh", check.mesh);
  if (!check.gear.empty()) f.add("gear", check.gear);
  f.add("margin", units::difference_from_si(check.margin, check.record->unit));
  f.add("unit", units::unit_name(check.record->unit));
  return f;
}

}  // namespace

std::string sensitivity_table(const Sensitivities& s) {
  if (s.inputs.empty()) return "";
  return quantity_table(s) + thermal_ends_table(s) + check_table(s);
}

Fields sensitivity_fields(const Sensitivities& s) {
  Fields f;
  f.add_list("sensitivities", s.inputs,
             [&](const Sensitivity& row) { return input_fields(s, row); });
  f.add_list("tightest_checks", s.checks, tight_check_fields);
  return f;
}

}  // namespace gear3k::report
