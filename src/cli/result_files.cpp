#include "cli/result_files.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <utility>

#include "cli/commands.hpp"
#include "io/diagnostics.hpp"
#include "io/gnuplot.hpp"

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
  if (failure.empty()) return written;
  // Figures of an earlier run would pass for results of this one.
  for (const report::Plot& plot : plots) set_aside(path_of(plot.name + ".svg"));
  fmt::print(stderr, "{}\nwritten without figures: {}\n", failure, fmt::join(written.paths, ", "));
  written.code = kInvalidInput;
  return written;
}

std::string files_text(const WrittenFiles& written) {
  return written.paths.empty() ? "" : fmt::format("\nFiles: {}\n", fmt::join(written.paths, ", "));
}

}  // namespace gear3k::cli
