#pragma once
// The motor that was chosen with the best gearbox of a search.

#include <optional>

#include "actuator/actuator.hpp"
#include "actuator/co_design.hpp"
#include "optimize/optimizer.hpp"
#include "report/co_design_report.hpp"

namespace gear3k::app {

/// An actuator with its gearbox, and what is told of it.
struct CoDesigned {
  actuator::Actuator actuator;
  report::CoDesignReport report;
};

/// The motor of the best set.
/// @param design  of that set, as files state it
CoDesigned co_designed(const optimize::Specification& spec, const optimize::OptimizeResult& result,
                       const design::Design& design);

/// The motor that misses its limits by least with any refined gearbox, or where the bounds left
/// none to refine with one without losses; empty where no gearbox is feasible or a motor is within
/// them.
std::optional<actuator::PairResult> nearest_motor(const optimize::Specification& spec,
                                                  const optimize::OptimizeResult& result);

}  // namespace gear3k::app
