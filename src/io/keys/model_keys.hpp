#pragma once
// Keys of the basic rack and of friction: the same in DESIGN, PAIR and SPEC.

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string_view>

#include "design/design.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

/// The values that the keys set, as references into a Target.
struct ModelInput {
  double& pressure_angle_rad;
  geometry::BasicRack<double>& rack;
  design::Friction& friction;
};

/// Position of a name in a list of names that holds it.
template <class Names>
std::size_t index_of(const Names& names, std::string_view name) {
  std::size_t index = 0;
  while (names[index] != name) ++index;
  return index;
}

/// @param view  ModelInput(Target&)
template <class Target, class View>
void append_model_keys(std::vector<Key<Target>>& keys, View view) {
  keys.push_back({.record = {.path = "pressure_angle_deg",
                             .type = KeyType::kNumber,
                             .unit = "deg",
                             .min = 5.0,
                             .max = 45.0,
                             .default_text = "20",
                             .help = "standard pressure angle of the basic rack"},
                  .assign = [view](Target& t, std::size_t, const TomlValue& v) {
                    view(t).pressure_angle_rad = v.number * std::numbers::pi / 180.0;
                  }});
  struct Rack {
    const char* name;
    double geometry::BasicRack<double>::*member;
    double min, max;
    const char* default_text;
    const char* help;
  };
  using BasicRack = geometry::BasicRack<double>;
  static constexpr std::array<Rack, 3> kRack{
      {{"addendum", &BasicRack::addendum, 0.1, 3.0, "1.0", "addendum of the basic rack"},
       {"dedendum", &BasicRack::dedendum, 0.1, 3.0, "1.25", "dedendum of the basic rack"},
       {"root_radius", &BasicRack::root_radius, 0.0, 1.0, "0.38",
        "root fillet radius of the basic rack"}}};
  for (const Rack& r : kRack) {
    keys.push_back(
        {.record = {.path = std::string("rack.") + r.name,
                    .type = KeyType::kNumber,
                    .unit = "modules",
                    .min = r.min,
                    .max = r.max,
                    .default_text = r.default_text,
                    .help = r.help},
         .assign = [view, member = r.member](Target& t, std::size_t, const TomlValue& v) {
           view(t).rack.*member = v.number;
         }});
  }
  keys.push_back({.record = {.path = "friction.coefficient",
                             .type = KeyType::kNumber,
                             .min = 0.0,
                             .max = 1.0,
                             .default_text = "0.1",
                             .help = "coefficient of friction of the meshes"},
                  .assign = [view](Target& t, std::size_t, const TomlValue& v) {
                    view(t).friction.coefficient = v.number;
                  }});
  keys.push_back(
      {.record = {.path = "friction.loss_model",
                  .type = KeyType::kChoice,
                  .choices = {efficiency::kLossModelNames.begin(),
                              efficiency::kLossModelNames.end()},
                  .default_text = "\"sliding\"",
                  .help = "mesh loss: sliding = mean sliding over a base pitch, for any contact "
                          "ratios; ohlendorf = the papers' closed form; coulomb_path = exact "
                          "friction along the path of contact; directional = the same with "
                          "approach_factor and recess_factor"},
       .assign = [view](Target& t, std::size_t, const TomlValue& v) {
         view(t).friction.model =
             static_cast<efficiency::LossModel>(index_of(efficiency::kLossModelNames, v.text));
       }});
  struct Factor {
    const char* path;
    double design::Friction::*member;
    const char* help;
  };
  static constexpr std::array<Factor, 2> kFactors{
      {{"friction.approach_factor", &design::Friction::approach_factor,
        "directional: friction in approach over the coefficient"},
       {"friction.recess_factor", &design::Friction::recess_factor,
        "directional: friction in recess over the coefficient"}}};
  for (const Factor& f : kFactors) {
    keys.push_back(
        {.record = {.path = f.path,
                    .type = KeyType::kNumber,
                    .min = 0.0,
                    .max = 10.0,
                    .default_text = "with directional: 1",
                    .help = f.help},
         .assign = [view, member = f.member](Target& t, std::size_t, const TomlValue& v) {
           view(t).friction.*member = v.number;
         }});
  }
}

/// The factors act in one loss model only.
inline void check_friction(const design::Friction& friction, FileReading& reading) {
  if (friction.model == efficiency::LossModel::kDirectional) return;
  for (const char* path : {"friction.approach_factor", "friction.recess_factor"}) {
    if (!reading.stated(path)) continue;
    reading.error_at(
        path, fmt::format("{}: allowed with friction.loss_model = \"directional\" only", path));
  }
}

/// The rack's tooth must not come to a point before its tip: hfP* < π/(4 tan α).
inline void check_rack(const geometry::BasicRack<double>& rack, double pressure_angle_rad,
                       FileReading& reading) {
  const double greatest = std::numbers::pi / (4.0 * std::tan(pressure_angle_rad));
  if (rack.dedendum >= greatest) {
    reading.error_at("rack.dedendum",
                     fmt::format("rack.dedendum = {}: allowed: below {:.6g}, where the rack's "
                                 "tooth comes to a point",
                                 rack.dedendum, greatest));
  }
}

}  // namespace gear3k::io
