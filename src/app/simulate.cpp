#include "app/simulate.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "io/text/diagnostics.hpp"

namespace gear3k::app {

report::MotionResult simulate(const SimulateRequest& request) {
  report::MotionResult result{
      .actuator = request.actuator, .scenario = request.scenario, .motion = {}};
  try {
    result.motion = motion::simulate(request.actuator, request.scenario);
  } catch (const std::invalid_argument& error) {
    throw io::InvalidInput(fmt::format("{}: {}", request.source, error.what()));
  }
  return result;
}

}  // namespace gear3k::app
