#pragma once
// A ledger of errata: what a source prints and what it comes to.

#include <string>
#include <vector>

namespace gear3k::papers {

/// A computed figure of a ledger; NaN when it could not be computed.
struct Figure {
  std::string name, unit;
  double value = 0.0;
  int decimals = 3;
};

/// One erratum: place, what is printed, what it comes to, and the figures that show it.
struct LedgerEntry {
  int number = 0;
  std::string where, paper, finding;
  std::vector<Figure> figures;
};

}  // namespace gear3k::papers
