#pragma once
// What is seen first of a design: 25 lines of 100 columns at most.

#include <optional>
#include <string>
#include <vector>

#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "design/tightest.hpp"

namespace gear3k::report {

/// @param tightest  of tightest_checks()
/// @param built     gearboxes built within the design's tolerances; null: none
/// @param columns   lines are broken there; tables have at most 80
/// @param outer_diameter_m  over the rings' outer surfaces, where they are stated
std::string first_screen(const design::Evaluation& e,
                         const std::vector<design::TightestCheck>& tightest,
                         const design::BuiltSeries* built, int columns,
                         std::optional<double> outer_diameter_m = {});
std::string first_screen(const design::PairEvaluation& e,
                         const std::vector<design::TightestCheck>& tightest, int columns);

/// A line broken at blanks, further lines indented; it ends with a line end, given or not.
std::string broken(const std::string& text, int columns, std::size_t indent);

/// A text whose longer lines, those of tables too, are broken so.
std::string folded(const std::string& text, int columns, std::size_t indent);

}  // namespace gear3k::report
