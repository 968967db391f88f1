#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/rig/deterministic_random.hpp"

namespace gear3k::wide_rig {

/// Range of a condition over the campaign.
struct Span {
  double low = 0.0, high = 1.0;
};

/// Value of a law at amplitude a and condition x; 0 at its reference point.
using ShapeLaw = std::function<double(double amplitude, double x)>;

/// A law with its random constants and the range of its amplitude.
struct DrawnLaw {
  ShapeLaw value{};
  double smallest = -1e9, largest = 1e9;
  double start = 0.05;
};

/// Friction over load: power, power_share, logarithmic, saturating, sigmoid.
///
/// x and the range are tooth forces; the reference point is anywhere in the range.
DrawnLaw load_law(const std::string& law, Span force, rig::DeterministicRandom& random);
/// Friction over sliding speed: stribeck_exponential, mixed_film, power, eyring, stribeck_viscous.
DrawnLaw speed_law(const std::string& law, Span speed, rig::DeterministicRandom& random);
/// Friction over temperature: exponential, vogel, linear, grease_transition.
DrawnLaw temperature_law(const std::string& law, Span temperature_c,
                         rig::DeterministicRandom& random);
/// Monotone over the share of the campaign, 0 at its begin: exponential, power, logarithmic,
/// linear, weibull. Time constants are 0.03 to 3 campaigns.
DrawnLaw time_law(const std::string& law, rig::DeterministicRandom& random);

/// Values of the sessions: all different and neither rising nor falling throughout, or one step;
/// rms 1 about their mean.
std::vector<double> session_values(int sessions, bool one_step, rig::DeterministicRandom& random);

}  // namespace gear3k::wide_rig
