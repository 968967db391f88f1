#include "report/series_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "calibrate/series/series.hpp"
#include "io/text/printable.hpp"
#include "report/diagnosis_report.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using calibrate::Origin, calibrate::RandomEffects, calibrate::UnitSeries, calibrate::SeriesCause,
    calibrate::SeriesMember, calibrate::SeriesParameter;

std::string origin_name(Origin of) {
  return std::string(calibrate::kOriginNames[static_cast<std::size_t>(of)]);
}

io::Json finite_or_null(double value) {
  return std::isfinite(value) ? io::Json(value) : io::Json(nullptr);
}

io::Json series_parameter_json(const SeriesParameter& p, const UnitSeries& series) {
  const RandomEffects& r = p.effects;
  io::Json units = io::Json::array();
  for (std::size_t u = 0; u < p.units.size(); ++u) {
    units.push_back(io::Json{{"name", series.units[u].name},
                             {"value", p.units[u].value},
                             {"sd", finite_or_null(p.units[u].sd)},
                             {"at_bound", static_cast<bool>(p.at_bound[u])}});
  }
  io::Json json{{"name", p.name}, {"unit", p.unit}};
  json["of"] = p.of ? io::Json(origin_name(*p.of)) : io::Json(nullptr);
  json["mean"] = r.mean;
  json["mean_ci95"] = {r.mean_low, r.mean_high};
  json["part_to_part_sd"] = r.deviation;
  json["part_to_part_sd_ci95"] = {r.deviation_low, r.deviation_high};
  json["p_mean"] = r.p_mean;
  json["p_part_to_part"] = r.p_between;
  json["p_mean_adjusted"] = p.p_mean_adjusted;
  json["p_part_to_part_adjusted"] = p.p_between_adjusted;
  json["units"] = std::move(units);
  return json;
}

io::Json cause_json(const SeriesCause& cause, const UnitSeries& series) {
  io::Json json{{"id", cause.id}};
  if (!cause.form.body.empty()) json["body"] = cause.form.body;
  if (cause.form.order > 0.0) json["order"] = cause.form.order;
  json["of"] = origin_name(cause.of);
  json["title"] = cause.title;
  json["form"] = cause.form.name;
  json["alternatives"] = cause.alternatives;
  json["parameters"] = list_json(
      cause.parameters, [&](const SeriesParameter& p) { return series_parameter_json(p, series); });
  return json;
}

io::Json member_json(const SeriesMember& m) {
  return {{"name", m.name},
          {"rows", m.rows},
          {"sessions", m.sessions},
          {"verdict", calibrate::kVerdictNames[static_cast<std::size_t>(m.verdict)]},
          {"unexplained",
           m.unexplained_along
               ? io::Json{{"along", m.unexplained_along->empty() ? io::Json(nullptr)
                                                                 : io::Json(*m.unexplained_along)},
                          {"p_value", m.p_value}}
               : io::Json(nullptr)}};
}

std::string spaced_name(std::string text) {
  std::ranges::replace(text, '_', ' ');
  return text;
}

std::string digits(double value) { return fmt::format("{:.3g}", clean(value)); }

std::string small_p(double p) {
  constexpr double kLeastShown = 1e-99;
  return p < kLeastShown ? "<1e-99" : fmt::format("{:.1g}", p);
}

std::string interval_text(double low, double high) {
  return fmt::format("{} to {}", digits(low), digits(high));
}

std::string whose(Origin of) {
  switch (of) {
    case Origin::kDesign:
      return "the design's: the same in all gearboxes";
    case Origin::kPart:
      return "the part's: differs from gearbox to gearbox";
    case Origin::kBoth:
      break;
  }
  return "the design's, and differs from gearbox to gearbox";
}

