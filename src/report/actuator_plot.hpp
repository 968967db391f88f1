#pragma once

#include <array>
#include <string>
#include <vector>

#include "report/actuator_report.hpp"
#include "report/plot.hpp"

namespace gear3k::report {

/// A figure of an actuator with its numbers.
struct ActuatorFigure {
  Plot plot;
  std::string csv;  ///< of the file of its name
};

/// Names of all figures, whether or not a result has them.
inline constexpr std::array<const char*, 4> kActuatorFigures{"power", "ledger", "impedance",
                                                             "drive_backdrive"};

/// Power over the cycle, the ledger with what each cause costs, |Z| and phase, and which motor
/// torques drive, hold, or are driven; each where the result has it.
std::vector<ActuatorFigure> actuator_figures(const ActuatorResult& result);

}  // namespace gear3k::report
