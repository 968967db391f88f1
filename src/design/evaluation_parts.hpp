#pragma once
// What the evaluations of a train and of a pair have in common: internal to design/.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "design/evaluation.hpp"

namespace gear3k::design {

/// That a mesh has no working pressure angle at a centre distance.
/// @param base_sum_m  geometry::base_radius_sum()
NotDefined no_working_angle(std::string_view mesh, double center_distance_m, double base_sum_m);

/// The root of each gear.
template <std::size_t N>
std::array<geometry::ToothForm<double>, N> tooth_forms(
    const std::array<geometry::GearGeometry<double>, N>& gears) {
  std::array<geometry::ToothForm<double>, N> forms;
  std::ranges::transform(gears, forms.begin(), geometry::make_tooth_form<double>);
  return forms;
}

/// What is known of a gear.
/// @param pin_diameter_m  empty: chosen by geometry::pin_measure()
GearResult gear_result(std::string_view name, const geometry::GearGeometry<double>& g,
                       const geometry::ToothForm<double>& form,
                       std::optional<double> pin_diameter_m);

/// A mesh with its gears.
struct Pairing {
  std::string_view name;
  const geometry::GearGeometry<double>& gear1;
  const geometry::GearGeometry<double>& gear2;
  const geometry::MeshGeometry<double>& mesh;
  bool gear1_drives;  ///< forward
};

/// Coefficients of friction of a mesh when the train is driven forward and backward.
struct MeshFriction {
  double forward, backward;
};

/// What is known of a mesh at its friction in either drive direction of the train.
MeshResult mesh_result(const Pairing& p, const Friction& friction, const MeshFriction& mu);

/// The load of a design, where one is stated.
template <class AnyDesign>
const strength::RatingTask* stated_load(const AnyDesign& design) {
  return design.rating ? &*design.rating : nullptr;
}

/// The range of temperature of a design, where one is stated.
inline const train::ThermalRange* stated_range(const Design& design) {
  return design.thermal ? &*design.thermal : nullptr;
}

/// Names of the members that checks are about.
struct CheckNames {
  std::span<const std::string_view> gears, meshes;
};

/// Value and margin of every check.
std::vector<CheckResult> run_checks(const std::vector<CheckInstance>& checks,
                                    const Gearing<double>& gearing, const CheckNames& names);

/// What the tolerances make of a gearing and its checks; says so where they leave no mesh.
template <class Stated>
std::optional<ToleranceLimits> limits_within(const std::optional<Stated>& tolerances,
                                             const DrawnGearing& drawn,
                                             const std::vector<CheckInstance>& checks,
                                             std::vector<std::string>& notes) {
  if (!tolerances) return std::nullopt;
  auto limits = tolerance_limits(drawn, tolerances->gears, tolerances->center_distance_m, checks);
  if (!limits) {
    notes.emplace_back(
        "the tolerances have no minimum and maximum: at an end of tolerances.center_distance_um a "
        "mesh has no working pressure angle");
  } else if (!limits->gears_without_rim.empty()) {
    notes.push_back(
        fmt::format("at a corner of the tolerances no material is left under the root of {}: its "
                    "teeth have no rating there",
                    fmt::join(limits->gears_without_rim, ", ")));
  }
  return limits;
}

/// Says where the loss model or the efficiency of a mesh does not hold.
void note_loss_model(const std::vector<MeshResult>& meshes, std::vector<std::string>& notes);
/// Says which teeth are pointed below their tip circle.
void note_pointed_teeth(const std::vector<GearResult>& gears, std::vector<std::string>& notes);

}  // namespace gear3k::design
