#include "sweep/store.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "io/text/diagnostics.hpp"
#include "io/text/toml_text.hpp"
#include "io/text/version.hpp"
#include "sweep/model_revision.hpp"

namespace gear3k::sweep {

namespace {

/// A value of a key as a column holds it: numbers and texts as they are, the rest as TOML.
SqlValue sql_value(const io::TomlValue& value) {
  using Kind = io::TomlValue::Kind;
  switch (value.kind) {
    case Kind::kBoolean:
      return static_cast<std::int64_t>(value.boolean ? 1 : 0);
    case Kind::kInteger:
      return value.integer;
    case Kind::kNumber:
      return value.number;
    case Kind::kText:
      return value.text;
    default:
      // A list of one is its value: planets = 3.
      if (value.kind == Kind::kList && value.list.size() == 1) return sql_value(value.list.front());
      return io::toml_text(value);
  }
}

SqlValue sql_value(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? SqlValue(*value) : SqlValue(nullptr);
}

/// Of a field of a result: never null, no list and no object.
SqlValue sql_value(const io::Json& json) {
  return std::visit(
      [](const auto& value) -> SqlValue {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::uint64_t>) {
          return static_cast<std::int64_t>(value);
        } else if constexpr (std::is_constructible_v<SqlValue, T>) {
          return SqlValue(value);
        } else {
          return nullptr;
        }
      },
      json.value());
}

void insert_design(Database& database, std::int64_t task, std::size_t rank,
                   const std::vector<report::FieldRow>& fields) {
  std::string names, places;
  int place = 2;
  for (const report::FieldRow& field : fields) {
    names += ", " + quoted(field.quantity);
    places += fmt::format(", ?{}", ++place);
  }
  Statement insert = database.prepare(
      fmt::format("INSERT INTO design(task, rank{}) VALUES(?1, ?2{})", names, places));
  insert.with(task, static_cast<std::int64_t>(rank));
  place = 2;
  for (const report::FieldRow& field : fields) insert.bind(++place, sql_value(field.value));
  insert.run();
}

/// A switch of a key that also takes numbers is a text: 1 would be the number.
SqlValue value_of_key(const io::StatedValue& stated) {
  const bool is_switch = stated.value.kind == io::TomlValue::Kind::kBoolean;
  if (is_switch && is_number_or_switch(stated.path)) return io::toml_text(stated.value);
  return sql_value(stated.value);
}

std::int64_t signed_count(std::uint64_t count) { return static_cast<std::int64_t>(count); }

/// Writes what a task became; its row is there and has no result.
void insert_result(Database& database, std::int64_t task, const TaskResult& result) {
  database
      .prepare(
          "UPDATE task SET status = ?2, reason = ?3, sets = ?4, merit = ?5, bound = ?6, best = ?7 "
          "WHERE id = ?1")
      .with(task, std::string(kTaskStatusNames[static_cast<std::size_t>(result.status)]),
            result.reason, signed_count(result.sets), sql_value(result.merit),
            sql_value(result.bound), result.best)
      .run();
  Statement refusal = database.prepare("INSERT INTO refusal VALUES(?1, ?2, ?3, ?4)");
  for (const Refusal& r : result.refusals) {
    refusal.with(task, r.status, r.reason, signed_count(r.sets)).run();
  }
  for (std::size_t k = 0; k < result.designs.size(); ++k) {
    insert_design(database, task, k + 1, result.designs[k]);
  }
}

}  // namespace

std::int64_t Store::begin(const Run& run, const Sweep& sweep) {
  Transaction transaction(database_);
  database_
      .prepare(
          "INSERT INTO run(uid, name, sweep, axes, version, git, revision, host, workers, shard, "
          "tasks, "
          "started) VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, 0, ?11)")
      .with(run.uid, sweep.name, sweep.source, fmt::format("{}", fmt::join(sweep.varied(), ",")),
            std::string(io::version()), std::string(io::git_commit()),
            static_cast<std::int64_t>(kModelRevision), run.host,
            static_cast<std::int64_t>(run.workers),
            fmt::format("{}/{}", run.shard.number, run.shard.count), run.started_s)
      .run();
  const std::int64_t id = database_.last_id();
  transaction.commit();
  return id;
}

