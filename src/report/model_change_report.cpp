#include "report/model_change_report.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "report/display.hpp"
#include "report/text_table.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::report {

namespace {

using optimize::ObjectiveRecord;

io::Json interval_json(const std::optional<std::array<double, 2>>& interval, double per_unit) {
  if (!interval) return nullptr;
  return {(*interval)[0] / per_unit, (*interval)[1] / per_unit};
}

/// `key`: value, `key`_ci90: [low, high].
void add_estimate(io::Json& json, const std::string& key,
                  const std::optional<ModelEstimate>& estimate, double per_unit) {
  json[key] = estimate ? io::Json(estimate->value / per_unit) : nullptr;
  json[key + "_ci90"] = estimate ? interval_json(estimate->ci90, per_unit) : nullptr;
}

io::Json design_json(const JudgedDesign& design, const ObjectiveRecord& record) {
  io::Json json{{"teeth", train::teeth_of(design.teeth)}, {"planets", design.planets}};
  add_estimate(json, "objective", design.objective, record.per_unit);
  add_estimate(json, "eta_b_model", design.eta_b, 1.0);
  add_estimate(json, "eta_f_model", design.eta_f, 1.0);
  add_estimate(json, "measured_arcmin", design.lost_motion_rad, 1.0 / arcmin(1.0));
  json["keeps_lost_motion_limits"] = design.keeps_lost_motion_limits;
  return json;
}

/// "81.234 % [81.20, 81.26]"
std::string percent_text(const std::optional<ModelEstimate>& eta) {
  if (!eta) return "does not run";
  std::string text = fmt::format("{} %", fixed(percent(eta->value), 3));
  if (eta->ci90) {
    text += fmt::format(" [{}, {}]", fixed(percent((*eta->ci90)[0]), 3),
                        fixed(percent((*eta->ci90)[1]), 3));
  }
  return text;
}

/// The same in the unit of a quantity.
std::string number_text(const std::optional<ModelEstimate>& estimate, double per_unit,
                        std::string_view unit) {
  if (!estimate) return "-";
  std::string text = with_unit(fmt::format("{:.6g}", clean(estimate->value / per_unit)), unit);
  if (estimate->ci90) {
    text += fmt::format(" [{:.6g}, {:.6g}]", clean((*estimate->ci90)[0] / per_unit),
                        clean((*estimate->ci90)[1] / per_unit));
  }
  return text;
}

/// "+0.12 points"; signed, as more is not better by every objective.
std::string gain_text(const ModelChange& change, const ObjectiveRecord& record) {
  if (!change.gain) return "not known, as one of them does not run";
  const bool efficiency = optimize::is_efficiency(change.objective);
  const double per_unit = efficiency ? 0.01 : record.per_unit;
  const auto number = [&](double value) {
    return efficiency ? fmt::format("{:+.4f}", value / per_unit)
                      : fmt::format("{:+.6g}", clean(value / per_unit));
  };
  std::string text =
      with_unit(number(change.gain->value), efficiency ? "percentage points" : record.unit);
  if (change.gain->ci90) {
    text +=
        fmt::format(" [{}, {}]", number((*change.gain->ci90)[0]), number((*change.gain->ci90)[1]));
  }
  if (change.gain_by_parameters) {
    text +=
        fmt::format("; by the parameters alone [{}, {}]", number((*change.gain_by_parameters)[0]),
                    number((*change.gain_by_parameters)[1]));
  }
  return text;
}

/// What a reader should know of the gain.
std::string remarks(const ModelChange& change, const ObjectiveRecord& record) {
  std::string text;
  if (!change.before.keeps_lost_motion_limits) {
    text +=
        "  The design without the model does not keep the limits of lost motion with it: what they "
        "cost is part of the gain\n";
  }
  if (!change.same_design && change.gain) {
    const double better = (record.maximise ? 1.0 : -1.0) * change.gain->value;
    if (change.before.keeps_lost_motion_limits && better < 0.0) {
      text +=
          "  With the model the design without it is the better one: the refinement takes of a "
          "model level, side, approach and recess of friction only\n";
    } else if (better > 0.0 && change.gain->ci90 && (*change.gain->ci90)[0] <= 0.0 &&
               (*change.gain->ci90)[1] >= 0.0) {
      text += "  The interval holds 0: the measurements do not tell which design is better\n";
    }
  }
  if (!change.no_intervals.empty()) {
    text += fmt::format("  No intervals: {}\n", change.no_intervals);
  } else {
    text +=
        "  [ ]: 90 % interval of what the model's parameters, and on the new design the law of its "
        "friction, may be; the causes taken as the right ones\n";
  }
  return text;
}

}  // namespace

