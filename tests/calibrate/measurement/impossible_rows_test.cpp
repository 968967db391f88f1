#include "calibrate/measurement/impossible_rows.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace gear3k::calibrate::impossible_rows_test {
namespace {

using design::Direction;

constexpr double kRatio = 100.0;

/// 120 rows of a gearbox of efficiency 0.88 forward and 0.85 backward, loads 5 to 50 Nm.
MeasurementSet campaign(double noise_Nm, unsigned seed) {
  MeasurementSet set;
  set.files = {"data.csv"};
  set.covariates = {{.name = "number", .value = {}}};
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0.0, noise_Nm > 0.0 ? noise_Nm : 1.0);
  for (int k = 0; k < 120; ++k) {
    Observation o;
    const bool forward = k % 2 == 0;
    o.condition.direction = forward ? Direction::kForward : Direction::kBackward;
    o.condition.sun_speed_rad_s = 20.0 + 10.0 * (k % 5);
    o.condition.output_torque_Nm = 5.0 + 15.0 * (k / 2 % 4);
    const double ideal = o.condition.output_torque_Nm / kRatio;
    o.response = forward ? ideal / 0.88 : 0.85 * ideal;
    if (noise_Nm > 0.0) o.response += noise(generator);
    o.line = k + 3;
    set.rows.push_back(o);
    set.covariates[0].value.push_back(k);
  }
  return set;
}

std::string error_of(MeasurementSet set, double ratio) {
  return leave_out_impossible(set, ratio).value_or("");
}

TEST(ImpossibleRows, LeavesPossibleRowsAlone) {
  MeasurementSet set = campaign(0.0, 1);
  EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
  EXPECT_EQ(set.rows.size(), 120U);
  EXPECT_TRUE(set.notes.empty());
}

TEST(ImpossibleRows, RowsOfEfficiencyAboveOneAreLeftOutWithTheirCovariatesAndNamed) {
  MeasurementSet set = campaign(0.0, 1);
  set.rows[10].response = 0.9 * set.rows[10].condition.output_torque_Nm / kRatio;   // forward
  set.rows[21].response = 1.05 * set.rows[21].condition.output_torque_Nm / kRatio;  // backward
  EXPECT_EQ(leave_out_impossible(set, -kRatio), std::nullopt);
  ASSERT_EQ(set.rows.size(), 118U);
  ASSERT_EQ(set.covariates[0].value.size(), 118U);
  EXPECT_EQ(set.covariates[0].value[10], 11.0);
  EXPECT_EQ(set.covariates[0].value[20], 22.0);
  ASSERT_EQ(set.notes.size(), 1U);
  EXPECT_EQ(set.notes[0],
            "data.csv: lines 13, 24: rows left out, efficiency above 1 beyond the noise");
}

TEST(ImpossibleRows, AreLeftOutWhereNothingTellsRowsApart) {
  // Of one operating point, and of as many loads as rows, no group of rows can be off.
  for (const double apart_Nm : {0.0, 4.0}) {
    MeasurementSet set;
    set.files = {"data.csv"};
    for (int k = 0; k < 12; ++k) {
      Observation o;
      o.condition.direction = Direction::kForward;
      o.condition.sun_speed_rad_s = 20.0;
      o.condition.output_torque_Nm = 10.0 + apart_Nm * k;
      o.response = o.condition.output_torque_Nm / kRatio / (k == 5 ? 1.1 : 0.88);
      o.line = k + 3;
      set.rows.push_back(o);
    }
    EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
    EXPECT_EQ(set.rows.size(), 11U) << apart_Nm;
  }
}

TEST(ImpossibleRows, OfOnePartOfTheTurnStayAndAreNoSensors) {
  MeasurementSet set = campaign(0.0, 1);
  for (int k = 0; k < 120; ++k) {
    // A twelfth of the turn, about 105 degrees, has twelve rows of all loads, speeds and
    // directions.
    constexpr double kDegree = 0.017453292519943295;
    const bool there = 7 * k % 120 < 12;
    Observation& row = set.rows[static_cast<std::size_t>(k)];
    row.condition.output_angle_rad = kDegree * (there ? 105.0 : 135.0 + 2.0 * (k % 97));
    if (there) row.response = 1.1 * row.condition.output_torque_Nm / kRatio;
  }
  EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
  EXPECT_EQ(set.rows.size(), 120U);
  ASSERT_EQ(set.notes.size(), 1U);
  EXPECT_NE(set.notes[0].find("in that part of the turn"), std::string::npos) << set.notes[0];
}

TEST(ImpossibleRows, WithinOnePercentNothingIsSaid) {
  MeasurementSet set = campaign(0.0, 1);
  set.rows[10].response = 0.995 * set.rows[10].condition.output_torque_Nm / kRatio;
  EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
  EXPECT_EQ(set.rows.size(), 120U);
}

