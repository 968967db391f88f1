#pragma once
// Causes against structure without a cause: which of the two the data hold, and the structure's
// shape.

#include <optional>
#include <string>
#include <vector>

#include "calibrate/laws/law_search.hpp"
#include "calibrate/search/search.hpp"
#include "calibrate/verdict/noise_level.hpp"
#include "calibrate/verdict/remainder.hpp"

namespace gear3k::calibrate {

/// What stands once causes and structure have both been looked for.
struct Contest {
  bool structure = false;   ///< structure remains that no cause explains
  std::vector<bool> stays;  ///< of each effect found
  RemainderSearch remainder;
};

/// @param before, after  structure in the residuals of the baseline and of the fit
/// @param base, fitted  the columns of both
/// @param rate  of false discoveries of structure
///
/// An effect that the data no longer need beside a significant best term does not stay, unless it
/// is two thirds of what the term does.  None stays where a term of the baseline's residuals
/// explains clearly better than all causes together, each paid for by the number of causes it was
/// chosen from: then the causes only imitate it, unless they are all of it and leave no structure,
/// or are two thirds of it and structure is left.
Contest causes_against_structure(const SearchResult& found, const Columns& base,
                                 const Columns& fitted, const RemainderSearch& before,
                                 const RemainderSearch& after, double rate);

/// The shape of a term over the levels of its covariate, or over twelfths of its wave, with the
/// mean residual there: fills along, order, at, mean, term, rows and share.
/// @param columns  of the fit that left the residual; @param residual  measured − simulated [SI]
void describe_shape(const Problem& problem, const Columns& columns, const EmpiricalTerm& term,
                    const std::vector<Levels>& levels, const Eigen::VectorXd& residual,
                    Remainder& remainder);

/// What a law that was found by itself tells of as structure that no cause explains: along its
/// first condition, beside the causes that stay.
Remainder structure_of(const Problem& problem, const FoundLaw& law,
                       const std::vector<Levels>& levels);

/// Mean square of what rows as they are miss, over their own σ and not whitened; far ones count as
/// less far.
double mean_square_as_read(const NoiseModel& noise, const Eigen::VectorXd& missed);

/// Settles a contest by what is left: structure beside causes that takes no more off than laws of
/// slightly wrong shape leave (2 % of the squares of the discrepancy) is none; and rows that
/// scatter by more than they state hold structure where they are too few to show their own scatter,
/// by three times as much or more, or where readings that follow each other go together as no
/// sensor's do.  Structure is not none where rows as they are keep as many of those squares beyond
/// noise, and 1.5² times as much as noise makes: noise that remembers, or sessions that scatter,
/// have taken them up.  Nor where steps and drifts alone stand and it is along a condition that is
/// not of the campaign: their slightly other shape leaves none there.
/// @param before  columns of the baseline; @param rate  of false discoveries of structure
/// @param has_causes  whether any stands
/// @returns what is said of structure that does not matter; empty where there is none of it
std::optional<std::string> settle(Contest& contest, const NoiseModel& noise, const LeftOver& left,
                                  const Columns& before, double rate, bool has_causes);
/// Whether a note is that.
bool tells_of_minor_remainder(const std::string& note);

}  // namespace gear3k::calibrate
