#include "efficiency/friction_law.hpp"

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/largest_deviation.hpp"

namespace gear3k::efficiency::friction_law_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kZeroCelsius = 273.15;

class Random {
 public:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  /// Evenly over the orders of magnitude.
  double scale(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

 private:
  std::mt19937_64 generator_{25};
};

MeshState<double> some_state(Random& random) {
  return {.normal_force_N = random.scale(1.0, 1e4),
          .sliding_speed_m_s = random.scale(1e-4, 10.0),
          .sum_speed_m_s = random.scale(1e-3, 20.0),
          .reduced_radius_m = random.scale(5e-4, 2e-2),
          .face_width_m = random.scale(2e-3, 3e-2),
          .temperature_K = random.between(260.0, 380.0)};
}

Friction<double> friction_of(FrictionLaw law) {
  Friction<double> f{};
  f.law = law;
  f.coefficient = 0.08;
  return f;
}

Lubricant<double> oil_of(double viscosity40_mm2_s, double viscosity100_mm2_s) {
  return {.temperature_K = {kZeroCelsius + 40.0, kZeroCelsius + 100.0},
          .viscosity_m2_s = {viscosity40_mm2_s * 1e-6, viscosity100_mm2_s * 1e-6},
          .density_kgm3 = 870.0};
}

Friction<double> schlenk_of(Random& random) {
  Friction<double> f = friction_of(FrictionLaw::kSchlenk);
  f.roughness_m = random.scale(1e-7, 3e-6);
  f.lubricant_factor = random.between(0.6, 1.3);
  const double thick = random.scale(15.0, 500.0);
  f.lubricant = oil_of(thick, thick * random.between(0.08, 0.3));
  return f;
}

/// Friction that a test expects the law to have.
double coefficient(const Friction<double>& f, const MeshState<double>& state) {
  const auto mu = friction_coefficient(f, state);
  EXPECT_TRUE(mu.has_value());
  return mu.value_or(std::numeric_limits<double>::quiet_NaN());
}

TEST(ConstantFriction, DependsOnNothing) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(coefficient(friction_of(FrictionLaw::kConstant), some_state(random)), 0.08);
  }
}

TEST(LoadPowerFriction, IsAStraightLineOverLogarithms) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 500; ++i) {
    Friction<double> f = friction_of(FrictionLaw::kLoadPower);
    f.load_exponent = random.between(-0.4, 0.3);
    f.reference_force_N = random.scale(1.0, 1e3);
    MeshState<double> state = some_state(random);
    state.normal_force_N = f.reference_force_N;
    EXPECT_NEAR(coefficient(f, state), 0.08, 4.0 * kEps);
    // Each doubling of the force multiplies by the same number: from halves and doubles alone.
    const double step = std::exp2(f.load_exponent);
    double expected = 0.08;
    for (int k = 0; k < 6; ++k) {
      state.normal_force_N *= 2.0;
      expected *= step;
      largest.see(i, coefficient(f, state) - expected, 32.0 * kEps * expected);
    }
    // In kilonewtons and ounces the law is the same.
    state.normal_force_N *= 0.37;
    const double mu = coefficient(f, state);
    f.reference_force_N *= 0.22481;
    state.normal_force_N *= 0.22481;
    largest.see(i, coefficient(f, state) - mu, 32.0 * kEps * mu);
  }
  largest.expect_allowed("load_power");
}

TEST(LoadPowerFriction, WithoutLoadIsZeroTheCoefficientOrNothingByTheSignOfItsExponent) {
  Friction<double> f = friction_of(FrictionLaw::kLoadPower);
  f.reference_force_N = 100.0;
  MeshState<double> state{};
  f.load_exponent = 0.2;
  EXPECT_EQ(coefficient(f, state), 0.0);
  f.load_exponent = 0.0;
  EXPECT_EQ(coefficient(f, state), 0.08);
  f.load_exponent = -0.2;
  EXPECT_FALSE(friction_coefficient(f, state).has_value());
}

