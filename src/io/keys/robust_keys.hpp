#pragma once
// Keys of the table [robust] of a SPEC: what the limits have to hold for.

#include <fmt/format.h>

#include <cstddef>
#include <vector>

#include "io/keys/key_registry.hpp"
#include "io/keys/model_keys.hpp"
#include "io/keys/tolerance_keys.hpp"
#include "optimize/specification.hpp"

namespace gear3k::io {

/// @param view  optimize::Robust&(Target&)
template <class Target, class View>
void append_robust_keys(std::vector<Key<Target>>& keys, View view) {
  const auto add = [&](const KeyRecord& record, auto assign) {
    keys.push_back(
        {.record = record, .assign = [view, assign](Target& t, std::size_t, const TomlValue& v) {
           assign(view(t), v);
         }});
  };
  using optimize::Robust;
  add({.path = "robust.hold",
       .type = KeyType::kChoice,
       .choices = {optimize::kHoldNames.begin(), optimize::kHoldNames.end()},
       .default_text = "\"nominal\"",
       .help = "what the limits hold for: the drawn gearbox, every gearbox within its "
               "[tolerances], or a share of them; with a share every check but that of normal "
               "backlash holds at its worst corner"},
      [](Robust& r, const TomlValue& v) {
        r.hold = static_cast<optimize::Hold>(index_of(optimize::kHoldNames, v.text));
      });
  add({.path = "robust.yield",
       .type = KeyType::kNumber,
       .min = 0.01,
       .max = 0.99999,
       .default_text = "0.99",
       .help = "share of the built gearboxes that assemble and keep the limits of lost motion"},
      [](Robust& r, const TomlValue& v) { r.yield = v.number; });
  add({.path = "robust.tolerances",
       .type = KeyType::kChoice,
       .choices = {"stated", "cheapest"},
       .default_text = "\"stated\"",
       .help = "cheapest: every tolerance may be tightened or widened in steps of sqrt(2) until "
               "the yield is reached at the least cost"},
      [](Robust& r, const TomlValue& v) { r.cheapest = v.text == "cheapest"; });
  for (std::size_t kind = 0; kind < backlash::kToleranceKindNames.size(); ++kind) {
    add({.path = fmt::format("robust.cost.{}", backlash::kToleranceKindNames[kind]),
         .type = KeyType::kNumber,
         .min = 0.0,
         .max = 1e6,
         .default_text = "1",
         .help = "cost of holding this tolerance of one gear or part as stated; half of it costs "
                 "twice as much"},
        [kind](Robust& r, const TomlValue& v) { r.cost[kind] = v.number; });
  }
}

/// What [robust], [tolerances] and the limits say together.  Accuracy grades are refused: their
/// deviations depend on sizes that the search chooses.
void check_robust(const optimize::Specification& spec, const ToleranceInput& tolerances,
                  FileReading& reading);

}  // namespace gear3k::io
