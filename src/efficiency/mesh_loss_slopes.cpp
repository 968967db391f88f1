#include "efficiency/mesh_loss_slopes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gear3k::efficiency {

namespace {

/// Efficiency by the friction in approach, μ_a, and in recess, μ_r.
struct PathSlopes {
  double efficiency = 1.0, by_approach = 0.0, by_recess = 0.0;
};

/// coulomb_path_efficiency() with derivatives as its own scalar takes them.
PathSlopes slopes_by_scalar(const MeshContact<double>& c, double approach, double recess) {
  const MeshContact<Jet1> contact{.z1 = c.z1,
                                  .z2 = c.z2,
                                  .sign = c.sign,
                                  .approach_contact_ratio = Jet1(c.approach_contact_ratio),
                                  .recess_contact_ratio = Jet1(c.recess_contact_ratio),
                                  .tan_alpha_w = Jet1(c.tan_alpha_w),
                                  .gear1_drives = c.gear1_drives};
  const Jet1 eta = coulomb_path_efficiency<Jet1>(contact, {.coefficient = Jet1(1.0),
                                                           .approach_factor = Jet1(approach, 0),
                                                           .recess_factor = Jet1(recess, 1)});
  return {.efficiency = eta.a, .by_approach = eta.v[0], .by_recess = eta.v[1]};
}

/// Of fixed geometry, with the friction of both sides.
struct PathFriction {
  const MeshContact<double>& contact;
  double approach, recess;                     ///< μ_a, μ_r
  double driving_pitch_rad, driven_pitch_rad;  ///< 2π/z_d, 2π/z_f, of a ring negative
};
PathFriction path_friction(const MeshContact<double>& c, double approach, double recess) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double pitch1 = kTurn / c.z1;
  const double pitch2 = kTurn / (c.sign * c.z2);
  return {.contact = c,
          .approach = approach,
          .recess = recess,
          .driving_pitch_rad = c.gear1_drives ? pitch1 : pitch2,
          .driven_pitch_rad = c.gear1_drives ? pitch2 : pitch1};
}

/// A piece of the path, in base pitches from the pitch point, on which no pair changes sides: the
/// k-th pair in contact is k base pitches ahead.
struct PathPiece {
  double start, end;
  int pairs;
};

/// Of 1 + x t on t = −½ .. ½, with y = x²/4 below 1:
///
///   ∫ dt/(1 + x t)    = 1 + y S          ∫ dt/(1 + x t)²    = G
///   ∫ t dt/(1 + x t)  = −x/4 S           ∫ t dt/(1 + x t)²  = −x/4 (G − S)
///                                        ∫ t² dt/(1 + x t)² = (G − 2 S)/4
///
///   S = Σ y^j/(2j + 3) = (artanh(√y)/√y − 1)/y,   G = Σ y^j = 1/(1 − y)
struct LinearDivisor {
  double s, g;
};
LinearDivisor linear_divisor(double y) {
  const double g = 1.0 / (1.0 - y);
  // Terms of the series up to the one that is below 1e-17; the closed form cancels where y is
  // small.
  if (y < 1e-4) return {.s = 1.0 / 3 + y * (1.0 / 5 + y * (1.0 / 7 + y / 9)), .g = g};
  if (y > 0.01) {
    const double root = std::sqrt(y);
    return {.s = (std::atanh(root) / root - 1.0) / y, .g = g};
  }
  double s = 1.0 / 17;
  for (const double over : {15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0}) s = s * y + 1.0 / over;
  return {.s = s, .g = g};
}

/// Whether every pair runs at both ends of the piece: no torque of a flank has changed its sign.
bool all_run(const PathFriction& path, const PathPiece& piece) {
  const double tan_alpha_w = path.contact.tan_alpha_w;
  const double most = std::max(path.approach, path.recess);
  const double farthest =
      std::max(std::abs(piece.start), std::abs(piece.end + (piece.pairs - 1.0)));
  const double pitch = std::max(std::abs(path.driving_pitch_rad), std::abs(path.driven_pitch_rad));
  if (most * (std::abs(tan_alpha_w) + farthest * pitch) < kJammingFriction) return true;
  const double middle = 0.5 * (piece.start + piece.end);
  for (int k = 0; k < piece.pairs; ++k) {
    const double friction = middle + k < 0.0 ? path.approach : -path.recess;
    for (const double s : {piece.start + k, piece.end + k}) {
      const bool runs = friction * (tan_alpha_w + s * path.driving_pitch_rad) < kJammingFriction &&
                        friction * (tan_alpha_w - s * path.driven_pitch_rad) < kJammingFriction;
      if (!runs) return false;
    }
  }
  return true;
}

