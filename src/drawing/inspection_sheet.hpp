#pragma once
// What is measured on the gears that a drawing shows, with its limits.

#include <optional>
#include <string>
#include <vector>

#include "backlash/tolerances.hpp"
#include "design/evaluation.hpp"

namespace gear3k::drawing {

/// A line of a sheet.
struct Characteristic {
  std::string group;   ///< gear, blank, teeth, deviations; of the planet sheet: phase, assembly
  std::string name;    ///< base tangent length over 3 teeth
  std::string symbol;  ///< W_3
  std::string unit;    ///< mm, um, deg; "" of counts
  /// As drawn, and its limits; in `unit`.
  std::optional<double> nominal, lower, upper;
  std::string note;
};

/// The sheet of one gear, or of the compound planet.
struct InspectionSheet {
  std::string name;   ///< of the files: S, P1, R1, P2, R2, planet; of a PAIR gear1, gear2
  std::string title;  ///< of the design
  std::vector<Characteristic> rows;
  std::vector<std::string> notes;
};

/// Deviations (f_pt, F_p, F_r) that are those of one accuracy grade of ISO 1328-1:1995, if they
/// are.
std::optional<int> grade_of(const geometry::GearGeometry<double>& gear,
                            const backlash::GearTolerances& tolerances);

/// The sheets of S, P1, R1, P2, R2 and of the compound planet.
///
/// Nominal values are those of the drawn gear, with its machining allowance; limits are those of
/// the stated tolerances, and missing where there are none.  A tooth that is a deviation A thicker
/// (arc on the reference circle) has W_k longer by A cos α, M by its own equation, and its root
/// where the tool stands that cut it (geometry::infeed).  The allowance A_sn is against the tooth
/// without machining allowance, A = −m q/cos α + deviation. Source: ISO 21771, docs/theory §21.
std::vector<InspectionSheet> inspection_sheets(const design::Design& design,
                                               const design::Evaluation& evaluation);
/// Those of gear1 and gear2 of a pair.
std::vector<InspectionSheet> inspection_sheets(const design::PairDesign& design,
                                               const design::PairEvaluation& evaluation);

/// Columns group, characteristic, symbol, unit, nominal, lower, upper, note: a line for each row,
/// in full precision; then the notes as lines of the group `note`.
std::string sheet_csv(const InspectionSheet& sheet);

/// A page to print (A4) and to fill in, as HTML that needs no other file: with a column for what
/// was measured.
std::string sheet_html(const InspectionSheet& sheet);

}  // namespace gear3k::drawing
