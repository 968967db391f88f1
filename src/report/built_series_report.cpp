#include "report/built_series_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "report/display.hpp"
#include "report/text_table.hpp"
#include "report/thermal_report.hpp"
#include "report/tolerance_report.hpp"

namespace gear3k::report {

namespace {

using backlash::Estimate, backlash::MonteCarloResult, backlash::Proportion, backlash::Quantile,
    backlash::ToleranceShare;
using design::BuiltSeries;

std::string share_text(double share) { return fmt::format("{:.2f} %", percent(share)); }

std::string proportion_text(const Proportion& p) {
  return fmt::format("{:8.3f} %   (95 %: {:.3f} to {:.3f})", percent(p.value), percent(p.lower),
                     percent(p.upper));
}

/// Sources by what halving them buys; where that is within its error for all, by their total share
/// of the variance.
std::vector<std::size_t> by_effect(const BuiltSeries& series) {
  std::vector<std::size_t> order(series.shares.sources.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const bool any_gain = std::ranges::any_of(series.shares.sources, [](const ToleranceShare& share) {
    return share.halved.yield_gain.value > 3.0 * share.halved.yield_gain.standard_error;
  });
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    const auto gain = [&](std::size_t i) {
      return series.shares.sources[i].halved.yield_gain.value;
    };
    if (any_gain && gain(a) != gain(b)) return gain(a) > gain(b);
    return series.shares.sources[a].total.value > series.shares.sources[b].total.value;
  });
  return order;
}

std::string estimate_text(const Estimate& e) {
  return fmt::format("{:+.2f} +- {:.2f}", percent(e.value), percent(e.standard_error));
}

std::string limit_text(const BuiltSeries& series) {
  return series.limit_rad ? fmt::format("{:g} arcmin", clean(arcmin(*series.limit_rad)))
                          : std::string("no limit");
}

/// How many assemble and keep the limit, and the lost motion of those that do.
std::string drawn_text(const BuiltSeries& series) {
  const MonteCarloResult& r = series.result;
  std::string text = fmt::format("  assemble               {}\n", proportion_text(r.assembled));
  if (series.limit_rad) {
    text += fmt::format("  and keep {:<13} {}\n", limit_text(series), proportion_text(r.yield));
  }
  text += fmt::format("  99 % of all keep       {}\n",
                      r.limit_of_99_percent_rad
                          ? fmt::format("{:.2f} arcmin", arcmin(*r.limit_of_99_percent_rad))
                          : std::string("no limit: more than 1 % do not assemble"));
  if (r.assembled.count == 0) return text;
  const auto& d = r.lost_motion;
  text += fmt::format("  lost motion            {:.2f} arcmin, standard deviation {:.2f}\n",
                      arcmin(d.mean_rad), arcmin(d.deviation_rad));
  std::string quantiles;
  for (const Quantile& q : d.quantiles) {
    quantiles += fmt::format("{}{:g} %: {:.2f}", quantiles.empty() ? "" : ", ",
                             clean(percent(q.probability)), arcmin(q.value));
  }
  return text + fmt::format("    at most, arcmin      {}\n", quantiles);
}

/// Planets that are alike, at the ends of the limits.
std::string worst_case_text(const backlash::WorstCase& w) {
  std::string text = fmt::format(
      "  planets alike          {:.2f} arcmin with all at the middle of their limits; +- {:.2f} by "
      "root sum square\n",
      arcmin(w.middle_rad), arcmin(w.root_sum_square_rad));
  if (w.greatest_margin_m >= 0.0) {
    text += fmt::format("  worst case             {:.2f} arcmin{}, least {:.2f}\n",
                        arcmin(w.greatest_rad), w.greatest_attained ? "" : " (a bound)",
                        arcmin(w.least_rad));
  }
  return text +
         (w.can_jam()
              ? fmt::format("  in the worst case it does not assemble, by {:.1f} um\n",
                            -um(w.least_margin_m))
              : fmt::format("  it always assembles, with {:.1f} um to spare in the worst case\n",
                            um(w.least_margin_m)));
}

std::string turn_text(const BuiltSeries& series) {
  if (!series.turn) return "";
  std::string text = fmt::format(
      "  at every position      of a turn, {} gearboxes: {:.1f} % assemble (95 %: {:.1f} to "
      "{:.1f})",
      series.turn->gearboxes, percent(series.turn->assembled.value),
      percent(series.turn->assembled.lower), percent(series.turn->assembled.upper));
  if (series.limit_rad) {
    text += fmt::format(", {:.1f} % also keep {} (95 %: {:.1f} to {:.1f})",
                        percent(series.turn->yield.value), limit_text(series),
                        percent(series.turn->yield.lower), percent(series.turn->yield.upper));
  }
  return text + '\n';
}

std::string thermal_end_text(const design::ThermalSeries& end) {
  const MonteCarloResult& at = end.result;
  return fmt::format(
      "  {:<22} at most {:.2f} % jam in some position of their teeth; lost motion {}\n",
      design::state_text(end.state), percent(end.jammed.value),
      at.assembled.count == 0 ? "none: no gearbox assembles"
      : at.limit_of_99_percent_rad
          ? fmt::format("{:.2f} arcmin, 99 % keep {:.2f}", arcmin(at.lost_motion.mean_rad),
                        arcmin(*at.limit_of_99_percent_rad))
          : fmt::format("{:.2f} arcmin", arcmin(at.lost_motion.mean_rad)));
}

std::string first_contact_text(const design::FirstContactRooms& rooms) {
  if (rooms.samples == 0 || rooms.median_m.size() < 2) return "";
  std::string later;
  for (std::size_t k = 1; k < rooms.median_m.size(); ++k) {
    later += fmt::format("{}{:.1f} um ({:.1f} um)", later.empty() ? "" : ", ",
                         um(rooms.median_m[k]), um(rooms.percent95_m[k]));
  }
  return fmt::format(
             "  at first contact       one planet carries {:.0f} % of the output torque on "
             "average{}\n",
             percent(rooms.greatest_share),
             rooms.greatest_share > 1.005
                 ? " (above 100: another one is wedged and works against it)"
                 : "") +
         fmt::format("    room left at the {}: {} in the median (95 % have at most)\n",
                     rooms.median_m.size() > 2 ? "planets that follow" : "planet that follows",
                     later);
}

std::string series_text(const BuiltSeries& series) {
  std::string text = fmt::format(
      "\nBuilt gearboxes at one position of the turn: {} drawn at random, seed {}, {} scatter{}\n",
      series.result.samples, series.seed,
      backlash::kScatterNames[static_cast<std::size_t>(series.scatter.scatter)],
      series.scatter.scatter == backlash::Scatter::kNormal
          ? fmt::format(" (limits at {:g} standard deviations)", series.scatter.sigma_level)
          : "");
  text += drawn_text(series) + worst_case_text(series.result.worst) + turn_text(series);
  for (const design::ThermalSeries& end : series.thermal) text += thermal_end_text(end);
  if (series.paper_limit) {
    text +=
        "  the limit of lost motion is one of the paper's model (backlash.model); built gearboxes "
        "follow the\n    kinematic one and are not judged by it\n";
  }
  return text + first_contact_text(series.rooms);
}

/// Whether tightening about the middles cannot help.
bool mostly_beyond(const BuiltSeries& series) {
  return series.limit_rad && series.result.beyond_limit.value > 0.5;
}

/// Whether each tolerance costs yield when it is halved, but for those that change nothing: the
/// middle is where no tolerance can mend it.
bool tightening_harms(const backlash::ToleranceShares& s) {
  const auto gain = [](const ToleranceShare& share) { return share.halved.yield_gain.value; };
  return std::ranges::any_of(s.sources, [&](const auto& share) { return gain(share) < 0.0; }) &&
         std::ranges::none_of(s.sources, [&](const auto& share) { return gain(share) > 0.0; });
}

std::string tighten_text(const BuiltSeries& series) {
  const backlash::ToleranceShares& s = series.shares;
  if (s.sources.empty()) return "";
  if (series.result.assembled.count == 0) return "\nNo gearbox of these tolerances assembles.\n";
  const bool limit = series.limit_rad.has_value();
  TextTable table({"tolerance", "limits um", limit ? "yield if halved %" : "assemble if halved %",
                   "gain %", "jam change %", "99 % keep arcmin", "of variance alone %",
                   "with others %", "planets alike arcmin"});
  for (const std::size_t i : by_effect(series)) {
    const ToleranceShare& share = s.sources[i];
    table.add({series.model.sources[i].name(),
               fmt::format("+-{:.2f}", um(series.model.sources[i].half_width_m)),
               fmt::format("{:.2f}", percent(share.halved.yield)),
               estimate_text(share.halved.yield_gain), estimate_text(share.halved.jam_change),
               fmt::format("{:.2f}", arcmin(share.halved.quantile_99_rad)),
               fixed(percent(share.first_order.value), 1), fixed(percent(share.total.value), 1),
               fmt::format("+-{:.2f}", arcmin(series.result.worst.share_rad[i]))});
  }
  return fmt::format(
             "\nWhich tolerance to tighten first{} ({} gearboxes; as stated: yield {}, jam {}, 99 "
             "% "
             "of those that assemble keep {:.2f} arcmin)\n",
             tightening_harms(s) ? ": none helps, the mean has to be moved" : "", s.samples,
             share_text(s.yield), share_text(s.jam_probability), arcmin(s.quantile_99_rad)) +
         table.text(2) +
         "  +- of gain and jam: one standard error; halved: half as wide about the middle of its "
         "limits; limits: half\n  width, radius of a circle, or arc on P2's base circle; variance: "
         "of the lost motion, 0 where it jams\n" +
         (mostly_beyond(series)
              ? "  Half of them and more exceed the limit: move the middle first (shifts, "
                "machining allowance, [robust] of a SPEC);\n"
                "  planets that differ have less lost motion than alike ones, so that tighter "
                "tolerances then gain nothing\n"
              : "");
}

/// A part of the series as an object with its rows.
constexpr const char* kItem = "built";

Fields proportion_fields(const Proportion& p, const char* quantity = nullptr) {
  Fields f(kItem);
  f.add("value", p.value);
  if (quantity != nullptr) f.add_row(p.value, {quantity});
  f.add("ci95", {p.lower, p.upper});
  return f;
}

Fields estimate_fields(const Estimate& e, const char* quantity = nullptr) {
  Fields f;
  f.add("value", e.value);
  f.add("standard_error", e.standard_error);
  if (quantity != nullptr) {
    f.add_row(e.value, {quantity});
    f.add_row(e.standard_error, {fmt::format("{}_error", quantity)});
  }
  return f;
}

Fields lost_motion_fields(const backlash::LostMotionDistribution& d) {
  Fields f(kItem);
  f.add("mean", arcmin(d.mean_rad), {"lost_motion_mean", "arcmin"});
  f.add("standard_deviation", arcmin(d.deviation_rad),
        {"lost_motion_standard_deviation", "arcmin"});
  f.add("least", arcmin(d.least_rad));
  f.add("greatest", arcmin(d.greatest_rad));
  f.add("quantiles", list_json(d.quantiles, [](const Quantile& q) {
          return io::Json{{"probability", q.probability}, {"lost_motion_arcmin", arcmin(q.value)}};
        }));
  return f;
}

Fields worst_case_fields(const backlash::WorstCase& w) {
  Fields f(kItem);
  f.add("planets_alike_arcmin", arcmin(w.middle_rad));
  f.add("root_sum_square_arcmin", arcmin(w.root_sum_square_rad));
  f.add("greatest_arcmin", arcmin(w.greatest_rad), {"lost_motion_worst_case", "arcmin"});
  f.add("greatest_attained", w.greatest_attained);
  f.add("least_arcmin", arcmin(w.least_rad));
  f.add("least_margin_um", um(w.least_margin_m), {"margin_worst_case", "um"});
  return f;
}

io::Json first_contact_json(const design::FirstContactRooms& r) {
  io::Json rooms = io::Json::array();
  for (std::size_t k = 0; k < r.median_m.size(); ++k) {
    rooms.push_back({{"median_um", um(r.median_m[k])}, {"percent95_um", um(r.percent95_m[k])}});
  }
  return {
      {"samples", r.samples}, {"greatest_share", r.greatest_share}, {"rooms", std::move(rooms)}};
}

/// A tolerance and what it does; its rows are the columns of tolerances.csv.
/// @param planets_alike_rad  its part of the lost motion of planets that are alike
Fields share_fields(const backlash::ToleranceSource& source, const ToleranceShare& share,
                    double planets_alike_rad) {
  Fields f;
  f.add("tolerance", backlash::kToleranceKindNames[static_cast<std::size_t>(source.kind)]);
  f.add_row(source.name(), {"tolerance"});
  f.add("gear", source.gear < 0
                    ? nullptr
                    : io::Json(train::kGearNames[static_cast<std::size_t>(source.gear)]));
  f.add("half_width_um", um(source.half_width_m), {"half_width_um"});
  f.add("variance_first_order", estimate_fields(share.first_order, "variance_first_order"));
  f.add("variance_total", estimate_fields(share.total, "variance_total"));
  f.add("planets_alike_arcmin", arcmin(planets_alike_rad), {"planets_alike_arcmin"});
  Fields halved;
  halved.add("yield", share.halved.yield, {"halved_yield"});
  halved.add("yield_gain", estimate_fields(share.halved.yield_gain, "halved_yield_gain"));
  halved.add("jam_probability", share.halved.jam_probability, {"halved_jam_probability"});
  halved.add("jam_change", estimate_fields(share.halved.jam_change));
  halved.add("quantile_99_arcmin", arcmin(share.halved.quantile_99_rad),
             {"halved_quantile_99_arcmin"});
  f.add("halved", std::move(halved));
  return f;
}

Fields share_fields(const BuiltSeries& series, std::size_t i) {
  return share_fields(series.model.sources[i], series.shares.sources[i],
                      series.result.worst.share_rad[i]);
}

io::Json shares_json(const BuiltSeries& series) {
  const backlash::ToleranceShares& s = series.shares;
  return {{"samples", s.samples},
          {"yield", s.yield},
          {"jam_probability", s.jam_probability},
          {"quantile_99_arcmin", arcmin(s.quantile_99_rad)},
          {"tolerances", list_json(by_effect(series),
                                   [&](std::size_t i) { return share_fields(series, i).json(); })}};
}

io::Json thermal_end_json(const design::ThermalSeries& end) {
  const MonteCarloResult& r = end.result;
  const io::Json lost_motion =
      r.assembled.count > 0 ? lost_motion_fields(r.lost_motion).json() : io::Json(nullptr);
  return {{"temperature_c", celsius(end.state.temperature_K)},
          {"moisture", moisture_name(end.state.moisture)},
          {"jammed", proportion_fields(end.jammed).json()},
          {"assembled", proportion_fields(r.assembled).json()},
          {"yield", proportion_fields(r.yield).json()},
          {"limit_of_99_percent_arcmin", if_any(r.limit_of_99_percent_rad, arcmin)},
          {"lost_motion_arcmin", lost_motion}};
}

}  // namespace

