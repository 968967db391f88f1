#include "cli/commands.hpp"

#include <fmt/format.h>
#include <omp.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <list>
#include <utility>
#include <vector>

#include "app/analyze.hpp"
#include "app/compare.hpp"
#include "app/evaluate.hpp"
#include "app/search.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "design/output_terms.hpp"
#include "design/tightest.hpp"
#include "drawing/dxf_drawing.hpp"
#include "drawing/export_report.hpp"
#include "drawing/inspection_sheet.hpp"
#include "drawing/section_drawing.hpp"
#include "drawing/svg_drawing.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/files/subject_file.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_set.hpp"
#include "io/text/file_writer.hpp"
#include "io/text/printable.hpp"
#include "papers/backdrivability_figures.hpp"
#include "papers/directional_bench_report.hpp"
#include "papers/paper_figures_plot.hpp"
#include "papers/paper_figures_report.hpp"
#include "papers/published_sources.hpp"
#include "papers/reproduce_report.hpp"
#include "report/analysis_report.hpp"
#include "report/comparison_report.hpp"
#include "report/first_screen.hpp"
#include "report/limits_report.hpp"
#include "report/search_report.hpp"
#include "report/torque_angle_plot.hpp"
#include "report/torque_angle_report.hpp"

namespace gear3k::cli {

namespace {

[[noreturn]] void refuse_stdout() { throw io::InvalidInput("stdout: cannot be written"); }

}  // namespace

void print_result(const std::string& result) {
  results_begin();
  // JSON has no control character but ends of lines that this would change, nor has CSV.
  const std::string text = io::printable_lines(result);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    refuse_stdout();
  }
}

void deliver(const CommonOptions& options, const std::string& text) {
  results_begin();
  if (options.out.empty()) {
    print_result(text);
  } else {
    io::write_file(options.out, io::printable_lines(text));
  }
}

void deliver_in_pieces(
    const CommonOptions& options,
    const std::function<void(const std::function<void(std::string_view)>&)>& produce) {
  results_begin();
  if (!options.out.empty()) {
    io::write_file_in_pieces(options.out, produce);
    return;
  }
  produce([](std::string_view piece) {
    if (std::fwrite(piece.data(), 1, piece.size(), stdout) < piece.size()) refuse_stdout();
  });
  if (std::fflush(stdout) != 0) refuse_stdout();
}

void warn(const app::Notes& notes, bool quiet) {
  if (quiet) return;
  for (const std::string& note : notes) say(fmt::format("model: {}\n", note));
}

std::optional<int> known_columns(int asked) {
  constexpr int kLeast = 60, kMost = 500;
  if (asked > 0) return asked;
  winsize size{};
  const bool known = ::isatty(STDOUT_FILENO) != 0 &&
                     ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  if (!known) return std::nullopt;
  return std::clamp(static_cast<int>(size.ws_col), kLeast, kMost);
}

report::TableChoice table_choice(const ShowOptions& options) {
  report::TableChoice choice{.full = options.full,
                             .sections = {},
                             .columns = known_columns(options.columns).value_or(kUsualColumns)};
  for (std::size_t k = 0; k < report::kSectionNames.size(); ++k) {
    if (std::ranges::find(options.show, report::kSectionNames[k]) != options.show.end()) {
      choice.sections.push_back(static_cast<report::Section>(k));
    }
  }
  return choice;
}

int use_threads(const CommonOptions& options) {
  if (options.threads > 0) omp_set_num_threads(options.threads);
  return omp_get_max_threads();
}

