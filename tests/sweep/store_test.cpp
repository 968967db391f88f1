#include "sweep/store.hpp"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <set>

#include "sweep/merge.hpp"
#include "sweep/questions.hpp"
#include "tests/sweep/small_sweep.hpp"

namespace gear3k::store_test {
namespace {

using sweep::Database, sweep::Process, sweep::Store;
using test::made_result, test::QueuedTasks, test::refusal_of, test::Workplace;

const Process kOfAnotherMachine{.host = "elsewhere", .number = 7, .began = 7};

sweep::Provenance provenance() {
  return {.run = "run", .host = "here", .finished_s = 1.0, .cpu_s = 0.5};
}

/// A process of this machine that has ended.
Process dead_process() {
  const pid_t child = ::fork();
  if (child == 0) {
    ::pause();
    ::_exit(0);
  }
  Process process = sweep::process_of(child);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  return process;
}

TEST(Store, GivesEveryTaskToOneWorker) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 20);
  Store store = tasks.open();
  EXPECT_EQ(tasks.planned.asked, 20U);
  std::set<std::int64_t> ids;
  for (int k = 0; k < 20; ++k) {
    const auto claimed = store.claim(tasks.run, sweep::this_process(), 0.0);
    ASSERT_TRUE(claimed);
    ids.insert(claimed->id);
  }
  EXPECT_EQ(ids.size(), 20U);
  EXPECT_FALSE(store.claim(tasks.run, sweep::this_process(), 0.0));
}

TEST(Store, GivesATaskAgainWhenItsLeaseEndsOrItsProcessIsDead) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 1);
  Store store = tasks.open();
  const Process self = sweep::this_process();
  ASSERT_TRUE(store.claim(tasks.run, kOfAnotherMachine, 100.0));
  // Of another machine nothing is known but the time.
  EXPECT_FALSE(store.claim(tasks.run, self, 100.0 + sweep::kLeaseSeconds - 1.0));
  store.renew({kOfAnotherMachine}, 200.0);
  EXPECT_FALSE(store.claim(tasks.run, self, 200.0 + sweep::kLeaseSeconds - 1.0));
  ASSERT_TRUE(store.claim(tasks.run, dead_process(), 200.0 + sweep::kLeaseSeconds + 1.0));
  // This one is of this machine, and dead: at once.
  const auto again = store.claim(tasks.run, self, 200.0 + sweep::kLeaseSeconds + 1.0);
  ASSERT_TRUE(again);
  store.release(again->id, kOfAnotherMachine);
  EXPECT_FALSE(store.claim(tasks.run, self, 0.0)) << "given back by one that does not hold it";
  store.release(again->id, self);
  EXPECT_TRUE(store.claim(tasks.run, self, 0.0));
}

TEST(Store, GivesNoTaskOfALivingProcessOfThisMachineToAnother) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 1);
  Store store = tasks.open();
  ASSERT_TRUE(store.claim(tasks.run, sweep::this_process(), 0.0));
  // The clock was set, or the machine slept: the lease has ended, and nobody has renewed it.
  const double later_s = 100.0 * sweep::kLeaseSeconds;
  EXPECT_FALSE(store.claim(tasks.run, kOfAnotherMachine, later_s));
}

TEST(Store, RecordsATaskOnce) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 1);
  Store store = tasks.open();
  const auto claimed = store.claim(tasks.run, kOfAnotherMachine, 0.0);
  ASSERT_TRUE(claimed);
  EXPECT_TRUE(store.finish(claimed->id, made_result(0.5), provenance()));
  EXPECT_FALSE(store.finish(claimed->id, made_result(0.7), provenance()));
  EXPECT_EQ(store.database().count("SELECT count(*) FROM design"), 5);
  EXPECT_EQ(std::get<double>(store.database().one("SELECT merit FROM task")), 0.5);
  EXPECT_EQ(store.open_tasks(tasks.run), 0);
}

TEST(Store, ATaskThatCrashesItsWorkerThreeTimesHasFailed) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 1);
  Store store = tasks.open();
  const Process worker = kOfAnotherMachine;
  // Workers that were asked to end do not count.
  for (int k = 0; k < 2 * sweep::kMostKills; ++k) {
    ASSERT_TRUE(store.claim(tasks.run, worker, 0.0));
    store.bury(worker, {}, provenance());
  }
  for (int k = 0; k < sweep::kMostCrashes; ++k) {
    ASSERT_TRUE(store.claim(tasks.run, worker, 0.0)) << k;
    store.bury(worker, {.signal = SIGSEGV, .crash = true}, provenance());
  }
  EXPECT_FALSE(store.claim(tasks.run, worker, 0.0));
  EXPECT_EQ(std::get<std::string>(store.database().one("SELECT status FROM task")), "failed");
  EXPECT_EQ(std::get<std::string>(store.database().one("SELECT reason FROM task")),
            "the program ended by signal 11 each of 3 times");
}

