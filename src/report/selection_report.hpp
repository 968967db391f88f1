#pragma once
// A selection of motors and gearboxes: CSV, JSON, table.

#include <string>

#include "actuator/selection.hpp"
#include "design/design.hpp"

namespace gear3k::report {

/// A gearbox of a selection that was designed for it.
struct MadeGearbox {
  std::size_t gearbox = 0;  ///< its place in the task
  design::Design design;
};

/// A row for every pair, with the reason of each rejection.
std::string selection_csv(const actuator::SelectionTask& task,
                          const actuator::Selection& selection);
/// The front.
std::string selection_front_csv(const actuator::SelectionTask& task,
                                const actuator::Selection& selection);
io::Json selection_json(const actuator::SelectionTask& task, const actuator::Selection& selection);
std::string selection_table(const actuator::SelectionTask& task,
                            const actuator::Selection& selection);
/// By how much a limit is exceeded: " by 12 % of the limit"; a share without bound (a winding that
/// heats up without end, an output that cannot drive) as that.
std::string excess_text(double share);
/// What keeps every pair from being feasible, and by how much the nearest misses it; "" where a
/// pair is.
std::string selection_blocking_text(const actuator::SelectionTask& task,
                                    const actuator::Selection& selection);

}  // namespace gear3k::report
