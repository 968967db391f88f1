#include "calibrate/measurement/noise_memory.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calibrate/fit/screen.hpp"

namespace gear3k::calibrate::noise_memory_test {
namespace {

MeasurementSet rows_at(const std::vector<double>& time_s, const std::vector<int>& run) {
  MeasurementSet data;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    Observation row;
    row.condition.time_s = time_s[i];
    row.condition.run = run[i];
    data.rows.push_back(row);
  }
  return data;
}

TEST(ReadingOrder, IsThatOfTimeInEachSession) {
  const ReadingOrder order = reading_order(rows_at({30.0, 10.0, 5.0, 20.0, 1.0}, {1, 0, 1, 0, 1}));
  EXPECT_EQ(order.row, (std::vector<int>{1, 3, 4, 2, 0}));
  EXPECT_EQ(order.step, (std::vector<int>{0, 1, 0, 1, 1}));
}

TEST(ReadingOrder, WithoutAClockIsThatOfLinesThatNoConditionFollows) {
  MeasurementSet data;
  RandomBits random(3);
  for (int i = 0; i < 60; ++i) {
    Observation row;
    row.condition.output_torque_Nm = 1.0 + std::floor(11.0 * random.uniform());
    row.condition.output_angle_rad = 0.1 * i;
    data.rows.push_back(row);
  }
  EXPECT_TRUE(reading_order(data).known());
  for (int i = 0; i < 60; ++i) {
    data.rows[static_cast<std::size_t>(i)].condition.output_torque_Nm = 1.0 + 0.1 * i;
  }
  EXPECT_FALSE(reading_order(data).known());
  // A clock says more than the lines.
  for (int i = 0; i < 60; ++i) data.rows[static_cast<std::size_t>(i)].condition.time_s = 60.0 - i;
  EXPECT_EQ(reading_order(data).row.front(), 59);
}

TEST(ReadingOrder, OfAChamberThatIsSetNowAndThenIsThatOfTheLines) {
  MeasurementSet data;
  RandomBits random(3);
  double temperature_K = 300.0;
  for (int i = 0; i < 60; ++i) {
    if (i % 6 == 0) temperature_K = 290.0 + 20.0 * random.uniform();
    Observation row;
    row.condition.temperature_K = temperature_K + 0.5 * random.uniform();
    data.rows.push_back(row);
  }
  EXPECT_TRUE(reading_order(data).known());
  // Set from the warmest to the coldest, ten rows each, in two sessions: sorted.
  for (int i = 0; i < 60; ++i) {
    Condition& c = data.rows[static_cast<std::size_t>(i)].condition;
    c.run = i / 30;
    c.temperature_K = 310.0 - 10.0 * (i % 30 / 10) + 0.5 * random.uniform();
  }
  EXPECT_EQ(lines_sorted_by(data), "temperature");
  EXPECT_FALSE(reading_order(data).known());
}

TEST(ReadingOrder, OfAGearboxThatWarmsUpIsThatOfTheLines) {
  // Quickly or slowly, to the same end in three sessions, read to a tenth of a kelvin.
  for (const double rows : {1.0, 2.0, 4.0, 8.0, 20.0, 60.0}) {
    for (const int count : {20, 40, 120}) {
      MeasurementSet data;
      RandomBits random(7);
      for (int i = 0; i < 3 * count; ++i) {
        Observation row;
        row.condition.run = i / count;
        const double warm_K = 310.0 - 18.0 * std::exp(-(i % count) / rows);
        row.condition.temperature_K = std::round(10.0 * (warm_K + 0.1 * random.normal())) / 10.0;
        row.condition.output_torque_Nm = 1.0 + std::floor(11.0 * random.uniform());
        data.rows.push_back(row);
      }
      EXPECT_EQ(lines_sorted_by(data), "") << rows << ", " << count;
      EXPECT_TRUE(reading_order(data).known());
    }
  }
}

/// Lines of 13 set torques, four of each, from the least to the greatest; each read 0.3 % off.
MeasurementSet read_torques(std::uint64_t seed) {
  MeasurementSet data;
  RandomBits random(seed);
  for (int i = 0; i < 52; ++i) {
    const double set_Nm = 10.0 + 10.0 * std::floor(i / 4.0);
    Observation row;
    row.condition.output_torque_Nm = set_Nm * (1.0 + 0.003 * random.normal());
    data.rows.push_back(row);
  }
  return data;
}

TEST(ReadingOrder, IsNotThatOfLinesSortedBySetPointsThatScatter) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    MeasurementSet data = read_torques(seed);
    EXPECT_FALSE(reading_order(data).known()) << seed;
    std::ranges::reverse(data.rows);
    EXPECT_FALSE(reading_order(data).known()) << seed;
  }
}

