#pragma once
// Options that commands share.

#include <string>
#include <string_view>

#include "cli/commands.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace gear3k::cli {

/// Where the keys of a file are told.
std::string keys_of(std::string_view file);

/// What every command takes but the number of threads.
/// @param text  --format text is another word for table
void add_output_options(CLI::App& command, CommonOptions& options, bool text = false);
/// The same with the number of threads.
void add_common_options(CLI::App& command, CommonOptions& options, bool text = false);

/// A file for the result.
void add_out_file(CLI::App& command, CommonOptions& options);

}  // namespace gear3k::cli
