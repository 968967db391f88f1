#pragma once

#include <string>

namespace gear3k::drawing {

/// Text as XML and HTML hold it: & < > as entities, line ends as spaces; characters that XML 1.0
/// cannot hold become U+FFFD.
/// @param text  UTF-8
std::string xml_text(const std::string& text);

}  // namespace gear3k::drawing
