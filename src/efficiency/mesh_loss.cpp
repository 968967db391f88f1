#include "efficiency/mesh_loss.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <type_traits>

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

/// 2π over the signed teeth of either gear.
struct PitchAngles {
  double driving_rad, driven_rad;
};
template <class G>
PitchAngles pitch_angles(const MeshContact<G>& c) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const SignedTeeth z = signed_teeth(c);
  return {.driving_rad = kTurn / z.driving, .driven_rad = kTurn / z.driven};
}

/// Friction over normal force of the pairs short of the pitch point and past it, positive where it
/// acts against the driving gear: μ and −μ, each with its factor.
template <class T>
struct SidesFriction {
  T approach, recess;
};
template <class T>
SidesFriction<T> sides_of(const FlankFriction<T>& mu) {
  return {.approach = mu.coefficient * mu.approach_factor,
          .recess = -mu.coefficient * mu.recess_factor};
}

/// A span of the base pitch: pairs k = 0 .. pairs - 1 in contact while the first runs from `start`
/// to `end`, the k-th k base pitches ahead of it.
template <class G>
struct ContactSpan {
  G start, end;
  int pairs;
};

/// Whether friction is less than what the normal force does on either gear in every position of a
/// span on which no pair passes the pitch point: at its ends, as levers are linear between.
bool runs(double tan_alpha_w, const PitchAngles& pitch, const SidesFriction<double>& friction,
          const ContactSpan<double>& span) {
  const double middle = 0.5 * (span.start + span.end);
  for (int k = 0; k < span.pairs; ++k) {
    const double f = middle + k < 0.0 ? friction.approach : friction.recess;
    for (const double s : {span.start + k, span.end + k}) {
      const double driving = tan_alpha_w + s * pitch.driving_rad;
      const double driven = tan_alpha_w - s * pitch.driven_rad;
      if (!(f * driving < kJammingFriction && f * driven < kJammingFriction)) return false;
    }
  }
  return true;
}

/// S = Σ y^j/(2j + 3) = (artanh(√y)/√y − 1)/y, 0 ≤ y < 1.
template <class T>
T divisor_series(const T& y) {
  using std::log, std::sqrt;
  constexpr double kClosed = 0.25, kLeast = 1e-18;
  const double at = value_of(y);
  if (at > kClosed) {
    const T root = sqrt(y);
    return (log(T((1.0 + root) / (1.0 - root))) / (2.0 * root) - 1.0) / y;
  }
  // Two terms more than the value needs, for two derivatives.
  const int last =
      2 + (at > kLeast ? static_cast<int>(std::ceil(std::log(kLeast) / std::log(at))) : 0);
  T sum = constant<T>(1.0 / (2.0 * last + 3.0));
  for (int j = last - 1; j >= 0; --j) sum = sum * y + 1.0 / (2.0 * j + 3.0);
  return sum;
}

/// Integral of the loss 1 − η over a span on which no pair passes the pitch point.  Torques over
/// normal force and base radius are linear in s, that of the driving gear and what is lost of it
///
///   n − Σ f_k (tan α_w + 2π s_k/z_d),   −(2π/z_d + 2π/z_f) Σ f_k s_k,   s_k = s + k,
///
/// f_k the friction of the side of the k-th pair: a quotient of linear functions, docs/theory §23.
/// @tparam G  of the geometry: plain numbers where the gears are drawn and friction alone has
///            derivatives
template <class G, class T>
T piece_integral(const MeshContact<G>& c, const SidesFriction<T>& friction,
                 const ContactSpan<G>& span) {
  const PitchAngles pitch = pitch_angles(c);
  const double middle = 0.5 * (value_of(span.start) + value_of(span.end));
  // Of the pairs on either side: how many, and the sum of their k.
  double before = 0.0, ahead_before = 0.0, past = 0.0, ahead_past = 0.0;
  for (int k = 0; k < span.pairs; ++k) {
    const double ahead = k;
    (middle + ahead < 0.0 ? before : past) += 1.0;
    (middle + ahead < 0.0 ? ahead_before : ahead_past) += ahead;
  }
  const G length = span.end - span.start;
  const G at = 0.5 * (span.start + span.end);
  const G s_before = before * at + ahead_before, s_past = past * at + ahead_past;
  const T moment = friction.approach * s_before + friction.recess * s_past;
  const T pull = friction.approach * before + friction.recess * past;
  const T driving =
      static_cast<double>(span.pairs) - pull * c.tan_alpha_w - moment * pitch.driving_rad;
  const double both = -(pitch.driving_rad + pitch.driven_rad);
  // Over t = (s − middle)/length from −½ to ½: (lost + lost_by t)/(1 + x t), over `driving`.
  const T lost = moment * both;
  const T change = pull * length;
  const T lost_by = change * both;
  const T x = change * -pitch.driving_rad / driving;
  const T y = 0.25 * x * x;
  const T series = divisor_series(y);
  return (lost * (1.0 + y * series) - lost_by * (0.25 * x * series)) / driving * length;
}

