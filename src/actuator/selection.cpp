#include "actuator/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "actuator/duty_cycle.hpp"
#include "actuator/felt.hpp"
#include "actuator/reflected.hpp"
#include "actuator/screening.hpp"
#include "actuator/winding.hpp"

namespace gear3k::actuator {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Empty where nothing of it is asked for.
std::optional<Felt> felt_of(const Actuator& a) {
  if (!limits_felt(a.felt) && !a.felt.transparency_torque_Nm) return std::nullopt;
  const Reflected r = reflected(a);
  Felt felt{.inertia_kgm2 = r.speeding_up_kgm2.value_or(kUnbounded),
            .breakaway_Nm = r.breakaway_Nm.value_or(kUnbounded)};
  if (const auto& torque = a.felt.transparency_torque_Nm) {
    felt.transparency = felt_torque(a, *torque).transparency.value_or(kUnbounded);
  }
  return felt;
}

double objective_of(Objective objective, const PairResult& r) {
  switch (objective) {
    case Objective::kEnergy:
      return r.energy_J;
    case Objective::kMass:
      return r.mass_kg.value_or(kUnbounded);
    case Objective::kPeakCurrent:
      return r.peak_current_A;
    case Objective::kBreakaway:
      return r.breakaway_Nm.value_or(kUnbounded);
    case Objective::kInertia:
      break;
  }
  return r.inertia_kgm2;
}

void require_task_of(const SelectionTask& task) {
  if (task.weights.size() == task.cycles.size() && !task.cycles.empty()) return;
  throw std::invalid_argument(fmt::format("select: {} weights for {} cycles, allowed: one for each",
                                          task.weights.size(), task.cycles.size()));
}

/// The pair that misses its limits by least.
PairResult nearest_of(const SelectionTask& task, const std::vector<PairVerdict>& verdicts) {
  std::vector<std::size_t> order(verdicts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return verdicts[k].excess; });
  std::optional<PairResult> best;
  for (const std::size_t k : order) {
    if (best && !(verdicts[k].excess < best->excess)) break;
    PairResult result = run_pair(task, verdicts[k].pair);
    if (!best || result.excess < best->excess) best = result;
  }
  return *best;
}

/// A pair that its bounds do not reject.
struct Candidate {
  std::size_t verdict = 0;  ///< its place
  PairResult bound;
};

/// Verdicts of all pairs by their bounds.  @returns those that are left, the most promising first:
/// they rule out the others
std::vector<Candidate> screen(const SelectionTask& task, Selection& selection) {
  selection.verdicts.reserve(task.motors.size() * task.gearboxes.size());
  std::vector<Candidate> candidates;
  Screening screening(task);
  for (std::size_t g = 0; g < task.gearboxes.size() && !task.motors.empty(); ++g) {
    for (const PairResult& bound : screening.bounds(g)) {
      PairVerdict verdict{.pair = bound.pair, .limit = bound.limit, .excess = bound.excess};
      if (bound.excess > 0.0) {
        verdict.status = PairStatus::kInfeasible;
      } else {
        candidates.push_back({.verdict = selection.verdicts.size(), .bound = bound});
      }
      selection.verdicts.push_back(verdict);
    }
  }
  std::ranges::stable_sort(candidates, [&](const Candidate& a, const Candidate& b) {
    for (const Objective objective : task.objectives) {
      const double left = objective_of(objective, a.bound);
      const double right = objective_of(objective, b.bound);
      if (left != right) return left < right;
    }
    return false;
  });
  return candidates;
}

/// The front among pairs that were run.
class Front {
 public:
  Front(const SelectionTask& task, Selection& selection) : task_(task), selection_(selection) {}

