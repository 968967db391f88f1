#include "io/text/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

namespace {

[[noreturn]] void refuse(const std::string& cause) {
  throw InvalidInput(fmt::format("gnuplot: {}", cause));
}

/// A file without a name, gone when it is closed.  Files instead of pipes: neither side can block
/// the other.
class NamelessFile {
 public:
  NamelessFile() {
    std::error_code status;
    std::string pattern = (std::filesystem::temp_directory_path(status) / "gear3k_XXXXXX").string();
    if (status) refuse(fmt::format("no folder for temporary files: {}", status.message()));
    descriptor_ = ::mkostemp(pattern.data(), O_CLOEXEC);
    if (descriptor_ < 0) {
      refuse(fmt::format("{}: cannot be made: {}", pattern, std::strerror(errno)));
    }
    ::unlink(pattern.c_str());
  }
  ~NamelessFile() { ::close(descriptor_); }
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }

  /// Leaves the file at its beginning.
  void write(const std::string& text) const {
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t count = ::write(descriptor_, text.data() + done, text.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) refuse(fmt::format("temporary file: {}", std::strerror(errno)));
      done += static_cast<std::size_t>(count);
    }
    rewind();
  }
  [[nodiscard]] std::string read() const {
    rewind();
    std::string text;
    std::array<char, 65536> block{};
    for (;;) {
      const ssize_t count = ::read(descriptor_, block.data(), block.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) refuse(fmt::format("temporary file: {}", std::strerror(errno)));
      if (count == 0) return text;
      text.append(block.data(), static_cast<std::size_t>(count));
    }
  }

 private:
  void rewind() const {
    if (::lseek(descriptor_, 0, SEEK_SET) != 0) {
      refuse(fmt::format("temporary file: {}", std::strerror(errno)));
    }
  }

  int descriptor_ = -1;
};

/// What the child's standard streams are.
class StreamActions {
 public:
  StreamActions() { ::posix_spawn_file_actions_init(&actions_); }
  ~StreamActions() { ::posix_spawn_file_actions_destroy(&actions_); }
  StreamActions(const StreamActions&) = delete;
  StreamActions& operator=(const StreamActions&) = delete;

  void set(int stream, const NamelessFile& file) {
    ::posix_spawn_file_actions_adddup2(&actions_, file.descriptor(), stream);
  }
  [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

}  // namespace

std::string run_gnuplot(const std::string& script) {
  const NamelessFile in;
  const NamelessFile out;
  const NamelessFile err;
  in.write(script);
  StreamActions streams;
  streams.set(STDIN_FILENO, in);
  streams.set(STDOUT_FILENO, out);
  streams.set(STDERR_FILENO, err);
  std::string program = "gnuplot";
  std::string defaults = "-d";
  const std::array<char*, 3> arguments{program.data(), defaults.data(), nullptr};
  pid_t process = 0;
  const int error =
      ::posix_spawnp(&process, program.c_str(), streams.get(), nullptr, arguments.data(), environ);
  if (error == ENOENT) {
    refuse("not found in PATH; figures need it (Debian package gnuplot-nox)");
  }
  if (error != 0) refuse(fmt::format("cannot be started: {}", std::strerror(error)));
  int status = 0;
  while (::waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) refuse(std::strerror(errno));
  }
  // An interrupt that the program handles itself ends gnuplot all the same.
  if (WIFSIGNALED(status)) refuse(fmt::format("ended by signal {}", WTERMSIG(status)));
  if (WEXITSTATUS(status) != 0) {
    refuse(fmt::format("failed with exit code {}:\n{}", WEXITSTATUS(status), err.read()));
  }
  std::string figure = out.read();
  if (figure.empty()) refuse(fmt::format("printed no figure:\n{}", err.read()));
  return figure;
}

}  // namespace gear3k::io
