#pragma once
// What the bounds of a search prove: JSON and text.

#include <string>

#include "io/text/json.hpp"
#include "optimize/optimizer.hpp"

namespace gear3k::report {

/// A bound of merit_of() in the unit of the objective, rounded to six digits, to the side on which
/// it still is one.
std::string bound_text(const optimize::Specification& spec, double merit);

/// Fields of a certificate; numbers that are not known are null.
io::Json proof_json(const optimize::Specification& spec, const optimize::Certificate& proof);

/// null without a certificate.
io::Json certificate_json(const optimize::Specification& spec,
                          const optimize::OptimizeResult& result);

/// What a certificate proves, for the terminal; "" without one.
std::string certificate_text(const optimize::Specification& spec,
                             const optimize::OptimizeResult& result);

}  // namespace gear3k::report
