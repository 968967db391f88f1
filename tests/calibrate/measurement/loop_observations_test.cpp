#include "calibrate/measurement/loop_observations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::loop_observations_test {
namespace {

constexpr double kArcmin = std::numbers::pi / 10800.0;

/// A dead band in series with a spring, behind dry friction.
struct Shaft {
  double dead_band_rad = 20.0 * kArcmin;
  double stiffness_Nm_rad = 2000.0;
  double friction_Nm = 0.4;
  double peak_Nm = 5.0;
};

/// Torque in triangles; the part of it that reaches the spring follows by the play operator.
TorqueAngleRecord wind_up(const Shaft& shaft, int loops, int samples_per_loop = 800) {
  TorqueAngleRecord record;
  double inside = 0.0;
  for (int k = 0; k <= loops * samples_per_loop; ++k) {
    const double phase = static_cast<double>(k % samples_per_loop) / samples_per_loop;
    double triangle = 4.0 * phase;
    if (phase >= 0.25) triangle = 2.0 - 4.0 * phase;
    if (phase >= 0.75) triangle = 4.0 * phase - 4.0;
    const double torque = shaft.peak_Nm * triangle;
    inside = std::clamp(inside, torque - shaft.friction_Nm, torque + shaft.friction_Nm);
    const double side = inside > 0.0 ? 0.5 : inside < 0.0 ? -0.5 : 0.0;
    record.time_s.push_back(0.05 * k);
    record.torque_Nm.push_back(torque);
    record.angle_rad.push_back(inside / shaft.stiffness_Nm_rad + side * shaft.dead_band_rad);
  }
  return record;
}

/// What the shaft would give between -T and +T without friction.
double travel_of(const Shaft& shaft, double torque_Nm) {
  return shaft.dead_band_rad + 2.0 * torque_Nm / shaft.stiffness_Nm_rad;
}

TEST(LoopObservations, AreDeadBandPlusWindUpWithoutTheFriction) {
  const Shaft shaft;
  const LoopObservations found =
      loop_observations({{.samples = wind_up(shaft, 4), .name = "a.csv"}}, 96.0);
  ASSERT_GE(found.measured, 2);
  ASSERT_EQ(found.rows.size(), static_cast<std::size_t>(found.measured) * 7U);
  for (const Observation& row : found.rows) {
    // The filter of the loops rounds flanks off by less than a per cent.
    EXPECT_NEAR(row.response, travel_of(shaft, row.condition.test_torque_Nm),
                0.01 * shaft.dead_band_rad)
        << row.condition.test_torque_Nm;
  }
}

TEST(LoopObservations, WhatDriftsWithinALoopIsThatOfTheRowsTime) {
  const Shaft shaft;
  constexpr double kDrift_s = 0.02 * kArcmin;  // of the dead band, per second
  TorqueAngleRecord record = wind_up(shaft, 4);
  const std::vector<double> still = record.angle_rad;
  for (std::size_t k = 0; k < still.size(); ++k) {
    // The flank that carries moves out by half of it.
    const double side = std::copysign(0.5, still[k]);
    if (std::abs(still[k]) >= 0.5 * shaft.dead_band_rad) {
      record.angle_rad[k] += side * kDrift_s * record.time_s[k];
    }
  }
  const LoopObservations found = loop_observations({{.samples = record}}, 96.0);
  ASSERT_GE(found.rows.size(), 14U);
  double earliest = HUGE_VAL, latest = 0.0;
  for (std::size_t k = 0; k < 7; ++k) {
    const Condition& c = found.rows[k].condition;
    earliest = std::min(earliest, c.time_s);
    latest = std::max(latest, c.time_s);
    EXPECT_NEAR(found.rows[k].response - kDrift_s * c.time_s, travel_of(shaft, c.test_torque_Nm),
                0.01 * shaft.dead_band_rad)
        << c.test_torque_Nm;
  }
  // 0.5 of the peak is an eighth of a loop of 40 s.
  EXPECT_GT(latest - earliest, 4.0);
}

TEST(LoopObservations, RowsScatterInProportionWhereTheAngleAndMeansOverABandDo) {
  rig::DeterministicRandom random(5);
  std::vector<double> zero_off, travel_off;
  double stated = 0.0;
  constexpr int kRecords = 40;
  const Shaft shaft{.friction_Nm = 0.8, .peak_Nm = 8.0};
  const LoopObservations still = loop_observations({{.samples = wind_up(shaft, 2, 400)}}, 96.0);
  for (int k = 0; k < kRecords; ++k) {
    TorqueAngleRecord record = wind_up(shaft, 2, 400);
    for (double& angle : record.angle_rad) angle += 1e-5 * random.normal();
    const LoopObservations found = loop_observations({{.samples = record}}, 96.0);
    ASSERT_EQ(found.rows.size(), still.rows.size());
    stated += found.rows[0].scatter / kRecords;
    for (std::size_t row = 0; row < found.rows.size(); ++row) {
      const bool is_zero = found.rows[row].condition.test_torque_Nm == 0.0;
      EXPECT_TRUE(is_zero || found.rows[row].scatter == 1.0);
      // What friction takes off is an error in common: travels count about their own mean.
      (is_zero ? zero_off : travel_off)
          .push_back(found.rows[row].response - still.rows[row].response);
    }
  }
  const auto variance = [](const std::vector<double>& off, std::size_t of_one_record) {
    double squares = 0.0;
    for (std::size_t k = 0; k < off.size(); k += of_one_record) {
      double mean = 0.0;
      for (std::size_t j = 0; j < of_one_record; ++j)
        mean += off[k + j] / static_cast<double>(of_one_record);
      for (std::size_t j = 0; j < of_one_record; ++j) {
        squares += (off[k + j] - mean) * (off[k + j] - mean);
      }
    }
    const std::size_t records = off.size() / of_one_record;
    return squares / static_cast<double>(records * (of_one_record - 1));
  };
  const std::size_t loops = still.rows.size() / 7;
  ASSERT_GE(loops, 2U);
  const double measured = std::sqrt(variance(zero_off, loops) / variance(travel_off, 6 * loops));
  EXPECT_GT(measured, 1.2);
  // At zero torque the greater of two estimates of its noise is stated.
  EXPECT_GT(stated, 0.8 * measured);
  EXPECT_LT(stated, 1.5 * measured);
}

/// Loops whose play differs from one to the next, as no sampling rate takes out.
TorqueAngleRecord uneven_loops(int samples_per_loop, double noise_rad,
                               rig::DeterministicRandom& random) {
  TorqueAngleRecord record = wind_up({}, 6, samples_per_loop);
  double shift = 0.0;
  for (std::size_t k = 0; k < record.angle_rad.size(); ++k) {
    if (k % static_cast<std::size_t>(samples_per_loop) == 0) shift = 3e-5 * random.normal();
    record.time_s[k] = 40.0 * static_cast<double>(k) / samples_per_loop;
    record.angle_rad[k] += std::copysign(shift, record.angle_rad[k]) + noise_rad * random.normal();
  }
  return record;
}

TEST(LoopObservations, NoSessionOutweighsAnotherForItsSamplingRateOrItsSensor) {
  rig::DeterministicRandom random(17);
  TorqueAngleRecord both = uneven_loops(6000, 5e-6, random);
  std::vector<std::string> run(both.time_s.size(), "fast");
  const TorqueAngleRecord slow = uneven_loops(400, 2e-5, random);
  for (std::size_t k = 0; k < slow.time_s.size(); ++k) {
    both.time_s.push_back(slow.time_s[k] + 1000.0);
    both.angle_rad.push_back(slow.angle_rad[k]);
    both.torque_Nm.push_back(slow.torque_Nm[k]);
    run.emplace_back("slow");
  }
  const LoopObservations found = loop_observations({{.samples = both, .run = run}}, 96.0);
  double weight[2] = {0.0, 0.0}, rows[2] = {0.0, 0.0};
  for (const Observation& row : found.rows) {
    const auto session = static_cast<std::size_t>(row.condition.run);
    weight[session] += 1.0 / (row.scatter * row.scatter);
    rows[session] += 1.0;
  }
  ASSERT_GT(rows[0], 0.0);
  ASSERT_EQ(rows[0], rows[1]);
  // By the noise that passes the filter the first would count 16 to 240 times as much.
  EXPECT_NEAR(weight[0] / weight[1], 1.0, 0.15);
}

TEST(LoopObservations, NotesSayHowMuchFrictionWasTakenOut) {
  const Shaft shaft;
  const LoopObservations found = loop_observations({{.samples = wind_up(shaft, 4)}}, 96.0);
  // 2 T_f/k = 0.4 mrad = 1.375 arcmin.
  EXPECT_TRUE(std::ranges::any_of(found.notes, [](const std::string& note) {
    return note.find("friction opens") != std::string::npos &&
           note.find(" by 1.3") != std::string::npos;
  })) << (found.notes.empty() ? "" : found.notes.back());
}

TEST(LoopObservations, WhereTheEdgeHidesZeroTorqueTheTravelIsKept) {
  // Friction of 1 % of the peak, and a sensor that averages over nine samples.
  const Shaft shaft{.friction_Nm = 0.05};
  const TorqueAngleRecord sharp = wind_up(shaft, 4);
  TorqueAngleRecord rounded = sharp;
  for (std::size_t k = 4; k + 4 < sharp.angle_rad.size(); ++k) {
    double sum = 0.0;
    for (std::size_t j = k - 4; j <= k + 4; ++j) sum += sharp.angle_rad[j];
    rounded.angle_rad[k] = sum / 9.0;
  }
  const LoopObservations all = loop_observations({{.samples = sharp, .name = "a.csv"}}, 96.0);
  const LoopObservations found = loop_observations({{.samples = rounded, .name = "a.csv"}}, 96.0);
  ASSERT_GE(found.measured, 3);
  EXPECT_EQ(found.measured, all.measured);
  EXPECT_EQ(all.rows.size(), static_cast<std::size_t>(all.measured) * 7U);
  ASSERT_EQ(found.rows.size(), static_cast<std::size_t>(found.measured) * 6U);
  for (const Observation& row : found.rows) {
    EXPECT_GT(row.condition.test_torque_Nm, 0.0);
    // What the springs yield under the friction is not told.
    EXPECT_NEAR(row.response, travel_of(shaft, row.condition.test_torque_Nm - shaft.friction_Nm),
                0.002 * shaft.dead_band_rad);
  }
  for (const char* part : {"a.csv: loops 2, 4", "test torque 0 left out", "friction is not told"}) {
    EXPECT_TRUE(std::ranges::any_of(found.notes, [&](const std::string& note) {
      return note.find(part) != std::string::npos;
    })) << part;
  }
}

TEST(LoopObservations, AtTheSunAngleAndTorqueAreReferredToTheOutput) {
  const TorqueAngleRecord output = wind_up({}, 3);
  const LoopObservations at_output = loop_observations({{.samples = output}}, 96.0);
  for (const double ratio : {96.0, -96.0}) {
    TorqueAngleRecord sun = output;
    for (double& angle : sun.angle_rad) angle *= 96.0;
    for (double& torque : sun.torque_Nm) torque /= 96.0;
    const LoopObservations at_sun =
        loop_observations({{.samples = sun, .sun_locked = false}}, ratio);
    ASSERT_EQ(at_sun.rows.size(), at_output.rows.size());
    for (std::size_t k = 0; k < at_sun.rows.size(); ++k) {
      EXPECT_NEAR(at_sun.rows[k].response, at_output.rows[k].response, 1e-12);
      EXPECT_NEAR(at_sun.rows[k].condition.test_torque_Nm,
                  at_output.rows[k].condition.test_torque_Nm, 1e-9);
    }
  }
}

TEST(LoopObservations, SessionsTellStiffnessAtTheOutputAndTheShaftThatWasMeasured) {
  TorqueAngleRecord sun = wind_up({}, 3);
  for (double& angle : sun.angle_rad) angle *= 96.0;
  for (double& torque : sun.torque_Nm) torque /= 96.0;
  const std::vector<std::string> run(sun.time_s.size(), "Monday");
  const LoopObservations found = loop_observations(
      {{.samples = sun, .run = run, .sun_locked = false, .name = "a.csv"}}, -96.0);
  ASSERT_EQ(found.sessions.size(), 1U);
  const LoopSession& session = found.sessions.front();
  EXPECT_EQ(session.run, "Monday");
  EXPECT_FALSE(session.sun_locked);
  // 120 times the loops' frequency of 1/(800 · 0.05 s).
  EXPECT_NEAR(session.cutoff_Hz, 3.0, 0.1);
  ASSERT_EQ(session.loops.size(), static_cast<std::size_t>(found.measured));
  const Shaft shaft;
  for (const SessionLoop& one : session.loops) {
    const Loop& loop = one.loop;
    ASSERT_TRUE(loop.stiffness_positive && loop.stiffness_negative);
    EXPECT_NEAR(loop.stiffness_positive->stiffness_Nm_rad, shaft.stiffness_Nm_rad, 1e-3);
    EXPECT_NEAR(loop.stiffness_negative->stiffness_Nm_rad, shaft.stiffness_Nm_rad, 1e-3);
    // The springs carry the friction to either side where the torque is zero.
    EXPECT_NEAR(loop.lost_motion_rad,
                shaft.dead_band_rad + 2.0 * shaft.friction_Nm / shaft.stiffness_Nm_rad,
                0.02 * shaft.dead_band_rad);
  }
}

TEST(LoopObservations, LoopsOfDifferentPeaksAreReadAtTheSameTorques) {
  Shaft small;
  small.peak_Nm = 3.0;
  const LoopObservations found =
      loop_observations({{.samples = wind_up({}, 3), .file = 0, .name = "a"},
                         {.samples = wind_up(small, 3), .file = 1, .name = "b"}},
                        96.0);
  std::vector<double> torques;
  for (const Observation& row : found.rows) torques.push_back(row.condition.test_torque_Nm);
  std::ranges::sort(torques);
  torques.erase(std::unique(torques.begin(), torques.end()), torques.end());
  EXPECT_EQ(torques.size(), 1 + kTravelFractions.size());
  EXPECT_LE(torques.back(), 3.0);
  for (const Observation& row : found.rows) {
    EXPECT_NEAR(row.response, travel_of({}, row.condition.test_torque_Nm), 0.3 * kArcmin);
  }
}

TEST(LoopObservations, UsedLoopsShareNoBranch) {
  const TorqueAngleRecord record = wind_up({}, 4);
  const LoopAnalysis analysis = analyse_loops(record);
  const auto measured = std::ranges::count_if(
      analysis.loops, [](const Loop& l) { return l.outcome == LoopOutcome::kMeasured; });
  const LoopObservations found = loop_observations({{.samples = record}}, 96.0);
  EXPECT_GT(measured, 4) << "neighbouring branches overlap";
  EXPECT_LE(found.measured, 4);
}

TEST(LoopObservations, RunsAreSessionsAndOneRecordIsNone) {
  const TorqueAngleRecord once = wind_up({}, 2);
  TorqueAngleRecord both = once;
  std::vector<std::string> run(once.time_s.size(), "Monday");
  for (std::size_t k = 0; k < once.time_s.size(); ++k) {
    both.time_s.push_back(once.time_s[k] + 1000.0);
    both.angle_rad.push_back(once.angle_rad[k] + 0.5);
    both.torque_Nm.push_back(once.torque_Nm[k]);
    run.emplace_back("Tuesday");
  }
  const LoopObservations found = loop_observations({{.samples = both, .run = run}}, 96.0);
  EXPECT_EQ(found.runs, (std::vector<std::string>{"Monday", "Tuesday"}));
  ASSERT_FALSE(found.rows.empty());
  EXPECT_EQ(found.rows.front().condition.run, 0);
  EXPECT_EQ(found.rows.back().condition.run, 1);
  EXPECT_GT(found.rows.back().line, static_cast<int>(once.time_s.size()))
      << "the place in the file, not in the run";
  EXPECT_EQ(loop_observations({{.samples = once}}, 96.0).rows.front().condition.run, -1);
}

TEST(LoopObservations, WhatIsNoLoopIsNamed) {
  TorqueAngleRecord ramp;
  for (int k = 0; k < 500; ++k) {
    ramp.time_s.push_back(k);
    ramp.torque_Nm.push_back(0.01 * k);
    ramp.angle_rad.push_back(1e-5 * k);
  }
  const LoopObservations found = loop_observations({{.samples = ramp, .name = "ramp.csv"}}, 96.0);
  EXPECT_TRUE(found.rows.empty());
  EXPECT_EQ(found.refused, 1);
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_EQ(found.notes.front().find("ramp.csv: no loop: "), 0U) << found.notes.front();
}

TEST(LoopObservations, RatioAndColumnsAreChecked) {
  EXPECT_THROW(loop_observations({}, 0.0), std::invalid_argument);
  EXPECT_THROW(loop_observations({}, std::nan("")), std::invalid_argument);
  TorqueAngleRecord record = wind_up({}, 2);
  record.torque_Nm.pop_back();
  EXPECT_THROW(loop_observations({{.samples = record}}, 96.0), std::invalid_argument);
}

MeasurementSet lost_motion_rows(double sigma) {
  MeasurementSet set;
  set.kind = Kind::kLostMotion;
  set.files = {"lost.csv", "loops.csv"};
  set.rows.resize(3);
  for (Observation& row : set.rows) row.sigma = sigma;
  set.covariates = {{.name = "humidity", .value = {1.0, 2.0, 3.0}}};
  return set;
}

TEST(AddLoops, PooledRowsAreSessionsOfTheirFiles) {
  MeasurementSet set = lost_motion_rows(kUnknown);
  const LoopObservations loops = loop_observations({{.samples = wind_up({}, 3)}}, 96.0);
  add_loops(set, loops, 1);
  ASSERT_EQ(set.rows.size(), 3 + loops.rows.size());
  EXPECT_EQ(set.runs, (std::vector<std::string>{"lost.csv", "loops.csv"}));
  EXPECT_EQ(set.rows.front().condition.run, 0);
  EXPECT_EQ(set.rows.back().condition.run, 1);
  EXPECT_EQ(set.rows.back().file, 1);
  ASSERT_EQ(set.loops.size(), 1U);
  EXPECT_EQ(set.loops.front().file, 1);
  EXPECT_EQ(set.covariates.front().value.size(), set.rows.size());
  EXPECT_TRUE(std::isnan(set.covariates.front().value.back()));
}

TEST(AddLoops, SessionsWithoutARowAreNone) {
  // A session that has no loop, and the file's own list of the same sessions.
  const TorqueAngleRecord loops_of = wind_up({}, 3);
  TorqueAngleRecord both = loops_of;
  std::vector<std::string> run(loops_of.time_s.size(), "with");
  for (std::size_t k = 0; k < 4; ++k) {
    both.time_s.push_back(loops_of.time_s.back() + 1.0 + static_cast<double>(k));
    both.angle_rad.push_back(0.0);
    both.torque_Nm.push_back(0.1);
    run.emplace_back("without");
  }
  const LoopObservations loops = loop_observations({{.samples = both, .run = run}}, 96.0);
  MeasurementSet set;
  set.kind = Kind::kTorqueAngle;
  set.files = {"loops.csv"};
  set.runs = {"with", "without"};
  add_loops(set, loops, 0);
  EXPECT_EQ(set.runs, (std::vector<std::string>{"with"}));
  ASSERT_FALSE(set.rows.empty());
  for (const Observation& row : set.rows) EXPECT_EQ(row.condition.run, 0);
}

TEST(AddLoops, SigmaIsStatedForAllRowsOrNone) {
  const LoopObservations loops = loop_observations({{.samples = wind_up({}, 3)}}, 96.0);
  MeasurementSet without = lost_motion_rows(kUnknown);
  add_loops(without, loops, 1);
  for (const Observation& row : without.rows) EXPECT_TRUE(std::isnan(row.sigma));
  MeasurementSet of_loops;
  of_loops.kind = Kind::kTorqueAngle;
  of_loops.files = {"loops.csv"};
  add_loops(of_loops, loops, 0);
  EXPECT_GT(loops.measured, 1);
  EXPECT_TRUE(of_loops.runs.empty());
  for (const Observation& row : of_loops.rows) EXPECT_TRUE(std::isnan(row.sigma)) << "repeats";
}

}  // namespace
}  // namespace gear3k::calibrate::loop_observations_test
