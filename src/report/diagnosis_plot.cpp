#include "report/diagnosis_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "calibrate/measurement/value_range.hpp"
#include "report/condition_columns.hpp"
#include "report/diagnosis_report.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using calibrate::Condition, calibrate::Diagnosis, calibrate::Kind, calibrate::MeasurementSet,
    calibrate::ValueRange;

std::string number(double value) { return exact(clean(value)); }

/// Rows that look alike: direction and sense of rotation of transmissions.
struct Series {
  const char* title;
  const char* style;  ///< point type and colour
  bool (*holds)(const Condition& c);
};

bool forward(const Condition& c) { return c.direction == design::Direction::kForward; }

constexpr std::array<Series, 4> kTransmissionSeries{
    {{.title = "forward, rotation +1",
      .style = "pt 7 lc rgb '#1f5fa8'",
      .holds = [](const Condition& c) { return forward(c) && c.rotation > 0; }},
     {.title = "backward, rotation +1",
      .style = "pt 7 lc rgb '#c0392b'",
      .holds = [](const Condition& c) { return !forward(c) && c.rotation > 0; }},
     {.title = "forward, rotation -1",
      .style = "pt 6 lc rgb '#1f5fa8'",
      .holds = [](const Condition& c) { return forward(c) && c.rotation <= 0; }},
     {.title = "backward, rotation -1",
      .style = "pt 6 lc rgb '#c0392b'",
      .holds = [](const Condition& c) { return !forward(c) && c.rotation <= 0; }}}};
constexpr std::array<Series, 1> kOneSeries{{{.title = "",
                                             .style = "pt 7 lc rgb '#1f5fa8'",
                                             .holds = [](const Condition&) { return true; }}}};

std::span<const Series> series_of(Kind kind) {
  if (kind == Kind::kTransmission) return kTransmissionSeries;
  return kOneSeries;
}

std::size_t stride_of(const MeasurementSet& set) {
  return (set.rows.size() + kMostPlottedRows - 1) / kMostPlottedRows;
}

std::string thinned_text(const MeasurementSet& set) {
  const std::size_t stride = stride_of(set);
  return stride > 1 ? fmt::format(", 1 of {} rows shown", stride) : "";
}

std::string axis_title(std::string_view title, std::string_view unit) {
  return unit.empty() ? std::string(title) : fmt::format("{} ({})", title, unit);
}

/// Points of each series as data blocks, and what plots them.
struct Layers {
  std::string data;
  std::vector<std::string> plots;
};

/// @param name  of the data blocks
/// @param x, y  of each row; rows without either are left out
Layers point_layers(const MeasurementSet& set, const std::string& name,
                    const std::vector<double>& x, const std::vector<double>& y) {
  Layers layers;
  const std::size_t stride = stride_of(set);
  int count = 0;
  for (const Series& series : series_of(set.kind)) {
    std::string points;
    for (std::size_t k = 0; k < set.rows.size(); k += stride) {
      if (!series.holds(set.rows[k].condition)) continue;
      if (!std::isfinite(x[k]) || !std::isfinite(y[k])) continue;
      points += fmt::format("{} {}\n", number(x[k]), number(y[k]));
    }
    if (points.empty()) continue;
    const std::string block = fmt::format("${}{}", name, ++count);
    layers.data += fmt::format("{} << EOD\n{}EOD\n", block, points);
    layers.plots.push_back(fmt::format(
        "{} using 1:2 with points ps 0.55 {} {}", block, series.style,
        *series.title != '\0' ? "title " + plot_text(series.title) : std::string("notitle")));
  }
  return layers;
}

std::string plot_line(const std::vector<std::string>& layers) {
  return fmt::format("plot {}\n", layers.empty()
                                      ? "NaN notitle"
                                      : fmt::format("{}", fmt::join(layers, ", \\\n  ")));
}

