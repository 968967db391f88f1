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

std::string svg_text_place(double x_mm, double y_mm, double size_mm, bool up) {
  constexpr double kReadable_mm = 1.0;
  constexpr double kUnits = 10.0;
  const std::string x = svg_millimetres(x_mm);
  const std::string y = svg_millimetres(y_mm);
  if (size_mm < kReadable_mm) {
    return fmt::format(R"-(transform="translate({} {}){} scale({:.6g})" font-size="{:g}")-", x, y,
                       up ? " rotate(-90)" : "", size_mm / kUnits, kUnits);
  }
  const std::string turned = up ? fmt::format(R"-( transform="rotate(-90 {} {})")-", x, y) : "";
  return fmt::format(R"(x="{}" y="{}" font-size="{}"{})", x, y, svg_millimetres(size_mm), turned);
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
