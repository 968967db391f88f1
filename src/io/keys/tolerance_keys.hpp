#pragma once
// Keys of the table [tolerances]; the same in DESIGN, SPEC and PAIR.

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "backlash/pitch_grade.hpp"
#include "backlash/tolerances.hpp"
#include "design/design.hpp"
#include "io/keys/key_registry.hpp"
#include "units/units.hpp"

namespace gear3k::io {

/// What a file states of tolerances; gears as in the file's schema.
struct ToleranceInput {
  bool stated = false;
  struct Gear {
    backlash::GearTolerances tolerances;
    std::optional<int> grade;
    bool runout = false, cumulative_pitch = false, single_pitch = false;  ///< stated
  };
  std::array<Gear, train::kGearCount> gears{};
  backlash::DeviationLimits center_distance_m, planet_phase_rad;
  double pin_position_m = 0.0;
  backlash::Scatter scatter = backlash::Scatter::kNormal;
  double sigma_level = 3.0;
  design::Sampling sampling;
};

/// A value of kNumberOrRange: ± a number, or [lower, upper].
inline backlash::DeviationLimits deviation_limits(const TomlValue& v, double unit) {
  if (v.is_number()) return {.lower = -unit * v.number, .upper = unit * v.number};
  return {.lower = unit * v.list[0].number, .upper = unit * v.list[1].number};
}

/// Keys of gears and centre distance.
/// @param view  ToleranceInput&(Target&)
/// @param pair  of two gears: without run-out and pitch, which its limits do not have
template <class Target, class View>
void append_gear_tolerance_keys(std::vector<Key<Target>>& keys, View view, bool pair) {
  const auto add = [&](const KeyRecord& record, auto assign) {
    keys.push_back({.record = record,
                    .assign = [view, assign](Target& t, std::size_t gear, const TomlValue& v) {
                      view(t).stated = true;
                      assign(view(t), view(t).gears[gear], v);
                    }});
  };
  using Input = ToleranceInput;
  using Gear = ToleranceInput::Gear;
  const auto add_limits = [&](const std::string& path, const char* default_text, const char* help,
                              auto assign) {
    add({.path = path,
         .type = KeyType::kNumberOrRange,
         .unit = "um",
         .min = -1e4,
         .max = 1e4,
         .default_text = default_text,
         .help = help},
        [assign](Input& t, Gear& g, const TomlValue& v) {
          assign(t, g.tolerances, deviation_limits(v, units::kMicrometre));
        });
  };
  using Limits = backlash::DeviationLimits;
  using Of = backlash::GearTolerances;
  const std::string prefix = "tolerances.{gear}.";
  add_limits("tolerances.center_distance_um", "0",
             "deviation of the built centre distance, in a gearbox that of the carrier at all "
             "planets",
             [](Input& t, Of&, const Limits& limits) { t.center_distance_m = limits; });
  add_limits(prefix + "tooth_thickness_um", "0",
             "deviation of the tooth thickness (arc on the reference circle) from that of profile "
             "shift and machining allowance",
             [](Input&, Of& gear, const Limits& limits) { gear.tooth_thickness_m = limits; });
  add_limits(prefix + "tip_diameter_um", "0", "deviation of the tip diameter",
             [](Input&, Of& gear, const Limits& limits) { gear.tip_diameter_m = limits; });
  add_limits(prefix + "root_diameter_um", "as the tool is fed in for the tooth thickness",
             "deviation of the root diameter",
             [](Input&, Of& gear, const Limits& limits) { gear.root_diameter_m = limits; });
  if (pair) return;
  const auto add_length = [&](const char* name, double backlash::GearTolerances::*member,
                              bool Gear::*flag, const char* help) {
    add({.path = prefix + name,
         .type = KeyType::kNumber,
         .unit = "um",
         .min = 0.0,
         .max = 1e4,
         .default_text = "that of accuracy_grade, else 0",
         .help = help},
        [member, flag](Input&, Gear& g, const TomlValue& v) {
          g.tolerances.*member = v.number * units::kMicrometre;
          g.*flag = true;
        });
  };
  add_length("runout_um", &backlash::GearTolerances::runout_m, &Gear::runout,
             "F_r: twice the greatest eccentricity of the teeth");
  add_length("cumulative_pitch_um", &backlash::GearTolerances::cumulative_pitch_m,
             &Gear::cumulative_pitch,
             "F_p: total cumulative pitch deviation, with what the eccentricity adds to it");
  add_length(
      "single_pitch_um", &backlash::GearTolerances::single_pitch_m, &Gear::single_pitch,
      "f_pt: each pitch differs by up to +- this, as each flank stands within +- half of it");
  add({.path = prefix + "accuracy_grade",
       .type = KeyType::kInteger,
       .min = backlash::kFinestGrade,
       .max = backlash::kCoarsestGrade,
       .default_text = "none",
       .help = "ISO 1328-1:1995 accuracy grade: sets those of runout_um, cumulative_pitch_um and "
               "single_pitch_um that are not stated"},
      [](Input&, Gear& g, const TomlValue& v) { g.grade = static_cast<int>(v.integer); });
}

/// Keys of a whole gearbox, beside those of its gears.
/// @param view  ToleranceInput&(Target&)
template <class Target, class View>
void append_tolerance_keys(std::vector<Key<Target>>& keys, View view) {
  append_gear_tolerance_keys<Target>(keys, view, false);
  const auto add = [&](const KeyRecord& record, auto assign) {
    keys.push_back(
        {.record = record, .assign = [view, assign](Target& t, std::size_t, const TomlValue& v) {
           view(t).stated = true;
           assign(view(t), v);
         }});
  };
  using Input = ToleranceInput;
  add({.path = "tolerances.pin_position_um",
       .type = KeyType::kNumber,
       .unit = "um",
       .min = 0.0,
       .max = 1e4,
       .default_text = "0",
       .help = "diameter of the circle about its drawn place in which each planet's pin stands"},
      [](Input& t, const TomlValue& v) { t.pin_position_m = v.number * 1e-6; });
  add({.path = "tolerances.planet_phase_arcmin",
       .type = KeyType::kNumberOrRange,
       .unit = "arcmin",
       .min = -600.0,
       .max = 600.0,
       .default_text = "0",
       .help = "angle of P2 against P1 on each planet, deviation from the drawn one"},
      [](Input& t, const TomlValue& v) {
        t.planet_phase_rad = deviation_limits(v, units::kArcmin);
      });
  add({.path = "tolerances.scatter",
       .type = KeyType::kChoice,
       .choices = {backlash::kScatterNames.begin(), backlash::kScatterNames.end()},
       .default_text = "\"normal\"",
       .help = "how built values scatter about the middle of their limits; none lies beyond them"},
      [](Input& t, const TomlValue& v) {
        t.scatter = v.text == "uniform" ? backlash::Scatter::kUniform : backlash::Scatter::kNormal;
      });
  add({.path = "tolerances.sigma_level",
       .type = KeyType::kNumber,
       .min = 1.0,
       .max = 6.0,
       .default_text = "3",
       .help = "normal scatter: the limits lie so many standard deviations off the middle"},
      [](Input& t, const TomlValue& v) { t.sigma_level = v.number; });
  add({.path = "tolerances.samples",
       .type = KeyType::kInteger,
       .min = 1000,
       .max = 1e9,
       .default_text = "1000000",
       .help = "gearboxes that are built at random"},
      [](Input& t, const TomlValue& v) { t.sampling.samples = v.integer; });
  add({.path = "tolerances.seed",
       .type = KeyType::kInteger,
       .min = 0,
       .max = 9e15,
       .default_text = "1",
       .help = "seed of the random gearboxes"},
      [](Input& t, const TomlValue& v) {
        t.sampling.seed = static_cast<std::uint64_t>(v.integer);
      });
}

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

/// "[tolerances]" and its tables as a DESIGN file states them; "" where there is nothing to say.
std::string tolerances_text(const backlash::Tolerances& tolerances,
                            const design::Sampling& sampling);

}  // namespace gear3k::io
