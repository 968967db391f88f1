#include "sweep/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "io/text/diagnostics.hpp"
#include "sweep/schema.hpp"

namespace gear3k::sweep {

namespace {

constexpr std::array<const char*, 5> kChangeNames{"same", "better", "worse", "newly_feasible",
                                                  "newly_infeasible"};

struct Result {
  std::int64_t id = 0, revision = 0;
  std::string key, spec_key, status, reason;
  double merit = std::nan("");
  std::string run;     ///< name and axes of the last run that asked for it
  std::string values;  ///< of those axes, in words
};

/// Keys of a task with their values in words.
std::map<std::string, std::string> keys_of(const Database& database, std::int64_t task) {
  std::map<std::string, std::string> keys;
  Statement values = database.prepare(
      "SELECT k.path, v.value FROM task_key v JOIN key k ON k.id = v.key WHERE v.task = ?1");
  values.with(task);
  while (values.step()) keys[values.text(0)] = text_of(key_value(values.text(0), values.value(1)));
  return keys;
}

/// Name and axes of the last run that asked for a task, and its values on them.
void place(const Database& database, Result& result) {
  Statement run = database.prepare(
      "SELECT r.name, r.axes FROM run_task m JOIN run r ON r.id = m.run WHERE m.task = ?1 ORDER BY "
      "r.started DESC LIMIT 1");
  if (!run.with(result.id).step()) return;
  const std::string axes = run.text(1);
  result.run = run.text(0) + "\n" + axes;
  const auto keys = keys_of(database, result.id);
  std::istringstream paths(axes);
  for (std::string path; std::getline(paths, path, ',');) {
    const auto value = keys.find(path);
    result.values += fmt::format("{}{} = {}", result.values.empty() ? "" : ", ", path,
                                 value == keys.end() ? "default" : value->second);
  }
}

/// Keys in which two tasks differ: "friction.coefficient 0.1 -> 0.08".
std::string difference(const Database& database, std::int64_t before, std::int64_t after) {
  const auto old_keys = keys_of(database, before);
  const auto new_keys = keys_of(database, after);
  std::set<std::string> paths;
  for (const auto& [path, value] : old_keys) paths.insert(path);
  for (const auto& [path, value] : new_keys) paths.insert(path);
  std::string text;
  for (const std::string& path : paths) {
    const auto value = [&](const auto& keys) {
      const auto found = keys.find(path);
      return found == keys.end() ? std::string("default") : found->second;
    };
    if (value(old_keys) == value(new_keys)) continue;
    text += fmt::format("{}{} {} -> {}", text.empty() ? "" : ", ", path, value(old_keys),
                        value(new_keys));
  }
  return text;
}

/// The newest result of every question before and after.
struct Sides {
  std::map<std::string, Result> before, after;  ///< by spec_key
};

Sides sides_of(const Database& database, const Since& since) {
  Sides sides;
  Statement results = database.prepare(
      "SELECT t.id, t.key, t.spec_key, t.revision, t.status, t.reason, t.merit, p.finished FROM "
      "task t LEFT JOIN provenance p ON p.task = t.id WHERE t.status IS NOT NULL ORDER BY "
      "t.revision");
  while (results.step()) {
    Result result{.id = results.integer(0),
                  .revision = results.integer(3),
                  .key = results.text(1),
                  .spec_key = results.text(2),
                  .status = results.text(4),
                  .reason = results.text(5),
                  .merit = results.is_null(6) ? std::nan("") : results.number(6),
                  .run = {},
                  .values = {}};
    const bool before = since.revision ? result.revision <= *since.revision
                                       : results.number(7) < since.time_s.value_or(0.0);
    (before ? sides.before : sides.after)[result.spec_key] = std::move(result);
  }
  return sides;
}

SqlValue merit_value(double merit) {
  return std::isfinite(merit) ? SqlValue(merit) : SqlValue(nullptr);
}

}  // namespace

std::optional<Since> since_of(const std::string& text) {
  std::int64_t revision = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), revision);
  if (error == std::errc() && end == text.data() + text.size()) {
    if (revision < 0) return std::nullopt;
    return Since{.revision = revision, .time_s = std::nullopt};
  }
  // Other texts that SQLite takes are days of Julius, or now.
  constexpr std::size_t kYearDigits = 4;
  if (text.find('-') != kYearDigits) return std::nullopt;
  const Database none(":memory:", Database::Access::kCreate);
  Statement time = none.prepare("SELECT (julianday(?1) - 2440587.5) * 86400.0");
  if (!time.with(text).step() || time.is_null(0)) return std::nullopt;
  return Since{.revision = std::nullopt, .time_s = time.number(0)};
}

