// `simulate` of any ACTUATOR in any SCENARIO: the file, a line "---", and the other one.

#include "app/simulate.hpp"

#include <stdexcept>

#include "entry.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/scenario_file.hpp"
#include "work.hpp"

using namespace gear3k;

namespace {

void simulate(const std::string& text) {
  const auto files = fuzz::both_files(text);
  app::SimulateRequest request{
      .actuator = io::parse_actuator(files.first, fuzz::kNameAmongActuators),
      .source = fuzz::kName,
      .scenario = io::parse_scenario(files.second, fuzz::kNameAmongActuators).scenario};
  motion::Scenario& scenario = request.scenario;
  scenario.solver.max_steps = std::min<std::int64_t>(scenario.solver.max_steps, 500);
  scenario.solver.max_events = std::min<std::int64_t>(scenario.solver.max_events, 50);
  scenario.sample_s = std::max(scenario.sample_s.value_or(0.0), scenario.duration_s / 50.0);
  try {
    const report::MotionResult result = app::simulate(request);
    fuzz::write(report::motion_json(result));
    report::motion_csv(result);
    report::motion_events_csv(result);
    report::motion_table(result);
  } catch (const io::InvalidInput&) {
    throw;
  } catch (const std::runtime_error&) {
    // The integration finds no way on: exit code 4.
  }
}

}  // namespace

FUZZER(simulate)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, simulate);
}
