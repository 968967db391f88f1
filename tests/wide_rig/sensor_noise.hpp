#pragma once

#include <string>
#include <vector>

#include "tests/rig/deterministic_random.hpp"

namespace gear3k::wide_rig {

/// Noise of a sensor: sqrt(full_scale^2 + (reading y)^2), normal, Student's t with 3 degrees of
/// freedom (same standard deviation), normal with 10 % outliers of 5 to 10 sigma, or normal and
/// quantised.
struct SensorNoise {
  std::string model;
  double full_scale = 0.0, reading = 0.0, resolution = 0.0;
};

/// @param typical rms reading; the noise is 0.2 % of it up to the largest share, parts of full
///                scale and of reading at random
/// @param model   normal, t3, outliers, quantised; empty: at random
/// @throws std::invalid_argument for another model
SensorNoise random_noise(const std::string& model, double typical, double largest_share,
                         rig::DeterministicRandom& random);

/// Standard deviation at a reading, without outliers, resolution included.
double sigma_of(const SensorNoise& noise, double reading);

double with_noise(const SensorNoise& noise, double clean, rig::DeterministicRandom& random);

}  // namespace gear3k::wide_rig