TEST(StribeckFriction, StartsStaticEndsRunningAndIsBetweenThemWithoutViscosity) {
  Random random;
  for (int i = 0; i < 500; ++i) {
    Friction<double> f = friction_of(FrictionLaw::kStribeck);
    f.static_coefficient = random.between(0.1, 0.3);
    f.stribeck_speed_m_s = random.scale(1e-3, 1.0);
    f.stribeck_exponent = random.between(0.5, 2.0);
    MeshState<double> state = some_state(random);
    const auto at = [&](double speed) {
      state.sliding_speed_m_s = speed * f.stribeck_speed_m_s;
      return coefficient(f, state);
    };
    EXPECT_EQ(at(0.0), f.static_coefficient);
    EXPECT_NEAR(at(1e-30), f.static_coefficient, 4.0 * kEps + 1e-15);
    EXPECT_EQ(at(1e6), 0.08);
    // At the Stribeck speed 1/e of the fall is left, whatever the exponent.
    EXPECT_NEAR((at(1.0) - 0.08) * 2.718281828459045, f.static_coefficient - 0.08, 8.0 * kEps);
    double last = f.static_coefficient;
    for (double speed = 0.05; speed < 3.0; speed += 0.05) {
      const double mu = at(speed);
      EXPECT_LT(mu, last);
      EXPECT_GT(mu, 0.08);
      last = mu;
    }
    // The fall's share left is e^-x with x = (v/v_s)^δ: x doubles at 2^(1/δ) times the speed, and
    // the share is then squared.
    const double share = (at(0.3) - 0.08) / (f.static_coefficient - 0.08);
    const double squared =
        (at(0.3 * std::exp2(1.0 / f.stribeck_exponent)) - 0.08) / (f.static_coefficient - 0.08);
    EXPECT_NEAR(squared, share * share, 64.0 * kEps / (f.static_coefficient - 0.08));
  }
}

TEST(StribeckFriction, RisesByTheViscousShareAtHighSpeed) {
  Friction<double> f = friction_of(FrictionLaw::kStribeck);
  f.static_coefficient = 0.15;
  f.stribeck_speed_m_s = 0.01;
  f.viscous_s_m = 0.004;
  MeshState<double> state{};
  state.sliding_speed_m_s = 5.0;  // 4 per mille per m/s
  EXPECT_NEAR(coefficient(f, state), 0.08 + 0.02, 4.0 * kEps);
}

TEST(SchlenkFriction, HasTheValueOfAComputationByHand) {
  // 400 N on 4 mm of face: 100 N/mm; over 5 m/s and 10 mm: 2.  32 mPa s = 2^5; Ra 16 um = 2^4;
  // 0.048 2^(1/5) 2^(-1/4) 2 0.75 = 0.072 2^(-1/20), where 2^(-1/20) = 0.965936.
  Friction<double> f = friction_of(FrictionLaw::kSchlenk);
  f.roughness_m = 16e-6;
  f.lubricant_factor = 0.75;
  f.lubricant = oil_of(40.0, 6.0);
  f.lubricant.density_kgm3 = 800.0;  // 40 mm2/s are 32 mPa s
  const MeshState<double> state{.normal_force_N = 400.0,
                                .sliding_speed_m_s = 1.0,
                                .sum_speed_m_s = 5.0,
                                .reduced_radius_m = 10e-3,
                                .face_width_m = 4e-3,
                                .temperature_K = kZeroCelsius + 40.0};
  constexpr double kHalfUnit = 0.5e-6;  // of 2^(-1/20)
  EXPECT_NEAR(coefficient(f, state), 0.072 * 0.965936, 0.072 * kHalfUnit);
}

TEST(SchlenkFriction, InSiUnitsHasTheConstantTimesTenToThe015) {
  // N/mm per mm: 10^-6, to the 0.2; Pa s to mPa s: 10^3 to the -0.05; m to um: 10^6 to the 0.25.
  const double constant = 0.048 * std::pow(10.0, -1.2 - 0.15 + 1.5);
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 1000; ++i) {
    const Friction<double> f = schlenk_of(random);
    const MeshState<double> s = some_state(random);
    const double eta = dynamic_viscosity(f.lubricant, s.temperature_K);
    const double lg = 0.2 * (std::log10(s.normal_force_N) - std::log10(s.face_width_m) -
                             std::log10(s.sum_speed_m_s) - std::log10(s.reduced_radius_m)) -
                      0.05 * std::log10(eta) + 0.25 * std::log10(f.roughness_m);
    const double expected =
        std::min(kGreatestFriction, constant * f.lubricant_factor * std::pow(10.0, lg));
    largest.see(i, coefficient(f, s) - expected, 64.0 * kEps * expected);
  }
  largest.expect_allowed("schlenk");
}

TEST(SchlenkFriction, HasNoValueAtRestAndNoneIsNeededWithoutLoad) {
  Random random;
  const Friction<double> f = schlenk_of(random);
  MeshState<double> state = some_state(random);
  state.sum_speed_m_s = 0.0;
  EXPECT_FALSE(friction_coefficient(f, state).has_value());
  state.sum_speed_m_s = 1.0;
  state.normal_force_N = 0.0;
  EXPECT_EQ(coefficient(f, state), 0.0);
  state.normal_force_N = 1e-60;
  EXPECT_LT(coefficient(f, state), 1e-12);
}

