#pragma once
// The database of a sweep: what is asked for, who works on it, what became of it.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sweep/process.hpp"
#include "sweep/schema.hpp"
#include "sweep/sweep_file.hpp"
#include "sweep/task.hpp"

namespace gear3k::sweep {

/// A part of a sweep: tasks k with k mod count = number - 1.
struct Shard {
  std::uint64_t number = 1, count = 1;
};

/// A call of the command.
struct Run {
  std::string uid;  ///< differs from that of any other
  int workers = 1;
  Shard shard;
  double started_s = 0.0;  ///< seconds since 1970
  std::string host;
};

/// What was found of the tasks of a run when they were put into the queue.
struct Planned {
  std::uint64_t asked = 0;  ///< tasks of the shard, one that is asked for twice counted once
  std::uint64_t known = 0;  ///< of them, those that have a result
};

/// A task that a worker has.
struct Claimed {
  std::int64_t id = 0;
  std::string key, spec;
};

/// When, where and by how much CPU time a result was found.
struct Provenance {
  std::string run;  ///< its uid
  std::string host;
  double finished_s = 0.0;
  double cpu_s = 0.0;
};

/// Seconds for which a task is a worker's, unless it is renewed.
inline constexpr double kLeaseSeconds = 120.0;
/// After so many crashes of its worker a task has failed.
inline constexpr int kMostCrashes = 3;
/// After so many kills of its worker from outside, as by a limit of memory or time, too.
inline constexpr int kMostKills = 5;

/// The signal by which a worker ended without a word.
struct WorkerEnd {
  int signal = 0;      ///< 0: it was asked to end, which does not count
  bool crash = false;  ///< the program itself failed; else it was killed from outside
};

class Store {
 public:
  explicit Store(Database database) : database_(std::move(database)) {}

  [[nodiscard]] Database& database() { return database_; }

  /// @returns the run's number in this database
  std::int64_t begin(const Run& run, const Sweep& sweep);
  void end(std::int64_t run, double now_s);

  /// Puts tasks from place `from` on into the queue, a block at a time.
  /// @returns the place of the next one; sweep.count() at the end
  std::uint64_t plan(std::int64_t run, const Sweep& sweep, const Shard& shard, std::uint64_t from,
                     Planned& planned);
  /// Has a column for every key in the view `result`; after the last block.
  void end_plan();

  /// Takes the next task of a run that is nobody's, whose process is dead, or whose lease has ended
  /// and whose process is not known to live: leases go by the clock, which may be set.
  std::optional<Claimed> claim(std::int64_t run, const Process& worker, double now_s);
  /// Gives a task back that the worker still holds.
  void release(std::int64_t task, const Process& worker);
  /// Keeps leases of living workers.
  void renew(const std::vector<Process>& workers, double now_s);
  /// Records a result, once.  @returns false where another worker has recorded it before
  bool finish(std::int64_t task, const TaskResult& result, const Provenance& provenance);
  /// A worker has ended without a word: frees its task, which has failed after kMostCrashes or
  /// kMostKills of them.
  void bury(const Process& worker, const WorkerEnd& end, const Provenance& provenance);

  /// Tasks of a run that have no result.
  [[nodiscard]] std::int64_t open_tasks(std::int64_t run) const;

 private:
  std::int64_t key_id(const std::string& path);

  Database database_;
  std::map<std::string, std::int64_t> key_ids_;
};

}  // namespace gear3k::sweep
