#include "report/tolerance_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "report/check_subject.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using design::BuiltRange, design::CheckLimits, design::GearLimits, design::MeshLimits,
    design::ToleranceLimits, units::Unit;

/// A quantity of a report: its name in JSON without the unit, its value, unit and decimals.
struct Quantity {
  std::string_view name;
  BuiltRange range;
  Unit unit;
  int decimals;
};

std::vector<Quantity> quantities(const MeshLimits& m) {
  return {
      {"normal_backlash", m.normal_backlash_m, Unit::kMicrometre, 2},
      {"circumferential_backlash", m.circumferential_backlash_m, Unit::kMicrometre, 2},
      {"radial_backlash", m.radial_backlash_m, Unit::kMicrometre, 2},
      {"contact_ratio", m.contact_ratio, Unit::kNone, 3},
      {"working_pressure_angle", m.working_pressure_angle_rad, Unit::kDegree, 3},
  };
}
std::vector<Quantity> quantities(const MeshLimits& m, std::size_t gear) {
  return {
      {"root_clearance", m.root_clearance_m[gear], Unit::kMillimetre, 4},
      {"active_root_diameter", m.active_root_diameter_m[gear], Unit::kMillimetre, 4},
      {"form_reserve", m.form_reserve_m[gear], Unit::kMillimetre, 4},
  };
}
std::vector<Quantity> quantities(const GearLimits& g) {
  return {
      {"generating_shift", g.generating_shift, Unit::kNone, 4},
      {"tooth_thickness", g.tooth_thickness_m, Unit::kMillimetre, 4},
      {"tip_diameter", g.tip_diameter_m, Unit::kMillimetre, 4},
      {"root_diameter", g.root_diameter_m, Unit::kMillimetre, 4},
      {"form_diameter", g.form_diameter_m, Unit::kMillimetre, 4},
      {"tip_thickness", g.tip_thickness_m, Unit::kMillimetre, 4},
  };
}

/// A margin is a difference: of temperatures without the unit's zero.
BuiltRange margin_in_unit(const CheckLimits& c) {
  const auto shown = [&](double si) { return units::difference_from_si(si, c.record->unit); };
  return {.least = shown(c.margin.least),
          .nominal = shown(c.margin.nominal),
          .greatest = shown(c.margin.greatest)};
}

BuiltRange in_unit(const BuiltRange& r, Unit unit) {
  return {.least = units::from_si(r.least, unit),
          .nominal = units::from_si(r.nominal, unit),
          .greatest = units::from_si(r.greatest, unit)};
}

std::string cell(const Quantity& q) {
  const BuiltRange r = in_unit(q.range, q.unit);
  const auto number = [&](double x) {
    return std::isfinite(x) ? fixed(x, q.decimals) : std::string("none");
  };
  return fmt::format("{} / {} / {}", number(r.least), number(r.nominal), number(r.greatest));
}

void add_cells(std::vector<std::string>& row, const std::vector<Quantity>& all) {
  for (const Quantity& q : all) row.push_back(cell(q));
}

std::string margin_cell(const CheckLimits& c) {
  const Unit unit = c.record->unit;
  const int decimals = unit == Unit::kMicrometre || unit == Unit::kArcmin ? 2 : 4;
  const std::string_view name = units::unit_name(unit);
  return cell({"", c.margin, unit, decimals}) + (name.empty() ? "" : fmt::format(" {}", name));
}

std::string mesh_table(const ToleranceLimits& limits) {
  TextTable table({"mesh", "backlash j_bn, um", "j_wt on pitch circles, um", "radial j_r, um",
                   "contact ratio", "working angle, deg"});
  TextTable flanks({"mesh", "gear", "tip clearance, mm", "active flank from dia, mm",
                    "reserve to form circle, mm"});
  flanks.align_left(1);
  for (const MeshLimits& m : limits.meshes) {
    std::vector<std::string> row{m.name};
    add_cells(row, quantities(m));
    table.add(std::move(row));
    for (const std::size_t i : {0U, 1U}) {
      std::vector<std::string> flank{i == 0 ? m.name : "", m.gear_names[i]};
      add_cells(flank, quantities(m, i));
      flanks.add(std::move(flank));
    }
  }
  return table.text(2) + "\n" + flanks.text(2);
}

std::string gear_table(const ToleranceLimits& limits) {
  TextTable table({"gear", "x_E", "tooth thickness, mm", "tip dia, mm", "form dia, mm",
                   "root dia, mm", "tip thickness, mm"});
  for (const GearLimits& g : limits.gears) {
    std::vector<std::string> row{g.name};
    auto all = quantities(g);
    std::swap(all[3], all[4]);  // form before root, as in the table of the drawn gears
    add_cells(row, all);
    table.add(std::move(row));
  }
  return fmt::format(
      "\n{}  x_E is that of a tool of nominal thickness fed in; form and root diameters are those "
      "of "
      "the drawn tool\n",
      table.text(2));
}

