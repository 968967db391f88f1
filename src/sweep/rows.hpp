#pragma once
// Results of queries, as tables, CSV and JSON.

#include <string>
#include <vector>

#include "sweep/database.hpp"

namespace gear3k::sweep {

struct Rows {
  std::vector<std::string> names;
  std::vector<std::vector<SqlValue>> rows;
};

/// All rows of a statement.
Rows rows_of(Statement& statement);

/// A value with all its digits; "" for NULL.
std::string text_of(const SqlValue& value);

/// For the terminal, numbers with six digits.  One single value stands as it is, without its name.
std::string rows_table(const Rows& rows);
/// Numbers with all digits, NULL as an empty field.
std::string rows_csv(const Rows& rows);
/// A list of objects; of several columns of one name the second is `name:1`, as SQLite names it.
std::string rows_json(const Rows& rows);

}  // namespace gear3k::sweep
