#pragma once

#include <optional>
#include <string>

namespace gear3k::papers {

/// One compared quantity; empty = nothing said or nothing to say.
struct ComparedRow {
  std::string quantity, unit;
  std::optional<double> paper;      ///< printed
  std::optional<double> equations;  ///< the paper's own equations, evaluated
  std::optional<double> exact;      ///< where the equations are an approximation or wrong
  std::optional<double> measured;
  int decimals = 4;
};

}  // namespace gear3k::papers
