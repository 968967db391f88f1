#include "papers/paper_figures_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "papers/paper_figures_report.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::papers {

namespace {

using optimize::RefinedSet, optimize::Status;
using report::Plot, report::arcmin, report::clean, report::fixed, report::mm, report::percent,
    report::plot_prologue, report::plot_text, report::teeth_text;

constexpr const char* kPalette =
    "set palette defined (0 '#440154', 1 '#414487', 2 '#2a788e', 3 '#22a884', 4 '#7ad151', 5 "
    "'#fde725')\n";
constexpr const char* kGrid = "set grid lc rgb '#e6e6e6' lt 1\n";
constexpr const char* kInfeasible = "#d9d9d9";
constexpr const char* kPublished = "#d62728";

/// Coordinates of a plot need no more: a hundredth of a pixel and less.
std::string drawn(double value) { return fmt::format("{:.8g}", value); }

std::string block(const std::string& name, const std::string& rows) {
  return fmt::format("${} << EOD\n{}EOD\n", name, rows);
}

std::string plot_of(const std::vector<std::string>& layers) {
  return fmt::format("plot {}\n", layers.empty()
                                      ? "NaN notitle"
                                      : fmt::format("{}", fmt::join(layers, ", \\\n  ")));
}

/// A legend of so many lines under the label of the lowest axis.
std::string key_below(int lines) {
  return fmt::format(
      "set bmargin {}\nset key at screen 0.5,screen 0.015 center bottom vertical maxrows {} Left "
      "reverse samplen 1.5\n",
      4 + lines, lines);
}

std::string friction_caption(const optimize::Specification& task) {
  return fmt::format("mu = {:g}, {}", task.friction.coefficient,
                     efficiency::kLossModelNames[static_cast<std::size_t>(task.friction.model)]);
}

bool is_published(const PaperFigures& f, const ZeroShiftPoint& p) {
  return p.candidate.teeth == f.published.train.teeth;
}

std::string scatter_script(const PaperFigures& f) {
  std::string sets;
  std::string published;
  for (const ZeroShiftPoint& p : f.scatter.points) {
    const std::string at = drawn(p.ratio) + ' ' + drawn(arcmin(p.lost_motion_rad));
    sets += fmt::format("{} {}\n", at, drawn(percent(p.eta_b)));
    if (is_published(f, p)) published += at + '\n';
  }
  const auto& ratio = f.task.ratio;
  std::string text = plot_prologue(900, 620);
  text += kGrid;
  text += kPalette;
  text += fmt::format(
      "set title {} offset 0,0.3\nset xlabel 'gear ratio'\n"
      "set ylabel 'backlash at the output, eq. 17 (arcmin)'\n"
      "set cblabel 'backward efficiency (%)' offset 1,0\n{}"
      "set xrange [{}:{}]\n",
      plot_text(fmt::format("{} tooth sets at zero profile shift ({})", f.scatter.points.size(),
                            friction_caption(f.task))),
      key_below(1), drawn(ratio.target * (1.0 - 1.02 * kScatterTolerance)),
      drawn(ratio.target * (1.0 + 1.02 * kScatterTolerance)));
  std::vector<std::string> layers;
  if (sets.empty()) {
    text += "unset colorbox\n";
  } else {
    text += block("sets", sets);
    layers.emplace_back("$sets using 1:2:3 with points pt 7 ps 0.35 lc palette notitle");
  }
  if (!published.empty()) {
    text += block("published", published);
    layers.push_back(fmt::format(
        "$published using 1:2 with points pt 6 ps 1.6 lw 2.5 lc rgb '{}' title {}", kPublished,
        plot_text("published teeth " + teeth_text(f.published.train.teeth))));
  }
  return text + plot_of(layers);
}

std::string refined_script(const PaperFigures& f) {
  constexpr std::array<const char*, kLimits> kColours{"#5e3c99", "#2166ac", "#1b9e77", "#e08214"};
  std::string before;
  std::array<std::string, kLimits> after;
  std::string published_before;
  std::string published;
  for (const RefinedPoint& set : f.refined) {
    const ZeroShiftPoint& p = f.scatter.points[set.scatter_index];
    const std::string zero =
        fmt::format("{} {}\n", drawn(arcmin(p.lost_motion_rad)), drawn(percent(p.eta_b)));
    before += zero;
    if (is_published(f, p)) published_before += zero;
    for (std::size_t i = 0; i < kLimits; ++i) {
      const RefinedSet& refined = set.refined[i];
      if (!optimize::has_design(refined.status)) continue;
      const std::string at = fmt::format("{} {}\n", drawn(arcmin(refined.lost_motion_rad)),
                                         drawn(percent(refined.eta_b)));
      after[i] += at;
      if (is_published(f, p)) published += at;
    }
  }
  std::string best;
  for (std::size_t i = 0; i < kLimits; ++i) {
    if (const RefinedSet* set = best_refined(f, i)) {
      best +=
          fmt::format("{} {}\n", drawn(arcmin(set->lost_motion_rad)), drawn(percent(set->eta_b)));
    }
  }
  std::string text = plot_prologue(900, 680);
  text += kGrid;
  text += fmt::format(
      "set title {} offset 0,0.3\nset xlabel 'backlash at the output, eq. 17 (arcmin)'\n"
      "set ylabel 'backward efficiency (%)'\n{}set xrange [0:20]\n",
      plot_text(fmt::format("{} tooth sets within {:g} % of {:g}:1, zero shift and refined ({})",
                            f.refined.size(), percent(f.task.ratio.tolerance), f.task.ratio.target,
                            friction_caption(f.task))),
      key_below(4));
  std::vector<std::string> layers;
  const auto add = [&](const std::string& name, const std::string& rows, const std::string& style,
                       const std::string& title) {
    if (rows.empty()) return;
    text += block(name, rows);
    layers.push_back(fmt::format("${} using 1:2 with {} title {}", name, style, plot_text(title)));
  };
  add("before", before, "points pt 7 ps 0.4 lc rgb '#a0a0a0'", "zero profile shift");
  for (std::size_t i = 0; i < kLimits; ++i) {
    add(fmt::format("after{}", i), after[i],
        fmt::format("points pt 7 ps 0.4 lc rgb '{}'", kColours[i]),
        fmt::format("refined, at most {:g} arcmin", kRefinementLimits_arcmin[i]));
  }
  add("best", best, "linespoints pt 6 ps 1 lw 1.5 lc rgb '#202020'", "best refined");
  const std::string teeth = "teeth " + teeth_text(f.published.train.teeth);
  add("published_before", published_before,
      fmt::format("points pt 2 ps 1 lw 2.5 lc rgb '{}'", kPublished), teeth + ", zero shift");
  add("published", published,
      fmt::format("linespoints pt 6 ps 1 lw 1.5 dt 2 lc rgb '{}'", kPublished),
      teeth + ", refined");
  return text + plot_of(layers);
}

double in_axis_unit(const VariedInput& input, double value) {
  return clean(units::from_si(value, input.unit));
}
std::string axis_label(const VariedInput& input) {
  const std::string unit(units::unit_name(input.unit));
  return plot_text(input.name + (unit.empty() ? "" : fmt::format(" ({})", unit)));
}
/// Half the distance of neighbouring values, in the axis' unit.
double half_step(const VariedInput& input) {
  return 0.5 * (in_axis_unit(input, input.values[1]) - in_axis_unit(input, input.values[0]));
}
std::string axis_range(const VariedInput& input) {
  const double half = half_step(input);
  return fmt::format("[{}:{}]", drawn(in_axis_unit(input, input.values.front()) - half),
                     drawn(in_axis_unit(input, input.values.back()) + half));
}

struct FigurePanel {
  const char* title;
  double (*value)(const FigureMapPoint&);
};
constexpr std::array<FigurePanel, 2> kPanels{
    {{.title = "backward efficiency (%)",
      .value = [](const FigureMapPoint& p) { return percent(p.eta_b); }},
     {.title = "backlash at the output, eq. 17 (arcmin)",
      .value = [](const FigureMapPoint& p) { return arcmin(p.paper_rad); }}}};

std::string figure_title(const PaperFigures& f, const std::string& varied) {
  return plot_text(fmt::format("Published gear {} over {}, centre distance {} mm fixed ({})",
                               teeth_text(f.published.train.teeth), varied,
                               fixed(mm(f.published_center_distance_m), 4),
                               friction_caption(f.task)));
}

/// Two maps side by side: the cells of a column that look alike are one box.
std::string map_script(const PaperFigures& f, const FigureMap& map) {
  const double dx = half_step(map.x);
  const double dy = half_step(*map.y);
  std::string text = plot_prologue(1120, 560);
  text += kPalette;
  text += fmt::format(
      "set multiplot layout 1,2 title {} font ',15'\nset xlabel {}\nset ylabel {}\nset xrange {}\n"
      "set yrange {}\nset style fill solid 1.0 noborder\nset tics out\n"
      "set format '%g'\nset rmargin 10\n{}",
      figure_title(f, map.x.name + " and " + map.y->name), axis_label(map.x), axis_label(*map.y),
      axis_range(map.x), axis_range(*map.y), key_below(1));
  const std::string published = fmt::format("{} {}\n", drawn(in_axis_unit(map.x, map.x.published)),
                                            drawn(in_axis_unit(*map.y, map.y->published)));
  text += block("published", published);
  for (std::size_t panel = 0; panel < kPanels.size(); ++panel) {
    std::string cells;
    std::string blanks;
    for (std::size_t i = 0; i < map.x.values.size(); ++i) {
      const double x = in_axis_unit(map.x, map.x.values[i]);
      for (std::size_t j = 0; j < map.rows();) {
        const auto shown = [&](std::size_t row) {
          const FigureMapPoint& p = map.points[i * map.rows() + row];
          return p.status == "ok" ? fmt::format("{:.4g}", kPanels[panel].value(p)) : "";
        };
        const std::string value = shown(j);
        std::size_t end = j + 1;
        while (end < map.rows() && shown(end) == value) ++end;
        const double low = in_axis_unit(*map.y, map.y->values[j]) - dy;
        const double high = in_axis_unit(*map.y, map.y->values[end - 1]) + dy;
        (value.empty() ? blanks : cells) +=
            fmt::format("{} {} {} {} {} {} {}\n", drawn(x), drawn(0.5 * (low + high)),
                        drawn(x - dx), drawn(x + dx), drawn(low), drawn(high), value);
        j = end;
      }
    }
    text += fmt::format("set title '{}' offset 0,-0.5\n", kPanels[panel].title);
    std::vector<std::string> layers;
    const auto add = [&](const char* name, const std::string& rows, const std::string& layer) {
      if (rows.empty()) return;
      const std::string numbered = fmt::format("{}{}", name, panel);
      text += block(numbered, rows);
      layers.push_back(fmt::format("${}{}", numbered, layer));
    };
    add("blanks", blanks,
        fmt::format(" using 1:2:3:4:5:6 with boxxyerror fillcolor rgb '{}' title 'infeasible'",
                    kInfeasible));
    add("cells", cells, " using 1:2:3:4:5:6:7 with boxxyerror fillcolor palette notitle");
    if (cells.empty()) text += "unset colorbox\n";
    layers.push_back(fmt::format(
        "$published using 1:2 with points pt 6 ps 1.4 lw 2.5 lc rgb '{}' title 'published'",
        kPublished));
    text += plot_of(layers) + "unset key\n";
  }
  return text + "unset multiplot\n";
}

std::string line_script(const PaperFigures& f, const FigureMap& map) {
  std::string text = plot_prologue(900, 820);
  text += kGrid;
  text += fmt::format(
      "set multiplot layout 2,1 title {} font ',15'\nset xlabel {}\nset xrange {}\n"
      "{}set format '%g'\nset lmargin 12\nset rmargin 4\nset style fill solid 1.0 noborder\n",
      figure_title(f, map.x.name), axis_label(map.x), axis_range(map.x), key_below(3));
  const double least = in_axis_unit(map.x, f.task.profile_shift.min);
  text +=
      fmt::format("set arrow from {0},graph 0 to {0},graph 1 nohead dt 2 lc rgb '#404040' lw 1.5\n",
                  drawn(least));
  const double half = half_step(map.x);
  for (std::size_t k = 0; k < map.points.size();) {
    std::size_t end = k + 1;
    while (end < map.points.size() && map.points[end].status == map.points[k].status) ++end;
    if (map.points[k].status != "ok") {
      const double low = in_axis_unit(map.x, map.x.values[k]) - half;
      const double high = in_axis_unit(map.x, map.x.values[end - 1]) + half;
      text += fmt::format(
          "set object rectangle from {},graph 0 to {},graph 1 fc rgb '{}' fs solid noborder "
          "behind\nset label {} at {},graph 0.5 center rotate by 90 tc rgb '#606060' font ',12'\n",
          drawn(low), drawn(high), kInfeasible, plot_text(map.points[k].status),
          drawn(0.5 * (low + high)));
    }
    k = end;
  }
  for (std::size_t panel = 0; panel < kPanels.size(); ++panel) {
    std::string line;
    std::string published;
    for (std::size_t k = 0; k < map.points.size(); ++k) {
      if (map.points[k].status != "ok") {
        line += '\n';  // interrupts the line
        continue;
      }
      const std::string at = fmt::format("{} {}\n", drawn(in_axis_unit(map.x, map.x.values[k])),
                                         drawn(kPanels[panel].value(map.points[k])));
      line += at;
      if (map.x.values[k] == map.x.published) published = at;
    }
    text += fmt::format("set ylabel '{}'\n", kPanels[panel].title);
    std::vector<std::string> layers;
    if (!published.empty()) {
      text += block(fmt::format("line{}", panel), line) +
              block(fmt::format("published{}", panel), published);
      layers.push_back(
          fmt::format("$line{} using 1:2 with lines lw 2.5 lc rgb '#2166ac' notitle", panel));
      layers.push_back(fmt::format(
          "$published{} using 1:2 with points pt 6 ps 1.4 lw 2.5 lc rgb '{}' title 'published'",
          panel, kPublished));
    }
    layers.emplace_back(
        "keyentry with lines dt 2 lc rgb '#404040' lw 1.5 title 'least shift by eq. 35'");
    layers.push_back(
        fmt::format("keyentry with boxes fillcolor rgb '{}' title 'infeasible, with the check that "
                    "fails first'",
                    kInfeasible));
    text += plot_of(layers) + "unset key\n";
  }
  return text + "unset multiplot\n";
}

}  // namespace

std::vector<Plot> figure_plots(const PaperFigures& figures) {
  return {{.name = kFigureNames[0], .script = scatter_script(figures)},
          {.name = kFigureNames[1], .script = refined_script(figures)},
          {.name = kFigureNames[2], .script = map_script(figures, figures.ring_shifts)},
          {.name = kFigureNames[3], .script = map_script(figures, figures.modules)},
          {.name = kFigureNames[4], .script = line_script(figures, figures.planet_shift)}};
}

}  // namespace gear3k::papers
