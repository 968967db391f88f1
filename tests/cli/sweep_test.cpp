// gear3k sweep: what is recorded, whatever happens to its workers.

#include <random>

#include "sweep/model_revision.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/sample.hpp"
#include "tests/sweep/small_sweep.hpp"

namespace gear3k::sweep_test {
namespace {

using std::chrono::milliseconds;
using test::kSmallSweep, test::kSmallTask, test::ProgramResult, test::RunningProgram,
    test::Workplace;

/// All that does not say when, where and by whom.
std::string content_of(const Workplace& place, const std::string& database) {
  std::string content;
  for (const char* sql :
       {"SELECT * FROM result ORDER BY key",
        "SELECT t.key, d.* FROM design d JOIN task t ON t.id = d.task ORDER BY t.key, rank",
        "SELECT t.key, r.status, r.reason, r.sets FROM refusal r JOIN task t ON t.id = r.task "
        "ORDER BY 1, 2, 3",
        "SELECT key, spec, best FROM task ORDER BY key"}) {
    std::string text(sql);
    // The ids are those of the order in which tasks came.
    if (text.find("d.*") != std::string::npos) text.replace(text.find("d.*"), 3, "d.eta_b, d.xS");
    const ProgramResult result = place.run({"sweep", "query", database, text, "--format", "csv"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    content += result.out;
  }
  return content;
}

std::int64_t number_of(const Workplace& place, const std::string& database,
                       const std::string& sql) {
  return std::stoll(place.run({"sweep", "query", database, sql}).out);
}

/// Until three tasks of a database are done.
void wait_for_three(const Workplace& place, const std::string& database) {
  while (!place.has(database) ||
         place.run({"sweep", "query", database, "SELECT count(*) > 2 FROM provenance"}).out !=
             "1\n") {
    std::this_thread::sleep_for(milliseconds(20));
  }
}

/// Processes whose parent is one, by /proc.
std::vector<pid_t> children_of(pid_t parent) {
  std::ifstream list("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) +
                     "/children");
  std::vector<pid_t> children;
  for (pid_t child = 0; list >> child;) children.push_back(child);
  return children;
}

/// 10 tasks of some hundredths of a second.
std::string many_tasks() {
  return kSmallTask +
         "planets = 4\nratio.target = 40.0\n[vary]\nfriction.coefficient = { min = 0.02, max = "
         "0.065, step = 0.005 }\n";
}

std::string one_task() {
  return kSmallTask + "friction.coefficient = 0.1\nplanets = 4\n[vary]\nratio.target = [40.0]\n";
}

TEST(Sweep, RecordsDesignsAndReasonsAndComputesNothingTwice) {
  const Workplace place;
  place.write("sweep.toml", kSmallSweep);
  const ProgramResult first = place.run({"sweep", "sweep.toml", "--out", "db", "--format", "csv"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(number_of(place, "db", "SELECT count(*) FROM task WHERE status = 'optimal'"), 2);
  EXPECT_EQ(number_of(place, "db", "SELECT count(*) FROM task WHERE status = 'no_feasible_design'"),
            6);
  EXPECT_EQ(
      number_of(place, "db", "SELECT count(*) FROM task WHERE status <> 'optimal' AND reason = ''"),
      0);
  // Another file of the same tasks, in another order and with a default stated.
  place.write("again.toml", kSmallTask + R"(solver.seed = 1
[vary]
friction.coefficient = { min = 0.06, max = 0.1, count = 2 }
planets = [9, 4]
ratio.target = [44, 40]
)");
  const ProgramResult second = place.run({"sweep", "again.toml", "--out", "db"});
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_NE(second.err.find("8 tasks, 8 of them known"), std::string::npos) << second.err;
  EXPECT_EQ(number_of(place, "db", "SELECT count(*) FROM provenance"), 8);
  EXPECT_EQ(number_of(place, "db", "SELECT count(DISTINCT run) FROM provenance"), 1);
}

TEST(Sweep, TheBestIsThatOfOptimize) {
  const Workplace place;
  place.write("sweep.toml", one_task());
  ASSERT_EQ(place.run({"sweep", "sweep.toml", "--out", "db"}).exit_code, 0);
  place.write("spec.toml", place.run({"sweep", "query", "db", "SELECT spec FROM task"}).out);
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--certify", "--out", "opt"}).exit_code, 0);
  EXPECT_EQ(place.run({"sweep", "query", "db", "SELECT best FROM task"}).out,
            place.read("opt/best.toml"));
}

TEST(Sweep, EndsWhereTheLauncherIgnoresEndsOfChildren) {
  const Workplace place;
  place.write("sweep.toml", one_task());
  const std::string line = "cd '" + place.file("").string() +
                           "' && timeout --signal=KILL 60 env --ignore-signal=CHLD '" +
                           GEAR3K_PROGRAM + "' sweep sweep.toml --out db --quiet";
  EXPECT_EQ(std::system(line.c_str()), 0);
  EXPECT_EQ(number_of(place, "db", "SELECT count(*) FROM task WHERE status = 'optimal'"), 1);
}

TEST(Sweep, AnInvalidTaskIsAResult) {
  const Workplace place;
  place.write("sweep.toml", kSmallTask +
                                "planets = 4\nratio.target = 44.0\nfriction.coefficient = 0.1\n"
                                "[vary]\nbacklash.min_output_arcmin = [20.0, 1.0]\n");
  ASSERT_EQ(place.run({"sweep", "sweep.toml", "--out", "db"}).exit_code, 0);
  const std::string reason =
      place.run({"sweep", "query", "db", "SELECT reason FROM task WHERE status = 'invalid'"}).out;
  EXPECT_NE(reason.find("backlash.min_output_arcmin = 20: allowed: at most max_output_arcmin = 12"),
            std::string::npos)
      << reason;
}

TEST(Sweep, ShardsMergedAreTheWhole) {
  const Workplace place;
  place.write("sweep.toml", kSmallSweep);
  ASSERT_EQ(place.run({"sweep", "sweep.toml", "--out", "whole", "--workers", "2"}).exit_code, 0);
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    ASSERT_EQ(
        place
            .run({"sweep", "sweep.toml", "--out", std::string("part") + shard[0], "--shard", shard})
            .exit_code,
        0);
  }
  for (int times = 0; times < 2; ++times) {
    ASSERT_EQ(place.run({"sweep", "merge", "part1", "part2", "part3", "--out", "merged"}).exit_code,
              0);
    EXPECT_EQ(content_of(place, "merged"), content_of(place, "whole"));
  }
}

TEST(Sweep, EachWorkerHasTheThreadsAskedForAndFindsTheSame) {
  const Workplace place;
  place.write("sweep.toml", many_tasks());
  ASSERT_EQ(place.run({"sweep", "sweep.toml", "--out", "one"}).exit_code, 0);
  RunningProgram program =
      place.start({"sweep", "sweep.toml", "--out", "three", "--threads", "3", "--quiet"});
  std::ptrdiff_t most = 0;
  std::optional<ProgramResult> end;
  while (!(end = program.wait(milliseconds(2)))) {
    for (const pid_t worker : children_of(program.number())) {
      std::error_code gone;
      const std::filesystem::directory_iterator threads("/proc/" + std::to_string(worker) + "/task",
                                                        gone);
      if (!gone)
        most = std::max(most, std::distance(begin(threads), std::filesystem::end(threads)));
    }
  }
  EXPECT_EQ(end->exit_code, 0) << end->err;
  EXPECT_EQ(most, 3);
  EXPECT_EQ(content_of(place, "three"), content_of(place, "one"));
}

TEST(Sweep, KilledWorkersLoseNothingAndRecordNothingTwice) {
  const Workplace place;
  place.write("sweep.toml", many_tasks());
  ASSERT_EQ(place.run({"sweep", "sweep.toml", "--out", "calm"}).exit_code, 0);
  const int moments = sample(6, 50);
  std::mt19937 random(1);
  int killed = 0;
  for (int run = 0; killed < moments; ++run) {
    const std::string database = "db" + std::to_string(run);
    RunningProgram program =
        place.start({"sweep", "sweep.toml", "--out", database, "--workers", "2", "--quiet"});
    std::optional<ProgramResult> end;
    while (!(end = program.wait(milliseconds(random() % 80)))) {
      const std::vector<pid_t> workers = children_of(program.number());
      if (workers.empty() || killed == moments) continue;
      ::kill(workers[random() % workers.size()], SIGKILL);
      ++killed;
    }
    ASSERT_EQ(end->exit_code, 0) << end->err;
    EXPECT_EQ(content_of(place, database), content_of(place, "calm"));
    EXPECT_EQ(number_of(place, database, "SELECT count(*) FROM provenance"), 10);
  }
}

TEST(Sweep, AKilledSweepGoesOnAtOnce) {
  const Workplace place;
  place.write("sweep.toml", many_tasks());
  RunningProgram program = place.start({"sweep", "sweep.toml", "--out", "db", "--workers", "2"});
  wait_for_three(place, "db");
  program.send(SIGKILL);
  ASSERT_EQ(program.wait(milliseconds(60'000))->signal, SIGKILL);
  const ProgramResult again = place.run({"sweep", "sweep.toml", "--out", "db"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(number_of(place, "db", "SELECT count(*) FROM provenance"), 10);
  EXPECT_EQ(number_of(place, "db", "SELECT count(*) FROM queue"), 0);
  ASSERT_EQ(place.run({"sweep", "sweep.toml", "--out", "calm"}).exit_code, 0);
  EXPECT_EQ(content_of(place, "db"), content_of(place, "calm"));
}

TEST(Sweep, CtrlCAndTheEndOfTimeKeepWhatIsDone) {
  const Workplace place;
  place.write("sweep.toml", many_tasks());
  {
    RunningProgram program = place.start({"sweep", "sweep.toml", "--out", "db"});
    wait_for_three(place, "db");
    program.send(SIGINT);
    const auto end = program.wait(milliseconds(60'000));
    ASSERT_TRUE(end);
    EXPECT_EQ(end->exit_code, 130);
    EXPECT_NE(end->err.find("as it was interrupted; the same command goes on"), std::string::npos)
        << end->err;
  }
  EXPECT_EQ(number_of(place, "db", "SELECT count(*) FROM queue WHERE process <> 0"), 0);
  const std::int64_t before = number_of(place, "db", "SELECT count(*) FROM provenance");
  EXPECT_GT(before, 2);
  const ProgramResult timed =
      place.run({"sweep", "sweep.toml", "--out", "timed", "--for", "0.2s", "--quiet"});
  EXPECT_EQ(timed.exit_code, 0) << timed.err;
  EXPECT_GT(number_of(place, "timed", "SELECT count(*) FROM queue"), 0);
}

TEST(Sweep, RefusesWhatCannotBeMeant) {
  const Workplace place;
  place.write("sweep.toml",
              kSmallTask +
                  "planets = 4\n[vary]\nratio.target = { min = 10, max = 1009, step = 1 "
                  "}\nfriction.coefficient = { min = 0.0001, max = 0.1, step = 0.0001 }\n");
  const ProgramResult million = place.run({"sweep", "sweep.toml", "--out", "db"});
  EXPECT_EQ(million.exit_code, 2);
  EXPECT_EQ(million.err,
            "sweep.toml: asks for 1000000 tasks: allowed: at most 100000, or more with --yes or a "
            "budget (--for 10h)\n");
  EXPECT_FALSE(place.has("db"));
  const auto usage = [&](const std::vector<std::string>& arguments) {
    const ProgramResult result = place.run(arguments);
    EXPECT_EQ(result.exit_code, 1) << result.err;
    return test::lines_of(result.err).front();
  };
  EXPECT_EQ(usage({"sweep", "sweep.toml", "--out", "db", "--shard", "5/4"}),
            "--shard: 5/4: allowed: i/n, 1 <= i <= n");
  for (const std::string time : {"10", "infs", "nanh"}) {
    EXPECT_EQ(usage({"sweep", "sweep.toml", "--out", "db", "--for", time}),
              "--for: " + time + ": allowed: a time above 0, as 10h, 30m or 45s");
  }
  for (const char* since : {"yesterday", "-1"}) {
    EXPECT_EQ(usage({"sweep", "compare", "db", "--since", since}),
              std::string("--since: ") + since +
                  ": allowed: a revision of the models, as 3, or a time of UTC, as 2026-11-25 or "
                  "\"2026-11-25 18:00\"");
  }
  EXPECT_EQ(usage({"sweep", "sweep.toml"}),
            "sweep: allowed: SWEEP.toml and --out DB, or a subcommand");
  EXPECT_EQ(usage({"sweep", "best", "db", "--bye", "ratio"}),
            "unknown option --bye; did you mean --by?; allowed: --help, --format, --quiet, "
            "--threads, --out, "
            "--by, --most, --least, --run");
  for (const std::vector<std::string>& folder :
       {std::vector<std::string>{"sweep", "status", "."}, {"sweep", "merge", ".", "--out", "db"}}) {
    const ProgramResult result = place.run(folder);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, ".: is a folder: allowed: a database of a sweep\n");
  }
  const ProgramResult over = place.run({"sweep", "sweep.toml", "--out", "sweep.toml"});
  EXPECT_EQ(over.exit_code, 2);
}

TEST(Sweep, QuestionsReadOnly) {
  const Workplace place;
  place.write("sweep.toml", kSmallSweep);
  ASSERT_EQ(place.run({"sweep", "sweep.toml", "--out", "db", "--quiet"}).exit_code, 0);
  const auto refused = [&](const std::vector<std::string>& arguments) {
    const ProgramResult result = place.run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_EQ(refused({"sweep", "query", "db", "VACUUM INTO 'file'"}),
            "db: a statement that does more than read; nothing was changed: allowed: SELECT, WITH, "
            "VALUES, EXPLAIN, or a PRAGMA that only tells\n");
  EXPECT_FALSE(place.has("file"));
  EXPECT_EQ(refused({"sweep", "best", "db", "--least", "mass_kg"}),
            "db: no design has mass_kg: allowed: a name that designs have a value of\n");
  const std::string newest = std::to_string(sweep::kModelRevision);
  EXPECT_EQ(refused({"sweep", "compare", "db", "--since", "999"}),
            "db: no result is of a revision of the models above " + newest +
                ": --since 999: allowed: at most " + newest + ", or a time of UTC\n");
  EXPECT_EQ(refused({"sweep", "query", "db", "SELECT colour FROM task"}),
            "db: no such column: colour\n");
  EXPECT_EQ(refused({"sweep", "best", "db", "--by", "rato"}).substr(0, 46),
            "db: no key and no column rato; did you mean ra");
  EXPECT_EQ(refused({"sweep", "best", "db", "--by", "teeth"}),
            "db: teeth may be teeth.P1 or teeth.P2 or teeth.R1_max or teeth.R2_max or teeth.S: "
            "allowed: one of them\n");
  const std::string best =
      place.run({"sweep", "best", "db", "--by", "ratio,planets,friction", "--format", "csv"}).out;
  EXPECT_EQ(test::lines_of(best).size(), 9U) << best;
  EXPECT_EQ(test::lines_of(best).front().substr(0, 57),
            "ratio.target,planets,friction.coefficient,eta_b,zS,zP1,zR");
  // The least loss is the best of both frictions.
  const std::string most =
      place.run({"sweep", "best", "db", "--by", "ratio", "--format", "csv"}).out;
  const std::string least =
      place.run({"sweep", "best", "db", "--by", "ratio", "--least", "eta_b", "--format", "csv"})
          .out;
  EXPECT_LT(least.substr(least.find("\n40")), most.substr(most.find("\n40")));
  // Rows of different planets or friction say so; the limit that all have is no column.
  EXPECT_NE(test::lines_of(most).front().find(",planets,"), std::string::npos) << most;
  EXPECT_EQ(most.find("max_output_arcmin"), std::string::npos) << most;
}

TEST(Sweep, AnAnswerDoesNotReplaceItsDatabase) {
  const Workplace place;
  const test::QueuedTasks tasks(place, "db", 1);
  const std::string before = place.read("db");
  std::filesystem::create_symlink("db", place.file("link"));
  std::filesystem::create_hard_link(place.file("db"), place.file("other"));
  const std::vector<std::vector<std::string>> questions{{"status"},
                                                        {"best"},
                                                        {"query", "SELECT 1"},
                                                        {"compare", "--since", "0"},
                                                        {"figure", "--x", "ratio", "--y", "eta_b"}};
  const auto refuses = [&](const std::string& database, const std::vector<std::string>& question,
                           const std::string& out) {
    std::vector<std::string> words{"sweep", question[0], database};
    words.insert(words.end(), question.begin() + 1, question.end());
    words.insert(words.end(), {"--out", out});
    const ProgramResult result = place.run(words);
    EXPECT_EQ(result.exit_code, 2) << question[0] << " " << out;
    EXPECT_EQ(result.err.substr(0, 7), "--out: ") << result.err;
  };
  for (const std::vector<std::string>& question : questions) refuses("db", question, "db");
  for (const char* out : {"link", "other", "./db", "db-wal", "db-journal"}) {
    refuses("db", {"status"}, out);
  }
  refuses("db", {"status"}, "../" + place.work().filename().string() + "/db-shm");
  for (const char* out : {"db", "other", "db-wal"}) refuses("link", {"status"}, out);
  EXPECT_EQ(place.run({"sweep", "merge", "db", "--out", "db-wal"}).exit_code, 2);
  EXPECT_TRUE(place.read("db") == before);
  EXPECT_EQ(place.run({"sweep", "status", "db", "--out", "answer"}).exit_code, 0);
}

TEST(Sweep, AFigureIsWrittenAsItIs) {
  const Workplace place;
  place.write("sweep.toml", one_task());
  ASSERT_EQ(place.run({"sweep", "sweep.toml", "--out", "db"}).exit_code, 0);
  const std::vector<std::string> words{"sweep", "figure", "db", "--x", "ratio", "--y", "eta_b"};
  const ProgramResult shown = place.run(words);
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_NE(shown.out.find('\t'), std::string::npos);
  EXPECT_EQ(shown.out.find("\\u0009"), std::string::npos);
  std::vector<std::string> into = words;
  into.insert(into.end(), {"--out", "map.svg"});
  ASSERT_EQ(place.run(into).exit_code, 0);
  EXPECT_EQ(place.read("map.svg"), shown.out);
}

TEST(Sweep, AMergeThatFailsLeavesNoNewDatabase) {
  const Workplace place;
  const test::QueuedTasks tasks(place, "part", 20);
  { const sweep::Store store = tasks.open(); }
  place.write("text", "no database");
  // Found before anything is written, though the first input is sound.
  EXPECT_EQ(place.run({"sweep", "merge", "part", "text", "--out", "all"}).exit_code, 2);
  EXPECT_EQ(place.run({"sweep", "merge", "part", "none", "--out", "all"}).exit_code, 2);
  // Found only while its rows are read.
  std::string bytes = place.read("part");
  for (std::size_t k = 4096; k < bytes.size(); ++k) bytes[k] = 'x';
  place.write("damaged", bytes);
  const ProgramResult damaged = place.run({"sweep", "merge", "damaged", "--out", "all"});
  EXPECT_EQ(damaged.exit_code, 2);
  EXPECT_NE(damaged.err.find("is damaged"), std::string::npos) << damaged.err;
  for (const std::string& path : place.listing()) EXPECT_NE(path.substr(0, 3), "all") << path;
}

TEST(Sweep, SaysWhatIsWorkedOnElsewhere) {
  const Workplace place;
  const test::QueuedTasks tasks(place, "db", 1);
  // Of another machine, for an hour.
  sweep::Store store = tasks.open();
  const double hence_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count() +
      3600.0;
  ASSERT_TRUE(store.claim(tasks.run, {.host = "elsewhere", .number = 7, .began = 7}, hence_s));
  const ProgramResult result = place.run({"sweep", "sweep.toml", "--out", "db"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("1 task is still worked on elsewhere\n"), std::string::npos)
      << result.err;
}

TEST(Sweep, ATaskIsThatOfTheFilesThatItNames) {
  const Workplace place;
  std::filesystem::create_directory(place.file("in"));
  const auto write_cycle = [&](const char* torque) {
    place.write("in/c.csv", std::string("time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,") + torque +
                                ",-1\n1,-3,1\n");
  };
  const std::string motors =
      "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a,rotor_inertia_kgm2\n"
      "A,m,0.6,0.04,2e-5\n";
  place.write("in/motors.csv", motors);
  write_cycle("3");
  place.write("in/sweep.toml", kSmallTask +
                                   "objective = \"cycle_energy\"\nplanets = 4\n"
                                   "ratio.target = 40.0\nactuator.motors = \"motors.csv\"\n"
                                   "[vary]\ncycle.files = [\"c.csv\"]\n");
  // Seen from the SWEEP file, not from here.
  const auto sweep = [&] { return place.run({"sweep", "in/sweep.toml", "--out", "a.db"}); };
  const ProgramResult first = sweep();
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(number_of(place, "a.db", "SELECT count(*) FROM task WHERE status = 'optimal'"), 1);
  EXPECT_NE(sweep().err.find("1 tasks, 1 of them known"), std::string::npos);
  write_cycle("4");
  const ProgramResult other = sweep();
  EXPECT_NE(other.err.find("1 tasks, 0 of them known"), std::string::npos) << other.err;
  EXPECT_EQ(number_of(place, "a.db", "SELECT count(DISTINCT merit) FROM task"), 2);
  EXPECT_EQ(number_of(place, "a.db", "SELECT count(DISTINCT spec_key) FROM task"), 2);
  EXPECT_EQ(number_of(place, "a.db", "SELECT count(DISTINCT spec) FROM task"), 1);
  place.write("in/motors.csv", motors + "A,n,0.5,0.05,3e-5\n");
  EXPECT_NE(sweep().err.find("1 tasks, 0 of them known"), std::string::npos);
  std::filesystem::remove(place.file("in/c.csv"));
  const ProgramResult none = sweep();
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("c.csv"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace gear3k::sweep_test
