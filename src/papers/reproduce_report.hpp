#pragma once
// What `reproduce` prints.

#include <string>

#include "io/text/json.hpp"
#include "papers/reproduce.hpp"

namespace gear3k::papers {

std::string reproduce_table(const Reproduction& r);
io::Json reproduce_json(const Reproduction& r);
/// CSV with the columns gearbox, quantity, unit, paper, equations, exact, measured; the ledger's
/// figures under "ledger N" with their value as exact.  The thesis's maps and models stand under
/// equations, its residuals and its ledger ("thesis ledger N") under exact.
std::string reproduce_csv(const Reproduction& r);

}  // namespace gear3k::papers
