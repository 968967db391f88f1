#include "io/keys/limit_keys.hpp"

#include <fmt/format.h>

namespace gear3k::io {

namespace {

using design::CheckId, design::CheckRecord, design::CheckScope, units::Unit;

bool belongs_to_pair(const CheckRecord& r) {
  return r.scope != CheckScope::kTrain && r.scope != CheckScope::kPlanetStep &&
         r.scope != CheckScope::kBodyPair && r.scope != CheckScope::kPlanetBearing &&
         r.scope != CheckScope::kPlanetPin && r.id != CheckId::kRingRootDiameter;
}

std::string default_text(const CheckRecord& r) {
  return r.default_limit ? fmt::format("{}", *r.default_limit) : "off";
}

std::string unit_in_words(const CheckRecord& r) {
  const std::string_view unit = units::unit_name(r.unit);
  return unit.empty() ? "" : fmt::format(" in {}", unit);
}

/// A limit with a table of its own: a number in the record's unit.
Key<LimitInput> own_key(const CheckId id) {
  const CheckRecord& r = design::check_record(id);
  return make_key<LimitInput>(
      number(std::string(r.limit_key), r.unit,
             within(id == CheckId::kNormalBacklash ? -1e6 : 0.0, 1e6), default_text(r),
             std::string(r.help)),
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

/// A key of [limits] that is a number in the record's unit, or a switch.
Key<LimitInput> threshold_key(const CheckRecord& r) {
  return {.record = {.path = fmt::format("limits.{}", r.name),
                     .type = KeyType::kNumberOrSwitch,
                     .unit = r.unit,
                     .min = -1e6,
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
          .state =
              [id = r.id](const KeyRecord& record, const LimitInput& t, std::size_t) {
                const auto& on = t.switched[static_cast<std::size_t>(id)];
                return on ? boolean_value(*on)
                          : stated(record, t.limits[id]).value_or(boolean_value(false));
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

}  // namespace

std::vector<Key<LimitInput>> limit_keys(bool for_pair) {
  std::vector<Key<LimitInput>> keys;
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
  }
  keys.push_back(own_key(CheckId::kNormalBacklash));
  keys.push_back(contact_ratio_key());
  for (const CheckRecord& r : design::check_records()) {
    if (r.id == CheckId::kIdenticalPlanets || (for_pair && !belongs_to_pair(r))) continue;
    if (r.threshold && r.limit_key.empty()) {
      keys.push_back(threshold_key(r));
      continue;
    }
    keys.push_back(switch_key(
        r.id, number(fmt::format("limits.{}", r.name), Unit::kNone, within(-1e6, 1e6),
                     r.default_limit ? "true" : "true when stated",
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
    if (!limits[r.id] && !number && (r.default_limit || in_range)) {
      input.switched[static_cast<std::size_t>(r.id)] = false;
    }
  }
  input.switched[static_cast<std::size_t>(CheckId::kIdenticalPlanets)] =
      limits[CheckId::kIdenticalPlanets].has_value();
  return input;
}

design::Limits finish_limits(const LimitInput& input, FileReading& reading) {
  design::Limits limits = input.limits;
  for (const CheckRecord& r : design::check_records()) {
    const auto& on = input.switched[static_cast<std::size_t>(r.id)];
    if (!on) continue;
    if (!*on) {
      limits[r.id].reset();
    } else if (!limits[r.id]) {
      reading.error_at(fmt::format("limits.{}", r.name),
                       r.limit_key.empty()
                           ? fmt::format("limits.{} = true: the check has no default; allowed: a "
                                         "number{} or false",
                                         r.name, unit_in_words(r))
                           : fmt::format("limits.{} = true: the check has no default; allowed with "
                                         "{} stated",
                                         r.name, r.limit_key));
    }
  }
  return limits;
}

}  // namespace gear3k::io
