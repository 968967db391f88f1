#pragma once
// JSON texts of results.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace gear3k::io {

/// A JSON value to be written; an object keeps its keys in the order in which they came.
///
/// Made of what it holds: a text, a number, a truth value, nullptr, a range of such values, an
/// optional one (null where it is empty), or a list in braces.  Such a list is an object where each
/// of its items is a list of two that begins with a text, else an array.
///
///   Json{{"name", "S"}, {"teeth", 21}, {"shifts", {0.1, 0.2}}}
class Json {
 public:
  class Item;
  struct Member;
  using Array = std::vector<Json>;
  using Object = std::vector<Member>;
  using Value = std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string,
                             Array, Object>;

  // NOLINTBEGIN(google-explicit-constructor): a value stands for itself
  Json();
  Json(std::nullptr_t);
  Json(double value);
  template <std::integral T>
  Json(T value) : Json() {
    if constexpr (std::same_as<T, bool>) {
      set(value);
    } else if constexpr (std::is_signed_v<T>) {
      set(static_cast<std::int64_t>(value));
    } else {
      set(static_cast<std::uint64_t>(value));
    }
  }
  Json(const char* text);
  Json(std::string_view text);
  Json(std::string text);
  template <class T>
  Json(const std::optional<T>& value) : Json(value ? Json(*value) : Json()) {}
  template <std::ranges::input_range Items>
  requires(!std::convertible_to<const Items&, std::string_view>) Json(const Items& items)
      : Json(array()) {
    for (const auto& item : items) push_back(item);
  }
  Json(std::initializer_list<Item> items);
  // NOLINTEND(google-explicit-constructor)
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(const Json& other);
  Json& operator=(Json&& other) noexcept;
  ~Json();

  /// An array or object without anything in it.
  static Json array();
  static Json object();

  /// The value of a key, null where it is new.
  /// @throws std::invalid_argument where this is neither an object nor null
  Json& operator[](std::string_view key);
  /// The value of a key.
  /// @throws std::invalid_argument where this is no object or has no such key
  [[nodiscard]] const Json& at(std::string_view key) const;
  /// Appends to an array; null becomes one.
  /// @throws std::invalid_argument where this is neither an array nor null
  void push_back(Json value);
  /// Takes the values of another object over, at their place where a key is there already.
  /// @throws std::invalid_argument as operator[] and at()
  void update(const Json& object);

  [[nodiscard]] bool is_null() const;
  /// What it holds.
  [[nodiscard]] const Value& value() const { return value_; }
  /// The values of an array.
  /// @throws std::invalid_argument where this is none
  [[nodiscard]] const Array& items() const;

  /// The text of a file: two spaces per level, a line end after the last line.
  ///
  /// Numbers have the digits that read back as the same double and a decimal point or an exponent
  /// where they are not whole numbers by type; null stands for NaN and infinities, U+FFFD for bytes
  /// that are no UTF-8 (one for each longest beginning of a character, as Unicode recommends).
  [[nodiscard]] std::string text() const;

 private:
  explicit Json(Value value);
  // Members that need the value whole are in the source: Member is not known yet.
  void set(bool value);
  void set(std::int64_t value);
  void set(std::uint64_t value);

  Value value_;
};

struct Json::Member {
  std::string key;
  Json value;
};

/// One value of a list in braces; what it holds can be moved out of the list.
class Json::Item {
 public:
  // NOLINTBEGIN(google-explicit-constructor,bugprone-forwarding-reference-overload): as Json, and
  // not for an Item
  template <class T>
  requires(std::constructible_from<Json, T&&> && !std::same_as<std::remove_cvref_t<T>, Item>)
      Item(T&& value)
      : value_(std::forward<T>(value)) {}
  Item(std::initializer_list<Item> items) : value_(items) {}
  // NOLINTEND(google-explicit-constructor,bugprone-forwarding-reference-overload)

 private:
  friend class Json;
  mutable Json value_;
};

}  // namespace gear3k::io
