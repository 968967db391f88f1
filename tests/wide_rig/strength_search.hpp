#pragma once

#include <vector>

#include "tests/wide_rig/bench_row.hpp"
#include "tests/wide_rig/bench_subject.hpp"

namespace gear3k::wide_rig {

/// Clean response of a kind of measurement.
BenchReading clean_reading(const BenchSubject& subject, const std::string& kind,
                           const BenchRow& row, const std::vector<AppliedEffect>& effects);

/// The amplitude at which an effect alone has a strength, or the greatest physical one.
///
/// The effect grows from its start amplitude in either sense where its sign is free; of the two
/// senses the one it began with is taken unless only the other reaches the strength.
struct FoundAmplitude {
  double amplitude = 0.0;
  double strength = 0.0;
};
FoundAmplitude amplitude_for(const BenchSubject& subject, const std::string& kind,
                             const std::vector<BenchRow>& rows, const HiddenEffect& effect,
                             double noise_sd, double strength);

}  // namespace gear3k::wide_rig
