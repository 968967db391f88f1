#include "calibrate/search/search.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/friction_jump.hpp"
#include "tests/calibrate/measured_grid.hpp"
#include "units/units.hpp"

namespace gear3k::calibrate::search_test {
namespace {

std::vector<std::string> names_of(const SearchResult& result) {
  std::vector<std::string> names;
  for (const Candidate& c : result.fit.hypothesis.effects) names.emplace_back(c.cause->id);
  std::ranges::sort(names);
  return names;
}

using Names = std::vector<std::string>;

class Search : public Bench {
 protected:
  [[nodiscard]] SearchResult search(const SearchResult* known = nullptr) const {
    return search_causes(problem(), candidates_for(simulation_, data_), {}, known);
  }
  static bool could_be(const FoundEffect& effect, const std::string& id) {
    return std::ranges::any_of(effect.replacements,
                               [&](const Replacement& r) { return r.candidate.cause->id == id; });
  }
};

TEST_F(Search, NamesFrictionForAnyLossInProportionToTheLoadOfForwardData) {
  // One line through the origin: nothing tells what makes it steeper, and the coefficient of
  // friction is the one that needs no new physics.
  data_ = measured_grid({.sun_speeds_rpm = {600.0},
                         .directions = {design::Direction::kForward},
                         .rotations = {1},
                         .repeats = 10});
  const Hypothesis gain = hypothesis({candidate("sensor_gain", {.name = "gain"})}, {0.03});
  const Hypothesis bearing =
      hypothesis({candidate("bearing_load", {.name = "output_bearing", .body = "output"})}, {0.03});
  const Hypothesis direction =
      hypothesis({candidate("friction_direction", {.name = "forward"})}, {0.2});
  for (const Hypothesis& hidden : {gain, bearing, direction}) {
    const std::string id(hidden.effects[0].cause->id);
    measure(hidden, 0.002, 1);
    const SearchResult result = search();
    ASSERT_EQ(result.effects.size(), 1U) << id;
    EXPECT_EQ(result.fit.hypothesis.effects[0].cause->id, "friction_level") << id;
    EXPECT_TRUE(could_be(result.effects[0], id)) << id;
  }
}

TEST_F(Search, NamesAStepWhereSessionsAreInTheOrderOfALaw) {
  // A torque that is there from the second session on, which is the one at speed.
  data_ = measured_grid({.sun_speeds_rpm = {2.0, 1000.0},
                         .directions = {design::Direction::kForward},
                         .rotations = {1},
                         .repeats = 10});
  data_.runs = {"slow", "fast"};
  for (Observation& row : data_.rows) {
    row.condition.run = row.condition.sun_speed_rad_s > 1.0 ? 1 : 0;
  }
  const Hypothesis drag =
      hypothesis({candidate("drag_viscous", {.name = "sun", .body = "sun"})}, {2e-4});
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    measure(drag, 0.004, seed);
    const SearchResult result = search();
    ASSERT_EQ(result.effects.size(), 1U);
    EXPECT_EQ(result.fit.hypothesis.effects[0].cause->id, "run_step");
    EXPECT_TRUE(could_be(result.effects[0], "drag_viscous"));
  }
}

TEST_F(Search, KnowsWhatAStepOfAFewRowsActsOnHoweverFarItIsAboveTheNoise) {
  // In one session of eight the friction falls by a half: its rows are far off, and the farther
  // the more load they have.
  data_ =
      measured_grid({.output_torques_Nm = {5.0, 20.0, 35.0, 50.0}, .rotations = {1}, .repeats = 8});
  const std::size_t rows = data_.rows.size() / 8;
  for (int run = 0; run < 8; ++run) data_.runs.push_back("s" + std::to_string(run + 1));
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.run = static_cast<int>(i / rows);
  }
  const Form last{.name = "from_friction",
                  .constants = {{.name = "first_run", .unit = "", .value = 7.0}},
                  .law = kOnFriction};
  for (const double noise : {0.01, 0.002}) {
    measure(hypothesis({candidate("run_step", last)}, {-0.5}), noise, 4);
    const SearchResult result = search();
    ASSERT_EQ(result.effects.size(), 1U) << noise;
    EXPECT_EQ(result.fit.hypothesis.effects[0].form.name, "from_friction") << noise;
  }
}

