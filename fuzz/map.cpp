// `map` on any DESIGN over few points, in every format, with its figures' scripts.

#include "app/map.hpp"

#include "entry.hpp"
#include "io/files/design_file.hpp"
#include "report/map_plot.hpp"
#include "report/map_report.hpp"
#include "work.hpp"

using namespace gear3k;

FUZZER(map)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, [](const std::string& text) {
    design::Design design = io::parse_design(text, fuzz::kName);
    for (design::GridAxis* axis : {&design.map.sun_speed_rad_s, &design.map.output_torque_Nm}) {
      axis->points = std::min(axis->points, 3);
    }
    const design::OperatingMap map = app::map({.design = design, .source = fuzz::kName}).map;
    fuzz::write(report::map_json(map, nullptr));
    report::map_csv(map);
    report::map_table(map, nullptr);
    report::map_plots(map);
  });
}
