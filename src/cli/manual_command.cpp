// The pages of the manual: one for each command, as --help has it, and one of the keys.

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/exit_code.hpp"
#include "cli/talk.hpp"
#include "io/text/file_set.hpp"
#include "io/text/version.hpp"

namespace gear3k::cli {

namespace {

constexpr std::string_view kKeysPage = "gear3k";  ///< in section 5

/// Text as roff takes it: no letter of it is an instruction, minus signs can be copied.
std::string roff(std::string_view text) {
  std::string result;
  bool begins = true;
  for (const char letter : text) {
    if (begins && (letter == '.' || letter == '\'')) result += "\\&";
    begins = letter == '\n';
    switch (letter) {
      case '\\':
        result += "\\e";
        break;
      case '-':
        result += "\\-";
        break;
      case '\'':
        result += "\\(aq";
        break;
      case '`':
        result += "\\(ga";
        break;
      case '^':
        result += "\\(ha";
        break;
      case '~':
        result += "\\(ti";
        break;
      default:
        result += letter;
    }
  }
  return result;
}

std::string page_name(const CommandTree& command) {
  std::string name = command.name;
  std::ranges::replace(name, ' ', '-');
  return name;
}

/// What stands above every page; no date, so that the same program prints the same.
std::string page_head(std::string_view name, int section, std::string_view title) {
  std::string capitals(name);
  std::ranges::transform(capitals, capitals.begin(), [](char letter) {
    return letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
  });
  return fmt::format(".TH {} {} \"\" \"gear3k {}\" \"gear3k\"\n.SH NAME\n{} \\- {}\n",
                     roff(capitals), section, io::version(), roff(name), roff(title));
}

/// Paragraphs: ends of lines within them are none.
std::string paragraphs(std::string_view text) {
  std::string result;
  bool open = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    if (line.empty()) {
      open = false;
      continue;
    }
    if (!open && !result.empty()) result += ".PP\n";
    open = true;
    result += roff(line) + '\n';
  }
  return result;
}

std::string synopsis(const CommandTree& command) {
  std::string text = fmt::format(".SH SYNOPSIS\n\\fB{}\\fR", roff(command.name));
  if (!command.commands.empty()) {
    text += command.arguments.empty() ? " \\fICOMMAND\\fR" : " [\\fICOMMAND\\fR]";
  }
  for (const CommandArgument& argument : command.arguments) {
    const std::string name =
        fmt::format("\\fI{}\\fR{}", roff(argument.names[0]), argument.repeated ? "..." : "");
    text += argument.required ? ' ' + name : fmt::format(" [{}]", name);
  }
  for (const CommandArgument& option : command.options) {
    if (!option.required) continue;
    text += fmt::format(" \\fB{}\\fR \\fI{}\\fR", roff(option.names.back()), roff(option.value));
  }
  return text + " [\\fIOPTION\\fR]...\n";
}

std::string words_text(const CommandArgument& argument) {
  // Many texts tell them already.
  const bool told = std::ranges::all_of(argument.words, [&](const std::string& word) {
    return (argument.text + argument.value).find(word) != std::string::npos;
  });
  return told ? "" : fmt::format(" ({})", fmt::join(argument.words, ", "));
}

std::string arguments_section(const CommandTree& command) {
  if (command.arguments.empty()) return "";
  std::string text = ".SH ARGUMENTS\n";
  for (const CommandArgument& argument : command.arguments) {
    text += fmt::format(".TP\n\\fI{}\\fR\n{}\n", roff(argument.names[0]),
                        roff(argument.text + words_text(argument)));
  }
  return text;
}

std::string options_section(const CommandTree& command) {
  std::string text = ".SH OPTIONS\n";
  for (const CommandArgument& option : command.options) {
    text += ".TP\n";
    for (std::size_t k = 0; k < option.names.size(); ++k) {
      text += fmt::format("{}\\fB{}\\fR", k == 0 ? "" : ", ", roff(option.names[k]));
    }
    if (!option.value.empty()) text += fmt::format(" \\fI{}\\fR", roff(option.value));
    text += fmt::format("\n{}{}\n", roff(option.text + words_text(option)),
                        option.required ? " (required)" : "");
  }
  return text;
}

std::string commands_section(const CommandTree& command) {
  if (command.commands.empty()) return "";
  std::string text = ".SH COMMANDS\n";
  for (const CommandTree& below : command.commands) {
    text += fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", roff(page_name(below)), roff(below.title));
  }
  return text;
}

std::string exit_section() {
  std::string text = ".SH EXIT STATUS\n";
  for (const ExitMeaning& meaning : kExitMeanings) {
    text += fmt::format(".TP\n{}\n{}\n", static_cast<int>(meaning.code), roff(meaning.text));
  }
  return text;
}

struct ManualPage {
  std::string name;
  int section = 1;
  std::string text{};
};

/// The page of a command and those of the commands below it.
/// @param above  the command that it belongs to; nullptr for the program
void add_pages(const CommandTree& command, const CommandTree* above,
               std::vector<ManualPage>& pages) {
  const std::string name = page_name(command);
  std::string title = command.title;
  if (title.starts_with(command.name + ' ')) title.erase(0, command.name.size() + 1);
  if (title.ends_with('.')) title.pop_back();
  std::string text = page_head(name, 1, title) + synopsis(command);
  if (!command.about.empty()) text += ".SH DESCRIPTION\n" + paragraphs(command.about);
  text += arguments_section(command) + commands_section(command) + options_section(command) +
          exit_section();
  text += ".SH SEE ALSO\n";
  if (above != nullptr) text += fmt::format("\\fB{}\\fR(1),\n", roff(page_name(*above)));
  text += fmt::format("\\fB{}\\fR(5)\n", roff(kKeysPage));
  pages.push_back({.name = name, .text = std::move(text)});
  for (const CommandTree& below : command.commands) add_pages(below, &command, pages);
}

/// Cells of a row of a Markdown table.
std::vector<std::string> cells(std::string_view row) {
  constexpr std::string_view kBegin = "| ", kEnd = " |", kBetween = " | ";
  row.remove_prefix(kBegin.size());
  row.remove_suffix(kEnd.size());
  std::vector<std::string> result;
  while (true) {
    const std::size_t end = std::min(row.find(kBetween), row.size());
    std::string cell(row.substr(0, end));
    for (std::size_t at = 0; (at = cell.find("\\|", at)) != std::string::npos; ++at) {
      cell.erase(at, 1);
    }
    std::erase(cell, '`');
    result.push_back(std::move(cell));
    if (end == row.size()) return result;
    row.remove_prefix(end + kBetween.size());
  }
}

/// The keys of all files, from what `gear3k keys` prints.
ManualPage keys_page() {
  const std::string document = keys_document();
  std::string text = page_head(kKeysPage, 5, "keys of the input files of gear3k");
  std::string_view left = document;
  while (!left.empty()) {
    const std::size_t end = std::min(left.find('\n'), left.size());
    const std::string_view line = left.substr(0, end);
    left.remove_prefix(std::min(end + 1, left.size()));
    constexpr std::string_view kHeading = "## ", kRow = "| `";
    if (line.starts_with(kHeading)) {
      text += fmt::format(".SH {}\n", roff(line.substr(kHeading.size())));
    } else if (line.starts_with(kRow)) {
      const std::vector<std::string> row = cells(line);
      const auto cell = [&](std::size_t k) { return k < row.size() ? roff(row[k]) : ""; };
      text += fmt::format(".TP\n\\fB{}\\fR = {}\n{}.\nDefault: {}.\n", cell(0), cell(1), cell(3),
                          row.size() > 2 && row[2].empty() ? "none" : cell(2));
    }
  }
  text += ".SH SEE ALSO\n\\fBgear3k\\fR(1),\n\\fBgear3k\\-keys\\fR(1)\n";
  return {.name = std::string(kKeysPage), .section = 5, .text = std::move(text)};
}

std::vector<ManualPage> manual_pages(const CommandTree& gear3k) {
  std::vector<ManualPage> pages;
  add_pages(gear3k, nullptr, pages);
  pages.push_back(keys_page());
  return pages;
}

/// NAME.SECTION of a page.
std::string file_of(const ManualPage& page) {
  return fmt::format("{}.{}", page.name, page.section);
}

}  // namespace

