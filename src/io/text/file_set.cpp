#include "io/text/file_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "io/text/diagnostics.hpp"
#include "io/text/file_writer.hpp"
#include "io/text/held_signals.hpp"
#include "io/text/new_file.hpp"

namespace gear3k::io {

namespace {

namespace fs = std::filesystem;

/// What was made on the way; removed again unless kept.
class Scaffold {
 public:
  Scaffold() = default;
  ~Scaffold() {
    std::error_code ignored;  // folders that others have put something in stay
    for (auto path = made_.rbegin(); path != made_.rend(); ++path) fs::remove(*path, ignored);
  }
  Scaffold(const Scaffold&) = delete;
  Scaffold& operator=(const Scaffold&) = delete;

  /// Makes a folder with its parents.  @throws InvalidInput
  void add_folder(const fs::path& folder) {
    std::vector<fs::path> missing;
    std::error_code unknown;
    for (fs::path p = folder; !p.empty() && !fs::exists(p, unknown); p = p.parent_path()) {
      missing.push_back(p);
      if (p == p.parent_path()) break;
    }
    made_.insert(made_.end(), missing.rbegin(), missing.rend());
    prepare_folder(folder.string());
  }
  void keep() { made_.clear(); }

 private:
  std::vector<fs::path> made_;
};

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

std::string refusal(const std::string& path, const std::string& cause) {
  return fmt::format("{}: cannot be written: {}", path, cause);
}

/// Why a name cannot be given to a new file; "" when it can.
std::string obstacle(const std::string& path, const std::vector<std::string>& inputs) {
  std::error_code unknown;
  const fs::file_status target = fs::status(path, unknown);
  if (fs::is_directory(target)) return refusal(path, "a folder has this name");
  if (fs::is_other(target)) return refusal(path, "what has this name is no regular file");
  return replaced_input(path, inputs);
}

}  // namespace

std::string replaced_input(const std::string& path, const std::vector<std::string>& inputs) {
  std::error_code unknown;
  const bool is_input = std::ranges::any_of(inputs, [&](const std::string& input) {
    return !input.empty() && fs::equivalent(path, input, unknown);
  });
  return is_input ? fmt::format("{} is an input file, allowed: another name", path) : "";
}

void write_files(const std::vector<FileText>& files, const std::vector<std::string>& inputs) {
  const HeldSignals held;
  Scaffold scaffold;
  std::string errors;
  const auto note = [&](const std::string& error) {
    if (!error.empty()) errors += (errors.empty() ? "" : "\n") + error;
  };
  std::vector<fs::path> folders;
  for (const FileText& file : files) {
    const fs::path folder = folder_of(file.path);
    if (std::ranges::find(folders, folder) == folders.end()) {
      folders.push_back(folder);
      try {
        scaffold.add_folder(folder);
      } catch (const InvalidInput& error) {
        note(error.what());
        continue;
      }
    }
    note(obstacle(file.path, inputs));
  }
  if (!errors.empty()) throw InvalidInput(errors);

  std::vector<NewFile> fresh;
  fresh.reserve(files.size());
  for (const FileText& file : files) {
    fresh.emplace_back(file.path).write(file.text);
    fresh.back().sync();
  }
  try {
    for (NewFile& file : fresh) file.publish();
  } catch (const InvalidInput&) {
    for (auto file = fresh.rbegin(); file != fresh.rend(); ++file) file->take_back();
    throw;
  }
  for (NewFile& file : fresh) file.keep();
  scaffold.keep();
}

}  // namespace gear3k::io
