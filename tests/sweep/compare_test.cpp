#include "sweep/compare.hpp"

#include <cmath>

#include "sweep/model_revision.hpp"
#include "tests/sweep/small_sweep.hpp"

namespace gear3k::compare_test {
namespace {

using sweep::Change, sweep::change_of;
using test::refusal_of, test::Workplace;

/// A run of four tasks, three ratios of which are known by name, recorded at a time.
struct Runs {
  explicit Runs(const Workplace& workplace) : place(workplace) {}

  /// @param results  merit by task, NaN = no feasible design
  void add(const std::string& uid, const std::string& keys, double time_s,
           const std::vector<double>& results) {
    place.write("sweep.toml",
                test::kSmallTask + keys +
                    "[vary]\nratio.target = [40.0, 41.0, 42.0, 43.0]\nplanets = [4]\n");
    const sweep::Sweep sweep = sweep::read_sweep(place.file("sweep.toml").string());
    sweep::Store store(sweep::open_sweep_database(path(), sweep::Database::Access::kCreate));
    const std::int64_t run = store.begin(
        {.uid = uid, .workers = 1, .shard = {}, .started_s = time_s, .host = "here"}, sweep);
    sweep::Planned planned;
    store.plan(run, sweep, {}, 0, planned);
    store.end_plan();
    for (const double merit : results) {
      const auto claimed = store.claim(run, sweep::this_process(), time_s);
      sweep::TaskResult result = test::made_result(merit);
      if (std::isnan(merit)) {
        result = {};
        result.status = sweep::TaskStatus::kNoFeasibleDesign;
        result.reason = "blocked by planet_gap";
      }
      store.finish(claimed->id, result,
                   {.run = uid, .host = "here", .finished_s = time_s, .cpu_s = 0.1});
    }
  }
  [[nodiscard]] std::string path() const { return place.file("db").string(); }
  [[nodiscard]] sweep::Database database() const {
    return sweep::open_sweep_database(path(), sweep::Database::Access::kWrite);
  }

  const Workplace& place;
};

constexpr double kDay = 86400.0;
const double kNone = std::nan("");

TEST(SweepCompare, JudgesAChange) {
  EXPECT_EQ(change_of("optimal", 0.9, "optimal", 0.9 + 1e-8), Change::kSame);
  EXPECT_EQ(change_of("optimal", 0.9, "optimal", 0.91), Change::kBetter);
  // Of a mass merits are negative: lighter is better.
  EXPECT_EQ(change_of("optimal", -0.9, "optimal", -0.91), Change::kWorse);
  EXPECT_EQ(change_of("optimal", 0.9, "no_feasible_design", kNone), Change::kNewlyInfeasible);
  EXPECT_EQ(change_of("failed", kNone, "optimal", 0.9), Change::kNewlyFeasible);
  EXPECT_EQ(change_of("invalid", kNone, "no_feasible_design", kNone), Change::kSame);
}

TEST(SweepCompare, FindsWhatAKeyChangedSinceADay) {
  const Workplace place;
  Runs runs(place);
  // The days 10 and 20 after 1970-01-01.
  runs.add("first", "friction.coefficient = 0.1\n", 10 * kDay, {0.8, 0.7, 0.6, kNone});
  runs.add("second", "friction.coefficient = 0.08\n", 20 * kDay, {0.9, 0.7, kNone, 0.5});
  const sweep::Database database = runs.database();
  const sweep::Comparison comparison =
      sweep::compare(database, sweep::since_of("1970-01-15").value());
  EXPECT_EQ(sweep::counts_text(comparison),
            "1 better, 0 worse, 1 newly feasible, 1 newly infeasible, 1 the same; 0 without a "
            "result before, 0 without one since\n");
  ASSERT_EQ(comparison.changes.rows.size(), 3U);
  const auto& worse = comparison.changes.rows[2];
  EXPECT_EQ(std::get<std::string>(worse[0]), "newly_infeasible");
  EXPECT_EQ(std::get<std::string>(worse[1]), "ratio.target = 42, planets = 4");
  EXPECT_EQ(std::get<std::string>(worse[4]), "friction.coefficient 0.1 -> 0.08");
  EXPECT_EQ(std::get<std::string>(worse[5]), "blocked by planet_gap");
  EXPECT_TRUE(comparison.any_worse());
  // Before the first day there is nothing, after the last nothing either.
  EXPECT_EQ(sweep::compare(database, sweep::since_of("1970-01-02").value()).only_after, 8);
  EXPECT_EQ(sweep::compare(database, sweep::since_of("1971-01-02").value()).only_before, 8);
}

TEST(SweepCompare, FindsWhatARevisionChanged) {
  const Workplace place;
  Runs runs(place);
  runs.add("first", "friction.coefficient = 0.1\n", 10 * kDay, {0.8, 0.7, 0.6, kNone});
  {
    // As if they were of the revision before: another key, the same question.
    sweep::Database database = runs.database();
    database.execute("UPDATE task SET revision = revision - 1, key = 'old' || id");
  }
  runs.add("second", "friction.coefficient = 0.1\n", 20 * kDay, {0.8, 0.65, 0.6, kNone});
  const sweep::Database database = runs.database();
  const std::string before = std::to_string(sweep::kModelRevision - 1);
  const sweep::Comparison comparison = sweep::compare(database, sweep::since_of(before).value());
  ASSERT_EQ(comparison.changes.rows.size(), 1U);
  EXPECT_EQ(comparison.same, 3);
  EXPECT_EQ(std::get<std::string>(comparison.changes.rows[0][0]), "worse");
  EXPECT_EQ(std::get<std::string>(comparison.changes.rows[0][4]),
            "revision " + before + " -> " + std::to_string(sweep::kModelRevision));
}

TEST(SweepCompare, RefusesWhatIsNeitherARevisionNorATime) {
  const Workplace place;
  for (const char* text : {"yesterday", "", "2026-13-01", "0x1", "-1", "1e-5", "now", "24-01-01"}) {
    EXPECT_FALSE(sweep::since_of(text)) << text;
  }
  EXPECT_EQ(sweep::since_of("3").value().revision, 3);
  Runs runs(place);
  runs.add("open", "friction.coefficient = 0.1\n", kDay, {});
  const sweep::Database database = runs.database();
  const sweep::Since day = sweep::since_of("1970-01-02").value();
  EXPECT_NE(refusal_of([&] { sweep::compare(database, day); }).find("no task has a result"),
            std::string::npos);
  runs.add("first", "friction.coefficient = 0.1\n", kDay, {0.8});
  const auto compared = [&](std::int64_t revision) {
    return refusal_of(
        [&] { sweep::compare(database, {.revision = revision, .time_s = std::nullopt}); });
  };
  EXPECT_EQ(compared(sweep::kModelRevision), "");
  EXPECT_NE(compared(sweep::kModelRevision + 1).find("no result is of a revision"),
            std::string::npos);
}

}  // namespace
}  // namespace gear3k::compare_test