  void consider(const Candidate& candidate) {
    PairVerdict& verdict = selection_.verdicts[candidate.verdict];
    verdict.limit.reset();
    if (beats(candidate.bound)) return;
    ++selection_.run;
    verdict.run = true;
    const PairResult result = run_pair(task_, verdict.pair);
    verdict.excess = result.excess;
    if (result.excess > 0.0) {
      verdict.status = PairStatus::kInfeasible;
      verdict.limit = result.limit;
    } else if (!beats(result)) {
      std::erase_if(members_, [&](const Member& member) {
        if (!dominates(task_, result, member.result)) return false;
        selection_.verdicts[member.verdict].status = PairStatus::kDominated;
        return true;
      });
      verdict.status = PairStatus::kFront;
      members_.push_back({.verdict = candidate.verdict, .result = result});
    }
  }
  /// In the order of the verdicts.
  void store() {
    std::ranges::sort(members_, {}, &Member::verdict);
    for (const Member& member : members_) selection_.front.push_back(member.result);
  }

 private:
  struct Member {
    std::size_t verdict;
    PairResult result;
  };
  [[nodiscard]] bool beats(const PairResult& result) const {
    return std::ranges::any_of(
        members_, [&](const Member& member) { return dominates(task_, member.result, result); });
  }

  const SelectionTask& task_;
  Selection& selection_;
  std::vector<Member> members_;
};

}  // namespace

void judge(const SelectionTask& task, const PairResult& values, double friction_W,
           PairResult& judged) {
  const CatalogueMotor& motor = task.motors[values.pair.motor];
  const CatalogueGearbox& gearbox = task.gearboxes[values.pair.gearbox];
  judged.excess = -kUnbounded;
  judged.limit.reset();
  const auto hold = [&](PairLimit limit, double value, const std::optional<double>& most) {
    if (!most) return;
    const double excess = value / *most - 1.0;
    if (!(excess > judged.excess)) return;
    judged.excess = excess;
    judged.limit = limit;
  };
  hold(PairLimit::kContinuousTorque, values.rms_torque_Nm, gearbox.continuous_Nm);
  hold(PairLimit::kIntermittentTorque, values.peak_torque_Nm, gearbox.intermittent_Nm);
  hold(PairLimit::kNominalCurrent, values.rms_current_A, motor.nominal_current_A);
  hold(PairLimit::kVoltage, values.peak_voltage_V,
       task.drive.bus_voltage_V ? task.drive.bus_voltage_V : motor.nominal_voltage_V);
  if (task.peak_current_factor && motor.nominal_current_A) {
    hold(PairLimit::kPeakCurrent, values.peak_current_A,
         *task.peak_current_factor * *motor.nominal_current_A);
  }
  hold(PairLimit::kPeakCurrent, values.peak_current_A, motor.motor.max_current_A);
  hold(PairLimit::kSpeed, values.peak_motor_speed_rad_s, motor.motor.max_speed_rad_s);
  if (values.felt) {
    hold(PairLimit::kFeltInertia, values.felt->inertia_kgm2, task.felt.max_inertia_kgm2);
    hold(PairLimit::kBreakaway, values.felt->breakaway_Nm, task.felt.max_breakaway_Nm);
    hold(PairLimit::kTransparency, values.felt->transparency.value_or(0.0),
         task.felt.max_transparency);
  }
  const double ambient_K = ambient_of(task, values.pair.motor);
  const auto state = winding_state(
      motor.motor, {.mean_square_current_A2 = values.rms_current_A * values.rms_current_A,
                    .friction_W = friction_W,
                    .ambient_K = ambient_K});
  judged.winding_K = state ? state->winding_K : std::nullopt;
  for (const auto& most : {task.max_winding_K, motor.motor.heat.max_winding_K}) {
    if (!state || !most) continue;
    // No motor is cooler than what is around it.
    const double room_K = *most - ambient_K;
    const bool kept = !state->runaway && room_K > 0.0;
    hold(PairLimit::kWinding, kept ? *state->winding_K - ambient_K : kUnbounded,
         kept ? room_K : 1.0);
  }
}

double ambient_of(const SelectionTask& task, std::size_t motor) {
  return task.motors[motor].ambient_K.value_or(task.ambient_K);
}

