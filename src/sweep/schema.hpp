#pragma once
// The tables of a sweep's database; docs/sweep.md is their contract.

#include <string>
#include <vector>

#include "sweep/database.hpp"

namespace gear3k::sweep {

/// PRAGMA user_version: raised when a program of before could not use the tables.  Columns that
/// refined.csv gets besides are added without it.
inline constexpr int kSchema = 1;
/// PRAGMA application_id: "g3ks".
inline constexpr int kApplicationId = 0x67336B73;

/// Opens a sweep's database, making its tables where the file is new and allowed to be.
/// @throws io::InvalidInput as Database; for a file of another program, of a newer schema, on a
///   network file system
Database open_sweep_database(const std::string& path, Database::Access access);

/// Columns of table design: those of refined.csv with all their options.
std::vector<std::string> design_columns();

/// Names in quotes, as SQL wants those with a dot.
std::string quoted(const std::string& name);

/// The value of a key of task t.  Databases of before have 1 and 0, as integers, for the switches
/// of keys that also take numbers, which are real: they read as 'true' and 'false', too.
/// @param id  of the key in this database
std::string key_value_sql(const std::string& path, std::int64_t id);
/// That of a row of task_key.
SqlValue key_value(const std::string& path, SqlValue stored);

/// Makes the view `result` anew, with a column for every key that any task states.
void make_result_view(Database& database);

}  // namespace gear3k::sweep