TEST_F(Search, CallsAZeroErrorThatCreepsAZeroError) {
  data_ = measured_grid({.repeats = 6});
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.time_s = 60.0 * static_cast<double>(i);
  }
  const double last = data_.rows.back().condition.time_s;
  measure({}, 0.001, 5);
  // In the sensor's own sign: a quarter more at the end than at the start.
  for (Observation& row : data_.rows) {
    const double offset = 0.02 * (1.0 + 0.25 * -std::expm1(-3.0 * row.condition.time_s / last));
    const double way = row.condition.direction == design::Direction::kForward ? 1.0 : -1.0;
    row.response += way * row.condition.rotation * offset;
  }
  const SearchResult result = search();
  EXPECT_TRUE(std::ranges::any_of(result.fit.hypothesis.effects, [](const Candidate& c) {
    return c.cause->id == "sensor_offset";
  }));
}

TEST_F(Search, NamesTheLoadWhereFrictionFallsFromOneLevelToAnother) {
  // A fall that no power and no bend has, and that a drag beside another level comes near to.
  data_ = measured_grid({.sun_speeds_rpm = {200.0, 600.0},
                         .output_torques_Nm = {5.0, 7.0, 10.0, 14.0, 20.0, 28.0, 40.0, 56.0},
                         .rotations = {1},
                         .repeats = 4});
  const double middle = std::sqrt(5.0 * 56.0);
  const Hypothesis fall = hypothesis(
      {candidate("friction_load",
                 {.name = "any_smooth_fine_by_torque",
                  .constants = {{.name = "reference_torque", .unit = "Nm", .value = middle},
                                {.name = "log_half_range",
                                 .unit = "",
                                 .value = 0.5 * std::log(56.0 / 5.0)}}})},
      {0.0, 0.3, 0.3, 0.25, -0.25, -0.3, -0.3});
  measure(fall, 1e-3, 5);
  const SearchResult result = search();
  ASSERT_EQ(result.effects.size(), 1U);
  const Candidate& found = result.fit.hypothesis.effects.front();
  EXPECT_EQ(found.cause->id, "friction_load");
  EXPECT_TRUE(found.form.name.starts_with("any_smooth")) << found.form.name;
  EXPECT_LT((result.fit.simulated - clean_).norm() / std::sqrt(static_cast<double>(clean_.size())),
            1e-3);
}

TEST_F(Search, NamesTheLoadWhereFrictionJumpsBetweenTwoOfFourLevels) {
  constexpr double kNoise = 5e-4;
  data_ = friction_jump(kNoise, 5);
  const SearchResult result = search();
  ASSERT_EQ(result.effects.size(), 1U);
  EXPECT_EQ(result.fit.hypothesis.effects.front().cause->id, "friction_load");
  EXPECT_LT(robust_deviation(result.fit.residual), 1.3 * kNoise);
  // No power and no bend goes so.
  const std::string& form = result.fit.hypothesis.effects.front().form.name;
  EXPECT_TRUE(form.starts_with("any_smooth_4_levels")) << form;
}

/// Rows of which no cause takes off more than luck by itself: friction by direction, and a wave of
/// it with the teeth.
class SearchOfTwoInFewRows : public Search {
 protected:
  SearchOfTwoInFewRows() {
    data_ = measured_grid(
        {.sun_speeds_rpm = {300.0, 3000.0}, .output_torques_Nm = {5.0, 27.5, 50.0}, .repeats = 1});
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      // In no order of loads and directions.
      const auto place = static_cast<double>((7 * i + 3) % data_.rows.size());
      data_.rows[i].condition.output_angle_rad = 11.9 * units::kDegree * (place + 1.0);
      data_.rows[i].sigma = kNoise_Nm;
    }
    hidden_ =
        hypothesis({of("friction_direction", "forward_backward"), of("mesh_order", "friction")},
                   {-0.3, 0.46, 0.19});
  }
  [[nodiscard]] Candidate of(std::string_view id, std::string_view form) const {
    for (const Candidate& c : candidates_for(simulation_, data_)) {
      if (c.cause->id == id && c.form.name == form) return c;
    }
    ADD_FAILURE() << id << ' ' << form;
    return {};
  }
  static constexpr double kNoise_Nm = 0.003;
  Hypothesis hidden_;
};

