// Motions against those of benchmarks/peers/motion_reference.py, SciPy's DOP853 at 1e-13 with its
// own text of the equations; tests/golden/motion has what it printed (SciPy 1.10.1).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/files/actuator_file.hpp"
#include "io/files/scenario_file.hpp"
#include "motion/simulate.hpp"

namespace gear3k::motion_reference_test {
namespace {

struct ReferenceEvent {
  double time_s = 0.0;
  std::string what;
};
struct Reference {
  std::vector<ReferenceEvent> events;
  double angle_rad = 0.0, speed_rad_s = 0.0;
};

std::string golden(const std::string& name) {
  return std::string(GEAR3K_SOURCE_DIR) + "/tests/golden/motion/" + name;
}

Reference read_reference(const std::string& name) {
  Reference r;
  std::ifstream file(golden(name));
  EXPECT_TRUE(file) << name;
  for (std::string line; std::getline(file, line);) {
    const auto number_after = [&](const char* key) {
      return std::stod(line.substr(line.find(key) + std::string(key).size()));
    };
    if (line.starts_with("time_s")) continue;
    if (line.starts_with("# output_angle_rad:")) {
      r.angle_rad = number_after(":");
    } else if (line.starts_with("# output_speed_rad_s:")) {
      r.speed_rad_s = number_after(":");
    } else {
      const std::size_t comma = line.find(',');
      if (line.substr(comma + 1) != "end") {
        r.events.push_back({std::stod(line.substr(0, comma)), line.substr(comma + 1)});
      }
    }
  }
  return r;
}

class MotionReference : public testing::TestWithParam<std::pair<const char*, const char*>> {};

// Times of events within 1e-8 s at a relative tolerance of 1e-10.
TEST_P(MotionReference, HasTheEventsOfAnotherIntegratorAndText) {
  const auto [drive, what] = GetParam();
  const Reference expected = read_reference(fmt::format("{}.{}.events.csv", drive, what));
  const auto actuator = io::read_actuator(golden(std::string(drive) + ".toml")).actuator;
  auto scenario = io::read_scenario(golden(std::string(what) + ".toml")).scenario;
  scenario.solver.relative_tolerance = 1e-10;
  const auto m = motion::simulate(actuator, scenario);
  ASSERT_EQ(m.events.size(), expected.events.size());
  for (std::size_t k = 0; k < m.events.size(); ++k) {
    EXPECT_EQ(m.events[k].what, expected.events[k].what) << k;
    EXPECT_NEAR(m.events[k].time_s, expected.events[k].time_s, 1e-8) << k;
  }
  EXPECT_NEAR(m.end.sides.output_rad, expected.angle_rad,
              1e-8 * (1.0 + std::abs(expected.angle_rad)));
  EXPECT_NEAR(m.end.sides.output_rad_s, expected.speed_rad_s, 1e-7);
  EXPECT_LT(m.ledger.balance_error, 1e-9);
  std::set<std::pair<int, int>> senses_and_flows;
  bool rests = false;
  for (const auto& row : m.rows) {
    rests = rests || row.mode.phase == motion::Phase::kStick;
    if (row.mode.phase == motion::Phase::kSlide) {
      senses_and_flows.insert({row.mode.sense, row.mode.flow});
    }
  }
  EXPECT_TRUE(rests);
  // A motor that is shorted is driven, and no more.
  if (std::string(what) == "left") return;
  EXPECT_GE(m.events.size(), 12U);
  EXPECT_EQ(senses_and_flows.size(), 4U);
}

INSTANTIATE_TEST_SUITE_P(
    Motions, MotionReference,
    testing::Values(std::pair("drive", "swung"), std::pair("drive", "held"),
                    std::pair("drive", "left"), std::pair("drive_with_gap", "swung"),
                    std::pair("drive_with_gap", "held"), std::pair("drive_with_gap", "shaken")),
    [](const auto& what) { return fmt::format("{}_{}", what.param.first, what.param.second); });

}  // namespace
}  // namespace gear3k::motion_reference_test
