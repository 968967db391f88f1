#include "sweep/questions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <sstream>

#include "io/text/diagnostics.hpp"
#include "optimize/objective.hpp"
#include "sweep/process.hpp"
#include "sweep/schema.hpp"
#include "sweep/task.hpp"

namespace gear3k::sweep {

namespace {

/// Tasks with a result, and their best designs: of a run, or of the newest revision that has one.
/// @throws io::InvalidInput for a run that there is not
std::string tasks_of(const Database& database, const AskedTasks& asked) {
  constexpr const char* kWithDesign = "task t LEFT JOIN design d ON d.task = t.id AND d.rank = 1";
  if (!asked.run) {
    return fmt::format(
        "{} WHERE t.status IS NOT NULL AND NOT EXISTS(SELECT 1 FROM task n WHERE n.spec_key = "
        "t.spec_key AND n.revision > t.revision AND n.status IS NOT NULL)",
        kWithDesign);
  }
  if (database.count(fmt::format("SELECT count(*) FROM run WHERE id = {}", *asked.run)) == 0) {
    throw io::InvalidInput(
        fmt::format("{}: no run {}: allowed: a number in the column run of gear3k sweep status",
                    database.path(), *asked.run));
  }
  return fmt::format(
      "{} WHERE t.status IS NOT NULL AND t.id IN (SELECT task FROM run_task WHERE run = {})",
      kWithDesign, *asked.run);
}

std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : name) {
    if (c == '.' || c == '_') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

/// Whether a name's words stand in another's, side by side.
bool is_part(const std::string& part, const std::string& whole) {
  const auto words = words_of(whole);
  const auto some = words_of(part);
  return std::search(words.begin(), words.end(), some.begin(), some.end()) != words.end();
}

struct KeyPath {
  std::int64_t id;
  std::string path;
  bool varied;
};

std::vector<KeyPath> key_paths(const Database& database) {
  std::set<std::string> varied;
  Statement axes = database.prepare("SELECT DISTINCT axes FROM run");
  while (axes.step()) {
    std::istringstream list(axes.text(0));
    for (std::string path; std::getline(list, path, ',');) varied.insert(path);
  }
  std::vector<KeyPath> keys;
  Statement paths = database.prepare("SELECT id, path FROM key ORDER BY path");
  while (paths.step()) {
    keys.push_back(
        {.id = paths.integer(0), .path = paths.text(1), .varied = varied.contains(paths.text(1))});
  }
  return keys;
}

Column key_column(const KeyPath& key) {
  return {.name = key.path, .sql = key_value_sql(key.path, key.id)};
}

Column design_column(const std::string& name) { return {.name = name, .sql = "d." + quoted(name)}; }

/// What is known of a task itself.
constexpr std::array<const char*, 4> kTaskColumns{"status", "merit", "bound", "sets"};

/// Columns of the keys that tasks have different values of, or some have none of.
std::vector<Column> differing_keys(const Database& database, const std::string& tasks) {
  std::set<std::string> differing;
  Statement paths = database.prepare(fmt::format(
      "SELECT p.path FROM task_key k JOIN key p ON p.id = k.key WHERE k.task IN (SELECT "
      "t.id FROM {0}) GROUP BY k.key HAVING count(DISTINCT k.value) > 1 OR "
      "count(DISTINCT typeof(k.value)) > 1 OR count(*) < (SELECT count(*) FROM {0})",
      tasks));
  while (paths.step()) differing.insert(paths.text(0));
  std::vector<Column> columns;
  for (const KeyPath& key : key_paths(database)) {
    if (differing.contains(key.path)) columns.push_back(key_column(key));
  }
  return columns;
}

/// Takes out columns, from one on, that have one value in all rows.
void drop_constant_columns(Rows& rows, std::size_t first) {
  for (std::size_t k = rows.names.size(); k-- > first;) {
    const auto same = [&](const auto& row) { return row[k] == rows.rows.front()[k]; };
    if (!std::ranges::all_of(rows.rows, same)) continue;
    const auto at = static_cast<std::ptrdiff_t>(k);
    rows.names.erase(rows.names.begin() + at);
    for (auto& row : rows.rows) row.erase(row.begin() + at);
  }
}

/// Tasks of each run that a process has whose lease lasts, and of which nothing says that it is
/// dead.
std::map<std::int64_t, std::int64_t> working_of(const Database& database) {
  std::map<std::int64_t, std::int64_t> working;
  Statement held = database.prepare(
      "SELECT m.run, q.host, q.process, q.began FROM queue q JOIN run_task m ON m.task = q.task "
      "WHERE q.process > 0 AND q.until > (julianday('now') - 2440587.5) * 86400.0");
  while (held.step()) {
    const Process holder{.host = held.text(1), .number = held.integer(2), .began = held.integer(3)};
    if (!is_dead(holder)) ++working[held.integer(0)];
  }
  return working;
}

}  // namespace

Rows status_of(const Database& database, const std::string& run) {
  Statement counts = database.prepare(
      "SELECT r.id AS run, r.name AS sweep, r.revision, r.shard, r.tasks, "
      "coalesce(c.done, 0) AS done, coalesce(c.optimal, 0) AS optimal, "
      "coalesce(c.without, 0) AS no_feasible_design, coalesce(c.invalid, 0) AS invalid, "
      "coalesce(c.failed, 0) AS failed, r.tasks - coalesce(c.done, 0) AS open, "
      "0 AS working, datetime(r.started, 'unixepoch') AS started, "
      "datetime(r.ended, 'unixepoch') AS ended, r.version, r.git, r.host "
      "FROM run r LEFT JOIN (SELECT m.run, count(t.status) AS done, "
      "sum(t.status = 'optimal') AS optimal, sum(t.status = 'no_feasible_design') AS without, "
      "sum(t.status = 'invalid') AS invalid, sum(t.status = 'failed') AS failed "
      "FROM run_task m JOIN task t ON t.id = m.task GROUP BY m.run) c ON c.run = r.id WHERE ?1 = "
      "'' OR r.uid = ?1 "
      "ORDER BY r.started DESC, r.id DESC");
  counts.with(run);
  Rows rows = rows_of(counts);
  const auto column = std::ranges::find(rows.names, "working") - rows.names.begin();
  const std::map<std::int64_t, std::int64_t> working = working_of(database);
  for (auto& row : rows.rows) {
    const auto found = working.find(std::get<std::int64_t>(row.front()));
    if (found != working.end()) row[static_cast<std::size_t>(column)] = found->second;
  }
  return rows;
}

Column column_of(const Database& database, const std::string& name, Role role) {
  const std::vector<KeyPath> keys = key_paths(database);
  const std::vector<std::string> columns = design_columns();
  const auto keys_where = [&](auto fits) {
    std::vector<Column> found;
    for (const KeyPath& key : keys) {
      if (fits(key)) found.push_back(key_column(key));
    }
    return found;
  };
  const auto columns_where = [&](auto fits) {
    std::vector<Column> found;
    for (const std::string& column : columns) {
      if (fits(column)) found.push_back(design_column(column));
    }
    return found;
  };
  auto own_columns = columns_where([&](const std::string& column) { return column == name; });
  if (std::ranges::find(kTaskColumns, name) != kTaskColumns.end()) {
    own_columns.push_back({.name = name, .sql = "t." + name});
  }
  const auto part_columns =
      columns_where([&](const std::string& column) { return is_part(name, column); });
  std::vector<std::vector<Column>> choices{
      keys_where([&](const KeyPath& key) { return key.varied && key.path == name; }),
      keys_where([&](const KeyPath& key) { return key.varied && is_part(name, key.path); }),
      own_columns,
      keys_where([&](const KeyPath& key) { return key.path == name; }),
      keys_where([&](const KeyPath& key) { return is_part(name, key.path); }),
      part_columns};
  if (role == Role::kResult) choices.insert(choices.begin(), {own_columns, part_columns});
  const auto found = std::ranges::find_if(choices, [](const auto& c) { return !c.empty(); });
  if (found == choices.end()) {
    std::vector<std::string> all = columns;
    all.insert(all.end(), kTaskColumns.begin(), kTaskColumns.end());
    for (const KeyPath& key : keys) all.push_back(key.path);
    const std::string hint = io::closest_word(name, all);
    throw io::InvalidInput(fmt::format(
        "{}: no key and no column {}{}; allowed: a key that a task states, or one of {}, {}",
        database.path(), name, hint.empty() ? "" : fmt::format("; did you mean {}?", hint),
        fmt::join(kTaskColumns, ", "), fmt::join(columns, ", ")));
  }
  if (found->size() > 1) {
    std::vector<std::string> names;
    for (const Column& column : *found) names.push_back(column.name);
    throw io::InvalidInput(fmt::format("{}: {} may be {}: allowed: one of them", database.path(),
                                       name, fmt::join(names, " or ")));
  }
  return found->front();
}

Ranking ranking_of(const Database& database, const AskedTasks& tasks,
                   const std::vector<std::string>& by) {
  constexpr const char* kKey = "objective";
  const std::string usual{
      optimize::objective_record(optimize::Objective::kBackwardEfficiency).name};
  const auto keys = key_paths(database);
  const auto key = std::ranges::find(keys, kKey, &KeyPath::path);
  std::vector<std::string> objectives{usual};
  if (key != keys.end()) {
    objectives.clear();
    Statement stated =
        database.prepare(fmt::format("SELECT DISTINCT coalesce({}, '{}') FROM {} ORDER BY 1",
                                     key_column(*key).sql, usual, tasks_of(database, tasks)));
    while (stated.step()) objectives.push_back(text_of(stated.value(0)));
  }
  constexpr const char* kOther = "--most NAME or --least NAME ranks by another column";
  const bool one_each = std::ranges::any_of(by, [&](const std::string& name) {
    return column_of(database, name, Role::kCondition).name == kKey;
  });
  if (objectives.size() > 1 && !one_each) {
    return {.of = "eta_b",
            .text = fmt::format("{}: ranked by eta_b, as the tasks have several objectives ({}); "
                                "--by objective has a row for each, {}\n",
                                database.path(), fmt::join(objectives, ", "), kOther)};
  }
  if (objectives.empty() || objectives == std::vector{usual}) return {.of = "eta_b", .text = ""};
  const bool forward =
      objectives.size() == 1 &&
      objectives[0] == optimize::objective_record(optimize::Objective::kForwardEfficiency).name;
  const std::string of = forward ? "eta_f" : "merit";
  return {.of = of,
          .text = fmt::format("{}: ranked by {}, of the objective {} of the tasks; {}\n",
                              database.path(), of, fmt::join(objectives, ", "), kOther)};
}

Rows best_of(const Database& database, const BestQuestion& question) {
  const std::string tasks = tasks_of(database, question.tasks);
  std::string names, groups;
  std::set<std::string> used;
  for (const std::string& name : question.by) {
    const Column column = column_of(database, name, Role::kCondition);
    if (!used.insert(column.name).second) continue;
    names += fmt::format("{} AS {}, ", column.sql, quoted(column.name));
    groups += fmt::format("{}{}", groups.empty() ? "" : ", ", column.sql);
  }
  const std::size_t by_count = used.size();
  const std::string asked =
      question.of.empty() ? ranking_of(database, question.tasks, question.by).of : question.of;
  const Column of = column_of(database, asked, Role::kResult);
  if (database.count(
          fmt::format("SELECT count(d.task) > 0 AND count({}) = 0 FROM {}", of.sql, tasks)) == 1) {
    throw io::InvalidInput(
        fmt::format("{}: no design has {}: allowed: a name that designs have a "
                    "value of",
                    database.path(), of.name));
  }
  std::string shown;
  for (const std::string& column :
       {of.name, std::string("zS"), std::string("zP1"), std::string("zR1"), std::string("zP2"),
        std::string("zR2"), std::string("planets"), std::string("ratio"), std::string("eta_b"),
        std::string("eta_f"), std::string("backlash_arcmin"),
        std::string("ring_root_diameter_mm")}) {
    if (!used.insert(column).second) continue;
    shown += fmt::format("{} AS {}, ", column == of.name ? of.sql : "d." + quoted(column),
                         quoted(column));
  }
  for (const char* column : {"status", "merit", "bound"}) {
    if (used.insert(column).second) shown += fmt::format("t.{0} AS {0}, ", column);
  }
  // What else the tasks of the rows differ in.
  std::string others;
  std::size_t other_count = 0;
  for (const Column& column : differing_keys(database, tasks)) {
    if (!used.insert(column.name).second) continue;
    others += fmt::format("{} AS {}, ", column.sql, quoted(column.name));
    ++other_count;
  }
  // Values that differ by rounding are equal: the greater objective is then better.  Of a number
  // x (2^23 + 1) - (x (2^23 + 1) - x) has the first 30 bits (Veltkamp), nine digits.
  const std::string compared = fmt::format(
      "CASE typeof({0}) WHEN 'real' THEN {0} * 8388609.0 - ({0} * 8388609.0 - {0}) ELSE {0} END",
      of.sql);
  Statement best = database.prepare(fmt::format(
      "SELECT * FROM (SELECT {0}{1}t.key, {7}row_number() OVER ({2} "
      "ORDER BY {3} IS NULL, {8} {4}, t.merit DESC, t.key) AS place FROM {5}) WHERE place = 1 "
      "ORDER BY {6}",
      names, shown, groups.empty() ? "" : "PARTITION BY " + groups, of.sql,
      question.least ? "ASC" : "DESC", tasks,
      [&] {
        std::string order;
        for (std::size_t k = 0; k < by_count; ++k) order += fmt::format("{}, ", k + 1);
        return order + "key";
      }(),
      others, compared));
  Rows rows = rows_of(best);
  // Its place is that of all of them.
  rows.names.pop_back();
  for (auto& row : rows.rows) row.pop_back();
  drop_constant_columns(rows, rows.names.size() - other_count);
  return rows;
}

std::string pooled_text(const Database& database, const AskedTasks& tasks,
                        const std::vector<std::string>& shown) {
  const std::string asked = tasks_of(database, tasks);
  std::set<std::string> told(shown.begin(), shown.end());
  bool of_files = false;
  for (const KeyPath& key : key_paths(database)) {
    if (key.varied) told.insert(key.path);
    of_files = of_files || names_files(key.path);
  }
  std::vector<std::string> hidden;
  for (const Column& column : differing_keys(database, asked)) {
    if (told.contains(column.name)) continue;
    std::vector<std::string> values;
    Statement all = database.prepare(
        fmt::format("SELECT DISTINCT {} FROM {} ORDER BY 1 LIMIT 4", column.sql, asked));
    while (all.step()) {
      values.push_back(all.is_null(0) ? std::string("not stated") : text_of(all.value(0)));
    }
    constexpr std::size_t kShown = 3;
    if (values.size() > kShown) values.back() = "...";
    hidden.push_back(fmt::format("{} ({})", column.name, fmt::join(values, ", ")));
  }
  // Tasks of the same keys are told apart by the contents of files.
  if (of_files &&
      database.count(fmt::format(
          "SELECT EXISTS(SELECT 1 FROM (SELECT t.spec_key, (SELECT group_concat(s) FROM (SELECT "
          "k.key || '=' || k.value AS s FROM task_key k WHERE k.task = t.id ORDER BY k.key)) AS "
          "keys FROM {}) GROUP BY keys HAVING count(DISTINCT spec_key) > 1)",
          asked)) == 1) {
    hidden.emplace_back("the contents of files that they name");
  }
  if (hidden.empty()) return "";
  const std::int64_t runs = database.count(fmt::format(
      "SELECT count(DISTINCT run) FROM run_task WHERE task IN (SELECT t.id FROM {})", asked));
  return fmt::format(
      "{}: the tasks of {} runs are asked together, and differ in what is not shown: {}; --run N "
      "asks "
      "those of one (N as in gear3k sweep status)\n",
      database.path(), runs, fmt::join(hidden, ", "));
}

Rows answer_to(const Database& database, const std::string& sql) {
  Statement statement = database.prepare(sql);
  return rows_of(statement);
}

Map map_of(const Database& database, const MapQuestion& question) {
  const Column x = column_of(database, question.x, Role::kCondition);
  const Column y = column_of(database, question.y, Role::kResult);
  const Column by = question.by.empty() ? Column{.name = "", .sql = "''"}
                                        : column_of(database, question.by, Role::kCondition);
  Statement points =
      database.prepare(fmt::format("SELECT {0}, {1}, max({2}) FROM {3} AND typeof({1}) IN "
                                   "('integer', 'real') AND typeof({2}) IN "
                                   "('integer', 'real') GROUP BY {0}, {1} ORDER BY {0}, {1}",
                                   by.sql, x.sql, y.sql, tasks_of(database, question.tasks)));
  Map map{.title = "", .x = x.name, .y = y.name, .by = by.name, .lines = {}};
  while (points.step()) {
    const std::string name = points.is_null(0) ? "default" : text_of(points.value(0));
    if (map.lines.empty() || map.lines.back().name != name) {
      map.lines.push_back({.name = name, .points = {}});
    }
    map.lines.back().points.emplace_back(points.number(1), points.number(2));
  }
  if (map.lines.empty()) {
    throw io::InvalidInput(
        fmt::format("{}: no design has numbers for both {} and {}: allowed: columns that have",
                    database.path(), x.name, y.name));
  }
  const SqlValue title =
      database.one("SELECT name FROM run WHERE name <> '' ORDER BY started DESC LIMIT 1");
  if (const auto* text = std::get_if<std::string>(&title)) map.title = *text;
  return map;
}

}  // namespace gear3k::sweep
