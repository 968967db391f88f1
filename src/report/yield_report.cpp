#include "report/yield_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "io/text/json.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

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

std::string series_text(const BuiltSeries& series) {
  const MonteCarloResult& r = series.result;
  std::string text = fmt::format(
      "\nBuilt gearboxes at one position of the turn: {} drawn at random, seed {}, {} scatter{}\n",
      r.samples, series.seed,
      backlash::kScatterNames[static_cast<std::size_t>(series.scatter.scatter)],
      series.scatter.scatter == backlash::Scatter::kNormal
          ? fmt::format(" (limits at {:g} standard deviations)", series.scatter.sigma_level)
          : "");
  text += fmt::format("  assemble               {}\n", proportion_text(r.assembled));
  if (series.limit_rad) {
    text += fmt::format("  and keep {:<13} {}\n", limit_text(series), proportion_text(r.yield));
  }
  text += fmt::format("  99 % of all keep       {}\n",
                      r.limit_of_99_percent_rad
                          ? fmt::format("{:.2f} arcmin", arcmin(*r.limit_of_99_percent_rad))
                          : std::string("no limit: more than 1 % do not assemble"));
  if (r.assembled.count > 0) {
    const auto& d = r.lost_motion;
    text += fmt::format("  lost motion            {:.2f} arcmin, standard deviation {:.2f}\n",
                        arcmin(d.mean_rad), arcmin(d.deviation_rad));
    std::string quantiles;
    for (const Quantile& q : d.quantiles) {
      quantiles += fmt::format("{}{:g} %: {:.2f}", quantiles.empty() ? "" : ", ",
                               clean(percent(q.probability)), arcmin(q.value));
    }
    text += fmt::format("    at most, arcmin      {}\n", quantiles);
  }
  const backlash::WorstCase& w = r.worst;
  text += fmt::format(
      "  planets alike          {:.2f} arcmin with all at the middle of their limits; +- {:.2f} by "
      "root sum square\n",
      arcmin(w.middle_rad), arcmin(w.root_sum_square_rad));
  if (w.greatest_margin_m >= 0.0) {
    text += fmt::format("  worst case             {:.2f} arcmin{}, least {:.2f}\n",
                        arcmin(w.greatest_rad), w.greatest_attained ? "" : " (a bound)",
                        arcmin(w.least_rad));
  }
  text += w.can_jam()
              ? fmt::format("  in the worst case it does not assemble, by {:.1f} um\n",
                            -um(w.least_margin_m))
              : fmt::format("  it always assembles, with {:.1f} um to spare in the worst case\n",
                            um(w.least_margin_m));
  if (series.turn) {
    text += fmt::format(
        "  at every position      of a turn, {} gearboxes: {:.1f} % assemble (95 %: {:.1f} to "
        "{:.1f})",
        series.turn->gearboxes, percent(series.turn->assembled.value),
        percent(series.turn->assembled.lower), percent(series.turn->assembled.upper));
    if (series.limit_rad) {
      text += fmt::format(", {:.1f} % also keep {} (95 %: {:.1f} to {:.1f})",
                          percent(series.turn->yield.value), limit_text(series),
                          percent(series.turn->yield.lower), percent(series.turn->yield.upper));
    }
    text += '\n';
  }
  if (series.paper_limit) {
    text +=
        "  the limit of lost motion is one of the paper's model (backlash.model); built gearboxes "
        "follow the\n    kinematic one and are not judged by it\n";
  }
  const design::FirstContactRooms& rooms = series.rooms;
  if (rooms.samples > 0 && rooms.median_m.size() > 1) {
    text += fmt::format(
        "  at first contact       one planet carries {:.0f} % of the output torque on average{}\n",
        percent(rooms.greatest_share),
        rooms.greatest_share > 1.005 ? " (above 100: another one is wedged and works against it)"
                                     : "");
    std::string later;
    for (std::size_t k = 1; k < rooms.median_m.size(); ++k) {
      later += fmt::format("{}{:.1f} um ({:.1f} um)", later.empty() ? "" : ", ",
                           um(rooms.median_m[k]), um(rooms.percent95_m[k]));
    }
    text += fmt::format("    room left at the {}: {} in the median (95 % have at most)\n",
                        rooms.median_m.size() > 2 ? "planets that follow" : "planet that follows",
                        later);
  }
  return text;
}

