#include "io/keys/tolerance_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "units/units.hpp"

namespace gear3k::io {

namespace {

using units::Unit;

/// Keys of [tolerances]; each of them states tolerances.
class ToleranceKeys {
 public:
  template <class View>
  void add(KeyRecord record, View view, bool unless_usual = true) {
    Key<ToleranceInput> key = make_key<ToleranceInput>(std::move(record), view);
    if (unless_usual) key = unless_default(std::move(key));
    key.assign = [assign = key.assign](const KeyRecord& r, ToleranceInput& t, std::size_t gear,
                                       const TomlValue& v) {
      t.stated = true;
      assign(r, t, gear, v);
    };
    key.written = [written = key.written](const ToleranceInput& t, std::size_t gear) {
      return t.stated && (!written || written(t, gear));
    };
    keys_.push_back(std::move(key));
  }
  template <class View>
  void add_limits(const std::string& path, const char* default_text, const char* help, View view) {
    add({.path = path,
         .type = KeyType::kNumberOrRange,
         .unit = Unit::kMicrometre,
         .min = -1e4,
         .max = 1e4,
         .default_text = default_text,
         .help = help},
        view);
  }
  void add_gear_keys(bool pair);
  void add_gearbox_keys();
  [[nodiscard]] std::vector<Key<ToleranceInput>> keys() const { return keys_; }

 private:
  std::vector<Key<ToleranceInput>> keys_;
};

void ToleranceKeys::add_gear_keys(bool pair) {
  using Gear = ToleranceInput::Gear;
  const std::string prefix = "tolerances.{gear}.";
  add_limits("tolerances.center_distance_um", "0",
             "deviation of the built centre distance, in a gearbox that of the carrier at all "
             "planets",
             &ToleranceInput::center_distance_m);
  add_limits(
      prefix + "tooth_thickness_um", "0",
      "deviation of the tooth thickness (arc on the reference circle) from that of profile "
      "shift and machining allowance",
      [](auto& t, std::size_t gear) -> auto& { return t.gears[gear].tooth_thickness_m; });
  add_limits(
      prefix + "tip_diameter_um", "0", "deviation of the tip diameter",
      [](auto& t, std::size_t gear) -> auto& { return t.gears[gear].tip_diameter_m; });
  add_limits(
      prefix + "root_diameter_um", "as the tool is fed in for the tooth thickness",
      "deviation of the root diameter",
      [](auto& t, std::size_t gear) -> auto& { return t.gears[gear].root_diameter_m; });
  if (pair) return;
  const auto add_length = [&](const char* name, std::optional<double> Gear::*member,
                              const char* help) {
    add(
        number(prefix + name, Unit::kMicrometre, within(0.0, 1e4), "that of accuracy_grade, else 0",
               help),
        [member](auto& t, std::size_t gear) -> auto& { return t.gears[gear].*member; });
  };
  add_length("runout_um", &Gear::runout_m, "F_r: twice the greatest eccentricity of the teeth");
  add_length("cumulative_pitch_um", &Gear::cumulative_pitch_m,
             "F_p: total cumulative pitch deviation, with what the eccentricity adds to it");
  add_length(
      "single_pitch_um", &Gear::single_pitch_m,
      "f_pt: each pitch differs by up to +- this, as each flank stands within +- half of it");
  add(
      integer(prefix + "accuracy_grade", within(backlash::kFinestGrade, backlash::kCoarsestGrade),
              "none",
              "ISO 1328-1:1995 accuracy grade: sets those of runout_um, cumulative_pitch_um and "
              "single_pitch_um that are not stated"),
      [](auto& t, std::size_t gear) -> auto& { return t.gears[gear].grade; });
}

void ToleranceKeys::add_gearbox_keys() {
  add(number("tolerances.pin_position_um", Unit::kMicrometre, within(0.0, 1e4), "0",
             "diameter of the circle about its drawn place in which each planet's pin stands"),
      &ToleranceInput::pin_position_m);
  add({.path = "tolerances.planet_phase_arcmin",
       .type = KeyType::kNumberOrRange,
       .unit = Unit::kArcmin,
       .min = -600.0,
       .max = 600.0,
       .default_text = "0",
       .help = "angle of P2 against P1 on each planet, deviation from the drawn one"},
      &ToleranceInput::planet_phase_rad);
  add({.path = "tolerances.scatter",
       .type = KeyType::kChoice,
       .choices = {backlash::kScatterNames.begin(), backlash::kScatterNames.end()},
       .default_text = "\"normal\"",
       .help = "how built values scatter about the middle of their limits; none lies beyond them"},
      &ToleranceInput::scatter, false);
  add(number("tolerances.sigma_level", Unit::kNone, within(1.0, 6.0), "3",
             "normal scatter: the limits lie so many standard deviations off the middle"),
      &ToleranceInput::sigma_level, false);
  add(
      integer("tolerances.samples", within(1000, 1e9), "1000000",
              "gearboxes that are built at random"),
      [](auto& t, std::size_t) -> auto& { return t.sampling.samples; }, false);
  add(
      integer("tolerances.seed", within(0, 9e15), "1", "seed of the random gearboxes"),
      [](auto& t, std::size_t) -> auto& { return t.sampling.seed; }, false);
}

/// Of one gear, those of its grade left out.
backlash::GearTolerances stated_gear(const ToleranceInput::Gear& input) {
  return {.tooth_thickness_m = input.tooth_thickness_m,
          .tip_diameter_m = input.tip_diameter_m,
          .root_diameter_m = input.root_diameter_m,
          .runout_m = input.runout_m.value_or(0.0),
          .cumulative_pitch_m = input.cumulative_pitch_m.value_or(0.0),
          .single_pitch_m = input.single_pitch_m.value_or(0.0)};
}

}  // namespace

KeyRecord thickness_allowance_record(const std::string& path) {
  return number_range(path, Unit::kMicrometre, within(-1e5, 0.0), "none",
                      "A_sni and A_sne, limits of the tooth thickness (arc on the reference "
                      "circle) from that without backlash: thinning of their middle with half "
                      "their distance as tolerance, in place of both");
}

void refuse_both(const std::string& allowance_path, const std::string& other_path,
                 FileReading& reading) {
  if (!reading.stated(allowance_path) || !reading.stated(other_path)) return;
  for (const std::string& path : {allowance_path, other_path}) {
    reading.error_at(path, fmt::format("{} and {} state the same: allowed: one of them",
                                       allowance_path, other_path));
  }
}

std::vector<Key<ToleranceInput>> gear_tolerance_keys(bool pair) {
  ToleranceKeys keys;
  keys.add_gear_keys(pair);
  return keys.keys();
}

std::vector<Key<ToleranceInput>> tolerance_keys() {
  ToleranceKeys keys;
  keys.add_gear_keys(false);
  keys.add_gearbox_keys();
  return keys.keys();
}

backlash::Tolerances stated_tolerances(const ToleranceInput& input) {
  backlash::Tolerances result{.gears = {},
                              .center_distance_m = input.center_distance_m,
                              .pin_position_m = input.pin_position_m,
                              .planet_phase_rad = input.planet_phase_rad,
                              .scatter = input.scatter,
                              .sigma_level = input.sigma_level};
  std::ranges::transform(input.gears, result.gears.begin(), stated_gear);
  return result;
}

ToleranceInput stated_input(const backlash::Tolerances& tolerances,
                            const design::Sampling& sampling) {
  ToleranceInput input{.stated = true,
                       .gears = {},
                       .center_distance_m = tolerances.center_distance_m,
                       .planet_phase_rad = tolerances.planet_phase_rad,
                       .pin_position_m = tolerances.pin_position_m,
                       .scatter = tolerances.scatter,
                       .sigma_level = tolerances.sigma_level,
                       .sampling = sampling};
  const auto length = [](double length_m) {
    return length_m > 0.0 ? std::optional(length_m) : std::nullopt;
  };
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const backlash::GearTolerances& g = tolerances.gears[i];
    input.gears[i] = {.tooth_thickness_m = g.tooth_thickness_m,
                      .tip_diameter_m = g.tip_diameter_m,
                      .root_diameter_m = g.root_diameter_m,
                      .runout_m = length(g.runout_m),
                      .cumulative_pitch_m = length(g.cumulative_pitch_m),
                      .single_pitch_m = length(g.single_pitch_m),
                      .grade = {}};
  }
  return input;
}

