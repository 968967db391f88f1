#include "app/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "actuator/design_gear.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::app {

report::MotionResult simulate(const SimulateRequest& request,
                              const motion::MotionProgress& progress) {
  report::MotionResult result{
      .actuator = request.actuator, .scenario = request.scenario, .motion = {}};
  try {
    result.motion = motion::simulate(request.actuator, request.scenario, progress);
  } catch (const std::invalid_argument& error) {
    throw io::InvalidInput(fmt::format("{}: {}", request.source, error.what()));
  }
  if (request.actuator.train) {
    std::ranges::move(actuator::notes_of(*request.actuator.train),
                      std::back_inserter(result.motion.notes));
  }
  return result;
}

}  // namespace gear3k::app
