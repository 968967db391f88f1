#include "efficiency/mesh_loss_slopes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "tests/largest_deviation.hpp"

namespace gear3k::efficiency::mesh_loss_slopes_test {
namespace {

class SlopeRandom {
 public:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

 private:
  std::mt19937_64 generator_{31};
};

TEST(MeshEfficiencySlopes, AreThoseOfTheScalarWithDerivatives) {
  constexpr std::array<LossModel, 4> kModels{LossModel::kSliding, LossModel::kOhlendorf,
                                             LossModel::kCoulombPath, LossModel::kDirectional};
  SlopeRandom random;
  LargestDeviation efficiency, slopes;
  for (int i = 0; i < 4000; ++i) {
    const LossModel model = kModels[static_cast<std::size_t>(i % 4)];
    const bool ring = random.count(0, 1) == 1;
    const int z1 = random.count(10, 60);
    // Beyond the pitch point on one side, without contact, and where flanks jam, too.
    const MeshContact<double> c{.z1 = z1,
                                .z2 = ring ? z1 + random.count(10, 90) : random.count(10, 90),
                                .sign = ring ? -1.0 : 1.0,
                                .approach_contact_ratio = random.between(-0.3, 1.8),
                                .recess_contact_ratio = random.between(-0.3, 1.8),
                                .tan_alpha_w = random.between(0.2, 0.6),
                                .gear1_drives = random.count(0, 1) == 1};
    const bool alike = random.count(0, 3) == 0;
    const FlankFriction<double> mu{.coefficient = random.between(0.0, i % 50 == 0 ? 3.0 : 0.3),
                                   .approach_factor = alike ? 1.0 : random.between(0.5, 2.0),
                                   .recess_factor = alike ? 1.0 : random.between(0.5, 2.0)};
    // Of the scalar that knows nothing of drawn gears.
    const auto contact = contact_in<Jet2>(c, [](double x) { return Jet2(x); });
    const Jet2 exact =
        mesh_efficiency<Jet2>(contact,
                              {.coefficient = Jet2::variable(mu.coefficient, 0),
                               .approach_factor = Jet2::variable(mu.approach_factor, 1),
                               .recess_factor = Jet2::variable(mu.recess_factor, 2)},
                              model);
    const MeshEfficiencySlopes fast = mesh_efficiency_slopes(c, mu, model, LossSlopes::kByAll);
    efficiency.see(i, fast.efficiency - exact.value, 1e-14 * (1.0 + std::abs(exact.value)));
    const std::array<double, 3> slope{fast.by_coefficient, fast.by_approach_factor,
                                      fast.by_recess_factor};
    const double scale = 1.0 + std::hypot(exact.by_row[0], exact.by_row[1], exact.by_row[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      slopes.see(i, slope[k] - exact.by_row[k], 1e-12 * scale);
    }
    const MeshEfficiencySlopes short_cut =
        mesh_efficiency_slopes(c, mu, model, LossSlopes::kByCoefficient);
    const MeshEfficiencySlopes value = mesh_efficiency_slopes(c, mu, model, LossSlopes::kNone);
    slopes.see(i, short_cut.by_coefficient - exact.by_row[0], 1e-12 * scale);
    efficiency.see(i, short_cut.efficiency - exact.value, 1e-14 * (1.0 + std::abs(exact.value)));
    efficiency.see(i, value.efficiency - exact.value, 1e-14 * (1.0 + std::abs(exact.value)));
  }
  efficiency.expect_allowed("efficiency");
  slopes.expect_allowed("slopes");
}

}  // namespace
}  // namespace gear3k::efficiency::mesh_loss_slopes_test
