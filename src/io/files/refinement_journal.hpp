#pragma once
// What a long run has refined so far, on disk: the source of --resume.

#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "optimize/refined_set.hpp"

namespace gear3k::io {

/// Tells tasks apart: a hash of the contents of their files, in this order, and of the program: its
/// version and commit, and where that does not say what it was built from (changed sources, none)
/// its build id.
std::uint64_t task_fingerprint(const std::vector<std::string>& contents);

/// The sets of a journal, by rising index.
///
/// A journal is a header (name of the format, fingerprint) and a record for each set: its length,
/// its fields as they are in memory, a hash of them.  A record that is cut short or damaged, as a
/// killed program leaves it, ends the journal; what comes after it is refined again.
struct Journal {
  bool exists = false;
  std::vector<optimize::RefinedSet> sets;
  std::uint64_t valid_bytes = 0;  ///< length of the undamaged part
};
/// @throws InvalidInput when the file is there and cannot be read, or is of another task
Journal read_journal(const std::string& path, std::uint64_t fingerprint);

/// Appends refined sets to a journal, each call flushed to the operating system; the file is locked
/// while the writer lives.
class JournalWriter {
 public:
  /// Goes on after `journal`'s undamaged part, or starts anew when it does not exist.
  /// @throws InvalidInput when the file cannot be written, or another program is writing it
  JournalWriter(std::string path, std::uint64_t fingerprint, const Journal& journal);
  /// @throws InvalidInput when the file cannot be written
  void append(std::span<const optimize::RefinedSet> sets);

 private:
  /// A descriptor, closed with its owner.
  struct Descriptor {
    explicit Descriptor(int descriptor) : value(descriptor) {}
    ~Descriptor();
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int value;
  };
  std::string path_;
  Descriptor lock_;
  std::ofstream file_;
};

}  // namespace gear3k::io
