#include "design/friction_range.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "design/train_motion.hpp"
#include "units/units.hpp"

namespace gear3k::design {

namespace {

using efficiency::FrictionLaw;
using train::kMeshCount;

/// What the friction of each mesh was taken at, by the drive directions in which the gearbox runs.
using RunningMeshes = std::array<std::vector<efficiency::MeshState<double>>, kMeshCount>;

RunningMeshes running_meshes(const LossyTrain<double>& train, const OperatingResult& operation) {
  const OperatingPoint<double>& point = operation.point;
  const double output_speed =
      point.sun_speed_rad_s / std::abs(train::speed_ratios(train.geometry.teeth).sun);
  const auto motion = kinematics(train.geometry, output_speed);
  RunningMeshes states;
  for (const auto* result : {&operation.forward, &operation.backward}) {
    if (!result->operation) continue;
    const auto torque_Nm = [&](std::size_t k) {
      return result->operation->mesh[k].normal_force_N * train.geometry.planets *
             motion[k].central_base_radius_m;
    };
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const auto stage = static_cast<std::size_t>(train::stage_of(train::kMeshGears[k][0]));
      states[k].push_back(
          {.normal_force_N = result->operation->mesh[k].normal_force_N,
           .sliding_speed_m_s = motion[k].sliding_speed_m_s,
           .sum_speed_m_s = motion[k].sum_speed_m_s,
           .reduced_radius_m = motion[k].reduced_radius_m,
           .face_width_m = train.face_width_m[stage],
           .temperature_K = point.temperature_K,
           .forward = result == &operation.forward,
           .ring2_torque_Nm = torque_Nm(train::kMeshP2R2),
           .own_torque_Nm = ring2_torque_by(train.geometry.teeth, k, torque_Nm(k))});
    }
  }
  return states;
}

/// "S-P1 12.3 N/mm, 0.25 m/s; P1-R1 ..." of the meshes that are outside, in either direction.
/// @param text  of a state that is outside, empty of one that is not
template <class Text>
std::string meshes_outside(const RunningMeshes& meshes, const Text& text) {
  std::vector<std::string> outside;
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    for (const auto& state : meshes[k]) {
      const std::string values = text(state);
      if (values.empty()) continue;
      outside.push_back(fmt::format("{} {}", train::kMeshNames[k], values));
      break;
    }
  }
  return fmt::format("{}", fmt::join(outside, "; "));
}

void note_cut(const Friction& friction, const RunningMeshes& meshes,
              std::vector<std::string>& notes) {
  const std::string outside = meshes_outside(meshes, [&](const auto& state) -> std::string {
    const auto mu = efficiency::uncut_friction_coefficient(friction, state);
    if (!mu || *mu <= efficiency::kGreatestFriction) return "";
    return fmt::format("{:.3g}", *mu);
  });
  if (outside.empty()) return;
  notes.push_back(
      fmt::format("the coefficient of friction is cut at {:g}, the greatest of any law; by {} {}",
                  efficiency::kGreatestFriction,
                  efficiency::kFrictionLawNames[static_cast<std::size_t>(friction.law)], outside));
}

/// One point stands for all: nothing depends on that variable.
bool is_beyond(const std::vector<double>& points, double x) {
  return points.size() > 1 && (x < points.front() || x > points.back());
}

void note_table_edge(const efficiency::FrictionTable& table, const RunningMeshes& meshes,
                     std::vector<std::string>& notes) {
  const std::string outside = meshes_outside(meshes, [&](const auto& state) {
    std::vector<std::string> values;
    if (is_beyond(table.sliding_speed_m_s, state.sliding_speed_m_s)) {
      values.push_back(fmt::format("{:.3g} m/s", state.sliding_speed_m_s));
    }
    if (is_beyond(table.tooth_force_N, state.normal_force_N)) {
      values.push_back(fmt::format("{:.4g} N", state.normal_force_N));
    }
    return fmt::format("{}", fmt::join(values, ", "));
  });
  if (outside.empty()) return;
  std::vector<std::string> ranges;
  const auto add = [&](const std::vector<double>& points, const char* unit) {
    if (points.size() < 2) return;
    ranges.push_back(fmt::format("{:g} to {:g} {}", points.front(), points.back(), unit));
  };
  add(table.sliding_speed_m_s, "m/s");
  add(table.tooth_force_N, "N");
  notes.push_back(fmt::format("the friction table ({}) is left, its edge is taken: {}",
                              fmt::join(ranges, ", "), outside));
}

void note_small_and_slow(const RunningMeshes& meshes, std::vector<std::string>& notes) {
  const auto n_mm = [](double line_load_N_m) {
    return units::from_si(line_load_N_m, units::Unit::kNewtonPerMillimetre);
  };
  const std::string outside = meshes_outside(meshes, [&](const auto& state) -> std::string {
    const double line_load_N_m = state.normal_force_N / state.face_width_m;
    if (line_load_N_m >= efficiency::kSchlenkLeastLineLoad_N_m &&
        state.sum_speed_m_s >= efficiency::kSchlenkLeastSumSpeed_m_s) {
      return "";
    }
    return fmt::format("{:.3g} N/mm, {:.3g} m/s", n_mm(line_load_N_m), state.sum_speed_m_s);
  });
  if (outside.empty()) return;
  notes.push_back(fmt::format(
      "friction law schlenk is extrapolated: a fit to industrial gears at some {:g} "
      "N/mm and a sum of speeds above {:g} m/s; {}",
      n_mm(efficiency::kSchlenkLeastLineLoad_N_m), efficiency::kSchlenkLeastSumSpeed_m_s, outside));
}

void note_viscosity(const efficiency::Lubricant<double>& oil, double temperature_K,
                    std::vector<std::string>& notes) {
  const auto [low_K, high_K] = std::minmax(oil.temperature_K[0], oil.temperature_K[1]);
  const double beyond_K = std::max(low_K - temperature_K, temperature_K - high_K);
  if (!(beyond_K > kFarFromStated_K)) return;
  const auto celsius = [](double kelvin) {
    return units::decimal_from_si(kelvin, units::Unit::kCelsius);
  };
  const double viscosity_m2_s =
      efficiency::dynamic_viscosity(oil, temperature_K) / oil.density_kgm3;
  notes.push_back(fmt::format(
      "viscosity is extrapolated by {:.4g} K: {:.3g} mm2/s at {:g} C, the lubricant is stated at "
      "{:g} and {:g} C",
      beyond_K, units::from_si(viscosity_m2_s, units::Unit::kSquareMillimetrePerSecond),
      celsius(temperature_K), celsius(low_K), celsius(high_K)));
}

}  // namespace

std::vector<std::string> friction_range_notes(const LossyTrain<double>& train,
                                              const OperatingResult& operation) {
  std::vector<std::string> notes;
  if (!operation.forward.operation && !operation.backward.operation) return notes;
  const RunningMeshes meshes = running_meshes(train, operation);
  note_cut(train.friction, meshes, notes);
  if (train.friction.law == FrictionLaw::kTable) {
    note_table_edge(train.friction.table, meshes, notes);
  }
  if (train.friction.law == FrictionLaw::kSchlenk) {
    note_small_and_slow(meshes, notes);
    note_viscosity(train.friction.lubricant, operation.point.temperature_K, notes);
  }
  return notes;
}

}  // namespace gear3k::design
