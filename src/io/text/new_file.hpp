#pragma once
// A file that has its name when it is whole.

#include <string>
#include <string_view>

namespace gear3k::io {

/// A file on its way to its name.
///
/// Until publish() it has no name at all where the file system can do so (O_TMPFILE), so that
/// nothing is left of it when the program is killed; elsewhere one that nobody can guess, made by
/// O_EXCL | O_NOFOLLOW in the same folder.  What goes without publish() leaves nothing.
/// Every member function throws InvalidInput "PATH: cannot be written: CAUSE".
class NewFile {
 public:
  explicit NewFile(std::string path);
  ~NewFile();
  NewFile(NewFile&& other) noexcept;
  NewFile& operator=(NewFile&&) = delete;
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes);
  /// Has the bytes on the disk.
  void sync();
  /// Gives it its name, in one step: whoever opens the path finds what was there before or the
  /// whole new file.
  void publish();
  /// Brings back what had the name before; on a file system that cannot exchange two names (no
  /// RENAME_EXCHANGE) an old file is gone and the new one stays.
  void take_back() noexcept;
  /// Has the names of the folder on the disk, as far as the system can; the file can no longer be
  /// taken back.
  void keep() noexcept;

 private:
  [[noreturn]] void refuse() const;
  void open_named();
  void give_second_name();

  std::string path_, folder_;
  std::string
      temporary_;  ///< a second name: before publish() its own, after it that of the old file
  int descriptor_ = -1;
  enum class Published { kNot, kNew, kExchanged, kReplaced };
  Published published_ = Published::kNot;
};

}  // namespace gear3k::io
