#include "io/files/refinement_journal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "design/checks.hpp"
#include "io/text/diagnostics.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/rig/deterministic_random.hpp"
#include "tests/sample.hpp"

namespace gear3k::io::refinement_journal_test {
namespace {

using optimize::RefinedSet;
using rig::DeterministicRandom;
using test::read_text;
using test::TemporaryFolder;
using test::write_text;

constexpr std::uint64_t kTask = 0x0123456789ABCDEFULL;

/// Any finite number, also −0, subnormal ones and the extremes.
double random_number(DeterministicRandom& random) {
  for (;;) {
    const auto x = std::bit_cast<double>(random.bits());
    if (std::isfinite(x)) return random.uniform() < 0.1 ? -0.0 : x;
  }
}

RefinedSet random_set(DeterministicRandom& random, std::uint32_t index) {
  RefinedSet s;
  s.index = index;
  const auto teeth = [&] { return 4 + static_cast<int>(random.index(300)); };
  s.candidate = {
      .teeth = {.S = teeth(), .P1 = teeth(), .R1 = teeth(), .P2 = teeth(), .R2 = teeth()},
      .planets = 3 + static_cast<int>(random.index(4))};
  s.status = static_cast<optimize::Status>(random.index(optimize::kStatusCount));
  s.grid_cut = random.uniform() < 0.5;
  s.blocked_together = random.uniform() < 0.5;
  const auto records = design::check_records();
  for (std::size_t k = random.index(4); k > 0; --k) {
    const std::size_t which = random.index(records.size() + 2);
    optimize::Miss miss{.name = which == records.size() ? "stage1_module" : "stage2_module",
                        .violation = random_number(random),
                        .amount = random_number(random),
                        .unit = "mm"};
    if (which < records.size()) {
      miss.name = records[which].name;
      miss.unit = units::unit_name(records[which].unit);
    }
    s.blocked_by.push_back(miss);
  }
  for (double& x : s.train.profile_shift) x = random_number(random);
  for (double& m : s.train.module_m) m = random_number(random);
  s.train.center_distance_m = random_number(random);
  s.eta_b = random_number(random);
  s.eta_f = random_number(random);
  if (random.uniform() < 0.5) s.eta_b_model = random_number(random);
  if (random.uniform() < 0.5) s.eta_f_model = random_number(random);
  s.lost_motion_rad = random_number(random);
  for (double& e : s.contact_ratio) e = random_number(random);
  s.ring_root_diameter_m = random_number(random);
  s.mass_kg = random_number(random);
  s.inertia_kgm2 = random_number(random);
  for (double& k : s.train.tip_shortening) k = random_number(random);
  s.train.pressure_angle_rad = random_number(random);
  s.kkt_residual = random_number(random);
  return s;
}

std::vector<RefinedSet> random_sets(std::uint64_t seed, std::size_t count) {
  DeterministicRandom random(seed);
  std::vector<RefinedSet> sets;
  sets.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    sets.push_back(random_set(random, static_cast<std::uint32_t>(7 * k + 3)));
  }
  return sets;
}

void expect_same_bits(const RefinedSet& a, const RefinedSet& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(a.candidate, b.candidate);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.grid_cut, b.grid_cut);
  EXPECT_EQ(a.blocked_together, b.blocked_together);
  ASSERT_EQ(a.blocked_by.size(), b.blocked_by.size());
  for (std::size_t k = 0; k < a.blocked_by.size(); ++k) {
    EXPECT_EQ(a.blocked_by[k].name, b.blocked_by[k].name);
    EXPECT_EQ(a.blocked_by[k].unit, b.blocked_by[k].unit);
    EXPECT_TRUE(same(a.blocked_by[k].violation, b.blocked_by[k].violation));
    EXPECT_TRUE(same(a.blocked_by[k].amount, b.blocked_by[k].amount));
  }
  for (std::size_t k = 0; k < train::kGearCount; ++k) {
    EXPECT_TRUE(same(a.train.profile_shift[k], b.train.profile_shift[k]));
  }
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_TRUE(same(a.train.module_m[k], b.train.module_m[k]));
  }
  EXPECT_TRUE(same(a.train.center_distance_m, b.train.center_distance_m));
  EXPECT_TRUE(same(a.eta_b, b.eta_b));
  EXPECT_TRUE(same(a.eta_f, b.eta_f));
  ASSERT_EQ(a.eta_b_model.has_value(), b.eta_b_model.has_value());
  ASSERT_EQ(a.eta_f_model.has_value(), b.eta_f_model.has_value());
  EXPECT_TRUE(same(a.eta_b_model.value_or(0.0), b.eta_b_model.value_or(0.0)));
  EXPECT_TRUE(same(a.eta_f_model.value_or(0.0), b.eta_f_model.value_or(0.0)));
  EXPECT_TRUE(same(a.lost_motion_rad, b.lost_motion_rad));
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    EXPECT_TRUE(same(a.contact_ratio[k], b.contact_ratio[k]));
  }
  EXPECT_TRUE(same(a.ring_root_diameter_m, b.ring_root_diameter_m));
  EXPECT_TRUE(same(a.kkt_residual, b.kkt_residual));
  EXPECT_TRUE(same(a.mass_kg, b.mass_kg));
  EXPECT_TRUE(same(a.inertia_kgm2, b.inertia_kgm2));
  for (std::size_t i = 0; i < a.train.tip_shortening.size(); ++i) {
    EXPECT_TRUE(same(a.train.tip_shortening[i], b.train.tip_shortening[i]));
  }
  EXPECT_TRUE(same(a.train.pressure_angle_rad, b.train.pressure_angle_rad));
}