namespace {

/// Of which preset the limits of a design or a pair are; nothing without one.
template <class Subject>
std::string limits_paragraph(const Subject& design, const ShowOptions& show) {
  if (!design.limits.preset) return "";
  return "\n" + report::broken(report::limits_line(design.limits, report::limits_subject(design)),
                               table_choice(show).columns, kBrokenIndent);
}

/// @param figures  what was drawn of it
std::string result_text(const app::Analysis& analysis, const std::optional<app::Model>& model,
                        const Figures& figures, Format format, const ShowOptions& show) {
  const design::BuiltSeries* built = analysis.series ? &*analysis.series : nullptr;
  const report::ModelUse* use = model ? &model->use : nullptr;
  const design::TorqueAngleCurve* curve = analysis.torque_angle ? &*analysis.torque_angle : nullptr;
  switch (format) {
    case Format::kJson:
      return with_missing_figures(
          report::analysis_json(analysis.evaluation, analysis.sensitivities, use, built, curve),
          figures);
    case Format::kCsv:
      return report::analysis_csv(analysis.evaluation, analysis.sensitivities, built, curve);
    case Format::kTable:
      break;
  }
  return report::analysis_text(
             analysis.evaluation,
             design::tightest_checks(analysis.design, analysis.evaluation, kTightestShown),
             table_choice(show), analysis.sensitivities, use, built, curve,
             design::stated_outer_diameter_m(analysis.design)) +
         limits_paragraph(analysis.design, show);
}

std::string result_text(const design::PairDesign& pair, const design::PairEvaluation& evaluation,
                        Format format, const ShowOptions& show) {
  switch (format) {
    case Format::kJson:
      return report::analysis_json(evaluation).text();
    case Format::kCsv:
      return report::analysis_csv(evaluation);
    case Format::kTable:
      break;
  }
  return report::analysis_text(evaluation,
                               design::tightest_checks(pair, evaluation, kTightestShown),
                               table_choice(show)) +
         limits_paragraph(pair, show);
}

/// Exit code of what was analysed.
ExitCode judged(const std::vector<design::CheckResult>& checks, const AnalyzeOptions& options) {
  return options.strict && !design::all_ok(checks) ? kNoFeasibleDesign : kDone;
}

/// Figures of a result, drawn and written.
struct WrittenFigures {
  Figures figures;
  std::vector<std::string> paths;
  std::string table;  ///< what they show
};

/// The torque-angle curve in the folder of --figures.
/// @throws io::InvalidInput where there is no curve, or a file cannot be written
WrittenFigures write_torque_angle(const AnalyzeOptions& options, const app::Analysis& analysis) {
  if (!analysis.design.rating) {
    throw io::InvalidInput(fmt::format(
        "{}: --figures: the torque-angle curve needs [strength], which gives the output's "
        "stiffness",
        options.file));
  }
  if (!analysis.torque_angle) {
    throw io::InvalidInput(
        fmt::format("{}: --figures: {}", options.file, analysis.evaluation.notes.back()));
  }
  const std::string csv = "torque_angle.csv";
  const std::string svg = "torque_angle.svg";
  ResultFolder folder(ResultFolderTask{.path = options.figures,
                                       .option = "--figures",
                                       .inputs = {options.file, options.model},
                                       .result = options.out,
                                       .files = {csv},
                                       .figures = {svg},
                                       .quiet = options.quiet});
  WrittenFigures written{
      .figures = draw({report::torque_angle_plot(analysis.design.name, *analysis.torque_angle)}),
      .paths = {},
      .table = {}};
  written.paths = folder.write(
      {{.path = csv, .text = report::torque_angle_csv(*analysis.torque_angle)}}, written.figures);
  return written;
}

}  // namespace

ExitCode run_analyze(const AnalyzeOptions& options) {
  end_on_interrupt();
  app::AnalyzeRequest request{.design = {}, .model = {}, .source = options.file};
  io::CollectedErrors errors;
  errors.attempt([&] { request.design = io::read_design(options.file); });
  errors.attempt([&] { request.model = app::read_model(options.model); });
  errors.raise();
  use_threads(options);
  refuse_replacing({options.file, options.model}, options.out, options.figures);
  const app::Analysis analysis = app::analyze(request);
  warn(analysis.model_notes, options.quiet);
  WrittenFigures written;
  if (!options.figures.empty()) {
    written = write_torque_angle(options, analysis);
  }
  std::string text =
      result_text(analysis, request.model, written.figures, options.format, options.show);
  if (options.format == Format::kTable) text += files_text(written.paths);
  deliver(options, text);
  return judged(analysis.evaluation.checks, options);
}