TEST(ImpossibleRows, StatedDeviationsDecideWhatNoiseMayDo) {
  MeasurementSet set = campaign(0.0, 1);
  const double ideal = set.rows[10].condition.output_torque_Nm / kRatio;
  set.rows[10].response = 0.9 * ideal;
  for (Observation& o : set.rows) o.sigma = 0.04 * ideal;
  MeasurementSet precise = set;
  EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
  EXPECT_EQ(set.rows.size(), 120U);  // 2.5 deviations
  for (Observation& o : precise.rows) o.sigma = 0.02 * ideal;
  EXPECT_EQ(leave_out_impossible(precise, kRatio), std::nullopt);
  EXPECT_EQ(precise.rows.size(), 119U);  // 5 deviations
}

TEST(ImpossibleRows, NoiseAloneCostsHardlyAnyRow) {
  // 0.004 Nm is more than half of the loss at 5 Nm: a bound of 1 % would take one row in twenty
  // there.
  std::size_t left_out = 0;
  constexpr unsigned kSeeds = 100;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    MeasurementSet set = campaign(0.004, seed);
    EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
    left_out += 120U - set.rows.size();
  }
  // The rows of 5 Nm, 30 of 120, lose 0.0068 (forward) and 0.0075 Nm: 1.7 and 1.9 deviations; 3
  // more would be 4.7: expected 1e-6 of the rows.
  EXPECT_LE(left_out, 3U);
}

TEST(ImpossibleRows, NoiseDoesNotHideImpossibleRows) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    MeasurementSet set = campaign(0.003, seed);
    for (const std::size_t k : {10U, 34U, 58U}) {
      ASSERT_EQ(set.rows[k].condition.output_torque_Nm, 20.0);
      set.rows[k].response = 0.16;  // ideal: 0.2
    }
    EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
    EXPECT_EQ(set.rows.size(), 117U) << seed;
  }
}

TEST(ImpossibleRows, SwappedDirectionsAreRefusedWithTheSuspects) {
  MeasurementSet set = campaign(0.003, 1);
  for (Observation& o : set.rows) {
    o.condition.direction =
        o.condition.direction == Direction::kForward ? Direction::kBackward : Direction::kForward;
  }
  const std::string error = error_of(set, kRatio);
  for (const char* part :
       {"data.csv: lines ", "efficiency above 1 at the ratio 100 in", "of 120 rows",
        "allowed: at most 20 %", "forward and backward swapped", "another unit"}) {
    EXPECT_NE(error.find(part), std::string::npos) << error;
  }
}

TEST(ImpossibleRows, AWrongRatioIsRefused) {
  EXPECT_NE(error_of(campaign(0.003, 1), 0.5 * kRatio), "");
  EXPECT_NE(error_of(campaign(0.003, 1), 2.0 * kRatio), "");
}

TEST(ImpossibleRows, PairsBelowZeroLossAreLeftOut) {
  MeasurementSet set;
  set.kind = Kind::kPairLoss;
  set.files = {"pairs.csv"};
  for (int k = 0; k < 30; ++k) {
    Observation o;
    o.condition.driving_teeth = 16 + k;
    o.condition.driven_teeth = 80;
    o.response = 0.4 / o.condition.driving_teeth;
    o.line = k + 3;
    set.rows.push_back(o);
  }
  set.rows[4].response = -0.05;
  set.rows[5].response = -0.005;  // within 1 %
  EXPECT_EQ(leave_out_impossible(set, std::numeric_limits<double>::quiet_NaN()), std::nullopt);
  EXPECT_EQ(set.rows.size(), 29U);
  ASSERT_EQ(set.notes.size(), 1U);
  EXPECT_EQ(set.notes[0], "pairs.csv: line 7: row left out, efficiency above 1 beyond the noise");
  for (Observation& o : set.rows) o.response = -0.3;
  EXPECT_NE(error_of(set, 1.0).find("loss_factor below 0"), std::string::npos);
}

TEST(ImpossibleRows, ARatioThatIsNoneIsABrokenPrecondition) {
  for (const double ratio :
       {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    MeasurementSet set = campaign(0.0, 1);
    EXPECT_THROW(static_cast<void>(leave_out_impossible(set, ratio)), std::invalid_argument);
  }
}

TEST(ImpossibleRows, LostMotionHasNoEfficiency) {
  MeasurementSet set;
  set.kind = Kind::kLostMotion;
  set.rows.resize(10);
  EXPECT_EQ(leave_out_impossible(set, 0.0), std::nullopt);
  EXPECT_EQ(set.rows.size(), 10U);
}

TEST(ImpossibleRows, OfOneSessionStayAndSpeakOfASensor) {
  // A sensor reads a fifth too much in the second of four sessions: backward more than comes in.
  MeasurementSet set = campaign(0.0, 1);
  set.runs = {"mon_am", "mon_pm", "tue_am", "tue_pm"};
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    set.rows[k].condition.run = static_cast<int>(k / 30);
    if (set.rows[k].condition.run == 1) set.rows[k].response *= 1.2;
    set.rows[k].sigma = 1e-4;
  }
  EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
  EXPECT_EQ(set.rows.size(), 120U);
  ASSERT_EQ(set.notes.size(), 1U);
  EXPECT_NE(set.notes[0].find("15 of 120 rows, of session mon_pm"), std::string::npos)
      << set.notes[0];
}

