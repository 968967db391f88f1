#pragma once

#include <optional>
#include <string>

namespace gear3k::papers {

/// One compared quantity; empty = nothing said or nothing to say.
struct ComparedRow {
  std::string quantity, unit;
  std::optional<double> paper;      ///< printed, see source
  std::optional<double> equations;  ///< the paper's own equations, evaluated
  std::optional<double> exact;      ///< where the equations are an approximation or wrong
  std::optional<double> measured;
  int decimals = 4;
  std::string source{};  ///< where `paper` is printed; empty where the quantity says it
};

}  // namespace gear3k::papers
