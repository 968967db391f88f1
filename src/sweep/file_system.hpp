#pragma once
// File systems that cannot hold a database of several writers.

#include <string>
#include <string_view>

namespace gear3k::sweep {

/// The name of a network file system by its number in statfs(2), "" for a local one.
///
/// Source: linux/magic.h, and the numbers that statfs(2) lists.  FUSE counts as one: it may be
/// (sshfs), and its number does not tell.
std::string_view network_file_system(unsigned long type);

/// Processes of several machines cannot share the index of SQLite's write-ahead log (SQLite,
/// "Write-Ahead Logging", 1): refuses a path on a network file system.
/// @throws io::InvalidInput with what to do instead
void refuse_network(const std::string& path);

}  // namespace gear3k::sweep
