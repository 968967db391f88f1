#pragma once

#include <array>
#include <charconv>
#include <string>

namespace gear3k::rig {

/// A number with so many significant digits; the fewest that read back the same with 0.
inline std::string number_text(double value, int digits = 0) {
  std::array<char, 40> text{};
  char* const end = text.data() + text.size();
  const auto result =
      digits > 0 ? std::to_chars(text.data(), end, value, std::chars_format::general, digits)
                 : std::to_chars(text.data(), end, value);
  return {text.data(), result.ptr};
}

}  // namespace gear3k::rig
