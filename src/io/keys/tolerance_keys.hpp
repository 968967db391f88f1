#pragma once
// Keys of the table [tolerances]; the same in DESIGN, SPEC and PAIR.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "backlash/pitch_grade.hpp"
#include "backlash/tolerances.hpp"
#include "design/design.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

/// What a file states of tolerances; gears as in the file's schema.
struct ToleranceInput {
  bool stated = false;
  struct Gear {
    backlash::DeviationLimits tooth_thickness_m, tip_diameter_m;
    std::optional<backlash::DeviationLimits> root_diameter_m;
    std::optional<double> runout_m, cumulative_pitch_m, single_pitch_m;
    std::optional<int> grade;
  };
  std::array<Gear, train::kGearCount> gears{};
  backlash::DeviationLimits center_distance_m, planet_phase_rad;
  double pin_position_m = 0.0;
  backlash::Scatter scatter = backlash::Scatter::kNormal;
  double sigma_level = 3.0;
  design::Sampling sampling;
};

/// A_sni and A_sne of a gear, in place of its thinning and the tolerance of its tooth thickness.
KeyRecord thickness_allowance_record(const std::string& path);

/// Says that a gear states its thickness in two ways, at both of them.
void refuse_both(const std::string& allowance_path, const std::string& other_path,
                 FileReading& reading);

/// Keys of gears and centre distance.
/// @param pair  of two gears: without run-out and pitch, which its limits do not have
std::vector<Key<ToleranceInput>> gear_tolerance_keys(bool pair);
/// Keys of a whole gearbox, those of its gears among them.
std::vector<Key<ToleranceInput>> tolerance_keys();

/// The tolerances of a gearbox as stated, those of grades left out.
backlash::Tolerances stated_tolerances(const ToleranceInput& input);

/// What a grade has to say of a gear whose size is known.
struct GradedGear {
  std::string path;  ///< of its table: "tolerances.S"
  double module_m = 0.0, reference_diameter_m = 0.0;
};
/// Tolerances of one gear, completed by its grade; sizes out of the standard's range are reported.
backlash::GearTolerances finish_gear_tolerances(const ToleranceInput::Gear& input,
                                                const GradedGear& gear, FileReading& reading);

/// What a file states of these tolerances.
ToleranceInput stated_input(const backlash::Tolerances& tolerances,
                            const design::Sampling& sampling);

}  // namespace gear3k::io
