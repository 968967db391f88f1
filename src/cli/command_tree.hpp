#pragma once
// The commands and options of the program as plain data, for what tells of all of them: the manual
// and the completion of shells.

#include <string>
#include <vector>

namespace gear3k::cli {

/// An option, or an argument without a name of its own.
struct CommandArgument {
  std::vector<std::string> names;  ///< with dashes, as --out; of an argument its one name, as SPEC
  std::string value;               ///< what stands for its value, as DIR or N [20]; "" of a flag
  std::string text;                ///< what it is
  bool required = false;
  bool repeated = false;           ///< of an argument: more than one may follow
  std::vector<std::string> words;  ///< what its value can be; empty: not a choice
  bool list = false;               ///< several of the words, by commas
};

struct CommandTree {
  std::string name;   ///< with those of the commands above it: "gear3k", "gear3k optimize"
  std::string title;  ///< one line
  std::string about;  ///< paragraphs
  std::vector<CommandArgument> arguments, options;
  std::vector<CommandTree> commands;
};

/// What file an argument's value is, by its text: "folder ...", "file ..." and "database ..." begin
/// so, others name NAME.toml, NAME.csv or "CSV files".
enum class FileKind { kNone, kFolder, kAny, kToml, kCsv };
FileKind file_kind(const CommandArgument& argument);

}  // namespace gear3k::cli
