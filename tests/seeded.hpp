#pragma once
// Variables of a function, each with its own derivative 1.

#include <array>

#include "geometry/scalar.hpp"

namespace gear3k {

template <std::size_t kCount>
std::array<Jet1, kCount> seeded1(const std::array<double, kCount>& at) {
  std::array<Jet1, kCount> v;
  for (std::size_t k = 0; k < kCount; ++k) v[k] = Jet1(at[k], static_cast<int>(k));
  return v;
}

template <std::size_t kCount>
std::array<Jet2, kCount> seeded2(const std::array<double, kCount>& at) {
  std::array<Jet2, kCount> v;
  for (std::size_t k = 0; k < kCount; ++k) v[k] = Jet2::variable(at[k], k);
  return v;
}

}  // namespace gear3k
