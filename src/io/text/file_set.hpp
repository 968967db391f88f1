#pragma once

#include <string>
#include <vector>

namespace gear3k::io {

struct FileText {
  std::string path, text;
};

/// Writes several files, replacing what has their names: all of them or none.
///
/// Missing folders are made.  Every file is written to a temporary name in its folder; only when
/// all are there are they renamed.  On failure nothing is left behind: no temporary file, no folder
/// that was made.  (Should a rename fail after all this, those before it have happened.)
/// @param input  a file that none of them may be, as an output over its own input is a slip
/// @throws InvalidInput naming every path that cannot be written and the cause
void write_files(const std::vector<FileText>& files, const std::string& input);

}  // namespace gear3k::io
