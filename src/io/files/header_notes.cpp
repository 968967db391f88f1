#include "io/files/header_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "calibrate/measurement/measurement.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

/// A note that some reader takes.
struct KnownNote {
  std::string key;
  std::vector<std::string> words;   ///< that it takes; none: see `allowed`
  std::string_view allowed = {};    ///< in place of words
  bool number = false;              ///< with no words: a number, else any word
  std::vector<std::string> not_it;  ///< words of English, or columns, that are near the key
};

const std::vector<KnownNote>& known_notes() {
  static const std::vector<KnownNote> kNotes = [] {
    std::vector<std::string> kinds(calibrate::kKindNames.begin(), calibrate::kKindNames.end());
    kinds.emplace_back("dynamic");
    return std::vector<KnownNote>{{.key = "kind", .words = kinds, .not_it = {}},
                                  {.key = "locked", .words = {"sun", "output"}, .not_it = {}},
                                  {.key = "sensor", .words = {"reference"}, .not_it = {}},
                                  {.key = "runs", .words = {"shared"}, .not_it = {"run"}},
                                  {.key = "unit",
                                   .words = {},
                                   .allowed = "the name of the gearbox that was measured",
                                   .not_it = {"units", "init", "unity", "unite", "until", "knit"}},
                                  {.key = "torque", .words = {"load", "actuator"}, .not_it = {}},
                                  {.key = "load_inertia_kgm2",
                                   .words = {},
                                   .allowed = "a number, at least 0",
                                   .number = true,
                                   .not_it = {}}};
  }();
  return kNotes;
}

const KnownNote* known_note(std::string_view key) {
  const auto found = std::ranges::find(known_notes(), key, &KnownNote::key);
  return found == known_notes().end() ? nullptr : &*found;
}

std::string allowed_text(const KnownNote& note) {
  return note.words.empty() ? std::string(note.allowed)
                            : fmt::format("{}", fmt::join(note.words, " or "));
}

/// Small letters, words parted by '_'.
std::string normalised_key(std::string_view written) {
  std::string key;
  for (const char c : written) {
    if (c >= 'A' && c <= 'Z') {
      key += static_cast<char>(c - 'A' + 'a');
    } else {
      key += c == ' ' || c == '-' ? '_' : c;
    }
  }
  return key;
}

bool takes(const KnownNote& note, std::string_view word) {
  if (word.empty()) return false;
  if (note.number) {
    constexpr std::string_view kBegins = "0123456789.+-";
    return kBegins.find(word.front()) != std::string_view::npos;
  }
  return note.words.empty() || !closest_word(normalised_key(word), note.words).empty();
}

bool has_same_letters(std::string a, std::string b) {
  std::ranges::sort(a);
  std::ranges::sort(b);
  return a == b;
}

/// Letters up to which a short key may be another word: one slip there, two in longer ones.
constexpr std::size_t kShortKey = 5;
/// Letters from which nothing in English is near.
constexpr std::size_t kLongKey = 10;

/// The key that was meant; "" for none.
std::string meant_key(const std::string& written, const std::vector<std::string>& keys) {
  const auto swapped = std::ranges::find_if(
      keys, [&](const std::string& key) { return has_same_letters(written, key); });
  if (swapped != keys.end()) return *swapped;
  std::string near = closest_word(written, keys);
  if (near.empty()) return near;
  const bool is_long = near.size() >= kLongKey && written.size() >= kLongKey;
  const std::size_t slips = near.size() <= kShortKey ? 1 : 2;
  return is_long || edit_distance(written, near) <= slips ? near : "";
}

bool says_the_same(const KnownNote& known, std::string_view a, std::string_view b) {
  if (a == b) return true;
  if (!known.number) return false;
  const auto x = csv_number(a), y = csv_number(b);
  return x && y && *x == *y;
}

/// Key and word of a line without its '#', which the first of these characters parts.
std::optional<HeaderNote> parted(std::string_view rest, std::string_view signs, int number) {
  const auto at = rest.find_first_of(signs);
  if (at == std::string_view::npos) return std::nullopt;
  return HeaderNote{.key = std::string(trimmed(rest.substr(0, at))),
                    .word = std::string(trimmed(rest.substr(at + 1))),
                    .line = number};
}

/// The column that a note means by a key in other letters, or with '=' behind it; "" where it may
/// be prose.
std::string stated_column(const HeaderNote& note, const std::vector<std::string>& columns) {
  const bool as_name = note.key.find('_') != std::string::npos;
  if (!as_name && !csv_number(note.word)) return "";
  const auto column = std::ranges::find(columns, normalised_key(note.key));
  return column == columns.end() ? "" : *column;
}

/// Without '#' before it and commas behind.
std::optional<std::string_view> comment_of(std::string_view line) {
  if (!line.starts_with('#')) return std::nullopt;
  std::string_view rest = trimmed(line.substr(1));
  while (rest.ends_with(',')) rest = trimmed(rest.substr(0, rest.size() - 1));
  return rest;
}

}  // namespace

std::optional<HeaderNote> note_of(std::string_view line, int number) {
  const auto rest = comment_of(line);
  return rest ? parted(*rest, ":", number) : std::nullopt;
}

