#include "cli/result_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "cli/commands.hpp"
#include "cli/talk.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/gnuplot.hpp"

namespace gear3k::cli {

namespace {

/// No result may replace a file that it was made from.
void refuse_overwriting_inputs(const std::vector<std::string>& paths, const ResultFolder& folder) {
  for (const std::string& path : paths) {
    for (const std::string& input : folder.protected_inputs) {
      std::error_code status;
      if (std::filesystem::equivalent(path, input, status)) {
        throw io::InvalidInput(fmt::format("--out {}: {} is an input file, allowed: another folder",
                                           folder.path, path));
      }
    }
  }
}

/// Removes a file of an earlier run, which would pass for a result of this one.
/// @throws io::InvalidInput when it cannot be removed
void remove_earlier(const std::string& path, bool quiet) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) return;
  if (!std::filesystem::remove(path, status) || status) {
    throw io::InvalidInput(
        fmt::format("{}: is of an earlier run and cannot be removed: {}", path, status.message()));
  }
  if (!quiet) say(fmt::format("{}: was of an earlier run, removed\n", path));
}

/// Whether a path is one of the inputs, by whatever name.
bool is_input(const std::string& path, const ResultFolder& folder) {
  return std::ranges::any_of(folder.protected_inputs, [&](const std::string& input) {
    std::error_code status;
    return std::filesystem::equivalent(path, input, status);
  });
}

}  // namespace

WrittenFiles write_results(const ResultFolder& folder, std::vector<io::FileText> files,
                           const std::vector<report::Plot>& plots) {
  const auto path_of = [&](const std::string& name) {
    return (std::filesystem::path(folder.path) / name).string();
  };
  for (io::FileText& file : files) file.path = path_of(file.path);
  std::string failure;
  try {
    std::vector<io::FileText> figures;
    figures.reserve(plots.size());
    for (const report::Plot& plot : plots) {
      figures.push_back(
          {.path = path_of(plot.name + ".svg"), .text = io::run_gnuplot(plot.script)});
    }
    files.insert(files.end(), figures.begin(), figures.end());
  } catch (const io::InvalidInput& error) {
    failure = error.what();
  }
  WrittenFiles written;
  written.paths.reserve(files.size());
  for (const io::FileText& file : files) written.paths.push_back(file.path);
  refuse_overwriting_inputs(written.paths, folder);
  io::write_files(files, folder.input);
  // Figures of an earlier run would pass for results of this one.
  for (const std::string& name : folder.figures) {
    const std::string path = path_of(name + ".svg");
    const bool own = std::ranges::find(plots, name, &report::Plot::name) != plots.end();
    if (!own && !is_input(path, folder)) remove_earlier(path, folder.quiet);
  }
  if (failure.empty()) return written;
  for (const report::Plot& plot : plots) set_aside(path_of(plot.name + ".svg"), folder.quiet);
  say(fmt::format("{}\nwritten without figures: {}\n", failure, fmt::join(written.paths, ", ")));
  written.code = kInvalidInput;
  return written;
}

std::string files_text(const WrittenFiles& written) {
  return written.paths.empty() ? "" : fmt::format("\nFiles: {}\n", fmt::join(written.paths, ", "));
}

}  // namespace gear3k::cli
