#include "io/keys/limit_keys.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "design/preset.hpp"

namespace gear3k::io {

namespace {

using design::CheckId, design::CheckRecord, design::CheckScope, units::Unit;

bool belongs_to_pair(const CheckRecord& r) {
  switch (r.scope) {
    case CheckScope::kTrain:
    case CheckScope::kSizedTrain:
    case CheckScope::kPlanetStep:
    case CheckScope::kBodyPair:
    case CheckScope::kPlanetBearing:
    case CheckScope::kPlanetPin:
    case CheckScope::kWalledGear:
    case CheckScope::kListedGear:
    case CheckScope::kSun:
    case CheckScope::kThermalMesh:
    case CheckScope::kThermalMember:
    case CheckScope::kThermalTrain:
      return false;
    default:
      return r.id != CheckId::kRingRootDiameter && r.id != CheckId::kGearboxDiameter;
  }
}

std::string default_text(const CheckRecord& r) {
  return r.default_limit ? fmt::format("{}", *r.default_limit) : "off";
}

/// Whether a check has a limit where a file says nothing of it but, maybe, its preset.  One that
/// has none is not stated as off: what a file gets later (temperatures) may bring it.
bool has_limit_unstated(const CheckRecord& r, const design::Limits& limits) {
  return r.default_limit || (limits.preset && design::preset_limit(*limits.preset, r.id));
}

/// Whether a gear has a list in [allowed_teeth].
bool has_lists(const design::Limits& limits) {
  return std::ranges::any_of(limits.allowed_teeth,
                             [](const auto& teeth) { return !teeth.empty(); });
}

std::string unit_in_words(const CheckRecord& r) {
  const std::string_view unit = units::unit_name(r.unit);
  return unit.empty() ? "" : fmt::format(" in {}", unit);
}

/// A limit with a table of its own: a number in the record's unit.
Key<LimitInput> own_key(const CheckId id) {
  const CheckRecord& r = design::check_record(id);
  // No gearbox is within a diameter of 0, by which nothing can be divided.
  const bool diameter = id == CheckId::kRingRootDiameter || id == CheckId::kGearboxDiameter;
  const Range range =
      diameter ? above(0.0, 1e6) : within(id == CheckId::kNormalBacklash ? -1e6 : 0.0, 1e6);
  return make_key<LimitInput>(
      number(std::string(r.limit_key), r.unit, range, default_text(r), std::string(r.help)),
      [id](auto& t, std::size_t) -> auto& { return t.limits[id]; });
}

/// A range has two ends; the one that is off is switched off in [limits].
Key<LimitInput> contact_ratio_key() {
  return {
      .record = number_range("contact_ratio.range", Unit::kNone, within(0.0, kGreatestContactRatio),
                             "at least 1", "least and greatest contact ratio of every mesh"),
      .assign =
          [](const KeyRecord&, LimitInput& t, std::size_t, const TomlValue& v) {
            t.limits[CheckId::kContactRatioMin] = v.list[0].number;
            t.limits[CheckId::kContactRatioMax] = v.list[1].number;
          },
      .state = [](const KeyRecord&, const LimitInput& t, std::size_t) -> std::optional<TomlValue> {
        const auto& least = t.limits[CheckId::kContactRatioMin];
        const auto& most = t.limits[CheckId::kContactRatioMax];
        if (!least && !most) return std::nullopt;
        return list_value({number_value(least.value_or(0.0)),
                           number_value(most.value_or(kGreatestContactRatio))});
      }};
}

/// The least that a limit may be: of a common factor 1, of sliding none; no tooth ends beyond its
/// point.
double least_threshold(CheckId id) {
  switch (id) {
    case CheckId::kHuntingTooth:
      return 1.0;
    case CheckId::kSpecificSliding:
    case CheckId::kTipThickness:
    case CheckId::kRingTipThickness:
    case CheckId::kTipThicknessLength:
      return 0.0;
    default:
      return -1e6;
  }
}

/// A key of [limits] that is a number in the record's unit, or a switch.
Key<LimitInput> threshold_key(const CheckRecord& r) {
  return {.record = {.path = fmt::format("limits.{}", r.name),
                     .type = KeyType::kNumberOrSwitch,
                     .unit = r.unit,
                     .min = least_threshold(r.id),
                     .max = 1e6,
                     .default_text = default_text(r),
                     .help = std::string(r.help)},
          .assign =
              [id = r.id](const KeyRecord& record, LimitInput& t, std::size_t, const TomlValue& v) {
                if (v.kind == TomlValue::Kind::kBoolean) {
                  t.switched[static_cast<std::size_t>(id)] = v.boolean;
                } else {
                  store(record, v, t.limits[id]);
                }
              },
          .state = [&r](const KeyRecord& record, const LimitInput& t,
                        std::size_t) -> std::optional<TomlValue> {
            const auto& on = t.switched[static_cast<std::size_t>(r.id)];
            if (on) return boolean_value(*on);
            const auto& limit = t.limits[r.id];
            if (!limit && !has_limit_unstated(r, t.limits)) return std::nullopt;
            return stated(record, limit).value_or(boolean_value(false));
          }};
}

/// The switch of a check.
Key<LimitInput> switch_key(const CheckId id, KeyRecord record) {
  record.type = KeyType::kBoolean;
  return make_key<LimitInput>(
      std::move(record), [id](auto& t, std::size_t) -> auto& {
        return t.switched[static_cast<std::size_t>(id)];
      });
}

/// Sizes of the whole gearbox, and what is asked of single meshes and gears.
void append_packaging_keys(std::vector<Key<LimitInput>>& keys) {
  keys.push_back(own_key(CheckId::kGearboxDiameter));
  keys.push_back(own_key(CheckId::kGearboxLength));
  keys.push_back(own_key(CheckId::kSunRootDiameter));
  keys.push_back(own_key(CheckId::kWall));
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    keys.push_back(make_key<LimitInput>(
        number(fmt::format("backlash.{}.min_normal_um", train::kMeshNames[k]), Unit::kMicrometre,
               within(-1e6, 1e6), "backlash.min_normal_um",
               fmt::format("least normal backlash of mesh {}", train::kMeshNames[k])),
        [k](auto& t, std::size_t) -> auto& { return t.limits.mesh_backlash_m[k]; }));
  }
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    keys.push_back(make_key<LimitInput>(
        {.path = fmt::format("allowed_teeth.{}", train::kGearNames[i]),
         .type = KeyType::kIntegers,
         .min = 3,
         .max = 2000,
         .default_text = "all",
         .help = fmt::format("tooth numbers that {} may have", train::kGearNames[i])},
        [i](auto& t, std::size_t) -> auto& { return t.limits.allowed_teeth[i]; }));
  }
  keys.push_back(make_key<LimitInput>(
      {.path = "limits.hunting_meshes",
       .type = KeyType::kChoices,
       .choices = {train::kMeshNames.begin(), train::kMeshNames.end()},
       .default_text = "all three",
       .help = "meshes that limits.hunting_tooth is asked of"},
      [](auto& t, std::size_t) -> auto& { return t.limits.hunting_meshes; }));
}

}  // namespace