std::optional<HeaderNote> HeaderNotes::read(std::string_view line, int number,
                                            const Complain& complain) {
  const auto rest = comment_of(line);
  if (!rest) return std::nullopt;
  std::optional<HeaderNote> note = parted(*rest, ":", number);
  const KnownNote* known = note ? known_note(note->key) : nullptr;
  if (known == nullptr) {
    const std::optional<HeaderNote> likely = parted(*rest, ":=", number);
    const bool equals_sign = likely && (!note || likely->key.size() < note->key.size());
    if (likely) look_for_slip(*likely, equals_sign, complain);
    return std::nullopt;
  }
  const bool own = std::ranges::find(own_, note->key) != own_.end();
  const auto first = std::ranges::find(known_, note->key, &HeaderNote::key);
  if (own && first != known_.end()) {
    if (says_the_same(*known, first->word, note->word)) return note;
    complain(fmt::format("# {}: {} after # {}: {}: allowed: one of them", note->key, note->word,
                         first->key, first->word));
    return std::nullopt;
  }
  known_.push_back(*note);
  return own ? note : std::nullopt;
}

void HeaderNotes::look_for_slip(const HeaderNote& note, bool equals_sign,
                                const Complain& complain) {
  constexpr std::size_t kLongest = 40;  // free text is no key
  const std::string key = note.key.size() > kLongest ? "" : normalised_key(note.key);
  std::string near = meant_key(key, own_);
  const KnownNote* meant = near.empty() ? nullptr : known_note(near);
  const bool as_key = key == near;
  if (meant != nullptr && std::ranges::find(meant->not_it, key) == meant->not_it.end() &&
      (takes(*meant, note.word) || (as_key && !equals_sign))) {
    slips_.push_back(near);
    complain(fmt::format("# {}{} {}: did you mean # {}:? allowed: {}", note.key,
                         equals_sign ? " =" : ":", note.word, near, allowed_text(*meant)));
    return;
  }
  if (equals_sign) {
    unknown_.push_back({.note = note, .near = {}, .equals_sign = true});
    return;
  }
  // Two letters off, and of other words, what follows decides.
  const bool another =
      meant != nullptr && std::ranges::find(meant->not_it, key) != meant->not_it.end();
  const bool close = !near.empty() && (near.size() >= kLongKey || edit_distance(key, near) <= 1) &&
                     (!another || key + "s" == near || near + "s" == key);
  unknown_.push_back(
      {.note = note, .near = close ? std::move(near) : std::string(), .equals_sign = false});
}

bool HeaderNotes::slipped(std::string_view key) const {
  return std::ranges::find(slips_, key) != slips_.end();
}

std::string HeaderNotes::nearest_unknown(const std::string& key) const {
  std::vector<std::string> keys;
  keys.reserve(unknown_.size());
  for (const Unknown& u : unknown_) {
    if (!u.equals_sign) keys.push_back(u.note.key);
  }
  return closest_word(key, keys);
}

void HeaderNotes::refuse_others(const KindNotes& of, Complaints& complaints) const {
  for (const HeaderNote& note : known_) {
    if (std::ranges::find(of.keys, note.key) != of.keys.end()) continue;
    const KnownNote* known = known_note(note.key);
    if (known == nullptr || !takes(*known, note.word)) continue;
    complaints.add({.line = note.line, .column = 1},
                   fmt::format("# {}: {}: has no part in kind {}, allowed: # {}:", note.key,
                               note.word, of.kind, fmt::join(of.keys, ":, # ")));
  }
}

std::vector<std::string> HeaderNotes::idle(const KindNotes& of,
                                           const std::vector<std::string>& columns,
                                           const std::vector<std::string>& header) const {
  std::vector<std::string> told, texts;
  for (const HeaderNote& note : known_) {
    if (std::ranges::find(of.keys, note.key) != of.keys.end() ||
        std::ranges::find(told, note.key) != told.end()) {
      continue;
    }
    told.push_back(note.key);
    texts.push_back(fmt::format("\"# {}:\" in line {} has no part in kind {} and does not act",
                                note.key, note.line, of.kind));
  }
  for (const Unknown& u : unknown_) {
    const std::string& key = u.note.key;
    if (std::ranges::find(told, key) != told.end()) continue;
    const bool by_name = !u.equals_sign && std::ranges::find(columns, key) != columns.end();
    const std::string column = by_name ? key : stated_column(u.note, columns);
    const bool is_there = std::ranges::find(header, column) != header.end() ||
                          std::ranges::find(header, key) != header.end();
    const KnownNote* near = u.near.empty() ? nullptr : known_note(u.near);
    // What stands as a column may be described in a comment.
    const bool meant =
        near != nullptr && (!(!column.empty() || is_there) || takes(*near, u.note.word));
    std::string would;
    if (!column.empty() && !is_there) {
      would = by_name ? "a column of that name" : "a column " + column;
    }
    if (meant) would += fmt::format("{}\"# {}:\"", would.empty() ? "" : ", or ", near->key);
    if (would.empty()) continue;
    told.push_back(key);
    texts.push_back(fmt::format("\"# {}{}\" in line {} is no note and does not act; {} would", key,
                                u.equals_sign ? " =" : ":", u.note.line, would));
  }
  return texts;
}

}  // namespace gear3k::io
