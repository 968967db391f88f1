#pragma once

#include <string>
#include <vector>

namespace gear3k::io {

struct FileText {
  std::string path, text;
};

/// Why a result cannot have a path: it is that of an input, which it would replace; "" when it can.
/// @param inputs  paths, "" for those that there are not
std::string replaced_input(const std::string& path, const std::vector<std::string>& inputs);

/// Writes several files, replacing what has their names: all of them or none.
///
/// Missing folders are made.  Every file is written whole (NewFile); only when all are on the disk
/// do they get their names, and should one not get it, the others lose theirs again to what had
/// them before.  On failure nothing is left behind: no temporary file, no folder that was made.
/// Signals that would end the program wait so long (HeldSignals); one that nothing can hold back
/// (SIGKILL) between two names can leave some of the set.
/// @param inputs  files that none of them may be (replaced_input())
/// @throws InvalidInput naming every path that cannot be written and the cause
void write_files(const std::vector<FileText>& files, const std::vector<std::string>& inputs);

}  // namespace gear3k::io