std::vector<Unknown> unknown_of(const SelectionTask& task, const Pair& pair) {
  const CatalogueMotor& motor = task.motors[pair.motor];
  const CatalogueGearbox& gearbox = task.gearboxes[pair.gearbox];
  const MotorHeat& heat = motor.motor.heat;
  std::vector<Unknown> unknown;
  const auto add = [&](bool known, Unknown what) {
    if (!known) unknown.push_back(what);
  };
  add(motor.friction_known, Unknown::kMotorFriction);
  add(motor.nominal_current_A.has_value(), Unknown::kNominalCurrent);
  add(gearbox.continuous_Nm && gearbox.intermittent_Nm, Unknown::kGearboxTorque);
  add(heat.winding_ambient_K_W || (heat.winding_housing_K_W && heat.housing_ambient_K_W),
      Unknown::kWinding);
  add(motor.motor.mass_kg && gearbox.gearbox.mass_kg, Unknown::kMass);
  // Without any friction none of its parts is known: said once.
  add(motor.coulomb_known || !motor.friction_known, Unknown::kMotorCoulomb);
  add(gearbox.gearbox.static_Nm > 0.0, Unknown::kGearboxDrag);
  add(motor.inertia_known, Unknown::kRotorInertia);
  add(gearbox.inertia_known, Unknown::kGearboxInertia);
  add(task.drive.bus_voltage_V || motor.nominal_voltage_V, Unknown::kVoltage);
  return unknown;
}

bool dominates(const SelectionTask& task, const PairResult& a, const PairResult& b) {
  bool better = false;
  for (const Objective objective : task.objectives) {
    const double left = objective_of(objective, a);
    const double right = objective_of(objective, b);
    if (left > right) return false;
    better = better || left < right;
  }
  return better;
}

PairResult run_pair(const SelectionTask& task, const Pair& pair) {
  return run_actuator(task, pair, actuator_of(task, pair));
}

PairResult run_actuator(const SelectionTask& task, const Pair& pair, const Actuator& a) {
  require_task_of(task);
  const double time_s = total_time(task);
  PairResult r{.pair = pair};
  set_constants(a.motor, a.gearbox, chain_of(a), r);
  double square = 0.0;
  double friction = 0.0;
  double mesh = 0.0;
  for (std::size_t k = 0; k < task.cycles.size(); ++k) {
    const DutyCycle d = run_cycle(a, task.cycles[k]);
    const CycleMoments m = cycle_moments(a, pieces_of(task.cycles[k]));
    r.energy_J += task.weights[k] * (d.drawn_J - d.regenerated_J);
    square += task.weights[k] * d.rms_current_A * d.rms_current_A * d.period_s;
    for (const LossEnergy& loss : d.losses) {
      if (loss.cause.starts_with("motor_")) friction += task.weights[k] * loss.energy_J;
    }
    r.peak_current_A = std::max(r.peak_current_A, d.peak_current_A);
    r.peak_voltage_V = std::max(r.peak_voltage_V, d.peak_voltage_V);
    r.peak_motor_speed_rad_s = std::max(r.peak_motor_speed_rad_s, d.peak_motor_speed_rad_s);
    mesh += task.weights[k] * m.square_mesh;
    r.peak_torque_Nm = std::max(r.peak_torque_Nm, m.peak_mesh_Nm);
  }
  r.rms_current_A = std::sqrt(square / time_s);
  r.rms_torque_Nm = std::sqrt(mesh / time_s);
  r.felt = felt_of(a);
  if (a.train != nullptr) {
    const Reflected felt = reflected(a);
    r.breakaway_Nm = felt.breakaway_Nm;
    r.inertia_kgm2 = felt.motor_kgm2 + felt.gearbox_kgm2;
  }
  judge(task, r, friction / time_s, r);
  return r;
}

Selection select(const SelectionTask& task) {
  require_task_of(task);
  Selection selection;
  const std::vector<Candidate> candidates = screen(task, selection);
  Front front(task, selection);
  for (const Candidate& candidate : candidates) front.consider(candidate);
  front.store();
  for (const PairVerdict& verdict : selection.verdicts) {
    if (verdict.status == PairStatus::kInfeasible && verdict.limit) {
      ++selection.rejected[static_cast<std::size_t>(*verdict.limit)];
    }
  }
  if (selection.front.empty() && !selection.verdicts.empty()) {
    selection.nearest = nearest_of(task, selection.verdicts);
  }
  return selection;
}

}  // namespace gear3k::actuator
