#include "io/keys/limit_keys.hpp"

#include <fmt/format.h>

namespace gear3k::io {

namespace {

using design::CheckId, design::CheckRecord, design::CheckScope;

bool belongs_to_pair(const CheckRecord& r) {
  return r.scope != CheckScope::kTrain && r.scope != CheckScope::kPlanetStep &&
         r.scope != CheckScope::kBodyPair && r.id != CheckId::kRingRootDiameter;
}

std::string default_text(const CheckRecord& r) {
  return r.default_limit ? fmt::format("{}", *r.default_limit) : "off";
}

std::string unit_in_words(const CheckRecord& r) {
  const std::string_view unit = design::unit_name(r.unit);
  return unit.empty() ? "" : fmt::format(" in {}", unit);
}

/// A limit with a table of its own: a number in the record's unit.
Key<LimitInput> own_key(const CheckId id) {
  const CheckRecord& r = design::check_record(id);
  return {.record = {.path = std::string(r.limit_key),
                     .type = KeyType::kNumber,
                     .unit = std::string(design::unit_name(r.unit)),
                     .min = id == CheckId::kNormalBacklash ? -1e6 : 0.0,
                     .max = 1e6,
                     .default_text = default_text(r),
                     .help = std::string(r.help)},
          .assign = [id, unit = r.unit](LimitInput& t, std::size_t, const TomlValue& v) {
            t.limits[id] = design::from_unit(v.number, unit);
          }};
}

}  // namespace

std::vector<Key<LimitInput>> limit_keys(bool for_pair) {
  std::vector<Key<LimitInput>> keys;
  if (!for_pair) {
    keys.push_back(
        {.record = {.path = "identical_planets",
                    .type = KeyType::kBoolean,
                    .default_text = "true",
                    .help = "all planets are one and the same part; false: each may have "
                            "its own phase between P1 and P2"},
         .assign = [](LimitInput& t, std::size_t, const TomlValue& v) {
           t.switched[static_cast<std::size_t>(CheckId::kIdenticalPlanets)] = v.boolean;
         }});
    keys.push_back({.record = {.path = "backlash.model",
                               .type = KeyType::kChoice,
                               .choices = {"kinematic", "paper"},
                               .default_text = "\"kinematic\"",
                               .help = "model of the lost motion that the limits apply to"},
                    .assign = [](LimitInput& t, std::size_t, const TomlValue& v) {
                      t.limits.model = v.text == "paper" ? backlash::LostMotionModel::kPaper
                                                         : backlash::LostMotionModel::kKinematic;
                    }});
    keys.push_back(own_key(CheckId::kOutputBacklashMin));
    keys.push_back(own_key(CheckId::kOutputBacklashMax));
    keys.push_back(own_key(CheckId::kRingRootDiameter));
  }
  keys.push_back(own_key(CheckId::kNormalBacklash));
  keys.push_back({.record = {.path = "contact_ratio.range",
                             .type = KeyType::kNumberRange,
                             .min = 0.0,
                             .max = kGreatestContactRatio,
                             .default_text = "at least 1",
                             .help = "least and greatest contact ratio of every mesh"},
                  .assign = [](LimitInput& t, std::size_t, const TomlValue& v) {
                    t.limits[CheckId::kContactRatioMin] = v.list[0].number;
                    t.limits[CheckId::kContactRatioMax] = v.list[1].number;
                  }});
  for (const CheckRecord& r : design::check_records()) {
    if (r.id == CheckId::kIdenticalPlanets || (for_pair && !belongs_to_pair(r))) continue;
    const bool threshold_here = r.threshold && r.limit_key.empty();
    keys.push_back(
        {.record = {.path = fmt::format("limits.{}", r.name),
                    .type = threshold_here ? KeyType::kNumberOrSwitch : KeyType::kBoolean,
                    .unit = threshold_here ? std::string(design::unit_name(r.unit)) : "",
                    .min = -1e6,
                    .max = 1e6,
                    .default_text = threshold_here    ? default_text(r)
                                    : r.default_limit ? "true"
                                                      : "true when stated",
                    .help = threshold_here ? std::string(r.help)
                            : r.threshold
                                ? fmt::format("switch of the check; its limit is {}", r.limit_key)
                                : std::string(r.help)},
         .assign = [id = r.id, unit = r.unit](LimitInput& t, std::size_t, const TomlValue& v) {
           if (v.kind == TomlValue::Kind::kBoolean) {
             t.switched[static_cast<std::size_t>(id)] = v.boolean;
           } else {
             t.limits[id] = design::from_unit(v.number, unit);
           }
         }});
  }
  return keys;
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
