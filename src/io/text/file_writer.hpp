#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace gear3k::io {

/// Writes a file whole or not at all (NewFile), on the disk when it returns; signals that would end
/// the program wait so long (HeldSignals).
/// What is no regular file (a pipe, a device) is written to as it is.
/// @throws InvalidInput naming the path and the cause when it cannot be written
void write_file(const std::string& path, const std::string& content);

/// The same for a text that is made piece by piece.
/// @param produce  called once with the function that takes the pieces
void write_file_in_pieces(
    const std::string& path,
    const std::function<void(const std::function<void(std::string_view)>&)>& produce);

/// What can be told before a result is computed: whether a file can have a path.
/// @throws InvalidInput as write_file()
void expect_file(const std::string& path);

/// Makes sure that a folder exists and can be written to.
/// @throws InvalidInput naming the path and the cause otherwise
void prepare_folder(const std::string& path);

/// What of prepare_folder() can be told without making anything: before a result is computed.
/// @throws InvalidInput as prepare_folder()
void expect_folder(const std::string& path);

}  // namespace gear3k::io
