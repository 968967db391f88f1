#include "design/checks.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "design/check_scope.hpp"

namespace gear3k::design {

const CheckRecord& check_record(CheckId id) {
  return check_records()[static_cast<std::size_t>(id)];
}

Limits default_limits() {
  Limits limits;
  for (const CheckRecord& r : check_records()) {
    if (r.default_limit) limits[r.id] = units::to_si(*r.default_limit, r.unit);
  }
  return limits;
}

bool hunts(const Limits& limits, std::size_t mesh) {
  const auto& meshes = limits.hunting_meshes;
  return meshes.empty() ||
         std::ranges::find(meshes, static_cast<train::MeshId>(mesh)) != meshes.end();
}

std::optional<double> least_backlash_m(const Limits& limits, std::size_t mesh) {
  const auto& own = limits.mesh_backlash_m[mesh];
  return own ? own : limits[CheckId::kNormalBacklash];
}

namespace {

/// Gears whose bore, of a ring whose outer surface, is known.
std::vector<bool> walled_gears(const TrainBodies<double>& bodies) {
  std::vector<bool> walled;
  for (int id = 0; id < train::kGearCount; ++id) {
    const bool ring = train::kind_of(id) == geometry::GearKind::kRing;
    const bool outer =
        bodies.ring_rim_m > 0.0 || bodies.ring_outer_radius_m[id == train::kR1 ? 0 : 1];
    walled.push_back(ring ? outer : bodies.bore_radius_m[static_cast<std::size_t>(id)] > 0.0);
  }
  return walled;
}

}  // namespace

GearingLayout train_layout(const TrainLayout& train) {
  using geometry::GearKind;
  static constexpr std::array<GearKind, train::kGearCount> kKinds{
      train::kind_of(train::kS), train::kind_of(train::kP1), train::kind_of(train::kR1),
      train::kind_of(train::kP2), train::kind_of(train::kR2)};
  GearingLayout layout{
      .gear_kinds = kKinds,
      .mesh_gears = train::kMeshGears,
      .shaped = {},
      .passing_bodies = train::overlapping_bodies(train.axial),
      .walled = walled_gears(train.bodies),
      .sized = train::whole_extent(train.axial) ||
               (train.bodies.face_width_m[0] > 0.0 && train.bodies.face_width_m[1] > 0.0),
      .planets = train.planets,
      .length_scale_m = train.stage1_module_m,
      .rating = train.rating,
      .thermal = train.thermal};
  for (const geometry::PinionCutter& cutter : train.cutter) {
    layout.shaped.push_back(cutter.teeth > 0);
  }
  return layout;
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
    case Unit::kArcmin: {
      // A limit next to nothing is no measure of what matters.
      constexpr double kLeast_rad = 0.1 * units::kArcmin;
      return limit > 0.0 ? std::max(limit, kLeast_rad) : units::kArcmin;
    }
    case Unit::kDegree:
      // Angles of assembly are zero when it fits, and never small otherwise.
      return 1e-6;
    case Unit::kNewton:
    case Unit::kMegapascal:
      return limit > 0.0 ? limit : 1.0;
    default:
      return 1.0;  // temperatures and speeds: 1 K, 1 m/s
  }
}

/// Whether a check has a value for a gear under load in the mesh with a mate.
bool applies(CheckId id, const strength::RatingTask& task, std::size_t gear, std::size_t mate) {
  const strength::GearMaterial& material = *task.material[gear];
  const bool plastic = strength::is_plastic(material.record.group);
  using strength::LimitLaw;
  switch (id) {
    case CheckId::kRootSafety:
      return material.record.root_limit.law != LimitLaw::kNotStated;
    case CheckId::kFlankSafety:
      return material.record.flank_limit.law != LimitLaw::kNotStated;
    case CheckId::kOverloadRootSafety:
      if (!task.overload) return false;
      return plastic ? material.record.yield_strength_Pa.has_value()
                     : material.record.root_limit.law != LimitLaw::kNotStated;
    case CheckId::kOverloadFlankSafety:
      return task.overload && !plastic && material.record.flank_limit.law != LimitLaw::kNotStated;
    case CheckId::kHardnessRange:
      return strength::computes_work_hardening(task, gear, mate);
    case CheckId::kToothTemperature:
      return plastic;
    case CheckId::kToothWear:
      return plastic && task.wear_coefficient_m2_N && strength::has_life(task, gear);
    case CheckId::kRimThickness:
      return !plastic && (task.rim_radius_m[gear] ||
                          (task.ring_rim_m &&
                           train::kind_of(static_cast<int>(gear)) == geometry::GearKind::kRing));
    default:
      return !plastic;
  }
}

/// From where the limit of a check on a gear under load counts: of safeties the least that the task
/// asks for, which depends on the material.
double least_of(CheckId id, const strength::RatingTask& task, std::size_t gear) {
  if (id == CheckId::kRootSafety) {
    return strength::least_root_safety(task, gear);
  }
  if (id == CheckId::kFlankSafety || id == CheckId::kOverloadFlankSafety) {
    return strength::least_flank_safety(task, gear);
  }
  if (id == CheckId::kOverloadRootSafety) {
    return strength::least_overload_root_safety(task, gear);
  }
  return 0.0;
}

