#include "sweep/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "io/text/diagnostics.hpp"
#include "report/search_report.hpp"
#include "sweep/file_system.hpp"
#include "sweep/task.hpp"

namespace gear3k::sweep {

namespace {

constexpr const char* kTables = R"(
CREATE TABLE run(
  id INTEGER PRIMARY KEY,
  uid TEXT NOT NULL UNIQUE,
  name TEXT NOT NULL,
  sweep TEXT NOT NULL,
  axes TEXT NOT NULL,
  version TEXT NOT NULL,
  git TEXT NOT NULL,
  revision INTEGER NOT NULL,
  host TEXT NOT NULL,
  workers INTEGER NOT NULL,
  shard TEXT NOT NULL,
  tasks INTEGER NOT NULL,
  started REAL NOT NULL,
  ended REAL);
CREATE TABLE task(
  id INTEGER PRIMARY KEY,
  key TEXT NOT NULL UNIQUE,
  spec_key TEXT NOT NULL,
  revision INTEGER NOT NULL,
  spec TEXT NOT NULL,
  status TEXT,
  reason TEXT,
  sets INTEGER,
  merit REAL,
  bound REAL,
  best TEXT);
CREATE INDEX task_by_spec ON task(spec_key, revision);
CREATE TABLE run_task(run INTEGER NOT NULL, task INTEGER NOT NULL, PRIMARY KEY(run, task)) WITHOUT ROWID;
CREATE TABLE key(id INTEGER PRIMARY KEY, path TEXT NOT NULL UNIQUE);
CREATE TABLE task_key(task INTEGER NOT NULL, key INTEGER NOT NULL, value, PRIMARY KEY(task, key)) WITHOUT ROWID;
CREATE TABLE refusal(task INTEGER NOT NULL, status TEXT NOT NULL, reason TEXT NOT NULL, sets INTEGER NOT NULL,
  PRIMARY KEY(task, status, reason)) WITHOUT ROWID;
CREATE TABLE provenance(task INTEGER PRIMARY KEY, run TEXT NOT NULL, host TEXT NOT NULL, finished REAL NOT NULL,
  cpu_s REAL NOT NULL);
CREATE TABLE queue(task INTEGER PRIMARY KEY, host TEXT NOT NULL DEFAULT '', process INTEGER NOT NULL DEFAULT 0,
  began INTEGER NOT NULL DEFAULT 0, until REAL NOT NULL DEFAULT 0, crashes INTEGER NOT NULL DEFAULT 0,
  kills INTEGER NOT NULL DEFAULT 0);
)";

/// Columns that a database of an earlier version does not have.
void add_missing_columns(Database& database) {
  std::vector<std::string> present;
  Statement info = database.prepare("SELECT name FROM pragma_table_info('design')");
  while (info.step()) present.push_back(info.text(0));
  for (const std::string& column : design_columns()) {
    if (std::ranges::find(present, column) != present.end()) continue;
    database.execute(fmt::format("ALTER TABLE design ADD COLUMN {}", quoted(column)));
  }
  if (database.count("SELECT count(*) FROM pragma_table_info('queue') WHERE name = 'kills'") == 0) {
    database.execute("ALTER TABLE queue ADD COLUMN kills INTEGER NOT NULL DEFAULT 0");
  }
}

void make_tables(Database& database) {
  Transaction transaction(database);
  // Another process may have made them meanwhile.
  if (database.count("PRAGMA user_version") == 0) {
    database.execute(kTables);
    std::string columns;
    for (const std::string& column : design_columns()) columns += ", " + quoted(column);
    database.execute(
        fmt::format("CREATE TABLE design(task INTEGER NOT NULL, rank INTEGER NOT NULL{}, "
                    "PRIMARY KEY(task, rank)) WITHOUT ROWID",
                    columns));
    make_result_view(database);
    database.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                 kApplicationId, kSchema));
  }
  transaction.commit();
}

