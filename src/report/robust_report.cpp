#include "report/robust_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/text/json.hpp"
#include "report/display.hpp"
#include "report/result_tally.hpp"
#include "report/text_table.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::report {

namespace {

using design::CheckId;
using optimize::BuiltOutcome, optimize::Hold, optimize::RobustPass, optimize::Specification;

std::string limit_text(const std::optional<double>& limit, double (*unit)(double)) {
  return limit ? fmt::format("{:.2f}", unit(*limit)) : "-";
}

io::Json turn_json(const backlash::TurnYield& turn) {
  return {{"gearboxes", turn.gearboxes},
          {"assembled", turn.assembled.value},
          {"yield", turn.yield.value}};
}

io::Json outcome_json(const BuiltOutcome& o) {
  return {{"yield", o.yield},
          {"jammed", o.jammed},
          {"beyond_limit", o.beyond_limit},
          {"limit_of_99_percent_arcmin", if_any(o.limit_of_99_percent_rad, arcmin)},
          {"worst_case_arcmin", arcmin(o.greatest_rad)},
          {"least_margin_um", um(o.least_margin_m)},
          {"checks_hold", o.checks_hold}};
}

std::size_t grid_cut_of(const optimize::RobustResult& search) {
  std::size_t sets = 0;
  for (const RobustPass& pass : search.passes) sets += pass.grid_cut;
  return sets;
}

/// A tolerance as files state it.
struct StatedTolerance {
  double value = 0.0;
  const char* unit = "um";
  bool both_ways = false;  ///< half the distance of two limits
};

StatedTolerance stated_tolerance(const backlash::ToleranceSource& source,
                                 const backlash::Tolerances& tolerances) {
  using enum backlash::ToleranceKind;
  const auto gear = static_cast<std::size_t>(std::max(source.gear, 0));
  const backlash::GearTolerances& g = tolerances.gears[gear];
  const auto limits = [](const backlash::DeviationLimits& l) {
    return StatedTolerance{.value = clean(um(l.half_width())), .both_ways = true};
  };
  const auto width = [](double m) { return StatedTolerance{.value = clean(um(m))}; };
  switch (source.kind) {
    case kCenterDistance:
      return limits(tolerances.center_distance_m);
    case kToothThickness:
      return limits(g.tooth_thickness_m);
    case kPinPosition:
      return width(tolerances.pin_position_m);
    case kPlanetPhase:
      return {.value = clean(arcmin(tolerances.planet_phase_rad.half_width())),
              .unit = "arcmin",
              .both_ways = true};
    case kRunout:
      return width(g.runout_m);
    case kCumulativePitch:
      return width(g.cumulative_pitch_m);
    case kSinglePitch:
      break;
  }
  return width(g.single_pitch_m);
}

}  // namespace

std::string robust_table(const Specification& spec, const RobustRun& run) {
  const RobustPass& nominal = run.search.passes.front();
  const RobustPass& chosen = run.search.passes[*run.search.chosen];
  TextTable table({"limits", "teeth", "eta_b %", "eta_f %", "lost motion arcmin",
                   "least j um asked", "most arcmin asked", "99 % keep arcmin", "yield %", "jam %",
                   "beyond limit %", "worst case arcmin", "room there um"});
  const auto add = [&](const std::string& name, const RobustPass& pass, const BuiltOutcome& o) {
    table.add({name, teeth_text(pass.best->candidate.teeth),
               fmt::format("{:.2f}", percent(pass.best->eta_b)),
               fmt::format("{:.2f}", percent(pass.best->eta_f)),
               fmt::format("{:.2f}", arcmin(pass.best->lost_motion_rad)),
               limit_text(pass.limits[CheckId::kNormalBacklash], um),
               limit_text(pass.limits[CheckId::kOutputBacklashMax], arcmin),
               limit_text(o.limit_of_99_percent_rad, arcmin),
               fmt::format("{:.3f}", percent(o.yield)), fmt::format("{:.3f}", percent(o.jammed)),
               fmt::format("{:.3f}", percent(o.beyond_limit)),
               fmt::format("{:.2f}", arcmin(o.greatest_rad)),
               fmt::format("{:.1f}", um(o.least_margin_m))});
  };
  add("as stated", nominal, run.nominal);
  add(spec.robust.hold == Hold::kWorstCase ? "hold in the worst case" : "hold for the yield",
      chosen, run.chosen);
  std::string text = fmt::format(
      "\nLimits that hold for the built gearboxes at one position of the turn ({} searches; {} "
      "gearboxes each from seed {}, which no search used)\n",
      run.search.passes.size(), run.samples, run.fresh_seed);
  text += table.text(2);
  text += grid_cuts_text(spec, grid_cut_of(run.search));
  text += fmt::format(
      "  at every position of a turn, {} gearboxes: {:.1f} % and {:.1f} % assemble, {:.1f} % and "
      "{:.1f} % also keep the limit\n",
      run.nominal_turn.gearboxes, percent(run.nominal_turn.assembled.value),
      percent(run.chosen_turn.assembled.value), percent(run.nominal_turn.yield.value),
      percent(run.chosen_turn.yield.value));
  if (!run.cheapest) return text;
  const auto& c = run.cheapest->tolerances;
  text += fmt::format(
      "\nCheapest tolerances for a yield of {:g} %: cost {:.2f} instead of {:.2f}, yield {:.3f} % "
      "instead of {:.3f} % ({:.3f} % from the fresh seed){}\n",
      clean(percent(spec.robust.yield)), c.cost, c.stated_cost, percent(c.yield),
      percent(c.stated_yield), percent(run.cheapest->built.yield),
      c.reached ? "" : "; the yield is not reached");
  text += fmt::format(
      "  best.toml has them; at every position of a turn {:.1f} % assemble, {:.1f} % also keep the "
      "limit\n",
      percent(run.cheapest->turn.assembled.value), percent(run.cheapest->turn.yield.value));
  TextTable tolerances({"tolerance", "stated", "cheapest", "unit", "factor"});
  for (std::size_t i = 0; i < c.factor.size(); ++i) {
    const backlash::ToleranceSource& source = run.cheapest->model.sources[i];
    const auto cell = [&](const backlash::Tolerances& of) {
      const StatedTolerance t = stated_tolerance(source, of);
      return fmt::format("{}{:.2f}", t.both_ways ? "+-" : "", t.value);
    };
    tolerances.add({source.name(), cell(run.cheapest->stated), cell(run.cheapest->chosen),
                    stated_tolerance(source, run.cheapest->stated).unit,
                    fmt::format("{:.3f}", c.factor[i])});
  }
  return text + tolerances.text(2);
}

