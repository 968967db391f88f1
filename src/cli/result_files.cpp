#include "cli/result_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <utility>

#include "cli/progress.hpp"
#include "cli/talk.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_writer.hpp"

namespace gear3k::cli {

namespace {

namespace fs = std::filesystem;

/// What stderr says of figures that are missing.
std::string missing_text(const Figures& figures, const std::vector<std::string>& written) {
  std::string text;
  std::vector<std::string> names;
  for (const Figures::Missing& missing : figures.missing) {
    names.push_back(missing.file);
    if (text.find(missing.cause) == std::string::npos) text += missing.cause + '\n';
  }
  return text +
         fmt::format("written without {}: {}\n",
                     figures.files.empty() ? "figures" : fmt::to_string(fmt::join(names, ", ")),
                     fmt::join(written, ", "));
}

/// One and the same for a file, whether it is there or not.
fs::path whole_path(const fs::path& path) {
  std::error_code unknown;
  // Absolute before: of a name that is not there the canonical form may be relative.
  return fs::weakly_canonical(fs::absolute(path), unknown);
}

}  // namespace

ResultFolder::ResultFolder(ResultFolderTask task) : task_(std::move(task)) {
  for (const auto* names : {&task_.files, &task_.others, &task_.figures}) {
    for (const std::string& name : *names) {
      const std::string slip = io::replaced_input(path_of(name), task_.inputs);
      if (!slip.empty()) {
        throw io::InvalidInput(fmt::format("{} {}: {}", task_.option, task_.path, slip));
      }
      if (task_.result.empty() || whole_path(path_of(name)) != whole_path(task_.result)) continue;
      throw io::InvalidInput(fmt::format("--out {}: is a file of {}, allowed: another file",
                                         task_.result, task_.option));
    }
  }
  io::expect_folder(task_.path);
  std::error_code status;
  if (fs::is_directory(task_.path, status)) lock();
}

ResultFolder::~ResultFolder() {
  std::error_code ignored;  // folders that something was put into stay
  for (auto path = made_.rbegin(); path != made_.rend(); ++path) fs::remove(*path, ignored);
  if (lock_ >= 0) ::close(lock_);
}

void ResultFolder::open() {
  if (lock_ < 0) {
    std::error_code unknown;
    for (fs::path p = task_.path; !p.empty() && !fs::exists(p, unknown); p = p.parent_path()) {
      made_.insert(made_.begin(), p.string());
      if (p == p.parent_path()) break;
    }
  }
  io::prepare_folder(task_.path);
  if (lock_ < 0) lock();
}

void ResultFolder::lock() {
  lock_ = ::open(task_.path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  made_.clear();  // folders that the other run uses
  throw io::InvalidInput(
      fmt::format("{} {}: another run is writing it; allowed: another folder, or to wait",
                  task_.option, task_.path));
}

std::string ResultFolder::path_of(const std::string& name) const {
  return (fs::path(task_.path) / name).string();
}

std::vector<std::string> ResultFolder::write(std::vector<io::FileText> files,
                                             const Figures& figures) {
  open();
  results_begin();
  files.insert(files.end(), figures.files.begin(), figures.files.end());
  std::vector<std::string> written;
  written.reserve(files.size());
  for (io::FileText& file : files) {
    file.path = path_of(file.path);
    written.push_back(file.path);
  }
  io::write_files(files, task_.inputs);
  for (const Figures::Missing& missing : figures.missing) set_aside(missing.file);
  // What is of an earlier run would pass for a result of this one.
  for (const auto* names : {&task_.figures, &task_.earlier}) {
    for (const std::string& name : *names) {
      if (std::ranges::find(written, path_of(name)) == written.end()) remove_earlier(name);
    }
  }
  if (!figures.missing.empty() && !task_.quiet) say(missing_text(figures, written));
  return written;
}

void ResultFolder::set_aside(const std::string& name) const {
  const std::string path = path_of(name);
  std::error_code status;
  if (!fs::exists(path, status)) return;
  std::string aside = path + ".previous";
  for (int n = 2; fs::exists(aside, status); ++n) aside = fmt::format("{}.previous.{}", path, n);
  fs::rename(path, aside, status);
  if (status) {
    throw io::InvalidInput(
        fmt::format("{}: is not of this run and cannot be renamed: {}", path, status.message()));
  }
  if (!task_.quiet) say(fmt::format("{}: is not of this run, renamed to {}\n", path, aside));
}

void ResultFolder::set_foreign_aside(const std::string& name) const {
  if (std::ranges::find(task_.earlier, name) == task_.earlier.end()) set_aside(name);
}

void ResultFolder::set_all_aside() const {
  for (const auto* names : {&task_.files, &task_.earlier}) {
    for (const std::string& name : *names) set_aside(name);
  }
}

void ResultFolder::remove_earlier(const std::string& name) const {
  const std::string path = path_of(name);
  std::error_code status;
  if (!fs::is_regular_file(path, status)) return;
  if (!io::replaced_input(path, task_.inputs).empty()) return;
  if (!fs::remove(path, status) || status) {
    throw io::InvalidInput(
        fmt::format("{}: is of an earlier run and cannot be removed: {}", path, status.message()));
  }
  if (!task_.quiet) say(fmt::format("{}: was of an earlier run, removed\n", path));
}

void refuse_replacing(const std::vector<std::string>& inputs, const std::string& out,
                      const std::string& figures) {
  if (!figures.empty()) io::expect_folder(figures);
  if (out.empty()) return;
  const std::string slip = io::replaced_input(out, inputs);
  if (!slip.empty()) throw io::InvalidInput("--out: " + slip);
  const bool within =
      !figures.empty() &&
      whole_path(out).parent_path() == whole_path(fs::path(figures) / "result").parent_path();
  if (!within) io::expect_file(out);
}

std::string files_text(const std::vector<std::string>& paths) {
  return paths.empty() ? "" : fmt::format("\nFiles: {}\n", fmt::join(paths, ", "));
}

}  // namespace gear3k::cli
