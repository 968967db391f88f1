#pragma once
// What every command's arguments have in common: the shape of the help, and words that are none.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/command_tree.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own name
class App;
class FormatterBase;
class ParseError;
class Validator;
}  // namespace CLI

namespace gear3k::cli {

/// Help whose descriptions end at column 100.
std::shared_ptr<CLI::FormatterBase> narrow_formatter();

/// Exit codes and what they mean, in lines of the help.
std::string exit_codes_text();

/// A message about a word that is none of the known ones.
std::string unknown(const std::string& kind, const std::string& word,
                    const std::vector<std::string>& known);

/// A check that takes the known words only.
CLI::Validator one_of(std::string kind, std::vector<std::string> known);
/// A check that a word is a number, of whole ones for integers, from `least` to `greatest`;
/// usage_error() says it as "--option = word: allowed: ...".
CLI::Validator within(std::int64_t least, std::int64_t greatest);
CLI::Validator within(int least, int greatest);
CLI::Validator within(double least, double greatest);
/// The same of any condition; `allowed` says it.
CLI::Validator number_that(std::function<bool(double)> allows, std::string allowed);

/// Adds checks to every argument of every command that names a file or folder (file_kind): its name
/// is not "", which would be read as if the option were not there, and that of an option not the
/// next option (`--out --quiet`).
void check_file_names(CLI::App& app);

/// A message about the first word that is no command, or no option of its command, or an option
/// that stands before it; "" when there is none.
std::string unknown_word(const CLI::App& app, const std::vector<std::string>& words);

/// What is wrong with the arguments that app.parse() refused: the command, every argument that is
/// missing with its meaning, or how many there may be.
std::string usage_error(CLI::App& app, const CLI::ParseError& error);

/// The commands and options that an app takes.
CommandTree described(const CLI::App& app);

}  // namespace gear3k::cli
