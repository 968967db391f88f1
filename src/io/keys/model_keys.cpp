#include "io/keys/model_keys.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace gear3k::io {

using units::Unit;

KeyRecord pressure_angle_record() {
  return number("pressure_angle_deg", Unit::kDegree, within(5.0, 45.0), "20",
                "standard pressure angle of the basic rack", {design::InputKind::kPressureAngle});
}

std::vector<Key<geometry::BasicRack<double>>> rack_keys() {
  using Rack = geometry::BasicRack<double>;
  const auto key = [](KeyRecord record, double Rack::*member) {
    record.path = "rack." + record.path;
    return make_key<Rack>(
        std::move(record), [member](auto& t, std::size_t) -> auto& { return t.*member; });
  };
  return {key(number("addendum", Unit::kModules, within(0.1, 3.0), "1.0",
                     "addendum of the basic rack", {design::InputKind::kAddendum}),
              &Rack::addendum),
          key(number("dedendum", Unit::kModules, within(0.1, 3.0), "1.25",
                     "dedendum of the basic rack", {design::InputKind::kDedendum}),
              &Rack::dedendum),
          key(number("root_radius", Unit::kModules, within(0.0, 1.0), "0.38",
                     "root fillet radius of the basic rack", {design::InputKind::kRootRadius}),
              &Rack::root_radius)};
}

std::vector<Key<design::Friction>> friction_keys() {
  using design::Friction;
  const auto factor = [](const char* path, double Friction::*member, design::InputKind input,
                         const char* help) {
    return make_key<Friction>(
        number(path, Unit::kNone, within(0.0, 10.0), "with directional: 1", help, {input}),
        [member](auto& t, std::size_t) -> auto& { return t.*member; },
        [](const Friction& f, std::size_t) {
          return f.model == efficiency::LossModel::kDirectional;
        });
  };
  return {
      make_key<Friction>(
          number("friction.coefficient", Unit::kNone, within(0.0, 1.0), "0.1",
                 "coefficient of friction of the meshes",
                 {design::InputKind::kFrictionCoefficient}),
          &Friction::coefficient,
          [](const Friction& f, std::size_t) { return efficiency::reads_coefficient(f.law); }),
      make_key<Friction>(
          {.path = "friction.loss_model",
           .type = KeyType::kChoice,
           .choices = {efficiency::kLossModelNames.begin(), efficiency::kLossModelNames.end()},
           .default_text = "\"sliding\"",
           .help = "mesh loss: sliding = mean sliding over a base pitch, for any contact ratios; "
                   "ohlendorf = the papers' closed form; coulomb_path = exact friction along the "
                   "path of contact; directional = the same with approach_factor and "
                   "recess_factor"},
          &Friction::model),
      factor("friction.approach_factor", &Friction::approach_factor,
             design::InputKind::kApproachFactor,
             "directional: friction in approach over the coefficient"),
      factor("friction.recess_factor", &Friction::recess_factor, design::InputKind::kRecessFactor,
             "directional: friction in recess over the coefficient")};
}

void check_friction(const design::Friction& friction, FileReading& reading) {
  if (friction.model == efficiency::LossModel::kDirectional) return;
  for (const char* path : {"friction.approach_factor", "friction.recess_factor"}) {
    if (!reading.stated(path)) continue;
    reading.error_at(
        path, fmt::format("{}: allowed with friction.loss_model = \"directional\" only", path));
  }
}

void check_rack(const geometry::BasicRack<double>& rack, double pressure_angle_rad,
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
