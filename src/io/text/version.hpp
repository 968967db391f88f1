#pragma once

#include <string_view>

namespace gear3k::io {

std::string_view version();     ///< of the tool, e.g. "0.3.0"
std::string_view git_commit();  ///< that it was built from; "unknown" outside a checkout

}  // namespace gear3k::io
