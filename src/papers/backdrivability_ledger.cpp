#include "papers/backdrivability_ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "actuator/reflected.hpp"
#include "numerics/square.hpp"
#include "report/display.hpp"

namespace gear3k::papers {

namespace {

using numerics::square, report::percent;

class BackdrivabilityLedger {
 public:
  BackdrivabilityLedger(const BackdrivabilitySources& sources,
                        const BackdrivabilityComparison& comparison)
      : sources_(sources),
        s_(sources.statements),
        c_(comparison),
        printed_(comparison.knee.runs.at(0)),
        equations_(comparison.knee.runs.at(1)),
        corrected_(comparison.knee.runs.at(2)) {}

  std::vector<LedgerEntry> entries() {
    add_inertias();
    return std::move(entries_);
  }

 private:
  void add(LedgerEntry entry) {
    entry.number = static_cast<int>(entries_.size()) + 1;
    entries_.push_back(std::move(entry));
  }

  void add_inertias() {
    const double square_ratio = square(s_.ratio);
    add({.where = "eqs. 41, 42, 45",
         .paper = fmt::format("{:g}, {:g} and {:g} kg m2", s_.eq41_inertia_kgm2,
                              s_.eq42_inertia_kgm2, s_.eq45_inertia_kgm2),
         .finding = "Table I's inertias give a tenth of each",
         .figures = {
             {"gearbox", "kg m2", square_ratio * s_.gear_inertia_kgm2, 4},
             {"motor", "kg m2", square_ratio * s_.rotor_inertia_kgm2, 4},
             {"both", "kg m2", square_ratio * (s_.gear_inertia_kgm2 + s_.rotor_inertia_kgm2), 4}}});
  }

  const BackdrivabilitySources& sources_;
  const BackdrivabilityStatements& s_;
  const BackdrivabilityComparison& c_;
  const KneeRun& printed_;
  const KneeRun& equations_;
  const KneeRun& corrected_;
  std::vector<LedgerEntry> entries_;
};

}  // namespace

std::vector<LedgerEntry> backdrivability_ledger(const BackdrivabilitySources& sources,
                                                const BackdrivabilityComparison& comparison) {
  return BackdrivabilityLedger(sources, comparison).entries();
}

}  // namespace gear3k::papers
