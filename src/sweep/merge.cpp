#include "sweep/merge.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <optional>

#include "io/text/diagnostics.hpp"
#include "sweep/schema.hpp"

namespace gear3k::sweep {

namespace {

/// Copies rows of a statement whose first column is an id of the source, in its place that of the
/// target.
class RowCopy {
 public:
  /// @param from  SELECT of all columns, of one id ?1
  RowCopy(const Database& source, const Database& into, const std::string& table)
      : from_(source.prepare(fmt::format("SELECT * FROM {} WHERE task = ?1", table))),
        to_(into.prepare(insert_of(from_, table))) {}

  void copy(std::int64_t from, std::int64_t to) {
    from_.with(from);
    while (from_.step()) {
      to_.with(to);
      for (int k = 1; k < from_.columns(); ++k) to_.bind(k + 1, from_.value(k));
      to_.run();
    }
    from_.reset();
  }

 private:
  static std::string insert_of(const Statement& from, const std::string& table) {
    std::string names, places;
    for (int k = 0; k < from.columns(); ++k) {
      names += fmt::format("{}{}", k == 0 ? "" : ", ", quoted(from.name(k)));
      places += fmt::format("{}?{}", k == 0 ? "" : ", ", k + 1);
    }
    return fmt::format("INSERT OR IGNORE INTO {}({}) VALUES({})", table, names, places);
  }

