#include "optimize/empty_stage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace gear3k::optimize {

namespace {

using design::CheckId;

/// Checks that an empty stage may be owed to, in the order in which they are tried.
constexpr std::array<CheckId, 2> kLoadChecks{CheckId::kFlankSafety, CheckId::kRootSafety};
constexpr std::array<CheckId, 8> kStageChecks{
    CheckId::kContactRatioMin, CheckId::kOutputBacklashMax,    CheckId::kNormalBacklash,
    CheckId::kSpecificSliding, CheckId::kInvoluteInterference, CheckId::kPlanetGap,
    CheckId::kRootClearance,   CheckId::kContactRatioMax};

/// The task with a check's limit given way by an amount, in its own unit but for the backlash:
/// normal backlash in modules, lost motion in modules of the ring mesh's backlash.
StageTask without(StageTask task, CheckId check, double amount) {
  switch (check) {
    case CheckId::kContactRatioMin:
      task.contact_ratio.lo -= amount;
      break;
    case CheckId::kContactRatioMax:
      task.contact_ratio.hi += amount;
      break;
    case CheckId::kOutputBacklashMax:
      task.ring_backlash.hi += amount;
      if (task.lost_motion) {
        task.lost_motion->most += amount * task.lost_motion->ring;
        task.sun_backlash.hi += amount * task.lost_motion->ring / task.lost_motion->sun;
      }
      break;
    case CheckId::kNormalBacklash:
      task.ring_backlash.lo -= amount;
      task.sun_backlash.lo -= amount;
      break;
    case CheckId::kSpecificSliding:
      if (task.rolling_share) task.rolling_share = 1.0 / (1.0 / *task.rolling_share + amount);
      break;
    case CheckId::kInvoluteInterference:
      if (task.interference) *task.interference -= amount;
      break;
    case CheckId::kRootClearance:
      if (task.root_clearance) *task.root_clearance -= amount;
      break;
    case CheckId::kPlanetGap:
      if (task.planet_gap) task.planet_gap->half_gap -= 0.5 * amount;
      break;
    case CheckId::kFlankSafety: {
      // The least safety gives way by the largest share.
      const double left = std::max(0.0, 1.0 - amount / task.flank_safety);
      for (strength::FlankNeed* need : {&task.sun_flank, &task.ring_flank}) {
        for (double& load : need->load_m2) load = left > 0.0 ? load * left * left : 0.0;
      }
      break;
    }
    case CheckId::kRootSafety: {
      const double left = std::max(0.0, 1.0 - amount / task.root_safety);
      StageRoots& r = task.roots;
      for (strength::RootNeed* need : {&r.sun, &r.planet_of_sun, &r.planet_of_ring}) {
        need->load_m2 = left > 0.0 ? need->load_m2 * left : 0.0;
      }
      break;
    }
    default:
      break;
  }
  return task;
}

/// An amount in SI and scaled to order 1.
struct Amount {
  double si, scaled;
};

/// @param stage  0 or 1
Amount amount_of(const Specification& spec, const StageTask& task, CheckId check, double amount,
                 std::size_t stage) {
  switch (check) {
    case CheckId::kRootClearanceLength: {
      const double length = amount * module_range(spec.module[stage]).lo;
      const double limit = *spec.limits[check];
      return {length, length / (limit > 0.0 ? limit : length_scale_m(spec))};
    }
    case CheckId::kNormalBacklash: {
      const double length = amount * module_range(spec.module[stage]).lo;
      return {length, length / length_scale_m(spec)};
    }
    case CheckId::kOutputBacklashMax: {
      const double half_cos = 0.5 * std::cos(spec.pressure_angle_rad);
      // The shares of the ring meshes are at most 1/r_b of their rings, §8.
      const double angle =
          amount * (task.lost_motion ? task.lost_motion->ring : 1.0 / (half_cos * task.ring.teeth));
      const double limit = spec.limits[check].value_or(0.0);
      return {angle, limit > 0.0 ? angle / limit : angle};
    }
    case CheckId::kPlanetGap: {
      // In modules of stage 1.
      const double gap =
          stage == 0 ? amount
                     : amount * module_range(spec.module[1]).lo / module_range(spec.module[0]).hi;
      return {gap, gap};
    }
    default:
      return {amount, amount};
  }
}

/// Of root clearances the one whose length asks for more than its modules do.
CheckId named(const Specification& spec, CheckId check, std::size_t stage) {
  const auto& length = spec.limits[CheckId::kRootClearanceLength];
  if (check != CheckId::kRootClearance || !length) return check;
  const double modules = *length / module_range(spec.module[stage]).hi;
  const bool longer = modules > spec.limits[check].value_or(-kInfinity);
  return longer ? CheckId::kRootClearanceLength : check;
}

}  // namespace

bool is_load(CheckId check) { return std::ranges::find(kLoadChecks, check) != kLoadChecks.end(); }

Infeasibility name_empty_stage(const Specification& spec, const StageTask& empty, std::size_t stage,
                               const StageEffort& effort) {
  constexpr double kDropped = 1e3;
  // What is empty without its load is named as without it.
  StageTask unloaded = empty;
  for (const CheckId check : kLoadChecks) unloaded = without(unloaded, check, kDropped);
  const bool loaded = !relax_stage(unloaded, effort).empty;
  const StageTask& task = loaded ? empty : unloaded;
  const auto empty_without = [&](const StageTask& t, CheckId check, double amount) {
    return relax_stage(without(t, check, amount), effort).empty;
  };
  using Checks = std::span<const CheckId>;
  const Checks checks = loaded ? Checks(kLoadChecks) : Checks(kStageChecks);
  for (const CheckId check : checks) {
    if (empty_without(task, check, kDropped)) continue;
    double proven = 0.0;  // still empty with so much
    double step = 0.5;
    while (proven + step < kDropped && empty_without(task, check, proven + step)) {
      proven += step;
      step *= 2.0;
    }
    for (step *= 0.5; step > 1e-4; step *= 0.5) {
      if (empty_without(task, check, proven + step)) proven += step;
    }
    const CheckId name = named(spec, check, stage);
    const Amount amount = amount_of(spec, task, name, proven, stage);
    return {.check = name, .miss_si = amount.si, .violation = amount.scaled};
  }
  if (loaded) return {.check = CheckId::kFlankSafety, .alone = false};
  StageTask rest = task;
  for (const CheckId check : kStageChecks) {
    rest = without(rest, check, kDropped);
    if (!relax_stage(rest, effort).empty) {
      return {.check = named(spec, check, stage), .alone = false};
    }
  }
  // The shifts' range itself: undercut, thin tips and the stated range.
  return {.check = CheckId::kUndercut, .alone = false};
}

}  // namespace gear3k::optimize
