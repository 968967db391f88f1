#include "efficiency/coulomb_path.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <type_traits>

namespace gear3k::efficiency {

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

template <class T>
SidesFriction<T> sides_of(const FlankFriction<T>& mu) {
  return {.approach = mu.coefficient * mu.approach_factor,
          .recess = mu.coefficient * mu.recess_factor};
}

/// Torques on the driving and the driven gear over normal force and base radius, of the pair at s
/// base pitches from the pitch point, with friction f that is positive in approach.
template <class G, class T>
struct FlankTorques {
  FlankTorques(const MeshContact<G>& c, const PitchAngles& pitch, const T& f, const G& s)
      : driving(1.0 - f * (c.tan_alpha_w + s * pitch.driving_rad)),
        driven(1.0 - f * (c.tan_alpha_w - s * pitch.driven_rad)) {}
  T driving, driven;
};

/// A span of the base pitch: pairs k = 0 .. pairs - 1 in contact while the first runs from `start`
/// to `end`, the k-th k base pitches ahead of it.
template <class G>
struct ContactSpan {
  G start, end;
  int pairs;
};

/// Whether no pair jams in any position of a span on which none passes the pitch point: at its
/// ends, as torques are linear between.
bool runs(const MeshContact<double>& c, const SidesFriction<double>& mu,
          const ContactSpan<double>& span) {
  const PitchAngles pitch = pitch_angles(c);
  constexpr double kLeast = 1.0 - kJammingFriction;
  const double middle = 0.5 * (span.start + span.end);
  for (int k = 0; k < span.pairs; ++k) {
    const double f = middle + k < 0.0 ? mu.approach : -mu.recess;
    for (const double s : {span.start + k, span.end + k}) {
      const FlankTorques<double, double> torque(c, pitch, f, s);
      if (!(torque.driving > kLeast && torque.driven > kLeast)) return false;
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
  int last = 2;
  for (double power = at; power > kLeast; power *= at) ++last;
  T sum = constant<T>(1.0 / (2.0 * last + 3.0));
  for (int j = last - 1; j >= 0; --j) sum = sum * y + 1.0 / (2.0 * j + 3.0);
  return sum;
}

/// Integral of the loss 1 − η over a span on which no pair passes the pitch point.  Torques over
/// normal force and base radius are linear in s, that of the driving gear and what is lost of it
///
///   n − Σ f_k (tan α_w + 2π s_k/z_d),   −(2π/z_d + 2π/z_f) Σ f_k s_k,   s_k = s + k,
///
/// f_k = μ f_a in approach, −μ f_r in recess: a quotient of linear functions, docs/theory §23.
/// @tparam G  of the geometry: plain numbers where the gears are drawn and friction alone has
///            derivatives
template <class G, class T>
T piece_integral(const MeshContact<G>& c, const SidesFriction<T>& mu, const ContactSpan<G>& span) {
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
  const T moment = mu.approach * s_before - mu.recess * s_past;
  const T pull = mu.approach * before - mu.recess * past;
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
std::optional<T> loss_integral(const MeshContact<G>& c, const SidesFriction<T>& mu,
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
    if (!runs(values_of(c), {.approach = value_of(mu.approach), .recess = value_of(mu.recess)},
              {.start = value_of(part.start), .end = value_of(part.end), .pairs = part.pairs})) {
      return std::nullopt;
    }
    integral = integral + piece_integral<G, T>(c, mu, part);
  }
  return integral;
}

template <class G, class T>
T efficiency_at(const MeshContact<G>& c, const SidesFriction<T>& mu, const G& s) {
  const T friction = value_of(s) < 0.0 ? mu.approach : T(-mu.recess);
  const FlankTorques<G, T> torque(c, pitch_angles(c), friction, s);
  if (!(value_of(torque.driving) > 0.0 && value_of(torque.driven) > 0.0)) return constant<T>(0.0);
  return torque.driven / torque.driving;
}

template <class G, class T>
T mean_over_path(const MeshContact<G>& contact, const SidesFriction<T>& mu) {
  const G& approach = contact.approach_contact_ratio;
  const G epsilon = approach + contact.recess_contact_ratio;
  if (value_of(epsilon) <= 0.0) {
    return efficiency_at<G, T>(contact, mu, 0.5 * (contact.recess_contact_ratio - approach));
  }
  // As in sliding_factor(): over a share f of the pitch there are pairs + 1 in contact.
  const int pairs = static_cast<int>(std::floor(value_of(epsilon)));
  const G f = epsilon - static_cast<double>(pairs);
  const G first = -approach;
  const auto more =
      loss_integral<G, T>(contact, mu, {.start = first, .end = first + f, .pairs = pairs + 1});
  if (!more) return constant<T>(0.0);
  if (pairs == 0) return 1.0 - *more / f;
  const auto fewer =
      loss_integral<G, T>(contact, mu, {.start = first + f, .end = first + 1.0, .pairs = pairs});
  if (!fewer) return constant<T>(0.0);
  return 1.0 - (*more + *fewer);
}

}  // namespace

template <class T>
T path_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu, const T& s) {
  return efficiency_at<T, T>(contact, sides_of(mu), s);
}

template <class T>
T coulomb_path_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu) {
  const SidesFriction<T> sides = sides_of(mu);
  if constexpr (std::is_same_v<T, Jet1>) {
    if (is_drawn(contact)) {
      // By the chain rule from the derivatives by the friction of both sides.
      const JetSides mean = drawn_path_efficiency<JetSides>(
          values_of(contact),
          {.approach = JetSides(sides.approach.a, 0), .recess = JetSides(sides.recess.a, 1)});
      Jet1 result(mean.a);
      result.v = mean.v[0] * sides.approach.v + mean.v[1] * sides.recess.v;
      return result;
    }
  }
  return mean_over_path<T, T>(contact, sides);
}

template <class T>
T drawn_path_efficiency(const MeshContact<double>& contact, const SidesFriction<T>& mu) {
  return mean_over_path<double, T>(contact, mu);
}

#define INSTANTIATE(T)                                                                     \
  template T path_efficiency<T>(const MeshContact<T>&, const FlankFriction<T>&, const T&); \
  template T coulomb_path_efficiency<T>(const MeshContact<T>&, const FlankFriction<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE
template double drawn_path_efficiency<double>(const MeshContact<double>&,
                                              const SidesFriction<double>&);
template JetSides drawn_path_efficiency<JetSides>(const MeshContact<double>&,
                                                  const SidesFriction<JetSides>&);

}  // namespace gear3k::efficiency
