#include "report/limit_price_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "optimize/objective_value.hpp"
#include "report/certificate_report.hpp"
#include "report/display.hpp"
#include "report/first_screen.hpp"
#include "report/limits_report.hpp"
#include "report/text_table.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::report {

namespace {

using optimize::dearest, optimize::giving_step;
using optimize::LimitPrice, optimize::ObjectiveRecord, optimize::Specification;

const ObjectiveRecord& record_of(const Specification& spec) {
  return optimize::objective_record(optimize::first_objective(spec));
}

/// A price in the units of files: the objective's over the key's.
double per_unit(const Specification& spec, const LimitPrice& price, double per_si) {
  return per_si * units::si_per(price.unit) / record_of(spec).per_unit;
}

/// What the objective gains where the limit gives way by its step, in the objective's unit; with
/// its sense: negative where less is better.
double change_per_step(const Specification& spec, const LimitPrice& price) {
  return per_unit(spec, price, price.loosened) * giving_step(price);
}

/// The same of the set refined anew with it; its gain must be known.
double refined_gain(const Specification& spec, const LimitPrice& price) {
  return *price.refined_gain_si / record_of(spec).per_unit;
}

bool in_percent_points(const Specification& spec) {
  return optimize::is_efficiency(optimize::first_objective(spec));
}

/// A change of the objective as tables show it.
std::string change_text(const Specification& spec, double change) {
  if (in_percent_points(spec)) return fmt::format("{:+.3g} % points", 100.0 * change);
  return with_unit(fmt::format("{:+.4g}", change), record_of(spec).unit);
}

std::string value_text(const LimitPrice& price) {
  return with_unit(fmt::format("{:g}", units::decimal_from_si(price.value_si, price.unit)),
                   units::unit_name(price.unit));
}

std::string price_text(const Specification& spec, const LimitPrice& price) {
  const auto number = [&](double per_si) {
    const double value = per_unit(spec, price, per_si);
    return in_percent_points(spec) ? fmt::format("{:+.3g} %", 100.0 * value)
                                   : with_unit(fmt::format("{:+.3g}", value), record_of(spec).unit);
  };
  const std::string_view unit =
      units::unit_name(price.unit == units::Unit::kModules ? units::Unit::kModule : price.unit);
  const std::string per = unit.empty() ? "" : fmt::format(" per {}", unit);
  if (price.unique()) return number(price.loosened) + per;
  return fmt::format("{}{}, tightened {}", number(price.loosened), per,
                     price.tightened ? number(*price.tightened) : "nothing is left");
}

bool has_price(const LimitPrice& price) { return price.loosened != 0.0 || !price.unique(); }

/// The preset whose limit a price is of; "" where there is none.
std::string_view preset_of(const Specification& spec, const LimitPrice& price) {
  const auto& check = price.limit.check;
  if (price.limit.kind != optimize::LimitKind::kCheck || price.limit.place >= 0 || !check ||
      !is_of_preset(spec.limits, *check)) {
    return "";
  }
  return design::kPresetNames[static_cast<std::size_t>(*spec.limits.preset)];
}
std::string preset_text(const Specification& spec, const LimitPrice& price) {
  const std::string_view preset = preset_of(spec, price);
  return preset.empty() ? "" : fmt::format(" ({})", preset);
}

double objective_of(const Specification& spec, const HeldSet& best) {
  return optimize::objective_of(spec, best.set, optimize::first_objective(spec)) /
         record_of(spec).per_unit;
}

/// Whether an objective can have a value: an estimate to first order may leave what is possible.
bool is_possible(const Specification& spec, double value) {
  return in_percent_points(spec) ? value < 1.0 : value > 0.0;
}

std::string objective_text(const Specification& spec, double value) {
  if (in_percent_points(spec)) return fmt::format("{:.3f} %", 100.0 * value);
  return with_unit(fmt::format("{:.5g}", value), record_of(spec).unit);
}

/// The bounds of the search that the set sits at, each with what lies beyond it.
std::string bounds_text(const Specification& spec, const HeldSet& best) {
  std::string text;
  std::vector<std::string> untried;
  for (const optimize::SearchBound& bound : best.held.at) {
    const std::string at = fmt::format("{} ({:.4g})", bound.key, bound.value);
    if (!bound.wider) {
      untried.push_back(at);
      continue;
    }
    text += fmt::format("  at a bound of the search: {}, ", at);
    if (const auto& better = bound.wider->better) {
      const double change =
          objective_of(spec, {.set = *better, .held = {}}) - objective_of(spec, best);
      text += fmt::format("to {:.4g} there is {} with {} ({})\n", bound.wider->value,
                          teeth_text(better->candidate.teeth),
                          objective_text(spec, objective_of(spec, {.set = *better, .held = {}})),
                          change_text(spec, change));
    } else {
      text += fmt::format("to {:.4g} nothing is better\n", bound.wider->value);
    }
  }
  if (untried.empty()) return text;
  return text + fmt::format("  at a bound of the search, beyond which nothing was tried: {}\n",
                            fmt::join(untried, ", "));
}

/// What a bound of the search that gives way gains, the most of them; null: none gains.
const optimize::SearchBound* most_beyond(const Specification& spec, const HeldSet& best) {
  const optimize::SearchBound* most = nullptr;
  double gain = 0.0;
  const double sense = optimize::sense_of(optimize::first_objective(spec));
  for (const optimize::SearchBound& bound : best.held.at) {
    if (!bound.wider || !bound.wider->better) continue;
    const double own = sense * (objective_of(spec, {.set = *bound.wider->better, .held = {}}) -
                                objective_of(spec, best));
    if (most != nullptr && own <= gain) continue;
    most = &bound;
    gain = own;
  }
  return most;
}

/// What a search with the limit given way found.
std::string relaxed_text(const Specification& spec, const HeldSet& best) {
  const std::optional<optimize::RelaxedAnswer>& relaxed = best.held.relaxed;
  if (!relaxed) return "";
  const std::string_view what = relaxed->all_sets ? "all tooth sets searched again with it"
                                                  : "this tooth set refined again with it";
  if (!relaxed->better) return fmt::format("  {}: nothing better\n", what);
  const HeldSet better{.set = *relaxed->better, .held = {}};
  return fmt::format("  {}: {} has {} ({})\n", what, teeth_text(better.set.candidate.teeth),
                     objective_text(spec, objective_of(spec, better)),
                     change_text(spec, objective_of(spec, better) - objective_of(spec, best)));
}

std::string better_text(const Specification& spec, const HeldSet& best) {
  const LimitPrice* const price = dearest(best.held);
  if (price == nullptr) return "";
  const bool refined = price->refined_gain_si.has_value();
  const double change = refined ? refined_gain(spec, *price) : change_per_step(spec, *price);
  const double moved =
      clean(units::decimal_from_si(price->value_si, price->unit) + giving_step(*price));
  const double estimate = objective_of(spec, best) + change;
  std::string text =
      refined ? fmt::format("  nearest better: {} with {} = {:g} ({})\n",
                            objective_text(spec, estimate), price->key, moved,
                            change_text(spec, change))
      : is_possible(spec, estimate)
          ? fmt::format("  nearest better, an estimate to first order: {} with {} = {:g} ({})\n",
                        objective_text(spec, estimate), price->key, moved,
                        change_text(spec, change))
          : fmt::format(
                "  nearest better: with {} = {:g}; its price does not hold as far as that\n",
                price->key, moved);
  text += relaxed_text(spec, best);
  if (const optimize::SearchBound* const beyond = most_beyond(spec, best)) {
    const HeldSet better{.set = *beyond->wider->better, .held = {}};
    const double gain = objective_of(spec, better) - objective_of(spec, best);
    if (std::abs(gain) > std::abs(change)) {
      text += fmt::format("  more beyond a bound of the search: {} with {} to {:g} ({})\n",
                          objective_text(spec, objective_of(spec, better)), beyond->key,
                          beyond->wider->value, change_text(spec, gain));
    }
  }
  return text;
}

/// What the limit gives for its step: refined anew, or to first order.
std::string gain_text(const Specification& spec, const HeldSet& best, const LimitPrice& price) {
  if (price.refined_gain_si) return change_text(spec, refined_gain(spec, price));
  const double change = change_per_step(spec, price);
  return is_possible(spec, objective_of(spec, best) + change)
             ? change_text(spec, change) + " (first order)"
             : "-";
}

/// Whether no line of a text is longer.
bool fits(std::string_view text, std::size_t columns) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (end > columns) return false;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return true;
}

}  // namespace

