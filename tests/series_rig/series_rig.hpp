#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/wide_rig/wide_rig.hpp"

namespace gear3k::series_rig {

/// Whose a hidden difference is.
enum class Owner { design, part, both };

/// A hidden difference and the value that each gearbox was built with.
struct SeriesTruth {
  std::string cause;      ///< id of the table of causes in docs/interface.md
  std::string parameter;  ///< as the contract names it; empty: the law states none
  Owner owner = Owner::design;
  double mean = 0.0, deviation = 0.0;  ///< of the drawn gearboxes' population, unit of the contract
  std::vector<double> values{};        ///< by gearbox
  /// May stand beside it as the design's: a law's reference point is not known, and another one is
  /// another coefficient of friction.
  std::string companion{};
};

/// Measurements of a series of gearboxes on one bench.
struct SeriesCampaign {
  std::string subject_toml{};
  std::vector<wide_rig::File> files{};  ///< with the note `# unit:`; two or more of a gearbox
  std::vector<std::string> units{};
  std::vector<SeriesTruth> truths{};
};

struct SeriesScenario {
  std::string name;
  std::string kind;  ///< transmission or lost_motion
  struct Hidden {
    std::string cause;
    double mean = 0.0;       ///< share of what is usual of the cause, 0: no mean
    double deviation = 0.0;  ///< the same, 0: none
    bool uniform = false;    ///< drawn from a uniform distribution of that deviation
  };
  std::vector<Hidden> hidden;
  double session_noise = 0.0;  ///< deviation of the sensor's offset between sessions, in row noises
};

/// Series with a difference of the design, of the part, of both, and with none.
std::vector<SeriesScenario> scenarios();

/// Eight gearboxes (or `units`), each in three sessions of 40 rows in two files.  A gearbox has a
/// sensor of its own noise, half to twice 1 % of the typical reading; some scatter as Student's t
/// with three degrees of freedom.  Forces and angles: tests/wide_rig/bench_subject.hpp.
/// @throws std::invalid_argument for a cause that the rig does not know
SeriesCampaign make_series(const SeriesScenario& scenario, std::uint64_t seed, int units = 8,
                           int rows_per_unit = 120);

}  // namespace gear3k::series_rig
