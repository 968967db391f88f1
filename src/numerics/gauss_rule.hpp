#pragma once
// Gauss-Legendre rules on [0, 1].

#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cstddef>

namespace gear3k::numerics {

struct GaussNode {
  double position = 0.0, weight = 0.0;
};

/// Nodes of the rule with an even number of them.
template <std::size_t kCount>
std::array<GaussNode, kCount> gauss_rule() {
  static_assert(kCount % 2 == 0);
  using Rule = boost::math::quadrature::gauss<double, static_cast<unsigned>(kCount)>;
  std::array<GaussNode, kCount> nodes{};
  for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
    const double x = Rule::abscissa()[i];
    const double weight = 0.5 * Rule::weights()[i];
    nodes[2 * i] = {.position = 0.5 * (1.0 - x), .weight = weight};
    nodes[2 * i + 1] = {.position = 0.5 * (1.0 + x), .weight = weight};
  }
  return nodes;
}

}  // namespace gear3k::numerics
