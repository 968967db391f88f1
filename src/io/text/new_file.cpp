#include "io/text/new_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

namespace {

constexpr mode_t kMode = 0666;  ///< less what the user's umask takes away

/// A name in a folder that nobody can guess.
std::string random_name(const std::string& folder) {
  std::uint64_t number = 0;
  while (::getrandom(&number, sizeof number, 0) != static_cast<ssize_t>(sizeof number)) {
    if (errno != EINTR) return "";
  }
  return (std::filesystem::path(folder) / fmt::format(".gear3k-{:016x}.tmp", number)).string();
}

std::string descriptor_path(int descriptor) { return fmt::format("/proc/self/fd/{}", descriptor); }

/// Whether a path has an old file that can change places with a new one.
bool has_old_file(const std::string& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 &&
         (S_ISREG(status.st_mode) || S_ISLNK(status.st_mode));
}

bool swap_names(const std::string& one, const std::string& other) {
  return ::renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE) == 0;
}

}  // namespace

NewFile::NewFile(std::string path)
    : path_(std::move(path)), folder_(std::filesystem::path(path_).parent_path().string()) {
  if (folder_.empty()) folder_ = ".";
  descriptor_ = ::open(folder_.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kMode);
  // Without /proc it could not be given a name.
  if (descriptor_ >= 0 && ::access(descriptor_path(descriptor_).c_str(), F_OK) == 0) return;
  if (descriptor_ >= 0) ::close(descriptor_);
  open_named();
}

NewFile::NewFile(NewFile&& other) noexcept
    : path_(std::move(other.path_)),
      folder_(std::move(other.folder_)),
      temporary_(std::exchange(other.temporary_, {})),
      descriptor_(std::exchange(other.descriptor_, -1)),
      published_(std::exchange(other.published_, Published::kNot)) {}

NewFile::~NewFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void NewFile::refuse() const {
  throw InvalidInput(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
}

void NewFile::open_named() {
  do {
    const std::string name = random_name(folder_);
    if (name.empty()) refuse();
    descriptor_ = ::open(name.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, kMode);
    if (descriptor_ >= 0) temporary_ = name;
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) refuse();
}

void NewFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse();
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void NewFile::sync() {
  // EINVAL: a file system that has nothing to bring to a disk.
  while (::fsync(descriptor_) != 0 && errno != EINVAL) {
    if (errno != EINTR) refuse();
  }
}

void NewFile::give_second_name() {
  while (temporary_.empty()) {
    const std::string name = random_name(folder_);
    if (name.empty()) refuse();
    if (::linkat(AT_FDCWD, descriptor_path(descriptor_).c_str(), AT_FDCWD, name.c_str(),
                 AT_SYMLINK_FOLLOW) == 0) {
      temporary_ = name;
    } else if (errno != EEXIST) {
      refuse();
    }
  }
}

void NewFile::publish() {
  give_second_name();
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) refuse();
  const bool old = has_old_file(path_);
  if (old && swap_names(temporary_, path_)) {
    published_ = Published::kExchanged;
    return;
  }
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) refuse();
  temporary_.clear();
  published_ = old ? Published::kReplaced : Published::kNew;
}

void NewFile::take_back() noexcept {
  const Published published = std::exchange(published_, Published::kNot);
  if (published == Published::kNew) ::unlink(path_.c_str());
  if (published == Published::kExchanged) swap_names(temporary_, path_);
}

void NewFile::keep() noexcept {
  published_ = Published::kNot;
  if (!temporary_.empty()) ::unlink(std::exchange(temporary_, {}).c_str());
  const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  ::fsync(folder);
  ::close(folder);
}

}  // namespace gear3k::io
