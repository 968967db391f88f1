#include "efficiency/mesh_loss.hpp"

#include <cmath>
#include <numbers>

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
    const T middle = recess - approach;  // twice the path's middle
    return value_of(middle) < 0.0 ? T(-middle) : middle;
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

template <class T>
T mesh_efficiency(const MeshContact<T>& contact, const T& mu, LossModel model) {
  const T factor =
      model == LossModel::kOhlendorf
          ? ohlendorf_factor(contact.approach_contact_ratio, contact.recess_contact_ratio)
          : sliding_factor(contact.approach_contact_ratio, contact.recess_contact_ratio);
  const double teeth = 1.0 / contact.z1 + contact.sign / contact.z2;
  return 1.0 - std::numbers::pi * teeth * mu * factor;
}

bool loss_model_in_range(LossModel model, double approach, double recess) {
  if (model != LossModel::kOhlendorf) return approach + recess > 0.0;
  return approach >= 0.0 && approach <= 1.0 && recess >= 0.0 && recess <= 1.0 &&
         approach + recess >= 1.0;
}

#define INSTANTIATE(T)                                \
  template T ohlendorf_factor<T>(const T&, const T&); \
  template T sliding_factor<T>(const T&, const T&);   \
  template T mesh_efficiency<T>(const MeshContact<T>&, const T&, LossModel);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)

}  // namespace gear3k::efficiency
