#pragma once

#include <string>

#include "tests/rig/deterministic_random.hpp"

namespace gear3k::wide_rig {

/// Noise of a sensor: sqrt(full_scale^2 + (reading y)^2), drawn as its model says:
///
/// - normal; t3: Student's t with 3 degrees of freedom (same standard deviation); outliers: normal
///   with 10 % of 5 to 10 sigma; quantised: normal, then rounded to a resolution
/// - reading: normal, with a part of full scale and one of reading, neither below a tenth of the
///   variance
/// - correlated: each reading remembers the one before, x_i = memory x_(i-1) + sqrt(1 - memory^2)
///   z_i within a session (first-order autoregression)
/// - blocks: the zero creeps evenly from each zeroing to the next, at a rate of its own each time:
///   sqrt(1 - shared) z + sqrt(3 shared) r u, with u from 0 to 1 within the block
struct SensorNoise {
  std::string model;
  double full_scale = 0.0, reading = 0.0, resolution = 0.0;
  double memory = 0.0;  ///< correlated: of one row to the next
  double shared = 0.0;  ///< blocks: share of the variance
  int block_rows = 1;   ///< blocks: from zeroing to zeroing
};

/// @param typical rms reading; the noise is 0.2 % of it up to the largest share, parts of full
///                scale and of reading at random
/// @param model   one of those of SensorNoise; empty: at random, with neither correlated nor blocks
/// @throws std::invalid_argument for another model
SensorNoise random_noise(const std::string& model, double typical, double largest_share,
                         rig::DeterministicRandom& random);

/// Standard deviation at a reading, without outliers, resolution included.
double sigma_of(const SensorNoise& noise, double reading);

/// Readings one after the other, in the order in which they are taken.
class NoisyReadings {
 public:
  explicit NoisyReadings(const SensorNoise& noise) : noise_(noise) {}
  double read(double clean, int session, rig::DeterministicRandom& random);

 private:
  double deviate(int session, rig::DeterministicRandom& random);

  SensorNoise noise_;
  int session_ = -1;     // of the reading before
  double before_ = 0.0;  // its deviate
  int in_block_ = 0;
  double rate_ = 0.0;
};

}  // namespace gear3k::wide_rig
