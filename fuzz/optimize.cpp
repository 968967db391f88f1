// `optimize` on any SPEC with few tooth sets: its result files, and that best.toml is read back.

#include "app/optimize.hpp"

#include "entry.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "report/search_report.hpp"
#include "work.hpp"

using namespace gear3k;

namespace {

constexpr std::uint64_t kMostSets = 3;

void optimize_and_report(const optimize::Specification& spec) {
  optimize::Progress progress;
  if (optimize::search_teeth(spec, progress).candidate_count() > kMostSets) return;
  app::OptimizeTask task = app::optimize_task({.spec = spec, .source = fuzz::kName});
  if (!task.unreachable.empty()) return;
  const app::Optimization o = app::optimize(task, {}, progress);
  if (!o.searched()) {
    report::robust_blocking_text(task.spec, o.robust->search);
    return;
  }
  const report::ResultTally tally = report::tally_of(o.result);
  const report::RefinedColumns columns = report::refined_columns(task.spec);
  report::write_refined_csv(o.result, columns, [](std::string_view) {});
  report::pareto_csv(o.result, columns);
  if (o.front) {
    report::pareto_csv(task.spec, *o.front);
    report::pareto_table(task.spec, *o.front);
  }
  report::summary_json(task.spec, o.result, tally, {}, nullptr, o.front ? &*o.front : nullptr,
                       o.robust ? &*o.robust : nullptr);
  if (o.robust) report::robust_table(task.spec, *o.robust);
  if (o.co_design) fuzz::write(report::co_design_json(o.co_design->report));
  app::nearest_motor(task.spec, o.result);
  if (o.best) {
    io::parse_design(io::design_text(o.best->stated), "best.toml");
  } else {
    report::blocking_text(task.spec, o.result, tally);
  }
}

}  // namespace

FUZZER(optimize)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, [](const std::string& text) {
    optimize_and_report(
        fuzz::with_little_work(io::parse_specification(text, fuzz::kNameAmongActuators)));
  });
}
