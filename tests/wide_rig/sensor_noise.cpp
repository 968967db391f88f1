#include "tests/wide_rig/sensor_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace gear3k::wide_rig {
namespace {

constexpr std::array kModels{"normal",  "t3",         "outliers", "quantised",
                             "reading", "correlated", "blocks"};

}  // namespace

SensorNoise random_noise(const std::string& model, double typical, double largest_share,
                         rig::DeterministicRandom& random) {
  SensorNoise noise{.model = model};
  const double drawn = random.uniform();
  if (model.empty()) {
    noise.model = drawn < 0.5    ? "normal"
                  : drawn < 0.68 ? "t3"
                  : drawn < 0.82 ? "outliers"
                                 : "quantised";
  } else if (std::find(kModels.begin(), kModels.end(), model) == kModels.end()) {
    throw std::invalid_argument("no noise model '" + model + "'");
  }
  const double share = 0.002 * std::pow(largest_share / 0.002, random.uniform());
  // A third each: the same everywhere, nearly all of reading, something between.
  const double which = random.uniform(), between = random.uniform();
  double of_reading = which < 0.33 ? 0.0 : which < 0.66 ? 0.98 : between;
  if (noise.model == "reading") of_reading = 0.1 + 0.8 * between;
  noise.full_scale = typical * share * std::sqrt(1.0 - of_reading);
  noise.reading = share * std::sqrt(of_reading);
  if (noise.model == "quantised") {
    noise.resolution = random.between(0.8, 2.5) * typical * share;
  }
  if (noise.model == "correlated") noise.memory = random.between(0.2, 0.7);
  if (noise.model == "blocks") {
    noise.shared = random.between(0.2, 0.5);
    noise.block_rows = 5 + static_cast<int>(random.index(16));
  }
  return noise;
}

double sigma_of(const SensorNoise& noise, double reading) {
  const double of_reading = noise.reading * reading;
  return std::sqrt(noise.full_scale * noise.full_scale + of_reading * of_reading +
                   noise.resolution * noise.resolution / 12.0);
}

double NoisyReadings::deviate(int session, rig::DeterministicRandom& random) {
  double drawn = noise_.model == "t3" ? random.student3() : random.normal();
  if (noise_.model == "outliers") {
    const bool out = random.uniform() < 0.1;
    const double far = random.between(5.0, 10.0);
    if (out) drawn = std::copysign(far, drawn);
  } else if (noise_.model == "correlated" && session == session_) {
    drawn = noise_.memory * before_ + std::sqrt(1.0 - noise_.memory * noise_.memory) * drawn;
  } else if (noise_.model == "blocks") {
    if (session != session_ || in_block_ == noise_.block_rows) {
      in_block_ = 0;
      rate_ = random.normal();
    }
    const double u = (in_block_ + 0.5) / noise_.block_rows;
    drawn = std::sqrt(1.0 - noise_.shared) * drawn + std::sqrt(3.0 * noise_.shared) * rate_ * u;
    ++in_block_;
  }
  session_ = session;
  before_ = drawn;
  return drawn;
}

double NoisyReadings::read(double clean, int session, rig::DeterministicRandom& random) {
  const double of_reading = noise_.reading * clean;
  const double sd = std::sqrt(noise_.full_scale * noise_.full_scale + of_reading * of_reading);
  const double value = clean + sd * deviate(session, random);
  return noise_.resolution > 0.0 ? std::round(value / noise_.resolution) * noise_.resolution
                                 : value;
}

}  // namespace gear3k::wide_rig
