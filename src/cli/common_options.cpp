#include "cli/common_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

namespace gear3k::cli {

std::string keys_of(std::string_view file) {
  return fmt::format("Keys of {}: gear3k keys, or gear3k keys WORD for those that hold a word.",
                     file);
}

void add_output_options(CLI::App& command, CommonOptions& options, bool text) {
  std::vector<std::string> names(kFormatNames.begin(), kFormatNames.end());
  if (text) names.emplace_back("text");
  command
      .add_option_function<std::string>(
          "--format",
          [&options](const std::string& name) {
            if (name == "text") return;  // kTable, as without it
            options.format =
                static_cast<Format>(std::ranges::find(kFormatNames, name) - kFormatNames.begin());
          },
          text ? "what is printed: table (or text), json or csv"
               : "what is printed: table, json or csv")
      ->check(one_of("format", names))
      ->option_text("FORMAT [table]");
  command.add_flag("--quiet", options.quiet, "no progress and no talk on stderr, errors only");
}

void add_common_options(CLI::App& command, CommonOptions& options, bool text) {
  add_output_options(command, options, text);
  command
      .add_option("--threads", options.threads,
                  "OpenMP threads, 1 to 1024; all processors by default")
      ->check(within(1, 1024))
      ->option_text("N");
}

void add_out_file(CLI::App& command, CommonOptions& options) {
  command.add_option("--out", options.out, "file for the result, instead of stdout");
}

}  // namespace gear3k::cli
