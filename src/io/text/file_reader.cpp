#include "io/text/file_reader.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

namespace {

/// A file open for reading, closed with its owner.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

std::string system_failure() { return fmt::format("cannot be read: {}", std::strerror(errno)); }

}  // namespace

FileBytes read_bytes(const std::string& path, std::string_view what, std::size_t most_bytes) {
  constexpr std::size_t kBlock = std::size_t{1} << 16U;
  const OpenFile file(path);
  struct stat status {};
  if (file.descriptor() < 0 || ::fstat(file.descriptor(), &status) != 0) {
    return {.bytes = {}, .failure = system_failure()};
  }
  if (S_ISDIR(status.st_mode)) {
    return {.bytes = {}, .failure = fmt::format("is a directory, allowed: {}", what)};
  }
  FileBytes result;
  std::string& bytes = result.bytes;
  const std::size_t stated =
      S_ISREG(status.st_mode) ? static_cast<std::size_t>(status.st_size) : std::size_t{0};
  std::size_t length = 0;
  while (length <= most_bytes) {
    // One byte more than a regular file should hold tells its end.
    bytes.resize(std::max(std::min(stated, most_bytes) + 1, length + kBlock));
    const ssize_t count = ::read(file.descriptor(), bytes.data() + length, bytes.size() - length);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return {.bytes = {}, .failure = system_failure()};
    if (count == 0) {
      bytes.resize(length);
      return result;
    }
    length += static_cast<std::size_t>(count);
  }
  return {.bytes = {},
          .failure = fmt::format("holds more than {0} bytes, allowed: {1} of at most {0} bytes",
                                 most_bytes, what)};
}

std::string read_text(const std::string& path, std::string_view what, std::size_t most_bytes) {
  FileBytes file = read_bytes(path, what, most_bytes);
  if (!file.failure.empty()) throw InvalidInput(fmt::format("{}: {}", path, file.failure));
  return std::move(file.bytes);
}

void check_named_file(const std::string& path, std::string_view key, const std::string& of) {
  const OpenFile file(path);
  struct stat status {};
  std::string failure;
  if (file.descriptor() < 0 || ::fstat(file.descriptor(), &status) != 0) {
    failure = system_failure();
  } else if (S_ISDIR(status.st_mode)) {
    failure = "is a directory, allowed: a file";
  }
  if (!failure.empty()) {
    throw InvalidInput(fmt::format("{}: {}: {}: {}", of, key, path, failure));
  }
}

std::string text_of_named_file(const std::function<std::string(const std::string&)>& text_of_file,
                               const std::string& path, std::string_view key,
                               const std::string& of) {
  try {
    return text_of_file(path);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}: {}", of, key, error.what()));
  }
}

}  // namespace gear3k::io
