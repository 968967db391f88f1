#pragma once

#include <string>

namespace gear3k::io {

/// Writes a file whole or not at all: to a temporary name in the same folder, then renamed.
/// What is no regular file (a pipe, a device) is written to as it is.
/// @throws InvalidInput naming the path and the cause when it cannot be written
void write_file(const std::string& path, const std::string& content);

/// Makes sure that a folder exists and can be written to.
/// @throws InvalidInput naming the path and the cause otherwise
void prepare_folder(const std::string& path);

}  // namespace gear3k::io