std::string held_back_table(const Specification& spec, const HeldSet& best, std::size_t columns) {
  std::string text = fmt::format(
      "\nHeld back by (price: change of the {} per unit, first order; gain: refined anew with the "
      "step)\n",
      record_of(spec).title);
  if (!best.held.missing.empty()) {
    return text + fmt::format("  not known: {}\n", best.held.missing) + bounds_text(spec, best);
  }
  TextTable table({"limit", "value", "at", "price", "step", "gain"});
  for (const std::size_t column : {std::size_t{2}, std::size_t{3}}) table.align_left(column);
  std::vector<std::string> free;
  std::string lines;
  for (const LimitPrice& price : best.held.prices) {
    if (!has_price(price)) {
      free.push_back(price.key);
      continue;
    }
    const std::string key =
        price.key + (price.stated ? "" : " (no key)") + preset_text(spec, price);
    const std::string where = fmt::format("{}", fmt::join(price.where, ", "));
    const std::string step =
        with_unit(fmt::format("{:+g}", giving_step(price)), units::unit_name(price.unit));
    table.add({key, value_text(price), where, price_text(spec, price), step,
               gain_text(spec, best, price)});
    lines += fmt::format("  {} = {}{}{}\n    price {}, step {}, gain {}\n", key, value_text(price),
                         where.empty() ? "" : " at ", where, price_text(spec, price), step,
                         gain_text(spec, best, price));
  }
  const bool any = free.size() < best.held.prices.size();
  const std::string rows = table.text(2);
  text += !any                  ? "  no limit: the optimum is inside all of them\n"
          : fits(rows, columns) ? rows
                                : lines;
  const bool open = std::ranges::any_of(best.held.prices,
                                        [](const LimitPrice& price) { return !price.unique(); });
  if (open) {
    text +=
        "  limits bind that depend on each other there: their prices differ where they give way "
        "and where they are tightened\n";
  }
  if (!free.empty()) {
    text += fmt::format("  met exactly, at no price: {}\n", fmt::join(free, ", "));
  }
  if (best.held.interrupted) {
    text += "  interrupted: not all bounds of the search, and limits given way, were tried\n";
  }
  return text + bounds_text(spec, best) + better_text(spec, best);
}