/// Meshes may have a least backlash of their own.
void list_backlash(const Limits& limits, const CheckRecord& record, const GearingLayout& layout,
                   std::vector<CheckInstance>& checks) {
  for (std::size_t k = 0; k < layout.mesh_gears.size(); ++k) {
    const std::optional<double> limit = least_backlash_m(limits, k);
    if (!limit) continue;
    checks.push_back({.record = &record,
                      .subject = {.member = static_cast<int>(k), .which = 0},
                      .limit = *limit,
                      .scale = scale_of(record, *limit, layout.length_scale_m)});
  }
}

/// Whether a check of some gears is asked of this one.
bool is_of_gear(CheckScope scope, const Limits& limits, const GearingLayout& layout, int gear) {
  const auto i = static_cast<std::size_t>(gear);
  const bool ring = layout.gear_kinds[i] == geometry::GearKind::kRing;
  switch (scope) {
    case CheckScope::kGear:
      return true;
    case CheckScope::kExternalGear:
      return !ring;
    case CheckScope::kRing:
      return ring;
    case CheckScope::kCutRing:
      return ring && i < layout.shaped.size() && layout.shaped[i];
    case CheckScope::kWalledGear:
      return i < layout.walled.size() && layout.walled[i];
    case CheckScope::kListedGear:
      return layout.planets > 0 && !limits.allowed_teeth[i].empty();
    case CheckScope::kSun:
      return layout.planets > 0 && gear == train::kS;
    default:
      return false;
  }
}

/// Whether a check of some meshes is asked of this one.
bool is_of_mesh(const CheckRecord& record, const Limits& limits, const GearingLayout& layout,
                std::size_t mesh) {
  const auto first = static_cast<std::size_t>(layout.mesh_gears[mesh][0]);
  const auto second = static_cast<std::size_t>(layout.mesh_gears[mesh][1]);
  if (record.scope == CheckScope::kRatedMesh) {
    if (layout.rating == nullptr) return false;
    const auto& material = layout.rating->material;
    const auto computes = record.id == CheckId::kDynamicSpeed ? strength::computes_dynamic_factor
                                                              : strength::computes_stiffness_factor;
    return computes(*layout.rating, *material[first], *material[second]);
  }
  if (record.id == CheckId::kHuntingTooth && !hunts(limits, mesh)) return false;
  return record.scope == CheckScope::kMesh ||
         layout.gear_kinds[second] == geometry::GearKind::kRing;
}

/// Whether a check of some members of meshes is asked of this one.
bool is_of_member(const CheckRecord& record, const GearingLayout& layout, std::size_t mesh,
                  int which) {
  const auto first = static_cast<std::size_t>(layout.mesh_gears[mesh][0]);
  const auto second = static_cast<std::size_t>(layout.mesh_gears[mesh][1]);
  if (record.scope == CheckScope::kTip) {
    return which == 2 || layout.gear_kinds[second] == geometry::GearKind::kExternal;
  }
  if (record.scope != CheckScope::kRatedTooth) return true;
  if (layout.rating == nullptr) return false;
  return which == 1 ? applies(record.id, *layout.rating, first, second)
                    : applies(record.id, *layout.rating, second, first);
}

/// Subjects of a check at the ends of the temperatures.
void list_thermal(const CheckRecord& record, double limit, const GearingLayout& layout,
                  std::vector<CheckInstance>& checks) {
  if (layout.thermal == nullptr || layout.planets == 0) return;
  const bool of_train = target_of(record.scope) == CheckTarget::kTrain;
  const int members = of_train ? 1 : static_cast<int>(layout.mesh_gears.size());
  const bool of_gear = target_of(record.scope) == CheckTarget::kMember;
  for (int end = 0; end < train::end_count(*layout.thermal); ++end) {
    for (int member = 0; member < members; ++member) {
      for (int which = of_gear ? 1 : 0; which <= (of_gear ? 2 : 0); ++which) {
        checks.push_back({.record = &record,
                          .subject = {.member = member, .which = which, .end = end},
                          .limit = limit,
                          .scale = scale_of(record, limit, layout.length_scale_m),
                          .at = state_text(train::end_state(*layout.thermal, end))});
      }
    }
  }
}

}  // namespace

std::string state_text(const train::ThermalState& state) {
  const double temperature_c = units::decimal_from_si(state.temperature_K, Unit::kCelsius);
  switch (state.moisture) {
    case train::Moisture::kDry:
      return fmt::format("{:g} C dry", temperature_c);
    case train::Moisture::kWet:
      return fmt::format("{:g} C wet", temperature_c);
    case train::Moisture::kDrawn:
      break;
  }
  return fmt::format("{:g} C", temperature_c);
}