TEST(Store, ATaskWhoseWorkersAreKilledFiveTimesHasFailed) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 1);
  {
    // A database of before: nobody counted.
    Store store = tasks.open();
    store.database().execute("ALTER TABLE queue DROP COLUMN kills");
  }
  Store store = tasks.open();
  // A crash does not make it fewer or more.
  ASSERT_TRUE(store.claim(tasks.run, kOfAnotherMachine, 0.0));
  store.bury(kOfAnotherMachine, {.signal = SIGSEGV, .crash = true}, provenance());
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(store.claim(tasks.run, kOfAnotherMachine, 0.0)) << k;
    store.bury(kOfAnotherMachine, {.signal = SIGKILL}, provenance());
  }
  EXPECT_FALSE(store.claim(tasks.run, kOfAnotherMachine, 0.0));
  EXPECT_EQ(std::get<std::string>(store.database().one("SELECT status FROM task")), "failed");
  EXPECT_EQ(std::get<std::string>(store.database().one("SELECT reason FROM task")),
            "killed by signal 9, 5 times");
}

TEST(Store, StatusCountsThoseWhoLive) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 5);
  Store store = tasks.open();
  const double now_s = static_cast<double>(std::time(nullptr));
  ASSERT_TRUE(store.claim(tasks.run, sweep::this_process(), now_s));
  ASSERT_TRUE(store.claim(tasks.run, kOfAnotherMachine, now_s));
  // One is dead, of another one nothing was heard for long.
  Process silent = kOfAnotherMachine;
  ++silent.number;
  ASSERT_TRUE(store.claim(tasks.run, silent, now_s - 2.0 * sweep::kLeaseSeconds));
  const auto working = [&] {
    const sweep::Rows rows = sweep::status_of(store.database());
    const auto column = std::ranges::find(rows.names, "working") - rows.names.begin();
    return std::get<std::int64_t>(rows.rows.at(0).at(static_cast<std::size_t>(column)));
  };
  EXPECT_EQ(working(), 2);
  ASSERT_TRUE(store.claim(tasks.run, dead_process(), now_s));
  EXPECT_EQ(working(), 2);
}

TEST(Store, MergeTakesEveryResultOnce) {
  const Workplace place;
  const QueuedTasks first(place, "first", 4);
  const QueuedTasks second(place, "second", 6);
  {
    Store store = first.open();
    while (const auto claimed = store.claim(first.run, sweep::this_process(), 0.0)) {
      store.finish(claimed->id, made_result(0.5), provenance());
    }
    // Both runs are calls of their own.
    store.database().execute("UPDATE run SET uid = 'another'");
  }
  {
    Store store = second.open();
    store.finish(store.claim(second.run, sweep::this_process(), 0.0)->id, made_result(0.7),
                 provenance());
  }
  Database into =
      sweep::open_sweep_database(place.file("into").string(), Database::Access::kCreate);
  // 0.001 is the first value of both sweeps; the later values differ.
  sweep::Merged merged = sweep::merge(into, first.path);
  EXPECT_EQ(merged.added, 4);
  merged = sweep::merge(into, second.path);
  EXPECT_EQ(merged.added, 0);
  EXPECT_EQ(merged.differing, 1);
  EXPECT_EQ(merged.open, 5);
  for (const std::string& path : {first.path, second.path}) {
    merged = sweep::merge(into, path);
    EXPECT_EQ(merged.added, 0);
  }
  EXPECT_EQ(into.count("SELECT count(*) FROM run"), 2);
  EXPECT_EQ(into.count("SELECT count(*) FROM task WHERE status IS NOT NULL"), 4);
  EXPECT_EQ(into.count("SELECT count(*) FROM design"), 20);
  EXPECT_EQ(into.count("SELECT count(*) FROM result WHERE merit = 0.5"), 4);
}

TEST(Store, MergeTakesWhatARunHasBecomeSinceItWasMerged) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 3);
  tasks.open().database().execute("UPDATE run SET tasks = 1");  // as while it was planned
  Database into =
      sweep::open_sweep_database(place.file("into").string(), Database::Access::kCreate);
  sweep::merge(into, tasks.path);
  tasks.open().database().execute("UPDATE run SET tasks = 3");
  tasks.open().end(tasks.run, 7.0);
  sweep::merge(into, tasks.path);
  EXPECT_EQ(into.count("SELECT count(*) FROM run WHERE tasks = 3 AND ended = 7.0"), 1);
  // What was there is not lost by a copy of before.
  tasks.open().database().execute("UPDATE run SET tasks = 1, ended = NULL");
  sweep::merge(into, tasks.path);
  EXPECT_EQ(into.count("SELECT count(*) FROM run WHERE tasks = 3 AND ended = 7.0"), 1);
}

