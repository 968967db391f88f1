#include "sweep/task.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/files/specification_file.hpp"
#include "io/text/fnv_hash.hpp"
#include "sweep/model_revision.hpp"

namespace gear3k::sweep {

namespace {

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

}  // namespace

Task task_of(const io::TomlValue& document) {
  Task task;
  std::vector<io::StatedValue> unusual;
  for (io::StatedKey& stated : io::stated_keys(document)) {
    if (!stated.usual) unusual.push_back(stated.key);
    task.values.push_back(std::move(stated.key));
  }
  const std::vector<std::string> order = order_of(unusual);
  task.spec = io::text_of(std::move(unusual), order);
  const std::uint64_t hash = io::hashed(io::kHashBasis, task.spec);
  task.spec_key = fmt::format("{:016x}", hash);
  task.key = fmt::format("{:016x}", io::hashed(hash, fmt::format("revision {}", kModelRevision)));
  return task;
}

}  // namespace gear3k::sweep