struct Values {
  std::vector<double> measured, baseline, extended;  ///< in the unit of the response
};
Values values_of(const Diagnosis& d, const MeasurementSet& set) {
  const double si = response_text(set.kind).si;
  Values v;
  for (std::vector<double>* list : {&v.measured, &v.baseline, &v.extended}) {
    list->reserve(set.rows.size());
  }
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    v.measured.push_back(set.rows[k].response / si);
    v.baseline.push_back(d.rows[k].baseline / si);
    v.extended.push_back(d.rows[k].extended / si);
  }
  return v;
}

std::string rms_text(double value_si, const ResponseText& response) {
  return fmt::format("{:.3g}{}{}", clean(value_si / response.si), response.unit.empty() ? "" : " ",
                     response.unit);
}

std::string subject_title(const Diagnosis& d) { return d.subject.empty() ? "" : d.subject + ": "; }

// --- measured against simulated

std::string comparison_script(const Diagnosis& d, const MeasurementSet& set) {
  const ResponseText response = response_text(set.kind);
  const Values v = values_of(d, set);
  std::vector<double> all = v.measured;
  all.insert(all.end(), v.baseline.begin(), v.baseline.end());
  all.insert(all.end(), v.extended.begin(), v.extended.end());
  std::string text = plot_prologue(1000, 560);
  text += panels_beside(
      fmt::format("{}measured against simulated{}", subject_title(d), thinned_text(set)));
  text += fmt::format("set xlabel {}\nset ylabel {}\n{}{}",
                      plot_text("simulated " + axis_title(response.title, response.unit)),
                      plot_text("measured " + axis_title(response.title, response.unit)),
                      plot_range("x", all), plot_range("y", all));
  const auto panel = [&](const char* name, const std::string& title, const std::vector<double>& x) {
    Layers layers = point_layers(set, name, x, v.measured);
    std::vector<std::string> plots{"x with lines lc rgb '#808080' notitle"};
    plots.insert(plots.end(), layers.plots.begin(), layers.plots.end());
    text += fmt::format("set title {}\n{}{}", plot_text(title), layers.data, plot_line(plots));
  };
  panel("before",
        fmt::format("as given: {} off (noise {})", rms_text(d.errors.baseline_train, response),
                    std::isfinite(d.errors.noise_floor) ? rms_text(d.errors.noise_floor, response)
                                                        : std::string("not known")),
        v.baseline);
  text += "unset key\n";
  panel("after",
        d.effects.empty()
            ? std::string("no cause added")
            : fmt::format("with the causes: {} off", rms_text(d.errors.extended_train, response)),
        v.extended);
  return text + "unset multiplot\n";
}

// --- residuals

/// What a cause acts along, by the covariates of column_of().
std::string guilty_covariate(const std::string& id, const MeasurementSet& set) {
  using Pair = std::pair<std::string_view, const char*>;
  constexpr std::array<Pair, 9> kCovariates{{{"friction_speed", "speed"},
                                             {"drag_viscous", "speed"},
                                             {"drag_quadratic", "speed"},
                                             {"friction_temperature", "temperature"},
                                             {"thermal_expansion", "temperature"},
                                             {"runout", "angle"},
                                             {"mesh_order", "angle"},
                                             {"drift", "time"},
                                             {"run_step", "run"}}};
  const auto* const at = std::ranges::find(kCovariates, id, &Pair::first);
  if (at == kCovariates.end()) return "load";
  std::string covariate(at->second);
  const auto states = [&](const char* name) {
    const auto column = column_of(name, set.kind);
    return column && std::ranges::any_of(set.rows, [&](const auto& row) {
             return std::isfinite(column->value(row.condition));
           });
  };
  if (covariate == "run" && !states("run")) return "time";
  return covariate;
}

/// The axis along which residuals are shown.
struct Abscissa {
  std::string title;
  std::vector<double> value;  ///< of each row
  std::string ticks;          ///< settings
};

