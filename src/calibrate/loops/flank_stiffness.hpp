#pragma once
// Stiffness of a loading flank of a torque-angle record.

#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/loops/filtered_record.hpp"
#include "calibrate/loops/torque_angle_loop.hpp"
#include "calibrate/loops/torque_branch.hpp"

namespace gear3k::calibrate {

/// The branch that loads one side of the loop of branches b and b + 1, up to at least half of the
/// loop's peak torque there: its own, else the one before it of the same sense.
/// Source: docs/theory §31 (stiffness).
/// @param peak_Nm  filtered, with its sign
/// @returns index of the branch; empty where neither reaches so far
std::optional<std::size_t> loading_branch(const FilteredRecord& record,
                                          const std::vector<Branch>& branches, std::size_t b,
                                          bool positive, double peak_Nm);

/// Slope of torque over angle between kStiffnessFrom and kStiffnessTo of a branch's last torque,
/// both unfiltered and regressed on the index i of the sample.
///
///   k = Σ (i - ī) T_i / Σ (i - ī) θ_i
///   var k = σ² (1 + φ)/(1 - φ) Σ (i - ī)² / (Σ (i - ī) θ_i)²      (σ², φ of T - k θ)
///
/// Source: own derivation, docs/theory §31, eq. 31.3.
/// Valid: a branch that ends loaded; noise on angle, torque or both leaves k unbiased.
/// @returns empty with fewer than kFewestFlankSamples, against the record's angle_sense, or within
/// 3 standard deviations of 0
std::optional<FlankStiffness> flank_stiffness(const FilteredRecord& record, const Branch& branch);

}  // namespace gear3k::calibrate
