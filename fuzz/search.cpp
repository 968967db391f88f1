// `search` on any SPEC with few tooth sets, in every format.

#include "app/search.hpp"

#include "entry.hpp"
#include "io/files/specification_file.hpp"
#include "report/search_report.hpp"
#include "work.hpp"

using namespace gear3k;

FUZZER(search)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, [](const std::string& text) {
    const app::SearchRequest request{
        .spec = fuzz::with_little_work(io::parse_specification(text, fuzz::kName)),
        .most_ranked = 50};
    optimize::Progress progress;
    app::ToothSets sets = app::search(request, progress);
    report::search_table(request.spec, sets.search, sets.ranking);
    report::write_search_csv(sets.ranking, [](std::string_view) {});
    report::write_search_json(request.spec, sets.search, sets.ranking, [](std::string_view) {});
  });
}
