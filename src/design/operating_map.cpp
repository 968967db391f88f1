#include "design/operating_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "backlash/normal_backlash.hpp"
#include "units/units.hpp"

namespace gear3k::design {

namespace {

using efficiency::FrictionLaw;

std::vector<double> points_of(const GridAxis& axis, std::string_view name) {
  if (axis.points < 1) {
    throw std::invalid_argument(
        fmt::format("make_operating_map: {} points of {}, allowed: at least 1", axis.points, name));
  }
  const auto count = static_cast<std::size_t>(axis.points);
  std::vector<double> values(count, axis.from);
  for (std::size_t k = 1; k < count; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(count - 1);
    values[k] = k + 1 == count ? axis.to : axis.from + share * (axis.to - axis.from);
  }
  return values;
}

/// η2 η3 − G2 or η2 η3 G2 − 1 with the given friction in the backward direction; empty where a
/// mesh efficiency is not positive, as the margin then has no meaning.
std::optional<double> margin_of(const LossyTrain<double>& train,
                                const std::array<double, train::kMeshCount>& friction) {
  const efficiency::Friction<double>& law = train.friction;
  efficiency::MeshEfficiencies<double> eta{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto contact =
        efficiency::mesh_contact(train.geometry, static_cast<train::MeshId>(k), false);
    eta[k] = efficiency::mesh_efficiency(contact, efficiency::flank_friction(law, friction[k]),
                                         law.model);
    if (!(eta[k] > 0.0)) return std::nullopt;
  }
  return efficiency::backdriving_margin(train.geometry.teeth, eta);
}

/// The margin with the friction of an operation, or with constant friction without one.
std::optional<double> margin_at(const LossyTrain<double>& train,
                                const std::optional<Operation<double>>& operation) {
  std::array<double, train::kMeshCount> friction{};
  if (operation) {
    for (std::size_t k = 0; k < train::kMeshCount; ++k) friction[k] = operation->mesh[k].friction;
  } else if (!efficiency::depends_on_state(train.friction)) {
    friction = *mesh_friction<double>(train, {}, Direction::kBackward);
  } else {
    return std::nullopt;
  }
  return margin_of(train, friction);
}

/// Whether R2 drives the sun at a point when no shaft has drag.
bool drives_without_drag(const LossyTrain<double>& train, const OperatingPoint<double>& point) {
  ShaftLosses<double> bearings = train.shafts;
  bearings.drag = {};
  const LossyTrain<double> free{.geometry = train.geometry,
                                .friction = train.friction,
                                .shafts = bearings,
                                .face_width_m = train.face_width_m};
  const auto driven = operate(free, point, Direction::kBackward);
  return driven.operation && driven.operation->sun_torque_Nm > 0.0;
}

MapStatus status_of(const OperationResult<double>& result, Direction direction) {
  if (!result.operation) {
    switch (result.reason) {
      case NoOperation::kNoFriction:
        return MapStatus::kNoFriction;
      case NoOperation::kNotConverged:
        return MapStatus::kNotConverged;
      case NoOperation::kLocks:
      case NoOperation::kNoContact:  // make_operating_map() has excluded it
        break;
    }
    return MapStatus::kLocks;
  }
  const bool helped = direction == Direction::kBackward && result.operation->sun_torque_Nm < 0.0;
  return helped ? MapStatus::kHelped : MapStatus::kRuns;
}

MapPair pair_at(const LossyTrain<double>& train, const OperatingPoint<double>& point) {
  MapPair pair{.point = point, .forward = {}, .backward = {}};
  const auto forward = operate(train, point, Direction::kForward);
  pair.forward = {.status = status_of(forward, Direction::kForward),
                  .operation = forward.operation,
                  .backdriving_margin = std::nullopt};
  const auto backward = operate(train, point, Direction::kBackward);
  pair.backward = {.status = status_of(backward, Direction::kBackward),
                   .operation = backward.operation,
                   .backdriving_margin = margin_at(train, backward.operation),
                   .drives_sun = drives_without_drag(train, point)};
  return pair;
}

std::string no_friction_reason(const LossyTrain<double>& train, bool at_rest) {
  const auto name = efficiency::kFrictionLawNames[static_cast<std::size_t>(train.friction.law)];
  return fmt::format(
      "friction law {} has no value {}", name,
      train.friction.law == FrictionLaw::kSchlenk && at_rest ? "at rest" : "without tooth load");
}

/// Torques without load at a speed; 0: at the onset of motion.
/// @param least_torque_Nm  least torque at R2 to judge by whether R2 can drive the sun
UnloadedTorques unloaded_torques(const LossyTrain<double>& train,
                                 const OperatingPoint<double>& point, double least_torque_Nm) {
  const bool at_rest = point.sun_speed_rad_s == 0.0;
  const auto told = [&](const OperationResult<double>& result, bool forward) {
    MapTorque torque;
    if (result.operation) {
      torque.torque_Nm =
          forward ? result.operation->sun_torque_Nm : result.operation->output_torque_Nm;
      torque.status = MapStatus::kRuns;
      // Without anything to overcome a locking train balances too, with all torques zero.
      OperatingPoint<double> loaded = point;
      loaded.output_torque_Nm = std::max(result.operation->output_torque_Nm, least_torque_Nm);
      if (!forward && !drives_without_drag(train, loaded)) torque = {};
    } else if (result.reason == NoOperation::kNoFriction) {
      torque.status = MapStatus::kNoFriction;
      torque.reason = no_friction_reason(train, at_rest);
    } else if (result.reason == NoOperation::kNotConverged) {
      torque.status = MapStatus::kNotConverged;
      torque.reason = no_operation_text(result.reason);
    }
    if (torque.status == MapStatus::kLocks) {
      torque.reason = forward ? "the train locks" : "the train locks: R2 cannot drive the sun";
    }
    return torque;
  };
  OperatingPoint<double> unloaded = point;
  unloaded.output_torque_Nm = 0.0;
  return {.sun = told(operate(train, unloaded, Direction::kForward), true),
          .output = told(drive_free_sun(train, unloaded), false)};
}

bool drags(const ShaftDrag<double>& drag) {
  return drag.constant_Nm != 0.0 || drag.viscous_Nms != 0.0 || drag.quadratic_Nms2 != 0.0;
}

void note_interference(const train::TrainGeometry<double>& train, OperatingMap& map) {
  const auto j_bn = backlash::normal_backlashes(train);
  constexpr double kRounding_m = 1e-9;
  std::vector<std::string> interfering;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    if (!(j_bn[k] < -kRounding_m)) continue;
    interfering.push_back(fmt::format("{} {:.1f} um", train::kMeshNames[k],
                                      units::from_si(j_bn[k], units::Unit::kMicrometre)));
  }
  if (interfering.empty()) return;
  map.notes.push_back(
      fmt::format("teeth interfere as drawn, so that it cannot be assembled: normal backlash {}",
                  fmt::join(interfering, ", ")));
}

/// Says which axes are those that the grid has where a file states none, and whose they are.
void note_default_grid(const Design& design, OperatingMap& map) {
  if (design.operating_point) return;
  const MapGrid usual;
  const auto spans = [](const GridAxis& axis, const GridAxis& other) {
    return axis.from == other.from && axis.to == other.to;
  };
  std::vector<std::string> axes, keys;
  if (const GridAxis& speed = design.map.sun_speed_rad_s; spans(speed, usual.sun_speed_rad_s)) {
    axes.push_back(fmt::format("{:g} to {:g} rpm of the sun",
                               units::from_si(speed.from, units::Unit::kRpm),
                               units::from_si(speed.to, units::Unit::kRpm)));
    keys.emplace_back("map.sun_speed_rpm");
  }
  if (const GridAxis& torque = design.map.output_torque_Nm; spans(torque, usual.output_torque_Nm)) {
    axes.push_back(fmt::format("{:g} to {:g} N m at R2", torque.from, torque.to));
    keys.emplace_back("map.output_torque_nm");
  }
  if (axes.empty()) return;
  map.notes.push_back(
      fmt::format("{}: the default of the grid, the range of the low-backlash paper's experiment; "
                  "that of the design's own duty is stated by {}",
                  fmt::join(axes, " and "), fmt::join(keys, " and ")));
}

void add_notes(const Design& design, OperatingMap& map) {
  note_default_grid(design, map);
  if (!std::ranges::any_of(design.shafts.drag, drags)) {
    map.notes.emplace_back(
        "the design states no load-independent losses: no-load, back-driving and breakaway torques "
        "are those of a gearbox without seals, preload and churning");
  }
  if (!design.center_distance_given) {
    map.notes.emplace_back(
        "no center_distance_mm given: the zero-backlash distance of mesh P1-R1 is used");
  }
  if (const auto& point = design.operating_point) {
    const auto beyond = [](const GridAxis& axis, double value) {
      return value < axis.from || value > axis.to;
    };
    if (beyond(design.map.sun_speed_rad_s, std::abs(point->sun_speed_rad_s)) ||
        beyond(design.map.output_torque_Nm, point->output_torque_Nm)) {
      map.notes.emplace_back(
          "the operating point lies outside the map: map.sun_speed_rpm and map.output_torque_nm "
          "say what it spans");
    }
  }
  const auto count = [&](auto holds) { return std::ranges::count_if(map.points, holds); };
  const auto note = [&](long number, std::string_view text) {
    if (number > 0)
      map.notes.push_back(fmt::format("{} of {} points {}", number, map.points.size(), text));
  };
  note(count([](const MapPair& p) { return p.backward.status == MapStatus::kHelped; }),
       "turn backward only with torque on the sun along its rotation");
  note(count([](const MapPair& p) {
         return p.forward.status == MapStatus::kNoFriction ||
                p.backward.status == MapStatus::kNoFriction;
       }),
       "have no value of the friction law");
}

}  // namespace

