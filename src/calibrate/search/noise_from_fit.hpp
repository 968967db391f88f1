#pragma once
// What the residuals of a fit say of the noise: whether it grows with the response, and whether
// sessions scatter.

#include <Eigen/Core>
#include <optional>

#include "calibrate/search/search.hpp"

namespace gear3k::calibrate {

/// Weights of rows whose variance is a share of full scale and one of the simulated response,
/// a² + (b y)², where the likelihood of the residuals says clearly that their scatter follows it;
/// empty otherwise, and where σ is stated.
std::optional<Eigen::VectorXd> weights_by_response(const Problem& problem,
                                                   const SearchResult& found);

/// Variance between sessions over that of rows, τ²/σ².
struct SessionScatter {
  double estimate = 0.0;
  double guarded = 0.0;  ///< as much as the sessions can be thought to scatter, for the weights
};
/// Where it is more than chance and neither an offset common to all, nor a step, nor a drift; 0
/// otherwise, and with fewer than four sessions.
SessionScatter session_scatter(const Problem& problem, const SearchResult& found);

}  // namespace gear3k::calibrate