std::vector<Key<LimitInput>> limit_keys(bool for_pair) {
  std::vector<Key<LimitInput>> keys;
  keys.push_back(make_key<LimitInput>(
      {.path = "preset",
       .type = KeyType::kChoice,
       .choices = {design::kPresetNames.begin(), design::kPresetNames.end()},
       .default_text = "none",
       .help = "limits of a workshop (docs/interface.md, Presets): bare = the defaults below; each "
               "is overridden by its own key"},
      [](auto& t, std::size_t) -> auto& { return t.limits.preset; }));
  if (!for_pair) {
    keys.push_back(
        switch_key(CheckId::kIdenticalPlanets,
                   {.path = "identical_planets",
                    .default_text = "true",
                    .help = "all planets are one and the same part; false: each may have its own "
                            "phase between P1 and P2"}));
    keys.push_back(make_key<LimitInput>(
        {.path = "backlash.model",
         .type = KeyType::kChoice,
         .choices = {"kinematic", "paper"},
         .default_text = "\"kinematic\"",
         .help = "model of the lost motion that the limits apply to"},
        [](auto& t, std::size_t) -> auto& { return t.limits.model; }));
    keys.push_back(own_key(CheckId::kOutputBacklashMin));
    keys.push_back(own_key(CheckId::kOutputBacklashMax));
    keys.push_back(own_key(CheckId::kRingRootDiameter));
    append_packaging_keys(keys);
  }
  keys.push_back(own_key(CheckId::kNormalBacklash));
  keys.push_back(contact_ratio_key());
  for (const CheckRecord& r : design::check_records()) {
    if (r.id == CheckId::kIdenticalPlanets) continue;
    if (for_pair && !belongs_to_pair(r)) continue;
    if (r.threshold && r.limit_key.empty()) {
      keys.push_back(threshold_key(r));
      continue;
    }
    keys.push_back(switch_key(
        r.id, number(fmt::format("limits.{}", r.name), Unit::kNone, within(-1e6, 1e6),
                     r.default_limit    ? "true"
                     : r.switched_limit ? "false"
                                        : "true when stated",
                     r.threshold ? fmt::format("switch of the check; its limit is {}", r.limit_key)
                                 : std::string(r.help))));
  }
  return keys;
}

