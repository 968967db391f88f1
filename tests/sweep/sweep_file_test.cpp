#include "sweep/sweep_file.hpp"

#include <cmath>
#include <set>
#include <tuple>

#include "tests/sweep/small_sweep.hpp"

namespace gear3k::sweep_file_test {
namespace {

using test::kSmallTask, test::refusal_of, test::Workplace;

sweep::Sweep read(const Workplace& place, const std::string& text) {
  place.write("sweep.toml", text);
  return sweep::read_sweep(place.file("sweep.toml").string());
}

/// What read() refuses, without the folder.
std::string refused(const Workplace& place, const std::string& text) {
  std::string message = refusal_of([&] { read(place, text); });
  const std::string folder = place.work().string() + "/";
  for (auto at = message.find(folder); at != std::string::npos; at = message.find(folder)) {
    message.erase(at, folder.size());
  }
  return message;
}

const io::TomlValue& at(const io::TomlValue& document, const std::string& path) {
  const io::TomlValue* table = &document;
  std::istringstream parts(path);
  for (std::string key; std::getline(parts, key, '.');) {
    table = &*std::find_if(table->table.begin(), table->table.end(),
                           [&](const io::TomlValue& member) { return member.key == key; });
  }
  return *table;
}

std::vector<double> numbers_of(const sweep::Axis& axis) {
  std::vector<double> numbers;
  for (const auto& point : axis.points) numbers.push_back(point.front().number);
  return numbers;
}

TEST(SweepFile, AGridHasEveryCombinationOnce) {
  const Workplace place;
  const sweep::Sweep sweep = read(place, test::kSmallSweep);
  ASSERT_EQ(sweep.count(), 8U);
  std::set<std::tuple<double, std::int64_t, double>> seen;
  for (std::uint64_t k = 0; k < sweep.count(); ++k) {
    const io::TomlValue document = sweep.document(k);
    seen.emplace(at(document, "ratio.target").number, at(document, "planets").integer,
                 at(document, "friction.coefficient").number);
    EXPECT_EQ(at(document, "teeth.R1_max").integer, 80);
  }
  EXPECT_EQ(seen.size(), 8U);
}

TEST(SweepFile, RangesHaveBothEndsAndTheirSteps) {
  const Workplace place;
  const auto axis = [&](const std::string& vary) {
    return read(place, kSmallTask + "planets = 4\n[vary]\n" + vary).axes.front();
  };
  // The sum of tenths is no multiple of a tenth in binary; the file's value is the decimal.
  EXPECT_EQ(numbers_of(axis("ratio.target = { min = 39.8, max = 40.2, step = 0.1 }")),
            (std::vector<double>{39.8, 39.9, 40.0, 40.1, 40.2}));
  EXPECT_EQ(numbers_of(axis("ratio.target = { min = 40, max = 42.5, step = 1 }")),
            (std::vector<double>{40, 41, 42}));
  EXPECT_EQ(numbers_of(axis("ratio.target = { min = 40, max = 41, count = 3 }")),
            (std::vector<double>{40, 40.5, 41}));
  const auto logarithmic =
      numbers_of(axis("ratio.target = { min = 40, max = 160, count = 5, log = true }"));
  ASSERT_EQ(logarithmic.size(), 5U);
  for (std::size_t k = 1; k < logarithmic.size(); ++k) {
    // 12 significant digits are kept.
    EXPECT_NEAR(logarithmic[k] / logarithmic[k - 1], std::sqrt(2.0), 1e-11);
  }
  const sweep::Sweep both = read(place, kSmallTask +
                                            "planets = 4\n[vary]\nratio.target = "
                                            "[40.0]\nteeth.max_coaxial_offset = { min = 1, max = "
                                            "4, count = 4 }\n");
  EXPECT_EQ(both.count(), 4U);
}

TEST(SweepFile, ZippedListsMoveTogetherAndRowsComeFromACsv) {
  const Workplace place;
  place.write("rows.csv", "planets,backlash.model\n4,paper\n3,kinematic\n");
  const sweep::Sweep sweep =
      read(place, kSmallTask +
                      "[vary]\nrows = \"rows.csv\"\n[[vary.zip]]\nratio.target = [40.0, "
                      "44.0]\nfriction.coefficient = [0.05, 0.1]\n");
  ASSERT_EQ(sweep.count(), 4U);
  std::set<std::tuple<double, double, std::int64_t, std::string>> seen;
  for (std::uint64_t k = 0; k < 4; ++k) {
    const io::TomlValue document = sweep.document(k);
    seen.emplace(at(document, "ratio.target").number, at(document, "friction.coefficient").number,
                 at(document, "planets").integer, at(document, "backlash.model").text);
  }
  const std::set<std::tuple<double, double, std::int64_t, std::string>> expected{
      {40.0, 0.05, 4, "paper"},
      {40.0, 0.05, 3, "kinematic"},
      {44.0, 0.1, 4, "paper"},
      {44.0, 0.1, 3, "kinematic"}};
  EXPECT_EQ(seen, expected);
}

TEST(SweepFile, ASpecBesideItIsTheTask) {
  const Workplace place;
  place.write("spec.toml", test::example("rp96.toml"));
  const sweep::Sweep sweep =
      read(place, "spec = \"spec.toml\"\n[vary]\nstage1.face_width_mm = [6, 8, 10]\n");
  EXPECT_EQ(sweep.count(), 3U);
  const std::string message = refused(place, "spec = \"spec.toml\"\n[vary]\nplanets = [3, 4]\n");
  EXPECT_EQ(message,
            "sweep.toml:2:2: planets is stated by the task and varied: allowed: one of them");
}

TEST(SweepFile, AllErrorsAreToldAtOnceWithTheirPlaces) {
  const Workplace place;
  EXPECT_EQ(refused(place, kSmallTask + "friction.coefficient = [0.1, 0.2]\n" + R"([vary]
ratio.target = { min = 48.0, max = 40.0, count = 3 }
ratio.tolerence = [0.1]
planets = [3, 40, 9]
size.max_ring_root_diameter_mm = { min = 1, max = 2 }
backlash.max_output_arcmin = [1.0]
friction.loss_model = ["sliding", "slidng"]
teeth.min_internal_difference = [[8, 9]]
teeth.max_coaxial_offset = { min = 1, max = 2, step = 0 }
contact_ratio.range = []
name = ["a"]
)"),
            R"(sweep.toml:13:10: friction.coefficient = [0.1, 0.2]: allowed: a number, 0 to 1
sweep.toml:14:2: backlash.max_output_arcmin is stated by the task and varied: allowed: one of them
sweep.toml:15:7: vary.ratio.target = { min = 48.0, max = 40.0, count = 3 }: allowed: min < max
sweep.toml:16:7: unknown key ratio.tolerence; did you mean ratio.tolerance?
sweep.toml:17:15: planets = 40: allowed: an integer or a list of integers, 1 to 24
sweep.toml:18:6: vary.size.max_ring_root_diameter_mm = { min = 1, max = 2 }: allowed: min, max, and one of step and count
sweep.toml:20:35: friction.loss_model = "slidng": allowed: "sliding" or "ohlendorf" or "coulomb_path" or "directional"; did you mean "sliding"?
sweep.toml:21:34: teeth.min_internal_difference = [8, 9]: allowed: an integer, 1 to 100
sweep.toml:22:48: vary.teeth.max_coaxial_offset.step = 0: allowed: a number above 0
sweep.toml:23:15: vary.contact_ratio.range = []: allowed: one value or more
sweep.toml:24:1: name: names no task: allowed: keys that change a result)");
  EXPECT_EQ(refused(place, kSmallTask + "planets = 4\n[vary]\nratio.target = { min = 1, max = 1e9, "
                                        "step = 1 }\n"),
            "sweep.toml:15:7: vary.ratio.target = { min = 1, max = 1000000000.0, step = 1 }: gives "
            "more values than may be: allowed: at most 1000000");
  EXPECT_EQ(refused(place, "[vary]\nplanets = [3]\n"),
            "sweep.toml:1:1: no task: allowed: spec = \"SPEC.toml\", or a table [task]");
  place.write("rows.csv", "planets,ratio.targt\n4,40\n");
  EXPECT_EQ(refused(place, kSmallTask + "[vary]\nrows = \"rows.csv\"\n"),
            "rows.csv:1:1: unknown key ratio.targt; did you mean ratio.target?");
  place.write("rows.csv", "planets,ratio.target\n4,40\n44,forty\n");
  EXPECT_EQ(refused(place, kSmallTask + "[vary]\nrows = \"rows.csv\"\n"),
            "rows.csv:3:1: planets = 44: allowed: an integer or a list of integers, 1 to 24\n"
            "rows.csv:3:1: ratio.target = \"forty\": allowed: a number, -100000 to 100000");
}

TEST(SweepFile, FilesThatItNamesHideNoErrors) {
  const Workplace place;
  const std::string vary = "[vary]\nplanetz = [3]\nrows = \"none.csv\"\nratio.traget = [40]\n";
  const std::string first =
      "sweep.toml:3:1: unknown key planetz; did you mean planets?\n"
      "sweep.toml:5:7: unknown key ratio.traget; did you mean ratio.target?\n";
  std::string message = refused(place, "spec = \"spec.toml\"\n" + vary);
  ASSERT_TRUE(message.starts_with(first)) << message;
  for (const std::string start : {"sweep.toml:1:1: spec: ", "sweep.toml:4:1: vary.rows: "}) {
    EXPECT_NE(message.find(start), std::string::npos) << message;
  }
  EXPECT_NE(message.find("spec.toml: cannot be read"), std::string::npos) << message;
  EXPECT_NE(message.find("none.csv: cannot be read"), std::string::npos) << message;
  place.write("spec.toml", "planets = 44\n");
  message = refused(place, "spec = \"spec.toml\"\n" + vary);
  ASSERT_TRUE(message.starts_with(first)) << message;
  EXPECT_NE(message.find("spec.toml:1:1: planets = 44"), std::string::npos) << message;
  place.write("rows.csv", "planetz,ratio.target\n4,forty\n");
  EXPECT_EQ(refused(place, kSmallTask + "[vary]\nrows = \"rows.csv\"\n"),
            "rows.csv:1:1: unknown key planetz; did you mean planets?\n"
            "rows.csv:2:1: ratio.target = \"forty\": allowed: a number, -100000 to 100000");
}

// With a SPEC beside it and with [task]; with a good [vary] and with one that has errors itself.
TEST(SweepFile, MissingKeysOfItsTaskAreToldBesideWrongValues) {
  const Workplace place;
  const std::string task =
      "[ratio]\ntarget = 45.0\n[teeth]\nS = [10, 3000]\nR1_max = 80\nR2_max = 80\n"
      "[strength]\nk_a = -1.0\n";
  const std::string missing_p1 = "teeth.P1 is missing", missing_p2 = "teeth.P2 is missing";
  const std::string missing_torque = "strength.output_torque_nm is missing";
  const auto told = [](const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
  };
  place.write("spec.toml", task);
  // The SWEEP file's own error is `nam`.
  for (const bool inlined : {false, true}) {
    std::string own = "nam = \"x\"\n";
    if (inlined) {
      std::string tables = "[task." + task.substr(1);
      for (const char* table : {"[teeth]", "[strength]"}) {
        tables.replace(tables.find(table), 1, "[task.");
      }
      own += tables;
    } else {
      own += "spec = \"spec.toml\"\n";
    }
    const std::string good = refused(place, own + "[vary]\nteeth.P2 = [[20, 30], [20, 40]]\n");
    EXPECT_EQ(told(good, "unknown key nam"), 1U) << good;
    EXPECT_EQ(told(good, "teeth.S = [10, 3000]"), 1U) << good;
    EXPECT_EQ(told(good, "strength.k_a = -1.0"), 1U) << good;
    EXPECT_EQ(told(good, missing_p1), 1U) << good;
    EXPECT_EQ(told(good, missing_p2), 0U) << good;
    EXPECT_EQ(told(good, missing_torque), 1U) << good;
    const std::string bad = refused(place, own + "[vary]\nteeth.P2 = { min = 3 }\n");
    EXPECT_EQ(told(bad, "vary.teeth.P2 = { min = 3 }"), 1U) << bad;
    EXPECT_EQ(told(bad, "teeth.S = [10, 3000]"), 1U) << bad;
    EXPECT_EQ(told(bad, missing_p1), 1U) << bad;
    EXPECT_EQ(told(bad, missing_p2), 0U) << bad;
  }
}

// What one combination lacks only is no error of the sweep.
// What some combinations are refused for is no error of the sweep; what all are refused for is.
TEST(SweepFile, AnErrorOfOneCombinationIsNotToldBesideAnother) {
  const Workplace place;
  const std::string start =
      "nam = 1\n" +
      test::replaced(kSmallTask, "max_output_arcmin = 12.0", "min_output_arcmin = 5.0") +
      "[vary]\nbacklash.max_output_arcmin = ";
  const std::string some = refused(place, start + "[4.0, 8.0]\n");
  EXPECT_EQ(some.find("sweep.toml:1:1: unknown key nam"), 0U) << some;
  EXPECT_EQ(some.find("min_output_arcmin"), std::string::npos) << some;
  const std::string all = refused(place, start + "[4.0]\nplanets = [3, 4]\n");
  EXPECT_NE(all.find("min_output_arcmin"), std::string::npos) << all;
}

TEST(SweepFile, IsRefusedWhereNoTaskFitsTogether) {
  const Workplace place;
  EXPECT_EQ(
      refused(place, kSmallTask + "[vary]\nplanets = [3, 4]\n"),
      "sweep.toml:11:1: ratio.target is missing: w_S/w_R2; negative = output turns against the "
      "input; allowed: a number, -100000 to 100000");
  // One of two does.
  EXPECT_EQ(read(place, kSmallTask + "ratio.target = 40.0\n[vary]\nbacklash.min_output_arcmin = "
                                     "[20.0, 1.0]\n")
                .count(),
            2U);
}

TEST(SweepFile, CountsAreKeptWithinTheirNumbers) {
  const sweep::Axis axis{.paths = {"a"}, .points = std::vector<std::vector<io::TomlValue>>(65536)};
  EXPECT_EQ(sweep::combinations({axis, axis, axis}), 281'474'976'710'656U);
  EXPECT_EQ(sweep::combinations({axis, axis, axis, axis}),
            std::numeric_limits<std::uint64_t>::max());
}

}  // namespace
}  // namespace gear3k::sweep_file_test
