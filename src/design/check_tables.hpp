#pragma once
// The tables of checks, which follow each other in the order of CheckId: internal to the registry.

#include <array>
#include <span>

#include "design/checks.hpp"

namespace gear3k::design::check_tables {

/// A record with what its check evaluates, for a value, a gradient and a Hessian.
template <class Check>
CheckRecord with_values(CheckRecord record) {
  record.value = &Check::template value<double>;
  record.value1 = &Check::template value<Jet1>;
  record.value2 = &Check::template value<Jet2>;
  return record;
}

std::span<const CheckRecord> gearing_checks();
std::span<const CheckRecord> strength_checks();
std::span<const CheckRecord> workshop_checks();

}  // namespace gear3k::design::check_tables
