#pragma once
// What each check evaluates, on any scalar: internal to the registry of checks.  Unit, sense and
// meaning of a value are those of its record.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "backlash/unequal_mesh.hpp"
#include "design/checks.hpp"
#include "geometry/interference.hpp"

namespace gear3k::design::check_values {

template <class T>
const geometry::GearGeometry<T>& gear_at(const Gearing<T>& g, int index) {
  return g.gears[static_cast<std::size_t>(index)];
}

struct Undercut {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return geometry::undercut_margin(gear_at(g, s.member));
  }
};

struct TipThickness {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto& gear = gear_at(g, s.member);
    return geometry::tooth_thickness(gear, gear.tip_radius_m) / gear.gear.module_m;
  }
};

struct RingTipOutsideBase {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return geometry::ring_tip_above_base(gear_at(g, s.member));
  }
};

struct InvoluteInterference {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto mesh = static_cast<std::size_t>(s.member);
    const auto [first, second] = g.mesh_gears[mesh];
    return geometry::involute_interference_margin(gear_at(g, first), gear_at(g, second),
                                                  g.meshes[mesh], s.which);
  }
};

/// The mesh of a check and its two gears.
template <class T>
struct MeshView {
  const geometry::GearGeometry<T>&gear1, &gear2;
  const geometry::MeshGeometry<T>& mesh;
};
template <class T>
MeshView<T> mesh_at(const Gearing<T>& g, int index) {
  const auto mesh = static_cast<std::size_t>(index);
  const auto [first, second] = g.mesh_gears[mesh];
  return {gear_at(g, first), gear_at(g, second), g.meshes[mesh]};
}

/// Tooth form of gear 1 or 2 of a mesh.
template <class T>
const geometry::ToothForm<T>& form_at(const Gearing<T>& g, int mesh, int which) {
  const auto pair = g.mesh_gears[static_cast<std::size_t>(mesh)];
  return g.forms[static_cast<std::size_t>(which == 1 ? pair[0] : pair[1])];
}

struct FormCircle {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto [gear1, gear2, mesh] = mesh_at(g, s.member);
    return geometry::form_circle_margin(gear1, gear2, mesh, form_at(g, s.member, s.which), s.which);
  }
};

struct TipFouling {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto [gear1, gear2, mesh] = mesh_at(g, s.member);
    const int mate = s.which == 1 ? 2 : 1;
    return geometry::tip_fouling_gap(gear1, gear2, mesh, form_at(g, s.member, mate), s.which);
  }
};

struct RootClearance {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto [gear1, gear2, mesh] = mesh_at(g, s.member);
    return geometry::root_clearance(gear1, gear2, mesh, s.which);
  }
};

struct TrochoidInterference {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto [gear1, gear2, mesh] = mesh_at(g, s.member);
    return geometry::trochoid_margin(gear1, gear2, mesh);
  }
};

struct Trimming {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto [gear1, gear2, mesh] = mesh_at(g, s.member);
    return geometry::trimming_margin(gear1, gear2, mesh);
  }
};

struct RingCutter {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return geometry::ring_cutter_margin(gear_at(g, s.member),
                                        g.forms[static_cast<std::size_t>(s.member)]);
  }
};

struct BodyGap {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return train::passing_gap(*g.train, *g.axial, s.member) /
           g.train->gears[train::kS].gear.module_m;
  }
};

/// The rated tooth of a check.
template <class T>
const strength::ToothRating<T>& tooth_at(const Gearing<T>& g, CheckSubject s) {
  return g.rating[static_cast<std::size_t>(s.member)].teeth[static_cast<std::size_t>(s.which - 1)];
}

struct RootSafety {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return tooth_at(g, s).root_safety;
  }
};

struct FlankSafety {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return tooth_at(g, s).flank_safety;
  }
};

struct OverloadRootSafety {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return *tooth_at(g, s).overload_root_safety;
  }
};

struct OverloadFlankSafety {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return *tooth_at(g, s).overload_flank_safety;
  }
};

/// V of K_v.
struct DynamicSpeed {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return *g.rating[static_cast<std::size_t>(s.member)].dynamic_speed;
  }
};

/// How far x1 + x2 is inside the range of c'.
struct ShiftSumRange {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const T& sum = *g.rating[static_cast<std::size_t>(s.member)].shift_sum;
    return smaller(T(sum - strength::kLeastShiftSum), T(strength::kGreatestShiftSum - sum));
  }
};

/// How far HB is inside the range of Z_W.
struct HardnessRange {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const double hb = *tooth_at(g, s).brinell;
    return constant<T>(std::min(hb - strength::kLeastBrinell, strength::kGreatestBrinell - hb));
  }
};

struct ToothTemperature {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto& tooth = tooth_at(g, s);
    return larger(*tooth.root_temperature_K, *tooth.flank_temperature_K);
  }
};

struct ToothWear {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return *tooth_at(g, s).wear_m / mesh_at(g, s.member).gear1.gear.module_m;
  }
};