/// Integral of the loss 1 − η over a span; empty where the flanks jam.
template <class G, class T>
std::optional<T> loss_integral(const MeshContact<G>& c, const SidesFriction<T>& friction,
                               const ContactSpan<G>& span) {
  // The pair that passes the pitch point splits the span: friction changes sides there.
  std::array<G, 3> ends{span.start, span.end, span.end};
  std::size_t pieces = 1;
  for (int k = 0; k < span.pairs; ++k) {
    const double crossing = -static_cast<double>(k);
    if (value_of(span.start) < crossing && crossing < value_of(span.end)) {
      ends = {span.start, constant<G>(crossing), span.end};
      pieces = 2;
    }
  }
  T integral = constant<T>(0.0);
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const ContactSpan<G> part{.start = ends[piece], .end = ends[piece + 1], .pairs = span.pairs};
    if (!runs(value_of(c.tan_alpha_w), pitch_angles(c),
              {.approach = value_of(friction.approach), .recess = value_of(friction.recess)},
              {.start = value_of(part.start), .end = value_of(part.end), .pairs = part.pairs})) {
      return std::nullopt;
    }
    integral = integral + piece_integral<G, T>(c, friction, part);
  }
  return integral;
}

}  // namespace

template <class T>
T path_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu, const T& s) {
  const SidesFriction<T> sides = sides_of(mu);
  const T& friction = value_of(s) < 0.0 ? sides.approach : sides.recess;
  const PitchAngles pitch = pitch_angles(contact);
  const T driving = 1.0 - friction * (contact.tan_alpha_w + s * pitch.driving_rad);
  const T driven = 1.0 - friction * (contact.tan_alpha_w - s * pitch.driven_rad);
  if (!(value_of(driving) > 0.0 && value_of(driven) > 0.0)) return constant<T>(0.0);
  return driven / driving;
}

namespace {

/// Of a path with a length.
template <class G, class T>
T mean_over_path(const MeshContact<G>& contact, const SidesFriction<T>& friction) {
  // As in sliding_factor(): over a share f of the pitch there are pairs + 1 in contact.
  const G epsilon = contact.approach_contact_ratio + contact.recess_contact_ratio;
  const int pairs = static_cast<int>(std::floor(value_of(epsilon)));
  const G f = epsilon - static_cast<double>(pairs);
  const G first = -contact.approach_contact_ratio;
  const auto more = loss_integral<G, T>(contact, friction,
                                        {.start = first, .end = first + f, .pairs = pairs + 1});
  if (!more) return constant<T>(0.0);
  if (pairs == 0) return 1.0 - *more / f;
  const auto fewer = loss_integral<G, T>(contact, friction,
                                         {.start = first + f, .end = first + 1.0, .pairs = pairs});
  if (!fewer) return constant<T>(0.0);
  return 1.0 - (*more + *fewer);
}

/// A mesh as drawn.
MeshContact<double> drawn(const MeshContact<Jet1>& c) {
  return {.z1 = c.z1,
          .z2 = c.z2,
          .sign = c.sign,
          .approach_contact_ratio = c.approach_contact_ratio.a,
          .recess_contact_ratio = c.recess_contact_ratio.a,
          .tan_alpha_w = c.tan_alpha_w.a,
          .gear1_drives = c.gear1_drives};
}

bool is_drawn(const MeshContact<Jet1>& c) {
  return is_neutral(c.approach_contact_ratio, c.approach_contact_ratio.a) &&
         is_neutral(c.recess_contact_ratio, c.recess_contact_ratio.a) &&
         is_neutral(c.tan_alpha_w, c.tan_alpha_w.a);
}

/// Friction of either side of the pitch point, with derivatives by the two.
using JetFlanks = ceres::Jet<double, 2>;

/// Where the gears are drawn and friction alone has derivatives: by the chain rule from those by
/// the friction of either side.
Jet1 mean_by_friction(const MeshContact<Jet1>& contact, const SidesFriction<Jet1>& friction) {
  const auto mean = mean_over_path<double, JetFlanks>(
      drawn(contact),
      {.approach = JetFlanks(friction.approach.a, 0), .recess = JetFlanks(friction.recess.a, 1)});
  Jet1 result(mean.a);
  result.v = mean.v[0] * friction.approach.v + mean.v[1] * friction.recess.v;
  return result;
}

}  // namespace

template <class T>
T coulomb_path_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu) {
  const T& approach = contact.approach_contact_ratio;
  if (value_of(approach) + value_of(contact.recess_contact_ratio) <= 0.0) {
    return path_efficiency<T>(contact, mu, 0.5 * (contact.recess_contact_ratio - approach));
  }
  if constexpr (std::is_same_v<T, Jet1>) {
    if (is_drawn(contact)) return mean_by_friction(contact, sides_of(mu));
  }
  return mean_over_path<T, T>(contact, sides_of(mu));
}

namespace {

/// Factor B of a first-order model.
template <class T>
T loss_factor(const MeshContact<T>& c, LossModel model) {
  return model == LossModel::kOhlendorf
             ? ohlendorf_factor(c.approach_contact_ratio, c.recess_contact_ratio)
             : sliding_factor(c.approach_contact_ratio, c.recess_contact_ratio);
}

}  // namespace

template <class T>
T mesh_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu, LossModel model) {
  if (model == LossModel::kCoulombPath || model == LossModel::kDirectional) {
    return coulomb_path_efficiency(contact, mu);
  }
  T factor = constant<T>(0.0);
  if constexpr (std::is_same_v<T, Jet1>) {
    factor =
        is_drawn(contact) ? Jet1(loss_factor(drawn(contact), model)) : loss_factor(contact, model);
  } else {
    factor = loss_factor(contact, model);
  }
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
