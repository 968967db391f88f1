#include "calibrate/measurement/condition_quantity.hpp"

#include <gtest/gtest.h>

#include <cmath>
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

TEST(ConditionQuantity, UnitsAreThoseOfPhysics) {
  EXPECT_DOUBLE_EQ(kSunSpeed.si(60.0), 2.0 * std::acos(-1.0));  // a turn per second
  EXPECT_DOUBLE_EQ(kOutputAngle.si(180.0), std::acos(-1.0));
  EXPECT_DOUBLE_EQ(kTemperature.si(-273.15), 0.0);  // absolute zero
  EXPECT_DOUBLE_EQ(kModule.si(2.0), 0.002);
}

}  // namespace
}  // namespace gear3k::calibrate::condition_quantity_test
