#include "io/text/toml_limits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace gear3k::io {

namespace {

/// Walks over a TOML text: strings and comments in one step, everything else character by
/// character.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  [[nodiscard]] bool done() const { return rest_.empty(); }
  [[nodiscard]] char front() const { return rest_.front(); }
  [[nodiscard]] Position position() const { return position_; }

  void skip(std::size_t bytes) {
    for (const char c : rest_.substr(0, bytes)) {
      if (c == '\n') {
        ++position_.line;
        position_.column = 1;
      } else if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) {
        ++position_.column;  // columns count characters, UTF-8's continuation bytes none
      }
    }
    rest_.remove_prefix(std::min(bytes, rest_.size()));
  }
  void skip_comment() { skip(std::min(rest_.find('\n'), rest_.size())); }

  /// Behind the quotes that end the string which begins here.  @returns false where it has no end,
  /// which the parser will say
  bool skip_string() {
    const char quote = front();
    const bool basic = quote == '"';
    const bool several_lines = rest_.size() > 2 && rest_[1] == quote && rest_[2] == quote;
    for (std::size_t k = several_lines ? 3 : 1; k < rest_.size(); ++k) {
      if (basic && rest_[k] == '\\') {
        ++k;
      } else if (rest_[k] == '\n' && !several_lines) {
        return false;
      } else if (rest_[k] == quote) {
        if (!several_lines) {
          skip(k + 1);
          return true;
        }
        std::size_t quotes = 1;
        while (k + quotes < rest_.size() && rest_[k + quotes] == quote) ++quotes;
        if (quotes >= 3) {
          skip(k + quotes);  // one or two more belong to the string
          return true;
        }
        k += quotes - 1;
      }
    }
    return false;
  }

 private:
  std::string_view rest_;
  Position position_{.line = 1, .column = 1};
};

Diagnostic beyond(Position position, std::string_view what, int allowed) {
  return {.position = position,
          .message = fmt::format("{} deep, allowed: at most {}", what, allowed)};
}

}  // namespace

std::optional<Diagnostic> beyond_toml_limits(std::string_view text) {
  if (text.size() > kMostTomlBytes) {
    return Diagnostic{
        .position = {},
        .message = fmt::format("holds {} bytes, allowed: at most {}", text.size(), kMostTomlBytes)};
  }
  int nesting = 0;
  int dots = 0;  // since the last character that no key goes across
  for (Scanner scanner(text); !scanner.done();) {
    const char c = scanner.front();
    if (c == '#') {
      scanner.skip_comment();
      continue;
    }
    if (c == '"' || c == '\'') {
      if (!scanner.skip_string()) return std::nullopt;
      continue;
    }
    if (c == '[' || c == '{') {
      if (++nesting > kMostNesting) {
        return beyond(scanner.position(), fmt::format("lists and tables {}", nesting),
                      kMostNesting);
      }
    } else if (c == ']' || c == '}') {
      nesting = std::max(nesting - 1, 0);
    }
    if (c == '.') {
      if (++dots >= kMostKeyParts) {
        return beyond(scanner.position(), fmt::format("a key {} parts", dots + 1), kMostKeyParts);
      }
    } else if (c == '\n' || c == '=' || c == ',' || c == '[' || c == ']' || c == '{' || c == '}') {
      dots = 0;
    }
    scanner.skip(1);
  }
  return std::nullopt;
}

}  // namespace gear3k::io
