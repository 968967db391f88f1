#include "design/elastic_windup.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace gear3k::design::elastic_windup_test {
namespace {

// Straight lines over ln F: halfway between 1 and 100 N lies 10 N.
TEST(MeshCompliance, IsLinearInTheForcesLogarithmAndConstantBeyondTheEnds) {
  const std::vector<ElasticTrain::MeshSpring> spring{{.normal_N = 1.0, .compliance_m_N = 8e-9},
                                                     {.normal_N = 100.0, .compliance_m_N = 4e-9},
                                                     {.normal_N = 1000.0, .compliance_m_N = 3e-9}};
  EXPECT_NEAR(mesh_compliance(spring, 10.0), 6e-9, 1e-22);
  EXPECT_NEAR(mesh_compliance(spring, std::pow(10.0, 1.5)), 5e-9, 1e-22);
  EXPECT_NEAR(mesh_compliance(spring, std::pow(10.0, 2.75)), 3.25e-9, 1e-22);
  EXPECT_EQ(mesh_compliance(spring, 100.0), 4e-9);
  EXPECT_EQ(mesh_compliance(spring, 0.0), 8e-9);
  EXPECT_EQ(mesh_compliance(spring, 0.5), 8e-9);
  EXPECT_EQ(mesh_compliance(spring, 1e6), 3e-9);
}

}  // namespace
}  // namespace gear3k::design::elastic_windup_test