Change change_of(const std::string& status_before, double merit_before,
                 const std::string& status_after, double merit_after) {
  const bool had = status_before == "optimal";
  const bool has = status_after == "optimal";
  if (had != has) return has ? Change::kNewlyFeasible : Change::kNewlyInfeasible;
  if (!had) return Change::kSame;
  const double scale = std::max(std::abs(merit_before), std::abs(merit_after));
  if (std::abs(merit_after - merit_before) <= kSameMerit * scale) return Change::kSame;
  return merit_after > merit_before ? Change::kBetter : Change::kWorse;
}

Comparison compare(const Database& database, const Since& since) {
  const SqlValue greatest = database.one("SELECT max(revision) FROM task WHERE status IS NOT NULL");
  if (std::holds_alternative<std::nullptr_t>(greatest)) {
    throw io::InvalidInput(
        fmt::format("{}: no task has a result: allowed: a database with results", database.path()));
  }
  const std::int64_t newest = std::get<std::int64_t>(greatest);
  if (since.revision && *since.revision > newest) {
    throw io::InvalidInput(
        fmt::format("{}: no result is of a revision of the models above {}: --since {}: allowed: "
                    "at most {}, or a time of UTC",
                    database.path(), newest, *since.revision, newest));
  }
  Sides sides = sides_of(database, since);
  Comparison comparison;
  comparison.changes.names = {"change", "task",   "merit_before", "merit_after",
                              "cause",  "reason", "key"};
  std::set<std::string> paired;
  const auto add = [&](const Result& before, Result& after, const std::string& cause) {
    paired.insert(before.spec_key);
    const Change change = change_of(before.status, before.merit, after.status, after.merit);
    const std::array<std::int64_t*, 5> counts{&comparison.same, &comparison.better,
                                              &comparison.worse, &comparison.newly_feasible,
                                              &comparison.newly_infeasible};
    ++*counts[static_cast<std::size_t>(change)];
    if (change == Change::kSame) return;
    if (after.run.empty()) place(database, after);
    comparison.changes.rows.push_back({std::string(kChangeNames[static_cast<std::size_t>(change)]),
                                       after.values, merit_value(before.merit),
                                       merit_value(after.merit), cause, after.reason, after.key});
  };
  std::vector<Result*> unpaired;
  for (auto& [spec_key, after] : sides.after) {
    const auto before = sides.before.find(spec_key);
    if (before == sides.before.end()) {
      unpaired.push_back(&after);
    } else {
      add(before->second, after,
          fmt::format("revision {} -> {}", before->second.revision, after.revision));
    }
  }
  // Another question at the same place of a run of the same name.
  std::map<std::pair<std::string, std::string>, const Result*> places;
  if (!unpaired.empty()) {
    for (auto& [spec_key, before] : sides.before) {
      place(database, before);
      const Result*& last = places[{before.run, before.values}];
      if (last == nullptr || last->id < before.id) last = &before;
    }
  }
  for (Result* after : unpaired) {
    place(database, *after);
    const auto before = places.find({after->run, after->values});
    if (after->run.empty() || before == places.end()) {
      ++comparison.only_after;
    } else {
      add(*before->second, *after, difference(database, before->second->id, after->id));
    }
  }
  comparison.only_before = std::ranges::count_if(
      sides.before, [&](const auto& side) { return !paired.contains(side.first); });
  std::ranges::sort(comparison.changes.rows, {}, [](const std::vector<SqlValue>& row) {
    return std::pair(std::get<std::string>(row[0]), std::get<std::string>(row[1]));
  });
  return comparison;
}

std::string counts_text(const Comparison& comparison) {
  return fmt::format(
      "{} better, {} worse, {} newly feasible, {} newly infeasible, {} the same; {} without a "
      "result before, {} without one since\n",
      comparison.better, comparison.worse, comparison.newly_feasible, comparison.newly_infeasible,
      comparison.same, comparison.only_after, comparison.only_before);
}

}  // namespace gear3k::sweep