  Statement from_, to_;
};

/// Columns of design that a program after this one may have added.
void add_columns_of(const Database& source, Database& into) {
  Statement theirs = source.prepare("SELECT name FROM pragma_table_info('design')");
  while (theirs.step()) {
    Statement ours =
        into.prepare("SELECT count(*) FROM pragma_table_info('design') WHERE name = ?1");
    ours.with(theirs.text(0)).step();
    if (ours.integer(0) == 0) {
      into.execute(fmt::format("ALTER TABLE design ADD COLUMN {}", quoted(theirs.text(0))));
    }
  }
}

/// Ids of the target by those of the source.
using Ids = std::map<std::int64_t, std::int64_t>;

/// A run that was copied while it was planned or at work has more tasks and an end by now.
Ids copy_runs(const Database& source, Database& into) {
  Ids ids;
  const std::string columns =
      "uid, name, sweep, axes, version, git, revision, host, workers, shard, tasks, started, ended";
  Statement runs = source.prepare("SELECT id, " + columns + " FROM run ORDER BY id");
  Statement insert =
      into.prepare("INSERT INTO run(" + columns +
                   ") VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13) "
                   "ON CONFLICT(uid) DO UPDATE SET tasks = max(tasks, excluded.tasks), "
                   "ended = coalesce(excluded.ended, ended)");
  Statement find = into.prepare("SELECT id FROM run WHERE uid = ?1");
  while (runs.step()) {
    insert.reset();
    for (int k = 1; k < runs.columns(); ++k) insert.bind(k, runs.value(k));
    insert.run();
    find.with(runs.text(1)).step();
    ids[runs.integer(0)] = find.integer(0);
  }
  return ids;
}

Ids copy_keys(const Database& source, Database& into) {
  Ids ids;
  Statement keys = source.prepare("SELECT id, path FROM key ORDER BY id");
  Statement insert = into.prepare("INSERT OR IGNORE INTO key(path) VALUES(?1)");
  Statement find = into.prepare("SELECT id FROM key WHERE path = ?1");
  while (keys.step()) {
    insert.with(keys.text(1)).run();
    find.with(keys.text(1)).step();
    ids[keys.integer(0)] = find.integer(0);
  }
  return ids;
}

/// Whether both have one result.
bool is_same(const Statement& a, const Statement& b, int first) {
  for (int k = first; k < a.columns(); ++k) {
    if (a.value(k) != b.value(k)) return false;
  }
  return true;
}

}  // namespace

Merged merge(Database& into, const std::string& path) {
  const Database source = open_sweep_database(path, Database::Access::kRead);
  // While a statement stands at a row all of a connection see the file as it was then: what
  // another process adds to one table has its rows in the others.
  Statement snapshot = source.prepare("SELECT 1 FROM sqlite_master");
  snapshot.step();
  Merged merged;
  Transaction transaction(into);
  add_columns_of(source, into);
  const Ids runs = copy_runs(source, into);
  const Ids keys = copy_keys(source, into);
  Ids tasks;
  const std::string result = "status, reason, sets, merit, bound, best";
  Statement theirs = source.prepare("SELECT id, key, spec_key, revision, spec, " + result +
                                    " FROM task ORDER BY id");
  Statement ours = into.prepare("SELECT id, key, spec_key, revision, spec, " + result +
                                " FROM task WHERE key = ?1");
  constexpr int kFirstOfResult = 5;
  Statement insert =
      into.prepare("INSERT INTO task(key, spec_key, revision, spec) VALUES(?1, ?2, ?3, ?4)");
  Statement fill = into.prepare(
      "UPDATE task SET status = ?2, reason = ?3, sets = ?4, merit = ?5, bound = ?6, best = ?7 "
      "WHERE "
      "id = ?1");
  Statement unqueue = into.prepare("DELETE FROM queue WHERE task = ?1");
  RowCopy design(source, into, "design");
  RowCopy refusal(source, into, "refusal");
  RowCopy provenance(source, into, "provenance");
  while (theirs.step()) {
    const std::string key = theirs.text(1);
    std::int64_t id = 0;
    bool known = false;
    if (ours.with(key).step()) {
      id = ours.integer(0);
      known = !ours.is_null(kFirstOfResult);
      if (known && !theirs.is_null(kFirstOfResult)) {
        ++(is_same(theirs, ours, kFirstOfResult) ? merged.known : merged.differing);
      }
    } else {
      insert.with(key, theirs.value(2), theirs.value(3), theirs.value(4)).run();
      id = into.last_id();
    }
    ours.reset();
    tasks[theirs.integer(0)] = id;
    if (theirs.is_null(kFirstOfResult)) {
      ++merged.open;
      continue;
    }
    if (known) continue;
    ++merged.added;
    fill.with(id);
    for (int k = kFirstOfResult; k < theirs.columns(); ++k) {
      fill.bind(k - kFirstOfResult + 2, theirs.value(k));
    }
    fill.run();
    unqueue.with(id).run();
    design.copy(theirs.integer(0), id);
    refusal.copy(theirs.integer(0), id);
    provenance.copy(theirs.integer(0), id);
  }
  Statement values = source.prepare("SELECT task, key, value FROM task_key");
  Statement value = into.prepare("INSERT OR IGNORE INTO task_key VALUES(?1, ?2, ?3)");
  while (values.step()) {
    value.with(tasks.at(values.integer(0)), keys.at(values.integer(1)), values.value(2)).run();
  }
  Statement members = source.prepare("SELECT run, task FROM run_task");
  Statement member = into.prepare("INSERT OR IGNORE INTO run_task VALUES(?1, ?2)");
  while (members.step()) {
    member.with(runs.at(members.integer(0)), tasks.at(members.integer(1))).run();
  }
  make_result_view(into);
  transaction.commit();
  return merged;
}

Rows merge(const std::vector<std::string>& paths, const std::string& into) {
  for (const std::string& path : paths) open_sweep_database(path, Database::Access::kRead);
  std::error_code unknown;
  const bool is_new = !std::filesystem::exists(into, unknown);
  std::optional<Database> database(open_sweep_database(into, Database::Access::kCreate));
  Rows rows{.names = {"database", "added", "known", "differing", "open"}, .rows = {}};
  try {
    for (const std::string& path : paths) {
      const Merged merged = merge(*database, path);
      rows.rows.push_back({path, merged.added, merged.known, merged.differing, merged.open});
    }
  } catch (const io::InvalidInput&) {
    const bool is_empty = database->count("SELECT count(*) FROM run") == 0;
    database.reset();  // with which SQLite removes what is beside it
    if (is_new && is_empty) std::filesystem::remove(into, unknown);
    throw;
  }
  return rows;
}

}  // namespace gear3k::sweep
