#include "drawing/xml_text.hpp"

namespace gear3k::drawing {

std::string xml_text(const std::string& text) {
  std::string result;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '\n' || c == '\t' || c == '\r') {
      result += ' ';
    } else if (static_cast<unsigned char>(c) < 0x20) {
      result += "\xEF\xBF\xBD";
    } else if (text.compare(k, 3, "\xEF\xBF\xBE") == 0 || text.compare(k, 3, "\xEF\xBF\xBF") == 0) {
      result += "\xEF\xBF\xBD";
      k += 2;
    } else {
      result += c;
    }
  }
  return result;
}

}  // namespace gear3k::drawing
