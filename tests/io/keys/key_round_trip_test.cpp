// Every key of the registry, with random legal values: written and read, the same bits.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "io/keys/actuator_keys.hpp"
#include "io/keys/design_keys.hpp"
#include "io/keys/scenario_keys.hpp"
#include "io/keys/selection_keys.hpp"
#include "io/keys/specification_keys.hpp"

namespace gear3k::io::key_round_trip_test {
namespace {

/// Draws values that a key allows, as TOML states them.
class LegalValues {
 public:
  explicit LegalValues(std::uint64_t seed) : random_(seed) {}

  TomlValue of(const KeyRecord& record) {
    switch (record.type) {
      case KeyType::kNumber:
        return number(record);
      case KeyType::kInteger:
        return integer(record);
      case KeyType::kBoolean:
        return boolean_value(below(2) == 1);
      case KeyType::kText:
        return text_value(below(2) == 1 ? "a \"name\"\\ with\ttab" : "");
      case KeyType::kChoice:
        return text_value(record.choices[below(record.choices.size())]);
      case KeyType::kChoices:
        return list_value({text_value(record.choices[below(record.choices.size())]),
                           text_value(record.choices[below(record.choices.size())])});
      case KeyType::kNumberRange:
      case KeyType::kNumberOrRange:
        return ordered(number(record), number(record));
      case KeyType::kIntegerRange:
        return ordered(integer(record), integer(record));
      case KeyType::kIntegers:
        return list_value({integer(record)});
      case KeyType::kNumbers:
        return list_value({number(record), number(record), number(record)});
      case KeyType::kModule:
        return module(record);
      case KeyType::kNumberOrMinMax:
        return min_max(record);
      case KeyType::kNumberPerGear:
        return per_gear(record);
      case KeyType::kNumberOrSwitch:
        return below(3) == 0 ? boolean_value(below(2) == 1) : number(record);
      case KeyType::kNumberOrChoice:
        return below(3) == 0 ? text_value(record.choices[below(record.choices.size())])
                             : number(record);
      case KeyType::kTexts:
        return list_value({text_value("a.csv"), text_value("b \"c\".csv")});
    }
    return {};
  }

 private:
  std::uint64_t below(std::uint64_t count) { return random_() % count; }
  double unit_interval() { return std::ldexp(static_cast<double>(random_() >> 11U), -53); }

  /// Ends of the range, numbers of few digits and of all of them, large and small.
  double draw(const KeyRecord& record) {
    const double min = std::isfinite(record.min) ? record.min : -1e9;
    const double max = std::isfinite(record.max) ? record.max : 1e9;
    while (true) {
      double value = min + unit_interval() * (max - min);
      const std::uint64_t way = below(8);
      if (way == 0) value = below(2) == 0 ? min : max;
      if (way == 1) value *= std::pow(10.0, -static_cast<double>(below(12)));
      if (way >= 4) {
        value =
            std::stod(fmt::format("{:.{}e}", value, static_cast<int>(below(way == 4 ? 16 : 4))));
      }
      const bool above = record.min_excluded ? value > min : value >= min;
      if (above && value <= max) return value;
    }
  }
  TomlValue number(const KeyRecord& record) { return number_value(draw(record)); }
  TomlValue integer(const KeyRecord& record) {
    const auto min = static_cast<std::int64_t>(record.min);
    const auto max = static_cast<std::int64_t>(record.max);
    return integer_value(
        min + static_cast<std::int64_t>(below(static_cast<std::uint64_t>(max - min) + 1)));
  }
  static TomlValue ordered(TomlValue a, TomlValue b) {
    if (b.number < a.number) std::swap(a, b);
    return list_value({std::move(a), std::move(b)});
  }
  static TomlValue named(const char* key, TomlValue value) {
    value.key = key;
    return value;
  }
  TomlValue min_max(const KeyRecord& record) {
    TomlValue ends = ordered(number(record), number(record));
    if (below(2) == 0 || ends.list[0].number == ends.list[1].number) return ends.list[0];
    return table_value({named("min", ends.list[0]), named("max", ends.list[1])});
  }
  TomlValue module(const KeyRecord& record) {
    const std::uint64_t way = below(3);
    if (way == 0) return number(record);
    TomlValue ends = ordered(number(record), number(record));
    if (ends.list[0].number == ends.list[1].number) return ends.list[0];
    if (way == 1) return table_value({named("series", ends)});
    return table_value({named("min", ends.list[0]), named("max", ends.list[1])});
  }
  TomlValue per_gear(const KeyRecord& record) {
    std::vector<TomlValue> gears;
    for (const char* gear : {"S", "P1", "R1", "P2", "R2"}) {
      gears.push_back(named(gear, number(record)));
    }
    return table_value(std::move(gears));
  }

