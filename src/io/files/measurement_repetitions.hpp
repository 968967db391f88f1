#pragma once
// Rows of measurements that stand twice, in one file or in several.

#include <cstdint>
#include <string_view>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "io/text/csv_table.hpp"

namespace gear3k::io {

/// The rows of one file as written, to find those that are the same in every column.
class RowTexts {
 public:
  /// @param is_label  by column: compared as a text; others as numbers, 1.0 and 1.00 are the same
  explicit RowTexts(std::vector<char> is_label) : is_label_(std::move(is_label)) {}

  /// @param line    must stay until the rows are compared
  /// @param fields  of the line
  void add(std::string_view line, const CsvFields& fields);

  /// Marks rows that are the same as one before.
  [[nodiscard]] std::vector<char> repetitions() const;

 private:
  [[nodiscard]] bool same(std::size_t a, std::size_t b) const;

  std::vector<char> is_label_;
  std::vector<std::string_view> lines_;
  std::vector<std::uint64_t> hash_;  ///< equal where rows are
};

/// Leaves out the rows of one file that are copies of a row before, and notes them.
///
/// A row that is the same in every column may as well be measured again by a coarse sensor: it is a
/// copy only where a column tells rows apart that repeat each other, and states a value.  That is
/// time_s; or an angle, a count of cycles or a column that the kind does not name, where at least
/// nine in ten of the rows that differ have a value of their own in it; or the response, if it is
/// read to more than 10,000 steps.  Others are kept as repeats and counted in a note.
/// @param repetition  RowTexts::repetitions()
void leave_out_copies(calibrate::MeasurementSet& set, const std::vector<char>& repetition);

/// Marks rows with their time that stand in an earlier file too, all columns equal but the run,
/// which may be named anew.
std::vector<char> copies_of_earlier_files(const calibrate::MeasurementSet& set);

/// Leaves marked rows out, if any, and notes why: "a.csv: line 4: row left out, REASON".
void leave_out_noted(calibrate::MeasurementSet& set, const std::vector<char>& marked,
                     std::string_view reason);

}  // namespace gear3k::io
