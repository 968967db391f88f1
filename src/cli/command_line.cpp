#include "cli/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <utility>

#include "cli/exit_code.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::cli {

namespace {

constexpr std::size_t kHelpColumns = 100;
constexpr std::size_t kCommandColumn = 14;  ///< where the text of a command begins

std::string in_lines(const std::string& text, std::size_t columns) {
  std::string lines;
  std::size_t begin = 0;
  while (text.size() - begin > columns) {
    const std::size_t end = text.rfind(' ', begin + columns);
    if (end == std::string::npos || end <= begin) break;
    lines += text.substr(begin, end - begin) + '\n';
    begin = end + 1;
  }
  return lines + text.substr(begin);
}

class NarrowFormatter : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override {
    return in_lines(option->get_description(), kHelpColumns - column_width_);
  }

  std::string make_subcommand(const CLI::App* command) const override {
    std::stringstream out;
    CLI::detail::format_help(out, command->get_display_name(true),
                             in_lines(command->get_description(), kHelpColumns - kCommandColumn),
                             kCommandColumn);
    return out.str();
  }

  /// DESIGN... for any argument that may be several, where CLI11 has its least number: DESIGN(2x).
  std::string make_option_usage(const CLI::Option* option) const override {
    const std::string name =
        make_option_name(option, true) + (option->get_expected_max() > 1 ? "..." : "");
    return option->get_required() ? name : "[" + name + "]";
  }
};

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// Words between two marks; the whole is "" without them.
std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  if (from == std::string::npos) return "";
  const std::size_t start = from + begin.size();
  const std::size_t to = text.find(end, start);
  return to == std::string::npos ? "" : text.substr(start, to - start);
}

/// What stands for the value of an option, and what its checks say of it, added to its text.
void describe_value(const CLI::Option& option, CommandArgument& argument) {
  // As CLI11 has it: TEXT, INT:INT in [1 - 1024], TEXT:{table,json,csv}.
  const std::string type = option.get_type_name();
  for (const std::string& word : CLI::detail::split(between(type, "{", "}"), ',')) {
    if (!word.empty()) argument.words.push_back(word);
  }
  argument.list = option.get_delimiter() == ',';
  argument.value = option.get_option_text();
  if (!argument.value.empty()) return;
  std::string range = between(type, " in [", "]");
  if (const std::size_t dash = range.find(" - "); dash != std::string::npos) {
    range.replace(dash, 3, " to ");
    argument.text += fmt::format(" ({})", range);
  }
  if (!type.starts_with("TEXT")) {
    argument.value = "N";
  } else {
    const FileKind kind = file_kind(argument);
    argument.value = kind == FileKind::kFolder ? "DIR" : kind == FileKind::kNone ? "TEXT" : "FILE";
  }
  if (!option.get_default_str().empty()) {
    argument.value += fmt::format(" [{}]", option.get_default_str());
  }
}

CommandTree described(const CLI::App& app, const std::string& name) {
  CommandTree tree{
      .name = name, .title = {}, .about = {}, .arguments = {}, .options = {}, .commands = {}};
  const std::string text = app.get_description();
  const std::size_t end = std::min(text.find('\n'), text.size());
  tree.title = text.substr(0, end);
  // Exit codes, the last lines of the program's own text, are told of every command.
  const std::string more = end < text.size() ? text.substr(end + 1) : "";
  tree.about = CLI::detail::trim_copy(more == exit_codes_text() ? "" : more) + "\n\n";
  tree.about = CLI::detail::trim_copy(tree.about + app.get_footer());
  for (const CLI::Option* option : app.get_options()) {
    CommandArgument argument;
    argument.text = option->get_description();
    argument.required = option->get_required();
    if (option->get_items_expected_max() > 0) describe_value(*option, argument);
    if (!option->nonpositional()) {
      argument.names = {option->get_name(true)};
      argument.repeated = option->get_items_expected_max() > 1;
      tree.arguments.push_back(std::move(argument));
      continue;
    }
    for (const std::string& letter : option->get_snames()) argument.names.push_back("-" + letter);
    for (const std::string& word : option->get_lnames()) argument.names.push_back("--" + word);
    tree.options.push_back(std::move(argument));
  }
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    tree.commands.push_back(described(*command, name + ' ' + command->get_name()));
  }
  return tree;
}

}  // namespace

std::shared_ptr<CLI::FormatterBase> narrow_formatter() {
  return std::make_shared<NarrowFormatter>();
}

std::string exit_codes_text() {
  std::string text = "Exit codes:";
  std::size_t column = text.size();
  for (const ExitMeaning& meaning : kExitMeanings) {
    const bool last = meaning.code == kExitMeanings.back().code;
    for (const std::string& word : CLI::detail::split(
             fmt::format("{} {}{}", static_cast<int>(meaning.code), meaning.text, last ? '.' : ','),
             ' ')) {
      constexpr std::size_t kColumns = 90;
      const bool fits = column + 1 + word.size() <= kColumns;
      text += (fits ? ' ' : '\n') + word;
      column = fits ? column + 1 + word.size() : word.size();
    }
  }
  return text;
}

