#include "sweep/questions.hpp"

#include <array>

#include "tests/sweep/small_sweep.hpp"

namespace gear3k::questions_test {
namespace {

using sweep::answer_to, sweep::Database;
using test::refusal_of, test::Workplace;

/// A database with five open tasks, to be read.
struct Asked {
  [[nodiscard]] std::string refusal(const std::string& sql) const {
    const std::string message = refusal_of([&] { answer_to(database, sql); });
    return message.substr(std::min(message.size(), tasks.path.size()));
  }

  Workplace place;
  test::QueuedTasks tasks{place, "db", 5};
  Database database = sweep::open_sweep_database(tasks.path, Database::Access::kRead);
};

TEST(SweepQuery, RefusesWhatDoesMoreThanRead) {
  const Asked asked;
  const std::string before = asked.place.read("db");
  const std::string file = "'" + asked.place.file("file").string() + "'";
  for (const std::string& statement :
       {std::string("DELETE FROM task"), std::string("UPDATE task SET status = NULL"),
        "VACUUM INTO " + file, std::string("VACUUM"), "ATTACH " + file + " AS other",
        std::string("DETACH main"), std::string("PRAGMA journal_mode=DELETE"),
        std::string("PRAGMA user_version = 5"), std::string("PRAGMA wal_checkpoint"),
        std::string("PRAGMA unknown"), std::string("BEGIN"), std::string("SAVEPOINT a"),
        std::string("CREATE TABLE t(x)"), std::string("CREATE TEMP TABLE t(x)"),
        std::string("REINDEX"), std::string("ANALYZE"), std::string("EXPLAIN DROP TABLE task"),
        std::string("SELECT 1; DELETE FROM task")}) {
    EXPECT_EQ(asked.refusal(statement),
              ": a statement that does more than read; nothing was changed: allowed: SELECT, WITH, "
              "VALUES, EXPLAIN, or a PRAGMA that only tells")
        << statement;
  }
  // A file opened to read keeps its own table of tables.
  EXPECT_NE(asked.refusal("UPDATE sqlite_master SET sql = ''"), "");
  EXPECT_FALSE(asked.place.has("file"));
  EXPECT_TRUE(asked.place.read("db") == before);
}

TEST(SweepQuery, TakesOneStatement) {
  const Asked asked;
  EXPECT_EQ(asked.refusal("SELECT 1; SELECT 2"), ": several SQL statements: allowed: one");
  EXPECT_EQ(asked.refusal({"SELECT 1\0, 2", 12}), ": a zero byte in an SQL statement");
  for (const char* none : {"", " ", ";", "-- nothing", "/* nothing */"}) {
    EXPECT_EQ(asked.refusal(none), ": no SQL statement: allowed: one, as \"SELECT * FROM result\"")
        << none;
  }
  for (const char* one :
       {"SELECT count(*) FROM task;", "; SELECT 5 -- one", "VALUES(5);;",
        "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 5) SELECT max(x) "
        "FROM n",
        "SELECT count(*) FROM pragma_table_info('run_task') JOIN json_each('[1, 2, 3, 4, 5]') "
        "WHERE pk = 1"}) {
    const sweep::Rows rows = answer_to(asked.database, one);
    ASSERT_EQ(rows.rows.size(), 1U) << one;
    EXPECT_EQ(std::get<std::int64_t>(rows.rows[0][0]), 5) << one;
  }
  EXPECT_EQ(sweep::rows_table(answer_to(asked.database, "PRAGMA user_version")), "1\n");
  EXPECT_EQ(sweep::rows_table(answer_to(asked.database, "PRAGMA integrity_check")), "ok\n");
}

TEST(SweepQuery, AKeyIsNoText) {
  const Asked asked;
  EXPECT_EQ(answer_to(asked.database, "SELECT \"friction.coefficient\" FROM result").rows.size(),
            0U);
  for (const char* name : {"\"ratio.traget\"", "ratio.target"}) {
    const std::string message = asked.refusal(std::string("SELECT ") + name + " FROM result");
    EXPECT_EQ(message.substr(0, 22), ": no such column: rati") << message;
    EXPECT_NE(message.find(": allowed: a key in double quotes, as \"ratio.target\""),
              std::string::npos)
        << message;
  }
}

TEST(SweepQuery, JsonKeepsColumnsOfOneName) {
  const Asked asked;
  EXPECT_EQ(sweep::rows_json(answer_to(asked.database, "SELECT 1 AS a, 2 AS a, 3 AS \"a:1\"")),
            "[\n  {\n    \"a\": 1,\n    \"a:1\": 2,\n    \"a:1:1\": 3\n  }\n]\n");
}

TEST(SweepBest, ConditionsAreKeysAndResultsAreColumns) {
  const Workplace place;
  place.write("sweep.toml", test::kSmallTask +
                                "planets = 4\n[vary]\nratio.target = [40.0, 40.1]\n"
                                "size.max_ring_root_diameter_mm = [100.0, 110.0]\n");
  const sweep::Sweep sweep = sweep::read_sweep(place.file("sweep.toml").string());
  const std::string path = place.file("db").string();
  sweep::Store store(sweep::open_sweep_database(path, Database::Access::kCreate));
  const std::int64_t run = store.begin(
      {.uid = "run", .workers = 1, .shard = {}, .started_s = 0.0, .host = "here"}, sweep);
  sweep::Planned planned;
  store.plan(run, sweep, {}, 0, planned);
  const auto name_of = [&](const std::string& name, sweep::Role role) {
    return sweep::column_of(store.database(), name, role).name;
  };
  for (const auto& [name, condition, result] :
       {std::array{"ratio", "ratio.target", "ratio"},
        std::array{"ring_root_diameter", "size.max_ring_root_diameter_mm", "ring_root_diameter_mm"},
        std::array{"ratio.target", "ratio.target", "ratio.target"},
        std::array{"eta_b", "eta_b", "eta_b"}, std::array{"teeth.S", "teeth.S", "teeth.S"}}) {
    EXPECT_EQ(name_of(name, sweep::Role::kCondition), condition);
    EXPECT_EQ(name_of(name, sweep::Role::kResult), result);
  }
  // A name that comes again is no second column.
  for (int k = 0; k < 4; ++k) {
    const auto claimed = store.claim(run, sweep::this_process(), 0.0);
    store.finish(claimed->id, test::made_result(0.5), {});
  }
  const sweep::Rows rows = sweep::best_of(store.database(), {.by = {"ratio", "ratio.target"}});
  EXPECT_EQ(rows.rows.size(), 2U);
  EXPECT_EQ(std::ranges::count(rows.names, "ratio.target"), 1);
}

TEST(SweepBest, SwitchesOfALimitAreNoNumbers) {
  const Workplace place;
  place.write("sweep.toml", test::kSmallTask +
                                "planets = 4\nratio.target = 40.0\n[vary]\n"
                                "limits.tip_thickness = [true, 1.0, false, 0.0]\n");
  const sweep::Sweep sweep = sweep::read_sweep(place.file("sweep.toml").string());
  const std::string path = place.file("db").string();
  sweep::Store store(sweep::open_sweep_database(path, Database::Access::kCreate));
  const std::int64_t run = store.begin(
      {.uid = "run", .workers = 1, .shard = {}, .started_s = 0.0, .host = "here"}, sweep);
  sweep::Planned planned;
  store.plan(run, sweep, {}, 0, planned);
  store.end_plan();
  for (int k = 0; k < 4; ++k) {
    store.finish(store.claim(run, sweep::this_process(), 0.0)->id, test::made_result(0.5), {});
  }
  const auto limits = [&] {
    std::vector<sweep::SqlValue> values;
    for (const auto& row : sweep::best_of(store.database(), {.by = {"tip_thickness"}}).rows) {
      values.push_back(row.front());
    }
    return values;
  };
  // true is the default, 0.25 modules.
  EXPECT_EQ(limits(), (std::vector<sweep::SqlValue>{0.0, 0.25, 1.0, "false"}));

  // As programs of before had them: true as 1, false as 0.
  store.database().execute(
      "UPDATE task_key SET value = CASE value WHEN 'false' THEN 0 ELSE 1 END WHERE value IN "
      "('false', 0.25) AND key = (SELECT id FROM key WHERE path = 'limits.tip_thickness')");
  EXPECT_EQ(limits(), (std::vector<sweep::SqlValue>{0.0, 1.0, "false", "true"}));
  const sweep::Rows view =
      answer_to(store.database(), "SELECT \"limits.tip_thickness\" FROM result ORDER BY 1");
  ASSERT_EQ(view.rows.size(), 4U);
  EXPECT_EQ(view.rows[3], (std::vector<sweep::SqlValue>{"true"}));
}

TEST(SweepBest, OfSizesThatDifferByRoundingTheGreaterObjectiveIsBestAndOtherKeysAreTold) {
  const Workplace place;
  const test::QueuedTasks tasks(place, "db", 3);
  sweep::Store store = tasks.open();
  const std::array sizes_mm{59.99999999999447, 60.0, 60.001};
  const std::array merits{0.94, 0.96, 0.97};
  for (std::size_t k = 0; k < sizes_mm.size(); ++k) {
    sweep::TaskResult result = test::made_result(merits[k]);
    result.designs.front().push_back(
        {.item = "", .quantity = "ring_root_diameter_mm", .unit = "mm", .value = sizes_mm[k]});
    store.finish(store.claim(tasks.run, sweep::this_process(), 0.0)->id, result, {});
  }
  const auto best = [&](std::vector<std::string> by) {
    return sweep::best_of(store.database(),
                          {.by = std::move(by), .of = "ring_root_diameter_mm", .least = true});
  };
  const sweep::Rows one = best({"planets"});
  ASSERT_EQ(one.rows.size(), 1U);
  const auto merit = std::ranges::find(one.names, "merit") - one.names.begin();
  EXPECT_EQ(sweep::text_of(one.rows[0][static_cast<std::size_t>(merit)]), "0.96");
  EXPECT_EQ(one.names.back(), "key") << "one row differs from none";
  const sweep::Rows by_size = best({"ring_root_diameter_mm"});
  ASSERT_EQ(by_size.rows.size(), 3U);
  EXPECT_EQ(by_size.names.back(), "friction.coefficient");
}

TEST(SweepBest, TasksOfRunsThatDifferInWhatIsNotToldAreSaidToAndOneRunCanBeAsked) {
  const Workplace place;
  const std::string path = place.file("db").string();
  sweep::Store store(sweep::open_sweep_database(path, Database::Access::kCreate));
  std::vector<std::int64_t> runs;
  for (const char* friction : {"0.06", "0.1"}) {
    place.write("sweep.toml", test::kSmallTask + "planets = 4\nfriction.coefficient = " + friction +
                                  "\n[vary]\nratio.target = [40.0, 40.1]\n");
    const sweep::Sweep sweep = sweep::read_sweep(place.file("sweep.toml").string());
    runs.push_back(store.begin(
        {.uid = friction, .workers = 1, .shard = {}, .started_s = 0.0, .host = "here"}, sweep));
    sweep::Planned planned;
    store.plan(runs.back(), sweep, {}, 0, planned);
    store.end_plan();
    for (int k = 0; k < 2; ++k) {
      const auto claimed = store.claim(runs.back(), sweep::this_process(), 0.0);
      store.finish(claimed->id, test::made_result(runs.size() == 1 ? 0.9 : 0.8), {});
    }
  }
  const Database& database = store.database();
  const auto merits = [&](const sweep::AskedTasks& tasks) {
    const sweep::Rows rows = sweep::best_of(
        database, {.tasks = tasks, .by = {"ratio.target"}, .of = "merit", .least = false});
    EXPECT_EQ(std::ranges::count(rows.names, "merit"), 1);
    const auto merit = std::ranges::find(rows.names, "merit") - rows.names.begin();
    std::string text;
    for (const auto& row : rows.rows) {
      text += sweep::text_of(row[static_cast<std::size_t>(merit)]) + " ";
    }
    return text;
  };
  EXPECT_EQ(merits({}), "0.9 0.9 ");
  EXPECT_EQ(merits({.run = runs[0]}), "0.9 0.9 ");
  EXPECT_EQ(merits({.run = runs[1]}), "0.8 0.8 ");
  const std::string message = refusal_of([&] { merits({.run = 7}); });
  EXPECT_NE(message.find(": no run 7: allowed: a number in the column run"), std::string::npos);

  const std::string pooled = sweep::pooled_text(database, {}, {"ratio.target"});
  EXPECT_NE(pooled.find(
                "2 runs are asked together, and differ in what is not shown: friction.coefficient "
                "(0.06, 0.1); --run N"),
            std::string::npos)
      << pooled;
  EXPECT_EQ(sweep::pooled_text(database, {}, {"ratio.target", "friction.coefficient"}), "");
  EXPECT_EQ(sweep::pooled_text(database, {.run = runs[1]}, {"ratio.target"}), "");
}

TEST(SweepBest, RanksByTheObjectiveOfTheTasksAndSaysSo) {
  const Workplace place;
  sweep::Store store(
      sweep::open_sweep_database(place.file("db").string(), Database::Access::kCreate));
  // Of the two tasks of a run the one of less eta_b has the greater merit and eta_f.
  const auto run_of = [&](const std::string& objective) {
    place.write("sweep.toml", test::kSmallTask + "planets = 4\n" + objective +
                                  "[vary]\nratio.target = [40.0, 40.1]\n");
    const sweep::Sweep sweep = sweep::read_sweep(place.file("sweep.toml").string());
    const std::int64_t run = store.begin(
        {.uid = objective, .workers = 1, .shard = {}, .started_s = 0.0, .host = "here"}, sweep);
    sweep::Planned planned;
    store.plan(run, sweep, {}, 0, planned);
    store.end_plan();
    for (const double eta_b : {0.6, 0.7}) {
      sweep::TaskResult result = test::made_result(eta_b);
      result.merit = 1.0 - eta_b;
      result.designs.front().push_back(
          {.item = "", .quantity = "eta_f", .unit = "", .value = 1.5 - eta_b});
      store.finish(store.claim(run, sweep::this_process(), 0.0)->id, result, {});
    }
    return run;
  };
  const Database& database = store.database();
  const auto best_eta_b = [&](std::optional<std::int64_t> run, std::vector<std::string> by) {
    const sweep::Rows rows = sweep::best_of(database, {.tasks = {.run = run}, .by = std::move(by)});
    const auto k = std::ranges::find(rows.names, "eta_b") - rows.names.begin();
    std::string text;
    for (const auto& row : rows.rows)
      text += sweep::text_of(row[static_cast<std::size_t>(k)]) + ' ';
    return text;
  };
  const auto said = [&](std::optional<std::int64_t> run, const std::vector<std::string>& by) {
    return sweep::ranking_of(database, {.run = run}, by).text;
  };
  const std::int64_t backward = run_of("");
  EXPECT_EQ(best_eta_b(backward, {}), "0.7 ");
  EXPECT_EQ(said(backward, {}), "");
  const std::int64_t forward = run_of("objective = \"forward_efficiency\"\n");
  EXPECT_EQ(best_eta_b(forward, {}), "0.6 ");
  EXPECT_NE(said(forward, {}).find("ranked by eta_f, of the objective forward_efficiency"),
            std::string::npos);
  const std::int64_t error = run_of("objective = \"ratio_error\"\n");
  EXPECT_EQ(best_eta_b(error, {}), "0.6 ");
  EXPECT_NE(said(error, {}).find("ranked by merit, of the objective ratio_error of the tasks; "
                                 "--most NAME or --least NAME"),
            std::string::npos);
  EXPECT_EQ(best_eta_b(std::nullopt, {}), "0.7 ");
  EXPECT_NE(said(std::nullopt, {})
                .find("ranked by eta_b, as the tasks have several objectives (backward_efficiency, "
                      "forward_efficiency, ratio_error)"),
            std::string::npos);
  EXPECT_EQ(best_eta_b(std::nullopt, {"objective"}), "0.6 0.6 0.6 ") << "by merit, 1 - eta_b";
}

TEST(SweepBest, WhatIsVariedIsNoDifferenceOfRuns) {
  const Workplace place;
  const test::QueuedTasks tasks(place, "db", 3);
  sweep::Store store = tasks.open();
  for (int k = 0; k < 3; ++k) {
    store.finish(store.claim(tasks.run, sweep::this_process(), 0.0)->id, test::made_result(0.9),
                 {});
  }
  EXPECT_EQ(sweep::pooled_text(store.database(), {}, {"planets"}), "");
}

}  // namespace
}  // namespace gear3k::questions_test
