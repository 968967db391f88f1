#include "design/thermal_result.hpp"

#include <cmath>

#include "backlash/lost_motion.hpp"
#include "backlash/unequal_mesh.hpp"
#include "geometry/interference.hpp"

namespace gear3k::design {

namespace {

using geometry::GearGeometry, train::ThermalRange, train::ThermalState;
template <class T>
using TrainGearsOf = std::array<GearGeometry<T>, train::kGearCount>;
using TrainGears = TrainGearsOf<double>;

template <class T>
TrainGearsOf<T> grown_gears(const TrainGearsOf<T>& gears, const ThermalRange& range,
                            const ThermalState& state) {
  TrainGearsOf<T> grown;
  for (std::size_t i = 0; i < gears.size(); ++i) {
    grown[i] =
        train::grown_gear(gears[i], train::growth_factor(range.gear[i], range.reference_K, state));
  }
  return grown;
}

double carrier_factor(const ThermalRange& range, const ThermalState& state) {
  return train::growth_factor(range.carrier, range.reference_K, state);
}

std::optional<ThermalStateResult> state_result(const train::TrainGeometry<double>& drawn,
                                               const ThermalRange& range,
                                               const ThermalState& state) {
  train::TrainGeometry<double> grown = drawn;
  grown.gears = grown_gears(drawn.gears, range, state);
  grown.center_distance_m = drawn.center_distance_m * carrier_factor(range, state);
  ThermalStateResult result{.state = state, .center_distance_m = grown.center_distance_m};
  std::array<double, train::kMeshCount> j_bn{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto& gear1 = grown.gears[static_cast<std::size_t>(train::kMeshGears[k][0])];
    const auto& gear2 = grown.gears[static_cast<std::size_t>(train::kMeshGears[k][1])];
    const auto mesh = backlash::make_unequal_mesh(gear1, gear2, grown.center_distance_m);
    if (!mesh.has_working_angle) return std::nullopt;
    ThermalMesh& m = result.meshes[k];
    m = {.base_pitch_difference_m = mesh.base_pitch_difference_m,
         .working_pressure_angle_rad = mesh.mesh.alpha_w_rad,
         .contact_ratio = mesh.mesh.contact_ratio,
         .normal_backlash_m = mesh.normal_backlash_m,
         .least_backlash_m = mesh.least_backlash_m};
    for (const int which : {1, 2}) {
      m.root_clearance_m[static_cast<std::size_t>(which - 1)] =
          geometry::root_clearance(gear1, gear2, mesh.mesh, which) * gear1.gear.module_m;
    }
    j_bn[k] = mesh.normal_backlash_m;
  }
  result.lost_motion_rad =
      backlash::output_lost_motion(grown, j_bn, backlash::LostMotionModel::kKinematic);
  return result;
}

/// Play of one mesh over temperature.
class MeshPlay {
 public:
  MeshPlay(const train::TrainGeometry<double>& train, const ThermalRange& range, std::size_t mesh)
      : train_(train), range_(range), mesh_(mesh) {}