TEST_F(SearchOfTwoInFewRows, NamesTheTwoThatLeaveWhatTheRowsState) {
  for (const std::uint64_t seed : {1U, 2U}) {
    measure(hidden_, kNoise_Nm, seed);
    const SearchResult result = search();
    const double greatest = std::ranges::max(result.first_gains, {}, &Gain::evidence).evidence;
    EXPECT_GT(result.first_luck.p_value(greatest), SearchOptions{}.rate);
    EXPECT_LT(result.first_p, 1e-4);
    EXPECT_EQ(names_of(result), (Names{"friction_direction", "mesh_order"})) << seed;
  }
}

TEST_F(SearchOfTwoInFewRows, NamesNoneWhereTheRowsOnlyScatterMoreThanTheyState) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    measure({}, 5.0 * kNoise_Nm, seed);
    found += search().effects.empty() ? 0 : 1;
  }
  EXPECT_LE(found, 4);  // P(X >= 5 of 20) at 4 % is 0.001
}

TEST_F(SearchOfTwoInFewRows, TakesWhatWasKnownWhereItIsClearlyBetter) {
  measure(hidden_, kNoise_Nm, 1);
  const SearchResult known = search();
  ASSERT_EQ(known.effects.size(), 2U);
  for (Observation& row : data_.rows) row.sigma = kUnknown;
  EXPECT_EQ(names_of(search()), Names{});
  const SearchResult taken = search(&known);
  EXPECT_EQ(names_of(taken), (Names{"friction_direction", "mesh_order"}));
  EXPECT_EQ(taken.first_p, known.first_p);
  measure({}, kNoise_Nm, 1);
  EXPECT_EQ(names_of(search(&known)), Names{});
}

TEST_F(Search, FindsNothingInNoise) {
  data_ = measured_grid({.repeats = 2});
  constexpr int kCases = 40;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    measure({}, 0.004, seed);
    const SearchResult result = search();
    found += result.effects.empty() ? 0 : 1;
    // What is named has passed the test, and has paid for its parameters.
    EXPECT_TRUE(result.effects.empty() || result.first_p <= SearchOptions{}.rate);
  }
  // The rate asked for is 4 %: P(X ≥ 8 of 40) < 0.001.
  EXPECT_LE(found, 7);
}

TEST_F(Search, FindsCausesThatActTogether) {
  // Each far above the noise, and told apart by direction, rotation and speed.
  data_ = measured_grid({.repeats = 4});
  const Hypothesis hidden = hypothesis({candidate("friction_level", {.name = "coefficient"}),
                                        candidate("drag_viscous", {.name = "sun", .body = "sun"}),
                                        candidate("sensor_offset", {.name = "offset"})},
                                       {0.3, 2e-4, 0.02});
  measure(hidden, 0.004, 9);
  const SearchResult result = search();
  ASSERT_EQ(result.effects.size(), 3U);
  for (const Candidate& c : hidden.effects) {
    const auto& effects = result.fit.hypothesis.effects;
    const auto at = static_cast<std::size_t>(
        std::ranges::find(effects, c.cause, &Candidate::cause) - effects.begin());
    ASSERT_LT(at, effects.size()) << c.cause->id;
    const auto k = static_cast<std::size_t>(
        std::ranges::find(hidden.effects, c.cause, &Candidate::cause) - hidden.effects.begin());
    EXPECT_NEAR(values_of(result.fit.hypothesis, at)[0], hidden.value[k],
                0.2 * std::abs(hidden.value[k]))
        << c.cause->id;
    EXPECT_GT(result.effects[at].delta_bic, 10.0) << c.cause->id;
  }
}

/// Rows of another kind than transmission, as the library simulates them, with normal deviates.
SearchResult search_in(const Simulation& simulation, MeasurementSet data, const Hypothesis& hidden,
                       double deviation, std::uint64_t seed) {
  rig::DeterministicRandom random(seed);
  const Eigen::VectorXd clean = simulated(simulation, data, hidden).value();
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    data.rows[i].response = clean[static_cast<Eigen::Index>(i)] + deviation * random.normal();
  }
  const Problem problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
  return search_causes(problem, candidates_for(simulation, data), {});
}

