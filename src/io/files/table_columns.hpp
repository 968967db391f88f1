#pragma once
// What tables over time have in common: their header, their numbers, the sign of their torque.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/header_notes.hpp"
#include "io/text/csv_table.hpp"

namespace gear3k::io {

/// Takes an error at a column of the line that is read.
using ColumnComplaint = std::function<void(int column, std::string message)>;

/// Greatest magnitude of a number in a table over time, in its unit.
inline constexpr double kGreatestInTable = 1e9;

/// Where the columns of a table stand.
class TableColumns {
 public:
  /// @param choices  one column of each is needed, and no more; other columns are not read
  explicit TableColumns(std::vector<std::vector<std::string>> choices);

  /// Reads the header.  Told are a column that is missing, with the one that may be meant, one that
  /// stands twice, and two of a choice.
  void read(const CsvFields& header, const ColumnComplaint& complain);

  /// Fields of the header; 0 before it.
  [[nodiscard]] std::size_t width() const { return width_; }
  /// The column of a choice, the first of two; empty where there is none.
  [[nodiscard]] std::optional<std::size_t> place(std::size_t choice) const;
  /// Its name.
  [[nodiscard]] const std::string& name(std::size_t choice) const;
  /// The number of a row under it; NaN where there is no such column, or no number from
  /// -kGreatestInTable to kGreatestInTable, which is told of every column of the choice.
  [[nodiscard]] double number(const CsvFields& row, std::size_t choice,
                              const ColumnComplaint& complain) const;
  /// All names: "time_s, torque_nm, and speed_rad_s or angle_rad".
  [[nodiscard]] std::string names() const;

 private:
  struct Column {
    std::string name;
    std::optional<std::size_t> place{};
  };
  void complain_missing(std::size_t choice, const std::vector<std::string>& unknown,
                        const ColumnComplaint& complain) const;
  [[nodiscard]] const Column& taken(std::size_t choice) const;

  std::vector<std::vector<Column>> choices_;
  std::size_t width_ = 0;
};

/// Whose torque a table holds, by its note `# torque: load` (that of the load on the output, which
/// holds without a note too) or `# torque: actuator` (that of the actuator on the load).
class TorqueNote {
 public:
  /// @param line  begins with '#'; other notes are not read
  void read(std::string_view line, const ColumnComplaint& complain);
  /// Whether the torques of the table, all of them, have the other sign.
  [[nodiscard]] bool turned() const { return whose_ == "actuator"; }

 private:
  HeaderNotes notes_{{"torque"}};
  std::string whose_;
};

}  // namespace gear3k::io
