#include "io/keys/round_keys.hpp"

#include <utility>

namespace gear3k::io {

using optimize::RoundSteps, units::Unit;

std::vector<Key<RoundSteps>> round_keys() {
  std::vector<Key<RoundSteps>> keys;
  const auto add = [&](KeyRecord record, double RoundSteps::*member) {
    keys.push_back(make_key<RoundSteps>(std::move(record), member));
  };
  add(number("round.profile_shift", Unit::kModules, within(1e-6, 1.0), "0.01",
             "step of the profile shifts with optimize --round"),
      &RoundSteps::profile_shift);
  add(number("round.center_distance_mm", Unit::kMillimetre, within(1e-6, 10.0), "0.005",
             "step of the centre distance"),
      &RoundSteps::center_distance_m);
  add(number("round.module_mm", Unit::kMillimetre, within(1e-6, 1.0), "0.01",
             "step of a module that is in a range; those of a series, or given, stay"),
      &RoundSteps::module_m);
  add(number("round.allowance_um", Unit::kMicrometre, within(1e-3, 100.0), "1",
             "step of machining_allowance times the module"),
      &RoundSteps::allowance_m);
  add(number("round.tip_shortening", Unit::kModules, within(1e-6, 1.0), "0.01",
             "step of the tip shortenings where free.addendum or free.tip_shortening opens them"),
      &RoundSteps::tip_shortening);
  add(number("round.face_width_mm", Unit::kMillimetre, within(1e-6, 100.0), "0.1",
             "step of a face width that is refined in a range"),
      &RoundSteps::face_width_m);
  add(number("round.pressure_angle_deg", Unit::kDegree, within(1e-6, 10.0), "0.1",
             "step of a pressure angle that free.pressure_angle_deg opens"),
      &RoundSteps::pressure_angle_rad);
  return keys;
}

}  // namespace gear3k::io
