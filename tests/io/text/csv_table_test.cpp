#include "io/text/csv_table.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "report/text_table.hpp"

namespace gear3k::io::csv_table_test {
namespace {

using Fields = std::vector<std::string>;

Fields fields_of(const std::string& line) {
  // A header as wide as the line is whatever the line holds.
  return parse_csv(line + "\n", "data.csv").header;
}

std::string message_of(const std::string& text) {
  try {
    parse_csv(text, "data.csv");
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(ParseCsv, SplitsAtCommas) { EXPECT_EQ(fields_of("a,b c,"), (Fields{"a", "b c", ""})); }

TEST(ParseCsv, QuotesKeepCommas) {
  EXPECT_EQ(fields_of("\"S-P1, S\",check"), (Fields{"S-P1, S", "check"}));
}

TEST(ParseCsv, DoubledQuotesAreOne) {
  EXPECT_EQ(fields_of("\"a \"\"b\"\" c\",\"\""), (Fields{"a \"b\" c", ""}));
}

TEST(ParseCsv, ReadsBackWhatReportsWrite) {
  for (const Fields& fields : {Fields{"plain", "", "3.5"}, Fields{"S-P1, S", "\"", "\"\""},
                               Fields{",", "a\"b,c", " x "}, Fields{"", ""}}) {
    const std::string line = report::csv_line(fields);
    EXPECT_TRUE(line.ends_with('\n'));
    EXPECT_EQ(parse_csv(line, "data.csv").header, fields) << line;
  }
}

TEST(ParseCsv, QuotesOnlyWhereNeeded) {
  EXPECT_EQ(report::csv_line({"a", "b c", "1.5"}), "a,b c,1.5\n");
  EXPECT_EQ(report::csv_line({"a,b", "say \"x\""}), "\"a,b\",\"say \"\"x\"\"\"\n");
}

TEST(CsvLine, KeepsNamesFromBeingFormulas) {
  EXPECT_EQ(report::csv_line({"=cmd|' /C calc'!A0", "+1+1", "-a", "@SUM(A1)"}),
            "'=cmd|' /C calc'!A0,'+1+1,'-a,'@SUM(A1)\n");
  EXPECT_EQ(report::csv_line({"=a,b"}), "\"'=a,b\"\n");
  EXPECT_EQ(report::csv_line({"-1.5e-3", "+2", "-inf", "a=b", ""}), "-1.5e-3,+2,-inf,a=b,\n");
}

TEST(CsvLine, ShowsControlCharacters) {
  EXPECT_EQ(report::csv_line({"a\nb", "\t=1", "\x1b[2J", "\xff"}),
            "a\\u000ab,\\u0009=1,\\u001b[2J,\\xff\n");
}

TEST(TextTable, ShowsControlCharactersInTheirWidth) {
  report::TextTable table({"name", "n"});
  table.add({"\x1b[2J", "1"});
  table.add({"a", "22"});
  EXPECT_EQ(table.text(0), "name        n\n\\u001b[2J   1\na          22\n");
}

TEST(CsvFields, KnowTheColumnThatEachBeginsAt) {
  CsvFields fields;
  ASSERT_TRUE(fields.split("ab, c,,\"x,\"\"y\"\"\",1"));
  EXPECT_EQ(fields.values(), (std::vector<std::string_view>{"ab", " c", "", "x,\"y\"", "1"}));
  for (const auto& [field, column] : {std::pair(0U, 1), std::pair(1U, 4), std::pair(2U, 7),
                                      std::pair(3U, 8), std::pair(4U, 18)}) {
    EXPECT_EQ(fields.column(field), column) << field;
  }
  EXPECT_FALSE(fields.split("a,\"b"));
}

TEST(ParseCsv, LinesWithAHashAreNotesWhereverTheyStand) {
  const CsvTable table = parse_csv("# kind: lost_motion\na,b\n#between\n1,2\n", "data.csv");
  EXPECT_EQ(table.notes, (Fields{" kind: lost_motion", "between"}));
  EXPECT_EQ(table.header, (Fields{"a", "b"}));
  ASSERT_EQ(table.rows.size(), 1U);
}

TEST(ParseCsv, RowsKnowTheirLineAcrossNotesBlankLinesAndLineEnds) {
  const CsvTable table = parse_csv("# note\r\na,b\r\n\r\n1,2\r\n3,4", "data.csv");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].line, 4);
  EXPECT_EQ(table.rows[0].fields, (Fields{"1", "2"}));
  EXPECT_EQ(table.rows[1].line, 5);
  EXPECT_EQ(table.rows[1].fields, (Fields{"3", "4"}));
}

TEST(ParseCsv, OfAnEmptyTextHoldsNothing) {
  const CsvTable table = parse_csv("", "data.csv");
  EXPECT_TRUE(table.notes.empty());
  EXPECT_TRUE(table.header.empty());
  EXPECT_TRUE(table.rows.empty());
}

TEST(ParseCsv, ReportsEveryRowOfAnotherWidthAtOnce) {
  const std::string message = message_of("a,b,c\n1,2\n1,2,3\n1,2,3,4\n");
  EXPECT_NE(message.find("data.csv:2:1: 2 fields, allowed: 3"), std::string::npos) << message;
  EXPECT_NE(message.find("data.csv:4:1: 4 fields, allowed: 3"), std::string::npos) << message;
  EXPECT_EQ(message.find("data.csv:3:"), std::string::npos) << message;
  EXPECT_LT(message.find(":2:1:"), message.find(":4:1:"));
}

TEST(CsvTable, FindsFieldsByColumn) {
  const CsvTable table = parse_csv("speed,torque\n10,0.25\n,1e-3\n", "data.csv");
  EXPECT_EQ(table.text(table.rows[0], "torque"), "0.25");
  EXPECT_EQ(table.number(table.rows[0], "torque"), 0.25);
  EXPECT_EQ(table.number(table.rows[1], "torque"), 1e-3);
}

TEST(CsvTable, BlankFieldIsNoValue) {
  const CsvTable table = parse_csv("speed,torque\n,1\n", "data.csv");
  EXPECT_EQ(table.text(table.rows[0], "speed"), std::nullopt);
  EXPECT_EQ(table.number(table.rows[0], "speed"), std::nullopt);
}

TEST(CsvTable, UnknownColumnNamesTheKnownOnes) {
  const CsvTable table = parse_csv("speed,torque\n1,2\n", "data.csv");
  try {
    static_cast<void>(table.text(table.rows[0], "power"));
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what();
    for (const char* word : {"power", "speed", "torque"}) {
      EXPECT_NE(message.find(word), std::string::npos) << message;
    }
  }
}

TEST(CsvTable, TextForANumberIsAnErrorWithLineColumnAndValue) {
  for (const char* value : {"fast", "1.5x", "1,5", "--1", "0x1p3", "1 2"}) {
    const CsvTable table =
        parse_csv("speed,torque\n1,1\n" + report::csv_line({value, "1"}), "data.csv");
    try {
      static_cast<void>(table.number(table.rows[1], "speed"));
      FAIL() << "no exception for " << value;
    } catch (const InvalidInput& error) {
      const std::string message = error.what();
      for (const std::string& word : {std::string("data.csv:3:"), std::string("speed"),
                                      std::string(value), std::string("a finite number")}) {
        EXPECT_NE(message.find(word), std::string::npos) << message;
      }
    }
  }
}

}  // namespace
}  // namespace gear3k::io::csv_table_test
