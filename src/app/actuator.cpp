#include "app/actuator.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "io/text/diagnostics.hpp"

namespace gear3k::app {

report::ActuatorResult analyze_actuator(const ActuatorRequest& request) {
  report::ActuatorResult result{.actuator = request.actuator,
                                .reflected = {},
                                .cycle = {},
                                .cycle_name = {},
                                .without_each = {},
                                .impedance_task = request.impedance,
                                .impedance = {}};
  try {
    result.reflected = actuator::reflected(request.actuator);
    if (request.cycle) {
      result.cycle_name = request.cycle->name;
      result.cycle = actuator::run_cycle(request.actuator, *request.cycle, request.keep_instants);
      if (request.without_each) {
        result.without_each =
            actuator::without_each(request.actuator, *request.cycle, *result.cycle);
      }
    }
    if (request.impedance) {
      result.impedance = actuator::impedance(request.actuator, *request.impedance);
    }
  } catch (const std::runtime_error& error) {
    throw io::InvalidInput(fmt::format("{}: {}", request.source, error.what()));
  }
  return result;
}

}  // namespace gear3k::app
