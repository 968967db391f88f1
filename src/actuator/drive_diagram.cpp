#include "actuator/drive_diagram.hpp"

#include <cmath>

#include "actuator/gear_model.hpp"

namespace gear3k::actuator {

std::vector<DrivePoint> drive_diagram(const Actuator& actuator, double most_load_Nm) {
  constexpr int kHalf = 40;
  const Chain chain = chain_of(actuator);
  const auto gear = gear_model(actuator);
  const double ratio = std::abs(chain.ratio);
  std::vector<DrivePoint> points;
  points.reserve(2 * kHalf + 1);
  for (int k = -kHalf; k <= kHalf; ++k) {
    const double load = most_load_Nm * k / kHalf;
    const RestBand band = gear->band(-load);
    const auto running = [&](double sense) {
      const GearInstant instant = gear->at({.load_Nm = -load, .sense = sense});
      return (instant.input_Nm + sense * chain.c1_Nm) / ratio;
    };
    points.push_back({.load_Nm = load,
                      .stick_low_Nm = (band.low_Nm - chain.c1_static_Nm) / ratio,
                      .stick_high_Nm = (band.high_Nm + chain.c1_static_Nm) / ratio,
                      .running_down_Nm = running(-1.0),
                      .running_up_Nm = running(1.0)});
  }
  return points;
}

}  // namespace gear3k::actuator
