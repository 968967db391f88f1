#include "strength/load_factors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "backlash/pitch_grade.hpp"
#include "units/units.hpp"

namespace gear3k::strength {

namespace {

constexpr double kStiffnessUnit_Pa = 1e9;  ///< 1 N/(mm µm)
constexpr int kFinestDynamicGrade = 3;
constexpr std::array<double, 6> kGradeTerms{2.1, 3.9, 7.5, 14.9, 26.8, 39.1};
constexpr std::array<double, 4> kM56MeshLoads{1.0, 1.2, 1.3, 1.4};
constexpr std::array<double, 4> kDrivetrainMeshLoads{1.1, 1.25, 1.35, 1.44};

void check_not_negative(std::string_view name, double value) {
  if (!(value >= 0.0)) {
    throw std::invalid_argument(
        fmt::format("load factors: {} = {}, allowed: 0 or more", name, value));
  }
}
void check_above_zero(std::string_view name, double value) {
  if (!(value > 0.0)) {
    throw std::invalid_argument(
        fmt::format("load factors: {} = {}, allowed: above 0", name, value));
  }
}

/// A factor held between 1 and a limit (which is not below 1).
template <class T>
Factor<T> held_factor(const T& value, const T& limit) {
  if (value_of(value) <= 1.0 || value_of(limit) <= 1.0) {
    return {.branch = "held at 1", .source = sources::kMekanika};
  }
  if (value_of(value) >= value_of(limit)) {
    return {.value = limit, .branch = "held at its limit", .source = sources::kMekanika};
  }
  return {.value = value, .branch = "by deviation", .source = sources::kMekanika};
}

}  // namespace

template <class T>
T line_load_n_mm(const LoadedMesh<T>& mesh) {
  check_above_zero("face width [m]", value_of(mesh.face_width_m));
  check_not_negative("tangential force [N]", value_of(mesh.tangential_N));
  return mesh.tangential_N * mesh.application_factor / (mesh.face_width_m / units::kMillimetre);
}

template <class T>
T dynamic_speed(const LoadedMesh<T>& mesh) {
  const double u = mesh.tooth_ratio;
  return magnitude(mesh.speed_m_s) * (mesh.pinion_teeth / 100.0 * u / std::sqrt(1.0 + u * u));
}

template <class T>
Factor<T> dynamic_factor(const LoadedMesh<T>& mesh, std::optional<int> grade) {
  if (!grade) return {.branch = "accuracy grade not stated", .source = sources::kNotStated};
  const int coarsest = kFinestDynamicGrade + static_cast<int>(kGradeTerms.size()) - 1;
  if (*grade < kFinestDynamicGrade || *grade > coarsest) {
    throw std::invalid_argument(
        fmt::format("dynamic factor: accuracy grade = {}, allowed: {} to {}", *grade,
                    kFinestDynamicGrade, coarsest));
  }
  if (value_of(mesh.speed_m_s) == 0.0) return {.branch = "at rest", .source = sources::kM56};
  const double k1 = kGradeTerms[static_cast<std::size_t>(*grade - kFinestDynamicGrade)];
  const T v = dynamic_speed(mesh);
  const T w = larger(line_load_n_mm(mesh), constant<T>(100.0));
  const bool slow = value_of(v) <= 0.2;
  const bool in_range = value_of(v) < kGreatestDynamicSpeed;
  const T held = in_range ? v : constant<T>(kGreatestDynamicSpeed);
  const T k3 = slow ? constant<T>(2.0) : T(2.071 - 0.357 * held);
  return {.value = 1.0 + (k1 / w + 0.0193) * held * k3,
          .branch = slow       ? "method C, slow"
                    : in_range ? "method C"
                               : "method C, held at its greatest speed",
          .source = sources::kM56,
          .in_range = in_range};
}

template <class T>
Factor<T> face_load_factor(const LoadedMesh<T>& mesh, const T& misalignment_m,
                           const T& stiffness_Pa) {
  using std::sqrt;
  check_not_negative("misalignment [m]", value_of(misalignment_m));
  if (is_neutral(misalignment_m, 0.0)) {
    return {.branch = "no misalignment stated", .source = sources::kNotStated};
  }
  const T w = line_load_n_mm(mesh);
  check_above_zero("line load [N/mm]", value_of(w));
  check_above_zero("mesh stiffness [Pa]", value_of(stiffness_Pa));
  const T q =
      (misalignment_m / units::kMicrometre) * (stiffness_Pa / kStiffnessUnit_Pa) / (2.0 * w);
  const bool whole = value_of(q) < 1.0;
  return {.value = whole ? T(1.0 + q) : T(2.0 * sqrt(q)),
          .branch = whole ? "whole face in contact" : "part of the face in contact",
          .source = sources::kMekanika};
}

template <class T>
Factor<T> root_face_load_factor(const T& flank_factor, const T& height_to_width) {
  using std::exp, std::log;
  check_above_zero("height over width", value_of(height_to_width));
  check_above_zero("K_Hbeta", value_of(flank_factor));
  const bool held = value_of(height_to_width) > 1.0 / 3.0;
  const T ratio = held ? constant<T>(1.0 / 3.0) : height_to_width;
  return {.value = exp(log(flank_factor) / (1.0 + ratio + ratio * ratio)),
          .branch = held ? "h/b held at 1/3" : "h/b",
          .source = sources::kM56};
}

template <class T>
TransverseLoadFactors<T> transverse_load_factors(const LoadedMesh<T>& mesh,
                                                 const TransverseDeviation<T>& deviation) {
  using std::sqrt;
  check_not_negative("base pitch deviation [m]", value_of(deviation.base_pitch_deviation_m));
  check_not_negative("running-in allowance [m]", value_of(deviation.running_in_m));
  check_not_negative("mesh stiffness [Pa]", value_of(deviation.stiffness_Pa));
  const T load = line_load_n_mm(mesh) * deviation.dynamic_factor * deviation.face_load_factor;
  check_above_zero("line load [N/mm]", value_of(load));
  const T left = (deviation.base_pitch_deviation_m - deviation.running_in_m) / units::kMicrometre;
  const T q = (deviation.stiffness_Pa / kStiffnessUnit_Pa) * left / load;
  const T& epsilon = mesh.contact_ratio;
  const T value = value_of(epsilon) <= 2.0
                      ? T(0.5 * epsilon * (0.9 + 0.4 * q))
                      : T(0.9 + 0.4 * sqrt(2.0 * (epsilon - 1.0) / epsilon) * q);
  const T z_eps_square = (4.0 - smaller(epsilon, constant<T>(3.0))) / 3.0;
  return {.flank = held_factor(value, T(1.0 / z_eps_square)),
          .root = held_factor(value, T(epsilon / (0.25 * epsilon + 0.75)))};
}

std::optional<double> base_pitch_deviation(double module_m, double reference_diameter_m,
                                           double alpha_rad, int grade) {
  const auto tolerances = backlash::pitch_grade(
      {.module_m = module_m, .reference_diameter_m = reference_diameter_m}, grade);
  if (!tolerances) return std::nullopt;
  return tolerances->single_pitch_m * std::cos(alpha_rad);
}

template <class T>
T running_in_allowance(MaterialGroup group, std::optional<double> flank_limit_Pa,
                       const T& deviation_m) {
  if (is_surface_hardened(group)) {
    return smaller(T(0.075 * deviation_m), constant<T>(3.0 * units::kMicrometre));
  }
  const bool soft = group == MaterialGroup::kNormalised || group == MaterialGroup::kThroughHardened;
  if (!soft || !flank_limit_Pa) return constant<T>(0.0);
  check_above_zero("flank limit [Pa]", *flank_limit_Pa);
  return deviation_m * std::min(1.0, 160.0 / (*flank_limit_Pa / 1e6));
}

std::optional<Factor<double>> mesh_load_factor(MeshLoadTable table, int planets) {
  if (planets < 1) {
    throw std::invalid_argument(
        fmt::format("mesh load factor: planets = {}, allowed: 1 or more", planets));
  }
  if (planets < 3) return std::nullopt;
  const auto row = static_cast<std::size_t>(std::min(planets, 6) - 3);
  const bool m56 = table == MeshLoadTable::kM56;
  return Factor<double>{.value = m56 ? kM56MeshLoads[row] : kDrivetrainMeshLoads[row],
                        .branch = "by number of planets",
                        .source = m56 ? sources::kM56 : sources::kDrivetrain};
}

#define INSTANTIATE(T)                                                                \
  template T dynamic_speed<T>(const LoadedMesh<T>&);                                  \
  template T line_load_n_mm<T>(const LoadedMesh<T>&);                                 \
  template Factor<T> dynamic_factor<T>(const LoadedMesh<T>&, std::optional<int>);     \
  template Factor<T> face_load_factor<T>(const LoadedMesh<T>&, const T&, const T&);   \
  template Factor<T> root_face_load_factor<T>(const T&, const T&);                    \
  template T running_in_allowance<T>(MaterialGroup, std::optional<double>, const T&); \
  template TransverseLoadFactors<T> transverse_load_factors<T>(const LoadedMesh<T>&,  \
                                                               const TransverseDeviation<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
