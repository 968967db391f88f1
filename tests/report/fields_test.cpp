#include "report/fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace gear3k::report::fields_test {
namespace {

TEST(Fields, OneListMakesTheJsonAndTheRows) {
  Fields gear("S");
  gear.add("name", "S");
  gear.add("teeth", 21, {"teeth"});
  gear.add("tip_diameter_mm", 12.5, {"tip_diameter", "mm"});
  gear.add("undercut", true, {"undercut"});
  EXPECT_EQ(gear.json().text(),
            "{\n  \"name\": \"S\",\n  \"teeth\": 21,\n  \"tip_diameter_mm\": 12.5,\n"
            "  \"undercut\": true\n}\n");
  EXPECT_EQ(gear.csv_rows(), "S,teeth,21,,,\nS,tip_diameter,12.5,mm,,\nS,undercut,1,,,\n");
}

TEST(Fields, WhatIsNotThereIsNullAndHasNoRow) {
  Fields f("S");
  f.add("a", nullptr, {"a"});
  f.add("b", std::numeric_limits<double>::quiet_NaN(), {"b"});
  f.add("c", std::optional<double>(), {"c"});
  f.add("d", std::numeric_limits<double>::infinity(), {"d"});
  f.add("check", nullptr, {.quantity = "check", .limit = "0", .ok = "false"});
  EXPECT_EQ(f.csv_rows(), "S,check,,,0,false\n") << "a check says so where it has no value";
  EXPECT_TRUE(f.rows().empty());
  EXPECT_EQ(f.csv_values(), ",,,,\n");
  EXPECT_TRUE(f.json().at("a").is_null());
}

TEST(Fields, RowsComeByRankWithinTheirPart) {
  const auto part = [](const std::string& name) {
    Fields f(name);
    f.add("late", 1, {"late", "", 1});
    f.add("early", 2, {"early"});
    return f;
  };
  Fields whole("all");
  whole.add_list("parts", std::vector<std::string>{"A", "B"}, part, 7);
  whole.add("last", 3, {"first"});
  EXPECT_EQ(whole.csv_rows(),
            "all,first,3,,,\nA,early,2,,,\nA,late,1,,,\nB,early,2,,,\nB,late,1,,,\n");
  EXPECT_EQ(whole.json().at("parts").items().size(), 2U);
}

TEST(Fields, HeaderAndLineAreOfTheSameColumns) {
  Fields f;
  f.append("teeth", 12, {"zS"});
  f.append("teeth", 33, {"zP1"});
  f.add("meshes", false, {"meshes"});
  f.add_row("a,b", {"reason"});
  EXPECT_EQ(f.csv_header(), "zS,zP1,meshes,reason\n");
  EXPECT_EQ(f.csv_values(), "12,33,false,\"a,b\"\n");
}

}  // namespace
}  // namespace gear3k::report::fields_test
