#pragma once
// The quantities of a result, each listed once: its JSON and its rows of a CSV come from the list.

#include <string>
#include <string_view>
#include <vector>

#include "io/text/json.hpp"

namespace gear3k::report {

/// How a quantity stands in a CSV.
struct CsvRow {
  std::string quantity = {};
  std::string unit = {};
  /// The rows of a list come by their rank, those of one rank in the order of the list.
  int rank = 0;
  std::string item = {};   ///< what it is a quantity of; "" = what the list is about
  std::string limit = {};  ///< of a check; its row stands also where it has no value
  std::string ok = {};
};

/// A row of a CSV with its value.
struct FieldRow {
  std::string item, quantity, unit;
  io::Json value;  ///< never null or NaN
};

/// A part of a result: an object of the JSON, and rows "item,quantity,value,unit,limit,ok" or the
/// columns of one line of a CSV.
class Fields {
 public:
  /// @param item  what the rows are about
  explicit Fields(std::string item = {}) : item_(std::move(item)), json_(io::Json::object()) {}

  /// A quantity of the JSON alone.
  void add(std::string_view key, io::Json value) { json_[key] = std::move(value); }
  /// One of the JSON and of the CSV.
  void add(std::string_view key, io::Json value, CsvRow row);
  /// One of the CSV alone.
  void add_row(io::Json value, CsvRow row);
  /// An object within the object; its rows keep their rank.
  void add(std::string_view key, Fields part);
  /// The next value of a list in the JSON, a row of its own in the CSV.
  void append(std::string_view key, io::Json value, CsvRow row);
  /// The next object of a list; its rows keep their rank.
  void append(std::string_view key, Fields part);
  /// The members of another part, and its rows.
  void join(Fields part);
  /// A list of objects: those that to_fields makes of the items, the rows of one after those of the
  /// other, all of one rank.
  template <class Items, class ToFields>
  void add_list(std::string_view key, const Items& items, ToFields to_fields, int rank = 0) {
    add(key, io::Json::array());
    for (const auto& item : items) append(key, to_fields(item).at_rank(rank));
  }

  /// The same with its rows in their order, all of one rank.
  [[nodiscard]] Fields at_rank(int rank) &&;

  [[nodiscard]] const io::Json& json() const { return json_; }
  /// Rows by rank.  A truth value is 1 or 0; what is null or NaN has no row.
  [[nodiscard]] std::string csv_rows() const;
  /// The rows that csv_rows() writes, without those that have no value.
  [[nodiscard]] std::vector<FieldRow> rows() const;
  /// The quantities as the header of a CSV, by rank.
  [[nodiscard]] std::string csv_header() const;
  /// The values as a line below that header; "" for what is null or not finite.
  [[nodiscard]] std::string csv_values() const;

 private:
  struct Row {
    CsvRow text;
    io::Json value;
  };
  [[nodiscard]] std::vector<const Row*> by_rank() const;
  void take_rows(std::vector<Row> rows);

  std::string item_;
  io::Json json_;
  std::vector<Row> rows_;
};

/// The header of csv_rows().
inline constexpr const char* kRowsHeader = "item,quantity,value,unit,limit,ok\n";

}  // namespace gear3k::report