Abscissa abscissa_of(const Diagnosis& d, const MeasurementSet& set) {
  std::string covariate = "load";
  double order = 0.0;
  std::string body;
  if (!d.effects.empty()) {
    const calibrate::Effect& guilty = d.effects.front();
    covariate = guilty_covariate(guilty.id, set);
    if (guilty.id == "drift" && guilty.form.name.ends_with("cycles")) covariate = "cycles";
    order = guilty.form.order;
    body = place_text(guilty.form);
  } else if (d.remainder.significant && !d.remainder.along.empty()) {
    covariate = d.remainder.along;
    if (covariate == "angle") order = d.remainder.order;
  }
  Abscissa result;
  result.value.assign(set.rows.size(), calibrate::kUnknown);
  const auto extra = std::ranges::find(set.covariates, covariate, &calibrate::Covariate::name);
  auto column = column_of(covariate, set.kind);
  if (!column && extra != set.covariates.end() && extra->value.size() == set.rows.size()) {
    result.title = covariate;
    result.value = extra->value;
    return result;
  }
  // Pairs have no load: their drivers stand for it.
  if (!column) column = column_of("pinion", set.kind);
  if (!column) column = column_of("load", set.kind);
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    result.value[k] = column->value(set.rows[k].condition);
  }
  result.title = axis_title(column->title, column->unit);
  constexpr double kTurn = 360.0;
  if (column->name == "output_angle_deg" && order > 0.0) {
    for (double& value : result.value) {
      value = order * value - kTurn * std::floor(order * value / kTurn);
    }
    result.title = fmt::format("angle{} (deg), {:.4g} periods per output turn",
                               body.empty() ? "" : " of " + body, order);
    result.ticks = "set xtics 0,60,360\n";
  }
  if (column->name == "run") {
    constexpr std::size_t kMostLabels = 20;
    std::vector<std::string> labels;
    labels.reserve(set.runs.size());
    for (std::size_t k = 0; k < set.runs.size(); ++k) {
      labels.push_back(fmt::format("{} {}", plot_text(set.runs[k]), k));
    }
    if (labels.size() <= kMostLabels) {
      result.ticks = fmt::format("set xtics ({})\n", fmt::join(labels, ", "));
    }
  }
  if (column->name == "direction") result.ticks = "set xtics ('forward' 0, 'backward' 1)\n";
  return result;
}

/// Means of the residual over classes of the abscissa: its values while they are few, else equal
/// parts of the range.
std::string mean_data(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr std::size_t kMostClasses = 24;
  std::vector<std::pair<double, double>> points;
  points.reserve(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (std::isfinite(x[k]) && std::isfinite(y[k])) points.emplace_back(x[k], y[k]);
  }
  if (points.empty()) return "";
  std::ranges::sort(points);
  std::size_t distinct = 1;
  for (std::size_t k = 1; k < points.size(); ++k) {
    distinct += points[k].first > points[k - 1].first ? 1U : 0U;
  }
  const double low = points.front().first;
  const double span = points.back().first - low;
  const auto class_of = [&](double at) {
    constexpr double kClasses = 12.0;
    return distinct <= kMostClasses
               ? at
               : std::min(kClasses - 1.0, std::floor((at - low) / span * kClasses));
  };
  std::string text;
  for (std::size_t k = 0; k < points.size();) {
    double sum_x = 0.0;
    double sum_y = 0.0;
    std::size_t end = k;
    while (end < points.size() && class_of(points[end].first) == class_of(points[k].first)) {
      sum_x += points[end].first;
      sum_y += points[end].second;
      ++end;
    }
    const auto count = static_cast<double>(end - k);
    text += fmt::format("{} {}\n", number(sum_x / count), number(sum_y / count));
    k = end;
  }
  return text;
}

