#pragma once
// A bench on which the bilateral drive gear is measured by the library's own simulation.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "tests/calibrate/rig_campaign.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate {

class Bench : public testing::Test {
 protected:
  Bench() : simulation_(design_of(rig::bilateral_drive_gear()), Kind::kTransmission) {}

  /// Gives the rows of data_ the responses of a hypothesis with normal deviates.
  void measure(const Hypothesis& truth, double deviation, std::uint64_t seed) {
    rig::DeterministicRandom random(seed);
    respond(truth, [&] { return deviation * random.normal(); });
  }
  /// The same with even deviations, none of which is far enough out to count less.
  void measure_evenly(const Hypothesis& truth, double most, std::uint64_t seed) {
    rig::DeterministicRandom random(seed);
    respond(truth, [&] { return random.between(-most, most); });
  }
  [[nodiscard]] Problem problem() const {
    return {.simulation = simulation_, .data = data_, .noise = make_noise_model(data_)};
  }

  Simulation simulation_;
  MeasurementSet data_;
  Eigen::VectorXd clean_;  ///< responses without the deviations

 private:
  void respond(const Hypothesis& truth, const std::function<double()>& deviation) {
    clean_ = simulated(simulation_, data_, truth).value();
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].response = clean_[static_cast<Eigen::Index>(i)] + deviation();
    }
  }
};

}  // namespace gear3k::calibrate
