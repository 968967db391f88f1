#pragma once
// The best design for a specification, as drawn or for the gearboxes built to it.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "actuator/felt.hpp"
#include "app/co_design.hpp"
#include "app/model.hpp"
#include "design/evaluation.hpp"
#include "design/torque_angle_curve.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/pareto_search.hpp"
#include "optimize/relaxed_limits.hpp"
#include "optimize/rounding.hpp"
#include "report/limit_price_report.hpp"
#include "report/model_change_report.hpp"
#include "report/robust_report.hpp"
#include "report/search_report.hpp"

namespace gear3k::app {

struct OptimizeRequest {
  optimize::Specification spec;
  std::optional<Model> model = std::nullopt;
  std::string source = "specification";  ///< stands for the specification in messages
  bool certify = false;  ///< refine only what can still win, and prove that nothing else can
  bool round = false;    ///< seek the best design of the lattice of SPEC's [round] too
  bool explain = true;   ///< find what holds the best design back, or what would give one
};

/// A request that can be worked on, with what its model changes.
struct OptimizeTask {
  optimize::Specification spec;  ///< as it is searched
  /// As it was stated; where there is a model.
  std::optional<optimize::Specification> without_model;
  design::Limits stated_limits;  ///< what files state of a design found
  std::optional<Model> model;    ///< with what it moves the limits of lost motion by
  Notes model_notes;
  std::string unreachable;  ///< why no design can reach the lost motion; "" when one may
  std::string source;
  bool certify = false;
  bool round = false;
  bool explain = true;

  [[nodiscard]] const report::ModelUse* use() const { return model ? &model->use : nullptr; }
};

/// @throws io::InvalidInput where a certificate or a Pareto front is asked for and cannot be had
OptimizeTask optimize_task(const OptimizeRequest& request);

/// What others keep of a run, and give back to it.
struct OptimizeHooks {
  /// Sets that an earlier run of the same task refined; asked for once, before the search.
  std::function<std::vector<optimize::RefinedSet>()> known = {};
  /// Called with the sets of a wave when all of them are refined, known ones left out.
  std::function<void(std::span<const optimize::RefinedSet>)> on_wave = {};
  /// What an earlier run of the same task found of the front; asked for once, before its search.
  std::function<std::vector<optimize::FrontStep>()> front_steps = {};
  /// Called with what every further search of the front found.
  std::function<void(const optimize::FrontStep&)> on_front_step = {};
};

/// The tooth set that carries most where none carries the load.
struct CarriedTorque {
  train::ToothSet teeth;
  double torque_Nm = 0.0;  ///< at R2, with every other limit kept
};

struct Optimization {
  /// Of a specification that asks for built gearboxes.  Where it chose nothing, the rest is empty.
  std::optional<report::RobustRun> robust;
  optimize::OptimizeResult result;
  std::optional<optimize::ParetoFront> front;  ///< of several objectives
  /// The best design as files state it, and what is known of it with the task's model.
  struct Best {
    design::Design stated, design;  ///< without and with the model
    design::Evaluation evaluation;
    std::optional<design::TorqueAngleCurve> torque_angle;  ///< as Analysis::torque_angle
  };
  std::optional<Best> best;
  std::vector<design::Design> front_designs{};  ///< as files state them, of the front's points
  /// Limits of what is felt at the best design's output through the stated motor.
  std::vector<actuator::LimitCheck> felt{};
  std::optional<CoDesigned> co_design;  ///< its motor, of the objective cycle_energy
  /// What holds the best design back, and the best of every number of planets; where there is one
  /// and that was asked for.
  std::optional<report::HeldBackReport> held;
  /// What would give a design, limits of lost motion with the share of the task's model; where
  /// there is none and that was asked for.
  std::optional<optimize::RelaxedLimits> relaxed;
  std::string not_relaxed{};  ///< why that was not asked, where there is no design; else ""
  /// What can be carried, where the load blocks sets and there is no design, and that was asked
  /// for.
  std::optional<CarriedTorque> carried{};
  /// The best design rounded to what is made; where that was asked for and there is one.
  std::optional<optimize::Rounding> rounding;
  /// As files state the best of `rounding`; where it has one.
  std::optional<Best> rounded;
  /// What the task's model changes in the best design; empty without a model.
  std::optional<report::ModelComparison> comparison;
  bool interrupted = false;

  /// Whether limits were found that hold as asked; without, nothing was searched under them.
  [[nodiscard]] bool searched() const {
    return !robust || (robust->search.chosen && !robust->search.interrupted);
  }
};

/// Searches, refines, picks the best; with a model compares it with the best without the model.
/// @param task  must outlive the result; gets the limits, and the cheapest tolerances, that hold
///   for the built gearboxes
/// @param progress  may be watched, and ends the run by its `stop`, keeping what is done
/// @throws std::invalid_argument for a task whose limits are unreachable
Optimization optimize(OptimizeTask& task, const OptimizeHooks& hooks, optimize::Progress& progress);

/// The most that a tooth set of the specification carries, found by refining all of them for it;
/// empty where no limit stress is stated, no set has a design at a thousandth of the stated torque,
/// or one carries what is asked for.
/// @param progress  may be watched, and ends the search by its `stop`: empty then
std::optional<CarriedTorque> carried_torque(const optimize::Specification& spec,
                                            optimize::Progress& progress);

}  // namespace gear3k::app
