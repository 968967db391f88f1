#include "cli/front_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "io/files/design_file.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_reader.hpp"
#include "report/search_report.hpp"

namespace gear3k::cli {

namespace {

constexpr const char* kColumn = "design_file";
constexpr std::size_t kMostBytes = std::size_t{1} << 24U;  // of a pareto.csv, far beyond any front

/// Whether a name is one of front_file_name(), and so of a file within the folder.
bool is_front_file(std::string_view name) {
  constexpr std::string_view kBegin = "front_", kEnd = ".toml";
  if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) return false;
  if (name.size() <= kBegin.size() + kEnd.size()) return false;
  name.remove_prefix(kBegin.size());
  name.remove_suffix(kEnd.size());
  return std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::vector<std::string> possible_front_files(const optimize::Specification& spec) {
  std::vector<std::string> names;
  if (spec.objectives.size() < 2) return names;
  // Every objective has its end, however few designs are asked for.
  const std::size_t most =
      std::max(static_cast<std::size_t>(spec.pareto_points), spec.objectives.size());
  for (std::size_t row = 0; row < most; ++row) names.push_back(report::front_file_name(row));
  return names;
}

std::vector<std::string> earlier_front_files(const std::string& folder) {
  const std::string path = (std::filesystem::path(folder) / "pareto.csv").string();
  std::vector<std::string> names;
  std::error_code none;
  if (!std::filesystem::exists(path, none)) return names;
  try {
    const io::CsvTable front = io::parse_csv(io::read_text(path, "a CSV file", kMostBytes), path);
    if (std::ranges::find(front.header, kColumn) == front.header.end()) return names;
    for (const io::CsvTable::Row& row : front.rows) {
      std::string name = front.text(row, kColumn).value_or("");
      if (is_front_file(name)) names.push_back(std::move(name));
    }
  } catch (const io::InvalidInput&) {
    names.clear();  // no file of this program
  }
  return names;
}

std::vector<io::FileText> front_files(const std::vector<design::Design>& designs) {
  std::vector<io::FileText> files;
  files.reserve(designs.size());
  for (std::size_t row = 0; row < designs.size(); ++row) {
    files.push_back({.path = report::front_file_name(row), .text = io::design_text(designs[row])});
  }
  return files;
}

std::string front_files_text(std::size_t designs) {
  if (designs == 0) return "";
  const std::string first = report::front_file_name(0);
  return designs == 1 ? first + ", "
                      : fmt::format("{} to {}, ", first, report::front_file_name(designs - 1));
}

}  // namespace gear3k::cli
