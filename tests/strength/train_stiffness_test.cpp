#include "strength/train_stiffness.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "strength/mesh_stiffness.hpp"
#include "tests/backlash/toleranced_train.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::strength::train_stiffness_test {
namespace {

/// The train as a network of springs, from the motion of its bodies alone.
///
/// Unknowns: angles of the input, the sun's teeth, the carrier, R2's teeth and the output; for each
/// planet the angles of P1 and P2, and the radial and tangential displacement of its axis in the
/// planes of the bearings, against the carrier.  What is rigid
/// is an equation.
class Network {
  // Long numbers: with the sun loaded, some of its springs are i² times softer than others.
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

 public:
  Network(const train::TrainGeometry<double>& g, const TrainSprings<double>& springs)
      : unknowns_(5 + 6 * g.planets), stiffness_(Matrix::Zero(unknowns_, unknowns_)) {
    const double rb_S = g.gears[train::kS].base_radius_m;
    const double rb_P1 = g.gears[train::kP1].base_radius_m;
    const double rb_R1 = g.gears[train::kR1].base_radius_m;
    const double rb_P2 = g.gears[train::kP2].base_radius_m;
    const double rb_R2 = g.gears[train::kR2].base_radius_m;
    const double positive = train::g2(g.teeth) < 1.0 ? 1.0 : -1.0;
    for (int p = 0; p < g.planets; ++p) {
      const int at = 5 + 6 * p;
      const int angle1 = at, angle2 = at + 1;
      // Displacement of the planet's axis in a plane, from those in the planes of the bearings.
      std::array<std::array<long double, 2>, 2> share{{{0.0L, 0.0L}, {0.0L, 0.0L}}};
      if (springs.bearings) {
        const PlanetAxis<double>& axis = springs.bearings->axis;
        const long double span = static_cast<long double>(axis.support_b_m) - axis.support_a_m;
        share[0] = {(axis.support_b_m - axis.plane1_m) / span,
                    (axis.plane1_m - axis.support_a_m) / span};
        share[1] = {(axis.support_b_m - axis.plane2_m) / span,
                    (axis.plane2_m - axis.support_a_m) / span};
      }
      // Approach of the flanks along each line of action, positive when they are pressed together:
      // the arcs of the base circles and the displacement of the axis along the line.  tangential
      // is the sense of the force on the planet.
      const auto mesh = [&](std::size_t k, double tangential, double central_radius, int central,
                            double planet_radius, int planet_angle) {
        Vector u = Vector::Zero(unknowns_);
        const long double c = std::cos(static_cast<long double>(g.meshes[k].alpha_w_rad));
        const long double s = std::sin(static_cast<long double>(g.meshes[k].alpha_w_rad));
        const double outwards = k == train::kMeshSP1 ? 1.0 : -1.0;
        const long double plane_radial = outwards * s, plane_tangential = tangential * c;
        // The central gear's tooth moves along the force by its radius times its turn against the
        // carrier; the planet's by its radius times its turn against the carrier.
        if (central >= 0) u(central) += tangential * central_radius;
        u(kCarrier) -= tangential * central_radius;
        // An external planet turns against the sun, and with a ring.
        const double with = k == train::kMeshSP1 ? -1.0 : 1.0;
        u(planet_angle) -= tangential * with * planet_radius;
        const auto& w = share[k == train::kMeshP2R2 ? 1 : 0];
        for (int b = 0; b < 2; ++b) {
          u(at + 2 + 2 * b) -= plane_radial * w[static_cast<std::size_t>(b)];
          u(at + 3 + 2 * b) -= plane_tangential * w[static_cast<std::size_t>(b)];
        }
        add(u, springs.mesh_N_m[k]);
      };
      // Torque on R2 from outside along its turn: its teeth press the planet along it.
      mesh(train::kMeshSP1, -positive, rb_S, kSun, rb_P1, angle1);
      mesh(train::kMeshP1R1, -1.0, rb_R1, -1, rb_P1, angle1);
      mesh(train::kMeshP2R2, 1.0, rb_R2, kRing2, rb_P2, angle2);
      connect(angle1, angle2, springs.planet_torsion_Nm_rad);
      for (int b = 0; b < 2; ++b) {
        for (int axis = 0; axis < 2; ++axis) {
          Vector u = Vector::Zero(unknowns_);
          u(at + 2 + 2 * b + axis) = 1.0;
          long double compliance = 0.0L;
          if (springs.bearings) {
            if (const auto& k = springs.bearings->stiffness_N_m[static_cast<std::size_t>(b)]) {
              compliance += 1.0L / *k;
            }
            if (const auto& k = springs.bearings->pin_stiffness_N_m) compliance += 1.0L / *k;
          }
          if (compliance > 0.0L) {
            add(u, 1.0L / compliance);
          } else {
            rigid_.push_back(u);
          }
        }
      }
    }
    connect(kInput, kSun, springs.sun_shaft_Nm_rad);
    connect(kRing2, kOutput, springs.ring2_Nm_rad);
  }

