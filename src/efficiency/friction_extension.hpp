#pragma once
// How the friction of the meshes differs from a design's law: what a calibrated model carries.

#include <array>
#include <cmath>

#include "geometry/scalar.hpp"

namespace gear3k::efficiency {

/// Most places at which a free smooth curve has a value of its own.
inline constexpr int kMostCurvePlaces = 7;

/// How a law of one variable bends: exp(q x² + c x³ + s(x)), with x the variable (ln F, ln v or θ)
/// from its reference on, over half_range; x² and x³ beyond |x| = 1.5 as there.
///
/// s goes through given values at places from x = −1 to 1, even ones or those given, as a cubic
/// between two of them, straight on to |x| = 1.5 and beyond as there.  Its slope at an even place
/// is that of the chord past it (Catmull-Rom), at a given one 0 or a harmonic mean of both chords,
/// so that s stays between neighbours (docs/theory §29); at the first and the last the chord's.
template <class T>
struct FrictionBend {
  T quadratic{}, cubic{};               ///< q, c
  std::array<T, kMostCurvePlaces> s{};  ///< that of place number `places`/2 is the level, and 0
  int places = kMostCurvePlaces;        ///< of s
  /// x of each place, rising from −1 to 1; all 0: even ones.
  std::array<double, kMostCurvePlaces> x{};
  double half_range = 1.0;  ///< > 0
};

/// Factors on the coefficient of friction that a design states; by default all are 1.
///
///   μ = μ_design · level · (F/F_0)^n · (1 + a exp(−v/v_0)) · (v/v_1)^m · exp(β (θ − θ_0)) · side
///       · bends of F, v and θ
///
/// F, v: normal force (or, of all meshes alike, the torque that R2's teeth carry) and mean sliding
/// speed of a mesh; θ: temperature of the lubricant; side:
/// `forward` or `backward`, by which end drives the train.  `approach` and `recess` multiply the
/// friction on either side of the pitch point; `inner_drives` and `outer_drives` that of a mesh by
/// which of its gears drives, the inner one (the sun, of planet and ring the planet) or the other;
/// `ring_meshes` that of both meshes with a ring.
/// Source: empirical forms, docs/theory §29; the parameters come from measurements.
template <class T>
struct FrictionExtension {
  T level = constant<T>(1.0);
  T load_exponent{};                        ///< n
  double reference_force_N = 1.0;           ///< F_0 > 0; [N m] where it is a torque
  bool load_is_torque = false;              ///< each mesh by its own share of the load
  bool share_is_of_force = false;           ///< that share by the mesh's own force
  T slow_excess{};                          ///< a
  T slow_speed_m_s = constant<T>(1.0);      ///< v_0 > 0
  T speed_exponent{};                       ///< m
  double reference_speed_m_s = 1.0;         ///< v_1 > 0
  T temperature_1_K{};                      ///< β
  double reference_temperature_K = 293.15;  ///< θ_0
  FrictionBend<T> load_bend, speed_bend, temperature_bend;
  T forward = constant<T>(1.0), backward = constant<T>(1.0);
  T approach = constant<T>(1.0), recess = constant<T>(1.0);
  T inner_drives = constant<T>(1.0), outer_drives = constant<T>(1.0);
  T ring_meshes = constant<T>(1.0);
};

/// Whether meshes differ by themselves: by constants, which ask for no state.
template <class T>
bool depends_on_mesh(const FrictionExtension<T>& e) {
  return !(is_neutral(e.inner_drives, 1.0) && is_neutral(e.outer_drives, 1.0) &&
           is_neutral(e.ring_meshes, 1.0));
}

/// Friction of a mesh of a train over that of the others.
/// @param with_ring  the outer gear is a ring; @param inner_drives  else the outer gear does
template <class T>
T mesh_factor(const FrictionExtension<T>& e, bool with_ring, bool inner_drives) {
  const T& side = inner_drives ? e.inner_drives : e.outer_drives;
  return with_ring ? T(side * e.ring_meshes) : side;
}

template <class T>
bool is_straight(const FrictionBend<T>& bend) {
  for (const T& s : bend.s) {
    if (!is_neutral(s, 0.0)) return false;
  }
  return is_neutral(bend.quadratic, 0.0) && is_neutral(bend.cubic, 0.0);
}

/// s(x).
template <class T>
T curve_at(const FrictionBend<T>& bend, const T& x);

/// Whether the factor depends on the temperature.
template <class T>
bool depends_on_temperature(const FrictionExtension<T>& e) {
  return !(is_neutral(e.temperature_1_K, 0.0) && is_straight(e.temperature_bend));
}

/// Whether the factor needs to know where a mesh runs.
template <class T>
bool depends_on_state(const FrictionExtension<T>& e) {
  return depends_on_temperature(e) ||
         !(is_neutral(e.load_exponent, 0.0) && is_neutral(e.slow_excess, 0.0) &&
           is_neutral(e.speed_exponent, 0.0) && is_straight(e.load_bend) &&
           is_straight(e.speed_bend));
}

/// The part of the factor that does not: level and side.  What meshes differ by is mesh_factor().
template <class T>
T constant_factor(const FrictionExtension<T>& e, bool forward) {
  return e.level * (forward ? e.forward : e.backward);
}

/// Least force and speed over their references that the powers see: they have no value at 0.
inline constexpr double kLeastReduced = 1e-3;

/// Which bends there are, where the factor is wanted in many states.
struct BentBy {
  bool load = false, speed = false, temperature = false;
};
template <class T>
BentBy bent_by(const FrictionExtension<T>& e) {
  return {.load = !is_straight(e.load_bend),
          .speed = !is_straight(e.speed_bend),
          .temperature = !is_straight(e.temperature_bend)};
}

/// The whole factor.
/// @param bent  bent_by(e)
/// @param load  normal force [N], or where load_is_torque the torque that R2's teeth carry, where
///              share_is_of_force by the mesh's own force [N m]
template <class T>
T friction_factor(const FrictionExtension<T>& e, const BentBy& bent, const T& load,
                  const T& sliding_speed_m_s, const T& temperature_K, bool forward) {
  using std::exp;
  using std::log;
  T factor = constant_factor(e, forward);
  const auto power = [](const T& x, double reference, const T& exponent) {
    return T(exp(T(exponent * log(larger(T(x / reference), constant<T>(kLeastReduced))))));
  };
  const auto bend = [&](const FrictionBend<T>& b, const T& from_reference) {
    constexpr double kFarthest = 1.5;
    const T x = smaller(larger(T(from_reference / b.half_range), constant<T>(-kFarthest)),
                        constant<T>(kFarthest));
    factor =
        factor *
        exp(T(x * x * (b.quadratic + b.cubic * x) + curve_at(b, T(from_reference / b.half_range))));
  };
  const auto log_over = [](const T& x, double reference) {
    return T(log(larger(T(x / reference), constant<T>(kLeastReduced))));
  };
  if (bent.load) bend(e.load_bend, log_over(load, e.reference_force_N));
  if (bent.speed) {
    bend(e.speed_bend, log_over(sliding_speed_m_s, e.reference_speed_m_s));
  }
  if (bent.temperature) {
    bend(e.temperature_bend, T(temperature_K - e.reference_temperature_K));
  }
  if (!is_neutral(e.load_exponent, 0.0)) {
    factor = factor * power(load, e.reference_force_N, e.load_exponent);
  }
  if (!is_neutral(e.slow_excess, 0.0)) {
    factor = factor * (1.0 + e.slow_excess * exp(T(-sliding_speed_m_s / e.slow_speed_m_s)));
  }
  if (!is_neutral(e.speed_exponent, 0.0)) {
    factor = factor * power(sliding_speed_m_s, e.reference_speed_m_s, e.speed_exponent);
  }
  if (!is_neutral(e.temperature_1_K, 0.0)) {
    factor = factor * exp(T(e.temperature_1_K * (temperature_K - e.reference_temperature_K)));
  }
  return factor;
}
template <class T>
T friction_factor(const FrictionExtension<T>& e, const T& load, const T& sliding_speed_m_s,
                  const T& temperature_K, bool forward) {
  return friction_factor(e, bent_by(e), load, sliding_speed_m_s, temperature_K, forward);
}

}  // namespace gear3k::efficiency
