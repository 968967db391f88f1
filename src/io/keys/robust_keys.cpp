#include "io/keys/robust_keys.hpp"

#include <fmt/format.h>

#include <string>

#include "optimize/cheapest_tolerances.hpp"

namespace gear3k::io {

namespace {

using optimize::Hold, optimize::Robust, units::Unit;

/// That the search for the cheapest tolerances can reach.
double most_cheapest_yield() {
  return optimize::highest_yield(optimize::CheapestOptions{}.samples);
}

void refuse_grades(const ToleranceInput& tolerances, FileReading& reading) {
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    if (!tolerances.gears[i].grade) continue;
    const std::string key = fmt::format("tolerances.{}.accuracy_grade", train::kGearNames[i]);
    reading.error_at(key, fmt::format("{} = {}: allowed in DESIGN files; a SPEC states runout_um, "
                                      "cumulative_pitch_um and single_pitch_um",
                                      key, *tolerances.gears[i].grade));
  }
}

/// Limits that built gearboxes cannot be held to.
void check_limits(const design::Limits& limits, FileReading& reading) {
  const double least_rad = limits[design::CheckId::kOutputBacklashMin].value_or(0.0);
  if (least_rad > 0.0) {
    reading.error_at("backlash.min_output_arcmin",
                     fmt::format("backlash.min_output_arcmin = {:.6g} with robust.hold: allowed: 0 "
                                 "(gearboxes that can jam have no least lost motion)",
                                 units::from_si(least_rad, units::Unit::kArcmin)));
  }
  if (limits.model == backlash::LostMotionModel::kPaper) {
    reading.error_at("backlash.model",
                     "backlash.model = \"paper\" with robust.hold: allowed: \"kinematic\", which "
                     "built gearboxes follow");
  }
}

/// Settings that only another choice of [robust] would read.
void check_unread(const Robust& robust, FileReading& reading) {
  const Robust unstated;
  if (robust.hold != Hold::kYield && robust.yield != unstated.yield) {
    reading.error_at("robust.yield", fmt::format("robust.yield = {:g}: allowed with robust.hold = "
                                                 "\"yield\"",
                                                 robust.yield));
  }
  if (robust.cheapest) return;
  for (std::size_t kind = 0; kind < robust.cost.size(); ++kind) {
    if (robust.cost[kind] == unstated.cost[kind]) continue;
    const std::string key = fmt::format("robust.cost.{}", backlash::kToleranceKindNames[kind]);
    reading.error_at(key, fmt::format("{} = {:g}: allowed with robust.tolerances = \"cheapest\"",
                                      key, robust.cost[kind]));
  }
}

}  // namespace

std::vector<Key<Robust>> robust_keys() {
  std::vector<Key<Robust>> keys{
      make_key<Robust>(
          {.path = "robust.hold",
           .type = KeyType::kChoice,
           .choices = {optimize::kHoldNames.begin(), optimize::kHoldNames.end()},
           .default_text = "\"nominal\"",
           .help = "what the limits hold for: the drawn gearbox, every gearbox within its "
                   "[tolerances], or a share of them; with a share every check but that of normal "
                   "backlash holds at its worst corner"},
          &Robust::hold),
      make_key<Robust>(
          number("robust.yield", Unit::kNone, within(0.01, 0.99999), "0.99",
                 "share of the built gearboxes that assemble and keep the limits of lost motion"),
          &Robust::yield),
      make_key<Robust>(
          {.path = "robust.tolerances",
           .type = KeyType::kChoice,
           .choices = {"stated", "cheapest"},
           .default_text = "\"stated\"",
           .help = fmt::format("cheapest: every tolerance may be tightened or widened in steps of "
                               "sqrt(2) until the yield, to {:g}, is reached at the least cost",
                               most_cheapest_yield())},
          &Robust::cheapest)};
  for (std::size_t kind = 0; kind < backlash::kToleranceKindNames.size(); ++kind) {
    keys.push_back(make_key<Robust>(
        number(fmt::format("robust.cost.{}", backlash::kToleranceKindNames[kind]), Unit::kNone,
               within(0.0, 1e6), "1",
               "cost of holding this tolerance of one gear or part as stated; half of it costs "
               "twice as much"),
        [kind](auto& t, std::size_t) -> auto& { return t.cost[kind]; }));
  }
  return keys;
}

void check_robust(const optimize::Specification& spec, const ToleranceInput& tolerances,
                  FileReading& reading) {
  const Robust& robust = spec.robust;
  refuse_grades(tolerances, reading);
  if (robust.hold != Hold::kNominal && !tolerances.stated) {
    reading.error_at("robust.hold",
                     fmt::format("robust.hold = \"{}\" without [tolerances]: allowed: with them",
                                 optimize::kHoldNames[static_cast<std::size_t>(robust.hold)]));
  }
  if (robust.cheapest && robust.hold != Hold::kYield) {
    reading.error_at("robust.tolerances",
                     "robust.tolerances = \"cheapest\": allowed with robust.hold = \"yield\"");
  }
  if (robust.cheapest && robust.yield > most_cheapest_yield()) {
    reading.error_at("robust.yield", fmt::format("robust.yield = {:g}: allowed up to {:g} with "
                                                 "robust.tolerances = \"cheapest\"",
                                                 robust.yield, most_cheapest_yield()));
  }
  if (robust.hold != Hold::kNominal) check_limits(spec.limits, reading);
  check_unread(robust, reading);
}

}  // namespace gear3k::io
