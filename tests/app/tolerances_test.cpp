#include "app/tolerances.hpp"

#include <gtest/gtest.h>

#include <string>

#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::app::tolerances_test {
namespace {

design::Design toleranced() {
  design::Design design =
      io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/ratio_96_tolerances.toml");
  design.sampling.samples = 1000;
  return design;
}

TEST(Tolerances, BuildsAsManyGearboxesAsAskedFor) {
  optimize::Progress progress;
  const Tolerances result = tolerances({.design = toleranced()}, progress);
  EXPECT_FALSE(result.interrupted);
  EXPECT_EQ(result.series.result.samples, 1000U);
  EXPECT_EQ(progress.total.load(), 1000U);
  EXPECT_TRUE(result.series.turn);
  EXPECT_FALSE(result.turn.turn.points.empty());
}

TEST(Tolerances, TurnTheFirstGearboxesOfTheSeriesOfWhichThereMayBeFew) {
  optimize::Progress progress;
  design::Design design = toleranced();
  design.sampling.samples = 20;
  const Tolerances result = tolerances({.design = design}, progress);
  ASSERT_TRUE(result.series.turn);
  EXPECT_EQ(result.series.turn->gearboxes, 20U);
}

TEST(Tolerances, EndWhenAsked) {
  optimize::Progress progress;
  progress.stop = true;
  design::Design design = toleranced();
  design.sampling.samples = 1'000'000'000;
  const Tolerances result = tolerances({.design = design}, progress);
  EXPECT_TRUE(result.interrupted);
  EXPECT_LT(result.series.result.samples, 1'000'000'000U);
}

TEST(Tolerances, AreNeeded) {
  design::Design design = toleranced();
  design.tolerances.reset();
  optimize::Progress progress;
  try {
    tolerances({.design = design, .source = "plain.toml"}, progress);
    FAIL() << "no exception";
  } catch (const io::InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()),
              "plain.toml: has no [tolerances]; allowed: a DESIGN with them (docs/keys.md)");
  }
}

}  // namespace
}  // namespace gear3k::app::tolerances_test
