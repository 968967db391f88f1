#include "calibrate/measurement/condition_quantity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <string>

#include "calibrate/causes/form_catalogue.hpp"

namespace gear3k::calibrate::condition_quantity_test {
namespace {

TEST(ConditionQuantity, ColumnsAreNameAndUnitAndStandOnce) {
  std::set<std::string_view> columns;
  for (const ConditionQuantity& q : kConditionQuantities) {
    EXPECT_EQ(q.column, file_key(q.name, q.unit));
    EXPECT_TRUE(columns.insert(q.column).second) << q.column;
  }
}

TEST(ConditionQuantity, ReadBackWhatWasWritten) {
  for (const ConditionQuantity& q : kConditionQuantities) {
    for (const double written : {-40.0, 0.0, 0.3, 1000.0}) {
      // Rounding: of the shift, a few hundred.
      EXPECT_NEAR(q.written(q.si(written)), written, 4e-16 * (std::abs(written) + 500.0))
          << q.column;
    }
  }
}

// Texts of up to nine digits, as files have them.
TEST(ConditionQuantity, StatesTheDigitsThatWereRead) {
  EXPECT_EQ(kTemperature.stated(kTemperature.si(44.122)), 44.122);
  EXPECT_NE(kTemperature.written(kTemperature.si(44.122)), 44.122);
  std::uint64_t state = 12345;
  for (const ConditionQuantity& q : kConditionQuantities) {
    for (int n = 0; n < 300; ++n) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      const auto whole = static_cast<long long>(state >> 34U) % 1000000000LL;
      const std::string text = std::to_string(whole / 1000000) + "." +
                               std::to_string(1000000 + whole % 1000000).substr(1);
      const double read = std::stod(text);
      EXPECT_EQ(q.stated(q.si(read)), read) << q.column << ' ' << text;
      EXPECT_EQ(q.si(q.stated(q.si(read))), q.si(read)) << q.column << ' ' << text;
    }
  }
}

TEST(ConditionQuantity, UnitsAreThoseOfPhysics) {
  EXPECT_DOUBLE_EQ(kSunSpeed.si(60.0), 2.0 * std::acos(-1.0));  // a turn per second
  EXPECT_DOUBLE_EQ(kOutputAngle.si(180.0), std::acos(-1.0));
  EXPECT_DOUBLE_EQ(kTemperature.si(-273.15), 0.0);  // absolute zero
  EXPECT_DOUBLE_EQ(kModule.si(2.0), 0.002);
}

}  // namespace
}  // namespace gear3k::calibrate::condition_quantity_test
