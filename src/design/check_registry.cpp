// What each check evaluates, and its record.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "design/checks.hpp"
#include "geometry/interference.hpp"

namespace gear3k::design {

namespace {

template <class T>
const geometry::GearGeometry<T>& gear_at(const Gearing<T>& g, int index) {
  return g.gears[static_cast<std::size_t>(index)];
}

// What each check evaluates.

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

template <class Check>
CheckRecord with_values(CheckRecord record) {
  record.value = &Check::template value<double>;
  record.value1 = &Check::template value<Jet1>;
  record.value2 = &Check::template value<Jet2>;
  return record;
}

const std::array<CheckRecord, kCheckCount>& records() {
  static const std::array<CheckRecord, kCheckCount> kRecords{
      with_values<Undercut>(CheckRecord{.id = CheckId::kUndercut,
                                        .name = "undercut",
                                        .title = "profile shift above undercut",
                                        .group = "teeth",
                                        .unit = Unit::kModule,
                                        .scope = CheckScope::kExternalGear,
                                        .at_least = true,
                                        .default_limit = 0.0,
                                        .limit_key = "",
                                        .help = "least profile shift above the one at which a rack "
                                                "undercuts the gear"}),
      with_values<TipThickness>(CheckRecord{.id = CheckId::kTipThickness,
                                            .name = "tip_thickness",
                                            .title = "tip thickness",
                                            .group = "teeth",
                                            .unit = Unit::kModule,
                                            .scope = CheckScope::kExternalGear,
                                            .at_least = true,
                                            .default_limit = 0.25,
                                            .limit_key = "",
                                            .help =
                                                "least tooth thickness on the tip circle of S, P1 "
                                                "and P2, in the gear's own module"}),
      with_values<TipThickness>(CheckRecord{.id = CheckId::kRingTipThickness,
                                            .name = "ring_tip_thickness",
                                            .title = "ring tip thickness",
                                            .group = "teeth",
                                            .unit = Unit::kModule,
                                            .scope = CheckScope::kRing,
                                            .at_least = true,
                                            .default_limit = 0.25,
                                            .limit_key = "",
                                            .help =
                                                "least tooth thickness on the tip circle of R1 and "
                                                "R2, in the ring's own module"}),
      with_values<RingTipOutsideBase>(CheckRecord{.id = CheckId::kRingTipOutsideBase,
                                                  .name = "ring_tip_outside_base",
                                                  .title = "ring tip outside base circle",
                                                  .group = "teeth",
                                                  .unit = Unit::kModule,
                                                  .scope = CheckScope::kRing,
                                                  .at_least = true,
                                                  .default_limit = 0.0,
                                                  .limit_key = "",
                                                  .help = "least distance of a ring's tip circle "
                                                          "outside its base circle"}),
      with_values<InvoluteInterference>(CheckRecord{
          .id = CheckId::kInvoluteInterference,
          .name = "involute_interference",
          .title = "tip to mate's base tangent point",
          .group = "interference",
          .unit = Unit::kModule,
          .scope = CheckScope::kTip,
          .at_least = true,
          .default_limit = 0.0,
          .limit_key = "",
          .help = "least room on the line of action between a tip's contact point and the "
                  "tangent point of the mate's base circle"}),
      with_values<FormCircle>(CheckRecord{
          .id = CheckId::kFormCircle,
          .name = "form_circle",
          .title = "start of active profile to form circle",
          .group = "interference",
          .unit = Unit::kModule,
          .scope = CheckScope::kMember,
          .at_least = true,
          .default_limit = 0.0,
          .limit_key = "",
          .tooth_form = true,
          .help = "least length of flank, along the line of action, between the last point that "
                  "the mate's tip touches and the form circle where the root fillet begins"}),
      with_values<TipFouling>(CheckRecord{.id = CheckId::kTipFouling,
                                          .name = "tip_fouling",
                                          .title = "tip corner to mate's fillet",
                                          .group = "interference",
                                          .unit = Unit::kModule,
                                          .scope = CheckScope::kMember,
                                          .at_least = true,
                                          .default_limit = 0.0,
                                          .limit_key = "",
                                          .tooth_form = true,
                                          .help = "least gap between a tip corner and the mate's "
                                                  "root fillet on the whole way through the mesh"}),
      with_values<RootClearance>(CheckRecord{.id = CheckId::kRootClearance,
                                             .name = "root_clearance",
                                             .title = "tip to mate's root circle",
                                             .group = "interference",
                                             .unit = Unit::kModule,
                                             .scope = CheckScope::kMember,
                                             .at_least = true,
                                             .default_limit = 0.0,
                                             .limit_key = "",
                                             .help = "least radial clearance between a tip circle "
                                                     "and the mate's root circle"}),
      with_values<TrochoidInterference>(CheckRecord{
          .id = CheckId::kTrochoidInterference,
          .name = "trochoid_interference",
          .title = "tip corners off the line of action",
          .group = "interference",
          .unit = Unit::kModule,
          .scope = CheckScope::kInternalMesh,
          .at_least = true,
          .default_limit = 0.0,
          .limit_key = "",
          .help = "least arc between the tip corners of pinion and ring where their tip circles "
                  "cross"}),
      with_values<Trimming>(CheckRecord{.id = CheckId::kTrimming,
                                        .name = "trimming",
                                        .title = "radial assembly of the pinion",
                                        .group = "assembly",
                                        .unit = Unit::kModule,
                                        .scope = CheckScope::kInternalMesh,
                                        .at_least = true,
                                        .default_limit = std::nullopt,
                                        .limit_key = "",
                                        .help = "least arc between the tip corners of pinion and "
                                                "ring when the pinion is put in radially; off, as "
                                                "planets are put in along the axis"}),
      with_values<RingCutter>(CheckRecord{.id = CheckId::kRingCutter,
                                          .name = "ring_cutter",
                                          .title = "cutter leaves the ring's flank",
                                          .group = "teeth",
                                          .unit = Unit::kModule,
                                          .scope = CheckScope::kCutRing,
                                          .at_least = true,
                                          .default_limit = 0.0,
                                          .limit_key = "",
                                          .tooth_form = true,
                                          .help = "least room of a ring's pinion cutter: its "
                                                  "involute reaches the ring's tip, and it trims "
                                                  "no tip in rolling or in radial feed"}),
      with_values<PlanetGap>(CheckRecord{.id = CheckId::kPlanetGap,
                                         .name = "planet_gap",
                                         .title = "gap between planets",
                                         .group = "room",
                                         .unit = Unit::kModule,
                                         .scope = CheckScope::kPlanetStep,
                                         .at_least = true,
                                         .default_limit = 0.5,
                                         .limit_key = "",
                                         .help =
                                             "least gap between the tip circles of neighbouring "
                                             "planets, in modules of stage 1"}),
      with_values<BodyGap>(CheckRecord{.id = CheckId::kBodyGap,
                                       .name = "body_gap",
                                       .title = "gap between passing bodies",
                                       .group = "room",
                                       .unit = Unit::kModule,
                                       .scope = CheckScope::kBodyPair,
                                       .at_least = true,
                                       .default_limit = 0.0,
                                       .limit_key = "",
                                       .help = "least radial gap, in modules of stage 1, of P2 to "
                                               "the sun and R1, of P1 to R2 and of the carrier to "
                                               "the rings, where they overlap by [axial]"}),
      with_values<ContactRatio>(CheckRecord{.id = CheckId::kContactRatioMin,
                                            .name = "contact_ratio_min",
                                            .title = "contact ratio, least",
                                            .group = "contact",
                                            .unit = Unit::kNone,
                                            .scope = CheckScope::kMesh,
                                            .at_least = true,
                                            .default_limit = 1.0,
                                            .limit_key = "contact_ratio.range",
                                            .help = "least contact ratio of every mesh"}),
      with_values<ContactRatio>(CheckRecord{.id = CheckId::kContactRatioMax,
                                            .name = "contact_ratio_max",
                                            .title = "contact ratio, greatest",
                                            .group = "contact",
                                            .unit = Unit::kNone,
                                            .scope = CheckScope::kMesh,
                                            .at_least = false,
                                            .default_limit = std::nullopt,
                                            .limit_key = "contact_ratio.range",
                                            .help = "greatest contact ratio of every mesh"}),
      with_values<Coaxiality>(CheckRecord{.id = CheckId::kCoaxiality,
                                          .name = "coaxiality",
                                          .title = "centre distance off the mesh's own",
                                          .group = "backlash",
                                          .unit = Unit::kMillimetre,
                                          .scope = CheckScope::kMesh,
                                          .at_least = false,
                                          .default_limit = std::nullopt,
                                          .limit_key = "",
                                          .help = "greatest difference between the common centre "
                                                  "distance and the zero-backlash distance of each "
                                                  "mesh (full teeth)"}),
      with_values<NormalBacklash>(CheckRecord{.id = CheckId::kNormalBacklash,
                                              .name = "normal_backlash",
                                              .title = "normal backlash",
                                              .group = "backlash",
                                              .unit = Unit::kMicrometre,
                                              .scope = CheckScope::kMesh,
                                              .at_least = true,
                                              .default_limit = 0.0,
                                              .limit_key = "backlash.min_normal_um",
                                              .help = "least normal backlash of every mesh"}),
      with_values<OutputBacklash>(CheckRecord{.id = CheckId::kOutputBacklashMin,
                                              .name = "output_backlash_min",
                                              .title = "output lost motion (backlash.model), least",
                                              .group = "backlash",
                                              .unit = Unit::kArcmin,
                                              .scope = CheckScope::kTrain,
                                              .at_least = true,
                                              .default_limit = std::nullopt,
                                              .limit_key = "backlash.min_output_arcmin",
                                              .help = "least lost motion at the output"}),
      with_values<OutputBacklash>(
          CheckRecord{.id = CheckId::kOutputBacklashMax,
                      .name = "output_backlash_max",
                      .title = "output lost motion (backlash.model), greatest",
                      .group = "backlash",
                      .unit = Unit::kArcmin,
                      .scope = CheckScope::kTrain,
                      .at_least = false,
                      .default_limit = std::nullopt,
                      .limit_key = "backlash.max_output_arcmin",
                      .help = "greatest lost motion at the output"}),
      with_values<RingRootDiameter>(CheckRecord{.id = CheckId::kRingRootDiameter,
                                                .name = "ring_root_diameter",
                                                .title = "ring root diameter",
                                                .group = "room",
                                                .unit = Unit::kMillimetre,
                                                .scope = CheckScope::kRing,
                                                .at_least = false,
                                                .default_limit = std::nullopt,
                                                .limit_key = "size.max_ring_root_diameter_mm",
                                                .help = "greatest root diameter of both rings"}),
      with_values<EqualSpacing>(CheckRecord{.id = CheckId::kEqualSpacing,
                                            .name = "equal_spacing",
                                            .title = "planets fit at equal spacing",
                                            .group = "assembly",
                                            .unit = Unit::kDegree,
                                            .scope = CheckScope::kTrain,
                                            .at_least = true,
                                            .default_limit = 0.0,
                                            .threshold = false,
                                            .limit_key = "",
                                            .help =
                                                "zS + zR1 divisible by the number of planets; the "
                                                "margin is the carrier angle from the first "
                                                "planet to the nearest position that fits"}),
      with_values<IdenticalPlanets>(CheckRecord{.id = CheckId::kIdenticalPlanets,
                                                .name = "identical_planets",
                                                .title = "planets are one and the same part",
                                                .group = "assembly",
                                                .unit = Unit::kDegree,
                                                .scope = CheckScope::kTrain,
                                                .at_least = true,
                                                .default_limit = 0.0,
                                                .threshold = false,
                                                .limit_key = "identical_planets",
                                                .help =
                                                    "equal planets can be assembled; the margin is "
                                                    "the largest P1/P2 phase that a planet needs"}),
  };
  return kRecords;
}

}  // namespace

std::span<const CheckRecord> check_records() { return records(); }

}  // namespace gear3k::design
