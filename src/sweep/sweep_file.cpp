#include "sweep/sweep_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

#include "io/files/document_kind.hpp"
#include "io/files/specification_file.hpp"
#include "io/keys/material_keys.hpp"
#include "io/keys/specification_keys.hpp"
#include "io/keys/strength_keys.hpp"
#include "io/text/file_reader.hpp"
#include "sweep/task.hpp"

namespace gear3k::sweep {

namespace {

using io::TomlValue;

struct SweepInput {
  std::string name;
  std::optional<std::string> spec;
};

const io::Schema<SweepInput>& sweep_schema() {
  static const io::Schema<SweepInput> schema = [] {
    std::vector<io::Key<SweepInput>> keys;
    keys.push_back(io::make_key<SweepInput>({.path = "name",
                                             .type = io::KeyType::kText,
                                             .default_text = "\"\"",
                                             .help = "of the sweep, in status and figures"},
                                            &SweepInput::name));
    keys.push_back(io::make_key<SweepInput>(
        {.path = "spec",
         .type = io::KeyType::kText,
         .default_text = "[task]",
         .help = "SPEC.toml of the keys that all tasks share, beside the SWEEP file, in place of a "
                 "table [task] that states them"},
        &SweepInput::spec));
    return io::Schema<SweepInput>({}, std::move(keys));
  }();
  return schema;
}

/// Takes a table out of the document.
std::optional<TomlValue> taken(TomlValue& document, const char* key, io::FileReading& reading) {
  const auto found = std::ranges::find(document.table, key, &TomlValue::key);
  if (found == document.table.end()) return std::nullopt;
  TomlValue table = std::move(*found);
  document.table.erase(found);
  if (table.kind == TomlValue::Kind::kTable) return table;
  reading.error(table.position,
                fmt::format("{} = {}: allowed: a table [{}]", key, io::as_text(table), key));
  return std::nullopt;
}

/// Makes paths absolute: a database may be gone on with from any folder.
void set_folder(TomlValue& value, const std::filesystem::path& folder) {
  for (TomlValue& one : value.list) set_folder(one, folder);
  if (value.kind != TomlValue::Kind::kText || value.text.empty()) return;
  value.text = std::filesystem::absolute(folder / value.text).lexically_normal().string();
}

/// The same for every key under a table that names files.
void set_folder_under(TomlValue& table, const std::string& prefix,
                      const std::filesystem::path& folder) {
  for (TomlValue& member : table.table) {
    const std::string path = prefix + member.key;
    if (names_files(path)) set_folder(member, folder);
    set_folder_under(member, path + ".", folder);
  }
}

/// Keys of the task that are varied as well.
void check_stated_twice(const Sweep& sweep, const TomlValue& vary, io::FileReading& reading) {
  for (const std::string& path : sweep.varied()) {
    if (!has_at(sweep.task, path)) continue;
    reading.error(vary.position,
                  fmt::format("{} is stated by the task and varied: allowed: one of them", path));
  }
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Whether one of the first tasks fits together.
/// @throws io::InvalidInput with what is wrong with the first where none does
void try_tasks(const Sweep& sweep) {
  std::string first;
  for (std::uint64_t k = 0; k < std::min(kTriedTasks, sweep.count()); ++k) {
    try {
      io::specification_of(sweep.document(k), sweep.task_file);
      return;
    } catch (const io::InvalidInput& error) {
      if (k == 0) first = error.what();
    }
  }
  throw io::InvalidInput(first);
}

/// Makes paths of files absolute, and forgets where values of axes stand: places of values are
/// those of the SWEEP file, and messages name the SPEC where the task is one.
/// @param folder  of the SWEEP file
void place_in(Sweep& sweep, const std::string& folder, bool inlined) {
  set_folder_under(sweep.task, "", std::filesystem::path(sweep.task_file).parent_path());
  for (Axis& axis : sweep.axes) {
    for (std::size_t p = 0; p < axis.paths.size(); ++p) {
      if (!names_files(axis.paths[p])) continue;
      for (auto& point : axis.points) set_folder(point[p], folder);
    }
    if (inlined) continue;
    for (auto& point : axis.points) {
      for (TomlValue& value : point) value.position = {};
    }
  }
}

/// Lines of a text that another one does not have.
std::vector<std::string> lines_beside(const std::string& text, const std::string& other) {
  const std::vector<std::string> others = lines_of(other);
  std::vector<std::string> lines = lines_of(text);
  std::erase_if(lines, [&](const std::string& line) {
    return std::ranges::find(others, line) != others.end();
  });
  return lines;
}

/// Lines that the first tasks are all refused with, those of what is known aside: they are wrong
/// whatever is varied.
std::vector<std::string> common_errors(const Sweep& sweep, const std::string& known) {
  constexpr std::uint64_t kMost = 100;
  std::vector<std::string> common;
  for (std::uint64_t k = 0; k < std::min(kMost, sweep.count()); ++k) {
    io::CollectedErrors of_task;
    of_task.attempt([&] { io::specification_of(sweep.document(k), sweep.task_file); });
    const std::vector<std::string> lines = lines_beside(of_task.text(), known);
    if (k == 0) common = lines;
    std::erase_if(common, [&](const std::string& line) {
      return std::ranges::find(lines, line) == lines.end();
    });
    if (common.empty()) break;
  }
  return common;
}

/// Adds what else is wrong with the task, beside errors of the SWEEP file: without any it is read
/// as a whole.
/// @param vary_is_good  what is varied has no errors
void add_errors_of_task(const Sweep& sweep, const Vary& vary, bool vary_is_good,
                        io::CollectedErrors& errors) {
  const std::string known = errors.text();
  if (vary_is_good) {
    errors.add(common_errors(sweep, known));
    return;
  }
  io::FileReading spec(sweep.task_file);
  io::check_keys(sweep.task, spec);
  if (vary.paths_known) {
    for (const io::ExpandedKey& key : io::specification_schema().index().keys) {
      if (!key.record->required || vary.paths.contains(key.path)) continue;
      if (!has_at(sweep.task, key.path)) io::say_missing(key, spec);
    }
  }
  io::CollectedErrors of_keys;
  of_keys.attempt([&] { spec.throw_if_invalid(); });
  errors.add(lines_beside(of_keys.text(), known));
}

}  // namespace

std::vector<std::string> Sweep::varied() const {
  std::vector<std::string> paths;
  for (const Axis& axis : axes) paths.insert(paths.end(), axis.paths.begin(), axis.paths.end());
  return paths;
}

TomlValue Sweep::document(std::uint64_t k) const {
  TomlValue document = task;
  for (auto axis = axes.rbegin(); axis != axes.rend(); ++axis) {
    const std::vector<TomlValue>& point = axis->points[k % axis->points.size()];
    k /= axis->points.size();
    for (std::size_t p = 0; p < axis->paths.size(); ++p) {
      set_at(document, axis->paths[p], point[p]);
    }
  }
  return document;
}

Sweep read_sweep(const std::string& path) {
  Sweep sweep;
  sweep.source = io::read_toml_text(path);
  TomlValue document = io::parse_toml(sweep.source, path);
  io::FileReading reading(path);
  std::optional<TomlValue> task = taken(document, "task", reading);
  const std::optional<TomlValue> vary = taken(document, "vary", reading);
  if (!task && std::ranges::find(document.table, "spec", &TomlValue::key) == document.table.end()) {
    io::refuse_other_documents(document, path, {},
                               "SWEEP takes a file with spec = \"SPEC.toml\" or [task]");
  }
  SweepInput input;
  io::read_by_schema(document, sweep_schema(), input, reading);
  sweep.name = input.name;
  sweep.task_file = path;
  const std::string folder = std::filesystem::path(path).parent_path().string();
  io::CollectedErrors of_spec;
  const bool inlined = task.has_value();
  if (inlined == input.spec.has_value()) {
    reading.error_at("spec", inlined ? "spec and [task]: allowed: one of them"
                                     : "no task: allowed: spec = \"SPEC.toml\", or a table [task]");
  } else if (input.spec) {
    sweep.task_file = (std::filesystem::path(folder) / *input.spec).string();
    of_spec.attempt([&] {
      const std::string text = io::text_of_named_file(io::read_toml_text, sweep.task_file, "spec",
                                                      reading.place_of("spec"));
      task = io::parse_toml(text, sweep.task_file);
    });
  }
  if (task) {
    sweep.task = io::with_material_tables(*task, io::train_gear_tables());
    if (inlined) io::check_keys(sweep.task, reading);
  }
  Vary varied;
  const std::size_t before = reading.count();
  if (vary) varied = read_vary(*vary, folder, reading);
  const bool vary_is_good = reading.count() == before && !varied.of_rows.any();
  sweep.axes = std::move(varied.axes);
  if (vary) check_stated_twice(sweep, *vary, reading);
  if (task) place_in(sweep, folder, inlined);
  io::CollectedErrors errors;
  errors.attempt([&] { reading.throw_if_invalid(); });
  errors.attempt([&] { of_spec.raise(); });
  errors.attempt([&] { varied.of_rows.raise(); });
  if (errors.any() && task) add_errors_of_task(sweep, varied, vary_is_good, errors);
  errors.raise();
  try_tasks(sweep);
  return sweep;
}

std::string sweep_key_table() { return io::key_table(sweep_schema()); }

}  // namespace gear3k::sweep
