// The completion of bash: what every command's arguments and options can be, as --help tells them.

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "cli/commands.hpp"
#include "io/keys/key_search.hpp"
#include "io/text/version.hpp"

namespace gear3k::cli {

namespace {

/// What is the same for all commands.  COMP_WORDS has "=" as a word of its own.
constexpr std::string_view kWalk = R"(_gear3k() {
  local current=${COMP_WORDS[COMP_CWORD]} command="" option="" position=0 word k
  local files="" words="" list="" options=""
  for ((k = 1; k < COMP_CWORD; k++)); do
    word=${COMP_WORDS[k]}
    if [[ -n $option ]]; then
      [[ $word == "=" ]] || option=""
    elif [[ $word == -* ]]; then
      _gear3k_takes_value "$command" "$word" && option=$word
    elif ((position == 0)) && _gear3k_is_command "$command" "$word"; then
      command+=${command:+ }$word
    else
      ((position++))
    fi
  done
  [[ $current != "=" ]] || current=""
  if [[ -n $option ]]; then
    _gear3k_value "$command $option"
  elif [[ $current == -* ]]; then
    _gear3k_options "$command"
    words=$options
  else
    _gear3k_value "$command $position"
    ((position > 0)) || _gear3k_commands "$command"
  fi
  local before=""
  [[ -z $list || $current != *,* ]] || before=${current%,*},
  COMPREPLY=()
  while IFS= read -r word; do COMPREPLY+=("$before$word"); done < \
    <(compgen -W "$words $list" -- "${current#"$before"}")
  [[ -n $files ]] || return 0
  compopt -o filenames 2>/dev/null
  [[ $files == folders ]] ||
    while IFS= read -r word; do COMPREPLY+=("$word"); done < \
      <(if [[ $files == all ]]; then compgen -f -- "$current"
        else compgen -f -X "!*.$files" -- "$current"; fi)
  [[ $files == all ]] ||
    while IFS= read -r word; do COMPREPLY+=("$word"); done < <(compgen -d -- "$current")
}
complete -F _gear3k gear3k
)";

/// The name of a command after that of the program; "" for the program.
std::string below_program(const CommandTree& command) {
  const std::size_t space = command.name.find(' ');
  return space == std::string::npos ? "" : command.name.substr(space + 1);
}

std::vector<const CommandTree*> with_all_below(const CommandTree& command) {
  std::vector<const CommandTree*> all{&command};
  for (const CommandTree& below : command.commands) {
    for (const CommandTree* c : with_all_below(below)) all.push_back(c);
  }
  return all;
}

std::string last_word(const CommandTree& command) {
  return command.name.substr(command.name.rfind(' ') + 1);
}

/// What sets the value's variables; "" where nothing is known of it.
std::string value_text(const CommandArgument& argument) {
  if (!argument.words.empty()) {
    return fmt::format("{}='{}'", argument.list ? "list" : "words", fmt::join(argument.words, " "));
  }
  if (argument.value.empty()) return "";
  switch (file_kind(argument)) {
    case FileKind::kFolder:
      return "files=folders";
    case FileKind::kAny:
      return "files=all";
    case FileKind::kToml:
      return "files=toml";
    case FileKind::kCsv:
      return "files=csv";
    case FileKind::kNone:
      break;
  }
  return "";
}

std::string values_of(const CommandTree& command) {
  const std::string name = below_program(command);
  std::string text;
  for (const CommandArgument& option : command.options) {
    const std::string value = value_text(option);
    if (value.empty()) continue;
    text += fmt::format("    '{} {}') {} ;;\n", name, option.names.back(), value);
  }
  for (std::size_t k = 0; k < command.arguments.size(); ++k) {
    const std::string value = value_text(command.arguments[k]);
    if (value.empty()) continue;
    // An argument that repeats takes all positions from its own on.
    text += command.arguments[k].repeated ? fmt::format("    '{} '[{}-9]*) {} ;;\n", name, k, value)
                                          : fmt::format("    '{} {}') {} ;;\n", name, k, value);
  }
  return text;
}

CommandArgument* first_argument(CommandTree& gear3k, std::string_view command) {
  const auto found = std::ranges::find_if(
      gear3k.commands, [&](const CommandTree& c) { return last_word(c) == command; });
  return found == gear3k.commands.end() || found->arguments.empty() ? nullptr
                                                                    : found->arguments.data();
}

}  // namespace

ExitCode run_completion(const CommonOptions& options, CommandTree gear3k) {
  if (other_form(options, "completion", "a script of bash")) return kUsage;
  if (CommandArgument* word = first_argument(gear3k, "keys")) {
    word->words = io::words_of_keys(keys_document());
  }
  if (CommandArgument* page = first_argument(gear3k, "manual")) {
    page->words = manual_page_words(gear3k);
  }
  std::string takes_value, commands, names, all_options, values;
  for (const CommandTree* command : with_all_below(gear3k)) {
    const std::string name = below_program(*command);
    values += values_of(*command);
    std::vector<std::string> long_names, below;
    for (const CommandArgument& option : command->options) {
      long_names.push_back(option.names.back());
      if (option.value.empty()) continue;
      for (const std::string& n : option.names) {
        takes_value += fmt::format("{}'{} {}'", takes_value.empty() ? "" : " | ", name, n);
      }
    }
    all_options += fmt::format("    '{}') options='{}' ;;\n", name, fmt::join(long_names, " "));
    if (command->commands.empty()) continue;
    for (const CommandTree& b : command->commands) below.push_back(last_word(b));
    commands += fmt::format("    '{}') words+=' {}' ;;\n", name, fmt::join(below, " "));
    for (const std::string& b : below) {
      names += fmt::format("{}'{} {}'", names.empty() ? "" : " | ", name, b);
    }
  }
  const auto tests = [](std::string_view function, std::string_view patterns) {
    return fmt::format(
        "{}() {{\n  case \"$1 $2\" in\n    {}) return 0 ;;\n  esac\n  return 1\n}}\n", function,
        patterns);
  };
  const auto sets = [](std::string_view function, std::string_view cases) {
    return fmt::format("{}() {{\n  case \"$1\" in\n{}  esac\n}}\n", function, cases);
  };
  deliver(
      options,
      fmt::format("# Completion of gear3k {} for bash, by `gear3k completion`.\n", io::version()) +
          tests("_gear3k_takes_value", takes_value) + tests("_gear3k_is_command", names) +
          sets("_gear3k_commands", commands) + sets("_gear3k_options", all_options) +
          sets("_gear3k_value", values) + std::string(kWalk));
  return kDone;
}

}  // namespace gear3k::cli
