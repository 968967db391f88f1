// `tolerances` on any DESIGN with few gearboxes, in every format, with its figures' scripts.

#include "app/tolerances.hpp"

#include "entry.hpp"
#include "io/files/design_file.hpp"
#include "report/built_series_report.hpp"
#include "report/tolerance_report.hpp"
#include "report/turn_plot.hpp"
#include "report/turn_report.hpp"
#include "work.hpp"

using namespace gear3k;

FUZZER(tolerances)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, [](const std::string& text) {
    design::Design design = io::parse_design(text, fuzz::kName);
    design.sampling.samples = std::min<std::int64_t>(design.sampling.samples, 20);
    optimize::Progress progress;
    const app::Tolerances t = app::tolerances({.design = design, .source = fuzz::kName}, progress);
    report::tolerance_table(t.evaluation.tolerance_limits);
    fuzz::write(report::tolerances_json(t.evaluation, t.series));
    report::built_series_table(t.series);
    report::lost_motion_histogram_csv(t.series);
    report::tolerance_shares_csv(t.series);
    report::turn_csv(t.turn);
    report::turn_orders_csv(t.turn);
    report::turn_table(t.turn);
    report::lost_motion_plot(design.name, t.series);
    report::tolerance_shares_plot(design.name, t.series);
  });
}