/// Whether tightening about the middles cannot help.
bool mostly_beyond(const BuiltSeries& series) {
  return series.limit_rad && series.result.beyond_limit.value > 0.5;
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
             "\nWhich tolerance to tighten first ({} gearboxes; as stated: yield {}, jam {}, 99 % "
             "of those that assemble keep {:.2f} arcmin)\n",
             s.samples, share_text(s.yield), share_text(s.jam_probability),
             arcmin(s.quantile_99_rad)) +
         table.text(2) +
         "  +- of gain and jam: one standard error; halved: half as wide about the middle of its "
         "limits; limits: half\n  width, radius of a circle, or arc on P2's base circle; variance: "
         "of the lost motion, 0 where it jams\n" +
         (mostly_beyond(series)
              ? "  Half of them and more exceed the limit: move the middle first (shifts, "
                "machining "
                "allowance, [robust] of a SPEC);\n  planets that differ have less lost motion than "
                "alike ones, so that tighter tolerances then gain nothing\n"
              : "");
}

io::Json proportion_json(const Proportion& p) {
  return {{"value", p.value}, {"ci95", {p.lower, p.upper}}};
}

io::Json estimate_json(const Estimate& e) {
  return {{"value", e.value}, {"standard_error", e.standard_error}};
}

}  // namespace

std::string yield_table(const BuiltSeries& series) {
  return series_text(series) + tighten_text(series);
}

io::Json yield_json(const BuiltSeries& series) {
  const MonteCarloResult& r = series.result;
  io::Json quantiles = io::Json::array();
  for (const Quantile& q : r.lost_motion.quantiles) {
    quantiles.push_back({{"probability", q.probability}, {"lost_motion_arcmin", arcmin(q.value)}});
  }
  io::Json margins = io::Json::array();
  for (const Quantile& q : r.margin) {
    margins.push_back({{"probability", q.probability}, {"margin_um", um(q.value)}});
  }
  const bool any = r.assembled.count > 0;
  io::Json json{
      {"samples", r.samples},
      {"seed", series.seed},
      {"scatter", backlash::kScatterNames[static_cast<std::size_t>(series.scatter.scatter)]},
      {"sigma_level", series.scatter.sigma_level},
      {"limit_arcmin", if_any(series.limit_rad, arcmin)},
      {"assembled", proportion_json(r.assembled)},
      {"jammed", proportion_json(r.jammed)},
      {"beyond_limit", proportion_json(r.beyond_limit)},
      {"yield", proportion_json(r.yield)},
      {"limit_of_99_percent_arcmin", if_any(r.limit_of_99_percent_rad, arcmin)},
      {"lost_motion_arcmin",
       any ? io::Json{{"mean", arcmin(r.lost_motion.mean_rad)},
                      {"standard_deviation", arcmin(r.lost_motion.deviation_rad)},
                      {"least", arcmin(r.lost_motion.least_rad)},
                      {"greatest", arcmin(r.lost_motion.greatest_rad)},
                      {"quantiles", quantiles}}
           : nullptr},
      {"margin_um", margins},
      {"worst_case",
       {{"planets_alike_arcmin", arcmin(r.worst.middle_rad)},
        {"root_sum_square_arcmin", arcmin(r.worst.root_sum_square_rad)},
        {"greatest_arcmin", arcmin(r.worst.greatest_rad)},
        {"greatest_attained", r.worst.greatest_attained},
        {"least_arcmin", arcmin(r.worst.least_rad)},
        {"least_margin_um", um(r.worst.least_margin_m)}}}};
  io::Json rooms = io::Json::array();
  for (std::size_t k = 0; k < series.rooms.median_m.size(); ++k) {
    rooms.push_back({{"median_um", um(series.rooms.median_m[k])},
                     {"percent95_um", um(series.rooms.percent95_m[k])}});
  }
  json["turn"] = series.turn ? io::Json{{"gearboxes", series.turn->gearboxes},
                                        {"assembled", proportion_json(series.turn->assembled)},
                                        {"yield", proportion_json(series.turn->yield)}}
                             : nullptr;
  json["first_contact"] = {{"samples", series.rooms.samples},
                           {"greatest_share", series.rooms.greatest_share},
                           {"rooms", rooms}};
  io::Json sources = io::Json::array();
  for (const std::size_t i : by_effect(series)) {
    const ToleranceShare& share = series.shares.sources[i];
    const backlash::ToleranceSource& source = series.model.sources[i];
    sources.push_back(
        {{"tolerance", backlash::kToleranceKindNames[static_cast<std::size_t>(source.kind)]},
         {"gear", source.gear < 0
                      ? nullptr
                      : io::Json(train::kGearNames[static_cast<std::size_t>(source.gear)])},
         {"half_width_um", um(source.half_width_m)},
         {"variance_first_order", estimate_json(share.first_order)},
         {"variance_total", estimate_json(share.total)},
         {"planets_alike_arcmin", arcmin(series.result.worst.share_rad[i])},
         {"halved",
          {{"yield", share.halved.yield},
           {"yield_gain", estimate_json(share.halved.yield_gain)},
           {"jam_probability", share.halved.jam_probability},
           {"jam_change", estimate_json(share.halved.jam_change)},
           {"quantile_99_arcmin", arcmin(share.halved.quantile_99_rad)}}}});
  }
  json["shares"] = {{"samples", series.shares.samples},
                    {"yield", series.shares.yield},
                    {"jam_probability", series.shares.jam_probability},
                    {"quantile_99_arcmin", arcmin(series.shares.quantile_99_rad)},
                    {"tolerances", sources}};
  return json;
}

