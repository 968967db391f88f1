#include "papers/directional_bench_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "papers/report_parts.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::papers {

namespace {

using motion::MotionRow, motion::Phase;
using report::TextTable, report::csv_line, report::exact, report::fixed, report::list_json,
    report::percent;

/// One quantity of a pair of gears: its key in JSON and CSV.
struct FeltNumber {
  const char* key;
  const char* unit;
  double (*value)(const FeltGears&);
};
constexpr std::array<FeltNumber, 8> kFeltNumbers{{
    {"eta_f", "", [](const FeltGears& g) { return g.forward; }},
    {"eta_b", "", [](const FeltGears& g) { return g.backward; }},
    {"inertia_plain_kgm2", "kg m2", [](const FeltGears& g) { return g.plain_kgm2; }},
    {"inertia_speeding_up_kgm2", "kg m2", [](const FeltGears& g) { return g.speeding_up_kgm2; }},
    {"inertia_slowing_down_kgm2", "kg m2", [](const FeltGears& g) { return g.slowing_down_kgm2; }},
    {"spring_pushed_in", "", [](const FeltGears& g) { return g.pushed_in(); }},
    {"spring_let_out", "", [](const FeltGears& g) { return g.let_out(); }},
    {"transparency", "", [](const FeltGears& g) { return g.transparency; }},
}};

const char* flow_name(const MotionRow& row) {
  if (row.mode.phase == Phase::kStick) return "stick";
  return row.mode.flow > 0 ? "forward" : "backward";
}

std::string held_csv(const DirectionalBench& bench) {
  std::string text =
      "# Directional-impedance thesis: torque at the output while the motor holds a torque, "
      "moving\n"
      "# with it and pushed back (docs/theory, section 59); losses of its Table 3.1.\n"
      "pinion,gear,motor_nm,moving_with_nm,pushed_back_nm\n";
  for (const HeldTorque& h : bench.held) {
    text += csv_line({fmt::to_string(h.pinion), fmt::to_string(h.gear), exact(h.motor_Nm),
                      exact(h.moving_with_Nm), exact(h.pushed_back_Nm)});
  }
  return text;
}

std::string felt_csv(const DirectionalBench& bench) {
  std::string text =
      "# Directional-impedance thesis: what is felt at the output with each pair of its Table 3.1\n"
      "# measured both ways, the pinion on the motor's shaft (examples/actuators/\n"
      "# directional_bench.toml).  Springs over the stiffness that the motor plays.\n"
      "pinion,gear,ratio";
  for (const FeltNumber& n : kFeltNumbers) text += fmt::format(",{}", n.key);
  text += '\n';
  for (const FeltGears& g : bench.felt) {
    std::vector<std::string> fields{fmt::to_string(g.pinion), fmt::to_string(g.gear),
                                    exact(g.ratio())};
    for (const FeltNumber& n : kFeltNumbers) fields.push_back(exact(n.value(g)));
    text += csv_line(fields);
  }
  return text;
}

std::string load_csv(const DirectionalBench& bench) {
  std::string text =
      "# Directional-impedance thesis, section 3.2: constant speed under a load that rises, which\n"
      "# then drives; examples/actuators/directional_bench_load.toml, simulated.\n"
      "time_s,speed_rad_s,flow,motor_nm_times_ratio,load_nm\n";
  for (const MotionRow& row : bench.load.rows) {
    text += csv_line({exact(row.time_s), exact(row.sides.output_rad_s), flow_name(row),
                      exact(row.outside.reflected_Nm), exact(row.outside.load_Nm)});
  }
  return text;
}

std::string braking_csv(const DirectionalBench& bench) {
  std::string text =
      "# Directional-impedance thesis, sections 2.2 and 4.1: a load sped up and braked, with the\n"
      "# efficiency of either direction and with the mean of both for both;\n"
      "# examples/actuators/directional_bench_braking.toml, simulated.\n"
      "efficiency,time_s,speed_rad_s,flow,motor_nm_times_ratio,mesh_nm\n";
  const auto add = [&](const char* name, const motion::Motion& motion) {
    for (const MotionRow& row : motion.rows) {
      text += csv_line({name, exact(row.time_s), exact(row.sides.output_rad_s), flow_name(row),
                        exact(row.outside.reflected_Nm), exact(report::or_nan(row.mesh_Nm))});
    }
  };
  add("directional", bench.braking.directional);
  add("fixed", bench.braking.fixed);
  return text;
}

double row_value(const DirectionalBench& bench, const char* start) {
  const auto row = std::ranges::find_if(
      bench.rows, [&](const ComparedRow& r) { return r.quantity.starts_with(start); });
  return report::or_nan(row->exact);
}

}  // namespace