std::string built_series_table(const BuiltSeries& series) {
  return series_text(series) + tighten_text(series);
}

Fields built_series_fields(const BuiltSeries& series) {
  const MonteCarloResult& r = series.result;
  Fields f(kItem);
  f.add("samples", r.samples);
  f.add("seed", series.seed);
  f.add("scatter", backlash::kScatterNames[static_cast<std::size_t>(series.scatter.scatter)]);
  f.add("sigma_level", series.scatter.sigma_level);
  f.add("limit_arcmin", if_any(series.limit_rad, arcmin));
  f.add("assembled", proportion_fields(r.assembled, "assembled"));
  f.add("jammed", proportion_fields(r.jammed));
  f.add("beyond_limit", proportion_fields(r.beyond_limit));
  f.add("yield", proportion_fields(r.yield, "yield"));
  f.add("limit_of_99_percent_arcmin", if_any(r.limit_of_99_percent_rad, arcmin),
        {"limit_of_99_percent", "arcmin"});
  f.add("lost_motion_arcmin", nullptr);
  if (r.assembled.count > 0) f.add("lost_motion_arcmin", lost_motion_fields(r.lost_motion));
  f.add("margin_um", list_json(r.margin, [](const Quantile& q) {
          return io::Json{{"probability", q.probability}, {"margin_um", um(q.value)}};
        }));
  f.add("worst_case", worst_case_fields(r.worst));
  f.add("turn", nullptr);
  if (series.turn) {
    f.add("turn", {{"gearboxes", series.turn->gearboxes},
                   {"assembled", proportion_fields(series.turn->assembled).json()},
                   {"yield", proportion_fields(series.turn->yield).json()}});
  }
  f.add("first_contact", first_contact_json(series.rooms));
  f.add("shares", shares_json(series));
  f.add("thermal", nullptr);
  if (!series.thermal.empty()) {
    f.add("thermal", list_json(series.thermal, thermal_end_json));
  }
  return f;
}

