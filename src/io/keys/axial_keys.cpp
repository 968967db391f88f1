#include "io/keys/axial_keys.hpp"

#include <fmt/format.h>

#include <utility>

namespace gear3k::io {

using units::Unit;

namespace {

/// Of lengths along the axis that are the same.
constexpr double kSlack_m = 1e-9;

std::string key_of(int body) {
  return fmt::format("axial.{}_mm", train::kBodyNames[static_cast<std::size_t>(body)]);
}

}  // namespace

std::vector<Key<train::AxialLayout>> axial_keys() {
  using Layout = train::AxialLayout;
  std::vector<Key<Layout>> keys;
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    KeyRecord record =
        number_range(key_of(static_cast<int>(i)), Unit::kMillimetre, within(-1e4, 1e4), "none",
                     "from and to along the axis; bodies that overlap are checked for "
                     "a radial gap (limits.body_gap)");
    record.ends_differ = true;
    keys.push_back(make_key<Layout>(
        std::move(record), [i](auto& t, std::size_t) -> auto& { return t.extent[i]; }));
  }
  keys.push_back(unless_default(make_key<Layout>(
      number("axial.carrier_diameter_mm", Unit::kDiameterMillimetre, above(0.0, 1e4), "none",
             "outer diameter of the carrier; stated together with axial.carrier_mm"),
      &Layout::carrier_radius_m)));
  return keys;
}

namespace {

std::string stated(const train::AxialLayout& layout, int body) {
  const train::AxialInterval& extent = *layout.extent[static_cast<std::size_t>(body)];
  return fmt::format("{} = [{:g}, {:g}]", key_of(body),
                     units::from_si(extent.from_m, Unit::kMillimetre),
                     units::from_si(extent.to_m, Unit::kMillimetre));
}

/// Mates face each other, and the toothings of the planet lie side by side.
void check_mates(const train::AxialLayout& layout, FileReading& reading) {
  for (const auto& [gear1, gear2] : train::kMeshGears) {
    const std::optional<double> common_m = train::common_length_m(layout, gear1, gear2);
    if (!common_m || *common_m > kSlack_m) continue;
    reading.error_at(key_of(gear2),
                     fmt::format("{} and {}: allowed: a length in common, as {} and {} mesh",
                                 stated(layout, gear1), stated(layout, gear2),
                                 train::kBodyNames[static_cast<std::size_t>(gear1)],
                                 train::kBodyNames[static_cast<std::size_t>(gear2)]));
  }
  const std::optional<double> shared_m = train::common_length_m(layout, train::kP1, train::kP2);
  if (!shared_m || *shared_m <= kSlack_m) return;
  reading.error_at(key_of(train::kP2),
                   fmt::format("{} and {}: allowed: side by side, as both are toothings of one "
                               "planet",
                               stated(layout, train::kP1), stated(layout, train::kP2)));
}

}  // namespace

void check_axial(const train::AxialLayout& layout, FileReading& reading) {
  bool in_order = true;
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    const auto& body = layout.extent[i];
    if (body && !(body->from_m < body->to_m)) {
      const auto which = static_cast<int>(i);
      reading.error_at(key_of(which),
                       fmt::format("{}: allowed: from below to", stated(layout, which)));
      in_order = false;
    }
  }
  if (in_order) check_mates(layout, reading);
  const bool extent = layout.extent[train::kCarrier].has_value();
  const bool radius = layout.carrier_radius_m > 0.0;
  if (extent == radius) return;
  const char* given = extent ? "axial.carrier_mm" : "axial.carrier_diameter_mm";
  const char* missing = extent ? "axial.carrier_diameter_mm" : "axial.carrier_mm";
  reading.error_at(given, fmt::format("{} without {}: allowed: both or neither", given, missing));
}

void check_rings_apart(const train::AxialLayout& layout,
                       const std::optional<std::array<RingBody, 2>>& rings, FileReading& reading) {
  const std::optional<double> common_m = train::common_length_m(layout, train::kR1, train::kR2);
  if (!common_m || *common_m <= kSlack_m) return;
  std::string allowed = "apart along the axis";
  if (rings) {
    const bool first = (*rings)[0].tip_radius_m < (*rings)[1].tip_radius_m;
    const RingBody& inner = (*rings)[first ? 0 : 1];
    const double tip_m = (*rings)[first ? 1 : 0].tip_radius_m;
    if (inner.outer_radius_m && *inner.outer_radius_m <= tip_m) return;
    if (inner.root_radius_m < tip_m) {
      allowed +=
          fmt::format(", or gears.{}.outer_diameter_mm of at most {:.6g}, the tip diameter of {}",
                      first ? "R1" : "R2", units::from_si(tip_m, Unit::kDiameterMillimetre),
                      first ? "R2" : "R1");
    }
  }
  reading.error_at(key_of(train::kR2),
                   fmt::format("{} and {}: two rings in one place: allowed: {}",
                               stated(layout, train::kR1), stated(layout, train::kR2), allowed));
}

}  // namespace gear3k::io