/// A table with more speeds than forces.
Friction<double> table_of(Random& random, std::size_t forces, std::size_t speeds) {
  Friction<double> f = friction_of(FrictionLaw::kTable);
  double v = random.between(0.0, 0.1);
  double force = random.between(0.0, 50.0);
  for (std::size_t i = 0; i < speeds; ++i) {
    f.table.sliding_speed_m_s.push_back(v += random.between(0.01, 2.0));
  }
  for (std::size_t i = 0; i < forces; ++i) {
    f.table.tooth_force_N.push_back(force += random.between(5.0, 300.0));
  }
  for (std::size_t i = 0; i < speeds * std::max<std::size_t>(forces, 1); ++i) {
    f.table.coefficient.push_back(random.between(0.02, 0.3));
  }
  return f;
}

TEST(TableFriction, IsTheTableAtItsNodes) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    const std::size_t forces = static_cast<std::size_t>(random.count(1, 4));
    const std::size_t speeds = static_cast<std::size_t>(random.count(1, 5));
    const Friction<double> f = table_of(random, forces, speeds);
    MeshState<double> state{};
    std::size_t node = 0;
    for (const double force : f.table.tooth_force_N) {
      for (const double speed : f.table.sliding_speed_m_s) {
        state.normal_force_N = force;
        state.sliding_speed_m_s = speed;
        EXPECT_NEAR(coefficient(f, state), f.table.coefficient[node++], 2.0 * kEps);
      }
    }
  }
}

TEST(TableFriction, BetweenNodesWeightsTheFourCornersByTheOppositeAreas) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 1000; ++i) {
    const Friction<double> f = table_of(random, 4, 5);
    const auto& v = f.table.sliding_speed_m_s;
    const auto& n = f.table.tooth_force_N;
    const std::size_t a = static_cast<std::size_t>(random.count(0, 3));
    const std::size_t b = static_cast<std::size_t>(random.count(0, 2));
    MeshState<double> state{};
    state.sliding_speed_m_s = random.between(v[a], v[a + 1]);
    state.normal_force_N = random.between(n[b], n[b + 1]);
    double expected = 0.0;
    for (const std::size_t i1 : {a, a + 1}) {
      for (const std::size_t i2 : {b, b + 1}) {
        const double width = std::abs(state.sliding_speed_m_s - v[a + a + 1 - i1]);
        const double height = std::abs(state.normal_force_N - n[b + b + 1 - i2]);
        expected += f.table.coefficient[i2 * v.size() + i1] * width * height;
      }
    }
    expected /= (v[a + 1] - v[a]) * (n[b + 1] - n[b]);
    largest.see(i, coefficient(f, state) - expected, 256.0 * kEps);
  }
  largest.expect_allowed("bilinear");
}

TEST(TableFriction, BeyondItsEdgesIsThatOfTheEdge) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const Friction<double> f = table_of(random, 3, 4);
    const auto& v = f.table.sliding_speed_m_s;
    const auto& n = f.table.tooth_force_N;
    MeshState<double> inside{};
    inside.sliding_speed_m_s = random.between(v.front(), v.back());
    inside.normal_force_N = n.back();
    MeshState<double> outside = inside;
    outside.normal_force_N = n.back() * 7.0;
    EXPECT_NEAR(coefficient(f, outside), coefficient(f, inside), 2.0 * kEps);
    inside.normal_force_N = n.front();
    outside.normal_force_N = 0.0;
    EXPECT_NEAR(coefficient(f, outside), coefficient(f, inside), 2.0 * kEps);
    outside.sliding_speed_m_s = 0.0;
    EXPECT_EQ(coefficient(f, outside), f.table.coefficient.front());
    outside.sliding_speed_m_s = 1e9;
    outside.normal_force_N = 1e9;
    EXPECT_EQ(coefficient(f, outside), f.table.coefficient.back());
  }
}

TEST(TableFriction, WithoutForcesDependsOnSpeedAlone) {
  Random random;
  const Friction<double> f = table_of(random, 0, 4);
  MeshState<double> state{};
  state.sliding_speed_m_s = 0.5 * (f.table.sliding_speed_m_s[1] + f.table.sliding_speed_m_s[2]);
  const double middle = 0.5 * (f.table.coefficient[1] + f.table.coefficient[2]);
  for (const double force : {0.0, 1.0, 1e5}) {
    state.normal_force_N = force;
    EXPECT_NEAR(coefficient(f, state), middle, 4.0 * kEps);
  }
}