  std::mt19937_64 random_;
};

/// What the numbers of a value are in SI, to the last bit, and its texts.
std::string bits_of(const KeyRecord& record, const TomlValue& value) {
  std::string text;
  switch (value.kind) {
    case TomlValue::Kind::kNumber:
      return fmt::format("{:016x}",
                         std::bit_cast<std::uint64_t>(units::to_si(value.number, record.unit)));
    case TomlValue::Kind::kList:
      for (const TomlValue& element : value.list) text += bits_of(record, element) + ",";
      return "[" + text + "]";
    case TomlValue::Kind::kTable:
      for (const TomlValue& member : value.table) {
        text += member.key + "=" + bits_of(record, member) + ",";
      }
      return "{" + text + "}";
    default:
      return toml_text(value);
  }
}

/// The value as a file's reader finds it, when it is written for the key; empty where the key
/// refuses it.
std::optional<TomlValue> read_back(const KeyRecord& record, const std::string& text) {
  KeyRecord alone = record;
  alone.path = "key";
  const TomlValue document = parse_toml("key = " + text, "f");
  FileReading reading("f");
  const auto found = match_keys(document, KeyIndex(expand_keys({&alone}, {})), reading);
  if (found.size() != 1) return std::nullopt;
  return *found[0].value;
}

template <class Target>
void expect_every_key_survives(const Schema<Target>& schema) {
  LegalValues values(20);
  constexpr int kSamples = 60;
  for (const Key<Target>& key : schema.keys()) {
    const bool per_gear = key.record.path.find("{gear}") != std::string::npos;
    for (std::size_t gear = 0; gear < (per_gear ? schema.gears().size() : 1); ++gear) {
      for (int sample = 0; sample < kSamples; ++sample) {
        const TomlValue stated = values.of(key.record);
        SCOPED_TRACE(fmt::format("{} = {}", key.record.path, toml_text(stated)));
        Target first;
        key.assign(key.record, first, gear, stated);
        const auto written = key.state(key.record, first, gear);
        ASSERT_TRUE(written);
        const auto read = read_back(key.record, toml_text(*written));
        ASSERT_TRUE(read) << "written as " << toml_text(*written) << ", which is refused";
        ASSERT_EQ(bits_of(key.record, *read), bits_of(key.record, stated))
            << "written as " << toml_text(*written);
        // What was read is written as before.
        Target second;
        key.assign(key.record, second, gear, *read);
        const auto again = key.state(key.record, second, gear);
        ASSERT_TRUE(again);
        ASSERT_EQ(toml_text(*again), toml_text(*written));
      }
    }
  }
}

TEST(KeyRoundTrip, OfDesign) { expect_every_key_survives(design_schema()); }
TEST(KeyRoundTrip, OfPair) { expect_every_key_survives(pair_schema()); }
TEST(KeyRoundTrip, OfActuator) { expect_every_key_survives(actuator_schema()); }
TEST(KeyRoundTrip, OfScenario) { expect_every_key_survives(scenario_schema()); }
TEST(KeyRoundTrip, OfSelection) { expect_every_key_survives(selection_schema()); }
TEST(KeyRoundTrip, OfSpecification) { expect_every_key_survives(specification_schema()); }

}  // namespace
}  // namespace gear3k::io::key_round_trip_test
