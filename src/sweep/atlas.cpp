#include "sweep/atlas.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "io/text/csv_table.hpp"
#include "io/text/diagnostics.hpp"
#include "papers/embedded_data.hpp"
#include "report/text_table.hpp"
#include "sweep/axes.hpp"
#include "sweep/task.hpp"

namespace gear3k::sweep {

namespace {

AtlasPoint atlas_point(const io::CsvTable& table, const io::CsvTable::Row& row) {
  const auto number = [&](const char* column) { return table.number(row, column).value_or(0.0); };
  const auto count = [&](const char* column) { return static_cast<int>(number(column)); };
  AtlasPoint point{.ratio_target = number("ratio.target"),
                   .planets = count("planets"),
                   .backlash_arcmin = number("backlash.max_output_arcmin"),
                   .friction = number("friction.coefficient"),
                   .best = std::nullopt};
  if (table.text(row, "status") != "optimal") return point;
  point.best = {.teeth = {.S = count("zS"),
                          .P1 = count("zP1"),
                          .R1 = count("zR1"),
                          .P2 = count("zP2"),
                          .R2 = count("zR2")},
                .eta_b = number("eta_b"),
                .eta_f = number("eta_f"),
                .bound = number("bound"),
                .module_mm = {number("m1_mm"), number("m2_mm")},
                .ring_root_diameter_mm = number("ring_root_diameter_mm"),
                .torque_capacity_nm = number("torque_capacity_nm")};
  return point;
}

/// The different values of a member, rising.
template <class Member>
auto atlas_values(Member AtlasPoint::*member) {
  std::set<Member> values;
  for (const AtlasPoint& point : atlas()) values.insert(point.*member);
  return std::vector<Member>(values.begin(), values.end());
}

double nearest(const std::vector<double>& values, double wanted) {
  return *std::ranges::min_element(
      values, {}, [&](double value) { return std::abs(std::log(value / wanted)); });
}

/// Its colour, by the number of planets.
const char* planet_colour(int planets) {
  constexpr std::array<const char*, 4> kColours{"#1f5fa8", "#3a8f5c", "#e08e0b", "#b03a2e"};
  return kColours[static_cast<std::size_t>(planets) % kColours.size()];
}

/// Size of the atlas's gearboxes: the greatest diameter of their rings' roots.
constexpr double kSize_mm = 76.0;

/// A published 3K gearbox with a measured backward efficiency.
struct Published {
  std::string key;  ///< what the figure's key says of it
  double ratio, eta_percent, backlash_arcmin, diameter_mm;
};
std::vector<Published> published_gearboxes() {
  const io::CsvTable table =
      io::parse_csv(std::string(papers::published_prototypes_csv()), "published_3k_prototypes.csv");
  std::vector<Published> gearboxes;
  for (const io::CsvTable::Row& row : table.rows) {
    const auto number = [&](const char* column) { return table.number(row, column); };
    const auto ratio = number("ratio_stated");
    const auto eta = number("bwd_eff_pct");
    const auto backlash_arcmin = number("backlash_arcmin");
    const auto diameter_mm = number("diameter_mm");
    if (!number("zS") || !ratio || !eta || !backlash_arcmin || !diameter_mm) continue;
    std::string name = *table.text(row, "design");
    std::ranges::replace(name, '_', ' ');
    gearboxes.push_back({.key = fmt::format("measured: {}, {:g} arcmin, {:g} mm", name,
                                            *backlash_arcmin, *diameter_mm),
                         .ratio = *ratio,
                         .eta_percent = *eta,
                         .backlash_arcmin = *backlash_arcmin,
                         .diameter_mm = *diameter_mm});
  }
  return gearboxes;
}

}  // namespace

const std::vector<AtlasPoint>& atlas() {
  static const std::vector<AtlasPoint> points = [] {
    const io::CsvTable table = io::parse_csv(std::string(atlas_csv()), "atlas.csv");
    std::vector<AtlasPoint> all;
    for (const io::CsvTable::Row& row : table.rows) all.push_back(atlas_point(table, row));
    return all;
  }();
  return points;
}

std::string atlas_error(const AtlasQuestion& question) {
  std::vector<std::string> errors;
  const std::vector<double> ratios = atlas_values(&AtlasPoint::ratio_target);
  // A hundredth beyond, as its tasks may be off.
  constexpr double kBeyond = 1.01;
  if (!(question.ratio * kBeyond >= ratios.front() && question.ratio <= ratios.back() * kBeyond)) {
    errors.push_back(fmt::format("atlas {:g}: allowed: a ratio from {:g} to {:g}", question.ratio,
                                 ratios.front(), ratios.back()));
  }
  const std::vector<int> planets = atlas_values(&AtlasPoint::planets);
  if (question.planets && std::ranges::find(planets, *question.planets) == planets.end()) {
    errors.push_back(fmt::format("--planets {}: allowed: {} to {}", *question.planets,
                                 planets.front(), planets.back()));
  }
  const double least_arcmin = atlas_values(&AtlasPoint::backlash_arcmin).front();
  if (question.backlash_arcmin && !(*question.backlash_arcmin >= least_arcmin)) {
    errors.push_back(
        fmt::format("--backlash {:g}: allowed: at least {:g}, the atlas's least limit in arcmin",
                    *question.backlash_arcmin, least_arcmin));
  }
  return fmt::format("{}", fmt::join(errors, "\n"));
}

std::vector<AtlasPoint> atlas_near(const AtlasQuestion& question) {
  if (const std::string error = atlas_error(question); !error.empty()) {
    throw io::InvalidInput(error);
  }
  const double ratio = nearest(atlas_values(&AtlasPoint::ratio_target), question.ratio);
  std::optional<double> backlash_arcmin, friction;
  if (question.backlash_arcmin) {
    for (const double limit : atlas_values(&AtlasPoint::backlash_arcmin)) {
      if (limit <= *question.backlash_arcmin) backlash_arcmin = limit;
    }
  }
  if (question.friction) {
    friction = nearest(atlas_values(&AtlasPoint::friction), *question.friction);
  }
  std::vector<AtlasPoint> near;
  for (const AtlasPoint& point : atlas()) {
    if (point.ratio_target != ratio) continue;
    if (question.planets && point.planets != *question.planets) continue;
    if (backlash_arcmin && point.backlash_arcmin != *backlash_arcmin) continue;
    if (friction && point.friction != *friction) continue;
    near.push_back(point);
  }
  return near;
}

std::string atlas_snap_text(const AtlasQuestion& question, const std::vector<AtlasPoint>& points) {
  const AtlasPoint& point = points.front();
  std::vector<std::string> taken;
  const auto add = [&](const char* text, double value, double asked, const char* unit = "") {
    constexpr double kSame = 1e-6;
    if (std::abs(value - asked) <= kSame * std::abs(asked)) return;
    taken.push_back(fmt::format("{} {:g}{} ({:g} was asked for)", text, value, unit, asked));
  };
  add("ratio", point.ratio_target, question.ratio);
  if (question.backlash_arcmin) {
    add("lost motion within", point.backlash_arcmin, *question.backlash_arcmin, " arcmin");
  }
  if (question.friction) add("friction", point.friction, *question.friction);
  return taken.empty() ? "" : fmt::format("the atlas's nearest: {}", fmt::join(taken, ", "));
}

Rows atlas_rows(const std::vector<AtlasPoint>& points) {
  Rows rows{.names = {"ratio_target", "planets", "max_backlash_arcmin", "friction", "eta_b",
                      "bound", "eta_f", "zS", "zP1", "zR1", "zP2", "zR2", "m1_mm", "m2_mm",
                      "ring_root_diameter_mm", "torque_capacity_nm"},
            .rows = {}};
  for (const AtlasPoint& point : points) {
    std::vector<SqlValue> row{point.ratio_target, std::int64_t{point.planets},
                              point.backlash_arcmin, point.friction};
    if (point.best) {
      const AtlasPoint::Best& best = *point.best;
      row.insert(row.end(), {best.eta_b, best.bound, best.eta_f});
      for (const int teeth : train::teeth_of(best.teeth)) row.emplace_back(std::int64_t{teeth});
      row.insert(row.end(), {best.module_mm[0], best.module_mm[1], best.ring_root_diameter_mm,
                             best.torque_capacity_nm});
    }
    row.resize(rows.names.size(), nullptr);
    rows.rows.push_back(std::move(row));
  }
  return rows;
}

std::string atlas_task(const AtlasQuestion& question) {
  std::vector<AtlasPoint> points = atlas_near(question);
  const auto eta_b = [](const AtlasPoint& point) {
    if (!point.best) return -HUGE_VAL;
    return point.best->eta_b;
  };
  const AtlasPoint& start = *std::ranges::max_element(points, {}, eta_b);
  io::TomlValue sweep = io::parse_toml(std::string(atlas_sweep()), "atlas.toml");
  io::TomlValue task = *std::ranges::find(sweep.table, "task", &io::TomlValue::key);
  set_at(task, "ratio.target", io::number_value(question.ratio));
  set_at(task, "planets", io::integer_value(start.planets));
  set_at(task, "backlash.max_output_arcmin",
         io::number_value(question.backlash_arcmin.value_or(start.backlash_arcmin)));
  set_at(task, "friction.coefficient",
         io::number_value(question.friction.value_or(start.friction)));
  return fmt::format("# A start from the atlas: its task at {:g}:1.\nname = \"atlas {:g}\"\n{}",
                     question.ratio, question.ratio, task_of(task).spec);
}

namespace {

/// Data of the tasks with so many planets and this friction; a task without a design, or with one
/// that cannot be driven backwards, has no point.
std::string atlas_data(double limit_arcmin, int planets, double friction) {
  std::string data;
  for (const AtlasPoint& point : atlas()) {
    if (point.planets != planets || point.friction != friction ||
        point.backlash_arcmin != limit_arcmin || !point.best || !(point.best->eta_b > 0.0)) {
      continue;
    }
    data += fmt::format("{} {}\n", report::exact(point.ratio_target),
                        report::exact(100.0 * point.best->eta_b));
  }
  return data;
}

/// The tasks as points: between two of them lies nothing, other tooth sets are the best there.
std::string atlas_script(double limit_arcmin) {
  std::string script = report::plot_prologue(820, 520);
  script += fmt::format(
      "set title {}\nset xlabel 'ratio'\nset ylabel 'backward efficiency (%)'\nset logscale x\n"
      "set xrange [18:330]\nset yrange [0:100]\nset xtics (20, 30, 50, 100, 200, 300)\n"
      "set grid lc rgb '#e0e0e0'\nset key left bottom Left reverse\n",
      report::plot_text(
          fmt::format("3K gearboxes of {:g} mm for 20 N m, at most {:g} arcmin of lost motion",
                      kSize_mm, limit_arcmin)));
  std::vector<std::string> layers;
  const auto add = [&](const std::string& data, const std::string& look, const std::string& key) {
    if (data.empty()) return;
    const std::string name = fmt::format("$d{}", layers.size());
    script += fmt::format("{} << EOD\n{}EOD\n", name, data);
    layers.push_back(
        fmt::format("{} using 1:2 with points {} title {}", name, look, report::plot_text(key)));
  };
  for (const int planets : atlas_values(&AtlasPoint::planets)) {
    for (const double friction : atlas_values(&AtlasPoint::friction)) {
      const bool first = friction == atlas_values(&AtlasPoint::friction).front();
      add(atlas_data(limit_arcmin, planets, friction),
          fmt::format("pt {} ps 0.8 lw 1.6 lc rgb '{}'", first ? 7 : 6, planet_colour(planets)),
          fmt::format("{} planets, friction {:g}", planets, friction));
    }
  }
  for (const Published& p : published_gearboxes()) {
    if (p.backlash_arcmin > limit_arcmin || p.diameter_mm > kSize_mm) continue;
    add(fmt::format("{} {}\n", report::exact(p.ratio), report::exact(p.eta_percent)),
        "pt 2 ps 1.2 lw 2 lc rgb '#202020'", p.key);
  }
  return script + fmt::format("plot {}\n", fmt::join(layers, ", \\\n  "));
}

}  // namespace

std::vector<report::Plot> atlas_plots() {
  std::vector<report::Plot> plots;
  for (const double limit : atlas_values(&AtlasPoint::backlash_arcmin)) {
    plots.push_back(
        {.name = fmt::format("atlas_{:g}_arcmin", limit), .script = atlas_script(limit)});
  }
  return plots;
}

}  // namespace gear3k::sweep
