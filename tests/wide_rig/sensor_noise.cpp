#include "tests/wide_rig/sensor_noise.hpp"

#include <cmath>
#include <stdexcept>

namespace gear3k::wide_rig {

SensorNoise random_noise(const std::string& model, double typical, double largest_share,
                         rig::DeterministicRandom& random) {
  SensorNoise noise{.model = model};
  const double drawn = random.uniform();
  if (model.empty()) {
    noise.model = drawn < 0.5    ? "normal"
                  : drawn < 0.68 ? "t3"
                  : drawn < 0.82 ? "outliers"
                                 : "quantised";
  } else if (model != "normal" && model != "t3" && model != "outliers" && model != "quantised") {
    throw std::invalid_argument("no noise model '" + model + "'");
  }
  const double share = 0.002 * std::pow(largest_share / 0.002, random.uniform());
  // A third each: the same everywhere, nearly all of reading, something between.
  const double which = random.uniform(), between = random.uniform();
  const double of_reading = which < 0.33 ? 0.0 : which < 0.66 ? 0.98 : between;
  noise.full_scale = typical * share * std::sqrt(1.0 - of_reading);
  noise.reading = share * std::sqrt(of_reading);
  if (noise.model == "quantised") {
    noise.resolution = random.between(0.8, 2.5) * typical * share;
  }
  return noise;
}

double sigma_of(const SensorNoise& noise, double reading) {
  const double of_reading = noise.reading * reading;
  return std::sqrt(noise.full_scale * noise.full_scale + of_reading * of_reading +
                   noise.resolution * noise.resolution / 12.0);
}

double with_noise(const SensorNoise& noise, double clean, rig::DeterministicRandom& random) {
  const double of_reading = noise.reading * clean;
  const double sd = std::sqrt(noise.full_scale * noise.full_scale + of_reading * of_reading);
  double drawn = noise.model == "t3" ? random.student3() : random.normal();
  if (noise.model == "outliers") {
    const bool out = random.uniform() < 0.1;
    const double far = random.between(5.0, 10.0);
    if (out) drawn = std::copysign(far, drawn);
  }
  const double value = clean + sd * drawn;
  return noise.resolution > 0.0 ? std::round(value / noise.resolution) * noise.resolution : value;
}

}  // namespace gear3k::wide_rig
