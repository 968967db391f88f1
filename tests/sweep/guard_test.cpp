// The guard on results: a small sweep whose results are those of the revision of the models.

#include <cmath>
#include <map>

#include "io/text/csv_table.hpp"
#include "sweep/compare.hpp"
#include "sweep/model_revision.hpp"
#include "tests/sweep/small_sweep.hpp"

namespace gear3k::guard_test {
namespace {

using test::ProgramResult, test::Workplace;

struct GuardResult {
  std::string status;
  double merit = std::nan("");
};

/// By spec_key.
std::map<std::string, GuardResult> results_in(const io::CsvTable& table) {
  std::map<std::string, GuardResult> results;
  for (const io::CsvTable::Row& row : table.rows) {
    results[*table.text(row, "spec_key")] = {
        .status = *table.text(row, "status"),
        .merit = table.number(row, "merit").value_or(std::nan(""))};
  }
  return results;
}

// Where this fails, the results of tasks have changed.  If they were to: raise kModelRevision by
// one, and write tests/sweep/guard_results.csv anew, the revision in its first line:
//   gear3k sweep tests/sweep/guard.toml --out guard.db
//   gear3k sweep query guard.db "SELECT spec_key, status, merit FROM task ORDER BY id" --format csv
TEST(ModelRevision, ResultsOfTheGuardAreThoseOfThisRevision) {
  const Workplace place;
  const std::filesystem::path folder = std::filesystem::path(GEAR3K_SOURCE_DIR) / "tests" / "sweep";
  ASSERT_EQ(place.run({"sweep", (folder / "guard.toml").string(), "--out", "db"}).exit_code, 0);
  const ProgramResult found = place.run({"sweep", "query", "db", "--format", "csv",
                                         "SELECT spec_key, status, merit FROM task ORDER BY id"});
  const io::CsvTable recorded =
      io::parse_csv(test::read_text(folder / "guard_results.csv"), "guard_results.csv");
  ASSERT_EQ(recorded.notes.front(), " revision: " + std::to_string(sweep::kModelRevision));
  const auto before = results_in(recorded);
  const auto after = results_in(io::parse_csv(found.out, "stdout"));
  ASSERT_EQ(before.size(), 8U);
  EXPECT_EQ(after.size(), before.size());
  for (const auto& [spec_key, result] : after) {
    ASSERT_TRUE(before.contains(spec_key)) << spec_key << ": the form of a SPEC has changed";
    const GuardResult& old = before.at(spec_key);
    EXPECT_EQ(old.status, result.status) << spec_key;
    EXPECT_EQ(sweep::change_of(old.status, old.merit, result.status, result.merit),
              sweep::Change::kSame)
        << spec_key << ": " << old.merit << " before, " << result.merit << " now\n"
        << found.out;
  }
}

}  // namespace
}  // namespace gear3k::guard_test