io::Json tolerances_json(const design::Evaluation& e, const BuiltSeries& series) {
  io::Json json{{"tool", tool_json()}, {"name", e.name}};
  if (e.tolerance_limits) json["tolerances"] = tolerance_fields(*e.tolerance_limits).json();
  json["built"] = built_series_fields(series).json();
  return json;
}

std::string lost_motion_histogram_csv(const BuiltSeries& series) {
  std::string text = "from_arcmin,to_arcmin,gearboxes\n";
  for (const backlash::HistogramBin& bin : series.result.lost_motion.histogram) {
    text += csv_line(
        {exact(arcmin(bin.lower)), exact(arcmin(bin.upper)), fmt::format("{}", bin.count)});
  }
  return text;
}

std::string tolerance_shares_csv(const BuiltSeries& series) {
  std::string text = share_fields({}, {}, 0.0).csv_header();
  for (const std::size_t i : by_effect(series)) text += share_fields(series, i).csv_values();
  return text;
}

Plot lost_motion_plot(const std::string& name, const BuiltSeries& series) {
  const MonteCarloResult& r = series.result;
  std::string bins;
  for (const backlash::HistogramBin& bin : r.lost_motion.histogram) {
    const double middle = 0.5 * (arcmin(bin.lower) + arcmin(bin.upper));
    const double width = arcmin(bin.upper) - arcmin(bin.lower);
    bins +=
        fmt::format("{} {} {}\n", exact(middle),
                    exact(100.0 * static_cast<double>(bin.count) / static_cast<double>(r.samples)),
                    exact(width));
  }
  std::string text = plot_prologue(900, 520);
  text += fmt::format(
      "set title {}\nset xlabel 'lost motion at the output (arcmin)'\nset ylabel 'gearboxes (%)'\n"
      "set yrange [0:*]\nset style fill solid 0.8 noborder\nset key top left\n",
      plot_text(fmt::format("{}: {} built gearboxes, {:.2f} % assemble", name, r.samples,
                            percent(r.assembled.value))));
  // Wide enough for every line, which gnuplot leaves out beyond its range.
  double from = arcmin(r.worst.middle_rad);
  double to = arcmin(r.worst.greatest_rad);
  for (const backlash::HistogramBin& bin : r.lost_motion.histogram) {
    from = std::min(from, arcmin(bin.lower));
    to = std::max(to, arcmin(bin.upper));
  }
  const auto line = [&](const std::string& label, double at, const char* style) {
    from = std::min(from, at);
    to = std::max(to, at);
    text +=
        fmt::format("set arrow from {0}, graph 0 to {0}, graph 1 nohead {1}\n", exact(at), style);
    text += fmt::format("set label {} at {}, graph 0.97 rotate by -90 offset 0.8,0 font ',10'\n",
                        plot_text(label), exact(at));
  };
  if (series.limit_rad) line("limit", arcmin(*series.limit_rad), "lc rgb '#b2182b' lw 2");
  line("planets alike, middle", arcmin(r.worst.middle_rad), "lc rgb '#404040' dt 2");
  line("worst case", arcmin(r.worst.greatest_rad), "lc rgb '#404040' dt 3");
  const double border = std::max(0.05 * (to - from), 0.01);
  text += fmt::format("set xrange [{}:{}]\n", exact(from - border), exact(to + border));
  if (bins.empty()) {
    // An empty frame: gnuplot fails where there is nothing at all to plot.
    text += "set yrange [0:1]\nplot -1 notitle\n";
    return {.name = "lost_motion", .script = text};
  }
  text += fmt::format(
      "$bins << EOD\n{}EOD\nplot $bins using 1:2:3 with boxes lc rgb '#4393c3' "
      "notitle\n",
      bins);
  return {.name = "lost_motion", .script = text};
}

