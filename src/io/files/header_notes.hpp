#pragma once
// Lines "# key: word" of CSV files: the notes that their readers take, and lines that were meant to
// be such.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/text/complaints.hpp"

namespace gear3k::io {

struct HeaderNote {
  std::string key, word;
  int line = 0;
};

/// Keys of the notes that have a part in a kind of file.
struct KindNotes {
  std::string_view kind;
  std::vector<std::string> keys;
};

/// The note of a line that begins with '#', of any key, without the commas with which spreadsheets
/// fill rows up.
std::optional<HeaderNote> note_of(std::string_view line, int number);

/// The notes of one file.  Free text and unknown keys stay possible: a line is refused only where
/// its key differs from one of the reader's by case or a few letters, or has '=' in place of the
/// colon, and what follows is (nearly) a word that the note takes.
class HeaderNotes {
 public:
  using Complain = std::function<void(std::string message)>;  ///< at the line that is read

  /// @param own  keys that the reader takes: some of "kind", "locked", "sensor", "runs", "unit",
  ///             "torque", "load_inertia_kgm2"
  explicit HeaderNotes(std::vector<std::string> own) : own_(std::move(own)) {}

  /// The note of a line where it has one of the reader's keys; its word may be wrong.  Told are a
  /// slip of the pen, and a note that says something else than the one of this key before it.
  std::optional<HeaderNote> read(std::string_view line, int number, const Complain& complain);

  /// Whether a slip of this key was told.
  [[nodiscard]] bool slipped(std::string_view key) const;
  /// Unknown keys, that of the nearest to `key` in spelling; "" for none.
  [[nodiscard]] std::string nearest_unknown(const std::string& key) const;

  /// Complains of notes that are known, say what they may and have no part in this file.
  void refuse_others(const KindNotes& of, Complaints& complaints) const;

  /// Says of lines that look like a column or a note that they do not act.  With other letters, or
  /// with '=' in place of the colon, a line looks like a column where its key is written as one
  /// ("Temperature_c") or a number follows.
  /// @param columns  names that the kind knows
  /// @param header   names that are there
  [[nodiscard]] std::vector<std::string> idle(const KindNotes& of,
                                              const std::vector<std::string>& columns,
                                              const std::vector<std::string>& header) const;

 private:
  void look_for_slip(const HeaderNote& note, bool equals_sign, const Complain& complain);

  struct Unknown {
    HeaderNote note;
    std::string near;  ///< key of the reader that may be meant; "" for none
    bool equals_sign;  ///< in place of the colon
  };
  std::vector<std::string> own_, slips_;
  std::vector<HeaderNote> known_;  ///< of known keys, the reader's or not
  std::vector<Unknown> unknown_;
};

}  // namespace gear3k::io
