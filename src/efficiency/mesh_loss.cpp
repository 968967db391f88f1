#include "efficiency/mesh_loss.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <type_traits>

#include "numerics/gauss_rule.hpp"

namespace gear3k::efficiency {

namespace {

/// ∫ |s| ds from a to b.
template <class T>
T absolute_integral(const T& a, const T& b) {
  const T half_b = value_of(b) < 0.0 ? T(-0.5 * b * b) : T(0.5 * b * b);
  const T half_a = value_of(a) < 0.0 ? T(-0.5 * a * a) : T(0.5 * a * a);
  return half_b - half_a;
}

}  // namespace

template <class T>
T ohlendorf_factor(const T& approach, const T& recess) {
  return 1.0 - approach - recess + approach * approach + recess * recess;
}

template <class T>
T sliding_factor(const T& approach, const T& recess) {
  const T epsilon = approach + recess;
  if (value_of(epsilon) <= 0.0) {
    return magnitude(T(recess - approach));  // twice the path's middle
  }
  // Over a share f of the pitch there are pairs + 1 in contact, over the rest there are `pairs`.
  const int pairs = static_cast<int>(std::floor(value_of(epsilon)));
  const T f = epsilon - static_cast<double>(pairs);
  T sum_more = constant<T>(0.0);
  for (int k = 0; k <= pairs; ++k) {
    const T start = static_cast<double>(k) - approach;
    sum_more = sum_more + absolute_integral<T>(start, start + f);
  }
  if (pairs == 0) return 2.0 * sum_more / f;
  T sum_fewer = constant<T>(0.0);
  for (int k = 0; k < pairs; ++k) {
    const T start = static_cast<double>(k) - approach;
    sum_fewer = sum_fewer + absolute_integral<T>(start + f, start + 1.0);
  }
  return 2.0 * (sum_more / (pairs + 1.0) + sum_fewer / (1.0 * pairs));
}

namespace {

/// Signed tooth numbers: of a ring negative.
struct SignedTeeth {
  double driving, driven;
};
template <class T>
SignedTeeth signed_teeth(const MeshContact<T>& c) {
  const double z1 = c.z1;
  const double z2 = c.sign * c.z2;
  return c.gear1_drives ? SignedTeeth{z1, z2} : SignedTeeth{z2, z1};
}

/// Torques on the driving and the driven gear over normal force and base radius.
template <class T>
struct FlankTorques {
  T driving, driven;
};

/// Of the pair at s base pitches from the pitch point, on its side of it.
template <class T>
FlankTorques<T> flank_torques(const MeshContact<T>& c, const FlankFriction<T>& mu, const T& s,
                              bool approach) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const SignedTeeth z = signed_teeth(c);
  const T friction =
      approach ? T(mu.coefficient * mu.approach_factor) : T(-mu.coefficient * mu.recess_factor);
  return {.driving = 1.0 - friction * (c.tan_alpha_w + s * (kTurn / z.driving)),
          .driven = 1.0 - friction * (c.tan_alpha_w - s * (kTurn / z.driven))};
}

constexpr std::size_t kNodes = 12;

/// Pairs k = 0 .. pairs - 1 in contact while the first runs from `start` to `end`, the k-th k base
/// pitches ahead of it.
template <class T>
struct ContactSpan {
  T start, end;
  int pairs;
};

/// Integral of the loss 1 − η over a span; empty where the flanks jam.
template <class T>
std::optional<T> loss_integral(const MeshContact<T>& c, const FlankFriction<T>& mu,
                               const ContactSpan<T>& span) {
  static const auto kRule = numerics::gauss_rule<kNodes>();
  // The pair that passes the pitch point splits the span: friction changes sides there.
  std::array<T, 3> ends{span.start, span.end, span.end};
  int pieces = 1;
  for (int k = 0; k < span.pairs; ++k) {
    const double crossing = -static_cast<double>(k);
    if (value_of(span.start) < crossing && crossing < value_of(span.end)) {
      ends = {span.start, constant<T>(crossing), span.end};
      pieces = 2;
    }
  }
  T integral = constant<T>(0.0);
  for (std::size_t piece = 0; piece < static_cast<std::size_t>(pieces); ++piece) {
    const T length = ends[piece + 1] - ends[piece];
    const double middle = 0.5 * (value_of(ends[piece]) + value_of(ends[piece + 1]));
    for (const numerics::GaussNode& node : kRule) {
      const T s = ends[piece] + length * node.position;
      FlankTorques<T> sum{constant<T>(0.0), constant<T>(0.0)};
      for (int k = 0; k < span.pairs; ++k) {
        const double ahead = k;
        const FlankTorques<T> one = flank_torques<T>(c, mu, s + ahead, middle + ahead < 0.0);
        if (!(value_of(one.driving) > 0.0 && value_of(one.driven) > 0.0)) return std::nullopt;
        sum.driving = sum.driving + one.driving;
        sum.driven = sum.driven + one.driven;
      }
      integral = integral + length * (sum.driving - sum.driven) / sum.driving * node.weight;
    }
  }
  return integral;
}

}  // namespace

