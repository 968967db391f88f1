#include "calibrate/measurement/loop_reading.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "calibrate/loops/correlated_noise.hpp"
#include "calibrate/loops/zero_phase_filter.hpp"
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

}  // namespace

LoopReading read_loop(const Loop& loop, const CorrelatedNoise& noise,
                      const std::vector<double>& response, double peak_Nm) {
  // One branch is few samples to tell its noise from; that of all flanks is the least.
  const double least = variance_of_mean(noise, {loop.falling_zero_sample}, response) +
                       variance_of_mean(noise, {loop.rising_zero_sample}, response);
  LoopReading reading{
      .tells_zero = loop.outcome == LoopOutcome::kMeasured,
      .zero_rad = loop.lost_motion_rad,
      .zero_variance_rad2 = std::max(numerics::square(loop.lost_motion_sd_rad), least)};
  for (const double fraction : kTravelFractions) {
    if (const auto travel =
            mean_travel(loop, noise, response, fraction * peak_Nm, kTravelBand * peak_Nm)) {
      reading.travel.push_back(*travel);
    }
  }
  return reading;
}

}  // namespace gear3k::calibrate