  static constexpr int kInput = 0, kSun = 1, kCarrier = 2, kRing2 = 3, kOutput = 4;

  /// Torque over angle at one end with the other locked.
  [[nodiscard]] double stiffness(int loaded, int locked) const {
    // Constraints as equations with multipliers.
    const auto constraints = static_cast<Eigen::Index>(rigid_.size()) + 1;
    const Eigen::Index size = unknowns_ + constraints;
    Matrix a = Matrix::Zero(size, size);
    // Rows of angles and of displacements differ by orders of magnitude; so do their scales.
    const long double scale = stiffness_.diagonal().maxCoeff();
    a.topLeftCorner(unknowns_, unknowns_) = (stiffness_ / scale);
    for (Eigen::Index i = 0; i + 1 < constraints; ++i) {
      a.row(unknowns_ + i).head(unknowns_) = rigid_[static_cast<std::size_t>(i)].transpose();
      a.col(unknowns_ + i).head(unknowns_) = rigid_[static_cast<std::size_t>(i)];
    }
    a(size - 1, locked) = a(locked, size - 1) = 1.0L;
    Vector torque = Vector::Zero(size);
    torque(loaded) = 1.0L / scale;
    const Vector x = Eigen::PartialPivLU<Matrix>(a).solve(torque);
    return static_cast<double>(1.0L / x(loaded));
  }

 private:
  void add(const Vector& u, long double k) { stiffness_ += k * u * u.transpose(); }
  void connect(int first, int second, const std::optional<double>& k) {
    Vector u = Vector::Zero(unknowns_);
    u(first) = 1.0;
    u(second) = -1.0;
    if (k) {
      add(u, *k);
    } else {
      rigid_.push_back(u);
    }
  }