void Store::end(std::int64_t run, double now_s) {
  Transaction transaction(database_);
  database_.prepare("UPDATE run SET ended = ?2 WHERE id = ?1").with(run, now_s).run();
  transaction.commit();
}

std::int64_t Store::key_id(const std::string& path) {
  const auto known = key_ids_.find(path);
  if (known != key_ids_.end()) return known->second;
  database_.prepare("INSERT OR IGNORE INTO key(path) VALUES(?1)").with(path).run();
  Statement id = database_.prepare("SELECT id FROM key WHERE path = ?1");
  id.with(path).step();
  return key_ids_[path] = id.integer(0);
}

std::uint64_t Store::plan(std::int64_t run, const Sweep& sweep, const Shard& shard,
                          std::uint64_t from, Planned& planned) {
  constexpr std::uint64_t kBlock = 500;
  const std::uint64_t count = sweep.count();
  // Worked out before the database is held.
  std::vector<Task> tasks;
  std::uint64_t place = from;
  for (; place < count && tasks.size() < kBlock; ++place) {
    if (place % shard.count == shard.number - 1) tasks.push_back(task_of(sweep.document(place)));
  }
  Transaction transaction(database_);
  Statement find = database_.prepare("SELECT id, spec, status FROM task WHERE key = ?1");
  Statement insert =
      database_.prepare("INSERT INTO task(key, spec_key, revision, spec) VALUES(?1, ?2, ?3, ?4)");
  Statement value = database_.prepare("INSERT OR IGNORE INTO task_key VALUES(?1, ?2, ?3)");
  Statement queue = database_.prepare("INSERT OR IGNORE INTO queue(task) VALUES(?1)");
  Statement member = database_.prepare("INSERT OR IGNORE INTO run_task VALUES(?1, ?2)");
  for (const Task& task : tasks) {
    std::int64_t id = 0;
    bool done = false;
    if (find.with(task.key).step()) {
      id = find.integer(0);
      done = !find.is_null(2);
      if (find.text(1) != task.spec) {
        throw io::InvalidInput(
            fmt::format("{}: two tasks have the key {}: allowed: a file of its own for this sweep",
                        database_.path(), task.key));
      }
    } else {
      insert.with(task.key, task.spec_key, static_cast<std::int64_t>(kModelRevision), task.spec)
          .run();
      id = database_.last_id();
    }
    find.reset();
    // Also of a task that is known: it may have stated less.
    for (const io::StatedValue& v : task.values) {
      value.with(id, key_id(v.path), value_of_key(v)).run();
    }
    member.with(run, id).run();
    if (database_.changes() == 0) continue;
    ++planned.asked;
    if (done) {
      ++planned.known;
    } else {
      queue.with(id).run();
    }
  }
  database_.prepare("UPDATE run SET tasks = ?2 WHERE id = ?1")
      .with(run, signed_count(planned.asked))
      .run();
  transaction.commit();
  return place;
}

void Store::end_plan() {
  Transaction transaction(database_);
  make_result_view(database_);
  transaction.commit();
}