ExitCode run_mesh(const AnalyzeOptions& options) {
  end_on_interrupt();
  const app::MeshRequest request{.pair = io::read_pair(options.file), .source = options.file};
  refuse_replacing({options.file}, options.out);
  const design::PairEvaluation evaluation = app::mesh(request);
  deliver(options, result_text(request.pair, evaluation, options.format, options.show));
  return judged(evaluation.checks, options);
}

ExitCode run_compare(const CompareOptions& options) {
  end_on_interrupt();
  app::CompareRequest request;
  request.designs.reserve(options.files.size());
  io::CollectedErrors errors;
  for (const std::string& file : options.files) {
    errors.attempt(
        [&] { request.designs.push_back({.design = io::read_design(file), .source = file}); });
  }
  errors.raise();
  refuse_replacing(options.files, options.out);
  const std::vector<report::ComparedDesign> compared = app::compare(request);
  switch (options.format) {
    case Format::kJson:
      deliver(options, report::comparison_json(compared));
      break;
    case Format::kCsv:
      deliver(options, report::comparison_csv(compared));
      break;
    case Format::kTable:
      deliver(options, report::comparison_table(
                           compared, known_columns(options.columns).value_or(kUsualColumns)));
      break;
  }
  return kDone;
}

ExitCode run_search(const SearchOptions& options) {
  end_on_interrupt();
  // Files state every set, the table the first ones.
  const app::SearchRequest request{.spec = io::read_specification(options.file),
                                   .most_ranked = options.format == Format::kTable
                                                      ? static_cast<std::size_t>(options.top)
                                                      : std::numeric_limits<std::size_t>::max()};
  const optimize::Specification& spec = request.spec;
  std::vector<std::string> inputs = io::named_files(spec);
  inputs.push_back(options.file);
  refuse_replacing(inputs, options.out);
  warn(spec.notes, options.quiet);
  use_threads(options);
  app::ToothSets found = [&] {
    optimize::Progress progress;
    const ProgressDisplay display(progress, options.quiet);
    return app::search(request, progress);
  }();
  end_on_interrupt();
  const optimize::ToothSearchResult& search = found.search;
  if (search.interrupted) {
    say("interrupted: a partial search has no ranking\n");
    return kInterrupted;
  }
  const bool empty = found.ranking.added() == 0;
  switch (options.format) {
    case Format::kJson:
      deliver_in_pieces(options, [&](const auto& out) {
        report::write_search_json(spec, search, found.ranking, out);
      });
      break;
    case Format::kCsv:
      deliver_in_pieces(options,
                        [&](const auto& out) { report::write_search_csv(found.ranking, out); });
      break;
    case Format::kTable:
      // Scripts get their header and no set; a reader gets the message below, and a file the
      // counts: that of an earlier run would pass for this one's.
      if (empty && options.out.empty()) break;
      deliver(options, empty ? report::search_counts_text(spec, search)
                             : report::search_table(spec, search, found.ranking));
      break;
  }
  if (!empty) return kDone;
  optimize::OptimizeResult nothing;
  nothing.search = search;
  say(fmt::format("{}\n", report::blocking_text(spec, nothing, {})));
  return kNoFeasibleDesign;
}