std::string yield_csv(const BuiltSeries& series) {
  const MonteCarloResult& r = series.result;
  std::string text;
  const auto add = [&](const std::string& quantity, double value, const std::string& unit) {
    text += csv_line({"built", quantity, exact(value), unit, "", ""});
  };
  add("assembled", r.assembled.value, "");
  add("yield", r.yield.value, "");
  if (r.limit_of_99_percent_rad) {
    add("limit_of_99_percent", arcmin(*r.limit_of_99_percent_rad), "arcmin");
  }
  if (r.assembled.count > 0) {
    add("lost_motion_mean", arcmin(r.lost_motion.mean_rad), "arcmin");
    add("lost_motion_standard_deviation", arcmin(r.lost_motion.deviation_rad), "arcmin");
  }
  add("lost_motion_worst_case", arcmin(r.worst.greatest_rad), "arcmin");
  add("margin_worst_case", um(r.worst.least_margin_m), "um");
  return text;
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
  std::string text =
      "tolerance,half_width_um,variance_first_order,variance_first_order_error,variance_total,"
      "variance_total_error,planets_alike_arcmin,halved_yield,halved_yield_gain,"
      "halved_yield_gain_error,halved_jam_probability,halved_quantile_99_arcmin\n";
  for (const std::size_t i : by_effect(series)) {
    const ToleranceShare& s = series.shares.sources[i];
    text +=
        csv_line({series.model.sources[i].name(), exact(um(series.model.sources[i].half_width_m)),
                  exact(s.first_order.value), exact(s.first_order.standard_error),
                  exact(s.total.value), exact(s.total.standard_error),
                  exact(arcmin(series.result.worst.share_rad[i])), exact(s.halved.yield),
                  exact(s.halved.yield_gain.value), exact(s.halved.yield_gain.standard_error),
                  exact(s.halved.jam_probability), exact(arcmin(s.halved.quantile_99_rad))});
  }
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
      plot_text(fmt::format("{}: which tolerance to tighten first", name)), order.size());
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
