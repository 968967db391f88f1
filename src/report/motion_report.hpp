#pragma once
// A simulated motion: its rows, events, ledger and summary.

#include <string>

#include "actuator/actuator.hpp"
#include "io/text/json.hpp"
#include "motion/scenario.hpp"
#include "motion/simulate.hpp"
#include "report/plot.hpp"

namespace gear3k::report {

struct MotionResult {
  actuator::Actuator actuator;
  motion::Scenario scenario;
  motion::Motion motion;
};

/// A row for each instant: both sides, mode, flow, torques, current and voltage.
std::string motion_csv(const MotionResult& result);
/// A row for each event, with the modes before and after it.
std::string motion_events_csv(const MotionResult& result);
/// The ledger of energy with all that sums the run up.
io::Json motion_json(const MotionResult& result);
std::string motion_table(const MotionResult& result);

/// Angle, speed and torques over time; what is behind them tells the mode.
Plot motion_plot(const MotionResult& result);

}  // namespace gear3k::report
