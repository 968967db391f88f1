#include "design/checks.hpp"

#include <algorithm>
#include <numbers>

#include "geometry/interference.hpp"

namespace gear3k::design {

namespace {

constexpr double kArcmin_rad = std::numbers::pi / 180.0 / 60.0;

struct UnitRecord {
  std::string_view name;
  double si;
};
constexpr std::array<UnitRecord, 6> kUnits{{{"", 1.0},
                                            {"module", 1.0},
                                            {"mm", 1e-3},
                                            {"um", 1e-6},
                                            {"arcmin", kArcmin_rad},
                                            {"deg", std::numbers::pi / 180.0}}};

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
          .unit = Unit::kModule,
          .scope = CheckScope::kTip,
          .at_least = true,
          .default_limit = 0.0,
          .limit_key = "",
          .help = "least room on the line of action between a tip's contact point and the "
                  "tangent point of the mate's base circle"}),
      with_values<PlanetGap>(CheckRecord{.id = CheckId::kPlanetGap,
                                         .name = "planet_gap",
                                         .title = "gap between planets",
                                         .unit = Unit::kModule,
                                         .scope = CheckScope::kPlanetStep,
                                         .at_least = true,
                                         .default_limit = 0.5,
                                         .limit_key = "",
                                         .help =
                                             "least gap between the tip circles of neighbouring "
                                             "planets, in modules of stage 1"}),
      with_values<ContactRatio>(CheckRecord{.id = CheckId::kContactRatioMin,
                                            .name = "contact_ratio_min",
                                            .title = "contact ratio, least",
                                            .unit = Unit::kNone,
                                            .scope = CheckScope::kMesh,
                                            .at_least = true,
                                            .default_limit = 1.0,
                                            .limit_key = "contact_ratio.range",
                                            .help = "least contact ratio of every mesh"}),
      with_values<ContactRatio>(CheckRecord{.id = CheckId::kContactRatioMax,
                                            .name = "contact_ratio_max",
                                            .title = "contact ratio, greatest",
                                            .unit = Unit::kNone,
                                            .scope = CheckScope::kMesh,
                                            .at_least = false,
                                            .default_limit = std::nullopt,
                                            .limit_key = "contact_ratio.range",
                                            .help = "greatest contact ratio of every mesh"}),
      with_values<NormalBacklash>(CheckRecord{.id = CheckId::kNormalBacklash,
                                              .name = "normal_backlash",
                                              .title = "normal backlash",
                                              .unit = Unit::kMicrometre,
                                              .scope = CheckScope::kMesh,
                                              .at_least = true,
                                              .default_limit = 0.0,
                                              .limit_key = "backlash.min_normal_um",
                                              .help = "least normal backlash of every mesh"}),
      with_values<OutputBacklash>(CheckRecord{.id = CheckId::kOutputBacklashMin,
                                              .name = "output_backlash_min",
                                              .title = "output lost motion (backlash.model), least",
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
                      .unit = Unit::kArcmin,
                      .scope = CheckScope::kTrain,
                      .at_least = false,
                      .default_limit = std::nullopt,
                      .limit_key = "backlash.max_output_arcmin",
                      .help = "greatest lost motion at the output"}),
      with_values<RingRootDiameter>(CheckRecord{.id = CheckId::kRingRootDiameter,
                                                .name = "ring_root_diameter",
                                                .title = "ring root diameter",
                                                .unit = Unit::kMillimetre,
                                                .scope = CheckScope::kRing,
                                                .at_least = false,
                                                .default_limit = std::nullopt,
                                                .limit_key = "size.max_ring_root_diameter_mm",
                                                .help = "greatest root diameter of both rings"}),
      with_values<EqualSpacing>(CheckRecord{.id = CheckId::kEqualSpacing,
                                            .name = "equal_spacing",
                                            .title = "planets fit at equal spacing",
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

std::string_view unit_name(Unit unit) { return kUnits[static_cast<std::size_t>(unit)].name; }
double in_unit(double value_si, Unit unit) {
  return value_si / kUnits[static_cast<std::size_t>(unit)].si;
}
double from_unit(double value, Unit unit) {
  return value * kUnits[static_cast<std::size_t>(unit)].si;
}

std::span<const CheckRecord> check_records() { return records(); }

const CheckRecord& check_record(CheckId id) { return records()[static_cast<std::size_t>(id)]; }

Limits default_limits() {
  Limits limits;
  for (const CheckRecord& r : records()) {
    if (r.default_limit) limits[r.id] = from_unit(*r.default_limit, r.unit);
  }
  return limits;
}

GearingLayout train_layout(int planets, double stage1_module_m) {
  using geometry::GearKind;
  static constexpr std::array<GearKind, train::kGearCount> kKinds{
      train::kind_of(train::kS), train::kind_of(train::kP1), train::kind_of(train::kR1),
      train::kind_of(train::kP2), train::kind_of(train::kR2)};
  return {.gear_kinds = kKinds,
          .mesh_gears = train::kMeshGears,
          .planets = planets,
          .length_scale_m = stage1_module_m};
}

namespace {

double scale_of(const CheckRecord& record, double limit, double length_scale_m) {
  switch (record.unit) {
    case Unit::kNone:
    case Unit::kModule:
      return 1.0;
    case Unit::kMicrometre:
      return length_scale_m;
    case Unit::kMillimetre:
      return limit > 0.0 ? limit : length_scale_m;
    case Unit::kArcmin:
      return limit > 0.0 ? limit : kArcmin_rad;
    case Unit::kDegree:
      // Angles of assembly are zero when it fits, and never small otherwise.
      return 1e-6;
  }
  return 1.0;
}

}  // namespace

std::vector<CheckInstance> list_checks(const Limits& limits, const GearingLayout& layout) {
  std::vector<CheckInstance> checks;
  for (const CheckRecord& r : records()) {
    const std::optional<double>& limit = limits[r.id];
    if (!limit) continue;
    const double scale = scale_of(r, *limit, layout.length_scale_m);
    const auto add = [&](CheckSubject subject) {
      checks.push_back({.record = &r, .subject = subject, .limit = *limit, .scale = scale});
    };
    const int gears = static_cast<int>(layout.gear_kinds.size());
    const int meshes = static_cast<int>(layout.mesh_gears.size());
    const auto kind = [&](int i) { return layout.gear_kinds[static_cast<std::size_t>(i)]; };
    switch (r.scope) {
      case CheckScope::kExternalGear:
      case CheckScope::kRing: {
        const auto wanted = r.scope == CheckScope::kRing ? geometry::GearKind::kRing
                                                         : geometry::GearKind::kExternal;
        for (int i = 0; i < gears; ++i) {
          if (kind(i) == wanted) add({.member = i, .which = 0});
        }
        break;
      }
      case CheckScope::kMesh:
        for (int k = 0; k < meshes; ++k) add({.member = k, .which = 0});
        break;
      case CheckScope::kTip:
        for (int k = 0; k < meshes; ++k) {
          const auto [first, second] = layout.mesh_gears[static_cast<std::size_t>(k)];
          if (kind(second) == geometry::GearKind::kExternal) add({.member = k, .which = 1});
          add({.member = k, .which = 2});
        }
        break;
      case CheckScope::kPlanetStep:
        if (layout.planets > 1) {
          add({.member = train::kP1, .which = 0});
          add({.member = train::kP2, .which = 0});
        }
        break;
      case CheckScope::kTrain:
        if (layout.planets > 0) add({.member = 0, .which = 0});
        break;
    }
  }
  return checks;
}

template <class T>
T check_value(const CheckInstance& check, const Gearing<T>& gearing) {
  if constexpr (std::is_same_v<T, double>) {
    return check.record->value(gearing, check.subject);
  } else if constexpr (std::is_same_v<T, Jet1>) {
    return check.record->value1(gearing, check.subject);
  } else {
    return check.record->value2(gearing, check.subject);
  }
}

SubjectNames subject_names(const CheckInstance& check, std::span<const std::string_view> gears,
                           std::span<const std::string_view> meshes,
                           std::span<const std::array<int, 2>> mesh_gears) {
  const auto index = static_cast<std::size_t>(check.subject.member);
  switch (check.record->scope) {
    case CheckScope::kExternalGear:
    case CheckScope::kRing:
    case CheckScope::kPlanetStep:
      return {.mesh = "", .gear = std::string(gears[index])};
    case CheckScope::kMesh:
      return {.mesh = std::string(meshes[index]), .gear = ""};
    case CheckScope::kTip: {
      const auto pair = mesh_gears[index];
      const int gear = check.subject.which == 1 ? pair[0] : pair[1];
      return {.mesh = std::string(meshes[index]),
              .gear = std::string(gears[static_cast<std::size_t>(gear)])};
    }
    case CheckScope::kTrain:
      break;
  }
  return {};
}

template <class T>
Gearing<T> gearing_of(const train::TrainGeometry<T>& train,
                      const std::array<T, train::kMeshCount>& normal_backlash_m,
                      backlash::LostMotionModel model) {
  return {.gears = train.gears,
          .meshes = train.meshes,
          .mesh_gears = train::kMeshGears,
          .normal_backlash_m = normal_backlash_m,
          .train = &train,
          .model = model};
}

#define INSTANTIATE(T)                                                       \
  template T check_value<T>(const CheckInstance&, const Gearing<T>&);        \
  template Gearing<T> gearing_of<T>(const train::TrainGeometry<T>&,          \
                                    const std::array<T, train::kMeshCount>&, \
                                    backlash::LostMotionModel);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)

}  // namespace gear3k::design
