#include "backlash/clearance_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "backlash/lost_motion.hpp"

namespace gear3k::backlash {

namespace {

using train::kP1, train::kP2, train::kR1, train::kR2, train::kS;

Body body_of(int gear) {
  switch (gear) {
    case kS:
      return Body::kSun;
    case kR1:
      return Body::kRing1;
    case kR2:
      return Body::kRing2;
    default:
      return Body::kPlanet;
  }
}
bool on_planet(int gear) { return body_of(gear) == Body::kPlanet; }

/// A vector's components along the x and the y axis of the carrier's frame.
struct Direction {
  double x = 0.0, y = 0.0;
};

class Builder {
 public:
  Builder(const train::TrainGeometry<double>& train, const Tolerances& tolerances,
          ClearanceModel& model)
      : train_(train), tolerances_(tolerances), model_(model) {}

  void add_all() {
    add_center_distance();
    for (int gear = 0; gear < train::kGearCount; ++gear) add_thickness(gear);
    add_pins();
    add_phase();
    for (int gear = 0; gear < train::kGearCount; ++gear) add_runout(gear);
    for (int gear = 0; gear < train::kGearCount; ++gear) add_cumulative_pitch(gear);
    for (int gear = 0; gear < train::kGearCount; ++gear) add_single_pitch(gear);
  }

 private:
  struct Frame {
    Direction n, t;  ///< outwards and along increasing angle at a planet
  };
  [[nodiscard]] Frame frame(int planet) const {
    const double angle = 2.0 * std::numbers::pi * planet / model_.planets;
    const double c = std::cos(angle), s = std::sin(angle);
    return {.n = {c, s}, .t = {-s, c}};
  }
  [[nodiscard]] double cos_alpha() const { return train_.gears[kS].angle.cos; }
  [[nodiscard]] static double sigma(int mesh) { return mesh == train::kMeshSP1 ? 1.0 : -1.0; }

  /// Starts a source; false where its tolerance is 0.
  bool begin(ToleranceKind kind, int gear, double half_width_m) {
    if (!(half_width_m > 0.0)) return false;
    model_.sources.push_back({.kind = kind, .gear = gear, .half_width_m = half_width_m});
    return true;
  }
  Deviation& deviation(Body body, int planet, bool planar) {
    model_.deviations.push_back(
        {.source = model_.sources.size() - 1, .body = body, .planet = planet, .planar = planar});
    return model_.deviations.back();
  }
  static void both_sides(std::vector<PlayEffect>& effects, int planet, int mesh, double to_lower,
                         double to_upper) {
    effects.push_back({.bound = bound_index(planet, mesh, false), .coefficient = to_lower});
    effects.push_back({.bound = bound_index(planet, mesh, true), .coefficient = to_upper});
  }

  /// Effects of moving the teeth of a planet (sign +1) or of a central gear (−1) at one mesh.
  void displaced(Deviation& d, int planet, int mesh, double sign) const {
    const Frame f = frame(planet);
    const auto& m = train_.meshes[static_cast<std::size_t>(mesh)];
    const double C = sign * std::cos(m.alpha_w_rad);
    const double S = sign * sigma(mesh) * std::sin(m.alpha_w_rad);
    both_sides(d.x, planet, mesh, C * f.t.x - S * f.n.x, C * f.t.x + S * f.n.x);
    both_sides(d.y, planet, mesh, C * f.t.y - S * f.n.y, C * f.t.y + S * f.n.y);
  }

  /// The sign with which a tooth's displacement along its reference circle enters u.
  [[nodiscard]] static double turning_sign(int gear, int mesh) {
    return gear == kP1 && mesh == train::kMeshP1R1 ? -1.0 : gear == kP2 ? -1.0 : 1.0;
  }

  template <class Visit>  // void(int mesh)
  static void meshes_of(int gear, Visit visit) {
    for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
      const auto k = static_cast<std::size_t>(mesh);
      if (train::kCentralGears[k] == gear || train::kPlanetGears[k] == gear) visit(mesh);
    }
  }
  /// One deviation of a central gear, or one for every planet.
  template <class Fill>  // void(Deviation&, int planet)
  void of_gear(int gear, bool planar, Fill fill) {
    if (on_planet(gear)) {
      for (int planet = 0; planet < model_.planets; ++planet) {
        fill(deviation(Body::kPlanet, planet, planar), planet);
      }
      return;
    }
    Deviation& d = deviation(body_of(gear), -1, planar);
    for (int planet = 0; planet < model_.planets; ++planet) fill(d, planet);
  }

  void add_center_distance() {
    if (!begin(ToleranceKind::kCenterDistance, -1, tolerances_.center_distance_m.half_width())) {
      return;
    }
    Deviation& d = deviation(Body::kCarrier, -1, false);
    for (int planet = 0; planet < model_.planets; ++planet) {
      for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
        const double S =
            sigma(mesh) * std::sin(train_.meshes[static_cast<std::size_t>(mesh)].alpha_w_rad);
        both_sides(d.x, planet, mesh, -S, S);
      }
    }
  }

  void add_thickness(int gear) {
    const auto& limits = tolerances_.gears[static_cast<std::size_t>(gear)].tooth_thickness_m;
    if (!begin(ToleranceKind::kToothThickness, gear, limits.half_width())) return;
    const double half = 0.5 * cos_alpha();
    of_gear(gear, false, [&](Deviation& d, int planet) {
      meshes_of(gear, [&](int mesh) { both_sides(d.x, planet, mesh, half, -half); });
    });
  }

