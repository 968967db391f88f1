#include "papers/backdrivability_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "papers/report_parts.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::papers {

namespace {

using report::TextTable, report::exact, report::fixed, report::list_json;

constexpr const char* kBackdrivability = "backdrivability-factors paper";

std::string exponents_text(const ScalingLaw& law, std::optional<double> ScalingFactor::*part) {
  std::string text;
  for (const ScalingFactor& f : law.factors) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", shown(f.*part, 2));
  }
  return text;
}

std::string laws_table(const std::vector<ScalingLaw>& laws) {
  TextTable table({"quantity", "over", "table", "frames", "printed in", "paper", "corrected",
                   "fitted, 95 % band", "scatter"});
  for (const std::size_t column : {1U, 2U, 4U}) table.align_left(column);
  for (const ScalingLaw& law : laws) {
    std::string over;
    std::string fitted;
    for (const ScalingFactor& f : law.factors) {
      over += (over.empty() ? "" : ", ") + f.name;
      fitted += fmt::format("{}{} +-{}", fitted.empty() ? "" : ", ", fixed(f.exponent, 2),
                            fixed(f.band, 2));
    }
    table.add({law.quantity, over, law.data, fmt::format("{}", law.frames), law.source,
               exponents_text(law, &ScalingFactor::paper),
               exponents_text(law, &ScalingFactor::equations), fitted,
               "x" + fixed(std::exp(law.scatter), 2)});
  }
  return table.text(2);
}

double lost_energy(const actuator::DutyCycle& duty, const char* cause) {
  for (const actuator::LossEnergy& loss : duty.losses) {
    if (loss.cause == cause) return loss.energy_J;
  }
  return std::nan("");
}

std::vector<KneeRun> all_runs(const KneeExample& knee) {
  std::vector<KneeRun> runs = knee.runs;
  if (knee.raised) runs.push_back(*knee.raised);
  return runs;
}

/// What the corrected actuator would save without each cause, largest first.
std::string saved_text(const KneeExample& knee) {
  std::vector<actuator::WithoutCause> causes = knee.without_each;
  std::ranges::stable_sort(causes, std::ranges::greater(), &actuator::WithoutCause::saved_J);
  std::string text;
  for (const actuator::WithoutCause& w : causes) {
    if (!(w.saved_J > 0.0)) continue;
    text += fmt::format("{}{} {} J", text.empty() ? "" : ", ", w.cause, fixed(w.saved_J, 1));
  }
  return fmt::format("    saved without one cause, corrected: {}\n", text);
}

std::string knee_table(const KneeExample& knee) {
  if (knee.runs.empty()) return {};
  TextTable table({"numbers", "drawn", "regenerated", "copper", "gear drag", "mesh", "motor drag",
                   "peak", "least", "backdriven", "regenerating"});
  for (const KneeRun& run : all_runs(knee)) {
    const actuator::DutyCycle& d = run.duty;
    const auto share = [&](double actuator::NegativeShares::*part) {
      return d.shares ? fixed(report::percent(*d.shares.*part), 1) + " %" : std::string("-");
    };
    table.add({run.name, fixed(d.drawn_J, 2), fixed(d.regenerated_J, 2),
               fixed(lost_energy(d, "copper"), 2),
               fixed(lost_energy(d, "gear_coulomb") + lost_energy(d, "gear_viscous"), 2),
               fixed(lost_energy(d, "mesh"), 2), fixed(lost_energy(d, "motor_viscous"), 2),
               fixed(run.peak_electrical_W, 1), fixed(run.least_electrical_W, 1),
               share(&actuator::NegativeShares::backdriven),
               share(&actuator::NegativeShares::regenerating)});
  }
  const actuator::DutyCycle& d = knee.runs.front().duty;
  return fmt::format(
             "  Its knee actuator over a stride of {:g} s (J; electrical power in W; shares of "
             "what the load gives back)\n  the knee: {} N m, {} to {} W; its load takes {} J and "
             "gives back {} J\n",
             d.period_s, fixed(knee.peak_torque_Nm, 1), fixed(knee.least_power_W, 1),
             fixed(knee.peak_power_W, 1), fixed(d.positive_J, 2), fixed(d.negative_J, 2)) +
         table.text(4) + saved_text(knee);
}

io::Json run_json(const KneeRun& run) {
  const actuator::DutyCycle& d = run.duty;
  io::Json losses;
  for (const actuator::LossEnergy& loss : d.losses) losses[loss.cause] = loss.energy_J;
  io::Json json{{"name", run.name},
                {"drawn_j", d.drawn_J},
                {"regenerated_j", d.regenerated_J},
                {"positive_j", d.positive_J},
                {"negative_j", d.negative_J},
                {"losses_j", std::move(losses)},
                {"kinetic_j", d.kinetic_J},
                {"balance_error", d.balance_error},
                {"rms_current_a", d.rms_current_A},
                {"peak_electrical_w", run.peak_electrical_W},
                {"least_electrical_w", run.least_electrical_W}};
  if (d.shares) {
    json["backdrivable_fraction_of_negative_power"] = d.shares->backdriven;
    json["motor_braking_fraction"] = d.shares->motor_braking;
    json["regenerating_fraction"] = d.shares->regenerating;
  }
  return json;
}

