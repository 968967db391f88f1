#include "calibrate/measurement/blank_conditions.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "calibrate/verdict/diagnosis.hpp"
#include "tests/calibrate/bench.hpp"

namespace gear3k::calibrate::blank_conditions_test {
namespace {

/// Rows of one file at line 2 and on, that state all there is.
MeasurementSet stated_rows(int count, Kind kind = Kind::kLostMotion) {
  MeasurementSet set;
  set.kind = kind;
  set.files = {"a.csv"};
  for (int i = 0; i < count; ++i) {
    Observation row;
    row.line = 2 + i;
    row.condition.temperature_K = 290.0 + i;
    row.condition.time_s = 10.0 * i;
    row.condition.cycles = 100.0 * i;
    row.condition.output_angle_rad = 0.1 * i;
    row.condition.module_m = 0.001 * (1 + i % 2);
    set.rows.push_back(row);
  }
  return set;
}

constexpr std::array<const ConditionQuantity*, 4> kAll{&kTemperature, &kTime, &kCycles,
                                                       &kOutputAngle};

TEST(BlankConditions, OfAFifthOfTheRowsLeaveTheseOut) {
  for (const ConditionQuantity* q : kAll) {
    MeasurementSet set = stated_rows(20);
    for (const std::size_t k : {3U, 7U, 8U, 19U}) set.rows[k].condition.*q->member = kUnknown;
    settle_blank_conditions(set);
    EXPECT_EQ(set.rows.size(), 16U);
    for (const Observation& row : set.rows) {
      EXPECT_TRUE(std::isfinite(row.condition.*q->member)) << q->column;
    }
    EXPECT_FALSE(is_unused(set, *q));
    ASSERT_EQ(set.notes.size(), 1U);
    EXPECT_EQ(set.notes[0], "a.csv: lines 5, 9, 10, 21: 4 rows left out, " +
                                std::string(q->column) + " is blank and other rows state it");
  }
}

TEST(BlankConditions, OfMoreRowsLeaveTheColumnOut) {
  for (const ConditionQuantity* q : kAll) {
    MeasurementSet set = stated_rows(20);
    for (std::size_t k = 0; k < 5; ++k) set.rows[4 * k].condition.*q->member = kUnknown;
    settle_blank_conditions(set);
    EXPECT_EQ(set.rows.size(), 20U);
    for (const ConditionQuantity* other : kAll) {
      EXPECT_EQ(is_unused(set, *other), other == q);
      EXPECT_EQ(used_range(set, *other).known(), other != q);
    }
    ASSERT_EQ(set.notes.size(), 1U);
    EXPECT_NE(set.notes[0].find("a.csv: lines 2, 6, 10, 14, 18: " + std::string(q->column) +
                                " is blank in 5 of 20 rows"),
              std::string::npos)
        << set.notes[0];
    EXPECT_NE(set.notes[0].find("not looked for"), std::string::npos);
  }
}

TEST(BlankConditions, OfSeveralColumnsLeaveAFifthOutTogether) {
  // Three rows without a time and two others without a temperature: one too many of twenty.
  MeasurementSet set = stated_rows(20);
  for (const std::size_t k : {0U, 1U, 2U}) set.rows[k].condition.time_s = kUnknown;
  for (const std::size_t k : {5U, 6U}) set.rows[k].condition.temperature_K = kUnknown;
  settle_blank_conditions(set);
  EXPECT_EQ(set.rows.size(), 18U) << "those of the column that fewer lack";
  EXPECT_FALSE(is_unused(set, kTemperature));
  EXPECT_TRUE(is_unused(set, kTime));
  // The same rows: no more than a fifth.
  set = stated_rows(20);
  for (const std::size_t k : {0U, 1U, 2U}) {
    set.rows[k].condition.time_s = set.rows[k].condition.temperature_K = kUnknown;
  }
  settle_blank_conditions(set);
  EXPECT_EQ(set.rows.size(), 17U);
  EXPECT_EQ(set.notes.size(), 2U);
}

TEST(BlankConditions, ThatNoRowOrEveryRowStatesChangeNothing) {
  MeasurementSet set = stated_rows(20);
  for (Observation& row : set.rows) row.condition.cycles = kUnknown;
  settle_blank_conditions(set);
  EXPECT_EQ(set.rows.size(), 20U);
  EXPECT_TRUE(set.notes.empty());
  EXPECT_TRUE(set.unused.empty());
}

TEST(BlankConditions, OfRowsReadFromARecordCountNeitherWay) {
  MeasurementSet set = stated_rows(20);
  set.files.emplace_back("loop.csv");
  set.loops.push_back({.file = 1});
  for (int i = 0; i < 3; ++i) {
    Observation row;
    row.file = 1;
    row.condition.time_s = 300.0 + i;
    set.rows.push_back(row);
  }
  settle_blank_conditions(set);
  EXPECT_EQ(set.rows.size(), 23U);
  EXPECT_TRUE(set.notes.empty());
  EXPECT_TRUE(used_range(set, kTemperature).varies());
}

TEST(BlankConditions, AFifthIsOfTheRowsThatCouldStateIt) {
  // Ten of twenty rows lack it, of 120 with those of a record.
  MeasurementSet set = stated_rows(20);
  for (std::size_t k = 0; k < 10; ++k) set.rows[k].condition.temperature_K = kUnknown;
  set.files.emplace_back("loop.csv");
  set.loops.push_back({.file = 1});
  for (int i = 0; i < 100; ++i) {
    Observation row;
    row.file = 1;
    set.rows.push_back(row);
  }
  settle_blank_conditions(set);
  EXPECT_EQ(set.rows.size(), 120U);
  EXPECT_TRUE(is_unused(set, kTemperature));
  ASSERT_EQ(set.notes.size(), 1U);
  EXPECT_NE(set.notes[0].find("temperature_c is blank in 10 of 20 rows"), std::string::npos)
      << set.notes[0];
}

TEST(BlankConditions, OfAModuleAreRowsOfAnotherPairOrOfOneMillimetre) {
  MeasurementSet set = stated_rows(20, Kind::kPairLoss);
  set.rows[4].condition.module_m = 0.0;
  settle_blank_conditions(set);
  EXPECT_EQ(set.rows.size(), 19U);
  for (std::size_t k = 0; k < 10; ++k) set.rows[k].condition.module_m = 0.0;
  settle_blank_conditions(set);
  EXPECT_EQ(set.rows.size(), 19U);
  EXPECT_NE(set.notes.back().find("count as of 1 mm"), std::string::npos);
}

// An oven that is set for each session, and friction that follows it as no other row says.
class AnOven : public Bench {
 protected:
  AnOven() {
    constexpr double kRpm = 0.10471975511965977;
    rig::DeterministicRandom random(4);
    data_.kind = Kind::kTransmission;
    data_.files = {"oven.csv"};
    data_.runs = {"cold", "mild", "warm"};
    for (int i = 0; i < 72; ++i) {
      Observation row;
      Condition& c = row.condition;
      row.line = 2 + i;
      c.run = i / 24;
      c.temperature_K = 293.15 + 15.0 * c.run + random.between(-1.0, 1.0);
      c.sun_speed_rad_s = kRpm * (200.0 + 200.0 * (i % 3));
      c.output_torque_Nm = 10.0 + 10.0 * (i / 3 % 4);
      c.direction = i / 12 % 2 == 0 ? design::Direction::kForward : design::Direction::kBackward;
      data_.rows.push_back(row);
    }
    const Form form{.name = "about_middle",
                    .constants = {{.name = "reference_temperature", .unit = "c", .value = 35.0}}};
    measure(hypothesis({candidate("friction_temperature", form)}, {-0.02}), 0.003, 9);
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> ids;
    const Diagnosis d = *diagnose(simulation_, data_, {});
    for (const Effect& e : d.effects) ids.push_back(e.id);
    return ids;
  }
};

TEST_F(AnOven, IsNamedWhereAFewRowsLackTheTemperature) {
  const std::vector<std::string> whole = names();
  ASSERT_EQ(whole, std::vector<std::string>{"friction_temperature"});
  // Rows of the warmest session would stand for the temperature of the design.
  for (const std::size_t k : {50U, 57U, 61U, 66U, 70U, 3U}) {
    data_.rows[k].condition.temperature_K = kUnknown;
  }
  settle_blank_conditions(data_);
  EXPECT_EQ(names(), whole);
}

TEST_F(AnOven, IsNotNamedWhereManyRowsLackTheTemperature) {
  for (std::size_t k = 0; k < data_.rows.size(); k += 3) {
    data_.rows[k].condition.temperature_K = kUnknown;
  }
  settle_blank_conditions(data_);
  const Diagnosis d = *diagnose(simulation_, data_, {});
  for (const Effect& e : d.effects) EXPECT_NE(e.id, "friction_temperature");
  for (const CauseEvidence& e : d.evidence) EXPECT_NE(e.id, "friction_temperature");
}

}  // namespace
}  // namespace gear3k::calibrate::blank_conditions_test
