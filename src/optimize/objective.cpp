#include "optimize/objective.hpp"

#include <cmath>
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
      .resolution = 1e-8,
      .help = "efficiency when R2 drives the sun"},
     {.id = Objective::kForwardEfficiency,
      .name = "forward_efficiency",
      .title = "eta forward",
      .maximise = true,
      .unit = "",
      .per_unit = 1.0,
      .resolution = 1e-8,
      .help = "efficiency when the sun drives R2"},
     {.id = Objective::kLostMotion,
      .name = "lost_motion",
      .title = "lost motion",
      .maximise = false,
      .unit = "arcmin",
      .per_unit = std::numbers::pi / 180.0 / 60.0,
      .resolution = 1e-5 * std::numbers::pi / 180.0 / 60.0,
      .help = "lost motion at the output by backlash.model"},
     {.id = Objective::kOuterDiameter,
      .name = "outer_diameter",
      .title = "outer diameter",
      .maximise = false,
      .unit = "mm",
      .per_unit = 1e-3,
      .resolution = 1e-9,
      .help = "root diameter of the larger ring plus both sides of its rim"},
     {.id = Objective::kInertia,
      .name = "inertia",
      .title = "inertia",
      .maximise = false,
      .unit = "kgm2",
      .per_unit = 1.0,
      .resolution = 1e-11,
      .help = "effective inertia of the gears at the output, without losses"},
     {.id = Objective::kMass,
      .name = "mass",
      .title = "mass",
      .maximise = false,
      .unit = "kg",
      .per_unit = 1.0,
      .resolution = 1e-8,
      .help = "mass of sun, planets and both rings"},
     {.id = Objective::kRatioError,
      .name = "ratio_error",
      .title = "ratio error",
      .maximise = false,
      .unit = "",
      .per_unit = 1.0,
      .resolution = 1e-12,
      .help = "|ratio/target - 1|"},
     {.id = Objective::kTorqueCapacity,
      .name = "torque_capacity",
      .title = "torque capacity",
      .maximise = true,
      .unit = "Nm",
      .per_unit = 1.0,
      .resolution = 1e-6,
      .help = "output torque at which the first tooth reaches its least safety, driven either way"},
     {.id = Objective::kTorqueDensity,
      .name = "torque_density",
      .title = "torque density",
      .maximise = true,
      .unit = "Nm/kg",
      .per_unit = 1.0,
      .resolution = 1e-6,
      .help = "torque capacity over the mass of sun, planets and both rings"},
     {.id = Objective::kTorsionalStiffness,
      .name = "torsional_stiffness",
      .title = "torsional stiffness",
      .maximise = true,
      .unit = "Nm/rad",
      .per_unit = 1.0,
      .resolution = 1e-2,
      .help = "of the output against the locked sun, at the stated torque"},
     {.id = Objective::kCycleEnergy,
      .name = "cycle_energy",
      .title = "cycle energy",
      .maximise = false,
      .unit = "J",
      .per_unit = 1.0,
      .resolution = 1e-8,
      .help = "energy of the cycles of [cycle] with the best motor of [actuator]"}}};

}  // namespace

std::span<const ObjectiveRecord> objective_records() { return kRecords; }

const ObjectiveRecord& objective_record(Objective objective) {
  return kRecords[static_cast<std::size_t>(objective)];
}

double cost_in_steps(Objective objective, double value) {
  return -sense_of(objective) * std::round(value / objective_record(objective).resolution);
}

}  // namespace gear3k::optimize