void expect_same_sets(const std::vector<RefinedSet>& a, const std::vector<RefinedSet>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) expect_same_bits(a[k], b[k]);
}

class RefinementJournal : public testing::Test {
 protected:
  [[nodiscard]] std::string path() const { return (folder_.path() / "run.journal").string(); }

  /// Writes sets one by one.  @returns the lengths of the file, before the first set and after each
  std::vector<std::size_t> write(const std::vector<RefinedSet>& sets) const {
    JournalWriter writer(path(), kTask, {});
    std::vector<std::size_t> lengths{std::filesystem::file_size(path())};
    lengths.reserve(sets.size() + 1);
    for (const RefinedSet& set : sets) {
      writer.append({&set, 1});
      lengths.push_back(std::filesystem::file_size(path()));
    }
    return lengths;
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(RefinementJournal, GivesBackEverySetBitByBit) {
  const auto sets = random_sets(1, 300);
  write(sets);
  const Journal journal = read_journal(path(), kTask);
  EXPECT_TRUE(journal.exists);
  EXPECT_EQ(journal.valid_bytes, std::filesystem::file_size(path()));
  expect_same_sets(journal.sets, sets);
}

TEST_F(RefinementJournal, SortsSetsByIndex) {
  auto sets = random_sets(2, 20);
  auto shuffled = sets;
  std::reverse(shuffled.begin(), shuffled.end());
  JournalWriter(path(), kTask, {}).append(shuffled);
  expect_same_sets(read_journal(path(), kTask).sets, sets);
}

TEST_F(RefinementJournal, CutAnywhereHoldsExactlyTheWholeRecordsBeforeTheCut) {
  const auto sets = random_sets(3, sample<std::size_t>(3, 6));
  const auto lengths = write(sets);
  const std::string bytes = read_text(path());
  for (std::size_t cut = lengths.front(); cut <= bytes.size(); ++cut) {
    write_text(path(), bytes.substr(0, cut));
    const Journal journal = read_journal(path(), kTask);
    std::size_t whole = 0;
    while (whole + 1 < lengths.size() && lengths[whole + 1] <= cut) ++whole;
    ASSERT_EQ(journal.sets.size(), whole) << "cut at " << cut;
    ASSERT_EQ(journal.valid_bytes, lengths[whole]) << "cut at " << cut;
    expect_same_sets(journal.sets,
                     {sets.begin(), sets.begin() + static_cast<std::ptrdiff_t>(whole)});
  }
}

TEST_F(RefinementJournal, ChangedByteEndsItBeforeItsRecord) {
  const auto sets = random_sets(4, sample<std::size_t>(2, 5));
  const auto lengths = write(sets);
  const std::string bytes = read_text(path());
  for (std::size_t at = lengths.front(); at < bytes.size(); ++at) {
    for (const unsigned flip : {1U, 128U}) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(static_cast<unsigned char>(changed[at]) ^ flip);
      write_text(path(), changed);
      const Journal journal = read_journal(path(), kTask);
      std::size_t whole = 0;
      while (lengths[whole + 1] <= at) ++whole;
      ASSERT_EQ(journal.sets.size(), whole) << "byte " << at;
      ASSERT_EQ(journal.valid_bytes, lengths[whole]) << "byte " << at;
    }
  }
}

std::string complaint_of(const std::string& path, std::uint64_t task) {
  try {
    read_journal(path, task);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST_F(RefinementJournal, OfAnotherTaskIsRefused) {
  write(random_sets(5, 2));
  const std::string complaint = complaint_of(path(), kTask + 1);
  EXPECT_NE(complaint.find(path()), std::string::npos) << complaint;
  EXPECT_NE(complaint.find("another task"), std::string::npos) << complaint;
  EXPECT_NE(complaint.find("allowed:"), std::string::npos) << complaint;
  write_text(path(), "name = \"a file that is no journal\"\n");
  EXPECT_FALSE(complaint_of(path(), kTask).empty());
}

TEST_F(RefinementJournal, CutInItsHeaderStartsAnew) {
  const auto lengths = write(random_sets(8, 2));
  const std::string bytes = read_text(path());
  for (std::size_t cut = 0; cut < lengths.front(); ++cut) {
    write_text(path(), bytes.substr(0, cut));
    const Journal journal = read_journal(path(), kTask);
    EXPECT_FALSE(journal.exists) << "cut at " << cut;
    { const JournalWriter writer(path(), kTask, journal); }
    EXPECT_EQ(read_text(path()), bytes.substr(0, lengths.front()));
  }
}

TEST_F(RefinementJournal, ThatIsNotThereHoldsNothing) {
  const Journal journal = read_journal(path(), kTask);
  EXPECT_FALSE(journal.exists);
  EXPECT_TRUE(journal.sets.empty());
}

TEST_F(RefinementJournal, GoesOnAfterACut) {
  const auto sets = random_sets(6, 8);
  const auto lengths = write(sets);
  const std::string bytes = read_text(path());
  for (const std::size_t cut : {lengths[0], lengths[3] - 1, lengths[3], lengths[3] + 5}) {
    write_text(path(), bytes.substr(0, cut));
    const Journal journal = read_journal(path(), kTask);
    const std::size_t known = journal.sets.size();
    JournalWriter(path(), kTask, journal).append(std::span(sets).subspan(known));
    EXPECT_EQ(read_text(path()), bytes) << "cut at " << cut;
    expect_same_sets(read_journal(path(), kTask).sets, sets);
  }
}

TEST_F(RefinementJournal, StartsAnewWithoutAJournalToGoOnWith) {
  write(random_sets(7, 4));
  { const JournalWriter writer(path(), kTask, {}); }
  EXPECT_TRUE(read_journal(path(), kTask).sets.empty());
}

TEST_F(RefinementJournal, FolderThatIsMissingIsAnError) {
  EXPECT_THROW(JournalWriter(path() + "/missing/file", kTask, {}), InvalidInput);
}

TEST(TaskFingerprint, TellsContentsAndTheirOrderApart) {
  EXPECT_EQ(task_fingerprint({"one", "two"}), task_fingerprint({"one", "two"}));
  EXPECT_NE(task_fingerprint({"one", "two"}), task_fingerprint({"two", "one"}));
  EXPECT_NE(task_fingerprint({"one"}), task_fingerprint({"one", ""}));
  EXPECT_NE(task_fingerprint({"one"}), task_fingerprint({"one "}));
  EXPECT_NE(task_fingerprint({"on", "etwo"}), task_fingerprint({"one", "two"}));
}

}  // namespace
}  // namespace gear3k::io::refinement_journal_test