TEST(ReadingOrder, IsNotThatOfSortedLinesOfWhichOneWasReadAgain) {
  const MeasurementSet sorted = read_torques(1);
  for (std::size_t again = 0; again < sorted.rows.size(); ++again) {
    for (std::size_t to = 0; to <= sorted.rows.size(); to += 13) {
      MeasurementSet data = sorted;
      data.rows.insert(data.rows.begin() + static_cast<std::ptrdiff_t>(to), sorted.rows[again]);
      EXPECT_FALSE(reading_order(data).known()) << again << " at " << to;
    }
  }
}

TEST(ReadingOrder, OfTorquesThatRiseAndFallOrAChamberThatCreepsIsThatOfTheLines) {
  MeasurementSet data = read_torques(1);
  const MeasurementSet back = data;
  data.rows.insert(data.rows.end(), back.rows.rbegin(), back.rows.rend());
  EXPECT_TRUE(reading_order(data).known());
  // To and fro, half of a turn and a bit: most of it in one sense.
  RandomBits random(5);
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    Condition& c = data.rows[i].condition;
    c.output_torque_Nm = 1.0 + std::floor(11.0 * random.uniform());
    c.temperature_K =
        300.0 + 5.0 * std::sin(0.045 * static_cast<double>(i)) + 0.2 * random.normal();
  }
  EXPECT_TRUE(reading_order(data).known());
  // What follows the line before by 95 %.
  int sorted = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    RandomBits other(seed);
    double creep = other.normal();
    for (Observation& row : data.rows) {
      creep = 0.95 * creep + std::sqrt(1.0 - 0.95 * 0.95) * other.normal();
      row.condition.temperature_K = 300.0 + creep;
    }
    sorted += reading_order(data).known() ? 0 : 1;
  }
  EXPECT_EQ(sorted, 0);
}

TEST(ReadingOrder, OfSomeRowsCountsTheReadingsBetweenThem) {
  const ReadingOrder order{.row = {2, 0, 1, 4, 3}, .step = {0, 1, 1, 0, 1}};
  const ReadingOrder part = subset_of(order, {1, 2, 3});
  // Rows 2, 1 and 3 are places 1, 0 and 2 of the part.
  EXPECT_EQ(part.row, (std::vector<int>{1, 0, 2}));
  EXPECT_EQ(part.step, (std::vector<int>{0, 2, 0}));
}

/// The covariance that the filter undoes, entry by entry: ρ φ^k between rows of a session.
Eigen::MatrixXd covariance_of(const ReadingOrder& order, const NoiseMemory& memory) {
  const auto n = static_cast<Eigen::Index>(order.row.size());
  Eigen::MatrixXd c = Eigen::MatrixXd::Identity(n, n);
  for (std::size_t a = 0; a < order.row.size(); ++a) {
    int apart = 0;
    for (std::size_t b = a + 1; b < order.row.size() && order.step[b] != 0; ++b) {
      apart += order.step[b];
      c(order.row[a], order.row[b]) = memory.share * std::pow(memory.decay, apart);
      c(order.row[b], order.row[a]) = c(order.row[a], order.row[b]);
    }
  }
  return c;
}

TEST(MemoryFilter, IsARootOfTheInverseCovariance) {
  const ReadingOrder order{.row = {2, 0, 1, 4, 3, 6, 5}, .step = {0, 1, 3, 0, 1, 2, 1}};
  for (const NoiseMemory memory : {NoiseMemory{.share = 1.0, .decay = 0.6},
                                   NoiseMemory{.share = 0.3, .decay = 0.95}, NoiseMemory{}}) {
    const MemoryFilter filter(order, memory);
    Eigen::MatrixXd root = Eigen::MatrixXd::Identity(7, 7);
    filter.whiten(root);
    const Eigen::MatrixXd c = covariance_of(order, memory);
    EXPECT_LT((root.transpose() * root - c.inverse()).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NEAR(filter.log_determinant(), std::log(c.determinant()), 1e-12);
  }
}

}  // namespace
}  // namespace gear3k::calibrate::noise_memory_test