std::string directional_bench_table(const DirectionalBench& bench) {
  std::string text = "  Its bench as an actuator, 16 teeth on the motor and 100 at the output\n";
  TextTable rows({"quantity", "thesis", "its equations", "simulated", "unit"});
  rows.align_left(4);
  for (const ComparedRow& row : bench.rows) {
    rows.add({row.quantity, shown(row.paper, row.decimals), shown(row.equations, row.decimals),
              shown(row.exact, row.decimals), row.unit});
  }
  text += rows.text(4);
  text +=
      "  What is felt at its output with each pair measured both ways: inertia in 1e-6 kg m2, a "
      "virtual\n  spring over its stiffness, width over mean of the torque felt while the motor "
      "holds 0.05 N m\n";
  TextTable felt({"gears", "eta_f", "eta_b", "inertia, plain", "sped up", "slowed",
                  "spring pushed in", "let out", "transparency"});
  for (const FeltGears& g : bench.felt) {
    constexpr double kMicro = 1e6;
    felt.add({fmt::format("{}/{}", g.gear, g.pinion), fixed(g.forward, 3), fixed(g.backward, 3),
              fixed(kMicro * g.plain_kgm2, 1), fixed(kMicro * g.speeding_up_kgm2, 1),
              fixed(kMicro * g.slowing_down_kgm2, 1), fixed(g.pushed_in(), 3),
              fixed(g.let_out(), 3), fixed(g.transparency, 3)});
  }
  return text + felt.text(4);
}

io::Json directional_bench_json(const DirectionalBench& bench) {
  return {{"rows", list_json(bench.rows,
                             [](const ComparedRow& r) {
                               return io::Json{{"quantity", r.quantity},
                                               {"unit", r.unit},
                                               {"thesis", r.paper},
                                               {"equations", r.equations},
                                               {"simulated", r.exact}};
                             })},
          {"felt", list_json(bench.felt,
                             [](const FeltGears& g) {
                               io::Json json{{"pinion", g.pinion}, {"gear", g.gear}};
                               for (const FeltNumber& n : kFeltNumbers) json[n.key] = n.value(g);
                               return json;
                             })},
          {"braking",
           {{"backward_share", bench.braking.backward_share},
            {"backward_while_motor_gives_share", bench.braking.opposite_share},
            {"fixed_efficiency_speed_error", bench.braking.speed_error}}},
          {"even_face_width_m", bench.even_width_m}};
}

std::string directional_bench_csv(const DirectionalBench& bench, const char* item) {
  std::string text;
  for (const ComparedRow& row : bench.rows) {
    text += row_fields(item, row).csv_values();
  }
  for (const FeltGears& g : bench.felt) {
    for (const FeltNumber& n : kFeltNumbers) {
      text += reproduce_line({item, fmt::format("{}/{}: {}", g.gear, g.pinion, n.key), n.unit, "",
                              "", exact(n.value(g)), ""});
    }
  }
  return text;
}

std::string directional_figures_table(const DirectionalBench& bench) {
  const auto width = [](const FeltGears& g) { return g.transparency; };
  const auto [clear, dull] = std::ranges::minmax_element(bench.felt, {}, width);
  const auto name = [](const FeltGears& g) { return fmt::format("{}/{}", g.gear, g.pinion); };
  return figures_text(
      "directional-impedance thesis",
      {{.figure = "directional_felt",
        .paper = "reflected inertia goes with the ratio's square; gear friction adds to it when "
                 "driven back",
        .ours = {fmt::format("{} pairs: sped up from outside {} to {} times the plain inertia",
                             bench.felt.size(),
                             fixed(clear->speeding_up_kgm2 / clear->plain_kgm2, 3),
                             fixed(dull->speeding_up_kgm2 / dull->plain_kgm2, 3))}},
       {.figure = "directional_transparency",
        .paper = "high impedance \"reduces the force transparency\"; no value",
        .ours = {fmt::format("width over mean {} ({}) to {} ({}) at any torque of the motor",
                             fixed(clear->transparency, 3), name(*clear),
                             fixed(dull->transparency, 3), name(*dull))}},
       {.figure = "directional_bench",
        .paper = "the loss is the slope of the torques at constant speed, 500 teeth a second",
        .ours = {fmt::format("simulated: {} and {}, speed within {} %",
                             fixed(row_value(bench, "loss of 16"), 4),
                             fixed(row_value(bench, "loss of 100"), 4),
                             fixed(percent(row_value(bench, "teeth a second, most") /
                                               row_value(bench, "teeth a second, least") -
                                           1.0),
                                   2))}},
       {.figure = "directional_braking",
        .paper = "one efficiency for all conditions \"can result in significant error\"",
        .ours = {fmt::format("rms difference of speeds {} %, flow backward {} % of the time",
                             fixed(percent(bench.braking.speed_error), 1),
                             fixed(percent(bench.braking.backward_share), 1))}}});
}

std::vector<FigureData> directional_figure_data(const DirectionalBench& bench) {
  return {{.name = kDirectionalFigures[0], .csv = felt_csv(bench)},
          {.name = kDirectionalFigures[1], .csv = held_csv(bench)},
          {.name = kDirectionalFigures[2], .csv = load_csv(bench)},
          {.name = kDirectionalFigures[3], .csv = braking_csv(bench)}};
}

}  // namespace gear3k::papers
