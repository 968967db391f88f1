#pragma once
// A train as a network of springs, by the motion of its bodies: a witness.

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "strength/train_stiffness.hpp"
#include "tests/linear_solve.hpp"
#include "tests/random_train.hpp"

namespace gear3k::strength {

/// The train as a network of springs, from the motion of its bodies alone.
///
/// Unknowns: angles of the input, the sun's teeth, the carrier, R2's teeth and the output; for each
/// planet the angles of P1 and P2, and the radial and tangential displacement of its axis in the
/// planes of the bearings, against the carrier.  What is rigid
/// is an equation.
class SpringNetwork {
  // Long numbers: with the sun loaded, some of its springs are i² times softer than others.
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

 public:
  using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

  SpringNetwork(const train::TrainGeometry<double>& g, const TrainSprings<double>& springs)
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

  /// Angle of P1, 1: of P2, of a planet.
  static int planet_angle(int planet, int step) { return 5 + 6 * planet + step; }
  [[nodiscard]] int unknowns() const { return unknowns_; }

  static constexpr int kInput = 0, kSun = 1, kCarrier = 2, kRing2 = 3, kOutput = 4;

  /// Torque over angle at one end with the other locked.
  [[nodiscard]] double stiffness(int loaded, int locked) const {
    Vector torque = Vector::Zero(unknowns_);
    torque(loaded) = 1.0L;
    return static_cast<double>(1.0L / displacements(torque, locked)(loaded));
  }

  /// Angles of the bodies with one end locked.
  [[nodiscard]] Vector displacements(const Vector& torque_Nm, int locked) const {
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
    Vector load = Vector::Zero(size);
    load.head(unknowns_) = torque_Nm / scale;
    return test::solved(a, load);
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

inline TrainSprings<double> random_springs(RandomTrain& random) {
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

}  // namespace gear3k::strength
