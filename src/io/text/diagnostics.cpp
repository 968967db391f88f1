#include "io/text/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "io/text/printable.hpp"

namespace gear3k::io {

std::string format_diagnostics(const std::string& file, std::vector<Diagnostic> diagnostics) {
  std::stable_sort(diagnostics.begin(), diagnostics.end(),
                   [](const Diagnostic& a, const Diagnostic& b) {
                     return std::tie(a.position.line, a.position.column) <
                            std::tie(b.position.line, b.position.column);
                   });
  std::string text;
  for (const Diagnostic& d : diagnostics) {
    if (!text.empty()) text += '\n';
    const std::string message = printable(d.message);
    if (d.position.line > 0) {
      text += fmt::format("{}:{}:{}: {}", file, d.position.line, d.position.column, message);
    } else {
      text += fmt::format("{}: {}", file, message);
    }
  }
  return text;
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

namespace {

/// The only word that begins so; "" where there is none or several.
std::string only_beginning(const std::string& beginning, const std::vector<std::string>& known) {
  std::string found;
  for (const std::string& word : known) {
    if (!word.starts_with(beginning)) continue;
    if (!found.empty()) return "";
    found = word;
  }
  return found;
}

}  // namespace

std::string closest_word(const std::string& written, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::min<std::size_t>(3, written.size() / 2) + 1;
  for (const std::string& word : known) {
    // A letter more or less is an edit each.
    if (std::max(word.size(), written.size()) - std::min(word.size(), written.size()) >= least) {
      continue;
    }
    const std::size_t distance = edit_distance(written, word);
    if (distance < least) {
      least = distance;
      best = word;
    }
  }
  constexpr std::size_t kFewestLetters = 3;
  if (!best.empty() || written.size() < kFewestLetters) return best;
  // A word that was not written to its end.
  if (std::string whole = only_beginning(written, known); !whole.empty()) return whole;
  // One with another last word, as of another unit.
  const std::size_t kept = written.rfind('_') + 1;
  return 3 * kept >= 2 * written.size() ? only_beginning(written.substr(0, kept), known) : "";
}

}  // namespace gear3k::io
