#include "optimize/gradients.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace gear3k::optimize {

bool evaluate_gradients(const RefinementProblem& problem, std::span<const double> v,
                        std::span<const std::uint16_t> selection, Gradients& result) {
  const auto n = static_cast<std::size_t>(problem.variables);
  constexpr auto kWidth = static_cast<std::size_t>(kMaxVariables);
  result.df.resize(n);
  result.g.resize(selection.size());
  result.dg.resize(selection.size() * n);
  result.pass.resize(selection.size());
  std::array<Jet1, kMostUnknowns> jets;
  for (std::size_t begin = 0; begin < n; begin += kWidth) {
    const std::size_t count = std::min(kWidth, n - begin);
    for (std::size_t k = 0; k < n; ++k) {
      const bool in_pass = k >= begin && k < begin + count;
      jets[k] = in_pass ? Jet1(v[k], static_cast<int>(k - begin)) : Jet1(v[k]);
    }
    const auto f =
        evaluate<Jet1>(problem, used(problem, jets), selection, std::span<Jet1>(result.pass));
    if (!f) return false;
    result.f = f->a;
    for (std::size_t j = 0; j < count; ++j) {
      const auto axis = static_cast<Eigen::Index>(j);
      result.df[begin + j] = f->v[axis];
      for (std::size_t k = 0; k < selection.size(); ++k) {
        result.dg[k * n + begin + j] = result.pass[k].v[axis];
      }
    }
    for (std::size_t k = 0; k < selection.size(); ++k) result.g[k] = result.pass[k].a;
  }
  return true;
}

std::vector<std::uint16_t> all_rows(const RefinementProblem& problem) {
  std::vector<std::uint16_t> rows(problem.rows.size());
  std::iota(rows.begin(), rows.end(), std::uint16_t{0});
  return rows;
}

}  // namespace gear3k::optimize