TEST(SearchOfPairs, TellsFrictionByTheGearThatDrivesFromNoDifference) {
  const Simulation simulation(pair_of(design_of(rig::bilateral_drive_gear())), Kind::kPairLoss);
  MeasurementSet data;
  data.kind = Kind::kPairLoss;
  for (const int driving : {18, 24, 31, 43, 60, 85}) {
    for (const int driven : {18, 24, 31, 43, 60, 85}) {
      if (driving == driven) continue;
      Observation row;
      row.condition.driving_teeth = driving;
      row.condition.driven_teeth = driven;
      data.rows.push_back(row);
    }
  }
  const Hypothesis pinion =
      hypothesis({candidate("friction_direction", {.name = "driving_pinion", .law = kOnFriction},
                            Kind::kPairLoss)},
                 {0.1});
  constexpr double kNoise = 1e-4;
  EXPECT_EQ(names_of(search_in(simulation, data, pinion, kNoise, 1)), Names{"friction_direction"});
  EXPECT_EQ(names_of(search_in(simulation, data, {}, kNoise, 1)), Names{});
}

TEST(SearchOfLostMotion, TellsPlayFromWindUpThatIsSoftAtItsBeginning) {
  const Simulation simulation(design_of(rig::bilateral_drive_gear()), Kind::kLostMotion);
  MeasurementSet data;
  data.kind = Kind::kLostMotion;
  for (int repeat = 0; repeat < 8; ++repeat) {
    for (const double torque_Nm : {0.5, 1.0, 2.0, 4.0, 8.0}) {
      Observation row;
      row.condition.test_torque_Nm = torque_Nm;
      data.rows.push_back(row);
    }
  }
  const Candidate play = candidate("clearance", {.name = "constant"}, Kind::kLostMotion);
  // Contact of points (Hertz): the approach goes with the torque to the power 2/3.
  const Candidate points =
      candidate("compliance",
                {.name = "hardening",
                 .constants = {{.name = "hardening_torque", .unit = "Nm", .value = 8.0}}},
                Kind::kLostMotion);
  const double noise_rad = 0.05 * units::kArcmin;
  EXPECT_EQ(names_of(search_in(simulation, data, hypothesis({play, points}, {2.0, 0.2, 1.0 / 3.0}),
                               noise_rad, 1)),
            (Names{"clearance", "compliance"}));
  EXPECT_EQ(
      names_of(search_in(simulation, data, hypothesis({points}, {0.2, 1.0 / 3.0}), noise_rad, 1)),
      Names{"compliance"});
  EXPECT_EQ(names_of(search_in(simulation, data, {}, noise_rad, 1)), Names{});
}

/// Lost motion of joints whose stiffness grows with the torque, K = K_0 (1 + (T/T_p)^power), by
/// sums over small steps of the torque; arcmin both ways.
double wound_arcmin(double torque_Nm, double soft_arcmin_Nm, double preload_Nm, double power) {
  constexpr int kSteps = 2000;
  double wound = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double at_Nm = (k + 0.5) * torque_Nm / kSteps;
    wound += torque_Nm / kSteps * soft_arcmin_Nm / (1.0 + std::pow(at_Nm / preload_Nm, power));
  }
  return 2.0 * wound;
}

TEST(SearchOfLostMotion, NamesOneWindUpWhoseStiffnessGrowsWithTheTorque) {
  const Simulation simulation(design_of(rig::bilateral_drive_gear()), Kind::kLostMotion);
  const auto found = [&](double soft_arcmin_Nm, double power, std::uint64_t seed) {
    rig::DeterministicRandom random(seed);
    MeasurementSet data;
    data.kind = Kind::kLostMotion;
    for (int repeat = 0; repeat < 25; ++repeat) {
      for (const double torque_Nm : {2.5, 8.0, 18.0}) {
        Observation row;
        row.condition.test_torque_Nm = torque_Nm;
        const double wound = wound_arcmin(torque_Nm, soft_arcmin_Nm, 7.0, power);
        row.response = rig::lost_motion_arcmin(rig::bilateral_drive_gear(),
                                               {.output_torque_Nm = 3.0, .temperature_c = 20.0}) +
                       wound + 0.1 * random.normal();
        row.response *= units::kArcmin;
        data.rows.push_back(row);
      }
    }
    const Problem problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
    return search_causes(problem, candidates_for(simulation, data), {});
  };
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const SearchResult growing = found(0.14, 1.0, seed);
    EXPECT_EQ(names_of(growing), Names{"compliance"}) << seed;
    EXPECT_EQ(growing.fit.hypothesis.effects.front().form.name, "preloaded") << seed;
    // Straight, stiffness does not change: nothing of the kind.
    const SearchResult straight = found(0.14, 0.0, seed);
    EXPECT_EQ(names_of(straight), Names{"compliance"}) << seed;
    EXPECT_EQ(straight.fit.hypothesis.effects.front().form.name, "output") << seed;
    const Names of_noise = names_of(found(0.0, 1.0, seed));
    EXPECT_EQ(std::ranges::count(of_noise, "compliance"), 0) << seed;
  }
}

