#pragma once

#include <string>

namespace gear3k::io {

/// Bytes that the linker made of the content of the running program (ELF note NT_GNU_BUILD_ID);
/// empty where it has made none.
std::string build_id();

}  // namespace gear3k::io
