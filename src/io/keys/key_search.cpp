#include "io/keys/key_search.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace gear3k::io {

namespace {

bool same_letter(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

bool holds(std::string_view line, std::string_view word) {
  return std::search(line.begin(), line.end(), word.begin(), word.end(), same_letter) != line.end();
}

/// A row of a table that tells of a key: its path stands first, as code.
bool is_row_of_key(std::string_view line) { return line.starts_with("| `"); }

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

}  // namespace

std::string rows_with(std::string_view document, std::string_view word) {
  std::string found;
  std::string head;  // of a table no row of which was found yet
  for (const std::string_view line : lines_of(document)) {
    if (is_row_of_key(line)) {
      if (!holds(line, word)) continue;
      found += head;
      found += line;
      found += '\n';
      head.clear();
      continue;
    }
    if (line.starts_with("## ")) head = found.empty() ? "" : "\n";
    if (line.starts_with("#") && !line.starts_with("## ")) continue;
    if (line.starts_with("## ") || line.starts_with("|") || (line.empty() && head.size() > 1)) {
      head += line;
      head += '\n';
    }
  }
  return found;
}

std::vector<std::string> words_of_keys(std::string_view document) {
  std::set<std::string> words;
  for (const std::string_view line : lines_of(document)) {
    if (!is_row_of_key(line)) continue;
    constexpr std::size_t kBegin = 3;  // after "| `"
    std::string_view path = line.substr(kBegin);
    path = path.substr(0, path.find('`'));
    while (!path.empty()) {
      const std::size_t end = std::min(path.find('.'), path.size());
      words.emplace(path.substr(0, end));
      path.remove_prefix(std::min(end + 1, path.size()));
    }
  }
  return {words.begin(), words.end()};
}

}  // namespace gear3k::io
