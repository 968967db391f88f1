// All checks, from their tables.

#include <algorithm>
#include <array>

#include "design/check_tables.hpp"

namespace gear3k::design {

std::span<const CheckRecord> check_records() {
  static const std::array<CheckRecord, kCheckCount> kRecords = [] {
    std::array<CheckRecord, kCheckCount> all{};
    auto end = all.begin();
    for (const auto& table : {check_tables::gearing_checks(), check_tables::strength_checks(),
                              check_tables::workshop_checks()}) {
      end = std::ranges::copy(table, end).out;
    }
    return all;
  }();
  return kRecords;
}

}  // namespace gear3k::design
