// `mesh` on any PAIR, in every format.

#include "app/analyze.hpp"
#include "entry.hpp"
#include "io/files/design_file.hpp"
#include "report/analysis_report.hpp"
#include "work.hpp"

using namespace gear3k;

FUZZER(mesh)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, [](const std::string& text) {
    const design::PairEvaluation e =
        app::mesh({.pair = io::parse_pair(text, fuzz::kName), .source = fuzz::kName});
    fuzz::write(report::analysis_json(e));
    report::analysis_csv(e);
    report::analysis_table(e);
  });
}
