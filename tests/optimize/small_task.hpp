#pragma once
// A task of a few dozen tooth sets about 40:1.

#include <fmt/format.h>

#include <string>

namespace gear3k::optimize::test {

struct ToothRange {
  int least = 0, most = 0;
};
struct SmallTask {
  ToothRange S, P1, P2;
};

/// Text of the task; tables for more of it may follow, and keys of the top level come before it.
inline std::string small_task(const SmallTask& teeth) {
  const auto range = [](const ToothRange& r) { return fmt::format("[{}, {}]", r.least, r.most); };
  return fmt::format(R"([ratio]
target = 40.0
tolerance = 0.02
[teeth]
S = {}
P1 = {}
P2 = {}
R1_max = 80
R2_max = 80
[module]
stage1_mm = {{ min = 0.5, max = 0.8 }}
stage2_mm = {{ min = 0.5, max = 0.8 }}
[profile_shift]
range = [-0.2, 0.8]
)",
                     range(teeth.S), range(teeth.P1), range(teeth.P2));
}

}  // namespace gear3k::optimize::test
