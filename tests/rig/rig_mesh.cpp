#include "tests/rig/rig_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string>

namespace gear3k::rig {
namespace {

constexpr double kPi = std::numbers::pi;

double leg(double hypotenuse, double other) {
  return std::sqrt(std::max(0.0, hypotenuse * hypotenuse - other * other));
}

// A gear's tooth (or, of a ring, its space) at a radius, from that at the reference circle.
double thickness_at(double radius, double reference_radius, double reference_thickness,
                    double alpha, double base_radius) {
  const double alpha_r = std::acos(base_radius / radius);
  const double roll = (std::tan(alpha) - alpha) - (std::tan(alpha_r) - alpha_r);
  return radius * (reference_thickness / reference_radius + 2.0 * roll);
}

}  // namespace

RigMesh make_rig_mesh(const RigPair& pair) {
  RigMesh mesh{.teeth_a = pair.teeth_a, .teeth_b = pair.teeth_b};
  const double m = pair.module_m, alpha = pair.pressure_angle_rad;
  const double rba = 0.5 * m * pair.teeth_a * std::cos(alpha);
  const double rbb = 0.5 * m * pair.teeth_b * std::cos(alpha);
  const double sum = pair.internal ? rbb - rba : rba + rbb;
  if (!(sum > 0.0) || !(pair.center_distance_m > sum)) {
    throw std::invalid_argument("pair " + std::to_string(pair.teeth_a) + "/" +
                                std::to_string(pair.teeth_b) + " has no line of action");
  }
  mesh.base_radius_a_m = rba;
  mesh.base_radius_b_m = rbb;
  mesh.curvature_1_m = pair.internal ? 1.0 / rba - 1.0 / rbb : 1.0 / rba + 1.0 / rbb;
  mesh.working_angle_rad = std::acos(sum / pair.center_distance_m);
  const double slope = std::tan(mesh.working_angle_rad);
  const double tip_a = m * (0.5 * pair.teeth_a + pair.addendum + pair.shift_a);
  const double tip_b = m * (0.5 * pair.teeth_b + (pair.internal ? pair.shift_b - pair.addendum
                                                                : pair.shift_b + pair.addendum));
  mesh.tip_path_a_m = leg(tip_a, rba) - rba * slope;
  mesh.tip_path_b_m = pair.internal ? rbb * slope - leg(tip_b, rbb) : leg(tip_b, rbb) - rbb * slope;

  // Contacts lie at -B + u + k p on the line of action (a's tip side positive), u in [0, p). Cut
  // at the phases where a pair enters, leaves or passes the pitch point, all is linear in u, and
  // the midpoint of each piece gives its mean.
  const double pitch = 2.0 * kPi * rba / pair.teeth_a;
  const double length = mesh.tip_path_a_m + mesh.tip_path_b_m;
  if (!(length > 0.0)) throw std::invalid_argument("no path of contact");
  const auto phase = [&](double x) { return x - pitch * std::floor(x / pitch); };
  std::array<double, 4> cuts{0.0, phase(length), phase(mesh.tip_path_b_m), pitch};
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double width = cuts[i + 1] - cuts[i];
    if (width <= 0.0) continue;
    const double u = 0.5 * (cuts[i] + cuts[i + 1]);
    double side_a = 0.0, side_b = 0.0;
    int in_contact = 0;
    for (double path = u; path <= length; path += pitch) {
      const double x = path - mesh.tip_path_b_m;
      (x > 0.0 ? side_a : side_b) += std::fabs(x);
      ++in_contact;
    }
    if (in_contact == 0) continue;  // the teeth lose contact for a while: no loss meanwhile
    mesh.lever_a_m += width / pitch * side_a / in_contact;
    mesh.lever_b_m += width / pitch * side_b / in_contact;
  }
  return mesh;
}

std::array<RigPair, 3> pairs_of(const Gearbox& gearbox) {
  const auto pair = [&](std::size_t a, std::size_t b, double module_mm, bool internal) {
    return RigPair{.teeth_a = gearbox.teeth[a],
                   .teeth_b = gearbox.teeth[b],
                   .internal = internal,
                   .shift_a = gearbox.profile_shift[a],
                   .shift_b = gearbox.profile_shift[b],
                   .module_m = module_mm * 1e-3,
                   .pressure_angle_rad = gearbox.pressure_angle_deg * kPi / 180.0,
                   .center_distance_m = gearbox.center_distance_mm * 1e-3,
                   .addendum = gearbox.addendum};
  };
  return {pair(0, 1, gearbox.module1_mm, false), pair(1, 2, gearbox.module1_mm, true),
          pair(3, 4, gearbox.module2_mm, true)};
}

double mesh_loss(const RigMesh& mesh, bool a_drives, double approach_friction,
                 double recess_friction) {
  // Contact runs towards the driver's tip: there is the recess. A pair at distance x from the
  // pitch point slides at |x| times the relative rotation; per unit of power transmitted
  // (normal force x base radius x rotation of a) that is |x| (1/r_ba +- 1/r_bb).
  const double on_a = a_drives ? recess_friction : approach_friction;
  const double on_b = a_drives ? approach_friction : recess_friction;
  return (on_a * mesh.lever_a_m + on_b * mesh.lever_b_m) * mesh.curvature_1_m;
}

double normal_backlash_m(const RigPair& pair, double center_distance_m, double thinning_m) {
  const double m = pair.module_m, alpha = pair.pressure_angle_rad;
  const double ra = 0.5 * m * pair.teeth_a, rb = 0.5 * m * pair.teeth_b;
  const double teeth = pair.internal ? pair.teeth_b - pair.teeth_a : pair.teeth_a + pair.teeth_b;
  const double wa = center_distance_m * pair.teeth_a / teeth;
  const double wb = center_distance_m * pair.teeth_b / teeth;
  const auto thickness = [&](double shift) {
    return m * (0.5 * kPi + 2.0 * shift * std::tan(alpha));
  };
  const double pitch = 2.0 * kPi * wa / pair.teeth_a;
  const double tooth_a = thickness_at(wa, ra, thickness(pair.shift_a), alpha, ra * std::cos(alpha));
  const double body_b = thickness_at(wb, rb, thickness(pair.shift_b), alpha, rb * std::cos(alpha));
  const double tooth_b = pair.internal ? pitch - body_b : body_b;
  const double cos_aw = ra * std::cos(alpha) / wa;
  // The thinning is a distance between parallel involutes: it adds to the normal backlash.
  return (pitch - tooth_a - tooth_b) * cos_aw + thinning_m;
}

}  // namespace gear3k::rig