namespace {

/// Subjects that a check is asked of, in the order in which tables show them; not of those over
/// temperature.
std::vector<CheckSubject> subjects_of(const CheckRecord& record, const Limits& limits,
                                      const GearingLayout& layout) {
  std::vector<CheckSubject> subjects;
  const auto add = [&](int member, int which = 0) {
    subjects.push_back({.member = member, .which = which});
  };
  const std::size_t meshes = layout.mesh_gears.size();
  switch (target_of(record.scope)) {
    case CheckTarget::kGear:
      if (record.scope == CheckScope::kPlanetStep) {
        if (layout.planets > 1) subjects = {{.member = train::kP1}, {.member = train::kP2}};
        break;
      }
      for (int i = 0; i < static_cast<int>(layout.gear_kinds.size()); ++i) {
        if (is_of_gear(record.scope, limits, layout, i)) add(i);
      }
      break;
    case CheckTarget::kMesh:
      for (std::size_t k = 0; k < meshes; ++k) {
        if (is_of_mesh(record, limits, layout, k)) add(static_cast<int>(k));
      }
      break;
    case CheckTarget::kMember:
      for (std::size_t k = 0; k < meshes; ++k) {
        for (const int which : {1, 2}) {
          if (is_of_member(record, layout, k, which)) add(static_cast<int>(k), which);
        }
      }
      break;
    case CheckTarget::kBodyPair:
      for (const int pair : layout.passing_bodies) add(pair);
      break;
    case CheckTarget::kPlanetBearing:
      if (layout.rating != nullptr && layout.rating->supports)
        subjects = {{.member = 0}, {.member = 1}};
      break;
    case CheckTarget::kPlanetPin:
      if (layout.rating == nullptr || !layout.rating->supports) break;
      if (layout.rating->pin_diameter_m) add(0);
      break;
    case CheckTarget::kTrain:
      if (layout.planets > 0 && (record.scope == CheckScope::kTrain || layout.sized)) add(0);
      break;
  }
  return subjects;
}

}  // namespace

std::vector<CheckInstance> list_checks(const Limits& limits, const GearingLayout& layout) {
  std::vector<CheckInstance> checks;
  for (const CheckRecord& r : check_records()) {
    if (r.id == CheckId::kNormalBacklash) {
      list_backlash(limits, r, layout, checks);
      continue;
    }
    const std::optional<double>& limit = limits[r.id];
    if (!limit) continue;
    if (is_thermal(r.scope)) {
      list_thermal(r, *limit, layout, checks);
      continue;
    }
    const double scale = scale_of(r, *limit, layout.length_scale_m);
    for (const CheckSubject& subject : subjects_of(r, limits, layout)) {
      checks.push_back({.record = &r, .subject = subject, .limit = *limit, .scale = scale});
      if (r.scope != CheckScope::kRatedTooth) continue;
      const auto& pair = layout.mesh_gears[static_cast<std::size_t>(subject.member)];
      const int gear = pair[subject.which == 1 ? 0 : 1];
      checks.back().limit += least_of(r.id, *layout.rating, static_cast<std::size_t>(gear));
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
  SubjectNames names;
  switch (target_of(check.record->scope)) {
    case CheckTarget::kGear:
      names.gear = gears[index];
      break;
    case CheckTarget::kMesh:
      names.mesh = meshes[index];
      break;
    case CheckTarget::kMember: {
      const int gear = mesh_gears[index][check.subject.which == 1 ? 0 : 1];
      names = {.mesh = std::string(meshes[index]),
               .gear = std::string(gears[static_cast<std::size_t>(gear)])};
      break;
    }
    case CheckTarget::kBodyPair: {
      const auto [first, second] = train::kPassingBodies[index];
      names.gear = fmt::format("{}, {}", train::kBodyNames[static_cast<std::size_t>(first)],
                               train::kBodyNames[static_cast<std::size_t>(second)]);
      break;
    }
    case CheckTarget::kPlanetBearing:
      names.gear = index == 0 ? "planet A" : "planet B";
      break;
    case CheckTarget::kPlanetPin:
      names.gear = "planet pin";
      break;
    case CheckTarget::kTrain:
      break;
  }
  if (is_thermal(check.record->scope)) {
    // Of a mesh or its gear beside the mesh, of the train by itself.
    std::string& place = names.mesh.empty() ? names.gear : names.mesh;
    place += fmt::format("{}at {}", place.empty() ? "" : " ", check.at);
  }
  return names;
}

template <class T>
Gearing<T> gearing_of(const train::TrainGeometry<T>& train,
                      const std::array<T, train::kMeshCount>& normal_backlash_m,
                      backlash::LostMotionModel model) {
  return {.gears = train.gears,
          .meshes = train.meshes,
          .mesh_gears = train::kMeshGears,
          .normal_backlash_m = normal_backlash_m,
          .forms = {},
          .train = &train,
          .axial = nullptr,
          .bodies = nullptr,
          .model = model};
}

#define INSTANTIATE(T)                                                       \
  template T check_value<T>(const CheckInstance&, const Gearing<T>&);        \
  template Gearing<T> gearing_of<T>(const train::TrainGeometry<T>&,          \
                                    const std::array<T, train::kMeshCount>&, \
                                    backlash::LostMotionModel);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::design
