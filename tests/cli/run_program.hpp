#pragma once
// Runs the program as a user would: in a fresh folder, with captured output.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "tests/temporary_folder.hpp"

namespace gear3k::test {

struct ProgramResult {
  int exit_code = -1;  ///< -1 when a signal ended the program
  int signal = 0;      ///< that ended it; 0 = none
  std::string out, err;
};

/// The program while it runs, and what it left when it has ended.
class RunningProgram {
 public:
  /// @param work         working folder of the program
  /// @param capture      folder for what it prints; not inside `work`
  /// @param standard_out a file to use as stdout instead, e.g. a device
  /// @param standard_err the same of stderr; "-" closes it
  RunningProgram(const std::vector<std::string>& arguments, const std::filesystem::path& work,
                 const std::filesystem::path& capture, const std::string& standard_out = "",
                 const std::string& standard_err = "")
      : out_(standard_out.empty() ? (capture / "stdout").string() : standard_out),
        err_(standard_err.empty() ? (capture / "stderr").string() : standard_err),
        out_is_file_(standard_out.empty()),
        err_is_file_(standard_err.empty()) {
    std::vector<std::string> words{GEAR3K_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    process_ = ::fork();
    if (process_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (process_ == 0) {
      const int in = ::open("/dev/null", O_RDONLY);
      const int out = ::open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      const bool no_err = err_ == "-";
      const int err = no_err ? 2 : ::open(err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      if (in < 0 || out < 0 || err < 0 || ::chdir(work.c_str()) != 0 || ::dup2(in, 0) < 0 ||
          ::dup2(out, 1) < 0 || ::dup2(err, 2) < 0) {
        ::_exit(127);
      }
      if (no_err) ::close(2);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
  }
  ~RunningProgram() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void send(int signal) const { ::kill(process_, signal); }
  [[nodiscard]] pid_t number() const { return process_; }

  /// What a descriptor of the program refers to: a path, or "" for one that is closed.
  [[nodiscard]] std::string descriptor(int number) const {
    std::error_code none;
    return std::filesystem::read_symlink(
               "/proc/" + std::to_string(process_) + "/fd/" + std::to_string(number), none)
        .string();
  }

  /// Waits until the program has a handler of its own for a signal.
  /// @returns false when it ended or the limit passed before
  bool wait_until_it_catches(int signal, std::chrono::milliseconds limit) const {
    const auto end = std::chrono::steady_clock::now() + limit;
    const std::string key = "SigCgt:";
    while (std::chrono::steady_clock::now() < end) {
      std::ifstream status("/proc/" + std::to_string(process_) + "/status");
      for (std::string word; status >> word;) {
        if (word != key) continue;
        unsigned long long mask = 0;
        status >> std::hex >> mask;
        // The test's own handlers do not survive execv, so this is the program's.
        if ((mask >> (signal - 1) & 1U) != 0) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }

  /// The result, or nothing when the program still runs after the limit.
  std::optional<ProgramResult> wait(std::chrono::milliseconds limit) {
    const auto end = std::chrono::steady_clock::now() + limit;
    int status = 0;
    while (::waitpid(process_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > end) return std::nullopt;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    process_ = -1;
    ProgramResult result;
    if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    if (out_is_file_) result.out = read_text(out_);
    if (err_is_file_) result.err = read_text(err_);
    return result;
  }

 private:
  std::string out_, err_;
  bool out_is_file_, err_is_file_;
  pid_t process_ = -1;
};

/// A working folder and the programs that run in it.
class Workplace {
 public:
  Workplace() { std::filesystem::create_directory(work()); }

  [[nodiscard]] std::filesystem::path work() const { return folder_.path() / "work"; }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return work() / name; }
  void write(const std::string& name, const std::string& text) const {
    write_text(file(name), text);
  }
  [[nodiscard]] std::string read(const std::string& name) const { return read_text(file(name)); }
  [[nodiscard]] bool has(const std::string& name) const {
    return std::filesystem::exists(file(name));
  }

  /// Paths of all files and folders below the working folder, sorted.
  [[nodiscard]] std::vector<std::string> listing() const {
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(work())) {
      paths.push_back(std::filesystem::relative(entry.path(), work()).string());
    }
    std::sort(paths.begin(), paths.end());
    return paths;
  }

  [[nodiscard]] RunningProgram start(const std::vector<std::string>& arguments,
                                     const std::string& standard_out = "",
                                     const std::string& standard_err = "") const {
    return {arguments, work(), folder_.path(), standard_out, standard_err};
  }

  /// Runs the program to its end; a minute is far beyond what any test needs.
  [[nodiscard]] ProgramResult run(const std::vector<std::string>& arguments,
                                  const std::string& standard_out = "",
                                  const std::string& standard_err = "") const {
    RunningProgram program = start(arguments, standard_out, standard_err);
    const std::optional<ProgramResult> result = program.wait(std::chrono::minutes(1));
    if (!result) {
      ADD_FAILURE() << "the program did not end";
      return {};
    }
    return *result;
  }

 private:
  TemporaryFolder folder_;
};

/// `text` with the first `from` replaced; the text must hold it.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::invalid_argument("no \"" + from + "\" in the text");
  return text.replace(at, from.size(), to);
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

inline std::string example(const std::string& name) {
  return read_text(std::filesystem::path(GEAR3K_SOURCE_DIR) / "examples" / name);
}

}  // namespace gear3k::test
