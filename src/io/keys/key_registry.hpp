#pragma once
// One record per key of a file: name, type, unit, range, default, help, and the place of its value.
// The same record reads and writes files and makes the tables of docs/keys.md.

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/keys/key_value.hpp"
#include "io/text/complaints.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::io {

/// What a value may be, in words: "a number in mm, above 0 to 100".
std::string allowed_text(const KeyRecord& record);

/// A key of files that describe a Target; `gear` counts the schema's gears (0 where the path has
/// none).
template <class Target>
struct Key {
  KeyRecord record;
  /// Stores a value that has passed the record's type and range.
  std::function<void(const KeyRecord&, Target&, std::size_t gear, const TomlValue&)> assign;
  /// The value as a file states it; empty where there is none.
  std::function<std::optional<TomlValue>(const KeyRecord&, const Target&, std::size_t gear)> state;
  /// Whether a written file states it; without: wherever it has a value.
  std::function<bool(const Target&, std::size_t gear)> written = {};
};

/// A key of a schema with its path spelt out, for the untyped part of reading.
struct ExpandedKey {
  std::string path;
  const KeyRecord* record;
  std::size_t key, gear;
};
std::vector<ExpandedKey> expand_keys(const std::vector<const KeyRecord*>& records,
                                     const std::vector<std::string>& gears);

/// What a reader looks up: every key by its path, and the tables that hold them.
struct KeyIndex {
  explicit KeyIndex(std::vector<ExpandedKey> expanded);

  std::vector<ExpandedKey> keys;
  std::map<std::string, std::size_t> by_path;  ///< place among the keys
  std::set<std::string> tables;
};

/// The keys of a file that describes a Target.  Made once for a kind of file: the records and the
/// index point at each other.
template <class Target>
class Schema {
 public:
  /// @param gears  what "{gear}" stands for
  /// @param order  keys and tables in the order in which they are written; the others follow
  Schema(std::vector<std::string> gears, std::vector<Key<Target>> keys,
         std::vector<std::string> order = {})
      : gears_(std::move(gears)),
        keys_(std::move(keys)),
        order_(std::move(order)),
        index_(expand_keys(records(), gears_)) {}
  Schema(const Schema&) = delete;
  Schema& operator=(const Schema&) = delete;
  Schema(Schema&&) = delete;
  Schema& operator=(Schema&&) = delete;
  ~Schema() = default;

  [[nodiscard]] const std::vector<std::string>& gears() const { return gears_; }
  [[nodiscard]] const std::vector<Key<Target>>& keys() const { return keys_; }
  [[nodiscard]] const std::vector<std::string>& order() const { return order_; }
  [[nodiscard]] const KeyIndex& index() const { return index_; }
  [[nodiscard]] std::vector<const KeyRecord*> records() const {
    std::vector<const KeyRecord*> records;
    records.reserve(keys_.size());
    for (const Key<Target>& key : keys_) records.push_back(&key.record);
    return records;
  }

 private:
  std::vector<std::string> gears_;
  std::vector<Key<Target>> keys_;
  std::vector<std::string> order_;
  KeyIndex index_;
};

/// What a view shows of a Target: a pointer to a member, or auto&(auto& target, std::size_t gear).
template <class View, class Target>
auto& seen(const View& view, Target& target, std::size_t gear) {
  if constexpr (std::is_member_object_pointer_v<View>) {
    return target.*view;
  } else {
    return view(target, gear);
  }
}

/// A key whose value is one member.
/// @param view  of the member, see seen()
template <class Target, class View>
// NOLINTNEXTLINE(performance-unnecessary-value-param): it is moved from
Key<Target> make_key(KeyRecord record, View view,
                     std::function<bool(const Target&, std::size_t gear)> written = {}) {
  return {.record = std::move(record),
          .assign = [view](const KeyRecord& r, Target& t, std::size_t gear,
                           const TomlValue& v) { store(r, v, seen(view, t, gear)); },
          .state = [view](const KeyRecord& r, const Target& t,
                          std::size_t gear) { return stated(r, seen(view, t, gear)); },
          .written = std::move(written)};
}

/// The key, written only where its value differs from that of a Target of nothing but defaults.
template <class Target>
Key<Target> unless_default(Key<Target> key) {
  key.written = [record = key.record, state = key.state](const Target& t, std::size_t gear) {
    const auto value = state(record, t, gear);
    const auto usual = state(record, Target{}, gear);
    return value && (!usual || toml_text(*value) != toml_text(*usual));
  };
  return key;
}

