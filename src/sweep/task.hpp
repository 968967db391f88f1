#pragma once
// One task of a sweep, and what became of it.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/keys/key_registry.hpp"
#include "optimize/refined_set.hpp"
#include "report/fields.hpp"

namespace gear3k::sweep {

/// A task by what it asks for.
struct Task {
  std::string key;       ///< of the question and the revision of the models: 16 hexadecimal digits
  std::string spec_key;  ///< of the question alone
  std::string spec;  ///< the SPEC with its stated keys in one form, without those at their defaults
  std::vector<io::StatedValue> values;  ///< by key, with those at their defaults
};
/// Its keys hash the contents of the files that the SPEC names, too.
/// @param document  a SPEC
/// @throws io::InvalidInput where one of these files cannot be read
Task task_of(const io::TomlValue& document);

/// Whether the value of a key is a path, or a list of paths, of files that the task is made of.
bool names_files(std::string_view path);
/// Whether a key takes true, false or a number, as most of [limits] do.
bool is_number_or_switch(std::string_view path);
/// Whether a SPEC states a key of files.
bool has_files(const io::TomlValue& document);

/// optimal: it has a design.  no_feasible_design: every tooth set is refused, see the reasons.
/// invalid: the SPEC asks for what cannot be.  failed: the solver, or the program itself.
enum class TaskStatus : std::uint8_t { kOptimal, kNoFeasibleDesign, kInvalid, kFailed };
inline constexpr std::size_t kTaskStatusCount = 4;
inline constexpr std::array<std::string_view, kTaskStatusCount> kTaskStatusNames{
    "optimal", "no_feasible_design", "invalid", "failed"};

/// Designs of a task that are kept, the best first.
inline constexpr std::size_t kKeptDesigns = 5;

/// How many tooth sets of a task have a status for one reason; "" where it has none.
struct Refusal {
  std::string status, reason;
  std::size_t sets = 0;
};

struct TaskResult {
  TaskStatus status = TaskStatus::kFailed;
  std::string reason;             ///< in words, where it has no design
  std::size_t sets = 0;           ///< tooth sets that fit the ratio
  std::optional<double> merit;    ///< of the best design: its objective, more is better
  std::optional<double> bound;    ///< what no design is above, where the task was certified
  std::vector<Refusal> refusals;  ///< of the sets without a design
  std::string best;               ///< the best as a DESIGN file
  std::vector<std::vector<report::FieldRow>> designs;  ///< columns of refined.csv that have a value
  bool interrupted = false;                            ///< nothing of it is known then
};

}  // namespace gear3k::sweep
