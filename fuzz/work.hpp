#pragma once
// What the fuzzers of the commands share: refusals, and little work whatever an input asks for.

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/text/diagnostics.hpp"
#include "io/text/json.hpp"
#include "optimize/specification.hpp"

namespace gear3k::fuzz {

inline const std::string kName = "fuzz.toml";
/// Of files that name others: those of the examples.
inline const std::string kNameAmongActuators = GEAR3K_SOURCE_DIR "/examples/actuators/fuzz.toml";

/// An input that is two files, with a line "---" between them.
struct TwoFiles {
  std::string first, second;
};
inline std::optional<TwoFiles> two_files(const std::string& text) {
  const std::string separator = "\n---\n";
  const auto at = text.find(separator);
  if (at == std::string::npos) return std::nullopt;
  return TwoFiles{.first = text.substr(0, at + 1), .second = text.substr(at + separator.size())};
}

/// The same of a command; refused where there is no such line.
inline TwoFiles both_files(const std::string& text) {
  auto files = two_files(text);
  if (!files) throw io::InvalidInput("no line ---");
  return *std::move(files);
}

/// An input that is several files in this way.
inline std::vector<std::string> files_of(const std::string& text) {
  std::vector<std::string> files{text};
  while (const auto two = two_files(files.back())) {
    files.back() = two->first;
    files.push_back(two->second);
  }
  return files;
}
inline bool has_more_lines(const std::string& text, std::size_t most) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n')) > most;
}

/// Does the work of a command, which may refuse its input with InvalidInput and nothing else.
/// @returns 0; of an input that is replayed, 1 when it was refused.
template <class Work>
int done_or_refused(const std::uint8_t* data, std::size_t size, Work work) {
  omp_set_num_threads(1);
  try {
    work(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const io::InvalidInput&) {
    // What a command may do.
#ifdef GEAR3K_REPLAY
    return 1;
#endif
  }
  return 0;
}

/// Writes a result as JSON, as far as its text.
inline void write(const io::Json& json) { static_cast<void>(json.text()); }

/// The first counts of a range.
inline optimize::IntegerRange first_of(const optimize::IntegerRange& range, int count) {
  return {.min = range.min, .max = std::min(range.max, range.min + count - 1)};
}

/// A specification of few tooth sets, started from one point each.
inline optimize::Specification with_little_work(optimize::Specification spec) {
  spec.teeth.S = first_of(spec.teeth.S, 2);
  spec.teeth.P1 = first_of(spec.teeth.P1, 2);
  spec.teeth.P2 = first_of(spec.teeth.P2, 4);
  spec.teeth.max_coaxial_offset = std::min(spec.teeth.max_coaxial_offset, 2);
  if (spec.planets.size() > 2) spec.planets.resize(2);
  spec.solver.starts = 1;
  spec.pareto_points = 2;
  spec.sampling.samples = std::min<std::int64_t>(spec.sampling.samples, 100);
  return spec;
}

}  // namespace gear3k::fuzz
