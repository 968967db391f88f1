#include "io/keys/thermal_keys.hpp"

#include <fmt/format.h>

#include <string>

namespace gear3k::io {

namespace {

using design::CheckId, units::Unit;

constexpr const char* kTemperature = "thermal.temperature_c";
/// Checks whose limits a range of temperature brings.
constexpr std::array<CheckId, 2> kThermalChecks{CheckId::kThermalBacklash,
                                                CheckId::kThermalRootClearance};

template <class View>
void append_part_keys(std::vector<Key<ThermalInput>>& keys, const std::string& prefix,
                      const char* part, View view) {
  keys.push_back(make_key<ThermalInput>(
      number(prefix + "expansion_1_k", Unit::kNone, within(-1e-3, 1e-3),
             "required with thermal.temperature_c",
             fmt::format("coefficient of linear expansion of {}, per kelvin", part)),
      [view](auto& t, std::size_t gear) -> auto& { return view(t, gear).expansion_1_K; }));
  keys.push_back(unless_default(make_key<ThermalInput>(
      number_range(
          prefix + "swelling", Unit::kNone, within(-0.1, 0.1), "[0, 0]",
          fmt::format("linear strain of {} by moisture, dry and wet, from the drawing", part)),
      [view](auto& t, std::size_t gear) -> auto& { return view(t, gear).swelling; })));
}

}  // namespace

std::vector<Key<ThermalInput>> thermal_keys() {
  std::vector<Key<ThermalInput>> keys;
  keys.push_back(make_key<ThermalInput>(
      number_range(kTemperature, Unit::kCelsius, within(-200.0, 400.0), "none",
                   "least and greatest temperature; backlash and root clearance have to hold at "
                   "both (limits.thermal_backlash, limits.thermal_root_clearance)"),
      &ThermalInput::temperature));
  keys.push_back(unless_default(
      make_key<ThermalInput>(number("thermal.reference_c", Unit::kCelsius, within(-200.0, 400.0),
                                    "20", "temperature at which the drawing holds"),
                             &ThermalInput::reference_K)));
  append_part_keys(
      keys, "thermal.{gear}.", "a gear",
      [](auto& t, std::size_t gear) -> auto& { return t.gears[gear]; });
  append_part_keys(
      keys, "thermal.carrier.", "the carrier, which sets the centre distance",
      [](auto& t, std::size_t) -> auto& { return t.carrier; });
  return keys;
}

namespace {

/// The first key that says something and makes no sense without the temperatures; "": none.
std::string first_said(const ThermalInput& input) {
  const auto said = [](const ThermalInput::Part& part, std::string_view name) -> std::string {
    if (part.expansion_1_K) return fmt::format("thermal.{}.expansion_1_k", name);
    const bool swells = part.swelling.dry != 0.0 || part.swelling.wet != 0.0;
    return swells ? fmt::format("thermal.{}.swelling", name) : "";
  };
  if (input.reference_K != ThermalInput{}.reference_K) return "thermal.reference_c";
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    std::string key = said(input.gears[i], train::kGearNames[i]);
    if (!key.empty()) return key;
  }
  return said(input.carrier, "carrier");
}

train::Growth finish_part(const ThermalInput::Part& part, const std::string& name,
                          FileReading& reading) {
  const std::string key = fmt::format("thermal.{}.expansion_1_k", name);
  if (!part.expansion_1_K && !reading.stated(key)) {
    reading.error_at(key, fmt::format("{} is missing: allowed: thermal.temperature_c with "
                                      "expansion_1_k of every gear and of the carrier",
                                      key));
  }
  return {.expansion_1_K = part.expansion_1_K.value_or(0.0), .swelling = part.swelling};
}

/// Limits over the temperatures want them to be stated.
void refuse_thermal_limits(const design::Limits& limits, FileReading& reading) {
  for (const CheckId id :
       {CheckId::kThermalBacklash, CheckId::kThermalRootClearance, CheckId::kThermalLostMotion}) {
    const std::string key = fmt::format("limits.{}", design::check_record(id).name);
    if (!limits[id] || !reading.stated(key)) continue;
    reading.error_at(key, fmt::format("{} without [thermal]: allowed: with it, or false", key));
  }
}

/// Whether the table is in the file with nothing in it.
bool is_empty_table(const FileReading& reading) {
  const auto stated = [&](std::string_view name) {
    return reading.stated(fmt::format("thermal.{}", name));
  };
  return reading.stated("thermal") && !stated("reference_c") && !stated("carrier") &&
         std::ranges::none_of(train::kGearNames, stated);
}

}  // namespace

std::optional<train::ThermalRange> finish_thermal(const ThermalInput& input,
                                                  const LimitInput& stated, design::Limits& limits,
                                                  FileReading& reading) {
  if (!reading.stated(kTemperature)) {
    refuse_thermal_limits(limits, reading);
    const std::string other = first_said(input);
    if (!other.empty()) {
      reading.error_at(other, fmt::format("{} without {}: allowed: both", other, kTemperature));
    } else if (is_empty_table(reading)) {
      reading.error_at("thermal", fmt::format("[thermal] is empty: needs {} and expansion_1_k of "
                                              "each gear and the carrier",
                                              kTemperature));
    }
    return std::nullopt;
  }
  if (!input.temperature) return std::nullopt;  // refused for its type or range
  train::ThermalRange range{.least_K = input.temperature->least_K,
                            .greatest_K = input.temperature->greatest_K,
                            .reference_K = input.reference_K};
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    range.gear[i] = finish_part(input.gears[i], std::string(train::kGearNames[i]), reading);
  }
  range.carrier = finish_part(input.carrier, "carrier", reading);
  for (const CheckId id : kThermalChecks) {
    const design::CheckRecord& r = design::check_record(id);
    if (limits[id] || stated.switched[static_cast<std::size_t>(id)]) continue;
    limits[id] = units::to_si(*r.switched_limit, r.unit);
  }
  return range;
}

ThermalInput stated_thermal(const std::optional<train::ThermalRange>& range,
                            const design::Limits& limits, LimitInput& stated) {
  ThermalInput input;
  if (!range) return input;
  input.temperature = TemperatureLimits{.least_K = range->least_K, .greatest_K = range->greatest_K};
  input.reference_K = range->reference_K;
  const auto part = [](const train::Growth& growth) {
    return ThermalInput::Part{.expansion_1_K = growth.expansion_1_K, .swelling = growth.swelling};
  };
  for (std::size_t i = 0; i < train::kGearCount; ++i) input.gears[i] = part(range->gear[i]);
  input.carrier = part(range->carrier);
  for (const CheckId id : kThermalChecks) {
    if (!limits[id]) stated.switched[static_cast<std::size_t>(id)] = false;
  }
  return input;
}

}  // namespace gear3k::io
