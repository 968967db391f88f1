#include "optimize/objective.hpp"

#include <numbers>

namespace gear3k::optimize {

namespace {

constexpr std::array<ObjectiveRecord, kObjectiveCount> kRecords{
    {{.id = Objective::kBackwardEfficiency,
      .name = "backward_efficiency",
      .title = "eta backward",
      .maximise = true,
      .unit = "",
      .per_unit = 1.0,
      .help = "efficiency when R2 drives the sun"},
     {.id = Objective::kForwardEfficiency,
      .name = "forward_efficiency",
      .title = "eta forward",
      .maximise = true,
      .unit = "",
      .per_unit = 1.0,
      .help = "efficiency when the sun drives R2"},
     {.id = Objective::kLostMotion,
      .name = "lost_motion",
      .title = "lost motion",
      .maximise = false,
      .unit = "arcmin",
      .per_unit = std::numbers::pi / 180.0 / 60.0,
      .help = "lost motion at the output by backlash.model"},
     {.id = Objective::kOuterDiameter,
      .name = "outer_diameter",
      .title = "outer diameter",
      .maximise = false,
      .unit = "mm",
      .per_unit = 1e-3,
      .help = "root diameter of the larger ring plus both sides of its rim"},
     {.id = Objective::kInertia,
      .name = "inertia",
      .title = "inertia",
      .maximise = false,
      .unit = "kgm2",
      .per_unit = 1.0,
      .help = "effective inertia of the gears at the output, without losses"},
     {.id = Objective::kMass,
      .name = "mass",
      .title = "mass",
      .maximise = false,
      .unit = "kg",
      .per_unit = 1.0,
      .help = "mass of sun, planets and both rings"},
     {.id = Objective::kRatioError,
      .name = "ratio_error",
      .title = "ratio error",
      .maximise = false,
      .unit = "",
      .per_unit = 1.0,
      .help = "|ratio/target - 1|"}}};

}  // namespace

std::span<const ObjectiveRecord> objective_records() { return kRecords; }

const ObjectiveRecord& objective_record(Objective objective) {
  return kRecords[static_cast<std::size_t>(objective)];
}

}  // namespace gear3k::optimize
