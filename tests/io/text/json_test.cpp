// The writer against nlohmann-json: the same text of any value.
#include "io/text/json.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace gear3k::io::json_test {
namespace {

using nlohmann::ordered_json;

std::string peer_text(const ordered_json& json) {
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

/// A random value and the peer's same one.
struct Twin {
  Json ours;
  ordered_json peer;
};

class Twins {
 public:
  explicit Twins(std::uint64_t seed) : random_(seed) {}

  Twin any(int depth) {
    switch (below(depth > 0 ? 8 : 6)) {
      case 0:
        return {nullptr, nullptr};
      case 1:
        return same(below(2) == 0);
      case 2:
        return same(static_cast<std::int64_t>(random_()) >> below(64));
      case 3:
        return same(random_() >> below(64));
      case 4:
        return same(number());
      case 5:
        return same(text());
      case 6:
        return array(depth);
      default:
        return object(depth);
    }
  }

  double number() {
    switch (below(4)) {
      case 0:  // any bits: subnormal, huge, NaN, infinite
        return std::bit_cast<double>(random_());
      case 1:  // few decimals, as read from a file
        return static_cast<double>(static_cast<std::int64_t>(below(2'000'000)) - 1'000'000) /
               std::pow(10.0, below(9));
      case 2:  // whole numbers and powers of ten
        return std::pow(10.0, static_cast<double>(below(60)) - 30.0);
      default:
        return std::uniform_real_distribution<double>(-1e3, 1e3)(random_);
    }
  }

  /// Bytes: ASCII with control characters, characters of several bytes, and pieces of such.
  std::string text() {
    static const std::vector<std::string> kPieces{
        "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x9A\x80", "\xED\x9F\xBF", "\xEF\xBF\xBF",
        "\xED\xA0", "\xF4\x90",     "\xE0\x9F",         "\xC0\xAF",     "\xF8"};
    std::string result;
    for (auto n = below(12); n > 0; --n) {
      switch (below(4)) {
        case 0:
          result += static_cast<char>(below(0x80));
          break;
        case 1:
          result += static_cast<char>(below(0x100));
          break;
        case 2:
          result += kPieces[below(kPieces.size())];
          break;
        default: {
          const std::string& piece = kPieces[below(kPieces.size())];
          result += piece.substr(0, 1 + below(piece.size()));
        }
      }
    }
    return result;
  }

 private:
  std::uint64_t below(std::uint64_t bound) { return random_() % bound; }

  template <class T>
  static Twin same(const T& value) {
    return {Json(value), ordered_json(value)};
  }
  Twin array(int depth) {
    Twin twin{Json::array(), ordered_json::array()};
    for (auto n = below(5); n > 0; --n) {
      Twin item = any(depth - 1);
      twin.ours.push_back(std::move(item.ours));
      twin.peer.push_back(std::move(item.peer));
    }
    return twin;
  }
  Twin object(int depth) {
    Twin twin{Json::object(), ordered_json::object()};
    for (auto n = below(5); n > 0; --n) {
      const std::string key = text();
      Twin item = any(depth - 1);
      twin.ours[key] = std::move(item.ours);
      twin.peer[key] = std::move(item.peer);
    }
    return twin;
  }

  std::mt19937_64 random_;
};

TEST(Json, NumbersHaveThePeersDigits) {
  Twins twins(1);
  for (int k = 0; k < 100'000; ++k) {
    const double number = twins.number();
    ASSERT_EQ(Json(number).text(), peer_text(number));
  }
  using Limits = std::numeric_limits<double>;
  for (const double number : {0.0, 1.0, -1.0, Limits::max(), Limits::lowest(), Limits::min(),
                              Limits::denorm_min(), Limits::infinity(), Limits::quiet_NaN(), 1e15,
                              1e16, 123456789012345680.0, 1e-4, 1e-5, 0.1 + 0.2}) {
    EXPECT_EQ(Json(number).text(), peer_text(number));
  }
  EXPECT_EQ(Json(2.0).text(), "2.0\n");
}

TEST(Json, TextsAreEscapedAsByThePeerAndReplacedWhereTheyAreNoUtf8) {
  Twins twins(2);
  for (int k = 0; k < 50'000; ++k) {
    const std::string text = twins.text();
    ASSERT_EQ(Json(text).text(), peer_text(text));
  }
  for (int byte = 0; byte < 0x100; ++byte) {
    const std::string text(1, static_cast<char>(byte));
    EXPECT_EQ(Json(text).text(), peer_text(text));
  }
}

TEST(Json, AnyValueHasThePeersText) {
  Twins twins(3);
  for (int k = 0; k < 5'000; ++k) {
    const Twin twin = twins.any(5);
    ASSERT_EQ(twin.ours.text(), peer_text(twin.peer));
  }
}

TEST(Json, BracesMeanWhatTheyMeanToThePeer) {
  const std::vector<double> numbers{1.5, 2.0};
  const Json ours{{"name", "S"},
                  {"pair", {"a", "b"}},
                  {"nested", {{"x", 1}, {"y", {{"z", nullptr}}}}},
                  {"rows", {{1, 2}, {3, 4}}},
                  {"numbers", numbers},
                  {"truth", true},
                  {"one", {7U}}};
  const ordered_json peer{{"name", "S"},
                          {"pair", {"a", "b"}},
                          {"nested", {{"x", 1}, {"y", {{"z", nullptr}}}}},
                          {"rows", {{1, 2}, {3, 4}}},
                          {"numbers", numbers},
                          {"truth", true},
                          {"one", {7U}}};
  EXPECT_EQ(ours.text(), peer_text(peer));
}

TEST(Json, EmptyOptionalIsNull) {
  EXPECT_TRUE(Json(std::optional<double>()).is_null());
  EXPECT_EQ(Json(std::optional<double>(2.5)).text(), "2.5\n");
}

TEST(Json, UpdateKeepsThePlaceOfAKey) {
  Json json{{"a", 1}, {"b", 2}};
  json.update({{"a", 3}, {"c", 4}});
  EXPECT_EQ(json.text(), "{\n  \"a\": 3,\n  \"b\": 2,\n  \"c\": 4\n}\n");
  EXPECT_EQ(json.at("c").text(), "4\n");
}

TEST(Json, WrongKindIsRefused) {
  Json number(1.0);
  EXPECT_THROW(number["key"], std::invalid_argument);
  EXPECT_THROW(number.push_back(1), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(number.items()), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(number.at("key")), std::invalid_argument);
  EXPECT_THROW(Json::object().update(number), std::invalid_argument);
}

TEST(JsonText, MinusZeroIsZero) {
  EXPECT_EQ(Json(-0.0).text(), "0.0\n");
  EXPECT_EQ(Json(0.0).text(), "0.0\n");
  EXPECT_EQ(Json(-0.5).text(), "-0.5\n");
}

}  // namespace
}  // namespace gear3k::io::json_test
