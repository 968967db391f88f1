#pragma once

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

}  // namespace gear3k::cli
