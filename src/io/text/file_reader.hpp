#pragma once
// Files read whole.

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace gear3k::io {

struct FileBytes {
  std::string bytes;
  std::string failure;  ///< why they could not be read to the end; "" where they could
};

/// Reads a file, a pipe or a device to its end.
///
/// A read that fails is a failure, never the end of the file.  What holds more than `most_bytes` is
/// not read on.
/// @param what  stands for the file in messages: "a TOML file"
FileBytes read_bytes(const std::string& path, std::string_view what, std::size_t most_bytes);

/// The same.
/// @throws InvalidInput naming the path and the failure
std::string read_text(const std::string& path, std::string_view what, std::size_t most_bytes);

/// Whether a file that a key of another one names can be opened.
/// @param of  the file that has the key, and its place there
/// @throws InvalidInput naming both files, the key and the failure
void check_named_file(const std::string& path, std::string_view key, const std::string& of);

/// What `text_of_file` has of such a file; the same where it throws.
std::string text_of_named_file(const std::function<std::string(const std::string&)>& text_of_file,
                               const std::string& path, std::string_view key,
                               const std::string& of);

}  // namespace gear3k::io