io::Json knee_json(const KneeExample& knee) {
  if (knee.runs.empty()) return nullptr;
  return {{"stride_s", knee.cycle.time_s.back()},
          {"peak_torque_nm", knee.peak_torque_Nm},
          {"peak_power_w", knee.peak_power_W},
          {"least_power_w", knee.least_power_W},
          {"runs", list_json(all_runs(knee), run_json)},
          {"negative_power", list_json(knee.negative,
                                       [](const NegativeStretch& s) {
                                         return io::Json{
                                             {"from_s", s.from_s},
                                             {"to_s", s.to_s},
                                             {"begins_at_zero_torque", s.begins_at_zero_torque},
                                             {"ends_at_zero_torque", s.ends_at_zero_torque},
                                             {"peak_torque_nm", s.peak_torque_Nm},
                                             {"energy_j", s.energy_J}};
                                       })},
          {"without_each", list_json(knee.without_each, [](const actuator::WithoutCause& w) {
             return io::Json{{"cause", w.cause},
                             {"drawn_j", w.drawn_J},
                             {"regenerated_j", w.regenerated_J},
                             {"saved_j", w.saved_J}};
           })}};
}

io::Json law_json(const ScalingLaw& law) {
  return {{"name", law.name},
          {"quantity", law.quantity},
          {"source", law.source},
          {"table", law.data},
          {"frames", law.frames},
          {"rows", law.points.size()},
          {"series", law.series.size()},
          {"factors", list_json(law.factors,
                                [](const ScalingFactor& f) {
                                  return io::Json{{"name", f.name},
                                                  {"paper", f.paper},
                                                  {"corrected", f.equations},
                                                  {"exponent", f.exponent},
                                                  {"band", f.band}};
                                })},
          {"scatter", law.scatter}};
}

}  // namespace

std::string backdrivability_table(const BackdrivabilityComparison& c) {
  std::string text = fmt::format("\n{}: its knee actuator, eqs. 37 to 45\n", kBackdrivability);
  TextTable table({"quantity", "paper", "its equations", "corrected", "unit"});
  table.align_left(4);
  for (const ComparedRow& row : c.rows) {
    table.add({row.quantity, shown(row.paper, row.decimals), shown(row.equations, row.decimals),
               shown(row.exact, row.decimals), row.unit});
  }
  text += table.text(2);
  text += "\n  Scaling laws: exponents, and scatter about the law\n" + laws_table(c.laws);
  text += '\n' + knee_table(c.knee);
  text += fmt::format("\nLedger of errata: {}\n", kBackdrivability);
  return text + ledger_text(c.ledger, "paper");
}

io::Json backdrivability_json(const BackdrivabilityComparison& c) {
  return {{"rows", list_json(c.rows,
                             [](const ComparedRow& row) {
                               return row_fields(kBackdrivability, row).json();
                             })},
          {"scaling_laws", list_json(c.laws, law_json)},
          {"knee", knee_json(c.knee)},
          {"ledger", ledger_json(c.ledger)}};
}

std::string backdrivability_csv(const BackdrivabilityComparison& c) {
  std::string text;
  for (const ComparedRow& row : c.rows) text += row_fields(kBackdrivability, row).csv_values();
  for (const ScalingLaw& law : c.laws) {
    for (const ScalingFactor& f : law.factors) {
      const auto line = [&](const char* what, const ComparedRow& values) {
        ComparedRow row = values;
        row.quantity = fmt::format("{}: {} {}", law.name, what, f.name);
        text += row_fields(kBackdrivability, row).csv_values();
      };
      line("exponent of", {.quantity = {},
                           .unit = {},
                           .paper = f.paper,
                           .equations = {},
                           .exact = f.equations,
                           .measured = f.exponent});
      line("95 % band of", {.quantity = {},
                            .unit = {},
                            .paper = {},
                            .equations = {},
                            .exact = {},
                            .measured = f.band});
    }
  }
  for (const KneeRun& run : all_runs(c.knee)) {
    const auto line = [&](const std::string& what, const char* unit, double value) {
      text += reproduce_line({kBackdrivability, fmt::format("knee, {}: {}", run.name, what), unit,
                              "", "", exact(value), ""});
    };
    line("drawn", "J", run.duty.drawn_J);
    line("regenerated", "J", run.duty.regenerated_J);
    for (const actuator::LossEnergy& loss : run.duty.losses) line(loss.cause, "J", loss.energy_J);
    line("peak electrical power", "W", run.peak_electrical_W);
    line("least electrical power", "W", run.least_electrical_W);
  }
  return text + ledger_csv(c.ledger, "backdrivability ledger");
}

}  // namespace gear3k::papers
