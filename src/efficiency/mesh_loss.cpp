#include "efficiency/mesh_loss.hpp"

#include <cmath>
#include <numbers>
#include <type_traits>

#include "efficiency/coulomb_path.hpp"

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

bool is_drawn(const MeshContact<Jet1>& c) {
  return is_neutral(c.approach_contact_ratio, c.approach_contact_ratio.a) &&
         is_neutral(c.recess_contact_ratio, c.recess_contact_ratio.a) &&
         is_neutral(c.tan_alpha_w, c.tan_alpha_w.a);
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
    factor = is_drawn(contact) ? Jet1(loss_factor(values_of(contact), model))
                               : loss_factor(contact, model);
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

#define INSTANTIATE(T)                                \
  template T ohlendorf_factor<T>(const T&, const T&); \
  template T sliding_factor<T>(const T&, const T&);   \
  template T mesh_efficiency<T>(const MeshContact<T>&, const FlankFriction<T>&, LossModel);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::efficiency