TEST(FrictionLaw, IsContinuousInForceAndSpeed) {
  Random random;
  for (int i = 0; i < 300; ++i) {
    std::vector<Friction<double>> laws;
    laws.push_back(schlenk_of(random));
    laws.push_back(table_of(random, 3, 3));
    laws.push_back(friction_of(FrictionLaw::kStribeck));
    laws.back().static_coefficient = 0.2;
    laws.back().stribeck_speed_m_s = 0.1;
    laws.push_back(friction_of(FrictionLaw::kLoadPower));
    laws.back().load_exponent = -0.3;
    laws.back().reference_force_N = 300.0;
    for (const Friction<double>& f : laws) {
      MeshState<double> state = some_state(random);
      if (f.law == FrictionLaw::kTable && i % 2 == 0) {  // at a kink
        state.normal_force_N = f.table.tooth_force_N[1];
        state.sliding_speed_m_s = f.table.sliding_speed_m_s[2];
      }
      const double before = coefficient(f, state);
      for (double* x : {&state.normal_force_N, &state.sliding_speed_m_s, &state.sum_speed_m_s}) {
        const double kept = *x;
        for (const double step : {-1e-9, 1e-9}) {
          *x = kept * (1.0 + step);
          // Slopes over a share of the argument: below 100 in tables of close nodes.
          EXPECT_NEAR(coefficient(f, state), before, 1e-7)
              << kFrictionLawNames[static_cast<std::size_t>(f.law)];
        }
        *x = kept;
      }
    }
  }
}

TEST(FrictionLaw, IsNeverAboveTheGreatestFriction) {
  Friction<double> f = friction_of(FrictionLaw::kLoadPower);
  f.load_exponent = -1.0;
  f.reference_force_N = 1.0;
  MeshState<double> state{};
  state.normal_force_N = 1e-6;
  EXPECT_EQ(coefficient(f, state), kGreatestFriction);
  f = friction_of(FrictionLaw::kStribeck);
  f.stribeck_speed_m_s = 1.0;
  f.viscous_s_m = 1.0;
  state.sliding_speed_m_s = 100.0;
  EXPECT_EQ(coefficient(f, state), kGreatestFriction);
}

TEST(FrictionLaw, NamesAreThoseOfTheFilesAndOnlyTheConstantDependsOnNothing) {
  EXPECT_EQ(kFrictionLawNames[static_cast<std::size_t>(FrictionLaw::kLoadPower)], "load_power");
  EXPECT_EQ(kFrictionLawNames[static_cast<std::size_t>(FrictionLaw::kTable)], "table");
  Random random;
  for (const FrictionLaw law :
       {FrictionLaw::kConstant, FrictionLaw::kLoadPower, FrictionLaw::kStribeck,
        FrictionLaw::kSchlenk, FrictionLaw::kTable}) {
    Friction<double> f = law == FrictionLaw::kTable ? table_of(random, 4, 4) : schlenk_of(random);
    f.law = law;
    f.static_coefficient = 0.3;
    f.stribeck_speed_m_s = 1.0;
    f.reference_force_N = 10.0;
    f.load_exponent = -0.1;
    MeshState<double> state{.normal_force_N = 120.0,
                            .sliding_speed_m_s = 0.7,
                            .sum_speed_m_s = 2.0,
                            .reduced_radius_m = 5e-3,
                            .face_width_m = 5e-3,
                            .temperature_K = 320.0};
    if (law == FrictionLaw::kTable) {
      state.normal_force_N = 0.4 * f.table.tooth_force_N[0] + 0.6 * f.table.tooth_force_N[1];
    }
    const double before = coefficient(f, state);
    state.normal_force_N *= 1.01;
    const bool loaded = law != FrictionLaw::kConstant && law != FrictionLaw::kStribeck;
    EXPECT_EQ(coefficient(f, state) != before, loaded);
    state.sliding_speed_m_s *= 1.3;
    state.sum_speed_m_s *= 1.3;
    EXPECT_EQ(coefficient(f, state) != before, depends_on_state(law));
  }
}

template <class T>
Friction<T> cast(const Friction<double>& f) {
  return {.coefficient = T(f.coefficient),
          .model = f.model,
          .approach_factor = T(f.approach_factor),
          .recess_factor = T(f.recess_factor),
          .law = f.law,
          .load_exponent = T(f.load_exponent),
          .reference_force_N = T(f.reference_force_N),
          .static_coefficient = T(f.static_coefficient),
          .stribeck_speed_m_s = T(f.stribeck_speed_m_s),
          .stribeck_exponent = T(f.stribeck_exponent),
          .viscous_s_m = T(f.viscous_s_m),
          .roughness_m = T(f.roughness_m),
          .lubricant_factor = T(f.lubricant_factor),
          .lubricant = {.temperature_K = {T(f.lubricant.temperature_K[0]),
                                          T(f.lubricant.temperature_K[1])},
                        .viscosity_m2_s = {T(f.lubricant.viscosity_m2_s[0]),
                                           T(f.lubricant.viscosity_m2_s[1])},
                        .density_kgm3 = T(f.lubricant.density_kgm3)},
          .table = f.table};
}