  int unknowns_;
  Matrix stiffness_;
  std::vector<Vector> rigid_;
};

TrainSprings<double> random_springs(RandomTrain& random) {
  const auto some = [&](double low, double high) -> std::optional<double> {
    if (random.count(0, 2) == 0) return std::nullopt;
    return random.between(low, high);
  };
  TrainSprings<double> springs;
  for (double& k : springs.mesh_N_m) k = random.between(2e7, 3e8);
  springs.planet_torsion_Nm_rad = some(200.0, 5000.0);
  springs.sun_shaft_Nm_rad = some(50.0, 500.0);
  springs.ring2_Nm_rad = some(1e4, 1e5);
  if (random.count(0, 3) > 0) {
    springs.bearings = PlanetBearings<double>{.axis = {.plane1_m = random.between(-5e-3, 5e-3),
                                                       .plane2_m = random.between(8e-3, 20e-3),
                                                       .support_a_m = random.between(-15e-3, 4e-3),
                                                       .support_b_m = random.between(9e-3, 30e-3)},
                                              .stiffness_N_m = {some(1e7, 1e8), some(1e7, 1e8)},
                                              .pin_stiffness_N_m = some(2e7, 2e8)};
  }
  return springs;
}

TEST(TrainStiffness, IsThatOfAnAssembledNetworkOfSprings) {
  RandomTrain random(61);
  LargestDeviation output, input, ratio;
  for (int n = 0; n < 1000; ++n) {
    auto g = random.train(n % 2 == 0);
    g.planets = random.count(1, 5);
    const TrainSprings<double> springs = random_springs(random);
    const auto k = train_stiffness(g, springs);
    const Network network(g, springs);
    output.see(n, network.stiffness(Network::kOutput, Network::kInput) - k.output_Nm_rad,
               1e-9 * k.output_Nm_rad);
    input.see(n, network.stiffness(Network::kInput, Network::kOutput) - k.input_Nm_rad,
              1e-9 * k.input_Nm_rad);
    const double i = train::ratio(g.teeth);
    ratio.see(n, k.input_Nm_rad * i * i - k.output_Nm_rad, 1e-14 * k.output_Nm_rad);
  }
  output.expect_allowed("output");
  input.expect_allowed("input");
  ratio.expect_allowed("input_from_output");
}

TEST(TrainStiffness, CompliancesAddUp) {
  RandomTrain random(62);
  const auto g = random.train(true);
  const auto k = train_stiffness(g, random_springs(random));
  const auto& c = k.compliance;
  const double sum =
      c.mesh[0] + c.mesh[1] + c.mesh[2] + c.planet_torsion + c.bearings + c.sun_shaft + c.ring2;
  EXPECT_NEAR(sum * k.output_Nm_rad, 1.0, 1e-14);
}

TEST(TrainStiffness, DerivativesAreThoseOfDifferences) {
  RandomTrain random(63);
  for (int n = 0; n < 40; ++n) {
    const train::ToothSet z = random.teeth(n % 2 == 0);
    const auto stiffness = [&](const auto& x) {
      using T = std::decay_t<decltype(x[0])>;
      train::TrainParameters<T> p{};
      p.teeth = z;
      p.planets = 3;
      p.pressure_angle_rad = x[3];
      p.module_m = {x[0], x[1]};
      p.center_distance_m = x[2];
      const auto g = train::make_train_geometry(p);
      TrainSprings<T> springs;
      springs.mesh_N_m = {1e8 * x[4], 2e8 * x[4], 1.5e8 * x[4]};
      springs.planet_torsion_Nm_rad = 900.0 * x[5];
      springs.sun_shaft_Nm_rad = 200.0 * x[5];
      springs.ring2_Nm_rad = 3e4 * x[5];
      springs.bearings = PlanetBearings<T>{.axis = {.plane1_m = constant<T>(0.0),
                                                    .plane2_m = 9e-3 * x[6],
                                                    .support_a_m = constant<T>(-4e-3),
                                                    .support_b_m = constant<T>(14e-3),
                                                    .mass_center_m = constant<T>(0.0)},
                                           .stiffness_N_m = {{T(3e7 * x[6]), T(4e7 * x[6])}},
                                           .pin_stiffness_N_m = T(9e7 * x[7])};
      return train_stiffness(*g, springs).output_Nm_rad;
    };
    const double m1 = 0.7e-3, m2 = m1 * (z.R1 - z.P1) / (z.R2 - z.P2);
    const std::array<double, 8> at{m1,  m2, 0.5 * m1 * (z.R1 - z.P1) * 1.03, 0.35, 1.0, 1.0,
                                   1.0, 1.0};
    std::array<Jet1, 8> jets;
    for (std::size_t i = 0; i < 8; ++i) jets[i] = Jet1(at[i], static_cast<int>(i));
    const Jet1 exact = stiffness(jets);
    for (std::size_t i = 0; i < 8; ++i) {
      const auto difference = [&](double h) {
        std::array<double, 8> up = at, down = at;
        up[i] *= 1.0 + h;
        down[i] *= 1.0 - h;
        return (stiffness(up) - stiffness(down)) / (2.0 * h);
      };
      const double expected = (4.0 * difference(2e-4) - difference(4e-4)) / 3.0;
      EXPECT_NEAR(exact.v[static_cast<int>(i)] * at[i], expected, 1e-6 * exact.a) << n << ' ' << i;
    }
  }
}

/// K_out of the bilateral drive gear in steel with the analytic stiffness of its meshes.
template <class T>
T loaded_stiffness(const std::array<T, 8>& x) {
  const train::TrainParameters<double> drawn = backlash::thinned_bilateral_drive_gear();
  train::TrainParameters<T> p{};
  p.teeth = drawn.teeth;
  p.planets = drawn.planets;
  p.pressure_angle_rad = constant<T>(drawn.pressure_angle_rad);
  p.profile_shift = {x[0], x[1], x[2], x[3], x[4]};
  p.module_m = {x[5], x[6]};
  p.center_distance_m = x[7];
  for (T& q : p.machining_allowance) q = constant<T>(0.05);
  const auto g = train::make_train_geometry(p);
  constexpr double kFaceWidth = 8e-3;
  constexpr Elasticity kSteel{.youngs_modulus_Pa = 206e9, .poissons_ratio = 0.3};
  const auto forces = lossless_mesh_forces(*g, constant<T>(20.0));
  TrainSprings<T> springs;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto& gear1 = g->gears[static_cast<std::size_t>(train::kMeshGears[k][0])];
    const auto& gear2 = g->gears[static_cast<std::size_t>(train::kMeshGears[k][1])];
    springs.mesh_N_m[k] = kFaceWidth * mean_mesh_stiffness(make_elastic_mesh(
                                           gear1, geometry::make_tooth_form(gear1), gear2,
                                           geometry::make_tooth_form(gear2), g->meshes[k], kSteel,
                                           kSteel, T(forces.normal_N[k] * (1.0 / kFaceWidth))));
  }
  return train_stiffness(*g, springs).output_Nm_rad;
}

