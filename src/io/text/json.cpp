#include "io/text/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
// The conversion alone: json.hpp as a whole takes seconds to compile.
#include <nlohmann/detail/conversions/to_chars.hpp>
#include <stdexcept>

#include "io/text/utf8.hpp"

namespace gear3k::io {

namespace {

void append_ascii(std::string& out, char c) {
  switch (c) {
    case '\b':
      out += "\\b";
      return;
    case '\t':
      out += "\\t";
      return;
    case '\n':
      out += "\\n";
      return;
    case '\f':
      out += "\\f";
      return;
    case '\r':
      out += "\\r";
      return;
    case '"':
      out += "\\\"";
      return;
    case '\\':
      out += "\\\\";
      return;
    default:
      break;
  }
  constexpr char kFirstPrinted = 0x20;
  if (c < kFirstPrinted) {
    fmt::format_to(std::back_inserter(out), "\\u{:04x}", static_cast<unsigned>(c));
  } else {
    out += c;
  }
}

void append_quoted(std::string& out, std::string_view text) {
  out += '"';
  while (!text.empty()) {
    std::size_t bytes = 1;
    if (static_cast<unsigned char>(text.front()) < 0x80) {
      append_ascii(out, text.front());
    } else {
      const Utf8Character character = first_character(text);
      bytes = character.bytes;
      out += character.whole ? text.substr(0, bytes) : std::string_view("\xEF\xBF\xBD");
    }
    text.remove_prefix(bytes);
  }
  out += '"';
}

void append_number(std::string& out, double value) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  std::array<char, 64> digits{};
  char* const begin = digits.data();
  // Minus zero is zero.
  out.append(begin, nlohmann::detail::to_chars(begin, begin + digits.size(), value + 0.0));
}

/// The text of one value after the other.
class JsonWriter {
 public:
  void add(const Json& json) {
    std::visit([this](const auto& value) { add(value); }, json.value());
  }
  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  void add(std::nullptr_t) { out_ += "null"; }
  void add(bool value) { out_ += value ? "true" : "false"; }
  void add(std::int64_t value) { fmt::format_to(std::back_inserter(out_), "{}", value); }
  void add(std::uint64_t value) { fmt::format_to(std::back_inserter(out_), "{}", value); }
  void add(double value) { append_number(out_, value); }
  void add(const std::string& value) { append_quoted(out_, value); }
  void add(const Json::Array& values) {
    add_list('[', ']', values, [this](const Json& value) { add(value); });
  }
  void add(const Json::Object& members) {
    add_list('{', '}', members, [this](const Json::Member& member) {
      append_quoted(out_, member.key);
      out_ += ": ";
      add(member.value);
    });
  }

  template <class Items, class AddItem>
  void add_list(char open, char close, const Items& items, AddItem add_item) {
    out_ += open;
    indent_ += 2;
    const char* separator = "\n";
    for (const auto& item : items) {
      out_ += separator;
      out_.append(indent_, ' ');
      add_item(item);
      separator = ",\n";
    }
    indent_ -= 2;
    if (!items.empty()) {
      out_ += '\n';
      out_.append(indent_, ' ');
    }
    out_ += close;
  }

  std::string out_;
  std::size_t indent_ = 0;
};

}  // namespace

Json::Json() : value_(nullptr) {}
Json::Json(std::nullptr_t) : value_(nullptr) {}
Json::Json(double value) : value_(value) {}
Json::Json(const char* text) : value_(std::string(text)) {}
Json::Json(std::string_view text) : value_(std::string(text)) {}
Json::Json(std::string text) : value_(std::move(text)) {}
Json::Json(Value value) : value_(std::move(value)) {}
Json::Json(const Json& other) = default;
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(const Json& other) = default;
Json& Json::operator=(Json&& other) noexcept = default;
Json::~Json() = default;

void Json::set(bool value) { value_ = value; }
void Json::set(std::int64_t value) { value_ = value; }
void Json::set(std::uint64_t value) { value_ = value; }

Json::Json(std::initializer_list<Item> items) {
  const auto is_member = [](const Item& item) {
    const auto* pair = std::get_if<Array>(&item.value_.value_);
    return pair != nullptr && pair->size() == 2 &&
           std::holds_alternative<std::string>(pair->front().value_);
  };
  if (std::ranges::all_of(items, is_member)) {
    auto& members = value_.emplace<Object>();
    members.reserve(items.size());
    for (const Item& item : items) {
      auto& pair = std::get<Array>(item.value_.value_);
      members.push_back({std::get<std::string>(std::move(pair[0].value_)), std::move(pair[1])});
    }
    return;
  }
  auto& values = value_.emplace<Array>();
  values.reserve(items.size());
  for (const Item& item : items) values.push_back(std::move(item.value_));
}

Json Json::array() { return Json(Value(Array())); }
Json Json::object() { return Json(Value(Object())); }

bool Json::is_null() const { return std::holds_alternative<std::nullptr_t>(value_); }

Json& Json::operator[](std::string_view key) {
  if (is_null()) value_.emplace<Object>();
  auto* members = std::get_if<Object>(&value_);
  if (members == nullptr) {
    throw std::invalid_argument(fmt::format("json: key {} of a value that is no object", key));
  }
  const auto at = std::ranges::find(*members, key, &Member::key);
  return at != members->end() ? at->value
                              : members->emplace_back(Member{std::string(key), {}}).value;
}

const Json& Json::at(std::string_view key) const {
  if (const auto* members = std::get_if<Object>(&value_)) {
    const auto at = std::ranges::find(*members, key, &Member::key);
    if (at != members->end()) return at->value;
  }
  throw std::invalid_argument(fmt::format("json: no key {}", key));
}

void Json::push_back(Json value) {
  if (is_null()) value_.emplace<Array>();
  auto* values = std::get_if<Array>(&value_);
  if (values == nullptr)
    throw std::invalid_argument("json: push_back() on a value of another kind");
  values->push_back(std::move(value));
}

void Json::update(const Json& object) {
  const auto* members = std::get_if<Object>(&object.value_);
  if (members == nullptr) throw std::invalid_argument("json: update() with what is no object");
  for (const Member& member : *members) (*this)[member.key] = member.value;
}

const Json::Array& Json::items() const {
  if (const auto* values = std::get_if<Array>(&value_)) return *values;
  throw std::invalid_argument("json: items() of a value that is no array");
}

std::string Json::text() const {
  JsonWriter writer;
  writer.add(*this);
  return writer.take() + '\n';
}

}  // namespace gear3k::io
