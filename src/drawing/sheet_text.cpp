#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "drawing/inspection_sheet.hpp"
#include "drawing/xml_text.hpp"
#include "io/text/printable.hpp"
#include "report/text_table.hpp"

namespace gear3k::drawing {

namespace {

/// Decimals that a workshop reads: 1 um of lengths, 1e-4 deg, 0.1 um.
int decimals_of(const Characteristic& row) {
  if (row.unit == "um") return 1;
  return row.unit == "mm" ? 3 : 4;
}

/// What says which gear and tool it is in full, as a tool of another module in its fourth digit
/// cuts another gear.
std::string shown(const Characteristic& row, const std::optional<double>& value) {
  if (!value) return "";
  if (row.group == "gear") return fmt::format("{:.10g}", *value);
  if (row.unit.empty()) return fmt::format("{:.6g}", *value);
  return fmt::format("{:.{}f}", *value, decimals_of(row));
}

/// Towards greater (sense 1) or smaller values (-1), but for what computing leaves.
double rounded_to(double value, double per_step, double sense) {
  constexpr double kOfComputing = 1e-6;
  return sense * std::ceil(sense * value * per_step - kOfComputing) / per_step;
}

/// Nominal value, lower and upper limit as a page shows them.
struct ShownSizes {
  std::string nominal;
  std::array<std::string, 2> limits;
};

/// Limits of few decimals that lie within the limits, so that nothing is accepted that is beyond
/// them; of more decimals, as the nominal value, where those would leave nothing between them.
ShownSizes shown_sizes(const Characteristic& row) {
  if (row.group == "gear" || row.unit.empty() || (!row.lower && !row.upper)) {
    return {shown(row, row.nominal), {shown(row, row.lower), shown(row, row.upper)}};
  }
  constexpr int kMostDecimals = 7;
  const bool is_range = row.lower && row.upper && *row.lower < *row.upper;
  for (int decimals = decimals_of(row);; ++decimals) {
    const double per_step = std::pow(10.0, decimals);
    const auto text = [&](double value) { return fmt::format("{:.{}f}", value + 0.0, decimals); };
    ShownSizes sizes;
    std::array<double, 2> limits{-std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::infinity()};
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      const std::optional<double>& exact = side == 0 ? row.lower : row.upper;
      if (!exact) continue;
      limits[side] = rounded_to(*exact, per_step, side == 0 ? 1.0 : -1.0) + 0.0;
      sizes.limits[side] = text(limits[side]);
    }
    const bool done =
        decimals == kMostDecimals || limits[0] < limits[1] || (!is_range && limits[0] == limits[1]);
    if (!done) continue;
    if (!row.nominal) return sizes;
    const bool within = *row.nominal >= row.lower.value_or(*row.nominal) &&
                        *row.nominal <= row.upper.value_or(*row.nominal);
    double nominal = std::round(*row.nominal * per_step) / per_step;
    // What is good is not shown beyond its limits.
    if (within && limits[0] <= limits[1]) nominal = std::clamp(nominal, limits[0], limits[1]);
    sizes.nominal = text(nominal);
    return sizes;
  }
}

/// Twelve digits, less than a picometre: what the change of units leaves after them is no size.
std::string digits_or_empty(const std::optional<double>& value) {
  return value ? fmt::format("{:.12g}", *value) : "";
}

/// What a page says above its table.
constexpr const char* kPageHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"/><title>{0}</title>
<style>
@page {{ size: A4; margin: 15mm; }}
body {{ font: 10pt "DejaVu Sans", Arial, sans-serif; color: #202020; }}
h1 {{ font-size: 13pt; margin: 0 0 4mm; }}
table {{ border-collapse: collapse; width: 100%; }}
th, td {{ border: 0.2mm solid #808080; padding: 0.8mm 1.5mm; text-align: right; }}
th {{ background: #eeeeee; }}
.text {{ text-align: left; }}
.measured {{ width: 22mm; }}
</style></head><body>
<h1>{0}</h1>
<table>
<tr><th class="text">characteristic</th><th class="text">symbol</th><th class="text">unit</th><th>nominal</th><th>lower</th><th>upper</th><th class="measured">measured</th><th class="text">note</th></tr>
)";

}  // namespace

std::string sheet_csv(const InspectionSheet& sheet) {
  std::string text = report::csv_line(
      {"group", "characteristic", "symbol", "unit", "nominal", "lower", "upper", "note"});
  for (const Characteristic& row : sheet.rows) {
    text +=
        report::csv_line({row.group, row.name, row.symbol, row.unit, digits_or_empty(row.nominal),
                          digits_or_empty(row.lower), digits_or_empty(row.upper), row.note});
  }
  for (const std::string& note : sheet.notes) {
    text += report::csv_line({"note", "", "", "", "", "", "", note});
  }
  return text;
}

std::string sheet_html(const InspectionSheet& sheet) {
  const std::string title =
      sheet.title.empty() ? sheet.name : fmt::format("{}: {}", sheet.title, sheet.name);
  std::string text = fmt::format(kPageHead, xml_text(fmt::format("Inspection sheet of {}", title)));
  std::string group;
  for (const Characteristic& row : sheet.rows) {
    if (row.group != group) {
      group = row.group;
      text += fmt::format("<tr><th class=\"text\" colspan=\"8\">{}</th></tr>\n", xml_text(group));
    }
    const ShownSizes sizes = shown_sizes(row);
    text += fmt::format(
        R"(<tr><td class="text">{}</td><td class="text">{}</td><td class="text">{}</td><td>{}</td><td>{}</td><td>{}</td><td></td><td class="text">{}</td></tr>)"
        "\n",
        xml_text(row.name), xml_text(row.symbol), xml_text(row.unit), sizes.nominal,
        sizes.limits[0], sizes.limits[1], xml_text(row.note));
  }
  text += "</table>\n";
  for (const std::string& note : sheet.notes) text += fmt::format("<p>{}</p>\n", xml_text(note));
  return text + "</body></html>\n";
}

}  // namespace gear3k::drawing
