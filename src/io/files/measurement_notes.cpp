#include "io/files/measurement_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/files/measurement_columns.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

using calibrate::Kind;

/// Of logs of motion, which are read by themselves.
const std::string kMotionKind = "dynamic";

/// Which of these words a note says; -1 where it is none of them.
/// @param elsewhere  a word that other files of the command say; "" for none
template <class Words>
int choice(const HeaderNote& note, const Words& words, Complaints& complaints,
           const std::string& elsewhere = "") {
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == note.word) return static_cast<int>(k);
  }
  std::vector<std::string> known(words.begin(), words.end());
  if (!elsewhere.empty()) known.push_back(elsewhere);
  const std::string near = closest_word(note.word, known);
  complaints.add(
      {.line = note.line, .column = 1},
      fmt::format("# {}: {}: allowed: {}{}", note.key, note.word, fmt::join(known, " or "),
                  near.empty() ? "" : fmt::format("; did you mean {}?", near)));
  return -1;
}

void read_kind(const HeaderNote& note, MeasurementNotes& notes, Complaints& complaints) {
  notes.kind_stated = true;
  if (note.word == kMotionKind) {
    // Above the header, and without another kind before it, it makes a file a log.
    complaints.add({.line = note.line, .column = 1},
                   fmt::format("# kind: {}: allowed: above the header", note.word));
    return;
  }
  const int k = choice(note, calibrate::kKindNames, complaints, kMotionKind);
  if (k < 0) return;
  notes.kind = static_cast<Kind>(k);
}

void read_unit(const HeaderNote& note, MeasurementNotes& notes, Complaints& complaints) {
  if (note.word.empty()) {
    complaints.add({.line = note.line, .column = 1},
                   "# unit: is blank, allowed: the name of the gearbox that was measured");
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
    const auto note = notes.header.read(lines.line(), lines.number(), [&](std::string message) {
      complaints.add({.line = lines.number(), .column = 1}, std::move(message));
    });
    if (!note) continue;
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

KindNotes notes_of(Kind kind) {
  KindNotes notes{.kind = calibrate::kKindNames[static_cast<std::size_t>(kind)],
                  .keys = {"kind", "unit", "sensor", "runs"}};
  if (kind == Kind::kTorqueAngle || kind == Kind::kLostMotion) notes.keys.emplace_back("locked");
  return notes;
}

void check_notes(const MeasurementNotes& notes, const std::vector<std::string>& columns,
                 Complaints& complaints) {
  if (!notes.kind) {
    if (notes.kind_stated || notes.header.slipped("kind")) return;
    std::string message =
        fmt::format("the note \"# kind: ...\" is missing, allowed: {}, {} (of an ACTUATOR)",
                    fmt::join(calibrate::kKindNames, ", "), kMotionKind);
    const std::string near = notes.header.nearest_unknown("kind");
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
  if (*notes.kind == Kind::kTorqueAngle && notes.locked_line == 0 &&
      !notes.header.slipped("locked")) {
    complaints.add({},
                   "the note \"# locked: ...\" is missing, allowed: sun (measured at the "
                   "output) or output (measured at the sun)");
  }
  notes.header.refuse_others(notes_of(*notes.kind), complaints);
  if (*notes.kind == Kind::kLostMotion && !notes.sun_locked.value_or(true)) {
    complaints.add({.line = notes.locked_line, .column = 1},
                   "# locked: output: allowed: sun (lost motion is measured at the output)");
  }
}

}  // namespace gear3k::io