std::string unknown(const std::string& kind, const std::string& word,
                    const std::vector<std::string>& known) {
  const std::string hint = io::closest_word(word, known);
  return fmt::format("unknown {} {}{}; allowed: {}", kind, word,
                     hint.empty() ? "" : fmt::format("; did you mean {}?", hint),
                     fmt::join(known, ", "));
}

CLI::Validator one_of(std::string kind, std::vector<std::string> known) {
  const std::string set = fmt::format("{{{}}}", fmt::join(known, ","));
  return {[kind = std::move(kind), known = std::move(known)](const std::string& word) {
            return std::ranges::find(known, word) == known.end() ? unknown(kind, word, known) : "";
          },
          set};
}

CLI::Validator within(std::int64_t least, std::int64_t greatest) {
  const std::string range = fmt::format("{} to {}", least, greatest);
  return {[=](const std::string& word) -> std::string {
            std::int64_t value = 0;
            const char* const last = word.data() + word.size();
            const auto read = std::from_chars(word.data(), last, value);
            const bool whole = read.ec == std::errc() && read.ptr == last;
            if (whole && value >= least && value <= greatest) return "";
            return fmt::format("= {}: allowed: a whole number, {}", word, range);
          },
          range};
}

CLI::Validator within(int least, int greatest) {
  return within(std::int64_t{least}, std::int64_t{greatest});
}

CLI::Validator within(double least, double greatest) {
  const std::string range = fmt::format("{:g} to {:g}", least, greatest);
  return {[=](const std::string& word) -> std::string {
            char* end = nullptr;
            const double value = std::strtod(word.c_str(), &end);
            const bool number = !word.empty() && *end == '\0';
            if (number && value >= least && value <= greatest) return "";
            return fmt::format("= {}: allowed: a number, {}", word, range);
          },
          range};
}

CLI::Validator number_that(std::function<bool(double)> allows, std::string allowed) {
  return {[allows = std::move(allows),
           allowed = std::move(allowed)](const std::string& word) -> std::string {
            const std::optional<double> value = io::csv_number(word);
            if (value && allows(*value)) return "";
            return fmt::format("= {}: allowed: {}", word, allowed);
          },
          ""};
}

void check_file_names(CLI::App& app) {
  for (CLI::Option* option : app.get_options([](const CLI::Option*) { return true; })) {
    if (option->get_items_expected_max() == 0) continue;
    CommandArgument argument;
    argument.text = option->get_description();
    const FileKind kind = file_kind(argument);
    if (kind == FileKind::kNone) continue;
    const char* what = kind == FileKind::kFolder ? "folder" : "file";
    const bool named = option->nonpositional();
    option->check([what, named](const std::string& name) -> std::string {
      if (name.empty()) return fmt::format("the name of a {}, not \"\"", what);
      if (!named || !name.starts_with("--")) return "";
      return fmt::format("without its value; ./{} is the name of a {}", name, what);
    });
  }
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    check_file_names(*command);
  }
}

namespace {

/// An option that stands before the command: where it goes, or that no command has it; "" where
/// every option there is the program's own.
std::string misplaced_option(const CLI::App& app, const std::vector<std::string>& words) {
  const std::vector<const CLI::App*> commands = app.get_subcommands(nullptr);
  const auto command_of = [&](const std::string& word) {
    return std::ranges::find(commands, word, &CLI::App::get_name);
  };
  // A value of the option may stand between; without a command the first that has it is shown.
  const auto named = std::ranges::find_if(
      words, [&](const std::string& word) { return command_of(word) != commands.end(); });
  const CLI::App* meant = named != words.end() ? *command_of(*named) : nullptr;
  std::vector<std::string> known = option_names(app);
  for (auto word = words.begin(); word != named && word->starts_with("-"); ++word) {
    const std::string name = word->substr(0, word->find('='));
    if (app.get_option_no_throw(name) != nullptr) continue;
    const auto has_it = [&](const CLI::App* command) {
      return command->get_option_no_throw(name) != nullptr;
    };
    if (meant != nullptr && has_it(meant)) {
      return fmt::format("{}: no effect before the command: allowed: after it, gear3k {} {} ...",
                         name, meant->get_name(), name);
    }
    if (meant == nullptr && std::ranges::any_of(commands, has_it)) {
      return fmt::format("{}: allowed: after a command, gear3k COMMAND {} ...", name, name);
    }
    if (meant != nullptr) {
      const std::vector<std::string> own = option_names(*meant);
      known.insert(known.end(), own.begin(), own.end());
      std::ranges::sort(known);
      known.erase(std::unique(known.begin(), known.end()), known.end());
    }
    return unknown("option", name, known);
  }
  return "";
}

}  // namespace