namespace {

/// Names of all figures of `reproduce`, without .csv and .svg.
std::vector<std::string> reproduce_figures() {
  std::vector<std::string> names(papers::kFigureNames.begin(), papers::kFigureNames.end());
  names.insert(names.end(), papers::kBackdrivabilityFigures.begin(),
               papers::kBackdrivabilityFigures.end());
  names.insert(names.end(), papers::kDirectionalFigures.begin(), papers::kDirectionalFigures.end());
  return names;
}

/// @throws io::InvalidInput where a file cannot be written or is also that of --out
WrittenFigures write_figures(const ReproduceOptions& options,
                             const papers::PublishedSources& sources,
                             const papers::Reproduction& reproduction) {
  ResultFolderTask task{.path = options.figures,
                        .option = "--figures",
                        .inputs = {},
                        .result = options.out,
                        .files = {},
                        .quiet = options.quiet};
  for (const std::string& name : reproduce_figures()) {
    task.files.push_back(name + ".csv");
    task.figures.push_back(name + ".svg");
  }
  ResultFolder folder(std::move(task));
  const papers::PaperFigures figures = papers::paper_figures(sources);
  const papers::BackdrivabilityFigures backdrivability{
      .comparison = reproduction.backdrivability,
      .strain_waves = sources.backdrivability.strain_waves,
      .designed = papers::scaled_design()};
  std::vector<io::FileText> files;
  const auto add_data = [&](const std::vector<papers::FigureData>& all) {
    for (const papers::FigureData& data : all) {
      files.push_back({.path = data.name + ".csv", .text = data.csv});
    }
  };
  add_data(papers::figure_data(figures));
  add_data(papers::backdrivability_figure_data(backdrivability));
  add_data(papers::directional_figure_data(reproduction.directional_bench));
  std::vector<report::Plot> plots = papers::figure_plots(figures);
  for (report::Plot& plot : papers::backdrivability_figure_plots(backdrivability)) {
    plots.push_back(std::move(plot));
  }
  for (report::Plot& plot : papers::directional_figure_plots(reproduction.directional_bench)) {
    plots.push_back(std::move(plot));
  }
  WrittenFigures written{
      .figures = draw(plots),
      .paths = {},
      .table = papers::figures_table(figures) +
               papers::backdrivability_figures_table(backdrivability) +
               papers::directional_figures_table(reproduction.directional_bench)};
  written.paths = folder.write(std::move(files), written.figures);
  return written;
}

}  // namespace

ExitCode run_reproduce(const ReproduceOptions& options) {
  end_on_interrupt();
  refuse_replacing({}, options.out, options.figures);
  use_threads(options);
  const papers::PublishedSources sources = papers::published_sources();
  const papers::Reproduction reproduction = papers::reproduce(sources);
  WrittenFigures written;
  if (!options.figures.empty()) {
    written = write_figures(options, sources, reproduction);
  }
  switch (options.format) {
    case Format::kJson:
      deliver(options, with_missing_figures(papers::reproduce_json(reproduction), written.figures));
      break;
    case Format::kCsv:
      deliver(options, papers::reproduce_csv(reproduction));
      break;
    case Format::kTable:
      deliver(options,
              papers::reproduce_table(reproduction) + written.table + files_text(written.paths));
      break;
  }
  return kDone;
}

namespace {

/// Adds one file to what is written and to what is printed of it.
struct Exports {
  drawing::ExportSummary summary;
  std::vector<io::FileText> files;