  void add_pins() {
    if (!begin(ToleranceKind::kPinPosition, -1, 0.5 * tolerances_.pin_position_m)) return;
    for (int planet = 0; planet < model_.planets; ++planet) {
      Deviation& d = deviation(Body::kCarrier, planet, true);
      for (int mesh = 0; mesh < train::kMeshCount; ++mesh) displaced(d, planet, mesh, 1.0);
    }
  }

  void add_phase() {
    const double arc_m =
        tolerances_.planet_phase_rad.half_width() * train_.gears[kP2].base_radius_m;
    if (!begin(ToleranceKind::kPlanetPhase, -1, arc_m)) return;
    for (int planet = 0; planet < model_.planets; ++planet) {
      both_sides(deviation(Body::kCarrier, planet, false).x, planet, train::kMeshP2R2, 1.0, 1.0);
    }
  }

  void add_runout(int gear) {
    const double e_m = 0.5 * tolerances_.gears[static_cast<std::size_t>(gear)].runout_m;
    if (!begin(ToleranceKind::kRunout, gear, e_m)) return;
    of_gear(gear, true, [&](Deviation& d, int planet) {
      meshes_of(gear, [&](int mesh) { displaced(d, planet, mesh, on_planet(gear) ? 1.0 : -1.0); });
    });
  }

  void add_cumulative_pitch(int gear) {
    const auto& t = tolerances_.gears[static_cast<std::size_t>(gear)];
    const double rest_m = 0.5 * (t.cumulative_pitch_m - t.runout_m / cos_alpha());
    if (!begin(ToleranceKind::kCumulativePitch, gear, rest_m)) return;
    of_gear(gear, true, [&](Deviation& d, int planet) {
      meshes_of(gear, [&](int mesh) {
        // P1 meets the sun on its side towards the axis.
        const double side = gear == kP1 && mesh == train::kMeshSP1 ? -1.0 : 1.0;
        const double c = -side * turning_sign(gear, mesh) * cos_alpha();
        const Frame f = frame(planet);
        both_sides(d.x, planet, mesh, c * f.n.x, c * f.n.x);
        both_sides(d.y, planet, mesh, c * f.n.y, c * f.n.y);
      });
    });
  }

  void add_single_pitch(int gear) {
    // A pitch is the distance of two flanks, each of which may stand off its place.
    const double f_m = 0.5 * tolerances_.gears[static_cast<std::size_t>(gear)].single_pitch_m;
    if (!begin(ToleranceKind::kSinglePitch, gear, f_m)) return;
    for (int planet = 0; planet < model_.planets; ++planet) {
      meshes_of(gear, [&](int mesh) {
        // The two flanks in question belong to different teeth.
        for (const bool upper : {false, true}) {
          deviation(body_of(gear), planet, false)
              .x.push_back({.bound = bound_index(planet, mesh, upper),
                            .coefficient = -turning_sign(gear, mesh) * cos_alpha()});
        }
      });
    }
  }

  const train::TrainGeometry<double>& train_;
  const Tolerances& tolerances_;
  ClearanceModel& model_;
};

}  // namespace

std::string ToleranceSource::name() const {
  const std::string_view what = kToleranceKindNames[static_cast<std::size_t>(kind)];
  return gear < 0 ? std::string(what)
                  : fmt::format("{} {}", train::kGearNames[static_cast<std::size_t>(gear)], what);
}

std::optional<ClearanceModel> clearance_model(const train::TrainParameters<double>& p,
                                              const Tolerances& tolerances) {
  train::TrainParameters<double> middle = p;
  middle.center_distance_m += tolerances.center_distance_m.middle();
  const auto train = train::make_train_geometry(middle);
  if (!train) return std::nullopt;
  ClearanceModel model{.levers = output_levers(*train),
                       .planets = p.planets,
                       .middle_m = {},
                       .sources = {},
                       .deviations = {}};
  const auto j = normal_backlashes(*train);
  model.middle_m.resize(bound_index(p.planets, 0, false));
  for (int planet = 0; planet < p.planets; ++planet) {
    for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
      const auto k = static_cast<std::size_t>(mesh);
      const double thicker = tolerances.gears[train::kCentralGears[k]].tooth_thickness_m.middle() +
                             tolerances.gears[train::kPlanetGears[k]].tooth_thickness_m.middle();
      const double half = 0.5 * (j[k] - thicker * train->gears[kS].angle.cos);
      const double phase = mesh == train::kMeshP2R2 ? tolerances.planet_phase_rad.middle() *
                                                          train->gears[kP2].base_radius_m
                                                    : 0.0;
      model.middle_m[bound_index(planet, mesh, false)] = phase - half;
      model.middle_m[bound_index(planet, mesh, true)] = phase + half;
    }
  }
  Builder(*train, tolerances, model).add_all();
  return model;
}

std::vector<PlanetPlay> plays(const ClearanceModel& model, std::span<const DeviationValue> values) {
  if (values.size() != model.deviations.size()) {
    throw std::invalid_argument(fmt::format("plays: {} values, allowed: one for each of {}",
                                            values.size(), model.deviations.size()));
  }
  std::vector<double> bound = model.middle_m;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (const PlayEffect& e : model.deviations[i].x) {
      bound[e.bound] += e.coefficient * values[i].x_m;
    }
    for (const PlayEffect& e : model.deviations[i].y) {
      bound[e.bound] += e.coefficient * values[i].y_m;
    }
  }
  std::vector<PlanetPlay> result(static_cast<std::size_t>(model.planets));
  for (int planet = 0; planet < model.planets; ++planet) {
    for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
      result[static_cast<std::size_t>(planet)][static_cast<std::size_t>(mesh)] = {
          .lower_m = bound[bound_index(planet, mesh, false)],
          .upper_m = bound[bound_index(planet, mesh, true)]};
    }
  }
  return result;
}

}  // namespace gear3k::backlash
