#pragma once
// Keys of a ring's pinion cutter; the same in DESIGN, PAIR and SPEC.

#include <fmt/format.h>

#include "geometry/gear.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

/// @param prefix  path of the cutter's table, with "{gear}" or without
/// @param view    geometry::PinionCutter&(Target&, std::size_t gear)
template <class Target, class View>
void append_cutter_keys(std::vector<Key<Target>>& keys, const std::string& prefix, View view) {
  keys.push_back({.record = {.path = prefix + ".teeth",
                             .type = KeyType::kInteger,
                             .min = 3,
                             .max = 2000,
                             .default_text = "none",
                             .help = "teeth of the pinion cutter that shapes a ring, fewer than "
                                     "the ring's; without it the ring's root is filleted by an "
                                     "arc of rack.root_radius"},
                  .assign = [view](Target& t, std::size_t gear, const TomlValue& v) {
                    view(t, gear).teeth = static_cast<int>(v.integer);
                  }});
  keys.push_back({.record = {.path = prefix + ".profile_shift",
                             .type = KeyType::kNumber,
                             .unit = "modules",
                             .min = -5.0,
                             .max = 5.0,
                             .default_text = "with a cutter: 0",
                             .help = "profile shift of the cutter as it is ground"},
                  .assign = [view](Target& t, std::size_t gear, const TomlValue& v) {
                    view(t, gear).profile_shift = v.number;
                  }});
  keys.push_back({.record = {.path = prefix + ".tip_radius",
                             .type = KeyType::kNumber,
                             .unit = "modules",
                             .min = 0.0,
                             .max = 1.0,
                             .default_text = "with a cutter: 0",
                             .help = "rounding of the cutter's tip corners"},
                  .assign = [view](Target& t, std::size_t gear, const TomlValue& v) {
                    view(t, gear).tip_radius = v.number;
                  }});
}

/// A ring's cutter needs teeth, and fewer than the ring's least tooth number.
inline void check_cutter(const std::string& path, const geometry::PinionCutter& cutter,
                         int ring_teeth, FileReading& reading) {
  for (const char* key : {".profile_shift", ".tip_radius"}) {
    if (reading.has(path + key) && !reading.stated(path + ".teeth")) {
      reading.error_at(path + key, fmt::format("{0}{1} without {0}.teeth: allowed: with the "
                                               "cutter's number of teeth",
                                               path, key));
    }
  }
  if (cutter.teeth > 0 && ring_teeth > 0 && cutter.teeth >= ring_teeth) {
    reading.error_at(path + ".teeth",
                     fmt::format("{}.teeth = {}: allowed: below the {} of the ring", path,
                                 cutter.teeth, ring_teeth));
  }
}

}  // namespace gear3k::io
