#pragma once
// Pitch and run-out tolerances of an ISO accuracy grade.

#include <optional>

namespace gear3k::backlash {

inline constexpr int kFinestGrade = 3, kCoarsestGrade = 12;
inline constexpr double kLeastGradedModule_m = 0.5e-3, kGreatestGradedModule_m = 70e-3;
inline constexpr double kLeastGradedDiameter_m = 5e-3, kGreatestGradedDiameter_m = 10.0;

struct GradedSize {
  double module_m = 0.0, reference_diameter_m = 0.0;
};
struct PitchTolerances {
  double single_pitch_m = 0.0;      ///< f_pt
  double cumulative_pitch_m = 0.0;  ///< F_p
  double runout_m = 0.0;            ///< F_r
};

/// Tolerances of grade Q, from the geometric means of the ranges that module and diameter lie in,
/// in mm and µm:
///
///   f_pt = (0.3 (m + 0.4 √d) + 4) 2^((Q−5)/2)
///   F_p  = (0.3 m + 1.25 √d + 7) 2^((Q−5)/2),   F_r = 0.8 F_p before rounding
///
/// rounded to 1 µm from 10 µm on, to 0.5 µm from 5 µm on, else to 0.1 µm.
/// Source: ISO 1328-1:1995 and ISO 1328-2:1997 annex B as implemented in gfsReboucas/Drivetrain,
/// Gear.m (formulas of f_pt and F_p, ranges, rounding); confirmed, with F_r, by the nine printed
/// deviations of the KISSsoft report in tests/golden/kisssoft_stage_01.toml.  The edition of 2013
/// has other formulas for its classes.
/// @returns empty outside module 0.5 to 70 mm and diameter 5 to 10,000 mm
/// @throws std::invalid_argument when the grade is not from 3 to 12
std::optional<PitchTolerances> pitch_grade(const GradedSize& gear, int grade);

}  // namespace gear3k::backlash