std::string residual_script(const Diagnosis& d, const MeasurementSet& set) {
  const ResponseText response = response_text(set.kind);
  const Values v = values_of(d, set);
  const Abscissa abscissa = abscissa_of(d, set);
  std::vector<double> before(v.measured.size());
  std::vector<double> after(v.measured.size());
  for (std::size_t k = 0; k < before.size(); ++k) {
    before[k] = v.measured[k] - v.baseline[k];
    after[k] = v.measured[k] - v.extended[k];
  }
  std::vector<double> all = before;
  all.insert(all.end(), after.begin(), after.end());
  all.push_back(0.0);
  std::string text = plot_prologue(900, 720);
  text +=
      panels_below(fmt::format("{}measured less simulated{}", subject_title(d), thinned_text(set)));
  text += fmt::format(
      "set xlabel {}\nset ylabel {}\n{}{}{}", plot_text(abscissa.title),
      plot_text(axis_title(fmt::format("residual of {}", response.title), response.unit)),
      plot_range("x", abscissa.value), plot_range("y", all), abscissa.ticks);
  const double noise = d.errors.noise_floor / response.si;
  const auto panel = [&](const char* name, const char* label, const std::vector<double>& y) {
    std::vector<std::string> plots{"0 with lines lc rgb '#404040' notitle"};
    if (noise > 0.0) {
      plots.push_back(
          fmt::format("{} with lines dt 2 lc rgb '#808080' title 'noise ±1 sd'", number(noise)));
      plots.push_back(fmt::format("{} with lines dt 2 lc rgb '#808080' notitle", number(-noise)));
    }
    Layers layers = point_layers(set, name, abscissa.value, y);
    plots.insert(plots.end(), layers.plots.begin(), layers.plots.end());
    // Of transmissions each direction has its own mean: a drag acts on them in opposite senses.
    const bool directed = set.kind == Kind::kTransmission;
    for (const bool driven : {false, true}) {
      if (driven && !directed) continue;
      std::vector<double> own = y;
      for (std::size_t k = 0; directed && k < own.size(); ++k) {
        if (forward(set.rows[k].condition) == driven) own[k] = calibrate::kUnknown;
      }
      const std::string means = mean_data(abscissa.value, own);
      if (means.empty()) continue;
      const std::string block = fmt::format("$mean_{}_{}", name, driven ? "driven" : "driving");
      const char* title = !directed ? "mean" : driven ? "mean backward" : "mean forward";
      const char* color = !directed ? "#202020" : driven ? "#7b241c" : "#123c69";
      layers.data += fmt::format("{} << EOD\n{}EOD\n", block, means);
      plots.push_back(
          fmt::format("{} using 1:2 with linespoints lw 2 pt 5 ps 0.6 lc rgb '{}' title '{}'",
                      block, color, title));
    }
    text += fmt::format("set label 1 {} at graph 0.02,0.94 left front\n{}{}", plot_text(label),
                        layers.data, plot_line(plots));
  };
  panel("before", "as given", before);
  text += "unset key\n";
  panel("after", d.effects.empty() ? "no cause added" : "with the causes", after);
  return text + "unset multiplot\n";
}

// --- evidence

