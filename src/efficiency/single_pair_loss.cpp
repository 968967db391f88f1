#include "efficiency/single_pair_loss.hpp"

#include <fmt/format.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace gear3k::efficiency {

namespace {

void require_geometry(const SinglePair& p) {
  const auto require = [](bool holds, const char* name, double value, const char* allowed) {
    if (!holds) {
      throw std::invalid_argument(fmt::format("{} = {}: allowed: {}", name, value, allowed));
    }
  };
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  require(positive(p.pitch_radius1_m), "pitch_radius1_m", p.pitch_radius1_m, "> 0");
  require(positive(p.pitch_radius2_m), "pitch_radius2_m", p.pitch_radius2_m, "> 0");
  require(p.tip_radius1_m > p.pitch_radius1_m && std::isfinite(p.tip_radius1_m), "tip_radius1_m",
          p.tip_radius1_m, "above the pitch radius");
  require(p.tip_radius2_m > p.pitch_radius2_m && std::isfinite(p.tip_radius2_m), "tip_radius2_m",
          p.tip_radius2_m, "above the pitch radius");
  require(p.pressure_angle_rad > 0.0 && p.pressure_angle_rad < 0.5 * std::numbers::pi,
          "pressure_angle_rad", p.pressure_angle_rad, "between 0 and pi/2");
}

void require_friction(const SinglePair& p) {
  if (!(p.friction >= 0.0 && p.friction * std::tan(p.pressure_angle_rad) < 1.0)) {
    throw std::invalid_argument(fmt::format("friction = {}: allowed: 0 <= friction < {:.6g}",
                                            p.friction, 1.0 / std::tan(p.pressure_angle_rad)));
  }
}

/// Pitch point to the contact of a tip, along the line of action.
double addendum_path(double tip_radius_m, double pitch_radius_m, double pressure_angle_rad) {
  const double base_radius_m = pitch_radius_m * std::cos(pressure_angle_rad);
  return std::sqrt((tip_radius_m - base_radius_m) * (tip_radius_m + base_radius_m)) -
         pitch_radius_m * std::sin(pressure_angle_rad);
}

/// λ; `side` is −1 in approach, +1 in recess.
double torque_loss(const SinglePair& p, double side, double a) {
  // Symbols as in the thesis.
  const double R1 = p.pitch_radius1_m;
  const double R2 = p.pitch_radius2_m;
  const double mu = p.friction;
  const double alpha = p.pressure_angle_rad;
  return mu * a * (R1 + R2) /
         (R2 * (mu * a + R1 * std::cos(alpha) + side * mu * R1 * std::sin(alpha)));
}

double checked_torque_loss(const SinglePair& pair, double side, double distance_m) {
  require_geometry(pair);
  require_friction(pair);
  if (!(distance_m >= 0.0)) {
    throw std::invalid_argument(fmt::format("distance_m = {}: allowed: >= 0", distance_m));
  }
  return torque_loss(pair, side, distance_m);
}

}  // namespace

SinglePair reversed(const SinglePair& pair) {
  return {.pitch_radius1_m = pair.pitch_radius2_m,
          .pitch_radius2_m = pair.pitch_radius1_m,
          .tip_radius1_m = pair.tip_radius2_m,
          .tip_radius2_m = pair.tip_radius1_m,
          .pressure_angle_rad = pair.pressure_angle_rad,
          .friction = pair.friction};
}

ContactPath contact_path(const SinglePair& pair) {
  require_geometry(pair);
  return {
      .approach_m =
          addendum_path(pair.tip_radius2_m, pair.pitch_radius2_m, pair.pressure_angle_rad),
      .recess_m = addendum_path(pair.tip_radius1_m, pair.pitch_radius1_m, pair.pressure_angle_rad)};
}

bool path_on_involutes(const SinglePair& pair) {
  const ContactPath path = contact_path(pair);
  const double sine = std::sin(pair.pressure_angle_rad);
  return path.approach_m <= pair.pitch_radius1_m * sine &&
         path.recess_m <= pair.pitch_radius2_m * sine;
}

double approach_torque_loss(const SinglePair& pair, double distance_m) {
  return checked_torque_loss(pair, -1.0, distance_m);
}

double recess_torque_loss(const SinglePair& pair, double distance_m) {
  return checked_torque_loss(pair, 1.0, distance_m);
}

double mean_torque_loss(const SinglePair& pair) {
  require_friction(pair);
  const ContactPath path = contact_path(pair);
  using Quadrature = boost::math::quadrature::gauss<double, 15>;
  const auto integral = [&](double side, double length_m) {
    return Quadrature::integrate([&](double a) { return torque_loss(pair, side, a); }, 0.0,
                                 length_m);
  };
  return (integral(-1.0, path.approach_m) + integral(1.0, path.recess_m)) /
         (path.approach_m + path.recess_m);
}

double symmetric_loss(const SinglePair& pair) {
  return 0.5 * (mean_torque_loss(pair) + mean_torque_loss(reversed(pair)));
}

double skew_loss(const SinglePair& pair) {
  return 0.5 * (mean_torque_loss(pair) - mean_torque_loss(reversed(pair)));
}

}  // namespace gear3k::efficiency
