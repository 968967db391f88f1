#pragma once
// A specification with one of its limits moved.

#include <optional>

#include "optimize/limit_prices.hpp"
#include "optimize/specification.hpp"

namespace gear3k::optimize {

/// The specification that a file states with another number of one limit.
/// @param by_si  what is added to the limit's number, in SI
/// @returns empty for limits of objectives, face widths, the load and what is felt, and for what no
///   file states
std::optional<Specification> with_limit_moved(const Specification& spec, const LimitPrice& price,
                                              double by_si);

}  // namespace gear3k::optimize