void check_schema(const Database& database) {
  const std::int64_t application = database.count("PRAGMA application_id");
  const std::int64_t schema = database.count("PRAGMA user_version");
  if (application != kApplicationId) {
    throw io::InvalidInput(fmt::format(
        "{}: is a database of another program; nothing was changed: allowed: a file that gear3k "
        "sweep made, or a new name",
        database.path()));
  }
  if (schema > kSchema) {
    throw io::InvalidInput(fmt::format(
        "{}: its tables are of schema {}, of a newer gear3k; nothing was changed: allowed: schema "
        "{}, or the newer program",
        database.path(), schema, kSchema));
  }
}

}  // namespace

std::vector<std::string> design_columns() {
  std::vector<std::string> columns = report::refined_column_names({.model = true,
                                                                   .tips = true,
                                                                   .pressure_angle = true,
                                                                   .masses = true,
                                                                   .strength = true,
                                                                   .cutters = true});
  columns.insert(columns.end(), report::kCoDesignColumns.begin(), report::kCoDesignColumns.end());
  return columns;
}

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + "\"";
}

std::string key_value_sql(const std::string& path, std::int64_t id) {
  return fmt::format("(SELECT {} FROM task_key k WHERE k.task = t.id AND k.key = {})",
                     is_number_or_switch(path)
                         ? "CASE typeof(value) WHEN 'integer' THEN CASE value WHEN 0 THEN 'false' "
                           "ELSE 'true' END ELSE value END"
                         : "value",
                     id);
}

SqlValue key_value(const std::string& path, SqlValue stored) {
  const auto* const integer = std::get_if<std::int64_t>(&stored);
  if (integer == nullptr || !is_number_or_switch(path)) return stored;
  return *integer == 0 ? "false" : "true";
}

void make_result_view(Database& database) {
  const std::vector<std::string> of_design = design_columns();
  std::string keys;
  // The status of a task is its own; that of its best design is always optimal.
  std::set<std::string> named{"status", "reason"};
  Statement paths = database.prepare("SELECT id, path FROM key ORDER BY path");
  while (paths.step()) {
    const std::string path = paths.text(1);
    const std::string value = key_value_sql(path, paths.integer(0));
    // A key that is a column too, as planets: what the task does not state its design tells.
    const bool both = std::ranges::find(of_design, path) != of_design.end();
    keys += fmt::format(", {} AS {}",
                        both ? fmt::format("coalesce({}, d.{})", value, quoted(path)) : value,
                        quoted(path));
    named.insert(path);
  }
  std::string columns;
  for (const std::string& column : of_design) {
    if (named.insert(column).second) columns += ", d." + quoted(column);
  }
  database.execute(fmt::format(
      "DROP VIEW IF EXISTS result; CREATE VIEW result AS SELECT t.key, t.spec_key, t.revision, "
      "t.status, t.reason, t.sets, t.merit, t.bound{}{} FROM task t LEFT JOIN design d ON d.task = "
      "t.id AND d.rank = 1 WHERE t.status IS NOT NULL",
      keys, columns));
}

Database open_sweep_database(const std::string& path, Database::Access access) {
  refuse_network(path);
  std::error_code none;
  if (access != Database::Access::kCreate && !std::filesystem::exists(path, none)) {
    throw io::InvalidInput(fmt::format(
        "{}: is not there: allowed: a file that gear3k sweep SWEEP.toml --out made", path));
  }
  if (std::filesystem::is_directory(path, none)) {
    throw io::InvalidInput(
        fmt::format("{}: is a folder: allowed: a database of a sweep{}", path,
                    access == Database::Access::kCreate ? ", or a new name" : ""));
  }
  Database database(path, access);
  // Reads the file's first page: what is no database ends here, unchanged.
  const bool empty = database.count("PRAGMA schema_version") == 0;
  if (empty && access == Database::Access::kCreate) {
    database.execute("PRAGMA journal_mode = WAL");
    make_tables(database);
  }
  if (empty && access != Database::Access::kCreate) {
    throw io::InvalidInput(
        fmt::format("{}: is empty: allowed: a file that gear3k sweep made", path));
  }
  check_schema(database);
  if (access != Database::Access::kRead) {
    // A commit is in the log when it returns; what the power takes are the last ones, whole.
    database.execute("PRAGMA synchronous = NORMAL");
    add_missing_columns(database);
  }
  return database;
}

}  // namespace gear3k::sweep
