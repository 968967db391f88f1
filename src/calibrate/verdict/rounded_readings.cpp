#include <cstdint>

#include "calibrate/fit/fit.hpp"
#include "calibrate/fit/rounding.hpp"
#include "calibrate/measurement/noise.hpp"
#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::calibrate {
namespace {

/// The readings as they may have been before they were rounded, if the simulation is right.
std::optional<MeasurementSet> before_rounding_of(const Simulation& simulation,
                                                 const MeasurementSet& data, std::uint64_t seed) {
  const Problem problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
  const Linearisation given = linearise(problem, {}, {});
  if (!given.runs || !given.simulated.allFinite()) return std::nullopt;
  return before_rounding(data, given.simulated, seed);
}

}  // namespace

std::optional<Diagnosis> diagnose(const Simulation& simulation, const MeasurementSet& data,
                                  const DiagnoseOptions& options) {
  auto found = diagnose_as_read(simulation, data, options);
  if (!found || found->verdict == Verdict::kNoDiscrepancy) return found;
  // Whether there is anything is a question of the simulation as given, and of what a sensor with
  // such steps reads of it.
  const auto expected = before_rounding_of(simulation, data, options.seed + 13);
  if (!expected) return found;
  DiagnoseOptions again = options;
  if (options.progress) again.progress = [&](double) { return options.progress(1.0); };
  auto rounded = diagnose_as_read(simulation, *expected, again);
  if (!rounded) return std::nullopt;
  // A memory that only the second look shows is no matter of rounding.
  const bool remembers = rounded->memory.memory.share > 0.0 && !(found->memory.memory.share > 0.0);
  if (rounded->verdict != Verdict::kNoDiscrepancy || remembers) return found;
  rounded->notes.emplace_back(
      "the readings come in coarse steps: rounded alike, the simulation as given agrees with them");
  return rounded;
}

}  // namespace gear3k::calibrate