io::Json robust_json(const Specification& spec, const RobustRun& run) {
  io::Json passes = io::Json::array();
  for (const RobustPass& pass : run.search.passes) {
    passes.push_back(
        {{"share", pass.share},
         {"min_normal_um", if_any(pass.limits[CheckId::kNormalBacklash], um)},
         {"max_output_arcmin", if_any(pass.limits[CheckId::kOutputBacklashMax], arcmin)},
         {"teeth", pass.best ? io::Json(train::teeth_of(pass.best->candidate.teeth)) : nullptr},
         {"eta_b", pass.best ? io::Json(pass.best->eta_b) : nullptr},
         {"grid_cut", pass.grid_cut},
         {"built", pass.outcome ? outcome_json(*pass.outcome) : nullptr}});
  }
  io::Json json{{"hold", optimize::kHoldNames[static_cast<std::size_t>(spec.robust.hold)]},
                {"yield", spec.robust.yield},
                {"passes", passes},
                {"chosen", run.search.chosen},
                {"samples", run.samples},
                {"fresh_seed", run.fresh_seed},
                {"nominal", outcome_json(run.nominal)},
                {"nominal_turn", turn_json(run.nominal_turn)},
                {"robust_turn", turn_json(run.chosen_turn)},
                {"robust", outcome_json(run.chosen)},
                {"cheapest", nullptr}};
  if (run.cheapest) {
    const auto& c = run.cheapest->tolerances;
    io::Json sources = io::Json::array();
    for (std::size_t i = 0; i < c.factor.size(); ++i) {
      const backlash::ToleranceSource& source = run.cheapest->model.sources[i];
      const StatedTolerance stated = stated_tolerance(source, run.cheapest->stated);
      const bool length = source.kind != backlash::ToleranceKind::kPlanetPhase;
      sources.push_back({{"tolerance", source.name()},
                         {"unit", stated.unit},
                         {"stated", stated.value},
                         {"cheapest", stated_tolerance(source, run.cheapest->chosen).value},
                         {"stated_um", length ? stated.value : um(source.half_width_m)},
                         {"half_width_um", um(source.half_width_m)},
                         {"factor", c.factor[i]}});
    }
    json["cheapest"] = {{"reached", c.reached},
                        {"stated_cost", c.stated_cost},
                        {"cost", c.cost},
                        {"stated_yield", c.stated_yield},
                        {"yield", c.yield},
                        {"fresh", outcome_json(run.cheapest->built)},
                        {"turn", turn_json(run.cheapest->turn)},
                        {"tolerances", sources}};
  }
  return json;
}

std::string robust_blocking_text(const Specification& spec, const optimize::RobustResult& search) {
  const BuiltOutcome* best = nullptr;
  bool any_infeasible = false;
  for (const RobustPass& pass : search.passes) {
    any_infeasible = any_infeasible || !pass.best;
    if (pass.outcome && (best == nullptr || pass.outcome->yield > best->yield)) {
      best = &*pass.outcome;
    }
  }
  if (!search.passes.front().best) return "no feasible design was found with the limits as stated";
  const std::string reached =
      best == nullptr
          ? std::string(
                "at an end of tolerances.center_distance_um a mesh of the best that was "
                "found has no working pressure angle")
          : fmt::format(
                "the best that was found yields {:.2f} % ({:.2f} % jam, {:.2f} % beyond the "
                "limit), worst case {:.2f} arcmin{}",
                percent(best->yield), percent(best->jammed), percent(best->beyond_limit),
                arcmin(best->greatest_rad),
                best->least_margin_m < 0.0
                    ? fmt::format(" and {:.1f} um short of assembling", -um(best->least_margin_m))
                    : "");
  const std::string asked =
      spec.robust.hold == Hold::kWorstCase
          ? std::string("in the worst case of its tolerances")
          : fmt::format("for a yield of {:g} %", clean(percent(spec.robust.yield)));
  return fmt::format(
      "no design was found that holds {}: {}{}{}; wider limits or tighter [tolerances] would help "
      "(`gear3k tolerances` on a design shows which)",
      asked, reached, any_infeasible ? "; under limits tighter than that nothing is feasible" : "",
      grid_cuts_text(spec, grid_cut_of(search), {.before = "; ", .after = ""}));
}

}  // namespace gear3k::report
