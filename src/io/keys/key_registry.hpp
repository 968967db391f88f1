#pragma once
// One record per key of a file: name, type, unit, range, default, help.  The same record drives
// parsing, --help and the tables of docs/keys.md.

#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/text/toml_value.hpp"

namespace gear3k::io {

enum class KeyType {
  kNumber,
  kInteger,
  kBoolean,
  kText,
  kChoice,
  kChoices,        ///< one of the choices, or a list of them
  kNumberRange,    ///< [low, high]
  kIntegerRange,   ///< [low, high]
  kIntegers,       ///< an integer or a list of them
  kNumbers,        ///< a list of numbers
  kModule,         ///< a number, { min, max } or { series = [..] }
  kNumberPerGear,  ///< a number for all gears, or { S = .., P1 = .., .. }
  kNumberOrRange,  ///< a number (± it), or [lower, upper]
  kNumberOrSwitch  ///< a number, or true (default limit) or false (off)
};

struct KeyRecord {
  /// Path with dots; "{gear}" stands for each of the schema's gears.
  std::string path = {};
  KeyType type = KeyType::kNumber;
  std::string unit = {};  ///< "" = dimensionless
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
  std::vector<std::string> choices = {};
  bool required = false;
  std::string default_text = {};  ///< as documentation shows it; "" = none
  std::string help = {};
};

/// What a value may be, in words: "a number in mm, above 0 to 100".
std::string allowed_text(const KeyRecord& record);

/// A key of files that describe a Target.
template <class Target>
struct Key {
  KeyRecord record;
  /// Stores a value that has passed the record's type and range; `gear` counts the schema's gears
  /// (0 where the path has none).
  std::function<void(Target&, std::size_t gear, const TomlValue&)> assign;
};

template <class Target>
struct Schema {
  std::vector<std::string> gears;  ///< what "{gear}" stands for
  std::vector<Key<Target>> keys;
};

/// Places of the keys that a file holds, and what was wrong with it.
class FileReading {
 public:
  explicit FileReading(std::string file) : file_(std::move(file)) {}

  /// Adds a message at a key's place; at its table's or the file's when the key is absent.
  void error_at(const std::string& path, const std::string& message);
  void error(Position position, const std::string& message) {
    diagnostics_.push_back({.position = position, .message = message});
  }
  /// Whether a key is in the file, with whatever value.
  [[nodiscard]] bool stated(const std::string& path) const;
  /// Whether a key is in the file with a value of its type and range.
  [[nodiscard]] bool has(const std::string& path) const;
  /// @throws InvalidInput with all messages, when there are any
  void throw_if_invalid() const;

  void remember(const std::string& path, Position position) {
    places_.emplace_back(path, position);
  }
  void accept(const std::string& path) { accepted_.insert(path); }

 private:
  std::string file_;
  std::vector<std::pair<std::string, Position>> places_;
  std::set<std::string> accepted_;
  std::vector<Diagnostic> diagnostics_;
};

/// A key of a schema with its path spelt out, for the untyped part of reading.
struct ExpandedKey {
  std::string path;
  const KeyRecord* record;
  std::size_t key, gear;
};
/// A value found in the file that fits a key.
struct FoundValue {
  std::size_t key, gear;
  const TomlValue* value;
};

/// Matches a document with the keys: unknown keys, wrong types, values out of range and missing
/// required keys become errors in `reading`.  @returns the values that passed.
std::vector<FoundValue> match_keys(const TomlValue& document, const std::vector<ExpandedKey>& keys,
                                   FileReading& reading);

std::vector<ExpandedKey> expand_keys(const std::vector<const KeyRecord*>& records,
                                     const std::vector<std::string>& gears);

/// Reads a document into a target by a schema; errors are collected in `reading`.
template <class Target>
void read_by_schema(const TomlValue& document, const Schema<Target>& schema, Target& target,
                    FileReading& reading) {
  std::vector<const KeyRecord*> records;
  for (const Key<Target>& key : schema.keys) records.push_back(&key.record);
  for (const FoundValue& found :
       match_keys(document, expand_keys(records, schema.gears), reading)) {
    schema.keys[found.key].assign(target, found.gear, *found.value);
  }
}

/// Markdown table of keys: key, value, default, meaning.
std::string key_table(const std::vector<const KeyRecord*>& records,
                      const std::vector<std::string>& gears);

template <class Target>
std::string key_table(const Schema<Target>& schema) {
  std::vector<const KeyRecord*> records;
  for (const Key<Target>& key : schema.keys) records.push_back(&key.record);
  return key_table(records, schema.gears);
}

}  // namespace gear3k::io
