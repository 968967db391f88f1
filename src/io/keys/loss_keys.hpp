#pragma once
// Keys of what a gearbox loses and where it runs: laws of [friction], [lubricant], [drag],
// [bearings], [operating_point] and [map] of a DESIGN.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "design/design.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

/// What the keys set.
struct LossInput {
  design::Friction friction;  ///< law and its parameters
  design::ShaftLosses<double> shafts;
  design::OperatingPoint<double> operating_point;
  design::MapGrid map;
};

/// A key that holds one number.
struct LossNumber {
  KeyRecord record;
  std::function<double&(LossInput&)> member;
  double per_unit = 1.0;  ///< SI per unit of the key
  double offset = 0.0;    ///< SI = number * per_unit + offset
  /// The law that reads it; empty: always read.
  std::optional<efficiency::FrictionLaw> law = std::nullopt;
  bool required_by_law = false;
};
const std::vector<LossNumber>& loss_numbers();

/// A key that holds a list of numbers of the friction table.
struct LossList {
  KeyRecord record;
  std::vector<double> efficiency::FrictionTable::*member = nullptr;
  bool required = false;
};
const std::vector<LossList>& loss_lists();

KeyRecord friction_law_record();
/// A key of [map]: a range or a number of points.
struct MapKey {
  KeyRecord record;
  design::GridAxis design::MapGrid::*axis = nullptr;
  bool points = false;
  double per_unit = 1.0;
};
const std::vector<MapKey>& map_keys();

/// @param view  LossInput&(Target&)
template <class Target, class View>
void append_loss_keys(std::vector<Key<Target>>& keys, View view) {
  keys.push_back({.record = friction_law_record(),
                  .assign = [view](Target& t, std::size_t, const TomlValue& v) {
                    std::size_t law = 0;
                    while (efficiency::kFrictionLawNames[law] != v.text) ++law;
                    view(t).friction.law = static_cast<efficiency::FrictionLaw>(law);
                  }});
  for (const LossNumber& n : loss_numbers()) {
    keys.push_back(
        {.record = n.record, .assign = [view, &n](Target& t, std::size_t, const TomlValue& v) {
           n.member(view(t)) = v.number * n.per_unit + n.offset;
         }});
  }
  for (const LossList& list : loss_lists()) {
    keys.push_back({.record = list.record,
                    .assign = [view, &list](Target& t, std::size_t, const TomlValue& v) {
                      auto& points = view(t).friction.table.*list.member;
                      points.clear();
                      points.reserve(v.list.size());
                      for (const TomlValue& e : v.list) points.push_back(e.number);
                    }});
  }
  for (const MapKey& key : map_keys()) {
    keys.push_back(
        {.record = key.record, .assign = [view, &key](Target& t, std::size_t, const TomlValue& v) {
           design::GridAxis& axis = view(t).map.*key.axis;
           if (key.points) {
             axis.points = static_cast<int>(v.integer);
             return;
           }
           axis.from = v.list[0].number * key.per_unit;
           axis.to = v.list[1].number * key.per_unit;
         }});
  }
}

/// Puts what was read into a design, whose loss model, coefficient, factors, masses and shafts are
/// set; says in `reading` what does not fit together.
void finish_losses(const LossInput& input, design::Design& design, FileReading& reading);

/// The keys of a design's losses as text, those that are read and differ from their default. Begins
/// inside the table [friction]: it follows the keys of loss model and coefficient.
std::string loss_text(const design::Design& design);

}  // namespace gear3k::io