namespace {

/// Numbers of planets of which no set was refined to a design.
std::vector<int> planets_left_out(const Specification& spec, const std::vector<HeldSet>& sets) {
  std::vector<int> left_out;
  for (const int planets : spec.planets) {
    const bool there = std::ranges::any_of(
        sets, [&](const HeldSet& set) { return set.set.candidate.planets == planets; });
    if (!there) left_out.push_back(planets);
  }
  return left_out;
}

/// What is proven of a number of planets; null where nothing is.
const optimize::Certificate* proof_of(const HeldBackReport& report, int planets) {
  const auto own =
      std::ranges::find(report.proofs, planets, &optimize::PlanetsCertificate::planets);
  return own == report.proofs.end() ? nullptr : &own->proof;
}

/// Why no best design of a number of planets is known.
struct NoBest {
  std::string_view name, text;
};

NoBest no_best(const HeldBackReport& report, int planets) {
  if (report.all_refined || proof_of(report, planets) != nullptr) {
    return {.name = "no_design", .text = "no design"};
  }
  if (report.interrupted) {
    return {.name = "interrupted", .text = "none was refined to a design before the run was ended"};
  }
  return {.name = "proof",
          .text =
              "not refined to a design, as the proof leaves out what cannot be the best of "
              "all; plain optimize tells their best, where there is one"};
}

/// Lines of the numbers of planets without a best design, those with the same reason together.
std::string without_best_text(const Specification& spec, const HeldBackReport& report,
                              std::size_t columns) {
  std::string text;
  const std::vector<int> left_out = planets_left_out(spec, report.by_planets);
  for (auto first = left_out.begin(); first != left_out.end();) {
    const NoBest reason = no_best(report, *first);
    const auto last = std::find_if(first, left_out.end(), [&](int planets) {
      return no_best(report, planets).name != reason.name;
    });
    text += broken(fmt::format("  {}: {}", fmt::join(first, last, ", "), reason.text),
                   static_cast<int>(columns), 4);
    first = last;
  }
  return text;
}

/// A bound of merit_of(), rounded to the side on which it still is one.
std::string bound_shown(const Specification& spec, double merit) {
  if (!in_percent_points(spec)) return bound_text(spec, merit);
  constexpr double kDecimals = 1e5;  // three of a percentage
  return objective_text(spec, std::ceil(merit * kDecimals) / kDecimals);
}

/// What is proven of the best of a number of planets: that no design surpasses it, or what none
/// surpasses.
std::string proof_text(const Specification& spec, const HeldBackReport& report, int planets) {
  const optimize::Certificate* const proof = proof_of(report, planets);
  if (proof == nullptr || !proof->objective_bounded || !std::isfinite(proof->best)) {
    return "not proven";
  }
  const double nothing =
      optimize::kProven * optimize::objective_scale(optimize::first_objective(spec), spec);
  if (proof->global_bound - proof->best <= nothing) return "proven";
  return fmt::format("none {} {}", record_of(spec).maximise ? "above" : "below",
                     bound_shown(spec, proof->global_bound));
}

std::string planets_title(const HeldBackReport& report) {
  if (report.all_refined) return "Best by number of planets";
  if (report.proofs.empty()) return "Best by number of planets, of the sets that were refined";
  return "Best by number of planets, each by a proof of its own";
}

}  // namespace