LimitInput stated_limits(const design::Limits& limits) {
  LimitInput input{.limits = limits, .switched = {}};
  const bool has_range = limits[CheckId::kContactRatioMin] || limits[CheckId::kContactRatioMax];
  for (const CheckRecord& r : design::check_records()) {
    const bool in_range = has_range && r.id == CheckId::kContactRatioMax;
    const bool number = r.threshold && r.limit_key.empty();
    if (limits[r.id] && r.switched_limit && !r.threshold) {
      input.switched[static_cast<std::size_t>(r.id)] = true;
    }
    if (!limits[r.id] && !number && (in_range || has_limit_unstated(r, limits))) {
      input.switched[static_cast<std::size_t>(r.id)] = false;
    }
  }
  // The lists alone would ask for the check.
  if (has_lists(limits) && !limits[CheckId::kAllowedTeeth]) {
    input.switched[static_cast<std::size_t>(CheckId::kAllowedTeeth)] = false;
  }
  input.switched[static_cast<std::size_t>(CheckId::kIdenticalPlanets)] =
      limits[CheckId::kIdenticalPlanets].has_value();
  return input;
}

namespace {

/// Whether a file states the number of a check's limit, or switches it off.
bool states_limit(const LimitInput& input, const CheckRecord& r, const FileReading& reading) {
  const auto& on = input.switched[static_cast<std::size_t>(r.id)];
  if (on) return !*on;
  return reading.stated(r.limit_key.empty() ? fmt::format("limits.{}", r.name)
                                            : std::string(r.limit_key));
}

/// What the preset sets that the file does not state; what none sets is left bare.
void take_preset(const LimitInput& input, const FileReading& reading, design::Limits& limits) {
  limits.bare.clear();
  for (const design::PresetLimit& of_preset : design::preset_limits()) {
    const CheckRecord& r = design::check_record(of_preset.check);
    if (states_limit(input, r, reading)) continue;
    const auto limit = limits.preset ? design::preset_limit(*limits.preset, r.id) : std::nullopt;
    if (limit) {
      limits[r.id] = limit;
    } else if (r.default_limit != of_preset.machined && r.id != CheckId::kWall) {
      limits.bare.push_back(r.id);
    }
  }
}

void report_missing_limit(const CheckRecord& r, FileReading& reading) {
  const std::string path = fmt::format("limits.{}", r.name);
  reading.error_at(path, r.limit_key.empty()
                             ? fmt::format("{} = true: the check has no default; allowed: a "
                                           "number{} or false",
                                           path, unit_in_words(r))
                             : fmt::format("{} = true: the check has no default; allowed with {} "
                                           "stated",
                                           path, r.limit_key));
}

}  // namespace

design::Limits finish_limits(const LimitInput& input, FileReading& reading) {
  design::Limits limits = input.limits;
  if (has_lists(limits)) limits[CheckId::kAllowedTeeth] = 0.0;
  take_preset(input, reading, limits);
  for (const CheckRecord& r : design::check_records()) {
    const auto& on = input.switched[static_cast<std::size_t>(r.id)];
    if (!on) continue;
    if (!*on) {
      limits[r.id].reset();
      if (r.id == CheckId::kNormalBacklash) limits.mesh_backlash_m = {};
    } else if (!limits[r.id] && r.switched_limit) {
      limits[r.id] = units::to_si(*r.switched_limit, r.unit);
    } else if (!limits[r.id]) {
      report_missing_limit(r, reading);
    }
  }
  if (!limits[CheckId::kHuntingTooth] && reading.stated("limits.hunting_meshes")) {
    reading.error_at("limits.hunting_meshes",
                     "limits.hunting_meshes without limits.hunting_tooth: allowed: both");
  }
  return limits;
}

}  // namespace gear3k::io
