#pragma once

#include <span>
#include <string_view>

namespace gear3k::io {

/// A first file of a kind: it runs as it is, with a comment on each key that most people change.
/// A line whose "#" is followed by no space is a choice that is off; with all of them on it runs
/// too.
struct FirstFile {
  std::string_view kind;  ///< as `gear3k new` takes it
  std::string_view text;  ///< TOML
};

/// All kinds, in the order in which they are told.
std::span<const FirstFile> first_files();

/// The file of a kind.  @returns nullptr where there is no such kind
const FirstFile* find_first_file(std::string_view kind);

}  // namespace gear3k::io
