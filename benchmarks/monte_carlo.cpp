// Random gearboxes a second: the bilateral drive gear with every tolerance stated, on one and on
// all threads, beside the loop one would write with <random>.
//
//   monte_carlo     about 20 seconds on two cores

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "backlash/tolerance_shares.hpp"
#include "benchmarks/program.hpp"

namespace {

using namespace gear3k;            // NOLINT(google-build-using-namespace): a program
using namespace gear3k::backlash;  // NOLINT(google-build-using-namespace)

constexpr int kRepetitions = 5;
constexpr double kArcmin = std::numbers::pi / 10800.0;

ClearanceModel bilateral_drive_gear() {
  train::TrainParameters<double> p{};
  p.teeth = {.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  p.planets = 3;
  p.pressure_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.module_m = {0.8e-3, 0.8467e-3};
  p.profile_shift = {0.476, 0.762, 2.0, 0.536, 1.21};
  p.center_distance_m = 21.268e-3;
  p.machining_allowance.fill(0.02);
  Tolerances t;
  for (GearTolerances& gear : t.gears) {
    gear.tooth_thickness_m = {.lower = -20e-6, .upper = 0.0};
    gear.runout_m = 10e-6;
    gear.cumulative_pitch_m = 20e-6;
    gear.single_pitch_m = 4e-6;
  }
  t.center_distance_m = {.lower = -5e-6, .upper = 5e-6};
  t.pin_position_m = 10e-6;
  t.planet_phase_rad = {.lower = -3e-4, .upper = 3e-4};
  return *clearance_model(p, t);
}

struct LostMotion {
  std::uint64_t assembled = 0;
  double sum_rad = 0.0;
};

/// The same distributions from <random>, one gearbox after the other.
LostMotion plain_loop(const ClearanceModel& model, std::uint64_t samples) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal(0.0, 1.0 / 3.0);
  const auto number = [&] {
    for (;;) {
      const double x = normal(generator);
      if (std::abs(x) <= 1.0) return x;
    }
  };
  LostMotion result;
  std::vector<DeviationValue> values(model.deviations.size());
  for (std::uint64_t g = 0; g < samples; ++g) {
    for (std::size_t d = 0; d < values.size(); ++d) {
      const double half = model.sources[model.deviations[d].source].half_width_m;
      values[d].x_m = half * number();
      if (!model.deviations[d].planar) continue;
      do {
        values[d] = {.x_m = half * normal(generator), .y_m = half * normal(generator)};
      } while (values[d].x_m * values[d].x_m + values[d].y_m * values[d].y_m > half * half);
    }
    const OutputRange range = output_range(model.levers, plays(model, values));
    if (!range.assembles()) continue;
    ++result.assembled;
    result.sum_rad += range.width_rad();
  }
  return result;
}

/// Median over repetitions of things done a second.
template <class Run>
double rate(std::uint64_t samples, Run run) {
  std::array<double, kRepetitions> rates{};
  for (double& r : rates) {
    const auto start = std::chrono::steady_clock::now();
    run(samples);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    r = static_cast<double>(samples) / took.count();
  }
  std::sort(rates.begin(), rates.end());
  fmt::print("{:10.3f} {:10.3f} {:10.3f}", 1e-6 * rates.front(), 1e-6 * rates[kRepetitions / 2],
             1e-6 * rates.back());
  return rates[kRepetitions / 2];
}

}  // namespace

PROGRAM(monte_carlo)(int, char**) {
  const ClearanceModel model = bilateral_drive_gear();
  const int threads = omp_get_max_threads();
  fmt::print("3 planets, {} tolerances, {} deviations, {} random numbers a gearbox\n",
             model.sources.size(), model.deviations.size(),
             GearboxBatch(model).components().size());
  fmt::print("{:<44} {:>10} {:>10} {:>10}   {} repetitions\n", "million gearboxes a second",
             "least", "median", "greatest", kRepetitions);

  MonteCarloResult sampled;
  const auto series = [&](std::uint64_t samples) {
    sampled = monte_carlo(model, {.samples = samples, .seed = 1});
  };
  fmt::print("{:<44} ", "monte_carlo, 1 thread");
  omp_set_num_threads(1);
  const double one = rate(2'000'000, series);
  fmt::print("\n{:<44} ", fmt::format("monte_carlo, {} threads", threads));
  omp_set_num_threads(threads);
  const double all = rate(4'000'000, series);
  fmt::print("   {:.2f} times as fast\n", all / one);

  fmt::print("{:<44} ", "std::normal_distribution, plays, output_range");
  LostMotion plain;
  const double naive =
      rate(100'000, [&](std::uint64_t samples) { plain = plain_loop(model, samples); });
  fmt::print("   1/{:.1f} of 1 thread, 1/{:.1f} of {}\n", one / naive, all / naive, threads);

  fmt::print("{:<44} ", fmt::format("tolerance_shares, {} threads", threads));
  rate(200'000, [&](std::uint64_t samples) {
    tolerance_shares(model, {.samples = samples, .seed = 1, .limit_rad = 8.0 * kArcmin});
  });
  const auto& lost = sampled.lost_motion;
  fmt::print(
      "\n\nlost motion: mean {:.4f} arcmin, of the plain loop {:.4f}; {:.3f} ... {:.3f}, worst "
      "case {:.3f} ... {:.3f} arcmin\n",
      lost.mean_rad / kArcmin, plain.sum_rad / static_cast<double>(plain.assembled) / kArcmin,
      lost.least_rad / kArcmin, lost.greatest_rad / kArcmin, sampled.worst.least_rad / kArcmin,
      sampled.worst.greatest_rad / kArcmin);
  return 0;
}