/// Appends the keys of a part of the Target.
/// @param view    of the part, see seen()
/// @param prefix  stands before their paths
template <class Target, class Part, class View>
void append_keys(std::vector<Key<Target>>& keys, const std::vector<Key<Part>>& part, View view,
                 const std::string& prefix = "") {
  for (const Key<Part>& key : part) {
    KeyRecord record = key.record;
    record.path = prefix + record.path;
    keys.push_back(
        {.record = std::move(record),
         .assign = [assign = key.assign, view](
                       const KeyRecord& r, Target& t, std::size_t gear,
                       const TomlValue& v) { assign(r, seen(view, t, gear), gear, v); },
         .state = [state = key.state, view](
                      const KeyRecord& r, const Target& t,
                      std::size_t gear) { return state(r, seen(view, t, gear), gear); }});
    if (!key.written) continue;
    keys.back().written = [written = key.written, view](const Target& t, std::size_t gear) {
      return written(seen(view, t, gear), gear);
    };
  }
}

/// Places of the keys that a file holds, and what was wrong with it.
class FileReading {
 public:
  explicit FileReading(std::string file) : file_(std::move(file)) {}

  /// Adds a message at a key's place; at its table's or the file's when the key is absent.
  void error_at(const std::string& path, const std::string& message);
  void error(Position position, const std::string& message) { complaints_.add(position, message); }
  /// The same with a message that is made only where it is kept (Complaints).
  void error(Position position, const std::function<std::string()>& message) {
    complaints_.add(position, message);
  }
  /// "file:line:column" of a key, of its table or of the file where the key is absent.
  [[nodiscard]] std::string place_of(const std::string& path) const;
  [[nodiscard]] std::string place_of(Position position) const;
  /// Whether a key is in the file, with whatever value.
  [[nodiscard]] bool stated(const std::string& path) const;
  /// Whether a key is in the file with a value of its type and range.
  [[nodiscard]] bool has(const std::string& path) const;
  /// Messages so far.
  [[nodiscard]] std::size_t count() const { return complaints_.count(); }
  /// @throws InvalidInput with the messages (Complaints), when there are any
  void throw_if_invalid() const;

  void remember(const std::string& path, Position position) {
    places_.emplace_back(path, position);
  }
  void accept(const std::string& path) { accepted_.insert(path); }

 private:
  [[nodiscard]] Position position_of(const std::string& path) const;

  std::string file_;
  std::vector<std::pair<std::string, Position>> places_;
  std::set<std::string> accepted_;
  Complaints complaints_;
};

/// A value found in the file that fits a key.
struct FoundValue {
  std::size_t key, gear;
  const TomlValue* value;
};

/// Says that a required key is missing.
void say_missing(const ExpandedKey& key, FileReading& reading);

/// Matches a document with the keys: unknown keys, wrong types, values out of range and missing
/// required keys become errors in `reading`.  @returns the values that passed.
std::vector<FoundValue> match_keys(const TomlValue& document, const KeyIndex& index,
                                   FileReading& reading);

/// Reads a document into a target by a schema; errors are collected in `reading`.
template <class Target>
void read_by_schema(const TomlValue& document, const Schema<Target>& schema, Target& target,
                    FileReading& reading) {
  for (const FoundValue& found : match_keys(document, schema.index(), reading)) {
    const Key<Target>& key = schema.keys()[found.key];
    key.assign(key.record, target, found.gear, *found.value);
  }
}

/// A value that is to be written.
struct StatedValue {
  std::string path;
  std::size_t gear = 0;
  TomlValue value = {};
};
/// A file of these values, in the order of Schema::order(), then of the gears; a gear's own keys
/// come before those of its tables.
std::string text_of(std::vector<StatedValue> values, const std::vector<std::string>& order);

/// The file that read_by_schema() turns into the target, as far as its schema's keys are written.
template <class Target>
std::string text_by_schema(const Schema<Target>& schema, const Target& target) {
  std::vector<StatedValue> values;
  for (const ExpandedKey& at : schema.index().keys) {
    const Key<Target>& key = schema.keys()[at.key];
    if (key.written && !key.written(target, at.gear)) continue;
    if (auto value = key.state(key.record, target, at.gear)) {
      values.push_back({.path = at.path, .gear = at.gear, .value = std::move(*value)});
    }
  }
  return text_of(std::move(values), schema.order());
}

/// Markdown table of keys: key, value, default, meaning.
std::string key_table(const std::vector<const KeyRecord*>& records,
                      const std::vector<std::string>& gears);

template <class Target>
std::string key_table(const Schema<Target>& schema) {
  return key_table(schema.records(), schema.gears());
}

}  // namespace gear3k::io
