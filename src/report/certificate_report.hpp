#pragma once
// What the bounds of a search prove: JSON and text.

#include <string>

#include "io/text/json.hpp"
#include "optimize/optimizer.hpp"

namespace gear3k::report {

/// null without a certificate.
io::Json certificate_json(const optimize::Specification& spec,
                          const optimize::OptimizeResult& result);

/// What a certificate proves, for the terminal; "" without one.
std::string certificate_text(const optimize::Specification& spec,
                             const optimize::OptimizeResult& result);

}  // namespace gear3k::report
