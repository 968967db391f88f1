#include "io/keys/key_registry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "train/tooth_set.hpp"

namespace gear3k::io {

namespace {

bool in_range(const KeyRecord& record, double x) {
  if (!std::isfinite(x)) return false;
  const bool above = record.min_excluded ? x > record.min : x >= record.min;
  return above && x <= record.max;
}

std::string range_text(const KeyRecord& record) {
  const bool low = std::isfinite(record.min);
  const bool high = std::isfinite(record.max);
  if (low && high) {
    return fmt::format("{}{} to {}", record.min_excluded ? "above " : "", record.min, record.max);
  }
  if (low) return fmt::format("{} {}", record.min_excluded ? "above" : "at least", record.min);
  if (high) return fmt::format("at most {}", record.max);
  return "";
}

std::string with_unit(const std::string& text, const KeyRecord& record) {
  std::string result = text;
  const std::string_view unit = units::unit_name(record.unit);
  if (!unit.empty()) result += fmt::format(" in {}", unit);
  const std::string range = range_text(record);
  if (!range.empty()) result += ", " + range;
  return result;
}

bool integers_in_range(const KeyRecord& record, const std::vector<TomlValue>& list) {
  return std::ranges::all_of(list, [&](const TomlValue& e) {
    return e.kind == TomlValue::Kind::kInteger && in_range(record, e.number);
  });
}

bool numbers_in_range(const KeyRecord& record, const std::vector<TomlValue>& list) {
  return std::ranges::all_of(
      list, [&](const TomlValue& e) { return e.is_number() && in_range(record, e.number); });
}

/// A number, or { min, max }.
bool min_max_fits(const KeyRecord& record, const TomlValue& value) {
  if (value.is_number()) return in_range(record, value.number);
  if (value.kind != TomlValue::Kind::kTable || value.table.size() != 2) return false;
  std::map<std::string, double> ends;
  for (const TomlValue& end : value.table) {
    if (!end.is_number() || !in_range(record, end.number)) return false;
    ends[end.key] = end.number;
  }
  return ends.contains("min") && ends.contains("max") && ends["min"] <= ends["max"];
}

bool module_fits(const KeyRecord& record, const TomlValue& value) {
  const bool table = value.kind == TomlValue::Kind::kTable;
  if (table && value.table.size() == 1 && value.table[0].key == "series") {
    const TomlValue& series = value.table[0];
    return series.kind == TomlValue::Kind::kList && !series.list.empty() &&
           numbers_in_range(record, series.list);
  }
  return min_max_fits(record, value);
}

bool per_gear_fits(const KeyRecord& record, const TomlValue& value) {
  if (value.is_number()) return in_range(record, value.number);
  if (value.kind != TomlValue::Kind::kTable || value.table.empty()) return false;
  return std::ranges::all_of(value.table, [&](const TomlValue& member) {
    return std::ranges::find(train::kGearNames, member.key) != train::kGearNames.end() &&
           member.is_number() && in_range(record, member.number);
  });
}

/// 2^53: beyond, not every integer is a double of its own, as ranges are.
constexpr std::int64_t kGreatestExact = std::int64_t{1} << 53U;

bool fits(const KeyRecord& record, const TomlValue& value) {
  using TomlKind = TomlValue::Kind;
  switch (record.type) {
    case KeyType::kNumber:
      return value.is_number() && in_range(record, value.number);
    case KeyType::kInteger:
      return value.kind == TomlKind::kInteger && in_range(record, value.number) &&
             value.integer >= -kGreatestExact && value.integer <= kGreatestExact;
    case KeyType::kBoolean:
      return value.kind == TomlKind::kBoolean;
    case KeyType::kText:
      return value.kind == TomlKind::kText;
    case KeyType::kChoice:
      return value.kind == TomlKind::kText &&
             std::ranges::find(record.choices, value.text) != record.choices.end();
    case KeyType::kChoices: {
      const auto fits = [&](const TomlValue& v) {
        return v.kind == TomlKind::kText &&
               std::ranges::find(record.choices, v.text) != record.choices.end();
      };
      if (value.kind != TomlKind::kList) return fits(value);
      return !value.list.empty() && std::ranges::all_of(value.list, fits);
    }
    case KeyType::kNumberRange:
      return value.kind == TomlKind::kList && value.list.size() == 2 &&
             numbers_in_range(record, value.list) && value.list[0].number <= value.list[1].number;
    case KeyType::kIntegerRange:
      return value.kind == TomlKind::kList && value.list.size() == 2 &&
             integers_in_range(record, value.list) &&
             value.list[0].integer <= value.list[1].integer;
    case KeyType::kIntegers:
      if (value.kind == TomlKind::kList) {
        return !value.list.empty() && integers_in_range(record, value.list);
      }
      return value.kind == TomlKind::kInteger && in_range(record, value.number) &&
             value.integer >= -kGreatestExact && value.integer <= kGreatestExact;
    case KeyType::kNumbers:
      return value.kind == TomlKind::kList && !value.list.empty() &&
             numbers_in_range(record, value.list);
    case KeyType::kModule:
      return module_fits(record, value);
    case KeyType::kNumberOrMinMax:
      return min_max_fits(record, value);
    case KeyType::kNumberPerGear:
      return per_gear_fits(record, value);
    case KeyType::kNumberOrRange:
      if (value.kind != TomlKind::kList) {
        return value.is_number() && value.number >= 0.0 && in_range(record, value.number);
      }
      return value.list.size() == 2 && numbers_in_range(record, value.list) &&
             value.list[0].number <= value.list[1].number;
    case KeyType::kNumberOrSwitch:
      return value.kind == TomlKind::kBoolean ||
             (value.is_number() && in_range(record, value.number));
    case KeyType::kNumberOrChoice:
      return value.kind == TomlKind::kText
                 ? std::ranges::find(record.choices, value.text) != record.choices.end()
                 : value.is_number() && in_range(record, value.number);
    case KeyType::kTexts:
      if (value.kind != TomlKind::kList) return value.kind == TomlKind::kText;
      return !value.list.empty() && std::ranges::all_of(value.list, [](const TomlValue& v) {
        return v.kind == TomlKind::kText;
      });
  }
  return false;
}

/// "; did you mean ...?" for the first text that is none of the choices; "" where nothing is near.
std::string hint_of(const KeyRecord& record, const TomlValue& value) {
  for (const TomlValue& element : value.list) {
    if (std::string hint = hint_of(record, element); !hint.empty()) return hint;
  }
  const bool unknown = value.kind == TomlValue::Kind::kText && !record.choices.empty() &&
                       std::ranges::find(record.choices, value.text) == record.choices.end();
  const std::string word = unknown ? closest_word(value.text, record.choices) : "";
  return word.empty() ? "" : fmt::format("; did you mean \"{}\"?", word);
}

std::string parent_of(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

/// Did-you-mean: the closest word of the same table, then the same word in another one, then the
/// closest path that ends in a word like it.
std::string suggestion(const std::string& path, const std::vector<ExpandedKey>& keys) {
  std::vector<std::string> siblings, paths;
  const std::string parent = parent_of(path);
  const std::string last =
      path.substr(path.rfind('.') == std::string::npos ? 0 : path.rfind('.') + 1);
  std::string same_word;
  for (const ExpandedKey& key : keys) {
    const std::string key_parent = parent_of(key.path);
    const std::string word = key.path.substr(key_parent.empty() ? 0 : key_parent.size() + 1);
    if (!closest_word(last, {word}).empty()) paths.push_back(key.path);
    if (key_parent == parent) siblings.push_back(word);
    if (word == last && same_word.empty()) same_word = key.path;
  }
  const std::string sibling = closest_word(last, siblings);
  if (!sibling.empty()) return parent.empty() ? sibling : parent + "." + sibling;
  if (!same_word.empty()) return same_word;
  return closest_word(path, paths);
}

struct Matcher {
  const KeyIndex& index;
  FileReading& reading;
  std::vector<FoundValue> found;

  void unknown(const std::string& path, const TomlValue& value) {
    reading.error(value.position, [&] {
      const std::string hint = suggestion(path, index.keys);
      const bool table = value.kind == TomlValue::Kind::kTable;
      return fmt::format("unknown {} {}{}", table ? "table" : "key", path,
                         hint.empty() ? "" : fmt::format("; did you mean {}?", hint));
    });
  }

  void unknown_table(const std::string& path, const TomlValue& value) {
    reading.error(value.position, [&] {
      const std::string hint = closest_word(path, {index.tables.begin(), index.tables.end()});
      return fmt::format("unknown table [{}]{}", path,
                         hint.empty() ? "" : fmt::format("; did you mean [{}]?", hint));
    });
  }

  void value(const ExpandedKey& key, const TomlValue& v) {
    reading.remember(key.path, v.position);
    if (!fits(*key.record, v)) {
      std::string message =
          fmt::format("{} = {}: allowed: {}", key.path, as_text(v), allowed_text(*key.record));
      message += hint_of(*key.record, v);
      reading.error(v.position, message);
      return;
    }
    reading.accept(key.path);
    found.push_back({.key = key.key, .gear = key.gear, .value = &v});
  }

  void walk(const TomlValue& table, const std::string& prefix) {
    for (const TomlValue& member : table.table) {
      // A quoted key with a dot in it names none, though its path may read as one that does.
      const bool dotted = member.key.find('.') != std::string::npos;
      const std::string name = dotted ? fmt::format("\"{}\"", member.key) : member.key;
      const std::string path = prefix.empty() ? name : fmt::format("{}.{}", prefix, name);
      const auto key = index.by_path.find(path);
      const bool known = key != index.by_path.end();
      const bool is_table = member.kind == TomlValue::Kind::kTable;
      const bool known_table = index.tables.contains(path);
      if (known && !(is_table && known_table)) {
        value(index.keys[key->second], member);
      } else if (is_table && known_table) {
        reading.remember(path, member.position);
        walk(member, path);
      } else if (known_table) {
        reading.error(member.position,
                      fmt::format("{} = {}: allowed: a table [{}]", path, as_text(member), path));
      } else if (is_table) {
        unknown_table(path, member);
      } else {
        unknown(path, member);
      }
    }
  }
};

}  // namespace

KeyRecord number(std::string_view path, units::Unit unit, const Range& range,
                 std::string_view default_text, std::string_view help) {
  return {.path = std::string(path),
          .unit = unit,
          .min = range.min,
          .max = range.max,
          .min_excluded = range.min_excluded,
          .required = default_text == kRequired,
          .default_text = std::string(default_text),
          .help = std::string(help)};
}

KeyRecord number(std::string_view path, units::Unit unit, const Range& range,
                 std::string_view default_text, std::string_view help,
                 const design::InputId& input) {
  KeyRecord record = number(path, unit, range, default_text, help);
  record.input = input;
  return record;
}

KeyRecord number_range(std::string_view path, units::Unit unit, const Range& range,
                       std::string_view default_text, std::string_view help) {
  KeyRecord record = number(path, unit, range, default_text, help);
  record.type = KeyType::kNumberRange;
  return record;
}

KeyRecord integer(std::string_view path, const Range& range, std::string_view default_text,
                  std::string_view help) {
  KeyRecord record = number(path, units::Unit::kNone, range, default_text, help);
  record.type = KeyType::kInteger;
  return record;
}

std::string allowed_text(const KeyRecord& record) {
  switch (record.type) {
    case KeyType::kNumber:
      return with_unit("a number", record);
    case KeyType::kInteger:
      return with_unit("an integer", record);
    case KeyType::kBoolean:
      return "true or false";
    case KeyType::kText:
      return "a text in quotes";
    case KeyType::kChoice:
      return fmt::format("\"{}\"", fmt::join(record.choices, "\" or \""));
    case KeyType::kChoices:
      return fmt::format("\"{}\", or a list of these", fmt::join(record.choices, "\" or \""));
    case KeyType::kNumberRange:
      return with_unit("[low, high], two numbers", record) +
             (record.ends_differ ? ", low < high" : ", low <= high");
    case KeyType::kIntegerRange:
      return with_unit("[low, high], two integers", record) + ", low <= high";
    case KeyType::kIntegers:
      return with_unit("an integer or a list of integers", record);
    case KeyType::kNumbers:
      return with_unit("a list of numbers", record);
    case KeyType::kModule:
      return with_unit("a number, { min, max } with min <= max, or { series = [..] }", record);
    case KeyType::kNumberOrMinMax:
      return with_unit("a number, or { min, max } with min <= max", record);
    case KeyType::kNumberPerGear:
      return with_unit("a number, or a table with S, P1, R1, P2, R2", record);
    case KeyType::kNumberOrRange:
      return with_unit("a number >= 0, meaning +- it, or [lower, upper], lower <= upper", record);
    case KeyType::kNumberOrSwitch:
      return with_unit("true, false, or a number", record);
    case KeyType::kNumberOrChoice:
      return fmt::format("{}, or \"{}\"", with_unit("a number", record),
                         fmt::join(record.choices, "\" or \""));
    case KeyType::kTexts:
      return "a text in quotes, or a list of these";
  }
  return "";
}

Position FileReading::position_of(const std::string& path) const {
  std::string place = path;
  while (true) {
    for (const auto& [known, position] : places_) {
      if (known == place) return position;
    }
    if (place.empty()) return {.line = 1, .column = 1};
    place = parent_of(place);
  }
}

void FileReading::error_at(const std::string& path, const std::string& message) {
  error(position_of(path), message);
}

std::string FileReading::place_of(const std::string& path) const {
  return place_of(position_of(path));
}
std::string FileReading::place_of(Position position) const {
  return fmt::format("{}:{}:{}", file_, position.line, position.column);
}

bool FileReading::has(const std::string& path) const { return accepted_.contains(path); }

bool FileReading::stated(const std::string& path) const {
  return std::ranges::any_of(places_, [&](const auto& place) { return place.first == path; });
}

void FileReading::throw_if_invalid() const {
  if (!complaints_.none()) throw InvalidInput(complaints_.text(file_));
}

std::vector<ExpandedKey> expand_keys(const std::vector<const KeyRecord*>& records,
                                     const std::vector<std::string>& gears) {
  static constexpr std::string_view kPlaceholder = "{gear}";
  std::vector<ExpandedKey> keys;
  for (std::size_t k = 0; k < records.size(); ++k) {
    const std::string& path = records[k]->path;
    const auto at = path.find(kPlaceholder);
    if (at == std::string::npos) {
      keys.push_back({.path = path, .record = records[k], .key = k, .gear = 0});
      continue;
    }
    for (std::size_t g = 0; g < gears.size(); ++g) {
      std::string expanded = path;
      expanded.replace(at, kPlaceholder.size(), gears[g]);
      keys.push_back({.path = expanded, .record = records[k], .key = k, .gear = g});
    }
  }
  return keys;
}

KeyIndex::KeyIndex(std::vector<ExpandedKey> expanded) : keys(std::move(expanded)) {
  for (std::size_t k = 0; k < keys.size(); ++k) {
    by_path[keys[k].path] = k;
    for (std::string parent = parent_of(keys[k].path); !parent.empty();
         parent = parent_of(parent)) {
      tables.insert(parent);
    }
  }
}

void say_missing(const ExpandedKey& key, FileReading& reading) {
  reading.error_at(key.path, fmt::format("{} is missing: {}; allowed: {}", key.path,
                                         key.record->help, allowed_text(*key.record)));
}

std::vector<FoundValue> match_keys(const TomlValue& document, const KeyIndex& index,
                                   FileReading& reading) {
  Matcher matcher{.index = index, .reading = reading, .found = {}};
  matcher.walk(document, "");
  for (const ExpandedKey& key : index.keys) {
    if (key.record->required && !reading.stated(key.path)) say_missing(key, reading);
  }
  return matcher.found;
}

std::string text_of(std::vector<StatedValue> values, const std::vector<std::string>& order) {
  const auto rank = [&](const std::string& path) {
    for (std::string prefix = path; !prefix.empty(); prefix = parent_of(prefix)) {
      const auto place = std::ranges::find(order, prefix);
      if (place != order.end()) return place - order.begin();
    }
    return std::ssize(order);
  };
  const auto place = [&](const StatedValue& v) {
    return std::tuple(rank(v.path), v.gear, std::ranges::count(v.path, '.'));
  };
  std::ranges::stable_sort(values, {}, place);
  std::string text, table;
  for (const StatedValue& v : values) {
    const std::string own = parent_of(v.path);
    if (own != table) {
      // A gear's own table stands with the gear.
      const bool within = std::ranges::count(own, '.') > 1;
      text += fmt::format("{}[{}]\n", within ? "" : "\n", own);
      table = own;
    }
    text += fmt::format("{} = {}\n", v.path.substr(own.empty() ? 0 : own.size() + 1),
                        toml_text(v.value));
  }
  return text;
}

std::string key_table(const std::vector<const KeyRecord*>& records,
                      const std::vector<std::string>& gears) {
  const auto cell = [](std::string content) {
    for (std::size_t at = 0; (at = content.find('|', at)) != std::string::npos; at += 2) {
      content.insert(at, 1, '\\');
    }
    return content;
  };
  std::string text = "| key | value | default | meaning |\n|---|---|---|---|\n";
  const std::string any_gear = gears.empty() ? "" : fmt::format("<{}>", fmt::join(gears, ","));
  for (const KeyRecord* r : records) {
    std::string path = r->path;
    const auto at = path.find("{gear}");
    if (at != std::string::npos) path.replace(at, 6, any_gear);
    text += fmt::format("| `{}` | {} | {} | {} |\n", path, cell(allowed_text(*r)),
                        cell(r->required ? "required" : r->default_text), cell(r->help));
  }
  return text;
}

}  // namespace gear3k::io
