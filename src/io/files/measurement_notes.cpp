#include "io/files/measurement_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "io/files/measurement_columns.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

using calibrate::Kind;

/// A note "# key: word".
struct Note {
  std::string_view key, word;
  int line = 0;
};

std::optional<Note> note_of(const TextLines& lines) {
  if (!lines.line().starts_with('#')) return std::nullopt;
  std::string_view rest = lines.line().substr(1);
  while (rest.ends_with(',')) rest.remove_suffix(1);  // spreadsheets fill rows up
  const auto colon = rest.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  return Note{.key = trimmed(rest.substr(0, colon)),
              .word = trimmed(rest.substr(colon + 1)),
              .line = lines.number()};
}

/// Of logs of motion, which are read by themselves.
const std::string kMotionKind = "dynamic";

/// Which of these words a note says; -1 where it is none of them.
/// @param elsewhere  a word that other files of the command say; "" for none
template <class Words>
int choice(const Note& note, const Words& words, Complaints& complaints,
           const std::string& elsewhere = "") {
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == note.word) return static_cast<int>(k);
  }
  std::vector<std::string> known(words.begin(), words.end());
  if (!elsewhere.empty()) known.push_back(elsewhere);
  const std::string near = closest_word(std::string(note.word), known);
  complaints.add(
      {.line = note.line, .column = 1},
      fmt::format("# {}: {}: allowed: {}{}", note.key, note.word, fmt::join(known, " or "),
                  near.empty() ? "" : fmt::format("; did you mean {}?", near)));
  return -1;
}

void read_kind(const Note& note, MeasurementNotes& notes, Complaints& complaints) {
  const int k = choice(note, calibrate::kKindNames, complaints, kMotionKind);
  notes.kind_stated = true;
  if (k < 0) return;
  const auto kind = static_cast<Kind>(k);
  if (notes.kind && *notes.kind != kind) {
    complaints.add({.line = note.line, .column = 1},
                   fmt::format("# kind: {}: the kind was {} before, allowed: one kind", note.word,
                               calibrate::kKindNames[static_cast<std::size_t>(*notes.kind)]));
  }
  notes.kind = kind;
}

void read_unit(const Note& note, MeasurementNotes& notes, Complaints& complaints) {
  if (note.word.empty()) {
    complaints.add({.line = note.line, .column = 1},
                   "# unit: is blank, allowed: the name of the gearbox that was measured");
  } else if (!notes.unit.empty() && notes.unit != note.word) {
    complaints.add({.line = note.line, .column = 1},
                   fmt::format("# unit: {}: the unit was {} in line {}, allowed: one gearbox in a "
                               "file",
                               note.word, notes.unit, notes.unit_line));
    return;
  }
  notes.unit = note.word;
  notes.unit_line = note.line;
}

bool are_columns_of(Kind kind, const std::vector<std::string>& names) {
  return std::ranges::all_of(columns_of(kind), [&](const MeasurementColumn& c) {
    return !c.required || std::ranges::find(names, c.name) != names.end();
  });
}

}  // namespace

MeasurementNotes read_notes(std::string_view text, Complaints& complaints) {
  constexpr std::array<std::string_view, 2> kLocked{"sun", "output"};
  constexpr std::array<std::string_view, 1> kSensor{"reference"}, kRuns{"shared"};
  MeasurementNotes notes;
  TextLines lines(text);
  while (lines.next()) {
    const std::optional<Note> note = note_of(lines);
    if (!note) continue;
    notes.keys.emplace_back(note->key);
    if (note->key == "kind") {
      read_kind(*note, notes, complaints);
    } else if (note->key == "locked") {
      notes.locked_line = note->line;
      const int k = choice(*note, kLocked, complaints);
      if (k >= 0) notes.sun_locked = k == 0;
    } else if (note->key == "sensor") {
      notes.reference_sensor = choice(*note, kSensor, complaints) == 0;
    } else if (note->key == "runs") {
      notes.runs_shared = choice(*note, kRuns, complaints) == 0;
    } else if (note->key == "unit") {
      read_unit(*note, notes, complaints);
    }
  }
  return notes;
}

void check_notes(const MeasurementNotes& notes, const std::vector<std::string>& columns,
                 Complaints& complaints) {
  if (!notes.kind) {
    if (notes.kind_stated) return;
    std::string message =
        fmt::format("the note \"# kind: ...\" is missing, allowed: {}, {} (of an ACTUATOR)",
                    fmt::join(calibrate::kKindNames, ", "), kMotionKind);
    const std::string near = closest_word("kind", notes.keys);
    if (!near.empty()) {
      message += fmt::format("; \"# {}:\" was meant?", near);
    } else {
      for (std::size_t k = 0; k < calibrate::kKindNames.size(); ++k) {
        if (!are_columns_of(static_cast<Kind>(k), columns)) continue;
        message += fmt::format("; the columns are those of {}", calibrate::kKindNames[k]);
      }
    }
    complaints.add({}, message);
    return;
  }
  if (*notes.kind == Kind::kTorqueAngle && notes.locked_line == 0) {
    complaints.add({},
                   "the note \"# locked: ...\" is missing, allowed: sun (measured at the "
                   "output) or output (measured at the sun)");
  }
  if (*notes.kind == Kind::kLostMotion && !notes.sun_locked.value_or(true)) {
    complaints.add({.line = notes.locked_line, .column = 1},
                   "# locked: output: allowed: sun (lost motion is measured at the output)");
  }
}

}  // namespace gear3k::io