TEST(Store, MergeTakesADatabaseAsItIsAtOneMoment) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 1);
  place.write("more.toml", test::kSmallTask +
                               "planets = 4\nratio.target = 40.0\n[vary]\nfriction.coefficient = { "
                               "min = 0.0001, max = 0.2, step = 0.0001 }\n");
  // Tasks and their keys come in blocks while they are read.
  const pid_t planner = ::fork();
  if (planner == 0) {
    const sweep::Sweep sweep = sweep::read_sweep(place.file("more.toml").string());
    Store store = tasks.open();
    const std::int64_t run = store.begin(
        {.uid = "more", .workers = 1, .shard = {}, .started_s = 0.0, .host = "here"}, sweep);
    sweep::Planned planned;
    for (std::uint64_t at = 0; at < sweep.count();) at = store.plan(run, sweep, {}, at, planned);
    ::_exit(0);
  }
  std::vector<std::int64_t> sizes;
  for (int status = -1; ::waitpid(planner, &status, WNOHANG) == 0;) {
    const std::string name = "into" + std::to_string(sizes.size());
    Database into =
        sweep::open_sweep_database(place.file(name).string(), Database::Access::kCreate);
    sweep::merge(into, tasks.path);
    // Every task has keys and a run.
    sizes.push_back(into.count("SELECT count(*) FROM task"));
    EXPECT_EQ(into.count("SELECT count(DISTINCT task) FROM task_key"), sizes.back());
    EXPECT_EQ(into.count("SELECT count(DISTINCT task) FROM run_task"), sizes.back());
  }
  EXPECT_FALSE(sizes.empty());
  EXPECT_TRUE(std::ranges::is_sorted(sizes));
}

TEST(SweepDatabase, RefusesWhatIsNoneOfItsOwnAndLeavesItAsItIs) {
  const Workplace place;
  const auto refused = [&](const std::string& name) {
    const std::string before = place.read(name);
    const std::string message = refusal_of(
        [&] { sweep::open_sweep_database(place.file(name).string(), Database::Access::kCreate); });
    EXPECT_EQ(place.read(name), before) << name;
    return message.substr(std::min(message.size(), place.file(name).string().size()));
  };
  place.write("text", std::string(5000, 'x'));
  EXPECT_EQ(refused("text"),
            ": is no SQLite database; nothing was changed: allowed: a file that gear3k sweep made, "
            "or a new name");
  {
    Database other(place.file("other").string(), Database::Access::kCreate);
    other.execute("CREATE TABLE music(title)");
  }
  EXPECT_EQ(refused("other"),
            ": is a database of another program; nothing was changed: allowed: a file that gear3k "
            "sweep made, or a new name");
  {
    Database newer =
        sweep::open_sweep_database(place.file("newer").string(), Database::Access::kCreate);
    newer.execute("PRAGMA journal_mode = DELETE; PRAGMA user_version = 2");
  }
  EXPECT_EQ(refused("newer"),
            ": its tables are of schema 2, of a newer gear3k; nothing was changed: allowed: schema "
            "1, or the newer program");
  place.write("empty", "");
  const std::string empty = place.file("empty").string();
  EXPECT_EQ(refusal_of([&] { sweep::open_sweep_database(empty, Database::Access::kRead); }),
            empty + ": is empty: allowed: a file that gear3k sweep made");
  EXPECT_NE(refusal_of([&] {
              sweep::open_sweep_database(place.file("none").string(), Database::Access::kRead);
            }).find("is not there"),
            std::string::npos);
}

TEST(SweepDatabase, ADamagedOneIsToldAndNotWritten) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 50);
  tasks.open().database().execute("PRAGMA wal_checkpoint(TRUNCATE)");
  std::string bytes = place.read("db");
  // All pages but the first, which says that it is a database.
  for (std::size_t k = 4096; k < bytes.size(); ++k) bytes[k] = 'x';
  place.write("db", bytes);
  const std::string message =
      refusal_of([&] { tasks.open().claim(tasks.run, sweep::this_process(), 0.0); });
  EXPECT_NE(message.find("is damaged; nothing was changed"), std::string::npos) << message;
  EXPECT_TRUE(place.read("db") == bytes);
}