TEST(FrictionLaw, GradientIsThatOfCentralDifferences) {
  constexpr double kShare = 1e-5;
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 300; ++i) {
    std::vector<Friction<double>> laws;
    laws.push_back(schlenk_of(random));
    laws.push_back(table_of(random, 3, 3));
    laws.push_back(friction_of(FrictionLaw::kStribeck));
    laws.back().static_coefficient = 0.2;
    laws.back().stribeck_speed_m_s = 0.1;
    laws.back().stribeck_exponent = 1.4;
    laws.back().viscous_s_m = 0.003;
    laws.push_back(friction_of(FrictionLaw::kLoadPower));
    laws.back().load_exponent = -0.3;
    laws.back().reference_force_N = 300.0;
    for (const Friction<double>& f : laws) {
      const MeshState<double> s = some_state(random);
      if (f.law == FrictionLaw::kTable) {
        const auto close = [](const std::vector<double>& nodes, double x) {
          return std::ranges::any_of(
              nodes, [&](double node) { return std::abs(node - x) < 2.0 * kShare * x; });
        };
        if (close(f.table.tooth_force_N, s.normal_force_N)) continue;
        if (close(f.table.sliding_speed_m_s, s.sliding_speed_m_s)) continue;
      }
      const std::array<double, 6> x{s.normal_force_N,   s.sliding_speed_m_s, s.sum_speed_m_s,
                                    s.reduced_radius_m, s.face_width_m,      s.temperature_K};
      const auto jet = [&](int k) { return Jet1(x[static_cast<std::size_t>(k)], k); };
      const auto mu = friction_coefficient<Jet1>(cast<Jet1>(f), {.normal_force_N = jet(0),
                                                                 .sliding_speed_m_s = jet(1),
                                                                 .sum_speed_m_s = jet(2),
                                                                 .reduced_radius_m = jet(3),
                                                                 .face_width_m = jet(4),
                                                                 .temperature_K = jet(5)});
      ASSERT_TRUE(mu.has_value());
      if (mu->a > 0.99 * kGreatestFriction) continue;
      EXPECT_NEAR(mu->a, coefficient(f, s), 16.0 * kEps);
      const auto at = [&](const std::array<double, 6>& y) {
        return coefficient(f, {.normal_force_N = y[0],
                               .sliding_speed_m_s = y[1],
                               .sum_speed_m_s = y[2],
                               .reduced_radius_m = y[3],
                               .face_width_m = y[4],
                               .temperature_K = y[5]});
      };
      for (std::size_t k = 0; k < 6; ++k) {
        auto above = x;
        auto below = x;
        above[k] *= 1.0 + kShare;
        below[k] *= 1.0 - kShare;
        const double slope = (at(above) - at(below)) / (2.0 * kShare);  // over a share of x
        // Truncation: the third derivative over a share is of order 10³ (temperature).
        largest.see(i, mu->v[static_cast<int>(k)] * x[k] - slope,
                    1e3 * kShare * kShare + 16.0 * kEps / kShare);
      }
    }
  }
  largest.expect_allowed("gradient");
}

double kinematic_mm2_s(const Lubricant<double>& oil, double celsius) {
  return dynamic_viscosity(oil, celsius + kZeroCelsius) / oil.density_kgm3 * 1e6;
}

TEST(Viscosity, PassesThroughBothPointsAndFallsWithTemperature) {
  Random random;
  for (int i = 0; i < 500; ++i) {
    const double thick = random.scale(5.0, 1000.0);
    const double thin = thick * random.between(0.08, 0.6);
    Lubricant<double> oil = oil_of(thick, thin);
    // lg lg loses digits: a relative ν ln ν of rounding.
    const double allowed = 64.0 * kEps * (1.0 + std::abs(std::log(thick)));
    EXPECT_NEAR(kinematic_mm2_s(oil, 40.0), thick, allowed * (thick + 1.0));
    EXPECT_NEAR(kinematic_mm2_s(oil, 100.0), thin, allowed * (thin + 1.0));
    double last = std::numeric_limits<double>::infinity();
    for (double t = 0.0; t <= 150.0; t += 5.0) {
      const double nu = kinematic_mm2_s(oil, t);
      EXPECT_LT(nu, last);
      EXPECT_GT(nu, -0.8);
      last = nu;
    }
    // The order of the points does not matter.
    const double at60 = kinematic_mm2_s(oil, 60.0);
    std::swap(oil.temperature_K[0], oil.temperature_K[1]);
    std::swap(oil.viscosity_m2_s[0], oil.viscosity_m2_s[1]);
    EXPECT_NEAR(kinematic_mm2_s(oil, 60.0), at60, allowed * (at60 + 1.0));
  }
}

