#include "app/actuator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "io/text/diagnostics.hpp"

namespace gear3k::app {

namespace {

/// Greatest load of the diagram: of the cycle, or five times what starts the output.
double greatest_load(const ActuatorRequest& request, const actuator::Reflected& reflected) {
  double most = 0.0;
  if (request.cycle) {
    for (const double load : request.cycle->load_Nm) most = std::max(most, std::abs(load));
  }
  if (most > 0.0) return most;
  constexpr double kShown = 5.0;
  const double breakaway = reflected.breakaway_Nm.value_or(0.0);
  return breakaway > 0.0 ? kShown * breakaway : 1.0;
}

}  // namespace

report::ActuatorResult analyze_actuator(const ActuatorRequest& request) {
  report::ActuatorResult result{.actuator = request.actuator,
                                .reflected = {},
                                .felt = {},
                                .felt_checks = {},
                                .cycle = {},
                                .cycle_name = {},
                                .without_each = {},
                                .impedance_task = request.impedance,
                                .impedance = {},
                                .drive_diagram = {}};
  try {
    result.reflected = actuator::reflected(request.actuator);
    if (const auto& torque = request.actuator.felt.transparency_torque_Nm) {
      result.felt = actuator::felt_torque(request.actuator, *torque);
    }
    result.felt_checks = actuator::felt_checks(request.actuator, result.reflected, result.felt);
    if (request.cycle) {
      result.cycle_name = request.cycle->name;
      result.cycle = actuator::run_cycle(request.actuator, *request.cycle, request.keep_instants);
      if (!std::isfinite(result.cycle->balance_error)) {
        throw std::runtime_error(fmt::format(
            "the energies of {} are not finite numbers: allowed: a motor and gearbox of its size",
            request.cycle->name));
      }
      if (request.without_each) {
        result.without_each =
            actuator::without_each(request.actuator, *request.cycle, *result.cycle);
      }
    }
    if (request.drive_diagram) {
      result.drive_diagram =
          actuator::drive_diagram(request.actuator, greatest_load(request, result.reflected));
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