std::string planets_table(const Specification& spec, const HeldBackReport& report,
                          std::size_t columns) {
  const std::vector<HeldSet>& sets = report.by_planets;
  if (spec.planets.size() < 2) return "";
  const bool proofs = !report.proofs.empty();
  std::vector<std::string> head{"planets", "S/P1/R1/P2/R2", "ratio",
                                std::string(record_of(spec).title)};
  if (proofs) head.emplace_back("proof");
  head.emplace_back("held back most by");
  const std::size_t last = head.size() - 1;
  TextTable table(std::move(head));
  for (const std::size_t column : {std::size_t{1}, last}) table.align_left(column);
  std::string lines;
  for (const HeldSet& set : sets) {
    const int planets = set.set.candidate.planets;
    const LimitPrice* const price = dearest(set.held);
    const std::string teeth = teeth_text(set.set.candidate.teeth);
    const std::string ratio = fmt::format("{:.4f}", train::ratio(set.set.candidate.teeth));
    const std::string objective = objective_text(spec, objective_of(spec, set));
    const std::string held =
        price == nullptr
            ? "-"
            : fmt::format("{} = {} ({})", price->key, value_text(*price), price_text(spec, *price));
    std::vector<std::string> row{fmt::format("{}", planets), teeth, ratio, objective};
    if (proofs) row.push_back(proof_text(spec, report, planets));
    row.push_back(held);
    table.add(std::move(row));
    lines +=
        fmt::format("  {}: {}, ratio {}, {} {}{}\n    held back most by {}\n", planets, teeth,
                    ratio, record_of(spec).title, objective,
                    proofs ? fmt::format(" ({})", proof_text(spec, report, planets)) : "", held);
  }
  const std::string rows = table.text(2);
  return fmt::format("\n{}\n{}{}", planets_title(report), fits(rows, columns) ? rows : lines,
                     without_best_text(spec, report, columns));
}