TEST(Viscosity, AThirdPointOfTheLineGivesTheSameOil) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const double thick = random.scale(10.0, 500.0);
    const Lubricant<double> oil = oil_of(thick, thick * random.between(0.08, 0.4));
    Lubricant<double> same = oil;
    same.temperature_K[1] = kZeroCelsius + 65.0;
    same.viscosity_m2_s[1] = kinematic_mm2_s(oil, 65.0) * 1e-6;
    for (const double t : {20.0, 50.0, 80.0, 100.0}) {
      const double nu = kinematic_mm2_s(oil, t);
      EXPECT_NEAR(kinematic_mm2_s(same, t), nu, 1e-12 * (nu + 1.0));
    }
  }
}

TEST(Viscosity, PublishedThirdPointsAreReproducedWithTheirConstantAndNearlyWith08) {
  const toml::table file =
      toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/viscosity_temperature.toml");
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  ASSERT_NE(std::string(file["locator"].value_or("")), "");
  const double half_unit = 0.5 * std::pow(10.0, -file["decimals"].value<int>().value());
  int cases = 0;
  for (const toml::node& node : *file["case"].as_array()) {
    const toml::table& c = *node.as_table();
    const auto number = [&](const char* key) { return c[key].value<double>().value(); };
    const double nu60 = number("nu60");
    // Their constant is that of the oil.  ν + c is the same for ν + (c − 0.8) with 0.8.
    const double shift = number("vtc") - 0.8;
    EXPECT_NEAR(number("vtc"), 1.0 - number("nu100") / number("nu40"), 0.5e-6);
    const double same_constant =
        kinematic_mm2_s(oil_of(number("nu40") + shift, number("nu100") + shift), 60.0) - shift;
    // Single precision: lg lg ν near 0.2 comes from m lg T and a near 10, each with 2^-24; the two
    // exponentials multiply that by ν ln ν ln 10.
    const double single = std::exp2(-24.0) * 2.0 * 10.0 * 2.3 * nu60 * std::log(nu60);
    EXPECT_NEAR(same_constant, nu60, half_unit + single) << c["id"].value_or("");
    // The standard's constant for every oil: the deviation is that of the constants.
    const double standard = kinematic_mm2_s(oil_of(number("nu40"), number("nu100")), 60.0);
    EXPECT_LT(std::abs(standard / nu60 - 1.0), 7e-3) << c["id"].value_or("");
    EXPECT_EQ(standard<nu60, shift> 0.0) << c["id"].value_or("");
    ++cases;
  }
  EXPECT_EQ(cases, 8);
}

TEST(Viscosity, OutsideItsRangeNamesWhatIsWrong) {
  const auto message = [](const Lubricant<double>& oil, double temperature) {
    try {
      static_cast<void>(dynamic_viscosity(oil, temperature));
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  const Lubricant<double> good = oil_of(68.0, 8.6);
  EXPECT_EQ(message(good, 300.0), "accepted");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -5.0, nan}) {
    EXPECT_NE(message(good, bad).find("temperature"), std::string::npos);
    Lubricant<double> oil = good;
    oil.viscosity_m2_s[1] = bad;
    EXPECT_NE(message(oil, 300.0).find("viscosity"), std::string::npos);
    oil = good;
    oil.temperature_K[0] = bad;
    EXPECT_NE(message(oil, 300.0).find("temperature"), std::string::npos);
  }
  Lubricant<double> oil = good;
  oil.temperature_K[1] = oil.temperature_K[0];
  EXPECT_NE(message(oil, 300.0).find("temperature"), std::string::npos);
}

