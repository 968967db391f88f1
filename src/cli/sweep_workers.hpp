#pragma once
// Processes that work on the tasks of a sweep.

#include <cstdint>
#include <optional>
#include <string>

namespace gear3k::cli {

struct SweepWork {
  std::string database;
  std::int64_t run = 0;  ///< in the database
  std::string uid;       ///< of the run
  int workers = 1;
  int threads = 1;               ///< of OpenMP, in each worker
  std::optional<double> most_s;  ///< ends after so long
  bool quiet = false;
};

struct SweepEnd {
  bool interrupted = false;  ///< by Ctrl-C or SIGTERM
  bool out_of_time = false;  ///< most_s have passed
  std::string failure;       ///< what kept workers from recording; "" = nothing
  std::int64_t open = 0;     ///< tasks without a result
};

/// Seconds since 1970.
double now_s();

/// Whether Ctrl-C or SIGTERM have come since the first call, which begins to listen.
bool sweep_interrupted();

/// Forks workers and stays with them: one that is killed is replaced, and its task done again.
/// The process must not have run a thread or an OpenMP region, nor have a connection to the
/// database.
SweepEnd work_on_sweep(const SweepWork& work);

}  // namespace gear3k::cli