/// Rim over the least one that its factor is stated for.
struct RimThickness {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return *tooth_at(g, s).rim_over_least;
  }
};

/// How far the notch parameter is inside the range of Y_S.
struct NotchRange {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const T& q_s = tooth_at(g, s).form.notch_parameter;
    return smaller(T(q_s - strength::kLeastNotchParameter),
                   T(strength::kGreatestNotchParameter - q_s));
  }
};

struct BearingLoad {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return g.train_rating->bearing_load_N[static_cast<std::size_t>(s.member)];
  }
};

struct PinStress {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject /*s*/) {
    return *g.train_rating->pin_stress_Pa;
  }
};

struct Coaxiality {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    using std::abs;
    const auto [gear1, gear2, mesh] = mesh_at(g, s.member);
    const auto own = geometry::zero_backlash_center_distance(gear1, gear2);
    // Without such a distance at all, the whole distance is amiss.
    return own ? T(abs(mesh.center_distance_m - *own)) : mesh.center_distance_m;
  }
};

struct PlanetGap {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return train::neighbour_gap(*g.train, static_cast<train::GearId>(s.member)) /
           g.train->gears[train::kS].gear.module_m;
  }
};

struct ContactRatio {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return g.meshes[static_cast<std::size_t>(s.member)].contact_ratio;
  }
};

struct NormalBacklash {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return g.normal_backlash_m[static_cast<std::size_t>(s.member)];
  }
};

struct OutputBacklash {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const std::array<T, train::kMeshCount> j{g.normal_backlash_m[0], g.normal_backlash_m[1],
                                             g.normal_backlash_m[2]};
    if (s.which == 0) return backlash::output_lost_motion(*g.train, j, g.model);
    const auto phi = backlash::paper_lost_motion(*g.train, j);
    return phi[0] + phi[static_cast<std::size_t>(s.which)];
  }
};

/// A mesh at an end of the temperatures, with its gears as they are there.
template <class T>
struct GrownMesh {
  geometry::GearGeometry<T> gear1, gear2;
  backlash::UnequalMesh<T> mesh;
};
template <class T>
GrownMesh<T> grown_mesh(const Gearing<T>& g, int member, int end) {
  const train::ThermalRange& range = *g.thermal;
  const train::ThermalState state = train::end_state(range, end);
  const auto mesh = static_cast<std::size_t>(member);
  const auto grown = [&](int gear) {
    return train::grown_gear(
        gear_at(g, gear),
        train::growth_factor(range.gear[static_cast<std::size_t>(gear)], range.reference_K, state));
  };
  GrownMesh<T> result{grown(g.mesh_gears[mesh][0]), grown(g.mesh_gears[mesh][1]), {}};
  const double carrier = train::growth_factor(range.carrier, range.reference_K, state);
  const T distance_m = g.meshes[mesh].center_distance_m * constant<T>(carrier);
  result.mesh = backlash::make_unequal_mesh(result.gear1, result.gear2, distance_m);
  return result;
}

struct ThermalBacklash {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return grown_mesh(g, s.member, s.end).mesh.least_backlash_m;
  }
};

struct ThermalRootClearance {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const GrownMesh<T> grown = grown_mesh(g, s.member, s.end);
    return geometry::root_clearance(grown.gear1, grown.gear2, grown.mesh.mesh, s.which);
  }
};

struct ThermalLostMotion {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    train::TrainGeometry<T> train;
    train.teeth = g.train->teeth;
    std::array<T, train::kMeshCount> j{};
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const GrownMesh<T> grown = grown_mesh(g, static_cast<int>(k), s.end);
      train.gears[static_cast<std::size_t>(g.mesh_gears[k][0])] = grown.gear1;
      train.gears[static_cast<std::size_t>(g.mesh_gears[k][1])] = grown.gear2;
      j[k] = grown.mesh.normal_backlash_m;
    }
    return backlash::output_lost_motion(train, j, backlash::LostMotionModel::kKinematic);
  }
};

struct RingRootDiameter {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return 2.0 * gear_at(g, s.member).root_radius_m;
  }
};

struct EqualSpacing {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject) {
    const auto& z = g.train->teeth;
    const int n = g.train->planets;
    const int remainder = (z.S + z.R1) % n;
    // Distance from the nearest assembly position, as angle of the carrier.
    const double misfit = std::min(remainder, n - remainder);
    return constant<T>(remainder == 0 ? 0.0
                                      : -misfit * 2.0 * std::numbers::pi / (n * (z.S + z.R1)));
  }
};

struct IdenticalPlanets {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto result = train::assembly(g.train->teeth, g.train->planets);
    if (!result.equal_spacing) return EqualSpacing::value(g, s);
    const auto& z = g.train->teeth;
    const double period =
        2.0 * std::numbers::pi / static_cast<double>(train::hunting_period_teeth(z.P1, z.P2));
    double worst = 0.0;
    for (const double phase : result.planet_phase_rad) {
      worst = std::max(worst, std::min(phase, period - phase));
    }
    return constant<T>(-worst);
  }
};

}  // namespace gear3k::design::check_values