std::variant<OperatingMap, NotDefined> make_operating_map(const Design& design) {
  if (auto undefined = why_undefined(design)) return *std::move(undefined);
  const auto geometry = train::make_train_geometry(resolved_parameters(design));
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const double contact_ratio = geometry->meshes[k].contact_ratio;
    if (contact_ratio > 0.0) continue;
    return NotDefined{
        fmt::format("mesh {} has no contact (contact ratio {:.3f}): no torque passes it",
                    train::kMeshNames[k], contact_ratio)};
  }
  const LossyTrain<double> train = lossy_train(design, *geometry);

  OperatingMap map;
  map.name = design.name;
  map.teeth = geometry->teeth;
  map.planets = geometry->planets;
  map.ratio = train::ratio(map.teeth);
  map.law = design.friction.law;
  const OperatingPoint<double> stated = design.operating_point.value_or(OperatingPoint<double>{});
  map.temperature_K = stated.temperature_K;
  map.sun_speed_rad_s = points_of(design.map.sun_speed_rad_s, "sun speed");
  map.output_torque_Nm = points_of(design.map.output_torque_Nm, "output torque");
  map.points.reserve(map.sun_speed_rad_s.size() * map.output_torque_Nm.size());
  map.running.reserve(map.sun_speed_rad_s.size());
  const double least_torque_Nm = std::ranges::min(map.output_torque_Nm);
  OperatingPoint<double> point = stated;
  for (const double speed_rad_s : map.sun_speed_rad_s) {
    point.sun_speed_rad_s = speed_rad_s;
    for (const double torque_Nm : map.output_torque_Nm) {
      point.output_torque_Nm = torque_Nm;
      map.points.push_back(pair_at(train, point));
    }
    map.running.push_back(unloaded_torques(train, point, least_torque_Nm));
  }
  point.sun_speed_rad_s = 0.0;
  map.breakaway = unloaded_torques(train, point, least_torque_Nm);
  map.reference_given = design.operating_point.has_value();
  if (map.reference_given) {
    point = stated;
  } else {
    point.sun_speed_rad_s = std::ranges::max(map.sun_speed_rad_s);
    point.output_torque_Nm = std::ranges::max(map.output_torque_Nm);
  }
  map.reference = pair_at(train, point);
  note_interference(*geometry, map);
  add_notes(design, map);
  return map;
}

std::optional<MapPair> least_margin(const OperatingMap& map) {
  std::optional<MapPair> least;
  for (const MapPair& pair : map.points) {
    const std::optional<double>& margin = pair.backward.backdriving_margin;
    if (margin && (!least || *margin < *least->backward.backdriving_margin)) least = pair;
  }
  return least;
}

}  // namespace gear3k::design