/// The factor in plain words, one power at a time.
TEST(FrictionExtension, EachFactorActsAsItsFormulaSays) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const MeshState<double> state = some_state(random);
    const auto factor = [&](auto set, bool forward = true) {
      Friction<double> f = friction_of(FrictionLaw::kConstant);
      f.coefficient = 1e-4;  // far from the greatest value
      set(f.extension);
      MeshState<double> s = state;
      s.forward = forward;
      return coefficient(f, s) / 1e-4;
    };
    using Extension = FrictionExtension<double>;
    const double n = random.between(-0.4, 0.4);
    const auto near = [](double value, double expected) {
      EXPECT_NEAR(value, expected, 1e-12 * expected);
    };
    near(factor([](Extension& e) { e.level = 1.7; }), 1.7);
    near(factor([](Extension& e) { e.forward = 0.6; }), 0.6);
    near(factor([](Extension& e) { e.forward = 0.6; }, false), 1.0);
    near(factor([](Extension& e) { e.backward = 1.3; }, false), 1.3);
    near(factor([&](Extension& e) {
           e.load_exponent = n;
           e.reference_force_N = 40.0;
         }),
         std::pow(std::max(state.normal_force_N / 40.0, 1e-3), n));
    near(factor([&](Extension& e) {
           e.speed_exponent = n;
           e.reference_speed_m_s = 0.2;
         }),
         std::pow(std::max(state.sliding_speed_m_s / 0.2, 1e-3), n));
    near(factor([&](Extension& e) {
           e.slow_excess = 0.8;
           e.slow_speed_m_s = 0.05;
         }),
         1.0 + 0.8 * std::exp(-state.sliding_speed_m_s / 0.05));
    near(factor([&](Extension& e) {
           e.temperature_1_K = -0.01;
           e.reference_temperature_K = 310.0;
         }),
         std::exp(-0.01 * (state.temperature_K - 310.0)));
    // Bends: 1 at the reference, and beyond one and a half ranges as there.
    const double q = random.between(-0.5, 0.5);
    const double c = random.between(-0.5, 0.5);
    const FrictionBend<double> bend{.quadratic = q, .cubic = c, .half_range = 0.7};
    const auto bent = [&](double from_reference) {
      const double x = std::clamp(from_reference / 0.7, -1.5, 1.5);
      return std::exp(q * std::pow(x, 2) + c * std::pow(x, 3));
    };
    near(factor([&](Extension& e) {
           e.load_bend = bend;
           e.reference_force_N = 40.0;
         }),
         bent(std::log(state.normal_force_N / 40.0)));
    near(factor([&](Extension& e) {
           e.speed_bend = bend;
           e.reference_speed_m_s = 0.2;
         }),
         bent(std::log(state.sliding_speed_m_s / 0.2)));
    near(factor([&](Extension& e) {
           e.temperature_bend = bend;
           e.temperature_bend.half_range = 15.0;
           e.reference_temperature_K = 310.0;
         }),
         bent((state.temperature_K - 310.0) * 0.7 / 15.0));
  }
}

TEST(FrictionExtension, OfAnyLawItMultipliesTheCoefficientUpToTheGreatest) {
  Random random;
  Friction<double> f = schlenk_of(random);
  const MeshState<double> state = some_state(random);
  const double plain = coefficient(f, state);
  f.extension.level = 2.0;
  EXPECT_NEAR(coefficient(f, state), std::min(2.0 * plain, kGreatestFriction), 1e-15);
  f.extension.level = 1e6;
  EXPECT_EQ(coefficient(f, state), kGreatestFriction);
}

TEST(FrictionExtension, LoadAndSpeedMakeConstantFrictionDependOnTheState) {
  Friction<double> f = friction_of(FrictionLaw::kConstant);
  EXPECT_FALSE(depends_on_state(f));
  f.extension.level = 2.0;
  f.extension.approach = 1.2;
  f.extension.backward = 0.9;
  EXPECT_FALSE(depends_on_state(f));
  f.extension.load_exponent = 0.1;
  EXPECT_TRUE(depends_on_state(f));
}

TEST(Curve, OfValuesOnAParabolaIsThatParabolaInside) {
  // The slope of a parabola is that of the chord over two intervals.
  const auto parabola = [](double x) { return 0.3 - 0.2 * x + 0.7 * x * x; };
  for (const int places : {5, 7}) {
    FrictionBend<double> bend{.places = places};
    for (int k = 0; k < places; ++k) {
      bend.s[static_cast<std::size_t>(k)] = parabola(2.0 * k / (places - 1) - 1.0);
    }
    for (const double x : {-0.49, -0.1, 0.0, 0.26, 0.5}) {
      EXPECT_NEAR(curve_at(bend, x), parabola(x), 1e-14) << places << " " << x;
    }
    for (const double x : {-1.0, 1.0}) EXPECT_NEAR(curve_at(bend, x), parabola(x), 1e-14);
  }
}

/// Through given places at random, from one hundredth of the range apart.
FrictionBend<double> uneven(Random& random) {
  FrictionBend<double> bend{.places = random.count(4, 7)};
  const auto last = static_cast<std::size_t>(bend.places - 1);
  std::vector<double> gap(last);
  for (double& g : gap) g = random.scale(0.01, 1.0);
  const double range = std::accumulate(gap.begin(), gap.end(), 0.0);
  bend.x[0] = -1.0;
  for (std::size_t k = 1; k < last; ++k) bend.x[k] = bend.x[k - 1] + 2.0 * gap[k - 1] / range;
  bend.x[last] = 1.0;
  for (std::size_t k = 0; k <= last; ++k) bend.s[k] = random.between(-1.5, 1.5);
  return bend;
}