std::vector<std::string> manual_page_words(const CommandTree& gear3k) {
  constexpr std::string_view kProgram = "gear3k-";
  std::vector<std::string> words;
  for (const ManualPage& page : manual_pages(gear3k)) {
    const bool of_command = page.name.starts_with(kProgram);
    words.push_back(of_command ? page.name.substr(kProgram.size()) : file_of(page));
  }
  return words;
}

ExitCode run_manual(const ManualOptions& options, const CommandTree& gear3k) {
  if (other_form(options, "manual", "roff")) return kUsage;
  if (!options.out.empty() && !options.page.empty()) {
    say("manual: allowed: PAGE, or --out DIR for all pages\n");
    return kUsage;
  }
  const std::vector<ManualPage> pages = manual_pages(gear3k);
  if (!options.out.empty()) {
    std::vector<io::FileText> files;
    files.reserve(pages.size());
    for (const ManualPage& page : pages) {
      files.push_back(
          {fmt::format("{}/man{}/{}", options.out, page.section, file_of(page)), page.text});
    }
    io::write_files(files, {});
    return kDone;
  }
  const std::string wanted = options.page.empty() ? "gear3k" : options.page;
  const auto page = std::ranges::find_if(pages, [&](const ManualPage& p) {
    return wanted == p.name || "gear3k-" + wanted == p.name || wanted == file_of(p);
  });
  if (page == pages.end()) {
    say(unknown("page", wanted, manual_page_words(gear3k)) + '\n');
    return kUsage;
  }
  print_result(page->text);
  return kDone;
}

}  // namespace gear3k::cli