namespace {

io::Json prices_json(const Specification& spec, const HeldSet& set) {
  return list_json(set.held.prices, [&](const LimitPrice& price) -> io::Json {
    const auto number = [&](const std::optional<double>& per_si) -> io::Json {
      return per_si ? io::Json(per_unit(spec, price, *per_si)) : nullptr;
    };
    const double change = change_per_step(spec, price);
    return {{"key", price.key},
            {"value", units::decimal_from_si(price.value_si, price.unit)},
            {"unit", units::unit_name(price.unit)},
            {"at_least", price.limit.at_least},
            {"stated", price.stated},
            {"preset",
             preset_of(spec, price).empty() ? io::Json(nullptr) : io::Json(preset_of(spec, price))},
            {"where", price.where},
            {"price_per_unit", price.unique() ? number(price.loosened) : io::Json(nullptr)},
            {"loosened_per_unit", number(price.loosened)},
            {"tightened_per_unit", number(price.tightened)},
            {"step", giving_step(price)},
            {"change_per_step", change},
            {"refined_change_per_step",
             price.refined_gain_si ? io::Json(refined_gain(spec, price)) : nullptr},
            {"percent_points_per_step",
             in_percent_points(spec) ? io::Json(100.0 * change) : io::Json(nullptr)}};
  });
}

/// A better design than the best one, of a search with a bound or a limit given way.
io::Json better_json(const Specification& spec, const HeldSet& best,
                     const optimize::RefinedSet& set) {
  const HeldSet better{.set = set, .held = {}};
  const double objective = objective_of(spec, better);
  return {{"planets", set.candidate.planets},
          {"teeth", train::teeth_of(set.candidate.teeth)},
          {"ratio", train::ratio(set.candidate.teeth)},
          {"objective", objective},
          {"change", objective - objective_of(spec, best)}};
}

io::Json relaxed_json(const Specification& spec, const HeldSet& best) {
  const std::optional<optimize::RelaxedAnswer>& relaxed = best.held.relaxed;
  const LimitPrice* const price = dearest(best.held);
  if (!relaxed || price == nullptr) return nullptr;
  return {{"key", relaxed->key},
          {"value", clean(units::decimal_from_si(relaxed->value_si, price->unit))},
          {"unit", units::unit_name(price->unit)},
          {"all_sets", relaxed->all_sets},
          {"better", relaxed->better ? better_json(spec, best, *relaxed->better) : nullptr}};
}

io::Json bound_json(const Specification& spec, const HeldSet& best,
                    const optimize::SearchBound& bound) {
  io::Json entry{{"key", bound.key},
                 {"value", bound.value},
                 {"tried", bound.wider ? io::Json(bound.wider->value) : nullptr},
                 {"better", nullptr}};
  if (bound.wider && bound.wider->better) {
    entry["better"] = better_json(spec, best, *bound.wider->better);
  }
  return entry;
}

io::Json held_set_json(const Specification& spec, const HeldSet& best) {
  const LimitPrice* const price = dearest(best.held);
  io::Json better = nullptr;
  if (price != nullptr) {
    const double change =
        price->refined_gain_si ? refined_gain(spec, *price) : change_per_step(spec, *price);
    better = {{"key", price->key},
              {"value",
               clean(units::decimal_from_si(price->value_si, price->unit) + giving_step(*price))},
              {"unit", units::unit_name(price->unit)},
              {"objective", nullptr},
              {"change", nullptr}};
    // The price of a limit does not hold up to where no design can be.
    if (const double estimate = objective_of(spec, best) + change; is_possible(spec, estimate)) {
      better["objective"] = estimate;
      better["change"] = change;
    }
  }
  return {{"prices", prices_json(spec, best)},
          {"prices_missing",
           best.held.missing.empty() ? io::Json(nullptr) : io::Json(best.held.missing)},
          {"at_bounds", list_json(best.held.at,
                                  [&](const optimize::SearchBound& bound) {
                                    return bound_json(spec, best, bound);
                                  })},
          {"better_estimate", std::move(better)},
          {"better_searched", relaxed_json(spec, best)}};
}

/// null where nothing is proven of a number of planets.
io::Json planets_proof_json(const Specification& spec, const HeldBackReport& report, int planets) {
  const optimize::Certificate* const proof = proof_of(report, planets);
  return proof == nullptr ? io::Json(nullptr) : proof_json(spec, *proof);
}

}  // namespace

io::Json held_back_json(const Specification& spec, const HeldBackReport& report) {
  io::Json json = held_set_json(spec, report.best);
  json["search_beyond_interrupted"] = report.best.held.interrupted;
  json["best_per_planets"] = list_json(report.by_planets, [&](const HeldSet& set) -> io::Json {
    io::Json entry{{"planets", set.set.candidate.planets},
                   {"teeth", train::teeth_of(set.set.candidate.teeth)},
                   {"ratio", train::ratio(set.set.candidate.teeth)},
                   {"objective", objective_of(spec, set)},
                   {"eta_b", set.set.eta_b},
                   {"eta_f", set.set.eta_f},
                   {"backlash_arcmin", arcmin(set.set.lost_motion_rad)},
                   {"all_refined", report.all_refined},
                   {"certificate", planets_proof_json(spec, report, set.set.candidate.planets)}};
    entry.update(held_set_json(spec, set));
    return entry;
  });
  json["planets_without_best"] =
      list_json(planets_left_out(spec, report.by_planets), [&](int planets) -> io::Json {
        return {{"planets", planets},
                {"reason", no_best(report, planets).name},
                {"certificate", planets_proof_json(spec, report, planets)}};
      });
  return json;
}

}  // namespace gear3k::report