template <class T>
T path_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu, const T& s) {
  const FlankTorques<T> torque = flank_torques<T>(contact, mu, s, value_of(s) < 0.0);
  if (!(value_of(torque.driving) > 0.0 && value_of(torque.driven) > 0.0)) return constant<T>(0.0);
  return torque.driven / torque.driving;
}

namespace {

template <class T>
T mean_over_path(const MeshContact<T>& contact, const FlankFriction<T>& mu) {
  const T& approach = contact.approach_contact_ratio;
  const T epsilon = approach + contact.recess_contact_ratio;
  if (value_of(epsilon) <= 0.0) {
    return path_efficiency<T>(contact, mu, 0.5 * (contact.recess_contact_ratio - approach));
  }
  // As in sliding_factor(): over a share f of the pitch there are pairs + 1 in contact.
  const int pairs = static_cast<int>(std::floor(value_of(epsilon)));
  const T f = epsilon - static_cast<double>(pairs);
  const T first = -approach;
  const auto more =
      loss_integral<T>(contact, mu, {.start = first, .end = first + f, .pairs = pairs + 1});
  if (!more) return constant<T>(0.0);
  if (pairs == 0) return 1.0 - *more / f;
  const auto fewer =
      loss_integral<T>(contact, mu, {.start = first + f, .end = first + 1.0, .pairs = pairs});
  if (!fewer) return constant<T>(0.0);
  return 1.0 - (*more + *fewer);
}

/// Friction of either side of the pitch point, with derivatives by the two.
using JetFlanks = ceres::Jet<double, 2>;

/// Where the gears are drawn and friction alone has derivatives: by the chain rule from those by
/// the friction of either side, as a row of Jet1 costs three times as much.
Jet1 mean_by_friction(const MeshContact<Jet1>& contact, const FlankFriction<Jet1>& mu) {
  const MeshContact<JetFlanks> drawn{
      .z1 = contact.z1,
      .z2 = contact.z2,
      .sign = contact.sign,
      .approach_contact_ratio = JetFlanks(contact.approach_contact_ratio.a),
      .recess_contact_ratio = JetFlanks(contact.recess_contact_ratio.a),
      .tan_alpha_w = JetFlanks(contact.tan_alpha_w.a),
      .gear1_drives = contact.gear1_drives};
  const Jet1 approach = mu.coefficient * mu.approach_factor;
  const Jet1 recess = mu.coefficient * mu.recess_factor;
  const JetFlanks mean =
      mean_over_path<JetFlanks>(drawn, {.coefficient = JetFlanks(1.0),
                                        .approach_factor = JetFlanks(approach.a, 0),
                                        .recess_factor = JetFlanks(recess.a, 1)});
  Jet1 result(mean.a);
  result.v = mean.v[0] * approach.v + mean.v[1] * recess.v;
  return result;
}

bool is_drawn(const MeshContact<Jet1>& c) {
  return is_neutral(c.approach_contact_ratio, c.approach_contact_ratio.a) &&
         is_neutral(c.recess_contact_ratio, c.recess_contact_ratio.a) &&
         is_neutral(c.tan_alpha_w, c.tan_alpha_w.a);
}

}  // namespace

template <class T>
T coulomb_path_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu) {
  if constexpr (std::is_same_v<T, Jet1>) {
    if (is_drawn(contact)) return mean_by_friction(contact, mu);
  }
  return mean_over_path<T>(contact, mu);
}

template <class T>
T mesh_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu, LossModel model) {
  if (model == LossModel::kCoulombPath || model == LossModel::kDirectional) {
    return coulomb_path_efficiency(contact, mu);
  }
  const T factor =
      model == LossModel::kOhlendorf
          ? ohlendorf_factor(contact.approach_contact_ratio, contact.recess_contact_ratio)
          : sliding_factor(contact.approach_contact_ratio, contact.recess_contact_ratio);
  const double teeth = 1.0 / contact.z1 + contact.sign / contact.z2;
  T efficiency = 1.0 - std::numbers::pi * teeth * mu.coefficient * factor;
  if (!(is_neutral(mu.approach_factor, 1.0) && is_neutral(mu.recess_factor, 1.0))) {
    efficiency =
        efficiency + (coulomb_path_efficiency(contact, mu) -
                      coulomb_path_efficiency<T>(contact, {.coefficient = mu.coefficient}));
  }
  return efficiency;
}

bool loss_model_in_range(LossModel model, double approach, double recess) {
  if (model != LossModel::kOhlendorf) return approach + recess > 0.0;
  return approach >= 0.0 && approach <= 1.0 && recess >= 0.0 && recess <= 1.0 &&
         approach + recess >= 1.0;
}

#define INSTANTIATE(T)                                                                     \
  template T ohlendorf_factor<T>(const T&, const T&);                                      \
  template T sliding_factor<T>(const T&, const T&);                                        \
  template T path_efficiency<T>(const MeshContact<T>&, const FlankFriction<T>&, const T&); \
  template T coulomb_path_efficiency<T>(const MeshContact<T>&, const FlankFriction<T>&);   \
  template T mesh_efficiency<T>(const MeshContact<T>&, const FlankFriction<T>&, LossModel);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::efficiency