std::string evidence_script(const Diagnosis& d) {
  std::vector<calibrate::CauseEvidence> bars;
  bars.reserve(d.evidence.size());
  for (const auto& candidate : d.evidence) {
    if (std::isfinite(candidate.delta_bic)) bars.push_back(candidate);
  }
  std::ranges::stable_sort(bars, std::ranges::greater{}, &calibrate::CauseEvidence::delta_bic);
  const auto is_effect = [&](const std::string& id) {
    return std::ranges::find(d.effects, id, &calibrate::Effect::id) != d.effects.end();
  };
  const auto is_alternative = [&](const std::string& id) {
    return std::ranges::any_of(d.effects, [&](const auto& effect) {
      return std::ranges::find(effect.alternatives, id, &calibrate::Alternative::id) !=
             effect.alternatives.end();
    });
  };
  std::string text = plot_prologue(900, 140 + 30 * std::max(3, static_cast<int>(bars.size())));
  text += fmt::format("set title {}\n",
                      plot_text(subject_title(d) + "evidence of each candidate by itself"));
  if (bars.empty()) {
    return text +
           "unset border\nunset tics\nset label 1 'these data could show no cause' at graph "
           "0.5,0.5 center\nset xrange [0:1]\nset yrange [0:1]\nplot NaN notitle\n";
  }
  struct Class {
    const char* block;
    const char* title;
    const char* color;
    std::string data;
  };
  std::array<Class, 3> classes{
      {{.block = "$named", .title = "named", .color = "#c0392b", .data = {}},
       {.block = "$alternatives",
        .title = "explains as well in its place",
        .color = "#e59866",
        .data = {}},
       {.block = "$others", .title = "other", .color = "#aab7c4", .data = {}}}};
  std::vector<std::string> ticks;
  ticks.reserve(bars.size());
  std::string labels_left, labels_right;  // of bars to the left, to the right
  double least = 0.0;
  double greatest = 0.0;
  for (std::size_t k = 0; k < bars.size(); ++k) {
    const auto& [id, delta_bic, evidence] = bars[k];
    Class& chosen = classes.at(is_effect(id) ? 0 : is_alternative(id) ? 1 : 2);
    chosen.data +=
        fmt::format("{} {} {} {} {} {}\n", number(0.5 * delta_bic), k,
                    number(std::min(0.0, delta_bic)), number(std::max(0.0, delta_bic)),
                    exact(static_cast<double>(k) - 0.38), exact(static_cast<double>(k) + 0.38));
    (delta_bic < 0.0 ? labels_left : labels_right) +=
        fmt::format("{} {} \"{}\"\n", number(delta_bic), k, fixed(delta_bic, 1));
    ticks.push_back(fmt::format("{} {}", plot_text(id), k));
    least = std::min(least, delta_bic);
    greatest = std::max(greatest, delta_bic);
  }
  const double span = std::max(greatest - least, 1.0);
  text += fmt::format(
      "set xlabel 'delta BIC against the simulation as given (> 0 speaks for the cause, > 10 "
      "strongly)'\n"
      "set lmargin 24\nset grid x lc rgb '#e0e0e0'\nset key bottom right\nset format x '%g'\n"
      "set yrange [{}:-0.7]\nset xrange [{}:{}]\nset ytics ({})\nset style fill solid 1.0 "
      "noborder\n"
      "set arrow 1 from 0,graph 0 to 0,graph 1 nohead lc rgb '#404040'\n",
      exact(static_cast<double>(bars.size()) - 0.3),
      number(least - (least < 0.0 ? 0.12 : 0.02) * span), number(greatest + 0.12 * span),
      fmt::join(ticks, ", "));
  std::vector<std::string> plots;
  for (const Class& c : classes) {
    if (c.data.empty()) continue;
    text += fmt::format("{} << EOD\n{}EOD\n", c.block, c.data);
    plots.push_back(
        fmt::format("{} using 1:2:3:4:5:6 with boxxyerror fillcolor rgb '{}' title '{}'", c.block,
                    c.color, c.title));
  }
  const auto add_labels = [&](const char* block, const std::string& labels, const char* place) {
    if (labels.empty()) return;
    text += fmt::format("{} << EOD\n{}EOD\n", block, labels);
    plots.push_back(
        fmt::format("{} using 1:2:({}) with labels {} font ',11' notitle", block,
                    place == std::string_view("left") ? "' '.strcol(3)" : "strcol(3).' '", place));
  };
  // Text beside the end of its bar: "left" is how it is aligned, right of the end.
  add_labels("$labels_right", labels_right, "left");
  add_labels("$labels_left", labels_left, "right");
  return text + plot_line(plots);
}

// --- periodogram