/// Integral of the loss (M_d − M_f)/M_d over a piece, added to that of `sum`, and where wanted its
/// slopes. M_d and M_d − M_f are linear in s, and so are their slopes by the friction:
///
///   M_d       = n − μ_a A + μ_r R,   A = Σ_a (tan α_w + s_k 2π/z_d),  R likewise in recess
///   M_d − M_f = (2π/z_d + 2π/z_f) (μ_r Σ_r s_k − μ_a Σ_a s_k),        s_k = s + k
///
/// @returns false where a pair jams at an end of the piece
template <bool kSlopes>
bool add_loss(const PathFriction& path, const PathPiece& piece, PathSlopes& sum) {
  const double tan_alpha_w = path.contact.tan_alpha_w;
  const double approach = path.approach;
  const double recess = path.recess;
  const double driving = path.driving_pitch_rad;
  const double driven = path.driven_pitch_rad;
  if (!all_run(path, piece)) return false;
  const double middle = 0.5 * (piece.start + piece.end);
  // Pairs in approach, in recess, and the sums of their k.
  const double in_approach = std::clamp(std::ceil(-middle), 0.0, static_cast<double>(piece.pairs));
  const std::array<double, 2> count{in_approach, piece.pairs - in_approach};
  const std::array<double, 2> ahead{
      0.5 * in_approach * (in_approach - 1.0),
      0.5 * (piece.pairs * (piece.pairs - 1.0) - in_approach * (in_approach - 1.0))};
  // Values at the middle, and changes over the length.
  const double length = piece.end - piece.start;
  const std::array<double, 2> s_at{count[0] * middle + ahead[0], count[1] * middle + ahead[1]};
  const std::array<double, 2> s_by{count[0] * length, count[1] * length};
  const std::array<double, 2> arm{count[0] * tan_alpha_w + s_at[0] * driving,
                                  count[1] * tan_alpha_w + s_at[1] * driving};
  const double torque = piece.pairs - approach * arm[0] + recess * arm[1];
  const double lost = recess * s_at[1] - approach * s_at[0];
  const double lost_by = recess * s_by[1] - approach * s_by[0];
  const double x = driving * lost_by / torque;
  const LinearDivisor d = linear_divisor(0.25 * x * x);
  const double first = 1.0 + 0.25 * x * x * d.s;  // ∫ dt/(1 + x t)
  const double first_t = -0.25 * x * d.s;
  const double share = length * (driving + driven) / torque;
  sum.efficiency -= share * (lost * first + lost_by * first_t);
  if constexpr (kSlopes) {
    const double second_t = -0.25 * x * (d.g - d.s);  // ∫ t dt/(1 + x t)²
    const double second_tt = 0.25 * (d.g - 2.0 * d.s);
    const auto slope = [&](std::size_t side) {
      const double arm_by = s_by[side] * driving;
      return (lost * arm[side] * d.g + (lost * arm_by + lost_by * arm[side]) * second_t +
              lost_by * arm_by * second_tt) /
                 torque -
             (s_at[side] * first + s_by[side] * first_t);
    };
    sum.by_approach -= share * slope(0);
    sum.by_recess += share * slope(1);
  }
  return true;
}

/// The span split where a pair passes the pitch point.
template <bool kSlopes>
bool add_span(const PathFriction& path, const PathPiece& span, PathSlopes& sum) {
  for (int k = 0; k < span.pairs; ++k) {
    const double crossing = -static_cast<double>(k);
    if (!(span.start < crossing && crossing < span.end)) continue;
    return add_loss<kSlopes>(path, {.start = span.start, .end = crossing, .pairs = span.pairs},
                             sum) &&
           add_loss<kSlopes>(path, {.start = crossing, .end = span.end, .pairs = span.pairs}, sum);
  }
  return add_loss<kSlopes>(path, span, sum);
}

template <bool kSlopes>
PathSlopes path_slopes(const MeshContact<double>& c, double approach, double recess) {
  const double epsilon = c.approach_contact_ratio + c.recess_contact_ratio;
  if (!(epsilon >= 1.0)) return slopes_by_scalar(c, approach, recess);
  // As in coulomb_path_efficiency(): over a share f of the pitch there are pairs + 1 in contact.
  const int pairs = static_cast<int>(std::floor(epsilon));
  const double f = epsilon - pairs;
  const double first = -c.approach_contact_ratio;
  const PathFriction path = path_friction(c, approach, recess);
  PathSlopes sum;
  const bool runs =
      add_span<kSlopes>(path, {.start = first, .end = first + f, .pairs = pairs + 1}, sum) &&
      add_span<kSlopes>(path, {.start = first + f, .end = first + 1.0, .pairs = pairs}, sum);
  return runs ? sum : slopes_by_scalar(c, approach, recess);
}

}  // namespace

MeshEfficiencySlopes mesh_efficiency_slopes(const MeshContact<double>& contact,
                                            const FlankFriction<double>& mu, LossModel model,
                                            LossSlopes wanted) {
  const bool along_path = model == LossModel::kCoulombPath || model == LossModel::kDirectional;
  const bool alike = mu.approach_factor == 1.0 && mu.recess_factor == 1.0;
  const auto path_of = [&](double approach, double recess) {
    return wanted == LossSlopes::kNone ? path_slopes<false>(contact, approach, recess)
                                       : path_slopes<true>(contact, approach, recess);
  };
  MeshEfficiencySlopes result;
  if (along_path || !alike || wanted == LossSlopes::kByAll) {
    const PathSlopes path =
        path_of(mu.coefficient * mu.approach_factor, mu.coefficient * mu.recess_factor);
    result = {
        .efficiency = path.efficiency,
        .by_coefficient = path.by_approach * mu.approach_factor + path.by_recess * mu.recess_factor,
        .by_approach_factor = path.by_approach * mu.coefficient,
        .by_recess_factor = path.by_recess * mu.coefficient};
    if (along_path) return result;
    // What the sides make different, beside the model of first order.
    const PathSlopes plain = alike ? path : path_of(mu.coefficient, mu.coefficient);
    result.efficiency = 1.0 + (path.efficiency - plain.efficiency);
    result.by_coefficient -= plain.by_approach + plain.by_recess;
  }
  const double factor =
      model == LossModel::kOhlendorf
          ? ohlendorf_factor(contact.approach_contact_ratio, contact.recess_contact_ratio)
          : sliding_factor(contact.approach_contact_ratio, contact.recess_contact_ratio);
  const double slope = -std::numbers::pi * (1.0 / contact.z1 + contact.sign / contact.z2) * factor;
  result.efficiency += slope * mu.coefficient;
  result.by_coefficient += slope;
  return result;
}

}  // namespace gear3k::efficiency
