#pragma once
// What the checks of a workshop's limits evaluate, on any scalar: internal to the registry of
// checks.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>

#include "design/check_values.hpp"
#include "geometry/sliding.hpp"
#include "train/axial_layout.hpp"

namespace gear3k::design::check_values {

struct TipThicknessLength {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto& gear = gear_at(g, s.member);
    return geometry::tooth_thickness(gear, gear.tip_radius_m);
  }
};

struct RootClearanceLength {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return RootClearance::value(g, s) * mesh_at(g, s.member).gear1.gear.module_m;
  }
};

struct SpecificSliding {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto [gear1, gear2, mesh] = mesh_at(g, s.member);
    return geometry::root_sliding(gear1, gear2, mesh, s.which);
  }
};

/// Outer radius of a ring, as stated or its root circle with the rim.
template <class T>
T ring_outer_radius(const Gearing<T>& g, int ring) {
  if (g.bodies == nullptr) return gear_at(g, ring).root_radius_m;
  const auto& stated = g.bodies->ring_outer_radius_m[ring == train::kR1 ? 0 : 1];
  return stated ? constant<T>(*stated) : T(gear_at(g, ring).root_radius_m + g.bodies->ring_rim_m);
}

/// Material between the root circle and the bore, of a ring its outer surface.
struct Wall {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto& gear = gear_at(g, s.member);
    if (gear.gear.kind == geometry::GearKind::kRing) {
      return ring_outer_radius(g, s.member) - gear.root_radius_m;
    }
    return gear.root_radius_m - g.bodies->bore_radius_m[static_cast<std::size_t>(s.member)];
  }
};

struct GearboxDiameter {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return 2.0 * ring_outer_radius(g, s.member);
  }
};

/// From the first to the last body of [axial]; without it both face widths side by side.
struct GearboxLength {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject) {
    return train::whole_length_m(g.axial != nullptr ? *g.axial : train::AxialLayout{},
                                 g.bodies->face_width_m);
  }
};

struct SunRootDiameter {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    return 2.0 * gear_at(g, s.member).root_radius_m;
  }
};

struct SameModule {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject) {
    using std::abs;
    return abs(T(gear_at(g, train::kS).gear.module_m - gear_at(g, train::kP2).gear.module_m));
  }
};

/// Greatest common factor of the teeth of a mesh.
struct HuntingTooth {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const auto [gear1, gear2, mesh] = mesh_at(g, s.member);
    return constant<T>(std::gcd(gear1.gear.teeth, gear2.gear.teeth));
  }
};

/// How far a tooth number is from the nearest one that is allowed.
struct ListedTeeth {
  template <class T>
  static T value(const Gearing<T>& g, CheckSubject s) {
    const int teeth = gear_at(g, s.member).gear.teeth;
    int least = std::numeric_limits<int>::max();
    for (const int allowed : (*g.bodies->allowed_teeth)[static_cast<std::size_t>(s.member)]) {
      least = std::min(least, std::abs(teeth - allowed));
    }
    return constant<T>(least);
  }
};

}  // namespace gear3k::design::check_values
