#include "tests/calibrate/built_design.hpp"

#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace gear3k::rig {

Gearbox built(const design::Design& design) {
  const auto& train = design.train;
  constexpr double kMillimetre = 1e-3;
  constexpr double kDegree = std::numbers::pi / 180.0;
  Gearbox gearbox{.name = design.name, .planets = train.planets};
  const double addendum = train.rack.front().addendum;
  for (std::size_t gear = 0; gear < gearbox.teeth.size(); ++gear) {
    if (train.tip_shortening[gear] != 0.0 || train.khk_tip[gear] ||
        train.rack[gear].addendum != addendum) {
      throw std::invalid_argument("built: the rig has full teeth of one rack");
    }
    gearbox.profile_shift[gear] = train.profile_shift[gear];
    gearbox.machining_allowance[gear] = train.machining_allowance[gear];
  }
  gearbox.teeth = train::teeth_of(train.teeth);
  gearbox.module1_mm = train.module_m[0] / kMillimetre;
  gearbox.module2_mm = train.module_m[1] / kMillimetre;
  gearbox.pressure_angle_deg = train.pressure_angle_rad / kDegree;
  gearbox.center_distance_mm = train.center_distance_m / kMillimetre;
  gearbox.addendum = addendum;
  gearbox.friction = design.friction.coefficient;
  return gearbox;
}

double measured_efficiency(const Gearbox& gearbox, const Condition& condition,
                           const std::vector<HiddenCause>& causes) {
  // Without losses: T_S = T_R2/|ratio|.
  const double lossless = condition.output_torque_Nm / std::abs(make_train(gearbox).ratio);
  const double torque = sun_torque(gearbox, condition, causes);
  return condition.forward ? lossless / torque : torque / lossless;
}

std::array<std::string, 2> halves_by_session(const std::string& csv) {
  std::array<std::string, 2> halves;
  std::istringstream lines(csv);
  std::map<std::string, std::size_t> half_of;
  bool header = true;
  for (std::string line; std::getline(lines, line);) {
    if (header) {
      for (std::string& half : halves) half += line + '\n';
      header = line.starts_with('#');
      continue;
    }
    const std::string run = line.substr(line.rfind(',') + 1);
    const auto [at, added] = half_of.emplace(run, half_of.size() % 2);
    halves[at->second] += line + '\n';
  }
  return halves;
}

}  // namespace gear3k::rig
