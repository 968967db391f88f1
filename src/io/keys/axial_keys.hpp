#pragma once
// Keys of the table [axial]: where bodies lie along the axis; the same in DESIGN and SPEC.

#include <fmt/format.h>

#include "io/keys/key_registry.hpp"
#include "train/axial_layout.hpp"

namespace gear3k::io {

/// @param view  train::AxialLayout&(Target&)
template <class Target, class View>
void append_axial_keys(std::vector<Key<Target>>& keys, View view) {
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    keys.push_back(
        {.record = {.path = fmt::format("axial.{}_mm", train::kBodyNames[i]),
                    .type = KeyType::kNumberRange,
                    .unit = "mm",
                    .min = -1e4,
                    .max = 1e4,
                    .default_text = "none",
                    .help = "from and to along the axis; bodies that overlap are checked for a "
                            "radial gap (limits.body_gap)"},
         .assign = [view, i](Target& t, std::size_t, const TomlValue& v) {
           view(t).extent[i] = train::AxialInterval{.from_m = v.list[0].number * 1e-3,
                                                    .to_m = v.list[1].number * 1e-3};
         }});
  }
  keys.push_back({.record = {.path = "axial.carrier_diameter_mm",
                             .type = KeyType::kNumber,
                             .unit = "mm",
                             .min = 0.0,
                             .max = 1e4,
                             .min_excluded = true,
                             .default_text = "none",
                             .help = "outer diameter of the carrier; stated together with "
                                     "axial.carrier_mm"},
                  .assign = [view](Target& t, std::size_t, const TomlValue& v) {
                    view(t).carrier_radius_m = 0.5e-3 * v.number;
                  }});
}

/// What the keys say together.
inline void check_axial(const train::AxialLayout& layout, FileReading& reading) {
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    const auto& body = layout.extent[i];
    if (body && !(body->from_m < body->to_m)) {
      const std::string key = fmt::format("axial.{}_mm", train::kBodyNames[i]);
      reading.error_at(key, fmt::format("{} = [{:g}, {:g}]: allowed: from below to", key,
                                        body->from_m * 1e3, body->to_m * 1e3));
    }
  }
  const bool extent = layout.extent[train::kCarrier].has_value();
  const bool radius = layout.carrier_radius_m > 0.0;
  if (extent == radius) return;
  const char* stated = extent ? "axial.carrier_mm" : "axial.carrier_diameter_mm";
  const char* missing = extent ? "axial.carrier_diameter_mm" : "axial.carrier_mm";
  reading.error_at(stated, fmt::format("{} without {}: allowed: both or neither", stated, missing));
}

}  // namespace gear3k::io
