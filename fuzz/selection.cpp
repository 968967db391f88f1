// `actuator --select` of any SPEC: the file, then its motors, gearboxes and cycle, named m, g and
// c, with lines "---" between them.

#include "actuator/selection.hpp"

#include <fmt/format.h>

#include <array>

#include "entry.hpp"
#include "io/files/selection_file.hpp"
#include "report/selection_report.hpp"
#include "work.hpp"

using namespace gear3k;

namespace {

constexpr std::size_t kMostCatalogueRows = 12;

void select_pairs(const std::string& text) {
  const std::vector<std::string> files = fuzz::files_of(text);
  if (files.size() != 4) throw io::InvalidInput("not four files");
  const auto text_of = [&](const std::string& name) {
    constexpr std::array<std::string_view, 3> kNames{"m", "g", "c"};
    const auto* const at = std::ranges::find(kNames, name);
    const std::size_t place = static_cast<std::size_t>(at - kNames.begin()) + 1;
    if (at == kNames.end() || fuzz::has_more_lines(files[place], kMostCatalogueRows)) {
      throw io::InvalidInput(name);
    }
    return files[place];
  };
  const actuator::SelectionTask task = io::parse_selection(files[0], fuzz::kName, text_of).task;
  if (task.cycles.size() > 3 || task.gearboxes.size() > kMostCatalogueRows) {
    throw io::InvalidInput("too many pairs");
  }
  const actuator::Selection selection = actuator::select(task);
  report::selection_json(task, selection);
  report::selection_csv(task, selection);
  report::selection_front_csv(task, selection);
  report::selection_table(task, selection);
  report::selection_blocking_text(task, selection);
}

}  // namespace

FUZZER(selection)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, select_pairs);
}