std::string unknown_word(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  std::size_t at = 0;
  for (; at < words.size(); ++at) {
    std::vector<std::string> names;
    const CLI::App* next = nullptr;
    for (const CLI::App* known : command->get_subcommands(nullptr)) {
      names.push_back(known->get_name());
      if (known->get_name() == words[at]) next = known;
    }
    if (next == nullptr) {
      if (command != &app) break;
      return words[at].starts_with("-") ? misplaced_option(app, words)
                                        : unknown("command", words[at], names);
    }
    command = next;
  }
  const std::vector<std::string> options = option_names(*command);
  for (; at < words.size(); ++at) {
    const std::string name = words[at].substr(0, words[at].find('='));
    if (name.starts_with("--") && name.size() > 2 &&
        std::ranges::find(options, name) == options.end()) {
      const bool has_formats = std::ranges::find(options, "--format") != options.end();
      if (has_formats && (name == "--json" || name == "--csv" || name == "--table")) {
        return fmt::format("unknown option {}; did you mean --format {}?", name, name.substr(2));
      }
      return unknown("option", name, options);
    }
  }
  return "";
}

namespace {

/// A complaint of the parser in the words of this program: "--option = value: allowed: ...".
std::string of_house(std::string complaint) {
  constexpr std::string_view kWithin = ": = ", kUnread = "Could not convert: ";
  if (complaint.starts_with(kUnread)) {
    return complaint.substr(kUnread.size()) + ": allowed: a number";
  }
  // After the name of an option, which has no blank; what follows is the user's own word.
  const auto at = complaint.find(kWithin);
  if (at != std::string::npos && at < complaint.find(' ')) complaint.erase(at, 1);
  return complaint;
}

/// What is said of words that a command does not take.
std::string too_many(const CLI::App& command, const std::string& name) {
  std::vector<std::string> taken;
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional()) continue;
    taken.push_back(option->get_name(true) + (option->get_expected_max() > 1 ? "..." : ""));
  }
  return fmt::format("{}: not expected: {}; allowed: {}", name, fmt::join(command.remaining(), " "),
                     taken.empty() ? "options alone" : fmt::format("{}", fmt::join(taken, " ")));
}

/// The complaints of all values, of which the parser tells the first: what it said, where that is
/// none of them, and theirs.
std::string with_other_values(CLI::App& command, const std::string& complaint) {
  std::vector<std::string> lines;
  for (CLI::Option* option : command.get_options([](const CLI::Option*) { return true; })) {
    if (option->count() == 0) continue;
    try {
      option->run_callback();  // checks its value where the parser has not
    } catch (const CLI::Success&) {
      continue;  // --help
    } catch (const CLI::ParseError& error) {
      lines.push_back(of_house(error.what()));
    }
  }
  if (std::ranges::find(lines, complaint) == lines.end()) lines.insert(lines.begin(), complaint);
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

}  // namespace

std::string usage_error(CLI::App& app, const CLI::ParseError& error) {
  CLI::App* command = &app;
  std::string name = "gear3k";
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    name += ' ' + command->get_name();
  }
  const bool extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  const std::string complaint = extra ? too_many(*command, name) : of_house(error.what());
  std::string missing, usage;
  // Beside another complaint, which the parser has found before.
  const std::string more =
      extra || command->remaining().empty() ? "" : too_many(*command, name) + '\n';
  for (const CLI::Option* option : command->get_options()) {
    const std::string own = option->get_name(!option->nonpositional());
    const auto given = option->count();
    const auto least = static_cast<std::size_t>(std::max(0, option->get_items_expected_min()));
    if (option->get_required()) {
      usage += option->nonpositional()
                   ? fmt::format(" {} {}", own, own == "--out" ? "OUT" : "VALUE")
                   : fmt::format(" {}{}", own, option->get_expected_max() > 1 ? "..." : "");
    }
    if (option->get_required() && given == 0) {
      const std::string& words = option->get_option_text();
      missing += fmt::format("{}: {} is missing: {}{}\n", name, own, option->get_description(),
                             words.empty() ? "" : fmt::format(" ({})", words));
    } else if (given > 0 && given < least) {
      missing += fmt::format("{}: {}: {} given, allowed: {} ({})\n", name, own, given,
                             option->get_option_text().empty() ? fmt::format("{} or more", least)
                                                               : option->get_option_text(),
                             option->get_description());
    } else if (given == 0 && complaint.starts_with(own + ": ") && complaint.ends_with(" missing")) {
      missing +=
          fmt::format("{}: {} without its value: {}\n", name, own, option->get_description());
    }
  }
  if (missing.empty()) return more + with_other_values(*command, complaint);
  return fmt::format("{}{}usage: {} [OPTIONS]{}\n", more, missing, name, usage);
}

FileKind file_kind(const CommandArgument& argument) {
  const std::string& text = argument.text;
  if (text.starts_with("folder")) return FileKind::kFolder;
  if (text.starts_with("file") || text.starts_with("database")) return FileKind::kAny;
  if (text.find(".toml") != std::string::npos) return FileKind::kToml;
  if (text.find(".csv") != std::string::npos || text.find("CSV") != std::string::npos) {
    return FileKind::kCsv;
  }
  return FileKind::kNone;
}

CommandTree described(const CLI::App& app) { return described(app, "gear3k"); }

}  // namespace gear3k::cli
