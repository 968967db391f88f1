// What docs/decisions.md, 31, promises of another machine, tried with the C library's functions for
// processors without FMA.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::other_processor_test {
namespace {

using nlohmann::json, test::example, test::replaced, test::Workplace;

/// Whether WithoutFma makes a difference here; elsewhere results are those of a second run, and
/// alike to the byte.
bool has_both() {
#if defined(__x86_64__) && defined(__GLIBC__)
  return __builtin_cpu_supports("fma") != 0;
#else
  return false;
#endif
}

/// While it lives, programs that are started have elementary functions without FMA.
class WithoutFma {
 public:
  WithoutFma() {
    ::setenv("GLIBC_TUNABLES",
             "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable,-FMA4_Usable", 1);
  }
  ~WithoutFma() { ::unsetenv("GLIBC_TUNABLES"); }
  WithoutFma(const WithoutFma&) = delete;
  WithoutFma& operator=(const WithoutFma&) = delete;
};

void expect_alike(const json& here, const json& there, double tolerance) {
  const json a = here.flatten();
  const json b = there.flatten();
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [path, value] : a.items()) {
    ASSERT_TRUE(b.contains(path)) << path;
    if (!value.is_number_float()) {
      EXPECT_EQ(value, b.at(path)) << path;
      continue;
    }
    const double x = value.get<double>();
    EXPECT_NEAR(b.at(path).get<double>(), x, tolerance * (1.0 + std::abs(x))) << path;
  }
}

TEST(AnotherProcessor, GivesTheSameResultsTo1em12) {
  const Workplace place;
  bool differs = false;
  for (const auto& [command, file] : std::vector<std::pair<std::string, std::string>>{
           {"analyze", "designs/low_backlash_prototype"},
           {"analyze", "designs/ratio_96_with_losses"},
           {"map", "designs/ratio_96_with_losses"},
           {"mesh", "pairs/gearpie_c14"}}) {
    SCOPED_TRACE(fmt::format("{} {}", command, file));
    place.write("gear.toml", example(file + ".toml"));
    const std::vector<std::string> words{command, "gear.toml", "--format", "json"};
    const auto here = place.run(words);
    ASSERT_EQ(here.exit_code, 0) << here.err;
    const WithoutFma other;
    const auto there = place.run(words);
    ASSERT_EQ(there.exit_code, 0) << there.err;
    differs = differs || here.out != there.out;
    expect_alike(json::parse(here.out), json::parse(there.out), 1e-12);
  }
  EXPECT_EQ(differs, has_both());
}

/// 32 sets, most of which end at the limits of lost motion and size.
std::string some_sets() {
  std::string spec = replaced(example("ratio-96.toml"), "S = [10, 24]", "S = [12, 14]");
  spec = replaced(spec, "P1 = [18, 70]", "P1 = [60, 66]");
  return replaced(spec, "P2 = [18, 70]", "P2 = [48, 56]");
}

std::vector<std::string> teeth_of(const io::CsvTable& table) {
  std::vector<std::string> sets;
  for (const auto& row : table.rows) {
    std::string teeth;
    for (const char* gear : {"zS", "zP1", "zR1", "zP2", "zR2"}) {
      teeth += std::to_string(std::lround(table.number(row, gear).value())) + "/";
    }
    sets.push_back(teeth);
  }
  return sets;
}

TEST(AnotherProcessor, FindsTheSameBestSetAndFront) {
  const Workplace place;
  place.write("spec.toml", some_sets());
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "here", "--quiet"}).exit_code, 0);
  {
    const WithoutFma other;
    ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "there", "--quiet"}).exit_code, 0);
  }
  const auto table = [&](const std::string& path) { return io::parse_csv(place.read(path), path); };
  EXPECT_EQ(teeth_of(table("here/pareto.csv")), teeth_of(table("there/pareto.csv")));
  const io::CsvTable here = table("here/refined.csv");
  const io::CsvTable there = table("there/refined.csv");
  ASSERT_EQ(teeth_of(here), teeth_of(there));
  for (std::size_t k = 0; k < here.rows.size(); ++k) {
    for (const char* column : {"eta_b", "eta_f", "backlash_arcmin", "eta_b_bound"}) {
      const auto a = here.number(here.rows[k], column);
      const auto b = there.number(there.rows[k], column);
      ASSERT_EQ(a.has_value(), b.has_value()) << column << " of row " << k;
      if (!a) continue;
      EXPECT_NEAR(*a, *b, 1e-8 * (1.0 + std::abs(*a))) << column << " of row " << k;
    }
  }
  json summary_here = json::parse(place.read("here/summary.json"));
  json summary_there = json::parse(place.read("there/summary.json"));
  for (json* summary : {&summary_here, &summary_there}) {
    summary->erase("wall_time_s");
    summary->at("best").erase("kkt_residual");
  }
  expect_alike(summary_here, summary_there, 1e-8);
}

}  // namespace
}  // namespace gear3k::other_processor_test
