#include "report/tooth_set_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace gear3k::report {

std::string teeth_text(const train::ToothSet& z) {
  return fmt::format("{}", fmt::join(train::teeth_of(z), "/"));
}

std::vector<std::string> teeth_fields(const train::ToothSet& z) {
  std::vector<std::string> fields;
  fields.reserve(train::kGearCount);
  for (const int teeth : train::teeth_of(z)) fields.push_back(fmt::format("{}", teeth));
  return fields;
}

}  // namespace gear3k::report
