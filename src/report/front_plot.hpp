#pragma once
// Figures of Pareto fronts.

#include <string>
#include <vector>

#include "actuator/selection.hpp"
#include "optimize/pareto_search.hpp"
#include "report/plot.hpp"

namespace gear3k::report {

/// The front as pareto.svg: the first objective over each other one, in their units; with three or
/// more the next objective as colour.
Plot pareto_plot(const optimize::Specification& spec, const optimize::ParetoFront& front);

/// The same of pairs of motor and gearbox.
Plot selection_plot(const actuator::SelectionTask& task, const actuator::Selection& selection);

}  // namespace gear3k::report
