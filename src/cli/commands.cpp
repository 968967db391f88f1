#include "cli/commands.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "calibrate/model/model_range.hpp"
#include "cli/model_option.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "drawing/dxf_drawing.hpp"
#include "drawing/export_report.hpp"
#include "drawing/svg_drawing.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/files/subject_file.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_set.hpp"
#include "io/text/file_writer.hpp"
#include "papers/paper_figures_plot.hpp"
#include "papers/paper_figures_report.hpp"
#include "papers/published_sources.hpp"
#include "papers/reproduce_report.hpp"
#include "report/analysis_report.hpp"
#include "report/search_report.hpp"

namespace gear3k::cli {

void print_result(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw io::InvalidInput("stdout: cannot be written");
  }
}

void deliver(const CommonOptions& options, const std::string& text) {
  if (options.out.empty()) {
    print_result(text);
  } else {
    io::write_file(options.out, text);
  }
}

void set_aside(const std::string& path, bool quiet) {
  std::error_code status;
  if (!std::filesystem::exists(path, status)) return;
  const std::string aside = path + ".previous";
  std::filesystem::rename(path, aside, status);
  if (status) {
    throw io::InvalidInput(
        fmt::format("{}: is not of this run and cannot be renamed: {}", path, status.message()));
  }
  if (quiet) return;
  say(fmt::format("{}: is not of this run, renamed to {}\n", path, aside));
}

int use_threads(const CommonOptions& options) {
  if (options.threads > 0) omp_set_num_threads(options.threads);
  return omp_get_max_threads();
}

namespace {

std::string analysis(const CommonOptions& options, const design::Design& design,
                     const design::Evaluation& evaluation,
                     const std::optional<LoadedModel>& model) {
  const auto sensitivities = design::sensitivities(design);
  const std::optional<design::BuiltSeries> series = design::table_series(design);
  const design::BuiltSeries* built = series ? &*series : nullptr;
  const report::ModelUse* use = model ? &model->use : nullptr;
  switch (options.format) {
    case Format::kJson:
      return report::analysis_json(evaluation, sensitivities, use, built);
    case Format::kCsv:
      return report::analysis_csv(evaluation, sensitivities, built);
    case Format::kTable:
      break;
  }
  return report::analysis_table(evaluation, sensitivities, use, built);
}
std::string analysis(const CommonOptions& options, const design::PairDesign&,
                     const design::PairEvaluation& evaluation,
                     const std::optional<LoadedModel>& /*model*/) {
  switch (options.format) {
    case Format::kJson:
      return report::analysis_json(evaluation);
    case Format::kCsv:
      return report::analysis_csv(evaluation);
    case Format::kTable:
      break;
  }
  return report::analysis_table(evaluation);
}

template <class Design>
auto evaluate_or_throw(const Design& design, const std::string& file) {
  auto result = design::evaluate(design);
  if (const auto* undefined = std::get_if<design::NotDefined>(&result)) {
    throw io::InvalidInput(fmt::format("{}: {}", file, undefined->message));
  }
  return std::get<0>(std::move(result));
}

/// An output that would overwrite its own input is a slip.
void refuse_overwriting_input(const std::string& input, const std::string& output) {
  std::error_code status;
  if (!output.empty() && std::filesystem::equivalent(input, output, status)) {
    throw io::InvalidInput(
        fmt::format("--out {}: is the input file, allowed: another file", output));
  }
}

template <class Design>
ExitCode analyze(const Design& design, const AnalyzeOptions& options,
                 const std::optional<LoadedModel>& model, const Notes& notes) {
  use_threads(options);
  refuse_overwriting_input(options.file, options.out);
  auto result = evaluate_or_throw(design, options.file);
  result.notes.insert(result.notes.end(), notes.begin(), notes.end());
  warn(notes, options.quiet);
  deliver(options, analysis(options, design, result, model));
  return options.strict && !design::all_ok(result.checks) ? kNoFeasibleDesign : kDone;
}

}  // namespace

ExitCode run_analyze(const AnalyzeOptions& options) {
  const design::Design design = io::read_design(options.file);
  const std::optional<LoadedModel> model = load_model(options.model);
  if (!model) return analyze(design, options, model, {});
  refuse_overwriting_input(options.model, options.out);
  Notes notes;
  const design::Design extended = with_model(design, *model, notes);
  return analyze(extended, options, model, notes);
}

ExitCode run_mesh(const AnalyzeOptions& options) {
  return analyze(io::read_pair(options.file), options, std::nullopt, {});
}

ExitCode run_search(const SearchOptions& options) {
  const optimize::Specification spec = io::read_specification(options.file);
  refuse_overwriting_input(options.file, options.out);
  use_threads(options);
  optimize::Progress progress;
  optimize::ToothSearchResult search;
  {
    const ProgressDisplay display(progress, options.quiet);
    search = optimize::search_teeth(spec, progress);
  }
  if (search.interrupted) {
    say("interrupted: a partial search has no ranking\n");
    return kInterrupted;
  }
  const bool empty = search.candidates.empty();
  const auto sets = optimize::rank_at_zero_shift(spec, search.candidates);
  switch (options.format) {
    case Format::kJson:
      deliver(options, report::search_json(spec, search, sets));
      break;
    case Format::kCsv:
      deliver(options, report::search_csv(sets));
      break;
    case Format::kTable:
      // Scripts get their header and no set; a reader gets the message below.
      if (empty) break;
      deliver(options,
              report::search_table(spec, search, sets, static_cast<std::size_t>(options.top)));
      break;
  }
  if (!empty) return kDone;
  optimize::OptimizeResult nothing;
  nothing.search = search;
  say(fmt::format("{}\n", report::blocking_text(spec, nothing, {})));
  return kNoFeasibleDesign;
}

