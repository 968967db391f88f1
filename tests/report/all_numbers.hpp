#pragma once
// A report held against every number that it is made of: none is wrong, in another's place, or left
// out.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "io/text/csv_table.hpp"

namespace gear3k {

/// Numbers by the JSON pointers at which they stand, or by the columns of a CSV.
using Numbers = std::map<std::string, double>;

inline Numbers numbers_of(const nlohmann::json& json) {
  Numbers numbers;
  const nlohmann::json flat = json.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (value.is_number()) numbers[pointer] = value.get<double>();
  }
  return numbers;
}

/// Those of a row of a CSV; fields of words are none.
inline Numbers numbers_of(const io::CsvTable& table, std::size_t row) {
  Numbers numbers;
  for (std::size_t k = 0; k < table.header.size(); ++k) {
    const auto number = io::csv_number(table.rows.at(row).fields.at(k));
    if (number) numbers[table.header[k]] = *number;
  }
  return numbers;
}

/// The same a level further down.
inline Numbers at_path(const std::string& path, const Numbers& numbers) {
  Numbers below;
  for (const auto& [name, value] : numbers) below[path + name] = value;
  return below;
}

/// Half a unit of the twelfth digit, to which reports round what is stated in their units.
inline constexpr double kTwelfthDigit = 5e-12;

/// The report has these numbers and no others.  All of them have to differ, so that one in
/// another's place shows.
inline void expect_all_numbers(const Numbers& shown, const Numbers& stated) {
  std::map<double, std::string> names;
  for (const auto& [name, value] : stated) {
    const auto [other, is_new] = names.emplace(std::abs(value), name);
    EXPECT_TRUE(is_new) << name << " is stated to be as " << other->second;
    const auto number = shown.find(name);
    if (number == shown.end()) {
      ADD_FAILURE() << name << " is missing";
    } else {
      EXPECT_NEAR(number->second, value, kTwelfthDigit * std::abs(value)) << name;
    }
  }
  for (const auto& [name, value] : shown) {
    EXPECT_TRUE(stated.contains(name)) << name << " = " << value << " is not stated";
  }
}

/// A value for each member of a result, each another one.
class EachAnother {
 public:
  double operator()() { return last_ *= 1.0371; }

 private:
  double last_ = 2.0;
};

}  // namespace gear3k
