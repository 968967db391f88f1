// `analyze` on any DESIGN, in every format.

#include "app/analyze.hpp"

#include "entry.hpp"
#include "io/files/design_file.hpp"
#include "report/analysis_report.hpp"
#include "work.hpp"

using namespace gear3k;

FUZZER(analyze)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, [](const std::string& text) {
    design::Design design = io::parse_design(text, fuzz::kName);
    design.sampling.samples = std::min<std::int64_t>(design.sampling.samples, 100);
    const app::Analysis a = app::analyze({.design = design, .source = fuzz::kName});
    const design::BuiltSeries* built = a.series ? &*a.series : nullptr;
    fuzz::write(report::analysis_json(a.evaluation, a.sensitivities, nullptr, built));
    report::analysis_csv(a.evaluation, a.sensitivities, built);
    report::analysis_table(a.evaluation, a.sensitivities, nullptr, built);
  });
}
