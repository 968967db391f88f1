#include "calibrate/model/hypothesis.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/measurement/value_range.hpp"
#include "tests/calibrate/rig_campaign.hpp"

namespace gear3k::calibrate::hypothesis_test {
namespace {

Hypothesis three_effects() {
  return hypothesis({candidate("friction_level", {.name = "coefficient"}),
                     candidate("runout", {.name = "constant", .body = "sun", .order = 83.5}),
                     candidate("drag_constant", {.name = "sun", .body = "sun"})},
                    {0.1, 2.0, 3.0, 0.04});
}

std::vector<double> copy_of(std::span<const double> values) {
  return {values.begin(), values.end()};
}

TEST(HypothesisValues, StayWithTheirEffects) {
  const Hypothesis h = three_effects();
  EXPECT_EQ(value_offset(h, 2), 3U);
  EXPECT_EQ(copy_of(values_of(h, 1)), (std::vector<double>{2.0, 3.0}));
  const Hypothesis rest = without(h, 0);
  EXPECT_FALSE(has_cause(rest, find_cause("friction_level")));
  EXPECT_EQ(copy_of(values_of(rest, 0)), (std::vector<double>{2.0, 3.0}));
  EXPECT_EQ(copy_of(values_of(rest, 1)), (std::vector<double>{0.04}));
  const Hypothesis ends = subset(h, {true, false, true});
  EXPECT_EQ(ends.value, (std::vector<double>{0.1, 0.04}));
  EXPECT_TRUE(subset(h, {false, false, false}).effects.empty());
  const Hypothesis grown = with(ends, h.effects[1]);
  EXPECT_EQ(grown.value, (std::vector<double>{0.1, 0.04, 0.0, 0.0}));
}

TEST(HypothesisForms, AreTheSameInAnyOrderAndWithAnyValues) {
  const Hypothesis h = three_effects();
  const Hypothesis turned = with(without(h, 0), h.effects[0]);
  EXPECT_TRUE(same_forms(h, turned));
  EXPECT_FALSE(same_forms(h, without(h, 0)));
  Hypothesis other = h;
  other.effects[1].form.order = 29.2;
  EXPECT_FALSE(same_forms(h, other));
  other = h;
  other.effects[2].form.name = "output";
  EXPECT_FALSE(same_forms(h, other));
  const Candidate early =
      candidate("run_step", {.name = "from", .constants = {{.name = "first_run", .value = 1.0}}});
  Candidate late = early;
  late.form.constants[0].value = 2.0;
  EXPECT_FALSE(
      same_forms({.effects = {early}, .value = {0.0}}, {.effects = {late}, .value = {0.0}}));
}

TEST(HypothesisApplied, IsEachEffectWithItsOwnValues) {
  const Hypothesis h = three_effects();
  const std::vector<Scalar> values = variables_of(h.value);
  Condition condition;
  condition.output_angle_rad = 0.01;
  Modification m;
  apply(h, values, condition, Kind::kTransmission, m);
  EXPECT_DOUBLE_EQ(m.gearbox.friction.level.a, 1.1);
  EXPECT_DOUBLE_EQ(m.gearbox.friction.level.v[0], 1.0);
  EXPECT_DOUBLE_EQ(m.added.a, 2.0 * std::cos(0.835) + 3.0 * std::sin(0.835));
  EXPECT_DOUBLE_EQ(m.added.v[1], std::cos(0.835));
  EXPECT_DOUBLE_EQ(m.added.v[2], std::sin(0.835));
  EXPECT_DOUBLE_EQ(m.gearbox.drag[design::kSunShaft].constant_Nm.a, 0.04);
  EXPECT_DOUBLE_EQ(m.gearbox.drag[design::kSunShaft].constant_Nm.v[3], 1.0);
}

TEST(ValueRange, LeavesOutWhatIsNotStated) {
  ValueRange range;
  EXPECT_FALSE(range.known());
  EXPECT_FALSE(range.varies());
  for (const double x : {kUnknown, 2.0, kUnknown}) range.extend(x);
  EXPECT_TRUE(range.known());
  EXPECT_FALSE(range.varies());
  for (const double x : {-1.0, kUnknown, 5.0, HUGE_VAL}) range.extend(x);
  EXPECT_EQ(range.low, -1.0);
  EXPECT_EQ(range.high, 5.0);
  EXPECT_TRUE(range.varies());
}

}  // namespace
}  // namespace gear3k::calibrate::hypothesis_test
