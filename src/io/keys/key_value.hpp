#pragma once
// Values of keys: as a file states them, and as members in SI that hold them.

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "design/sensitivity.hpp"
#include "io/text/toml_text.hpp"
#include "io/text/toml_value.hpp"
#include "units/units.hpp"

namespace gear3k::io {

enum class KeyType {
  kNumber,
  kInteger,
  kBoolean,
  kText,
  kChoice,
  kChoices,         ///< one of the choices, or a list of them
  kNumberRange,     ///< [low, high]
  kIntegerRange,    ///< [low, high]
  kIntegers,        ///< an integer or a list of them
  kNumbers,         ///< a list of numbers
  kModule,          ///< a number, { min, max } or { series = [..] }
  kNumberOrMinMax,  ///< a number, or { min, max }
  kNumberPerGear,   ///< a number for all gears, or { S = .., P1 = .., .. }
  kNumberOrRange,   ///< a number (± it), or [lower, upper]
  kNumberOrSwitch,  ///< a number, or true (default limit) or false (off)
  kNumberOrChoice,  ///< a number, or one of the choices
  kTexts            ///< a text, or a list of them
};

struct KeyRecord {
  /// Path with dots; "{gear}" stands for each of the schema's gears.
  std::string path = {};
  KeyType type = KeyType::kNumber;
  units::Unit unit = units::Unit::kNone;  ///< of its numbers
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
  bool ends_differ = false;  ///< of [low, high]; the file's own checks refuse equal ones
  std::vector<std::string> choices = {};
  bool required = false;
  std::string default_text = {};  ///< as documentation shows it; "" = none
  std::string help = {};
  /// What it is of the inputs whose sensitivities are known; of a gear's key the first gear's.
  std::optional<design::InputId> input = {};
};

/// The numbers that a key takes.
struct Range {
  double min = 0.0;
  double max = 0.0;
  bool min_excluded = false;
};
constexpr Range within(double min, double max) { return {.min = min, .max = max}; }
constexpr Range above(double min, double max) {
  return {.min = min, .max = max, .min_excluded = true};
}
/// Stands for the default of a key that has none.
inline constexpr const char* kRequired = "required";

/// The record of a key that holds a number.
KeyRecord number(std::string_view path, units::Unit unit, const Range& range,
                 std::string_view default_text, std::string_view help);
/// The same of an input with sensitivities.
KeyRecord number(std::string_view path, units::Unit unit, const Range& range,
                 std::string_view default_text, std::string_view help,
                 const design::InputId& input);
/// Of one that holds two numbers.
KeyRecord number_range(std::string_view path, units::Unit unit, const Range& range,
                       std::string_view default_text, std::string_view help);
KeyRecord integer(std::string_view path, const Range& range, std::string_view default_text,
                  std::string_view help);

/// Position of a name in a list of names that holds it.
template <class Names>
std::size_t index_of(const Names& names, std::string_view name) {
  std::size_t index = 0;
  while (names[index] != name) ++index;
  return index;
}

template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <class T>
inline constexpr bool kIsVector = false;
template <class T>
inline constexpr bool kIsVector<std::vector<T>> = true;

/// Stores a value that has passed the record's type and range in a member: a number in SI, a choice
/// as an enumerator or bool in the order of the choices, [low, high] or ± a number in a struct of
/// two members, a list, or one element, in a vector.
template <class T>
void store(const KeyRecord& record, const TomlValue& value, T& member) {
  if constexpr (kIsOptional<T>) {
    store(record, value, member.emplace());
  } else if constexpr (std::is_same_v<T, bool>) {
    member = value.kind == TomlValue::Kind::kText ? index_of(record.choices, value.text) == 1
                                                  : value.boolean;
  } else if constexpr (std::is_enum_v<T>) {
    member = static_cast<T>(index_of(record.choices, value.text));
  } else if constexpr (std::is_integral_v<T>) {
    member = static_cast<T>(value.integer);
  } else if constexpr (std::is_floating_point_v<T>) {
    member = units::to_si(value.number, record.unit);
  } else if constexpr (std::is_same_v<T, std::string>) {
    member = value.text;
  } else if constexpr (kIsVector<T>) {
    member.clear();
    if (value.kind != TomlValue::Kind::kList) store(record, value, member.emplace_back());
    for (const TomlValue& element : value.list) store(record, element, member.emplace_back());
  } else {
    auto& [low, high] = member;
    if (value.kind == TomlValue::Kind::kList) {
      store(record, value.list[0], low);
      store(record, value.list[1], high);
    } else {
      store(record, value, high);
      low = -high;
    }
  }
}

/// What store() makes the member of; numbers as units::decimal_from_si() gives them.
template <class T>
std::optional<TomlValue> stated(const KeyRecord& record, const T& member) {
  if constexpr (kIsOptional<T>) {
    return member ? stated(record, *member) : std::nullopt;
  } else if constexpr (std::is_same_v<T, bool>) {
    if (record.type == KeyType::kChoice) return text_value(record.choices[member ? 1 : 0]);
    return boolean_value(member);
  } else if constexpr (std::is_enum_v<T>) {
    return text_value(record.choices[static_cast<std::size_t>(member)]);
  } else if constexpr (std::is_integral_v<T>) {
    return integer_value(static_cast<std::int64_t>(member));
  } else if constexpr (std::is_floating_point_v<T>) {
    return number_value(units::decimal_from_si(member, record.unit));
  } else if constexpr (std::is_same_v<T, std::string>) {
    return text_value(member);
  } else if constexpr (kIsVector<T>) {
    if (member.empty()) return std::nullopt;
    TomlValue list = list_value({});
    for (const auto& element : member) list.list.push_back(*stated(record, element));
    return list;
  } else {
    const auto& [low, high] = member;
    return list_value({*stated(record, low), *stated(record, high)});
  }
}

}  // namespace gear3k::io