/// Orders in equal classes where there are many, each with its greatest power at its own order.
std::string periodogram_data(const calibrate::Periodogram& p) {
  const std::size_t count = p.order.size();
  const std::size_t classes = std::min(count, kMostPlottedOrders);
  std::string text;
  for (std::size_t c = 0; c < classes; ++c) {
    const auto first = static_cast<std::ptrdiff_t>(c * count / classes);
    const auto last = static_cast<std::ptrdiff_t>((c + 1) * count / classes);
    const auto top = std::max_element(p.power.begin() + first, p.power.begin() + last);
    const auto at = static_cast<std::size_t>(top - p.power.begin());
    text += fmt::format("{} {}\n", number(p.order[at]), number(p.power[at]));
  }
  return text;
}

bool more_than_a_turn(const MeasurementSet& set) {
  const ValueRange angle = calibrate::range_of(set, &Condition::output_angle_rad);
  return angle.high - angle.low > 2.0 * std::numbers::pi;
}

std::string periodogram_script(const Diagnosis& d, const std::vector<train::ShaftOrder>& orders) {
  const calibrate::Periodogram& p = d.periodogram;
  const double greatest = *std::ranges::max_element(p.power);
  const double top = greatest > 0.0 ? 1.35 * greatest : 1.0;
  const double last = p.order.back();
  std::string text = plot_prologue(1000, 480);
  text += fmt::format(
      "set title {}\nset grid lc rgb '#e0e0e0'\nset format '%g'\nunset key\n"
      "set xlabel 'order (periods per turn of the output)'\n"
      "set ylabel 'share of the variance that is left'\n"
      "set xrange [0:{}]\nset yrange [0:{}]\n",
      plot_text(subject_title(d) + "periodogram of what the causes leave, over the output angle"),
      number(1.02 * last), number(top));
  int mark = 0;
  for (const train::ShaftOrder& shaft : orders) {
    if (!(shaft.order > 0.0 && shaft.order <= last)) continue;
    ++mark;
    text += fmt::format(
        "set arrow {0} from {1},0 to {1},graph 0.8 nohead dt 2 lc rgb '#e59866' back\n"
        "set label {0} {2} at {1},graph 0.81 rotate left font ',10' front\n",
        mark, number(shaft.order),
        plot_text(
            fmt::format("{} {:.4g}", shaft.body == "output" ? "R2" : shaft.body, shaft.order)));
  }
  return text + fmt::format("$power << EOD\n{}EOD\n", periodogram_data(p)) +
         plot_line({"$power using 1:2 with impulses lc rgb '#1f5fa8' notitle"});
}

constexpr std::array<const char*, 4> kPlotNames{"measured_vs_simulated", "residuals", "evidence",
                                                "periodogram"};

std::string kind_suffix(Kind kind) {
  return fmt::format("_{}", calibrate::kKindNames[static_cast<std::size_t>(kind)]);
}

}  // namespace

std::vector<Plot> diagnosis_plots(const std::vector<Diagnosis>& diagnoses,
                                  const std::vector<MeasurementSet>& sets,
                                  const std::vector<train::ShaftOrder>& orders) {
  require_matching(diagnoses, sets);
  std::vector<Plot> plots;
  plots.reserve(kPlotNames.size() * sets.size());
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const Diagnosis& d = diagnoses[k];
    const std::string suffix = sets.size() == 1 ? "" : kind_suffix(d.kind);
    const auto add = [&](std::size_t name, std::string script) {
      plots.push_back({.name = kPlotNames.at(name) + suffix, .script = std::move(script)});
    };
    add(0, comparison_script(d, sets[k]));
    add(1, residual_script(d, sets[k]));
    add(2, evidence_script(d));
    if (!d.periodogram.order.empty() && more_than_a_turn(sets[k])) {
      add(3, periodogram_script(d, orders));
    }
  }
  return plots;
}

std::vector<std::string> diagnosis_plot_names() {
  std::vector<std::string> names;
  names.reserve(kPlotNames.size() * (1 + calibrate::kKindNames.size()));
  for (const char* name : kPlotNames) {
    names.emplace_back(name);
    for (const std::string_view kind : calibrate::kKindNames) {
      names.push_back(fmt::format("{}_{}", name, kind));
    }
  }
  return names;
}

}  // namespace gear3k::report
