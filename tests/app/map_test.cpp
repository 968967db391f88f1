#include "app/map.hpp"

#include <gtest/gtest.h>

#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::app::map_test {
namespace {

TEST(Map, HasAPointForEachSpeedAndTorqueOfTheGrid) {
  design::Design design =
      io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/ratio_96_with_losses.toml");
  design.map.sun_speed_rad_s.points = 4;
  design.map.output_torque_Nm.points = 3;
  const Map result = map({.design = design});
  EXPECT_EQ(result.map.name, design.name);
  EXPECT_EQ(result.map.points.size(), 12U);
  EXPECT_TRUE(result.model_notes.empty());
}

TEST(Map, OfMeshesWithoutContactIsRefused) {
  design::Design design =
      io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/bilateral_drive_gear.toml");
  design.train.center_distance_m = 0.0234;
  design.center_distance_given = true;
  EXPECT_THROW(map({.design = design}), io::InvalidInput);
}

}  // namespace
}  // namespace gear3k::app::map_test
