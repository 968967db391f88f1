// SWEEP files with the SPEC of their first tasks, and statements for `sweep query`.

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "entry.hpp"
#include "io/files/specification_file.hpp"
#include "sweep/questions.hpp"
#include "sweep/schema.hpp"
#include "sweep/sweep_file.hpp"
#include "sweep/task.hpp"
#include "work.hpp"

using namespace gear3k;

namespace {

std::string temporary(const std::string& name) {
  return (std::filesystem::temp_directory_path() / fmt::format("gear3k_{}_{}", getpid(), name))
      .string();
}

void read_tasks(const std::string& text) {
  const std::string path = temporary("sweep.toml");
  std::ofstream(path, std::ios::binary) << text;
  const sweep::Sweep sweep = sweep::read_sweep(path);
  for (std::uint64_t k = 0; k < std::min<std::uint64_t>(3, sweep.count()); ++k) {
    io::parse_specification(sweep::task_of(sweep.document(k)).spec, fuzz::kName);
  }
}

/// A database without results, to be read.
const sweep::Database& database() {
  static const sweep::Database empty = [] {
    const std::string path = temporary("sweep.db");
    std::filesystem::remove(path);
    {
      sweep::Database made = sweep::open_sweep_database(path, sweep::Database::Access::kCreate);
      sweep::make_result_view(made);
    }
    return sweep::open_sweep_database(path, sweep::Database::Access::kRead);
  }();
  return empty;
}

/// What a statement may do for as long, or with as much memory, as it asks for.
bool may_be_long(const std::string& sql) {
  std::string lower = sql;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* word : {"recursive", "blob", "printf", "format", "series"}) {
    if (lower.find(word) != std::string::npos) return true;
  }
  return false;
}

void ask(const std::string& text) {
  if (may_be_long(text)) return;
  const sweep::Rows rows = sweep::answer_to(database(), text);
  sweep::rows_table(rows);
  sweep::rows_csv(rows);
  sweep::rows_json(rows);
}

}  // namespace

FUZZER(sweep)(const std::uint8_t* data, std::size_t size) {
  fuzz::done_or_refused(data, size, read_tasks);
  fuzz::done_or_refused(data, size, [](const std::string& text) {
    for (const auto role : {sweep::Role::kCondition, sweep::Role::kResult}) {
      try {
        sweep::column_of(database(), text, role);
      } catch (const io::InvalidInput&) {
        // No column of this name.
      }
    }
    ask(text);
  });
  return 0;  // an input is of one of the kinds
}
