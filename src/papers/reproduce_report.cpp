#include "papers/reproduce_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/text/json.hpp"
#include "papers/backdrivability_report.hpp"
#include "papers/directional_bench_report.hpp"
#include "papers/report_parts.hpp"
#include "report/display.hpp"
#include "report/fields.hpp"
#include "report/text_table.hpp"

namespace gear3k::papers {

namespace {

using report::Fields, report::TextTable, report::exact, report::fixed, report::list_json,
    report::tool_json;

std::string in_percent(const std::optional<double>& eta) {
  return eta ? fmt::format("{:.1f} %", 100.0 * *eta) : std::string("none");
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

std::string directional_text(const GearboxComparison& g) {
  if (!g.directional) {
    return fmt::format(
        "  directional: no difference between approach and recess explains both directions; with "
        "all friction in recess backward is {}\n",
        in_percent(g.recess_only_backward));
  }
  return fmt::format(
      "  directional: both directions are explained by mu = {:.3f} with {:.3f} times as much "
      "friction in approach as in recess\n",
      g.directional->mu, g.directional->approach_factor / g.directional->recess_factor);
}

// --- the thesis

constexpr const char* kThesis = "directional-impedance thesis";

/// A constant of a pair-loss model: its key in the JSON, its name in the CSV.
struct ModelNumber {
  const char* key;
  const char* name;
  double PairLossModel::*number;
};
constexpr std::array<ModelNumber, 5> kModelNumbers{
    {{"mu", "mu", &PairLossModel::friction},
     {"symmetric_scale", "symmetric scale", &PairLossModel::symmetric_scale},
     {"offset", "offset", &PairLossModel::offset},
     {"skew_factor", "skew factor", &PairLossModel::skew_factor},
     {"rms_error", "rms error", &PairLossModel::rms_error}}};

std::string map_excerpt(const LossMap& map, const char* title, double LossMap::Point::*part,
                        int decimals) {
  const auto shown_teeth = {20, 40, 80, 120};
  std::vector<std::string> header{"driving \\ driven"};
  header.reserve(shown_teeth.size() + 1);
  for (const int z : shown_teeth) header.push_back(fmt::format("{}", z));
  TextTable table(std::move(header));
  for (const int driving : shown_teeth) {
    std::vector<std::string> row{fmt::format("{}", driving)};
    for (const LossMap::Point& p : map.points) {
      if (p.driving_teeth != driving ||
          std::ranges::find(shown_teeth, p.driven_teeth) == shown_teeth.end()) {
        continue;
      }
      row.push_back(fixed(100.0 * p.*part, decimals));
    }
    table.add(std::move(row));
  }
  return fmt::format("  {}\n{}", title, table.text(4));
}

std::string thesis_table(const ThesisComparison& t, const DirectionalBench& bench) {
  std::string text = fmt::format("\n{}: single-tooth loss model, full teeth, mu = {:g}\n", kThesis,
                                 t.map.friction);
  text += map_excerpt(t.map, "Mean torque loss in % (excerpt; all of it with --format json or csv)",
                      &LossMap::Point::loss, 3);
  text += map_excerpt(t.map, "Its symmetric part in %", &LossMap::Point::symmetric, 3);
  text += map_excerpt(t.map, "Its skew part in %", &LossMap::Point::skew, 5);
  text += fmt::format("  Models of its Table 3.1, {} rows\n", t.rows.size());
  TextTable models({"model", "mu", "symmetric scale", "offset", "skew factor", "rms error"});
  for (const PairLossModel& m : t.models) {
    models.add({m.description, fixed(m.friction, 3), fixed(m.symmetric_scale, 3),
                fixed(m.offset, 3), fixed(m.skew_factor, 0), fixed(m.rms_error, 4)});
  }
  text += models.text(4);
  text += directional_bench_table(bench);
  text += "\nLedger of errata: directional-impedance thesis\n";
  return text + ledger_text(t.ledger, "thesis");
}

io::Json thesis_json(const ThesisComparison& t, const DirectionalBench& bench) {
  const std::size_t n = t.map.teeth.size();
  const auto matrix = [&](auto part) {
    io::Json rows = io::Json::array();
    for (std::size_t i = 0; i < n; ++i) {
      io::Json row = io::Json::array();
      for (std::size_t j = 0; j < n; ++j) row.push_back(t.map.points[i * n + j].*part);
      rows.push_back(std::move(row));
    }
    return rows;
  };
  io::Json models = io::Json::array();
  for (const PairLossModel& m : t.models) {
    io::Json model{{"name", m.name}, {"description", m.description}};
    for (const auto& [key, name, number] : kModelNumbers) model[key] = m.*number;
    models.push_back(std::move(model));
  }
  io::Json rows = io::Json::array();
  for (const PairLossRow& row : t.rows) {
    io::Json predicted;
    io::Json residual;
    for (std::size_t k = 0; k < t.models.size(); ++k) {
      predicted[t.models[k].name] = row.predicted[k];
      residual[t.models[k].name] = row.measured.loss - row.predicted[k];
    }
    rows.push_back({{"driving_teeth", row.measured.driving_teeth},
                    {"driven_teeth", row.measured.driven_teeth},
                    {"measured", row.measured.loss},
                    {"predicted", std::move(predicted)},
                    {"residual", std::move(residual)}});
  }
  return {{"loss_map",
           {{"mu", t.map.friction},
            {"teeth", t.map.teeth},
            {"loss", matrix(&LossMap::Point::loss)},
            {"symmetric", matrix(&LossMap::Point::symmetric)},
            {"skew", matrix(&LossMap::Point::skew)},
            {"on_involutes", matrix(&LossMap::Point::on_involutes)}}},
          {"models", std::move(models)},
          {"rows", std::move(rows)},
          {"bench", directional_bench_json(bench)},
          {"ledger", ledger_json(t.ledger)}};
}

std::string thesis_csv(const ThesisComparison& t, const DirectionalBench& bench) {
  std::string text;
  for (const LossMap::Point& p : t.map.points) {
    const auto line = [&](const char* part, double value) {
      text += reproduce_line({kThesis,
                              fmt::format("{}, {} driving {}, mu = {:g}", part, p.driving_teeth,
                                          p.driven_teeth, t.map.friction),
                              "", "", exact(value), "", ""});
    };
    line("loss", p.loss);
    line("symmetric loss", p.symmetric);
    line("skew loss", p.skew);
  }
  for (const PairLossModel& m : t.models) {
    for (const auto& [key, name, number] : kModelNumbers) {
      text += reproduce_line(
          {kThesis, fmt::format("{}: {}", m.name, name), "", "", exact(m.*number), "", ""});
    }
  }
  for (const PairLossRow& row : t.rows) {
    for (std::size_t k = 0; k < t.models.size(); ++k) {
      const std::string pair = fmt::format("{} driving {}, {}", row.measured.driving_teeth,
                                           row.measured.driven_teeth, t.models[k].name);
      text += reproduce_line({kThesis, "loss of " + pair, "", "", exact(row.predicted[k]), "",
                              exact(row.measured.loss)});
      text += reproduce_line({kThesis, "residual (measured - model) of " + pair, "", "", "",
                              exact(row.measured.loss - row.predicted[k]), ""});
    }
  }
  text += directional_bench_csv(bench, kThesis);
  return text + ledger_csv(t.ledger, "thesis ledger");
}

}  // namespace

std::string reproduce_table(const Reproduction& r) {
  std::string text;
  for (const GearboxComparison& g : r.gearboxes) {
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", g.name);
    TextTable table(
        {"quantity", "paper", "its equations", "exact", "measured", "unit", "printed in"});
    for (const std::size_t column : {5U, 6U}) table.align_left(column);
    for (const ComparedRow& row : g.rows) {
      table.add({row.quantity, shown(row.paper, row.decimals), shown(row.equations, row.decimals),
                 shown(row.exact, row.decimals), shown(row.measured, row.decimals), row.unit,
                 row.source});
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
    if (!g.fits.empty()) text += directional_text(g);
  }
  text += "\nLedger of errata: low-backlash 3K gearbox paper\n";
  text += ledger_text(r.ledger, "paper");
  text += thesis_table(r.thesis, r.directional_bench);
  return text + backdrivability_table(r.backdrivability);
}

io::Json reproduce_json(const Reproduction& r) {
  io::Json gearboxes = io::Json::array();
  for (const GearboxComparison& g : r.gearboxes) {
    io::Json rows =
        list_json(g.rows, [&](const ComparedRow& row) { return row_fields(g.name, row).json(); });
    io::Json efficiency = io::Json::array();
    for (const EfficiencyPoint& p : g.efficiency) {
      efficiency.push_back(
          {{"mu", p.mu},
           {"ohlendorf", {{"forward", p.ohlendorf_forward}, {"backward", p.ohlendorf_backward}}},
           {"sliding", {{"forward", p.sliding_forward}, {"backward", p.sliding_backward}}}});
    }
    io::Json fits = io::Json::array();
    for (const FrictionFit& f : g.fits) {
      fits.push_back({{"loss_model", f.model},
                      {"mu_forward", f.mu},
                      {"backward_predicted", f.backward},
                      {"backward_measured", f.measured_backward},
                      {"mu_backward", f.backward_mu}});
    }
    io::Json directional = nullptr;
    if (g.directional) {
      directional = {{"mu", g.directional->mu},
                     {"approach_factor", g.directional->approach_factor},
                     {"recess_factor", g.directional->recess_factor}};
    }
    gearboxes.push_back({{"name", g.name},
                         {"rows", std::move(rows)},
                         {"efficiency", std::move(efficiency)},
                         {"friction_fits", std::move(fits)},
                         {"directional_fit", std::move(directional)},
                         {"recess_only_backward", g.recess_only_backward}});
  }
  io::Json json{{"tool", tool_json()},
                {"gearboxes", std::move(gearboxes)},
                {"ledger", ledger_json(r.ledger)},
                {"directional_impedance_thesis", thesis_json(r.thesis, r.directional_bench)},
                {"backdrivability_paper", backdrivability_json(r.backdrivability)}};
  return json;
}

std::string reproduce_csv(const Reproduction& r) {
  std::string text = row_fields("", {}).csv_header();
  const auto field = [](const std::optional<double>& v) { return v ? exact(*v) : std::string(); };
  for (const GearboxComparison& g : r.gearboxes) {
    for (const ComparedRow& row : g.rows) {
      text += row_fields(g.name, row).csv_values();
    }
    for (const EfficiencyPoint& p : g.efficiency) {
      const auto line = [&](const char* what, double ohlendorf, double sliding) {
        text += reproduce_line({g.name,
                                fmt::format("{} at mu = {:g} (ohlendorf | sliding)", what, p.mu),
                                "", "", exact(ohlendorf), exact(sliding), ""});
      };
      line("eta_f", p.ohlendorf_forward, p.sliding_forward);
      line("eta_b", p.ohlendorf_backward, p.sliding_backward);
    }
    for (const FrictionFit& f : g.fits) {
      text += reproduce_line(
          {g.name, "mu from measured forward, " + f.model, "", "", field(f.mu), "", ""});
      text += reproduce_line({g.name, "eta_b with that mu, " + f.model, "", "", field(f.backward),
                              "", exact(f.measured_backward)});
      text += reproduce_line(
          {g.name, "mu from measured backward, " + f.model, "", "", field(f.backward_mu), "", ""});
    }
  }
  for (const GearboxComparison& g : r.gearboxes) {
    if (!g.directional) continue;
    const auto line = [&](const char* what, double value) {
      text += reproduce_line(
          {g.name, fmt::format("{}, directional", what), "", "", exact(value), "", ""});
    };
    line("mu from both directions", g.directional->mu);
    line("approach factor", g.directional->approach_factor);
    line("recess factor", g.directional->recess_factor);
  }
  text += ledger_csv(r.ledger, "ledger");
  return text + thesis_csv(r.thesis, r.directional_bench) + backdrivability_csv(r.backdrivability);
}

}  // namespace gear3k::papers
