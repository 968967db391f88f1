#pragma once
// What the residuals of a fit say of the noise: whether it grows with the response, and whether
// sessions scatter.

#include <Eigen/Core>
#include <optional>

#include "calibrate/search.hpp"

namespace gear3k::calibrate {

/// Weights of the rows by a power (½ or 1) of the simulated response, where the likelihood of the
/// residuals says clearly that their scatter follows it; empty otherwise, and where σ is stated.
std::optional<Eigen::VectorXd> weights_by_response(const Problem& problem,
                                                   const SearchResult& found);

/// Variance between sessions over that of rows, τ²/σ², where it is more than chance and neither a
/// step nor a drift; 0 otherwise, and with fewer than four sessions.
double session_variance(const Problem& problem, const SearchResult& found);

}  // namespace gear3k::calibrate
