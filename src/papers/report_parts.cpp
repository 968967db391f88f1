#include "papers/report_parts.hpp"

#include <fmt/format.h>

#include <cmath>

#include "report/text_table.hpp"

namespace gear3k::papers {

using report::Fields, report::csv_line, report::exact;

std::string shown(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : std::string("-");
}

namespace {

std::string figure_text(const Figure& f) {
  const std::string value =
      std::isfinite(f.value) ? fmt::format("{:.{}f}", f.value, f.decimals) : std::string("none");
  return fmt::format("{} {}{}{}", f.name, value, f.unit.empty() ? "" : " ", f.unit);
}

}  // namespace

std::string ledger_text(const std::vector<LedgerEntry>& ledger, const char* source) {
  std::string text;
  for (const LedgerEntry& entry : ledger) {
    std::string figures;
    for (const Figure& f : entry.figures) {
      figures += (figures.empty() ? "" : ", ") + figure_text(f);
    }
    text += fmt::format("{:>3}. {}\n     {:<9} {}\n     finding:  {}\n     computed: {}\n",
                        entry.number, entry.where, fmt::format("{}:", source), entry.paper,
                        entry.finding, figures);
  }
  return text;
}

Fields row_fields(const std::string& gearbox, const ComparedRow& row) {
  Fields f;
  f.add_row(gearbox, {"gearbox"});
  f.add("quantity", row.quantity, {"quantity"});
  f.add("unit", row.unit, {"unit"});
  f.add("paper", row.paper, {"paper"});
  f.add("equations", row.equations, {"equations"});
  f.add("exact", row.exact, {"exact"});
  f.add("measured", row.measured, {"measured"});
  f.add("source", row.source.empty() ? io::Json() : io::Json(row.source), {"source"});
  return f;
}

std::string reproduce_line(std::vector<std::string> fields) {
  constexpr std::size_t kColumns = 8;
  fields.resize(kColumns);
  return csv_line(fields);
}

io::Json ledger_json(const std::vector<LedgerEntry>& entries) {
  io::Json ledger = io::Json::array();
  for (const LedgerEntry& entry : entries) {
    io::Json figures = io::Json::array();
    for (const Figure& f : entry.figures) {
      figures.push_back({{"name", f.name}, {"unit", f.unit}, {"value", f.value}});
    }
    ledger.push_back({{"number", entry.number},
                      {"where", entry.where},
                      {"paper", entry.paper},
                      {"finding", entry.finding},
                      {"figures", std::move(figures)}});
  }
  return ledger;
}

std::string ledger_csv(const std::vector<LedgerEntry>& ledger, const std::string& name) {
  std::string text;
  for (const LedgerEntry& entry : ledger) {
    for (const Figure& f : entry.figures) {
      text += reproduce_line({fmt::format("{} {}", name, entry.number),
                              fmt::format("{}: {}", entry.where, f.name), f.unit, "", "",
                              exact(f.value), ""});
    }
  }
  return text;
}

}  // namespace gear3k::papers
