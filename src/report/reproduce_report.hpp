#pragma once
// What `reproduce` prints.

#include <string>

#include "report/reproduce.hpp"

namespace gear3k::report {

std::string reproduce_table(const Reproduction& r);
std::string reproduce_json(const Reproduction& r);
/// CSV with the columns gearbox, quantity, unit, paper, equations, exact, measured; the ledger's
/// figures under "ledger N" with their value as exact.
std::string reproduce_csv(const Reproduction& r);

}  // namespace gear3k::report
