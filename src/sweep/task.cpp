#include "sweep/task.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/files/specification_file.hpp"
#include "io/keys/co_design_keys.hpp"
#include "io/keys/specification_keys.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/fnv_hash.hpp"
#include "sweep/axes.hpp"
#include "sweep/model_revision.hpp"

namespace gear3k::sweep {

namespace {

constexpr std::size_t kMostFileBytes = std::size_t{1} << 28U;

/// Keys without a table first, then table by table, as they come.
std::vector<std::string> order_of(const std::vector<io::StatedValue>& values) {
  std::vector<std::string> order, tables;
  for (const io::StatedValue& v : values) {
    const auto dot = v.path.rfind('.');
    if (dot == std::string::npos) {
      order.push_back(v.path);
    } else if (std::ranges::find(tables, v.path.substr(0, dot)) == tables.end()) {
      tables.push_back(v.path.substr(0, dot));
    }
  }
  order.insert(order.end(), tables.begin(), tables.end());
  return order;
}

/// The bytes of the files that a value names, each with its size.
std::uint64_t hashed_files(std::uint64_t hash, const io::TomlValue& value) {
  if (value.kind == io::TomlValue::Kind::kList) {
    for (const io::TomlValue& one : value.list) hash = hashed_files(hash, one);
  } else if (value.kind == io::TomlValue::Kind::kText && !value.text.empty()) {
    const std::string bytes = io::read_text(value.text, "a file", kMostFileBytes);
    hash = io::hashed(io::hashed_bytes(hash, bytes.size()), bytes);
  }
  return hash;
}

}  // namespace

bool names_files(std::string_view path) {
  return std::ranges::find(io::kCoDesignFileKeys, path) != io::kCoDesignFileKeys.end();
}

bool is_number_or_switch(std::string_view path) {
  const io::KeyIndex& index = io::specification_schema().index();
  const auto found = index.by_path.find(std::string(path));
  return found != index.by_path.end() &&
         index.keys[found->second].record->type == io::KeyType::kNumberOrSwitch;
}

bool has_files(const io::TomlValue& document) {
  return std::ranges::any_of(io::kCoDesignFileKeys, [&](std::string_view path) {
    return has_at(document, std::string(path));
  });
}

Task task_of(const io::TomlValue& document) {
  Task task;
  std::vector<io::StatedValue> unusual;
  for (io::StatedKey& stated : io::stated_keys(document)) {
    if (!stated.usual) unusual.push_back(stated.key);
    task.values.push_back(std::move(stated.key));
  }
  const std::vector<std::string> order = order_of(unusual);
  task.spec = io::text_of(std::move(unusual), order);
  std::uint64_t hash = io::hashed(io::kHashBasis, task.spec);
  for (const io::StatedValue& v : task.values) {
    // A task is one of its files as they are, wherever its database is asked again.
    if (names_files(v.path)) hash = hashed_files(hash, v.value);
  }
  task.spec_key = fmt::format("{:016x}", hash);
  task.key = fmt::format("{:016x}", io::hashed(hash, fmt::format("revision {}", kModelRevision)));
  return task;
}

}  // namespace gear3k::sweep
