#pragma once
// Result files of a command in one folder: the one way of the commands whose --out is a folder.

#include <string>
#include <vector>

#include "cli/figures.hpp"
#include "io/text/file_set.hpp"

namespace gear3k::cli {

/// What a command may write into a folder.
struct ResultFolderTask {
  std::string path;                      ///< of the folder
  std::string option = "--out";          ///< that named it
  std::vector<std::string> inputs;       ///< files that the results are made from; "" = none
  std::string result = {};               ///< file of another option, --out; "" = none
  std::vector<std::string> files;        ///< names within the folder, without figures
  std::vector<std::string> others = {};  ///< names of files that it writes on the way
  /// Names of all figures, with .svg: those of an earlier run that are none of this one's are
  /// removed.
  std::vector<std::string> figures = {};
  /// Files that an earlier run left and this one may not write: then removed, unless inputs.
  std::vector<std::string> earlier = {};
  bool quiet = false;  ///< says nothing on stderr of files of an earlier run, or missing figures
};

/// A folder of results, held by one run: no other run writes into it at the same time.
class ResultFolder {
 public:
  /// A folder that is there is locked at once, one that is not with the first file (or open()).  On
  /// file systems that lock no folders runs are not kept apart.
  /// @throws io::InvalidInput where a result would replace an input or the file of --out, the
  /// folder
  ///   cannot be made or written to, or another run holds it
  explicit ResultFolder(ResultFolderTask task);
  /// A folder that was made and got no file goes again.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// Makes the folder where it is missing, and locks it.
  /// @throws io::InvalidInput where it cannot be written to or another run holds it
  void open();

  [[nodiscard]] std::string path_of(const std::string& name) const;

  /// Writes files and figures, all or none.  Missing figures are no error: those of an earlier run
  /// are set aside, and stderr says so.
  /// @param files  named within the folder
  /// @returns paths of all that was written
  /// @throws io::InvalidInput where a file cannot be written
  std::vector<std::string> write(std::vector<io::FileText> files, const Figures& figures = {});

  /// Moves a file that would pass for a result of this run to NAME.previous, NAME.previous.2, ...:
  /// the first that is not there.
  /// @throws io::InvalidInput when it cannot be renamed
  void set_aside(const std::string& name) const;
  /// The same unless the earlier run left it, whose files are replaced.
  void set_foreign_aside(const std::string& name) const;
  /// The same of all files of the task, and of the earlier run that it names.
  void set_all_aside() const;

 private:
  void lock();
  void remove_earlier(const std::string& name) const;

  ResultFolderTask task_;
  std::vector<std::string> made_;  ///< folders, outermost first
  int lock_ = -1;
};

/// What of a result's file is told before it is computed.
/// @param inputs  files that it is made from; "" = none
/// @param out  the file of --out; "" = none
/// @param figures  the folder of --figures, which is made and may hold the result; "" = none
/// @throws io::InvalidInput where --out is an input, or it or `figures` cannot be written
void refuse_replacing(const std::vector<std::string>& inputs, const std::string& out,
                      const std::string& figures = "");

/// "\nFiles: a, b\n" for the end of a table; "" where nothing was written.
std::string files_text(const std::vector<std::string>& paths);

}  // namespace gear3k::cli