/// The values of each gearbox; the columns are the parameters of all causes.
std::string values_table(const UnitSeries& series) {
  std::vector<std::string> header{"gearbox", "rows", "verdict"};
  for (const SeriesCause& cause : series.causes) {
    for (const SeriesParameter& p : cause.parameters) {
      header.push_back(fmt::format("{} {}", cause.id, with_unit(spaced_name(p.name), p.unit)));
    }
  }
  TextTable table(header);
  table.align_left(2);
  for (std::size_t u = 0; u < series.units.size(); ++u) {
    const SeriesMember& m = series.units[u];
    std::vector<std::string> row{
        m.name, fmt::format("{}", m.rows),
        spaced_name(std::string(calibrate::kVerdictNames[static_cast<std::size_t>(m.verdict)]))};
    for (const SeriesCause& cause : series.causes) {
      for (const SeriesParameter& p : cause.parameters) {
        const auto& value = p.units[u];
        row.push_back(std::isfinite(value.sd)
                          ? fmt::format("{} ± {:.2g}", digits(value.value), value.sd)
                          : "not determined");
      }
    }
    table.add(row);
  }
  return table.text(2);
}

}  // namespace

io::Json unit_series_json(const calibrate::Diagnosis& d) {
  if (!d.series) return nullptr;
  const UnitSeries& series = *d.series;
  return {{"units", list_json(series.units, member_json)},
          {"session_sd_over_row_sd", series.session_ratio},
          {"causes", list_json(series.causes, [&](const SeriesCause& cause) {
             return cause_json(cause, series);
           })}};
}

std::string unit_series_text(const calibrate::Diagnosis& d) {
  if (!d.series) return "";
  const UnitSeries& series = *d.series;
  if (series.units.size() == 1) {
    return fmt::format("\nMeasured on one gearbox, {}: what is the part's cannot be told.\n",
                       io::printable(series.units.front().name));
  }
  std::string text = fmt::format("\nSeries of {} gearboxes", series.units.size());
  if (series.causes.empty()) {
    return text + ": they differ neither from the simulation nor from each other by a cause\n" +
           values_table(series);
  }
  text += " (95 % intervals in brackets)\n";
  TextTable table({"cause", "parameter", "of", "mean", "[95 %]", "part to part", "[95 %]", "p mean",
                   "p parts"});
  for (const std::size_t column : {1U, 2U}) table.align_left(column);
  for (const SeriesCause& cause : series.causes) {
    for (const SeriesParameter& p : cause.parameters) {
      const RandomEffects& r = p.effects;
      table.add({cause.id, with_unit(spaced_name(p.name), p.unit), p.of ? origin_name(*p.of) : "-",
                 digits(r.mean), interval_text(r.mean_low, r.mean_high), digits(r.deviation),
                 interval_text(r.deviation_low, r.deviation_high), small_p(p.p_mean_adjusted),
                 small_p(p.p_between_adjusted)});
    }
  }
  text += table.text(2);
  for (const SeriesCause& cause : series.causes) {
    text += fmt::format("  {}: {}.", cause.id, whose(cause.of));
    if (!cause.alternatives.empty()) {
      text += fmt::format(" Explained as well by {}.", fmt::join(cause.alternatives, ", "));
    }
    text += '\n';
  }
  text += values_table(series);
  text +=
      "  (± is a standard deviation.) The verdict and causes above are those of all rows less what "
      "is the parts' own.\n"
      "  A mean or a deviation counts where its p-value is at most a tenth of the rate of false "
      "discoveries.\n";
  std::vector<std::string> of_parts;
  for (const SeriesCause& cause : series.causes) {
    if (cause.of == calibrate::Origin::kPart) of_parts.push_back(cause.id);
  }
  text +=
      of_parts.empty()
          ? "  model.toml holds the means.\n"
          : fmt::format(
                "  model.toml holds the means of the design's causes only: {} {} from gearbox to "
                "gearbox, and no mean\n  of all is told from 0.\n",
                fmt::join(of_parts, ", "), of_parts.size() == 1 ? "differs" : "differ");
  return text;
}

std::string gearbox_of(const calibrate::MeasurementSet& set, const calibrate::Observation& row) {
  const auto file = static_cast<std::size_t>(row.file);
  return file < set.units.size() ? set.units[file] : "";
}

}  // namespace gear3k::report
