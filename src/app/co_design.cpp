#include "app/co_design.hpp"

#include <algorithm>
#include <memory>
#include <set>

#include "actuator/design_gear.hpp"
#include "actuator/duty_cycle.hpp"
#include "actuator/felt.hpp"
#include "actuator/reflected.hpp"
#include "optimize/refined_set.hpp"

namespace gear3k::app {

namespace {

constexpr std::size_t kMotorsShown = 5;
/// Ratios at which a motor is looked for where none suits.
constexpr std::size_t kMostRatios = 500;

}  // namespace

CoDesigned co_designed(const optimize::Specification& spec, const optimize::OptimizeResult& result,
                       const design::Design& design) {
  const actuator::CoDesign& co_design = *actuator::co_design_of(spec.cycle_energy.get());
  const actuator::SelectionTask& task = co_design.task();
  const optimize::RefinedSet& set = *result.best;
  const double ratio = train::ratio(set.candidate.teeth);
  CoDesigned found;
  auto train = std::make_shared<actuator::DesignTrain>(design);
  const bool inertia = set.cycle_energy_J.has_value();
  std::vector<actuator::PairResult> motors;
  for (std::size_t k = 0; k < task.motors.size(); ++k) {
    motors.push_back(
        inertia ? co_design.run(k, train)
                : co_design.run(k, {.ratio = ratio, .forward = set.eta_f, .backward = set.eta_b}));
  }
  const std::size_t chosen = optimize::energy_of(spec, set).motor;
  std::erase_if(motors, [&](const actuator::PairResult& r) {
    return r.excess > 0.0 && r.pair.motor != chosen;
  });
  std::ranges::stable_sort(motors, {}, [&](const actuator::PairResult& r) {
    return std::pair(r.pair.motor != chosen, r.energy_J);
  });
  motors.resize(std::min(motors.size(), kMotorsShown));
  report::CoDesignReport& report = found.report;
  for (const actuator::PairResult& r : motors) {
    auto unknown = actuator::unknown_of(task, {.motor = r.pair.motor, .gearbox = 0});
    std::erase_if(unknown, [](actuator::Unknown what) {
      return what == actuator::Unknown::kGearboxTorque || what == actuator::Unknown::kMass ||
             what == actuator::Unknown::kGearboxDrag || what == actuator::Unknown::kGearboxInertia;
    });
    report.motors.push_back(
        {.result = r, .name = task.motors[r.pair.motor].name, .unknown = std::move(unknown)});
  }
  report.motors_considered = task.motors.size();
  report.cycles = task.cycles.size();
  report.peak_torque_Nm = co_design.peak_mesh_nm();
  report.rms_torque_Nm = co_design.rms_mesh_nm();
  if (spec.rating) report.stated_torque_Nm = spec.rating->torque_Nm;
  if (result.certificate) report.bound_J = -result.certificate->global_bound;

  report.gear_inertia = train->inertia_kgm2() > 0.0;
  found.actuator = {.name = spec.name,
                    .motor = task.motors[chosen].motor,
                    .gearbox = {.ratio = train->ratio(),
                                .stiffness_Nm_rad = train->stiffness_nm_rad(),
                                .backlash_rad = train->backlash_rad(),
                                .mass_kg = train->mass_kg()},
                    .drive = task.drive,
                    .load_inertia_kgm2 = task.load_inertia_kgm2,
                    .felt = task.felt,
                    .train = train};
  actuator::MotorHeat& heat = found.actuator.motor.heat;
  heat.ambient_K = actuator::ambient_of(task, chosen);
  if ((heat.winding_housing_K_W || heat.winding_ambient_K_W) && task.max_winding_K) {
    heat.max_winding_K =
        std::min(*task.max_winding_K, heat.max_winding_K.value_or(*task.max_winding_K));
  }
  const actuator::CatalogueMotor& motor = task.motors[chosen];
  if (!found.actuator.drive.bus_voltage_V) {
    found.actuator.drive.bus_voltage_V = motor.nominal_voltage_V;
  }
  if (task.peak_current_factor && motor.nominal_current_A && !motor.motor.max_current_A) {
    found.actuator.motor.max_current_A = *task.peak_current_factor * *motor.nominal_current_A;
  }
  std::optional<actuator::FeltTorque> felt;
  if (const auto& torque = task.felt.transparency_torque_Nm) {
    felt = actuator::felt_torque(found.actuator, *torque);
  }
  // Limits that are constraints of the search are shown with it.
  if (!spec.felt) {
    report.felt_checks =
        actuator::felt_checks(found.actuator, actuator::reflected(found.actuator), felt);
  }
  for (std::size_t k = 0; k < task.cycles.size(); ++k) {
    const actuator::DutyCycle d = actuator::run_cycle(found.actuator, task.cycles[k]);
    report.run_J += task.weights[k] * (d.drawn_J - d.regenerated_J);
  }
  return found;
}

std::optional<actuator::PairResult> nearest_motor(const optimize::Specification& spec,
                                                  const optimize::OptimizeResult& result) {
  const actuator::CoDesign* const co_design = actuator::co_design_of(spec.cycle_energy.get());
  if (co_design == nullptr || result.best) return std::nullopt;
  std::optional<actuator::PairResult> nearest;
  const auto offer = [&](double ratio, double eta_f, double eta_b) {
    const optimize::EnergyGearbox g{.ratio = ratio, .forward = eta_f, .backward = eta_b};
    const actuator::PairResult r = co_design->run(spec.cycle_energy->at(g).motor, g);
    if (!nearest || r.excess < nearest->excess) nearest = r;
  };
  for (const optimize::RefinedSet& set : result.refined) {
    if (!optimize::has_design(set.status)) continue;
    offer(train::ratio(set.candidate.teeth), set.eta_f, set.eta_b);
  }
  // None was refined where the bounds leave no motor: gearboxes without losses, then.
  std::set<double> ratios;
  for (std::size_t k = 0; k < result.search.candidates.size() && result.refined.empty(); ++k) {
    const optimize::Candidate& candidate = result.search.candidates[k];
    if (!result.bounds || result.bounds->of(k).infeasible) continue;
    ratios.insert(train::ratio(candidate.teeth));
  }
  const std::size_t step = 1 + ratios.size() / kMostRatios;
  std::size_t n = 0;
  for (const double ratio : ratios) {
    if (n++ % step == 0) offer(ratio, 1.0, 1.0);
  }
  return nearest;
}

}  // namespace gear3k::app