  void add(const std::string& folder, drawing::ExportedFile file, std::string text) {
    file.path =
        (std::filesystem::path(folder) / fmt::format("{}.{}", file.drawing, file.format)).string();
    files.push_back({.path = file.path, .text = std::move(text)});
    summary.files.push_back(std::move(file));
  }
  void add_drawings(const std::string& folder, const char* format,
                    const std::vector<drawing::Drawing>& drawings,
                    std::string (*text_of)(const drawing::Drawing&)) {
    if (folder.empty()) return;
    for (const drawing::Drawing& one : drawings) {
      std::size_t points = 0;
      for (const drawing::DrawnGear& gear : one.gears) points += gear.contour.size();
      add(folder,
          {.path = "",
           .drawing = one.name,
           .format = format,
           .contours = one.gears.size(),
           .points = points},
          text_of(one));
    }
  }
  void add_section(const std::string& folder, const char* format,
                   const drawing::SectionDrawing& section) {
    if (folder.empty()) return;
    const bool dxf = std::string_view(format) == "dxf";
    add(folder,
        {.path = "",
         .drawing = "assembly",
         .format = format,
         .contours = section.bodies.size(),
         .points = 4 * section.bodies.size()},
        dxf ? drawing::dxf_text(section) : drawing::svg_text(section));
  }
  void add_sheets(const std::string& folder, const std::vector<drawing::InspectionSheet>& sheets) {
    for (const drawing::InspectionSheet& sheet : sheets) {
      add(folder, {.path = "", .drawing = sheet.name, .format = "csv", .contours = 0, .points = 0},
          drawing::sheet_csv(sheet));
      add(folder, {.path = "", .drawing = sheet.name, .format = "html", .contours = 0, .points = 0},
          drawing::sheet_html(sheet));
    }
  }
};

Exports exports_of(const design::Design& design, const ExportOptions& options) {
  const design::Evaluation evaluation = app::evaluate(design, options.file);
  const double chord_error_m = options.chord_error_um * 1e-6;
  drawing::DrawingSet set = drawing::make_drawings(design, evaluation, chord_error_m);
  const drawing::SectionDrawing section = drawing::make_section(design, evaluation, set.notes);
  Exports exports{.summary = {.name = evaluation.name,
                              .chord_error_m = chord_error_m,
                              .files = {},
                              .notes = std::move(set.notes)},
                  .files = {}};
  exports.add_drawings(options.dxf_folder, "dxf", set.drawings, drawing::dxf_text);
  exports.add_section(options.dxf_folder, "dxf", section);
  exports.add_drawings(options.svg_folder, "svg", set.drawings, drawing::svg_text);
  exports.add_section(options.svg_folder, "svg", section);
  if (!options.sheet_folder.empty())
    exports.add_sheets(options.sheet_folder, drawing::inspection_sheets(design, evaluation));
  return exports;
}

/// Of a pair there are sheets only.
Exports exports_of(const design::PairDesign& pair, const ExportOptions& options) {
  if (!options.dxf_folder.empty() || !options.svg_folder.empty()) {
    throw io::InvalidInput(options.file +
                           ": a PAIR has no drawings: --dxf, --svg: allowed: a DESIGN; of a PAIR "
                           "--sheet");
  }
  const design::PairEvaluation evaluation = app::mesh({.pair = pair, .source = options.file});
  Exports exports{.summary = {.name = evaluation.name,
                              .chord_error_m = options.chord_error_um * 1e-6,
                              .files = {},
                              .notes = evaluation.notes},
                  .files = {}};
  if (std::string failed = drawing::failed_checks_text(evaluation.checks); !failed.empty()) {
    exports.summary.notes.push_back(std::move(failed));
  }
  exports.add_sheets(options.sheet_folder, drawing::inspection_sheets(pair, evaluation));
  return exports;
}

Exports exports_of(const calibrate::BlackBox&, const ExportOptions& options) {
  throw io::InvalidInput(options.file +
                         ": is a black box, without teeth; allowed: a DESIGN or a PAIR");
}

/// Several folders; of those that were made, what was made last goes first.
struct ResultFolders {
  std::list<ResultFolder> list;

  ResultFolders() = default;
  ResultFolders(const ResultFolders&) = delete;
  ResultFolders& operator=(const ResultFolders&) = delete;
  ~ResultFolders() {
    while (!list.empty()) list.pop_back();
  }
};

/// Writes into folders of which each is held by this run, all files or none.
void write_exports(const Exports& exports, const ExportOptions& options) {
  ResultFolders folders;
  std::vector<std::filesystem::path> held;
  io::CollectedErrors errors;
  const std::pair<const char*, std::string> named[] = {{"--dxf", options.dxf_folder},
                                                       {"--svg", options.svg_folder},
                                                       {"--sheet", options.sheet_folder}};
  for (const auto& [option, folder] : named) {
    if (folder.empty()) continue;
    // One folder may be named by several options.
    std::error_code unknown;
    const auto path = std::filesystem::weakly_canonical(std::filesystem::absolute(folder), unknown);
    if (std::ranges::find(held, path) != held.end()) continue;
    held.push_back(path);
    errors.attempt([&, &option = option, &folder = folder] {
      folders.list.emplace_back(ResultFolderTask{
          .path = folder, .option = option, .inputs = {}, .files = {}, .quiet = options.quiet});
      folders.list.back().open();
    });
  }
  errors.raise();
  io::write_files(exports.files, {options.file});
}

}  // namespace

ExitCode run_export(const ExportOptions& options) {
  end_on_interrupt();
  use_threads(options);
  const Exports exports =
      std::visit([&](const auto& subject) { return exports_of(subject, options); },
                 io::read_subject(options.file, "export takes a DESIGN, or a PAIR for --sheet"));
  const drawing::ExportSummary& summary = exports.summary;
  write_exports(exports, options);

  if (!options.quiet) {
    for (const std::string& note : summary.notes) say(fmt::format("note: {}\n", note));
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

}  // namespace gear3k::cli