TEST(SweepDatabase, AFullOneKeepsWhatWasRecorded) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 200);
  Store store = tasks.open();
  store.database().execute("PRAGMA max_page_count = " +
                           std::to_string(store.database().count("PRAGMA page_count") + 4));
  int recorded = 0;
  std::string message;
  while (message.empty()) {
    message = refusal_of([&] {
      const auto claimed = store.claim(tasks.run, sweep::this_process(), 0.0);
      store.finish(claimed->id, made_result(0.5), provenance());
      ++recorded;
    });
  }
  EXPECT_GT(recorded, 0);
  EXPECT_NE(message.find("is full; what was recorded is kept: allowed: make room"),
            std::string::npos)
      << message;
  Store again = tasks.open();
  EXPECT_EQ(again.database().count("SELECT count(*) FROM task WHERE status IS NOT NULL"), recorded);
  EXPECT_EQ(again.database().count("SELECT count(*) FROM design"), 5 * recorded);
  EXPECT_EQ(again.open_tasks(tasks.run), 200 - recorded);
  EXPECT_EQ(std::get<std::string>(again.database().one("PRAGMA integrity_check")), "ok");
}

/// What `told` returns to somebody who may read the place and write nothing in it: root writes all
/// the same.
template <class Told>
std::string as_a_mere_reader(const Workplace& place, Told told) {
  ::chmod(place.work().c_str(), 0555);
  ::chmod(place.work().parent_path().c_str(), 0755);
  int ends[2];
  if (::pipe(ends) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    if (::getuid() == 0 && ::setuid(65534) != 0) ::_exit(1);
    const std::string message = told();
    const auto written = ::write(ends[1], message.data(), message.size());
    ::_exit(written == static_cast<ssize_t>(message.size()) ? 0 : 1);
  }
  ::close(ends[1]);
  std::string message;
  char c = 0;
  while (::read(ends[0], &c, 1) == 1) message += c;
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  ::chmod(place.work().c_str(), 0755);
  EXPECT_EQ(status, 0);
  return message;
}

TEST(SweepDatabase, AReadOnlyOneIsToldBeforeAnythingIsDone) {
  const Workplace place;
  const QueuedTasks tasks(place, "db", 1);
  tasks.open().database().execute("PRAGMA journal_mode = DELETE");
  ::chmod(tasks.path.c_str(), 0444);
  const std::string message =
      as_a_mere_reader(place, [&] { return refusal_of([&] { static_cast<void>(tasks.open()); }); });
  EXPECT_NE(message.find("cannot be written: it is read-only; nothing was changed"),
            std::string::npos)
      << message;
}

TEST(SweepDatabase, IsReadWhereNothingCanBeWritten) {
  const Workplace place;
  const QueuedTasks tasks(place, "as%20 it?is#", 7);
  const auto counted = [&] {
    std::string text;
    const std::string refusal = refusal_of([&] {
      const Database database = open_sweep_database(tasks.path, Database::Access::kRead);
      text = std::to_string(database.count("SELECT count(*) FROM task"));
    });
    return text + refusal;
  };
  EXPECT_EQ(as_a_mere_reader(place, counted), "7");
  EXPECT_FALSE(std::filesystem::exists(tasks.path + "-shm"));

  // What is in the log alone would be passed over: a run that was killed, its shared memory lost.
  const std::string copy = (place.work() / "copy").string();
  Store store = tasks.open();
  ASSERT_TRUE(store.claim(tasks.run, sweep::this_process(), 0.0));
  std::filesystem::copy_file(tasks.path, copy);
  std::filesystem::copy_file(tasks.path + "-wal", copy + "-wal");
  const std::string message = as_a_mere_reader(place, [&] {
    return refusal_of([&] {
      const Database database = open_sweep_database(copy, Database::Access::kRead);
      static_cast<void>(database.count("SELECT count(*) FROM task"));
    });
  });
  EXPECT_NE(message.find("a folder in which files may be made beside it"), std::string::npos)
      << message;
}

TEST(SweepDatabase, ManyWritersWaitForEachOther) {
  const Workplace place;
  constexpr int kTasks = 160, kWriters = 16;
  const QueuedTasks tasks(place, "db", kTasks);
  std::vector<pid_t> writers;
  for (int k = 0; k < kWriters; ++k) {
    writers.push_back(::fork());
    if (writers.back() != 0) continue;
    const std::string message = refusal_of([&] {
      Store store = tasks.open();
      while (const auto claimed = store.claim(tasks.run, sweep::this_process(), 0.0)) {
        store.finish(claimed->id, made_result(0.5), provenance());
      }
    });
    ::_exit(message.empty() ? 0 : 1);
  }
  for (const pid_t writer : writers) {
    int status = -1;
    ::waitpid(writer, &status, 0);
    EXPECT_EQ(status, 0);
  }
  Store store = tasks.open();
  EXPECT_EQ(store.database().count("SELECT count(*) FROM provenance"), kTasks);
  EXPECT_EQ(store.database().count("SELECT count(*) FROM design"), 5 * kTasks);
  EXPECT_EQ(store.open_tasks(tasks.run), 0);
}

}  // namespace
}  // namespace gear3k::store_test