TEST(TrainStiffness, GradientThroughTheMeshesIsThatOfDifferences) {
  const train::TrainParameters<double> p = backlash::thinned_bilateral_drive_gear();
  const std::array<double, 8> at{p.profile_shift[0], p.profile_shift[1], p.profile_shift[2],
                                 p.profile_shift[3], p.profile_shift[4], p.module_m[0],
                                 p.module_m[1],      p.center_distance_m};
  std::array<Jet1, 8> jets;
  for (std::size_t i = 0; i < 8; ++i) jets[i] = Jet1(at[i], static_cast<int>(i));
  const Jet1 exact = loaded_stiffness(jets);
  EXPECT_NEAR(exact.a, loaded_stiffness(at), 1e-12 * exact.a);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto difference = [&](double h) {
      std::array<double, 8> up = at, down = at;
      up[i] *= 1.0 + h;
      down[i] *= 1.0 - h;
      return (loaded_stiffness(up) - loaded_stiffness(down)) / (2.0 * h);
    };
    const double expected = (4.0 * difference(1e-4) - difference(2e-4)) / 3.0;
    EXPECT_NEAR(exact.v[static_cast<int>(i)] * at[i], expected, 1e-6 * exact.a) << i;
  }
}

TEST(TrainStiffness, NamesBadInput) {
  RandomTrain random(64);
  const auto g = random.train(true);
  TrainSprings<double> springs = random_springs(random);
  springs.mesh_N_m[1] = 0.0;
  EXPECT_THROW(train_stiffness(g, springs), std::invalid_argument);
  springs.mesh_N_m[1] = 1e8;
  springs.bearings = PlanetBearings<double>{.axis = {.support_a_m = 1e-3, .support_b_m = 1e-3}};
  EXPECT_THROW(train_stiffness(g, springs), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::train_stiffness_test
