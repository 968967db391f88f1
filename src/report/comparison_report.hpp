#pragma once
// What `compare` prints: designs side by side.

#include <span>
#include <string>

#include "design/evaluation.hpp"
#include "design/output_terms.hpp"

namespace gear3k::report {

/// A design among those that are compared.
struct ComparedDesign {
  std::string label;  ///< no other has the same
  std::string file;
  design::Evaluation evaluation;
  design::OutputTerms terms;
};

/// Two values of a quantity are alike where they differ by no more than this share of the larger
/// one or, except of masses and inertia, by what is rounding in every other unit of a report; in
/// micrometres that of positions of some 0.1 m is more.
inline constexpr double kAlikeShare = 1e-9, kNegligible = 1e-11, kNegligible_um = 1e-9;

/// What differs and matters most; of two designs the last column is the change from the first one,
/// where both values are positive and it is less than tenfold.
/// @param columns  at most so many (60 and more): names of quantities are broken, then the designs
///   are told in several tables
std::string comparison_table(std::span<const ComparedDesign> designs, int columns = 100);
/// Every quantity of `analyze` and of design::OutputTerms that differs.
std::string comparison_json(std::span<const ComparedDesign> designs);
/// The same: item, quantity, unit and a column for each design; "" where it has no value.
std::string comparison_csv(std::span<const ComparedDesign> designs);

}  // namespace gear3k::report