TEST(ImpossibleRows, OfTwoLoadsStayOneBesideTheOther) {
  MeasurementSet set = campaign(0.0, 1);
  // Forward at one load, backward at another; and a single reading anywhere.
  for (Observation& o : set.rows) {
    const bool forward = o.condition.direction == Direction::kForward;
    const double load = o.condition.output_torque_Nm;
    if (forward && load == 50.0 && o.condition.sun_speed_rad_s < 50.0) o.response *= 0.8;
    if (!forward && load == 5.0 && o.condition.sun_speed_rad_s < 40.0) o.response *= 1.25;
  }
  set.rows[4].response *= 0.5;
  EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
  EXPECT_EQ(set.rows.size(), 119U);
  EXPECT_EQ(set.notes.size(), 3U);
}

/// As a torque sensor of this gain and zero reads it.  Its own sign turns with the rotation and, as
/// the power goes the other way, with the direction.
MeasurementSet read_by(double gain, double zero_Nm, double noise_Nm, unsigned seed) {
  MeasurementSet set = campaign(noise_Nm, seed);
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    Observation& o = set.rows[k];
    o.condition.rotation = k / 8 % 2 == 0 ? 1 : -1;
    const double own_sign =
        o.condition.rotation * (o.condition.direction == Direction::kForward ? 1.0 : -1.0);
    const double applied_Nm = own_sign * o.response;
    o.response = own_sign * (gain * applied_Nm + zero_Nm);
  }
  return set;
}

void exchange(Observation& o) {
  o.condition.direction =
      o.condition.direction == Direction::kForward ? Direction::kBackward : Direction::kForward;
}

void state_sigma(MeasurementSet& set, double sigma_Nm) {
  for (Observation& o : set.rows) o.sigma = sigma_Nm;
}

/// Rows of an efficiency above 1.01, by its definition.
std::size_t impossible_rows_of(const MeasurementSet& set) {
  std::size_t count = 0;
  for (const Observation& o : set.rows) {
    const double in_Nm = kRatio * o.response, out_Nm = o.condition.output_torque_Nm;
    const bool forward = o.condition.direction == Direction::kForward;
    if ((forward ? out_Nm / in_Nm : in_Nm / out_Nm) > 1.01) ++count;
  }
  return count;
}

/// More than a fifth of the rows are impossible, every row stays, and the first note says why.
void expect_stay(MeasurementSet set, const std::string& part) {
  const std::size_t rows = set.rows.size();
  ASSERT_GT(5U * impossible_rows_of(set), rows);
  EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
  EXPECT_EQ(set.rows.size(), rows);
  ASSERT_FALSE(set.notes.empty());
  EXPECT_NE(set.notes[0].find(part), std::string::npos) << set.notes[0];
}

TEST(ImpossibleRows, OfOneRotationStayAsTheZeroOfASensorMakesThem) {
  expect_stay(read_by(1.0, 0.06, 0.001, 1), "of rotation -1: they stay");
  expect_stay(read_by(1.0, -0.06, 0.001, 1), "of rotation 1: they stay");
}

TEST(ImpossibleRows, OfOneDirectionStayAsTheGainOfASensorMakesThem) {
  expect_stay(read_by(0.82, 0.0, 0.001, 1), "of direction forward: they stay");
  expect_stay(read_by(1.25, 0.0, 0.001, 1), "of direction backward: they stay");
}

TEST(ImpossibleRows, OfADirectionOfMoreThanHalfOfTheRowsStay) {
  MeasurementSet set = read_by(0.82, 0.0, 0.001, 1);
  std::vector<Observation> most;
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    if (k % 2 == 0 || k % 3 == 0) most.push_back(set.rows[k]);
  }
  set.rows = most;
  set.covariates.clear();
  expect_stay(set, "of direction forward: they stay");
}

TEST(ImpossibleRows, OfATemperatureAndARotationStay) {
  // The zero goes with the temperature, and is right between the two.
  MeasurementSet warm = read_by(1.0, 0.07, 0.001, 1);
  const MeasurementSet cold = read_by(1.0, -0.07, 0.001, 1);
  for (std::size_t k = 0; k < warm.rows.size(); ++k) {
    const bool is_warm = k / 40 % 2 == 0;
    if (!is_warm) warm.rows[k] = cold.rows[k];
    warm.rows[k].condition.temperature_K = is_warm ? 330.0 : 290.0;
  }
  state_sigma(warm, 0.001);
  expect_stay(warm, "rotation ");
}