namespace {

/// The paper's figures, drawn and written.
struct WrittenFigures {
  WrittenFiles files;
  std::string table;  ///< what they show
};

/// @throws io::InvalidInput where a file cannot be written or is also that of --out
WrittenFigures write_figures(const ReproduceOptions& options,
                             const papers::PublishedSources& sources) {
  const auto canonical = [](const std::filesystem::path& path) {
    std::error_code status;
    const auto result = std::filesystem::weakly_canonical(path, status);
    return status ? path : result;
  };
  for (const char* name : papers::kFigureNames) {
    if (options.out.empty()) break;
    for (const char* type : {".csv", ".svg"}) {
      const auto path = std::filesystem::path(options.figures) / (std::string(name) + type);
      if (canonical(path) != canonical(options.out)) continue;
      throw io::InvalidInput(
          fmt::format("--out {}: is a file of --figures, allowed: another file", options.out));
    }
  }
  const papers::PaperFigures figures = papers::paper_figures(sources);
  std::vector<io::FileText> files;
  for (const papers::FigureData& data : papers::figure_data(figures)) {
    files.push_back({.path = data.name + ".csv", .text = data.csv});
  }
  return {
      .files = write_results(
          {.path = options.figures, .input = "", .protected_inputs = {}, .quiet = options.quiet},
          std::move(files), papers::figure_plots(figures)),
      .table = papers::figures_table(figures)};
}

}  // namespace

ExitCode run_reproduce(const ReproduceOptions& options) {
  use_threads(options);
  const papers::PublishedSources sources = papers::published_sources();
  const papers::Reproduction reproduction = papers::reproduce(sources);
  WrittenFigures figures;
  if (!options.figures.empty()) {
    end_on_interrupt();
    figures = write_figures(options, sources);
  }
  switch (options.format) {
    case Format::kJson:
      deliver(options, papers::reproduce_json(reproduction));
      break;
    case Format::kCsv:
      deliver(options, papers::reproduce_csv(reproduction));
      break;
    case Format::kTable:
      deliver(options,
              papers::reproduce_table(reproduction) + figures.table + files_text(figures.files));
      break;
  }
  return figures.files.code;
}

ExitCode run_export(const ExportOptions& options) {
  use_threads(options);
  const design::Design design = io::read_design(options.file);
  const design::Evaluation evaluation = evaluate_or_throw(design, options.file);
  const double chord_error_m = options.chord_error_um * 1e-6;
  const drawing::DrawingSet set = drawing::make_drawings(design, evaluation, chord_error_m);

  drawing::ExportSummary summary{
      .name = evaluation.name, .chord_error_m = chord_error_m, .files = {}, .notes = set.notes};
  std::vector<io::FileText> files;
  const auto add = [&](const std::string& folder, const char* format,
                       std::string (*text_of)(const drawing::Drawing&)) {
    if (folder.empty()) return;
    for (const drawing::Drawing& one : set.drawings) {
      const std::string path =
          (std::filesystem::path(folder) / fmt::format("{}.{}", one.name, format)).string();
      std::size_t points = 0;
      for (const drawing::DrawnGear& gear : one.gears) points += gear.contour.size();
      files.push_back({.path = path, .text = text_of(one)});
      summary.files.push_back({.path = path,
                               .drawing = one.name,
                               .format = format,
                               .contours = one.gears.size(),
                               .points = points});
    }
  };
  add(options.dxf_folder, "dxf", drawing::dxf_text);
  add(options.svg_folder, "svg", drawing::svg_text);
  io::write_files(files, options.file);

  if (!options.quiet) {
    for (const std::string& note : set.notes) say(fmt::format("note: {}\n", note));
  }
  switch (options.format) {
    case Format::kJson:
      print_result(drawing::export_json(summary));
      break;
    case Format::kCsv:
      print_result(drawing::export_csv(summary));
      break;
    case Format::kTable:
      print_result(drawing::export_table(summary));
      break;
  }
  return kDone;
}

ExitCode run_keys(const CommonOptions& options) {
  if (options.format != Format::kTable) {
    say("keys: --format: allowed: table (the document is Markdown)\n");
    return kUsage;
  }
  deliver(options, fmt::format("# Keys of the input files\n\nPrinted by `gear3k keys`.\n\n"
                               "## DESIGN.toml\n\n{}\n## PAIR.toml\n\n{}\n## SPEC.toml\n\n{}\n"
                               "## Black box (in place of a DESIGN)\n\n{}",
                               io::design_key_table(), io::pair_key_table(),
                               io::specification_key_table(), io::black_box_key_table()));
  return kDone;
}

}  // namespace gear3k::cli
