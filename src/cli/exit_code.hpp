#pragma once

#include <array>
#include <string_view>

namespace gear3k::cli {

/// Exit codes by the contract of docs/interface.md.
enum ExitCode {
  kDone = 0,
  kUsage = 1,
  kInvalidInput = 2,
  kNoFeasibleDesign = 3,  ///< or a check failed with --strict
  kSolverFailure = 4,
  kInterrupted = 130  ///< Ctrl-C; what was done is kept
};

struct ExitMeaning {
  ExitCode code;
  std::string_view text;
};
/// As help and manual tell them.
inline constexpr std::array<ExitMeaning, 6> kExitMeanings{
    {{kDone, "done"},
     {kUsage, "usage"},
     {kInvalidInput, "invalid input"},
     {kNoFeasibleDesign, "no feasible design or (--strict) a failed check"},
     {kSolverFailure, "solver failure"},
     {kInterrupted, "interrupted (what is done is kept)"}}};

}  // namespace gear3k::cli
