#pragma once
// Messages about a user's file: all of them at once, each with its place.

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace gear3k::io {

/// A place in a file; line and column count from 1, 0 = the file as a whole.
struct Position {
  int line = 0;
  int column = 0;
};

struct Diagnostic {
  Position position;
  std::string message;
};

/// "file:line:col: message" lines, sorted by place; messages printable().
std::string format_diagnostics(const std::string& file, std::vector<Diagnostic> diagnostics);

/// Thrown by readers when a file is invalid; what() is the formatted list of all diagnostics.
class InvalidInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Messages of several files, to be told together.
class CollectedErrors {
 public:
  /// Does what may throw InvalidInput, and keeps its message.
  template <class Step>
  void attempt(const Step& step) {
    try {
      step();
    } catch (const InvalidInput& error) {
      if (!text_.empty()) text_ += "\n";
      text_ += error.what();
    }
  }
  /// Adds lines.
  void add(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) text_ += (text_.empty() ? "" : "\n") + line;
  }
  [[nodiscard]] bool any() const { return !text_.empty(); }
  [[nodiscard]] const std::string& text() const { return text_; }
  /// @throws InvalidInput where there was any
  void raise() const {
    if (!text_.empty()) throw InvalidInput(text_);
  }

 private:
  std::string text_;
};

/// Letters to change, add or take away to make one word the other (Levenshtein).
std::size_t edit_distance(const std::string& a, const std::string& b);

/// The known word closest to what was written (edit distance at most 3 and at most half of the
/// word's length), else the only one that begins with it, else the only one that begins as it does
/// up to its last '_', if that is two thirds of it (another unit); "" when there is none.
std::string closest_word(const std::string& written, const std::vector<std::string>& known);

}  // namespace gear3k::io
