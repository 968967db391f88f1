#include "report/limits_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "design/preset.hpp"
#include "optimize/limit_prices.hpp"

namespace gear3k::report {

namespace {

double in_own_unit(const design::CheckRecord& r, double limit) {
  return units::decimal_from_si(limit, r.unit);
}

/// "normal_backlash >= 20 um", or "... off".
std::string limit_with_unit(const design::CheckRecord& r, const std::optional<double>& limit) {
  if (!limit) return fmt::format("{} off", r.name);
  const std::string_view unit = units::unit_name(r.unit);
  return fmt::format("{} {} {:g}{}{}", r.name, r.at_least ? ">=" : "<=", in_own_unit(r, *limit),
                     unit.empty() ? "" : " ", unit);
}

bool has_preset(const design::Limits& limits) {
  return limits.preset && *limits.preset != design::Preset::kBare;
}

/// Whether the limit is told as that of a preset, as stated in its place, or as bare.
bool is_told(const design::Limits& limits, const design::CheckRecord& r) {
  const bool of_preset = design::preset_limit(design::Preset::kMachined, r.id).has_value();
  const bool bare = std::ranges::find(limits.bare, r.id) != limits.bare.end();
  return of_preset && (has_preset(limits) || bare);
}

/// Whether such a thing has the check at all: a pair has no planets, bodies or walls, and what is
/// of rings only with a ring.
bool has_check(const LimitsSubject& subject, const design::CheckRecord& r) {
  if (!subject.pair) return true;
  switch (r.scope) {
    case design::CheckScope::kWalledGear:
    case design::CheckScope::kSun:
    case design::CheckScope::kPlanetStep:
    case design::CheckScope::kBodyPair:
    case design::CheckScope::kTrain:
    case design::CheckScope::kSizedTrain:
    case design::CheckScope::kPlanetBearing:
    case design::CheckScope::kPlanetPin:
    case design::CheckScope::kThermalMesh:
    case design::CheckScope::kThermalMember:
    case design::CheckScope::kThermalTrain:
      return false;
    case design::CheckScope::kRing:
    case design::CheckScope::kInternalMesh:
      return subject.ring;
    case design::CheckScope::kCutRing:
      return subject.ring_cutter;
    default:
      return true;
  }
}

/// Other checks with a threshold whose limit is 0: met without any reserve.
std::vector<std::string_view> limits_at_zero(const design::Limits& limits,
                                             const LimitsSubject& subject) {
  std::vector<std::string_view> names;
  for (const design::CheckRecord& r : design::check_records()) {
    if (r.threshold && !r.rating && has_check(subject, r) && !is_told(limits, r) &&
        limits[r.id] == 0.0) {
      names.push_back(r.name);
    }
  }
  return names;
}

/// Whether a check that nobody switches off would be evaluated.
bool applies(const design::CheckRecord& r, const LimitsSubject& subject) {
  switch (r.scope) {
    case design::CheckScope::kThermalMesh:
    case design::CheckScope::kThermalMember:
    case design::CheckScope::kThermalTrain:
      return subject.thermal;
    case design::CheckScope::kCutRing:
      return subject.ring_cutter;
    default:
      return r.default_limit && (subject.rated || !r.rating);
  }
}

/// Other checks that are off and would be evaluated, were they not.
std::vector<std::string_view> limits_off(const design::Limits& limits,
                                         const LimitsSubject& subject) {
  std::vector<std::string_view> names;
  for (const design::CheckRecord& r : design::check_records()) {
    const bool own_key = r.id == design::CheckId::kIdenticalPlanets;
    if (!limits[r.id] && !own_key && has_check(subject, r) && !is_told(limits, r) &&
        applies(r, subject)) {
      names.push_back(r.name);
    }
  }
  return names;
}

bool has_cutter(const std::array<geometry::PinionCutter, train::kGearCount>& cutters) {
  return std::ranges::any_of(cutters, [](const auto& cutter) { return cutter.teeth > 0; });
}

}  // namespace

LimitsSubject limits_subject(const design::Design& design) {
  return {.thermal = design.thermal.has_value(),
          .rated = design.rating.has_value(),
          .ring_cutter = has_cutter(design.train.cutter)};
}

LimitsSubject limits_subject(const design::PairDesign& design) {
  return {.pair = true,
          .ring = design.gear2.kind == geometry::GearKind::kRing,
          .rated = design.rating.has_value(),
          .ring_cutter = design.gear2.cutter.teeth > 0};
}

LimitsSubject limits_subject(const optimize::Specification& spec) {
  return {.thermal = spec.thermal.has_value(),
          .rated = spec.rating.has_value(),
          .ring_cutter = has_cutter(spec.cutter) ||
                         std::ranges::any_of(spec.cutter_teeth,
                                             [](const auto& listed) { return !listed.empty(); })};
}

std::string limits_line(const design::Limits& limits, const LimitsSubject& subject) {
  std::vector<std::string> preset, stated, bare;
  for (const design::PresetLimit& of_preset : design::preset_limits()) {
    const design::CheckRecord& r = design::check_record(of_preset.check);
    if (!has_check(subject, r)) continue;
    const auto& limit = limits[r.id];
    const auto usual = limits.preset ? design::preset_limit(*limits.preset, r.id) : std::nullopt;
    (limit == usual ? preset : stated).push_back(limit_with_unit(r, limit));
  }
  for (const design::CheckId id : limits.bare) {
    const design::CheckRecord& r = design::check_record(id);
    if (has_check(subject, r)) bare.push_back(limit_with_unit(r, limits[id]));
  }
  for (std::size_t mesh = 0; mesh < limits.mesh_backlash_m.size(); ++mesh) {
    if (const auto& least = limits.mesh_backlash_m[mesh]) {
      stated.push_back(fmt::format("normal_backlash of {} >= {:g} um", train::kMeshNames[mesh],
                                   units::decimal_from_si(*least, units::Unit::kMicrometre)));
    }
  }
  const auto zero = limits_at_zero(limits, subject);
  const auto off = limits_off(limits, subject);
  std::string rest = zero.empty() ? "" : fmt::format("; at 0: {}", fmt::join(zero, ", "));
  if (!off.empty()) rest += fmt::format("; off: {}", fmt::join(off, ", "));
  if (!subject.pair && !limits[design::CheckId::kOutputBacklashMax]) {
    rest += "; lost motion without a limit (backlash.max_output_arcmin)";
  }
  if (!has_preset(limits)) {
    const std::string named =
        bare.empty() ? "none of a workshop's is left bare"
                     : fmt::format("bare are {} (preset = \"machined\" or \"printed\" sets them)",
                                   fmt::join(bare, ", "));
    return fmt::format("Limits: {}; {}{}\n", limits.preset ? "preset bare" : "no preset", named,
                       rest);
  }
  const std::string of_preset =
      preset.empty() ? "none of its own" : fmt::format("{}", fmt::join(preset, ", "));
  return fmt::format("Limits: preset {}: {}{}{}{}\n",
                     design::kPresetNames[static_cast<std::size_t>(*limits.preset)], of_preset,
                     stated.empty() ? "" : "; stated instead: ", fmt::join(stated, ", "), rest);
}

bool is_of_preset(const design::Limits& limits, design::CheckId check) {
  const auto usual = limits.preset ? design::preset_limit(*limits.preset, check) : std::nullopt;
  return usual && limits[check] == usual;
}

std::string preset_note(const design::Limits& limits, std::span<const std::string_view> checks) {
  std::vector<std::string> named;
  for (const design::PresetLimit& of_preset : design::preset_limits()) {
    const design::CheckRecord& r = design::check_record(of_preset.check);
    if (std::ranges::find(checks, r.name) == checks.end() || !is_of_preset(limits, r.id)) continue;
    const std::string_view unit = units::unit_name(r.unit);
    named.push_back(fmt::format("{} = {:g}{}{}", optimize::key_of_limit(r),
                                in_own_unit(r, *limits[r.id]), unit.empty() ? "" : " ", unit));
  }
  if (named.empty()) return "";
  return fmt::format("; of preset {}, unless stated otherwise: {}",
                     design::kPresetNames[static_cast<std::size_t>(*limits.preset)],
                     fmt::join(named, ", "));
}

io::Json limits_json(const design::Limits& limits, const LimitsSubject& subject) {
  io::Json of_preset = io::Json::array();
  for (const design::PresetLimit& limit : design::preset_limits()) {
    if (is_of_preset(limits, limit.check)) {
      of_preset.push_back(design::check_record(limit.check).name);
    }
  }
  io::Json bare = io::Json::array();
  for (const design::CheckId id : limits.bare) bare.push_back(design::check_record(id).name);
  io::Json in_force = io::Json::object();
  io::Json of_mesh = io::Json::object();
  for (std::size_t mesh = 0; mesh < limits.mesh_backlash_m.size(); ++mesh) {
    if (const auto& least = limits.mesh_backlash_m[mesh]) {
      of_mesh[std::string(train::kMeshNames[mesh])] =
          units::decimal_from_si(*least, units::Unit::kMicrometre);
    }
  }
  for (const design::CheckRecord& r : design::check_records()) {
    if (limits[r.id] && !r.rating) in_force[std::string(r.name)] = in_own_unit(r, *limits[r.id]);
  }
  return {{"preset", limits.preset
                         ? io::Json(design::kPresetNames[static_cast<std::size_t>(*limits.preset)])
                         : io::Json(nullptr)},
          {"of_preset", std::move(of_preset)},
          {"bare", std::move(bare)},
          {"at_zero", limits_at_zero(limits, subject)},
          {"off", limits_off(limits, subject)},
          {"normal_backlash_of_mesh", std::move(of_mesh)},
          {"in_force", std::move(in_force)}};
}

}  // namespace gear3k::report
