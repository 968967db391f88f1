#pragma once
// The command line of `sweep`.

#include <functional>

#include "cli/commands.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace gear3k::cli {

/// What its commands read their options into.
struct SweepCommands {
  SweepOptions sweep;
  SweepMergeOptions merge;
  SweepQuestion question;
};

/// Gives `sweep` its options and subcommands, which set `run`.  All must outlive the parsing.
void add_sweep_commands(CLI::App& sweep, SweepCommands& commands, std::function<ExitCode()>& run);

/// The same of `atlas`.
void add_atlas_options(CLI::App& command, AtlasOptions& options, std::function<ExitCode()>& run);

}  // namespace gear3k::cli
