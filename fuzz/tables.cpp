// Catalogues of motors and gearboxes, duty cycles, logs of motion and tables over time: read, or
// refused with InvalidInput, and nothing else.

#include <algorithm>
#include <functional>

#include "calibrate/dynamic/motion_windows.hpp"
#include "entry.hpp"
#include "io/files/cycle_file.hpp"
#include "io/files/motion_log_file.hpp"
#include "io/files/scenario_file.hpp"
#include "io/files/selection_file.hpp"
#include "work.hpp"

using namespace gear3k;

FUZZER(tables)(const std::uint8_t* data, std::size_t size) {
  const std::string file = "fuzz.csv";
  const std::vector<std::function<void(const std::string&)>> readers{
      [&](const std::string& text) { io::parse_motors(text, file); },
      [&](const std::string& text) { io::parse_gearboxes(text, file, 0.97); },
      [&](const std::string& text) { io::parse_cycle(text, file); },
      [&](const std::string& text) {
        io::parse_motion_log(file, text,
                             {.ratio = 96.2, .torque_constant_Nm_A = 0.05, .load_kgm2 = 0.1});
      },
      [&](const std::string& text) {
        motion::Signal signal;
        io::parse_time_table(text, file,
                             {.columns = {"torque_nm", "load_nm"}, .torque_of_load = true}, signal);
      }};
  for (const auto& read : readers) fuzz::done_or_refused(data, size, read);
  return 0;
}
