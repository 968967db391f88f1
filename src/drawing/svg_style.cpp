#include "drawing/svg_style.hpp"

#include <fmt/format.h>

#include <array>

namespace gear3k::drawing {

std::string svg_millimetres(double value_mm) {
  std::string text = fmt::format("{:.6f}", value_mm);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

Colors colors_of(train::GearId gear) {
  static constexpr std::array<Colors, train::kGearCount> kColors{{{"#a3331f", "#f7d3c9"},
                                                                  {"#0f5a78", "#cde7f1"},
                                                                  {"#3a3a3a", "#dedede"},
                                                                  {"#22693f", "#d0ecd9"},
                                                                  {"#4b3a86", "#e0daf3"}}};
  return kColors.at(gear);
}

}  // namespace gear3k::drawing
