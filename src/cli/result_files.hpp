#pragma once
// Result files of a command in one folder, with figures where gnuplot can draw them.

#include <string>
#include <vector>

#include "cli/exit_code.hpp"
#include "io/text/file_set.hpp"
#include "report/plot.hpp"

namespace gear3k::cli {

struct ResultFolder {
  std::string path;                           ///< of --out
  std::string input;                          ///< as write_files() takes it
  std::vector<std::string> protected_inputs;  ///< that no result may replace
  /// Names of all figures that the command may write, without .svg: those of an earlier run that
  /// are none of this one's are removed.
  std::vector<std::string> figures = {};
  bool quiet = false;  ///< says nothing of figures of an earlier run
};

struct WrittenFiles {
  ExitCode code = kDone;           ///< kInvalidInput: without figures
  std::vector<std::string> paths;  ///< in the order given, then figures
};

/// Writes the files and a figure NAME.svg for each plot, all or none.  Without gnuplot: no figures,
/// those of an earlier run are set aside, and stderr says so.  Figures of an earlier run that this
/// one has not are removed, and stderr says so.
/// @param files  named within the folder
/// @throws io::InvalidInput where a file cannot be written or would replace an input
WrittenFiles write_results(const ResultFolder& folder, std::vector<io::FileText> files,
                           const std::vector<report::Plot>& plots);

/// "\nFiles: a, b\n" for the end of a table; "" where nothing was written.
std::string files_text(const WrittenFiles& written);

}  // namespace gear3k::cli
