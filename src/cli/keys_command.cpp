#include <fmt/format.h>

#include <filesystem>

#include "cli/commands.hpp"
#include "cli/talk.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/design_file.hpp"
#include "io/files/first_file.hpp"
#include "io/files/scenario_file.hpp"
#include "io/files/selection_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/files/subject_file.hpp"
#include "io/keys/key_search.hpp"
#include "io/text/diagnostics.hpp"
#include "sweep/sweep_file.hpp"

namespace gear3k::cli {

bool other_form(const CommonOptions& options, std::string_view command, std::string_view form) {
  if (options.format == Format::kTable) return false;
  say(fmt::format("{}: --format: allowed: table (the document is {})\n", command, form));
  return true;
}

std::string keys_document() {
  return fmt::format(
      "# Keys of the input files\n\nPrinted by `gear3k keys`.\n\n"
      "## DESIGN.toml\n\n{}\n## PAIR.toml\n\n{}\n## SPEC.toml\n\n{}\n"
      "## Black box (in place of a DESIGN)\n\n{}\n## ACTUATOR.toml\n\n{}\n"
      "## SPEC.toml of gear3k actuator --select\n\n{}\n## SCENARIO.toml\n\n{}\n"
      "## SWEEP.toml\n\n"
      "Besides, `[task]` with the keys of a SPEC, and `[vary]` ([sweep.md](sweep.md)).\n\n{}",
      io::design_key_table(), io::pair_key_table(), io::specification_key_table(),
      io::black_box_key_table(), io::actuator_key_table(), io::selection_key_table(),
      io::scenario_key_table(), sweep::sweep_key_table());
}

ExitCode run_keys(const KeysOptions& options) {
  if (other_form(options, "keys", "Markdown")) return kUsage;
  const std::string document = keys_document();
  if (options.word.empty()) {
    deliver(options, document);
    return kDone;
  }
  const std::string found = io::rows_with(document, options.word);
  if (found.empty()) {
    const std::string hint = io::closest_word(options.word, io::words_of_keys(document));
    say(fmt::format("keys {}: no key and no meaning holds it{}; gear3k keys prints all\n",
                    options.word, hint.empty() ? "" : fmt::format("; did you mean {}?", hint)));
    return kUsage;
  }
  deliver(options, found);
  return kDone;
}

ExitCode run_new(const NewOptions& options) {
  if (other_form(options, "new", "TOML")) return kUsage;
  if (!options.out.empty() && std::filesystem::exists(options.out)) {
    throw io::InvalidInput(
        fmt::format("{}: is there already, and is not replaced; allowed: a new name", options.out));
  }
  deliver(options, std::string(io::find_first_file(options.kind)->text));
  return kDone;
}

}  // namespace gear3k::cli