Plot tolerance_shares_plot(const std::string& name, const BuiltSeries& series) {
  std::string rows;
  const std::vector<std::size_t> order = by_effect(series);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const ToleranceShare& s = series.shares.sources[order[k]];
    rows += fmt::format("{} {} {} \"{}\"\n", order.size() - k,
                        exact(percent(s.halved.yield_gain.value)), exact(percent(s.total.value)),
                        series.model.sources[order[k]].name());
  }
  std::string text = plot_prologue(900, 160 + 22 * static_cast<int>(order.size()));
  text += fmt::format(
      "set multiplot layout 1,2 margins 0.22,0.97,0.12,0.93 spacing 0.05 title {}\nset style fill "
      "solid 0.8 noborder\nset boxwidth 0.7\n"
      "set yrange [0.4:{}.6]\nunset key\n",
      plot_text(fmt::format("{}: {}", name,
                            tightening_harms(series.shares)
                                ? "to tighten a tolerance does not help, the mean has to be moved"
                                : "which tolerance to tighten first")),
      order.size());
  if (rows.empty()) return {.name = "tolerances", .script = text + "unset multiplot\n"};
  text += fmt::format(
      "$rows << EOD\n{}EOD\n"
      "set xlabel 'yield gained when halved (%)'\n"
      "plot $rows using (0.5*$2):1:(0.5*$2):(0.35):ytic(4) with boxxyerror lc rgb '#4393c3'\n"
      "set xlabel 'share of the variance of lost motion (%)'\nset format y ''\n"
      "plot $rows using (0.5*$3):1:(0.5*$3):(0.35) with boxxyerror lc rgb '#92c5de'\n"
      "unset multiplot\n",
      rows);
  return {.name = "tolerances", .script = text};
}

}  // namespace gear3k::report
