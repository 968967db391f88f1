#include "efficiency/mesh_loss_slopes.hpp"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <optional>

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

/// Abscissae and weights on [0, 1].
struct HalfRule {
  static constexpr std::size_t kHalf = 6;
  std::array<double, kHalf> offset{}, weight{};  ///< at ½ ± offset
};
HalfRule half_rule() {
  using Rule = boost::math::quadrature::gauss<double, 2 * HalfRule::kHalf>;
  HalfRule rule;
  for (std::size_t i = 0; i < HalfRule::kHalf; ++i) {
    rule.offset[i] = 0.5 * Rule::abscissa()[i];
    rule.weight[i] = 0.5 * Rule::weights()[i];
  }
  return rule;
}

/// A piece of the path, in base pitches from the pitch point, on which no pair changes sides: the
/// k-th pair in contact is k base pitches ahead.
struct PathPiece {
  double start, end;
  int pairs;
};

/// Integral of the loss (M_d − M_f)/M_d over a piece and its slopes, added to those of `sum`:
///
///   M_d       = n − μ_a A + μ_r R,   A = Σ_a (tan α_w + s_k 2π/z_d),  R likewise in recess
///   M_d − M_f = (2π/z_d + 2π/z_f) (μ_r Σ_r s_k − μ_a Σ_a s_k),        s_k = s + k
///
/// @returns false where a pair jams at an end of the piece
bool add_loss(const MeshContact<double>& c, double approach, double recess, const PathPiece& piece,
              PathSlopes& sum) {
  static const HalfRule rule = half_rule();
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double z1 = c.z1;
  const double z2 = c.sign * c.z2;
  const double driving = kTurn / (c.gear1_drives ? z1 : z2);
  const double driven = kTurn / (c.gear1_drives ? z2 : z1);
  const double middle = 0.5 * (piece.start + piece.end);
  std::array<double, 2> count{};  // pairs in approach, in recess
  std::array<double, 2> ahead{};  // sum of k
  for (int k = 0; k < piece.pairs; ++k) {
    const bool in_approach = middle + k < 0.0;
    const double friction = in_approach ? approach : -recess;
    for (const double s : {piece.start + k, piece.end + k}) {
      const bool runs = 1.0 - friction * (c.tan_alpha_w + s * driving) > 0.0 &&
                        1.0 - friction * (c.tan_alpha_w - s * driven) > 0.0;
      if (!runs) return false;
    }
    const std::size_t side = in_approach ? 0 : 1;
    count[side] += 1.0;
    ahead[side] += k;
  }
  const double length = piece.end - piece.start;
  for (std::size_t i = 0; i < HalfRule::kHalf; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      const double s = middle + sign * rule.offset[i] * length;
      const double s_a = count[0] * s + ahead[0];
      const double s_r = count[1] * s + ahead[1];
      const double arm_a = count[0] * c.tan_alpha_w + s_a * driving;
      const double arm_r = count[1] * c.tan_alpha_w + s_r * driving;
      const double torque = piece.pairs - approach * arm_a + recess * arm_r;
      const double share = length * rule.weight[i] * (driving + driven) / torque;
      const double lost = (recess * s_r - approach * s_a) / torque;
      sum.efficiency -= share * (recess * s_r - approach * s_a);
      sum.by_approach -= share * (lost * arm_a - s_a);
      sum.by_recess -= share * (s_r - lost * arm_r);
    }
  }
  return true;
}

/// The span split where a pair passes the pitch point.
bool add_span(const MeshContact<double>& c, double approach, double recess, const PathPiece& span,
              PathSlopes& sum) {
  for (int k = 0; k < span.pairs; ++k) {
    const double crossing = -static_cast<double>(k);
    if (!(span.start < crossing && crossing < span.end)) continue;
    return add_loss(c, approach, recess,
                    {.start = span.start, .end = crossing, .pairs = span.pairs}, sum) &&
           add_loss(c, approach, recess, {.start = crossing, .end = span.end, .pairs = span.pairs},
                    sum);
  }
  return add_loss(c, approach, recess, span, sum);
}

PathSlopes path_slopes(const MeshContact<double>& c, double approach, double recess) {
  const double epsilon = c.approach_contact_ratio + c.recess_contact_ratio;
  if (!(epsilon >= 1.0)) return slopes_by_scalar(c, approach, recess);
  // As in coulomb_path_efficiency(): over a share f of the pitch there are pairs + 1 in contact.
  const int pairs = static_cast<int>(std::floor(epsilon));
  const double f = epsilon - pairs;
  const double first = -c.approach_contact_ratio;
  PathSlopes sum;
  const bool runs =
      add_span(c, approach, recess, {.start = first, .end = first + f, .pairs = pairs + 1}, sum) &&
      add_span(c, approach, recess, {.start = first + f, .end = first + 1.0, .pairs = pairs}, sum);
  return runs ? sum : slopes_by_scalar(c, approach, recess);
}

}  // namespace

MeshEfficiencySlopes mesh_efficiency_slopes(const MeshContact<double>& contact,
                                            const FlankFriction<double>& mu, LossModel model,
                                            bool by_sides) {
  const bool along_path = model == LossModel::kCoulombPath || model == LossModel::kDirectional;
  const bool alike = mu.approach_factor == 1.0 && mu.recess_factor == 1.0;
  MeshEfficiencySlopes result;
  if (along_path || !alike || by_sides) {
    const PathSlopes path = path_slopes(contact, mu.coefficient * mu.approach_factor,
                                        mu.coefficient * mu.recess_factor);
    result = {
        .efficiency = path.efficiency,
        .by_coefficient = path.by_approach * mu.approach_factor + path.by_recess * mu.recess_factor,
        .by_approach_factor = path.by_approach * mu.coefficient,
        .by_recess_factor = path.by_recess * mu.coefficient};
    if (along_path) return result;
    // What the sides make different, beside the model of first order.
    const PathSlopes plain = alike ? path : path_slopes(contact, mu.coefficient, mu.coefficient);
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
