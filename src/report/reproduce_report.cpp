#include "report/reproduce_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using nlohmann::ordered_json;

std::string shown(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : std::string("-");
}

std::string in_percent(const std::optional<double>& eta) {
  return eta ? fmt::format("{:.1f} %", 100.0 * *eta) : std::string("none");
}

std::string figure_text(const Figure& f) {
  const std::string value =
      std::isfinite(f.value) ? fmt::format("{:.{}f}", f.value, f.decimals) : std::string("none");
  return fmt::format("{} {}{}{}", f.name, value, f.unit.empty() ? "" : " ", f.unit);
}

std::string fit_text(const FrictionFit& f) {
  const std::string difference =
      f.backward ? fmt::format(" ({:+.1f} points)", 100.0 * (*f.backward - f.measured_backward))
                 : std::string();
  return fmt::format(
      "  {}: mu = {} gives the measured forward {}; backward is then {}, measured {}{}; that needs "
      "mu = {}\n",
      f.model, shown(f.mu, 3), in_percent(f.measured_forward), in_percent(f.backward),
      in_percent(f.measured_backward), difference, shown(f.backward_mu, 3));
}

}  // namespace

std::string reproduce_table(const Reproduction& r) {
  std::string text;
  for (const GearboxComparison& g : r.gearboxes) {
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", g.name);
    TextTable table({"quantity", "paper", "its equations", "exact", "measured", "unit"});
    table.align_left(5);
    for (const ComparedRow& row : g.rows) {
      table.add({row.quantity, shown(row.paper, row.decimals), shown(row.equations, row.decimals),
                 shown(row.exact, row.decimals), shown(row.measured, row.decimals), row.unit});
    }
    text += table.text(2);
    text += "\n  Efficiency by the paper's formula (ohlendorf) and by mean sliding, in %\n";
    TextTable efficiency(
        {"mu", "ohlendorf forward", "ohlendorf backward", "sliding forward", "sliding backward"});
    const auto percent = [](double eta) { return fmt::format("{:.2f}", 100.0 * eta); };
    for (const EfficiencyPoint& p : g.efficiency) {
      efficiency.add({fmt::format("{:g}", p.mu), percent(p.ohlendorf_forward),
                      percent(p.ohlendorf_backward), percent(p.sliding_forward),
                      percent(p.sliding_backward)});
    }
    text += efficiency.text(4);
    for (const FrictionFit& f : g.fits) text += fit_text(f);
  }
  text += "\nLedger of errata: low-backlash 3K gearbox paper\n";
  for (const LedgerEntry& entry : r.ledger) {
    std::string figures;
    for (const Figure& f : entry.figures) {
      figures += (figures.empty() ? "" : ", ") + figure_text(f);
    }
    text += fmt::format("{:>3}. {}\n     paper:    {}\n     finding:  {}\n     computed: {}\n",
                        entry.number, entry.where, entry.paper, entry.finding, figures);
  }
  return text;
}

std::string reproduce_json(const Reproduction& r) {
  ordered_json gearboxes = ordered_json::array();
  for (const GearboxComparison& g : r.gearboxes) {
    ordered_json rows = ordered_json::array();
    for (const ComparedRow& row : g.rows) {
      rows.push_back({{"quantity", row.quantity},
                      {"unit", row.unit},
                      {"paper", number_or_null(row.paper)},
                      {"equations", number_or_null(row.equations)},
                      {"exact", number_or_null(row.exact)},
                      {"measured", number_or_null(row.measured)}});
    }
    ordered_json efficiency = ordered_json::array();
    for (const EfficiencyPoint& p : g.efficiency) {
      efficiency.push_back(
          {{"mu", p.mu},
           {"ohlendorf", {{"forward", p.ohlendorf_forward}, {"backward", p.ohlendorf_backward}}},
           {"sliding", {{"forward", p.sliding_forward}, {"backward", p.sliding_backward}}}});
    }
    ordered_json fits = ordered_json::array();
    for (const FrictionFit& f : g.fits) {
      fits.push_back({{"loss_model", f.model},
                      {"mu_forward", number_or_null(f.mu)},
                      {"backward_predicted", number_or_null(f.backward)},
                      {"backward_measured", f.measured_backward},
                      {"mu_backward", number_or_null(f.backward_mu)}});
    }
    gearboxes.push_back({{"name", g.name},
                         {"rows", std::move(rows)},
                         {"efficiency", std::move(efficiency)},
                         {"friction_fits", std::move(fits)}});
  }
  ordered_json ledger = ordered_json::array();
  for (const LedgerEntry& entry : r.ledger) {
    ordered_json figures = ordered_json::array();
    for (const Figure& f : entry.figures) {
      figures.push_back({{"name", f.name}, {"unit", f.unit}, {"value", number_or_null(f.value)}});
    }
    ledger.push_back({{"number", entry.number},
                      {"where", entry.where},
                      {"paper", entry.paper},
                      {"finding", entry.finding},
                      {"figures", std::move(figures)}});
  }
  const ordered_json json{
      {"tool", tool_json()}, {"gearboxes", std::move(gearboxes)}, {"ledger", std::move(ledger)}};
  return json.dump(2) + "\n";
}

std::string reproduce_csv(const Reproduction& r) {
  std::string text = "gearbox,quantity,unit,paper,equations,exact,measured\n";
  const auto field = [](const std::optional<double>& v) { return v ? exact(*v) : std::string(); };
  for (const GearboxComparison& g : r.gearboxes) {
    for (const ComparedRow& row : g.rows) {
      text += csv_line({g.name, row.quantity, row.unit, field(row.paper), field(row.equations),
                        field(row.exact), field(row.measured)});
    }
    for (const EfficiencyPoint& p : g.efficiency) {
      const auto line = [&](const char* what, double ohlendorf, double sliding) {
        text += csv_line({g.name, fmt::format("{} at mu = {:g} (ohlendorf | sliding)", what, p.mu),
                          "", "", exact(ohlendorf), exact(sliding), ""});
      };
      line("eta_f", p.ohlendorf_forward, p.sliding_forward);
      line("eta_b", p.ohlendorf_backward, p.sliding_backward);
    }
    for (const FrictionFit& f : g.fits) {
      text +=
          csv_line({g.name, "mu from measured forward, " + f.model, "", "", field(f.mu), "", ""});
      text += csv_line({g.name, "eta_b with that mu, " + f.model, "", "", field(f.backward), "",
                        exact(f.measured_backward)});
      text += csv_line(
          {g.name, "mu from measured backward, " + f.model, "", "", field(f.backward_mu), "", ""});
    }
  }
  for (const LedgerEntry& entry : r.ledger) {
    for (const Figure& f : entry.figures) {
      text += csv_line({fmt::format("ledger {}", entry.number),
                        fmt::format("{}: {}", entry.where, f.name), f.unit, "", "", exact(f.value),
                        ""});
    }
  }
  return text;
}

}  // namespace gear3k::report