TEST(Curve, OfUnevenPlacesGoesThroughThemAndStaysBetweenNeighbours) {
  Random random;
  for (int trial = 0; trial < 300; ++trial) {
    const FrictionBend<double> bend = uneven(random);
    const auto last = static_cast<std::size_t>(bend.places - 1);
    for (std::size_t k = 0; k <= last; ++k) {
      EXPECT_NEAR(curve_at(bend, bend.x[k]), bend.s[k], 1e-12) << k;
    }
    for (std::size_t k = 0; k < last; ++k) {
      const auto [low, high] = std::minmax(bend.s[k], bend.s[k + 1]);
      // One way from the one to the other, in small steps.
      double before = bend.s[k];
      for (int step = 1; step < 60; ++step) {
        const double x = bend.x[k] + (bend.x[k + 1] - bend.x[k]) * step / 60.0;
        const double s = curve_at(bend, x);
        EXPECT_GE(s, low - 1e-12) << trial << ' ' << k << ' ' << step;
        EXPECT_LE(s, high + 1e-12) << trial << ' ' << k << ' ' << step;
        EXPECT_GE((s - before) * (bend.s[k + 1] - bend.s[k]), -1e-12) << trial << ' ' << k;
        before = s;
      }
    }
  }
}

TEST(Curve, BetweenLevelsThatAShortStepPrecedesIsNotDrawnBeyondThem) {
  // Loads 5, 5.5, 20 and 45 N m, friction 1/1.5 at the first and 1 at the others.
  const double half = 0.5 * std::log(45.0 / 5.0);
  const auto at = [&](double load_Nm) { return std::log(load_Nm / 15.0) / half; };
  FrictionBend<double> bend{.s = {-std::log(1.5)}, .places = 4};
  bend.x = {-1.0, at(5.5), at(20.0), 1.0};
  for (const double load_Nm : {5.5, 6.0, 8.45, 12.0, 20.0, 30.0, 45.0, 60.0}) {
    EXPECT_NEAR(curve_at(bend, at(load_Nm)), 0.0, 1e-15) << load_Nm;
  }
}

TEST(Curve, OfUnevenPlacesOnALineIsThatLine) {
  Random random;
  for (int trial = 0; trial < 20; ++trial) {
    FrictionBend<double> bend = uneven(random);
    for (std::size_t k = 0; k < 7; ++k) bend.s[k] = 0.3 - 0.4 * bend.x[k];
    for (const double x : {-1.5, -1.2, -0.7, 0.1, 0.9, 1.0, 1.3, 1.5}) {
      EXPECT_NEAR(curve_at(bend, x), 0.3 - 0.4 * x, 1e-12) << x;
    }
    EXPECT_NEAR(curve_at(bend, 4.0), -0.3, 1e-12);
  }
}

TEST(Curve, OfUnevenPlacesHasTheDerivativesOfItsValues) {
  Random random;
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 100; ++trial) {
    const FrictionBend<double> bend = uneven(random);
    const double x = random.between(-1.4, 1.4);
    FrictionBend<Jet1> jets{.places = bend.places};
    jets.x = bend.x;
    for (int k = 0; k < bend.places; ++k) {
      jets.s[static_cast<std::size_t>(k)] = Jet1(bend.s[static_cast<std::size_t>(k)], k);
    }
    const Jet1 s = curve_at<Jet1>(jets, Jet1(x));
    EXPECT_NEAR(s.a, curve_at(bend, x), 1e-12);
    for (int k = 0; k < bend.places; ++k) {
      FrictionBend<double> above = bend, below = bend;
      above.s[static_cast<std::size_t>(k)] += kStep;
      below.s[static_cast<std::size_t>(k)] -= kStep;
      const double slope = (curve_at(above, x) - curve_at(below, x)) / (2.0 * kStep);
      EXPECT_NEAR(s.v[k], slope, 1e-6) << trial << ' ' << k;
    }
  }
}

TEST(Curve, OfValuesOnALineGoesOnBeyondThemForHalfTheRange) {
  FrictionBend<double> bend{.places = 5};
  for (int k = 0; k < 5; ++k) bend.s[static_cast<std::size_t>(k)] = 0.4 * (0.5 * k - 1.0);
  for (const double x : {-1.5, -1.2, -0.7, 0.1, 1.0, 1.3, 1.5}) {
    EXPECT_NEAR(curve_at(bend, x), 0.4 * x, 1e-14) << x;
  }
  EXPECT_NEAR(curve_at(bend, -4.0), -0.6, 1e-14);
  EXPECT_NEAR(curve_at(bend, 4.0), 0.6, 1e-14);
}

}  // namespace
}  // namespace gear3k::efficiency::friction_law_test