  /// The first temperature on the way from the reference at which there is none.
  [[nodiscard]] std::optional<double> first_jam(double end_K, train::Moisture moisture) const {
    constexpr int kSteps = 256;
    constexpr double kAccuracy_K = 1e-9;
    double free_K = range_.reference_K;
    if (!has_play(free_K, moisture)) return free_K;
    for (int step = 1; step <= kSteps; ++step) {
      double jammed_K = range_.reference_K + (end_K - range_.reference_K) * step / kSteps;
      if (has_play(jammed_K, moisture)) {
        free_K = jammed_K;
        continue;
      }
      while (std::abs(jammed_K - free_K) > kAccuracy_K) {
        const double middle_K = 0.5 * (free_K + jammed_K);
        (has_play(middle_K, moisture) ? free_K : jammed_K) = middle_K;
      }
      return jammed_K;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] bool has_play(double temperature_K, train::Moisture moisture) const {
    const ThermalState state{.temperature_K = temperature_K, .moisture = moisture};
    const auto grown = [&](int gear) {
      const auto i = static_cast<std::size_t>(gear);
      return train::grown_gear(train_.gears[i],
                               train::growth_factor(range_.gear[i], range_.reference_K, state));
    };
    const auto mesh = backlash::make_unequal_mesh(
        grown(train::kMeshGears[mesh_][0]), grown(train::kMeshGears[mesh_][1]),
        train_.center_distance_m * carrier_factor(range_, state));
    return mesh.least_backlash_m > 0.0;
  }

  const train::TrainGeometry<double>& train_;
  const ThermalRange& range_;
  std::size_t mesh_;
};

JamRange jam_range(const MeshPlay& play, bool swells) {
  using train::Moisture;
  JamRange jams;
  const auto of = [&](Moisture moisture) {
    const auto below = play.first_jam(0.0, moisture);
    const auto above = play.first_jam(kGreatestJam_K, moisture);
    if (below && (!jams.below_K || *below > *jams.below_K)) jams.below_K = below;
    if (above && (!jams.above_K || *above < *jams.above_K)) jams.above_K = above;
  };
  if (!swells) {
    of(Moisture::kDrawn);
  } else {
    of(Moisture::kDry);
    of(Moisture::kWet);
  }
  return jams;
}

}  // namespace

std::optional<ThermalResult> thermal_result(const train::TrainGeometry<double>& train,
                                            const ThermalRange& range) {
  ThermalResult result{.reference_K = range.reference_K, .states = {}};
  std::vector<ThermalState> states{{.temperature_K = range.reference_K}};
  for (int end = 0; end < train::end_count(range); ++end) {
    states.push_back(train::end_state(range, end));
  }
  for (const ThermalState& state : states) {
    const auto at = state_result(train, range, state);
    if (!at) return std::nullopt;
    result.states.push_back(*at);
  }
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    result.jams[k] = jam_range(MeshPlay(train, range, k), train::swells(range));
  }
  return result;
}

template <class T>
ThermalPlay<T> thermal_play(const train::TrainGeometry<T>& drawn, const ThermalRange& range,
                            const ThermalState& state) {
  train::TrainGeometry<T> grown = drawn;
  grown.gears = grown_gears(drawn.gears, range, state);
  grown.center_distance_m = drawn.center_distance_m * constant<T>(carrier_factor(range, state));
  ThermalPlay<T> play;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto mesh = backlash::make_unequal_mesh(
        grown.gears[static_cast<std::size_t>(train::kMeshGears[k][0])],
        grown.gears[static_cast<std::size_t>(train::kMeshGears[k][1])], grown.center_distance_m);
    play.normal_backlash_m[k] = mesh.normal_backlash_m;
    play.least_backlash_m[k] = mesh.least_backlash_m;
  }
  play.lost_motion_rad = backlash::output_lost_motion(grown, play.normal_backlash_m,
                                                      backlash::LostMotionModel::kKinematic);
  return play;
}
template ThermalPlay<double> thermal_play(const train::TrainGeometry<double>&, const ThermalRange&,
                                          const ThermalState&);
template ThermalPlay<Jet1> thermal_play(const train::TrainGeometry<Jet1>&, const ThermalRange&,
                                        const ThermalState&);

std::optional<NoThermalMesh> mesh_without_angle(const TrainGears& gears, double center_distance_m,
                                                const ThermalRange& range) {
  for (int end = 0; end < train::end_count(range); ++end) {
    const ThermalState state = train::end_state(range, end);
    const TrainGears grown = grown_gears(gears, range, state);
    const double distance_m = center_distance_m * carrier_factor(range, state);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const auto [first, second] = train::kMeshGears[k];
      if (!geometry::make_mesh_geometry(grown[static_cast<std::size_t>(first)],
                                        grown[static_cast<std::size_t>(second)], distance_m)) {
        return NoThermalMesh{.state = state, .mesh = k};
      }
    }
  }
  return std::nullopt;
}

}  // namespace gear3k::design
