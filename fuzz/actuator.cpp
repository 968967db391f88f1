// `actuator` on any ACTUATOR and duty cycle: the file, a line "---", and CYCLE.csv.

#include "app/actuator.hpp"

#include "entry.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/cycle_file.hpp"
#include "report/actuator_plot.hpp"
#include "work.hpp"

using namespace gear3k;

FUZZER(actuator)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, [](const std::string& text) {
    const auto files = fuzz::both_files(text);
    const app::ActuatorRequest request{
        .actuator = io::parse_actuator(files.first, fuzz::kNameAmongActuators),
        .source = fuzz::kName,
        .cycle = io::parse_cycle(files.second, "fuzz.csv"),
        .impedance = std::nullopt,
        .without_each = true,
        .keep_instants = true,
        .drive_diagram = true};
    const report::ActuatorResult result = app::analyze_actuator(request);
    fuzz::write(report::actuator_json(result));
    report::actuator_table(result);
    report::actuator_cycle_csv(*result.cycle);
  });
}