TEST(ImpossibleRows, OfBothDirectionsStayWhereTheyFallWithTheLoad) {
  // No rotation is stated, and both directions are off as if they were exchanged; but the zero of a
  // sensor matters the less the greater the load.  0.09 Nm are more than is lost at any load.
  for (const double zero_Nm : {0.05, 0.09}) {
    MeasurementSet set = campaign(0.001, 1);
    for (Observation& o : set.rows) {
      o.response += o.condition.direction == Direction::kForward ? -zero_Nm : zero_Nm;
    }
    expect_stay(set, "they stay");
  }
}

TEST(ImpossibleRows, OfFewRowsStayWhereOneGainMakesAllPossible) {
  MeasurementSet set = read_by(0.84, 0.0, 0.0, 1);
  set.rows.resize(7);
  set.covariates.clear();
  state_sigma(set, 1e-4);
  expect_stay(set, "as one wrong gain of a torque sensor");
}

TEST(ImpossibleRows, OfFewRowsStayWhereOneSessionHasAWrongZero) {
  // Forward only, three of twelve rows, at the low loads of the second session.
  MeasurementSet set = campaign(0.0, 1);
  std::erase_if(set.rows, [](const Observation& o) { return o.line % 2 == 0; });
  set.rows.resize(12);
  set.covariates.clear();
  set.runs = {"mon", "tue"};
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    set.rows[k].condition.run = k < 7 ? 0 : 1;
    if (k >= 7) set.rows[k].response -= 0.055;
  }
  state_sigma(set, 1e-4);
  expect_stay(set, "as one wrong zero in session tue of a torque sensor");
}

TEST(ImpossibleRows, SingleErrorsBesideThoseOfASensorAreLeftOut) {
  MeasurementSet set = read_by(1.0, 0.06, 0.001, 1);
  // Of the rotation that the zero leaves possible, at 50 Nm.
  ASSERT_EQ(set.rows[54].condition.rotation, 1);
  set.rows[54].response *= 0.5;   // forward
  set.rows[55].response *= 10.0;  // backward
  EXPECT_EQ(leave_out_impossible(set, kRatio), std::nullopt);
  EXPECT_EQ(set.rows.size(), 118U);
  ASSERT_EQ(set.notes.size(), 2U);
  EXPECT_EQ(set.notes[1],
            "data.csv: lines 57, 58: rows left out, efficiency above 1 beyond the noise");
}

TEST(ImpossibleRows, ManyScatteredErrorsAreRefused) {
  // A third of the rows state the wrong direction.
  for (unsigned seed = 0; seed < 10; ++seed) {
    MeasurementSet set = read_by(1.0, 0.0, 0.001, seed);
    state_sigma(set, 0.001);
    std::mt19937 generator(seed);
    for (Observation& o : set.rows) {
      if (generator() % 3 == 0) exchange(o);
    }
    ASSERT_GT(5U * impossible_rows_of(set), set.rows.size());
    EXPECT_NE(error_of(set, kRatio), "") << seed;
  }
}

TEST(ImpossibleRows, ExchangedDirectionsAreRefusedWhereNoiseHidesThemAtLowLoads) {
  // At 5 Nm less is lost than noise may do: impossible together are those of greater loads.
  MeasurementSet set = campaign(0.003, 1);
  for (Observation& o : set.rows) exchange(o);
  state_sigma(set, 0.003);
  const std::string error = error_of(set, kRatio);
  EXPECT_NE(error.find("forward and backward swapped, is"), std::string::npos) << error;
}

TEST(ImpossibleRows, ExchangedDirectionsOfOneSessionAreRefusedAndNamed) {
  MeasurementSet set = campaign(0.001, 1);
  set.runs = {"mon", "tue"};
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    set.rows[k].condition.run = k < 60 ? 0 : 1;
    if (k >= 60) exchange(set.rows[k]);
  }
  state_sigma(set, 0.001);
  const std::string error = error_of(set, kRatio);
  EXPECT_NE(error.find("forward and backward swapped (session tue)"), std::string::npos) << error;
}

TEST(ImpossibleRows, ExchangedColumnsOfTorqueAreRefused) {
  // All backward rows give 1e4 times too much, and no other: no sensor does.
  MeasurementSet set = campaign(0.001, 1);
  for (Observation& o : set.rows) std::swap(o.condition.output_torque_Nm, o.response);
  const std::string error = error_of(set, kRatio);
  EXPECT_NE(error.find("in 60 of 120 rows"), std::string::npos) << error;
}

}  // namespace
}  // namespace gear3k::calibrate::impossible_rows_test