std::string model_change_table(const ModelComparison& comparison) {
  const std::string title = "\nWhat the model changes";
  if (!comparison.change) return fmt::format("{}: not known, {}\n", title, comparison.missing);
  const ModelChange& c = *comparison.change;
  const ObjectiveRecord& record = optimize::objective_record(c.objective);
  std::string text = fmt::format(
      "{}: the best designs of optimisation without and with it, both with the model{}\n", title,
      c.point ? fmt::format(" at {:.6g} rpm, {:.6g} N m, {:.4g} C", rpm(c.point->sun_speed_rad_s),
                            clean(c.point->output_torque_Nm), celsius(c.point->temperature_K))
              : std::string(", by the meshes alone"));
  TextTable table({"", "without", "with the model"});
  const auto row = [&](const char* name, auto cell) {
    table.add({name, cell(c.before), cell(c.after)});
  };
  row("S/P1/R1/P2/R2", [](const JudgedDesign& d) { return teeth_text(d.teeth); });
  if (c.before.planets != c.after.planets) {
    row("planets", [](const JudgedDesign& d) { return fmt::format("{}", d.planets); });
  }
  row("eta backward", [](const JudgedDesign& d) { return percent_text(d.eta_b); });
  row("eta forward", [](const JudgedDesign& d) { return percent_text(d.eta_f); });
  if (c.before.lost_motion_rad || c.after.lost_motion_rad) {
    row("measured lost motion", [](const JudgedDesign& d) {
      return number_text(d.lost_motion_rad, 1.0 / arcmin(1.0), "arcmin");
    });
  }
  if (!optimize::is_efficiency(c.objective)) {
    row(record.title.data(), [&](const JudgedDesign& d) {
      return number_text(d.objective, record.per_unit, record.unit);
    });
  }
  text += table.text(2);
  text += c.same_design ? fmt::format("  The model does not change the best design: gain 0 in {}\n",
                                      record.title)
                        : fmt::format("  Gain in {}: {}\n", record.title, gain_text(c, record));
  return text + remarks(c, record);
}

io::Json model_change_json(const ModelComparison& comparison) {
  if (!comparison.change) return nullptr;
  const ModelChange& c = *comparison.change;
  const ObjectiveRecord& record = optimize::objective_record(c.objective);
  io::Json gain{{"value", c.gain ? io::Json(c.gain->value / record.per_unit) : nullptr},
                {"ci90", c.gain ? interval_json(c.gain->ci90, record.per_unit) : nullptr},
                {"ci90_parameters", interval_json(c.gain_by_parameters, record.per_unit)}};
  io::Json point = nullptr;
  if (c.point) {
    point = {{"sun_speed_rpm", rpm(c.point->sun_speed_rad_s)},
             {"output_torque_nm", clean(c.point->output_torque_Nm)},
             {"temperature_c", celsius(c.point->temperature_K)}};
  }
  return {{"objective", record.name},
          {"unit", record.unit},
          {"operating_point", std::move(point)},
          {"before", design_json(c.before, record)},
          {"after", design_json(c.after, record)},
          {"gain", std::move(gain)},
          {"same_design", c.same_design},
          {"draws", c.draws},
          {"seed", c.seed},
          {"no_intervals", c.no_intervals.empty() ? io::Json(nullptr) : io::Json(c.no_intervals)}};
}

}  // namespace gear3k::report
