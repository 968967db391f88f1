#pragma once
// Which limits would have to give way that there is a design.

#include <string>

#include "io/text/json.hpp"
#include "optimize/relaxed_limits.hpp"

namespace gear3k::report {

/// Lines for people: every limit, or pair of limits, that frees a design with the value that does;
/// which free none.  The objective told has nothing of the specification's model, and says so.
std::string relaxed_limits_text(const optimize::Specification& spec,
                                const optimize::RelaxedLimits& relaxed);

/// freed (limits with key, check, stated, relaxed, unit, preset; the design with its objective and
/// whether a model is left out of that), tried_alone,
/// tried_in_pairs, interrupted.
io::Json relaxed_limits_json(const optimize::Specification& spec,
                             const optimize::RelaxedLimits& relaxed);

}  // namespace gear3k::report