/// Wind-up of a joint that stiffens in three pieces, as its slopes add up; arcmin.
double wound_in_pieces_arcmin(double torque_Nm) {
  double wound = 0.0;
  constexpr std::array<double, 4> kEnd_Nm{0.0, 5.0, 12.0, 1e9};
  constexpr std::array<double, 3> kSlope{0.28, 0.15, 0.06};  // arcmin/Nm
  for (std::size_t k = 0; k < kSlope.size(); ++k) {
    wound += kSlope[k] * (std::clamp(torque_Nm, kEnd_Nm[k], kEnd_Nm[k + 1]) - kEnd_Nm[k]);
  }
  return wound;
}

TEST(SearchOfLostMotion, NamesASmallWindUpBesideMuchPlay) {
  const Simulation simulation(design_of(rig::bilateral_drive_gear()), Kind::kLostMotion);
  const auto named = [&](double soft_arcmin_Nm, std::uint64_t seed) {
    rig::DeterministicRandom random(seed);
    MeasurementSet data;
    data.kind = Kind::kLostMotion;
    for (int repeat = 0; repeat < 20; ++repeat) {
      for (const double torque_Nm : {2.0, 6.0, 10.0, 14.0, 18.0}) {
        Observation row;
        row.condition.test_torque_Nm = torque_Nm;
        row.sigma = 0.2 * units::kArcmin;
        row.response = rig::lost_motion_arcmin(rig::bilateral_drive_gear(),
                                               {.output_torque_Nm = 3.0, .temperature_c = 20.0}) +
                       6.0 + soft_arcmin_Nm * (torque_Nm - 10.0) + 0.2 * random.normal();
        row.response *= units::kArcmin;
        data.rows.push_back(row);
      }
    }
    const Problem problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
    return names_of(search_causes(problem, candidates_for(simulation, data), {}));
  };
  for (const std::uint64_t seed : {5U, 6U, 7U}) {
    // 0.34 arcmin about 6 arcmin: 0.3 % of the squares are left; 1.6 times the noise.
    EXPECT_EQ(named(0.09, seed), (Names{"clearance", "compliance"})) << seed;
    EXPECT_EQ(named(0.0, seed), Names{"clearance"}) << seed;
  }
}

TEST(SearchOfLostMotion, NamesPlayBesideAWindUpThatStiffensInPieces) {
  const Simulation simulation(design_of(rig::bilateral_drive_gear()), Kind::kLostMotion);
  for (const double noise_arcmin : {0.3, 0.15, 0.08}) {
    rig::DeterministicRandom random(41);
    MeasurementSet data;
    data.kind = Kind::kLostMotion;
    for (int repeat = 0; repeat < 14; ++repeat) {
      for (const double torque_Nm : {1.2, 4.5, 8.2, 12.0, 15.0, 18.2, 22.0}) {
        Observation row;
        row.condition.test_torque_Nm = torque_Nm;
        row.sigma = noise_arcmin * units::kArcmin;
        row.response = rig::lost_motion_arcmin(rig::bilateral_drive_gear(),
                                               {.output_torque_Nm = 3.0, .temperature_c = 20.0}) +
                       2.5 + wound_in_pieces_arcmin(torque_Nm) + noise_arcmin * random.normal();
        row.response *= units::kArcmin;
        data.rows.push_back(row);
      }
    }
    const Problem problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
    const SearchResult found = search_causes(problem, candidates_for(simulation, data), {});
    EXPECT_EQ(names_of(found), (Names{"clearance", "compliance"})) << noise_arcmin;
    // Nothing of it is left: rows scatter as they were made to.
    EXPECT_LT(found.fit.sum_of_squares, 1.25 * static_cast<double>(data.rows.size()))
        << noise_arcmin;
  }
}

}  // namespace
}  // namespace gear3k::calibrate::search_test