/// Every check that fails at its worst corner, and of each other the subject with the least margin.
std::string check_table(const std::vector<CheckLimits>& checks) {
  TextTable table({"", "check", "tightest", "margin"});
  for (const std::size_t column : {1U, 2U}) table.align_left(column);
  std::vector<const CheckLimits*> rows;
  for (const CheckLimits& c : checks) {
    if (!c.holds) {
      table.add({"FAILS", std::string(c.record->title), subject_of(c), margin_cell(c)});
      continue;
    }
    const auto row =
        std::ranges::find_if(rows, [&](const CheckLimits* r) { return r->record == c.record; });
    if (row == rows.end()) {
      rows.push_back(&c);
    } else if (c.margin.least < (*row)->margin.least) {
      *row = &c;
    }
  }
  for (const CheckLimits* c : rows) {
    table.add({"ok", std::string(c->record->title), subject_of(*c), margin_cell(*c)});
  }
  const auto failing = std::ranges::count_if(checks, [](const CheckLimits& c) { return !c.holds; });
  return fmt::format("\n  Checks at their worst within the tolerances: {} of {} fail\n", failing,
                     checks.size()) +
         table.text(2);
}

/// Least, nominal and greatest as an object, each with a row "built <name> min", ...
Fields range_fields(const std::string& item, std::string_view name, const BuiltRange& range,
                    Unit unit) {
  const BuiltRange r = in_unit(range, unit);
  Fields f(item);
  for (const auto& [end, value] : std::array<std::pair<const char*, double>, 3>{
           {{"min", r.least}, {"nominal", r.nominal}, {"max", r.greatest}}}) {
    f.add(end, value, {fmt::format("built {} {}", name, end), std::string(units::unit_name(unit))});
  }
  return f;
}

std::string key_of(const Quantity& q) {
  const std::string_view unit = units::unit_name(q.unit);
  return unit.empty() ? std::string(q.name) : fmt::format("{}_{}", q.name, unit);
}

Fields mesh_limit_fields(const MeshLimits& m) {
  Fields f;
  f.add("name", m.name);
  for (const Quantity& q : quantities(m)) {
    f.add(key_of(q), range_fields(m.name, q.name, q.range, q.unit));
  }
  for (const std::size_t i : {0U, 1U}) {
    for (const Quantity& q : quantities(m, i)) {
      f.append(key_of(q),
               range_fields(m.name, fmt::format("{}_gear{}", q.name, i + 1), q.range, q.unit));
    }
  }
  return f;
}

Fields gear_limit_fields(const GearLimits& g) {
  Fields f;
  f.add("name", g.name);
  for (const Quantity& q : quantities(g)) {
    f.add(key_of(q), range_fields(g.name, q.name, q.range, q.unit));
  }
  return f;
}

Fields check_limit_fields(const CheckLimits& c) {
  Fields f;
  f.add("name", c.record->name);
  if (!c.mesh.empty()) f.add("mesh", c.mesh);
  if (!c.gear.empty()) f.add("gear", c.gear);
  const std::string unit(units::unit_name(c.record->unit));
  const BuiltRange r = margin_in_unit(c);
  Fields margin(subject_of(c));
  const auto add = [&](const char* end, double value, const char* ok) {
    margin.add(end, value,
               {.quantity = fmt::format("built margin {} {}", c.record->name, end),
                .unit = unit,
                .limit = "0",
                .ok = ok});
  };
  add("min", r.least, c.holds ? "true" : "false");
  add("nominal", r.nominal, "");
  add("max", r.greatest, "");
  f.add("margin", std::move(margin));
  f.add("unit", unit);
  f.add("ok", c.holds);
  return f;
}

}  // namespace

std::string tolerance_table(const std::optional<ToleranceLimits>& limits) {
  if (!limits) return "";
  std::string text =
      "\nLimits of the built gearbox (min / nominal / max; nominal as drawn; without run-out, "
      "pitch deviations, pin position and planet phase)\n";
  if (limits->lost_motion_rad) {
    text += fmt::format("  lost motion at output, kinematic   {} arcmin\n\n",
                        cell({"", *limits->lost_motion_rad, Unit::kArcmin, 2}));
  }
  return text + mesh_table(*limits) + gear_table(*limits) + check_table(limits->checks);
}

Fields tolerance_fields(const ToleranceLimits& limits) {
  Fields f;
  f.add_list("meshes", limits.meshes, mesh_limit_fields, 1);
  f.add_list("gears", limits.gears, gear_limit_fields, 2);
  f.add_list("checks", limits.checks, check_limit_fields, 3);
  if (limits.lost_motion_rad) {
    f.add("lost_motion_arcmin",
          range_fields("train", "lost_motion_kinematic", *limits.lost_motion_rad, Unit::kArcmin));
  }
  return f;
}

}  // namespace gear3k::report
