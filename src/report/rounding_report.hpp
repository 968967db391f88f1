#pragma once
// The best design of the lattice of what is made, beside the free optimum.

#include <string>

#include "io/text/json.hpp"
#include "optimize/rounding.hpp"

namespace gear3k::report {

/// What is said of steps that a file states where nothing is rounded; "": it states none.
std::string unread_steps_text(const optimize::Specification& spec);

/// What was rounded to which steps, and what that costs; without a design, which limit blocks and
/// by how much.
/// @param free_objective  of the optimum that was rounded, SI
std::string rounding_table(const optimize::Specification& spec, double free_objective,
                           const optimize::Rounding& rounding);
/// Which limit blocks where no rounded design meets every check, or none was found before the
/// search was cut short, and by how much.
std::string rounding_blocked_text(const optimize::Specification& spec,
                                  const optimize::Rounding& rounding);
/// `rounded` of summary.json.
io::Json rounding_json(const optimize::Specification& spec, double free_objective,
                       const optimize::Rounding& rounding);

}  // namespace gear3k::report
