#include "calibrate/measurement/loop_reading.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "calibrate/loops/correlated_noise.hpp"
#include "calibrate/loops/zero_phase_filter.hpp"
#include "numerics/distributions.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

/// Travel at a torque, between the levels that were read.
std::optional<TravelAtTorque> travel_at(const Loop& loop, double torque_Nm) {
  const auto& levels = loop.travel;
  for (std::size_t k = 1; k < levels.size(); ++k) {
    const auto& low = levels[k - 1];
    const auto& high = levels[k];
    if (torque_Nm < low.torque_Nm || torque_Nm > high.torque_Nm) continue;
    const double share = (torque_Nm - low.torque_Nm) / (high.torque_Nm - low.torque_Nm);
    return TravelAtTorque{
        .torque_Nm = torque_Nm,
        .angle_rad = low.angle_rad + share * (high.angle_rad - low.angle_rad),
        .fall_sample = low.fall_sample + share * (high.fall_sample - low.fall_sample),
        .rise_sample = low.rise_sample + share * (high.rise_sample - low.rise_sample)};
  }
  return std::nullopt;
}

/// Of the mean of the filtered angle at places between samples.
double variance_of_mean(const CorrelatedNoise& noise, const std::vector<double>& places,
                        const std::vector<double>& response) {
  const auto [low, high] = std::ranges::minmax(places);
  const std::size_t reach = response.size();
  const double first = std::floor(low);
  const auto span = static_cast<std::size_t>(std::floor(high) - first);
  std::vector<double> weight(span + 2 * reach + 2, 0.0);
  const double share = 1.0 / static_cast<double>(places.size());
  for (const double place : places) {
    const double whole = std::floor(place);
    const std::size_t at = reach + static_cast<std::size_t>(whole - first);
    add_filter_weights(response, at, share * (1.0 - (place - whole)), weight);
    add_filter_weights(response, at + 1, share * (place - whole), weight);
  }
  return variance_of_sum(noise, weight);
}

/// Empty where the flanks do not reach that far.
std::optional<TravelReading> mean_travel(const Loop& loop, const CorrelatedNoise& noise,
                                         const std::vector<double>& response, double torque_Nm,
                                         double band_Nm) {
  constexpr int kSteps = 10;
  TravelReading mean{.torque_Nm = torque_Nm};
  std::vector<double> fall, rise;
  for (int k = 0; k <= kSteps; ++k) {
    const auto travel = travel_at(loop, torque_Nm + band_Nm * (2.0 * k / kSteps - 1.0));
    if (!travel) return std::nullopt;
    mean.angle_rad += travel->angle_rad / (kSteps + 1);
    mean.fall_sample += travel->fall_sample / (kSteps + 1);
    mean.rise_sample += travel->rise_sample / (kSteps + 1);
    fall.push_back(travel->fall_sample);
    rise.push_back(travel->rise_sample);
  }
  mean.variance_rad2 =
      variance_of_mean(noise, fall, response) + variance_of_mean(noise, rise, response);
  return mean;
}

struct Intercept {
  double value = 0.0, variance = 0.0;
};

/// Least-squares line through three travels or more, at zero torque, with the scatter about it.
Intercept intercept_of(const std::vector<TravelReading>& points) {
  const auto count = static_cast<double>(points.size());
  double x = 0.0;
  double y = 0.0;
  for (const TravelReading& p : points) {
    x += p.torque_Nm / count;
    y += p.angle_rad / count;
  }
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const TravelReading& p : points) {
    xx += numerics::square(p.torque_Nm - x);
    xy += (p.torque_Nm - x) * (p.angle_rad - y);
    yy += numerics::square(p.angle_rad - y);
  }
  const double left = std::max(0.0, yy - xy * xy / xx) / (count - 2.0);
  return {.value = y - xy / xx * x, .variance = left * (1.0 / count + x * x / xx)};
}

}  // namespace

LoopReading read_loop(const Loop& loop, const CorrelatedNoise& noise,
                      const std::vector<double>& response, double peak_Nm) {
  constexpr std::size_t kFewest = 3;
  // One branch is few samples to tell its noise from; that of all flanks is the least.
  const double least = variance_of_mean(noise, {loop.falling_zero_sample}, response) +
                       variance_of_mean(noise, {loop.rising_zero_sample}, response);
  LoopReading reading{
      .zero_rad = loop.lost_motion_rad,
      .zero_variance_rad2 = std::max(numerics::square(loop.lost_motion_sd_rad), least)};
  for (const double fraction : kTravelFractions) {
    if (const auto travel =
            mean_travel(loop, noise, response, fraction * peak_Nm, kTravelBand * peak_Nm)) {
      reading.travel.push_back(*travel);
    }
  }
  if (reading.travel.size() < kFewest) return reading;
  const Intercept at_zero = intercept_of(reading.travel);
  reading.has_opening = true;
  reading.opening_rad = reading.zero_rad - at_zero.value;
  reading.opening_variance_rad2 = reading.zero_variance_rad2 + at_zero.variance;
  return reading;
}

std::vector<double> friction_openings_rad(const std::vector<LoopReading>& loops) {
  constexpr double kDeviations = 3.0;
  constexpr double kDiffer = 1e-3;
  double count = 0.0;
  double mean = 0.0;
  double variance = 0.0;
  for (const LoopReading& loop : loops) {
    if (!loop.has_opening) continue;
    count += 1.0;
    mean += loop.opening_rad;
    variance += loop.opening_variance_rad2;
  }
  std::vector<double> opening(loops.size(), 0.0);
  if (count == 0.0) return opening;
  mean /= count;
  variance /= count;
  if (!(mean > kDeviations * std::sqrt(variance / count))) return opening;
  double squares = 0.0;
  for (const LoopReading& loop : loops) {
    if (loop.has_opening) squares += numerics::square(loop.opening_rad - mean);
  }
  const bool differ =
      count > 1.0 && variance > 0.0 &&
      numerics::gamma_upper(0.5 * (count - 1.0), 0.5 * squares / variance) < kDiffer;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    if (!loops[k].has_opening) continue;
    opening[k] = differ ? std::max(0.0, loops[k].opening_rad) : mean;
  }
  return opening;
}

}  // namespace gear3k::calibrate
