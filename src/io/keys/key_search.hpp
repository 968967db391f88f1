#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gear3k::io {

/// The rows of the tables of a Markdown document that hold a word, in capitals or not, each table
/// with its heading; tables without one are left out.  @returns "" where no row holds it
std::string rows_with(std::string_view document, std::string_view word);

/// The parts of the paths of the keys in such a document, as "module" and "stage1_mm" of
/// "module.stage1_mm", each once.
std::vector<std::string> words_of_keys(std::string_view document);

}  // namespace gear3k::io