backlash::GearTolerances finish_gear_tolerances(const ToleranceInput::Gear& input,
                                                const GradedGear& gear, FileReading& reading) {
  backlash::GearTolerances result = stated_gear(input);
  if (input.grade && gear.module_m > 0.0 && gear.reference_diameter_m > 0.0) {
    const auto pitch = backlash::pitch_grade(
        {.module_m = gear.module_m, .reference_diameter_m = gear.reference_diameter_m},
        *input.grade);
    if (!pitch) {
      const std::string key = gear.path + ".accuracy_grade";
      reading.error_at(
          key,
          fmt::format("{} = {}: a gear of module {:.6g} mm and reference diameter {:.6g} mm; "
                      "allowed: module {:g} to {:g} mm and diameter {:g} to {:g} mm, which "
                      "ISO 1328-1:1995 covers",
                      key, *input.grade, gear.module_m * 1e3, gear.reference_diameter_m * 1e3,
                      backlash::kLeastGradedModule_m * 1e3, backlash::kGreatestGradedModule_m * 1e3,
                      backlash::kLeastGradedDiameter_m * 1e3,
                      backlash::kGreatestGradedDiameter_m * 1e3));
      return result;
    }
    if (!input.runout_m) result.runout_m = pitch->runout_m;
    if (!input.cumulative_pitch_m) result.cumulative_pitch_m = pitch->cumulative_pitch_m;
    if (!input.single_pitch_m) result.single_pitch_m = pitch->single_pitch_m;
  }
  return result;
}

}  // namespace gear3k::io
