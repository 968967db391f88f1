#include "io/keys/axial_keys.hpp"

#include <fmt/format.h>

namespace gear3k::io {

using units::Unit;

std::vector<Key<train::AxialLayout>> axial_keys() {
  using Layout = train::AxialLayout;
  std::vector<Key<Layout>> keys;
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    keys.push_back(make_key<Layout>(
        number_range(fmt::format("axial.{}_mm", train::kBodyNames[i]), Unit::kMillimetre,
                     within(-1e4, 1e4), "none",
                     "from and to along the axis; bodies that overlap are checked for "
                     "a radial gap (limits.body_gap)"),
        [i](auto& t, std::size_t) -> auto& { return t.extent[i]; }));
  }
  keys.push_back(unless_default(make_key<Layout>(
      number("axial.carrier_diameter_mm", Unit::kDiameterMillimetre, above(0.0, 1e4), "none",
             "outer diameter of the carrier; stated together with axial.carrier_mm"),
      &Layout::carrier_radius_m)));
  return keys;
}

void check_axial(const train::AxialLayout& layout, FileReading& reading) {
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    const auto& body = layout.extent[i];
    if (body && !(body->from_m < body->to_m)) {
      const std::string key = fmt::format("axial.{}_mm", train::kBodyNames[i]);
      reading.error_at(key, fmt::format("{} = [{:g}, {:g}]: allowed: from below to", key,
                                        units::from_si(body->from_m, Unit::kMillimetre),
                                        units::from_si(body->to_m, Unit::kMillimetre)));
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