std::optional<Claimed> Store::claim(std::int64_t run, const Process& worker, double now_s) {
  Transaction transaction(database_);
  Statement queue = database_.prepare(
      "SELECT q.task, q.host, q.process, q.began, q.until, t.key, t.spec FROM queue q JOIN task t "
      "ON t.id "
      "= "
      "q.task WHERE EXISTS(SELECT 1 FROM run_task r WHERE r.run = ?1 AND r.task = q.task) ORDER BY "
      "q.task");
  queue.with(run);
  while (queue.step()) {
    const Process holder{
        .host = queue.text(1), .number = queue.integer(2), .began = queue.integer(3)};
    const bool leased = queue.number(4) > now_s;
    if (leased ? !is_dead(holder) : is_alive(holder)) continue;
    const Claimed claimed{.id = queue.integer(0), .key = queue.text(5), .spec = queue.text(6)};
    queue.reset();
    database_
        .prepare("UPDATE queue SET host = ?2, process = ?3, began = ?4, until = ?5 WHERE task = ?1")
        .with(claimed.id, worker.host, worker.number, worker.began, now_s + kLeaseSeconds)
        .run();
    transaction.commit();
    return claimed;
  }
  return std::nullopt;
}

void Store::release(std::int64_t task, const Process& worker) {
  Transaction transaction(database_);
  database_
      .prepare(
          "UPDATE queue SET host = '', process = 0, began = 0, until = 0 "
          "WHERE task = ?1 AND host = ?2 AND process = ?3 AND began = ?4")
      .with(task, worker.host, worker.number, worker.began)
      .run();
  transaction.commit();
}

void Store::renew(const std::vector<Process>& workers, double now_s) {
  Transaction transaction(database_);
  Statement lease = database_.prepare(
      "UPDATE queue SET until = ?4 WHERE host = ?1 AND process = ?2 AND began = ?3");
  for (const Process& worker : workers) {
    lease.with(worker.host, worker.number, worker.began, now_s + kLeaseSeconds).run();
  }
  transaction.commit();
}

bool Store::finish(std::int64_t task, const TaskResult& result, const Provenance& provenance) {
  Transaction transaction(database_);
  Statement open = database_.prepare("SELECT 1 FROM task WHERE id = ?1 AND status IS NULL");
  const bool first = open.with(task).step();
  open.reset();
  if (first) {
    insert_result(database_, task, result);
    database_.prepare("INSERT INTO provenance VALUES(?1, ?2, ?3, ?4, ?5)")
        .with(task, provenance.run, provenance.host, provenance.finished_s, provenance.cpu_s)
        .run();
  }
  database_.prepare("DELETE FROM queue WHERE task = ?1").with(task).run();
  transaction.commit();
  return first;
}

void Store::bury(const Process& worker, const WorkerEnd& end, const Provenance& provenance) {
  std::int64_t task = 0;
  TaskResult result;
  {
    Transaction transaction(database_);
    Statement held = database_.prepare(
        "SELECT task, crashes, kills FROM queue WHERE host = ?1 AND process = ?2 AND began = ?3");
    if (!held.with(worker.host, worker.number, worker.began).step()) return;
    task = held.integer(0);
    const bool counts = end.signal != 0;
    const std::int64_t crashes = held.integer(1) + (counts && end.crash ? 1 : 0);
    const std::int64_t kills = held.integer(2) + (counts && !end.crash ? 1 : 0);
    held.reset();
    database_
        .prepare(
            "UPDATE queue SET host = '', process = 0, began = 0, until = 0, crashes = ?2, "
            "kills = ?3 WHERE task = ?1")
        .with(task, crashes, kills)
        .run();
    transaction.commit();
    if (crashes >= kMostCrashes) {
      result.reason =
          fmt::format("the program ended by signal {} each of {} times", end.signal, kMostCrashes);
    } else if (kills >= kMostKills) {
      result.reason = fmt::format("killed by signal {}, {} times", end.signal, kMostKills);
    }
  }
  if (!result.reason.empty()) finish(task, result, provenance);
}

std::int64_t Store::open_tasks(std::int64_t run) const {
  Statement count = database_.prepare(
      "SELECT count(*) FROM queue q WHERE EXISTS(SELECT 1 FROM run_task r WHERE r.run = ?1 AND "
      "r.task = q.task)");
  count.with(run).step();
  return count.integer(0);
}

}  // namespace gear3k::sweep
