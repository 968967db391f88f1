#include "calibrate/measurement/loop_reading.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calibrate/loops/zero_phase_filter.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::loop_reading_test {
namespace {

/// Triangles of torque over a spring, with noise of the angle that remembers.
TorqueAngleRecord noisy_loops(double sd_rad, double correlation, rig::DeterministicRandom& random) {
  constexpr int kSamples = 400;
  TorqueAngleRecord record;
  double noise = sd_rad * random.normal();
  for (int k = 0; k <= 3 * kSamples; ++k) {
    const double phase = static_cast<double>(k % kSamples) / kSamples;
    const double triangle = phase < 0.25   ? 4.0 * phase
                            : phase < 0.75 ? 2.0 - 4.0 * phase
                                           : 4.0 * phase - 4.0;
    noise =
        correlation * noise + std::sqrt(1.0 - correlation * correlation) * sd_rad * random.normal();
    record.time_s.push_back(0.1 * k);
    record.torque_Nm.push_back(8.0 * triangle);
    record.angle_rad.push_back(8.0 * triangle / 4000.0 + noise);
  }
  return record;
}

TEST(ReadLoop, TravelsScatterAsTheirVarianceSays) {
  constexpr double kNoise_rad = 1e-5;
  rig::DeterministicRandom random(71);
  LoopOptions options;
  options.travel_levels.clear();
  for (int k = 5; k < 95; ++k) options.travel_levels.push_back(0.01 * k);
  for (const double correlation : {-0.3, 0.0, 0.4}) {
    double squares = 0.0, stated = 0.0, products = 0.0, count = 0.0, pairs = 0.0;
    for (int seed = 0; seed < 60; ++seed) {
      const LoopAnalysis found =
          analyse_loops(noisy_loops(kNoise_rad, correlation, random), options);
      const auto response = impulse_response(found.cutoff_per_sample);
      for (std::size_t b = 1; b < found.loops.size(); b += 2) {
        const LoopReading reading = read_loop(found.loops[b], found.flank_noise, response, 7.9);
        ASSERT_EQ(reading.travel.size(), kTravelFractions.size());
        double before = 0.0;
        for (const TravelReading& travel : reading.travel) {
          const double off = travel.angle_rad - 2.0 * travel.torque_Nm / 4000.0;
          squares += off * off;
          stated += travel.variance_rad2;
          count += 1.0;
          if (before != 0.0) {
            products += off * before;
            pairs += 1.0;
          }
          before = off;
        }
      }
    }
    EXPECT_NEAR(std::sqrt(stated / count), std::sqrt(squares / count),
                0.15 * std::sqrt(squares / count))
        << correlation;
    // Neighbours share no noise: over n pairs a correlation of 0 scatters by 1/√n.
    EXPECT_NEAR(products / pairs / (squares / count), 0.0, 4.0 / std::sqrt(pairs)) << correlation;
  }
}

}  // namespace
}  // namespace gear3k::calibrate::loop_reading_test
