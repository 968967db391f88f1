#pragma once
// Sweeps whose tasks take milliseconds, and what the tests ask of databases.

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "sweep/schema.hpp"
#include "sweep/store.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::test {

/// The keys that the tasks share: one tooth set at 40:1, none at 44:1.
inline const std::string kSmallTask = R"(name = "small"
[task]
teeth.S = [16, 16]
teeth.P1 = [27, 27]
teeth.P2 = [22, 22]
teeth.R1_max = 80
teeth.R2_max = 80
module.stage1_mm = 1.0
module.stage2_mm = 1.0
backlash.max_output_arcmin = 12.0
ratio.tolerance = 0.02
solver.starts = 1
)";

/// 2 ratios x 2 numbers of planets x 2 frictions; of nine planets none has room.
inline const std::string kSmallSweep = kSmallTask + R"([vary]
ratio.target = [40.0, 44.0]
planets = [4, 9]
friction.coefficient = [0.06, 0.1]
)";

/// The message of what is refused; "" where it is not.
template <class Step>
std::string refusal_of(const Step& step) {
  try {
    step();
  } catch (const io::InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// A database with tasks of friction 0.001 k, k = 1 .. count, in its queue.
struct QueuedTasks {
  QueuedTasks(const Workplace& place, const std::string& name, int count)
      : path(place.file(name).string()) {
    std::string values = "0.001";
    for (int k = 2; k <= count; ++k) values += ", " + std::to_string(0.001 * k);
    place.write("sweep.toml", kSmallTask +
                                  "planets = 4\nratio.target = 40.0\n"
                                  "[vary]\nfriction.coefficient = [" +
                                  values + "]\n");
    const sweep::Sweep sweep = sweep::read_sweep(place.file("sweep.toml").string());
    sweep::Store store = open();
    run = store.begin({.uid = "run", .workers = 1, .shard = {}, .started_s = 0.0, .host = "here"},
                      sweep);
    for (std::uint64_t at = 0; at < sweep.count();) {
      at = store.plan(run, sweep, {}, at, planned);
    }
    store.end_plan();
  }
  [[nodiscard]] sweep::Store open() const {
    return sweep::Store(sweep::open_sweep_database(path, sweep::Database::Access::kCreate));
  }

  std::string path;
  std::int64_t run = 0;
  sweep::Planned planned;
};

/// A result with five designs, told apart by a number.
inline sweep::TaskResult made_result(double number) {
  sweep::TaskResult result;
  result.status = sweep::TaskStatus::kOptimal;
  result.sets = 3;
  result.merit = number;
  result.best = "name = \"made\"\n";
  result.refusals = {{.status = "infeasible", .reason = "planet_gap", .sets = 2}};
  for (int k = 0; k < 5; ++k) {
    result.designs.push_back({{.item = "", .quantity = "zS", .unit = "", .value = 16},
                              {.item = "", .quantity = "eta_b", .unit = "", .value = number - k}});
  }
  return result;
}

}  // namespace gear3k::test
