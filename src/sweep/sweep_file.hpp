#pragma once
// SWEEP.toml: one task, and what of it is varied.

#include <cstdint>
#include <string>
#include <vector>

#include "sweep/axes.hpp"

namespace gear3k::sweep {

/// A sweep: a SPEC and its axes.
struct Sweep {
  std::string name;
  std::string source;     ///< the file's text, kept with the results
  io::TomlValue task;     ///< the keys that are not varied
  std::string task_file;  ///< in which they are, for messages
  std::vector<Axis> axes;

  /// Tasks, the greatest number where they are more.
  [[nodiscard]] std::uint64_t count() const { return combinations(axes); }
  /// Paths of what is varied.
  [[nodiscard]] std::vector<std::string> varied() const;
  /// SPEC of task k < count(); the last axis goes round first.
  [[nodiscard]] io::TomlValue document(std::uint64_t k) const;
};

/// Tasks that are looked at to find one that fits together, before a sweep is refused.
inline constexpr std::uint64_t kTriedTasks = 1000;

/// Reads a SWEEP file.
/// @throws io::InvalidInput with every error of the file; where none of the first kTriedTasks tasks
///   fits together, with those of the first
Sweep read_sweep(const std::string& path);

/// Table of its own keys, in Markdown.
std::string sweep_key_table();

}  // namespace gear3k::sweep
