// What a limit gains where it gives way, against the file with its key stated otherwise.

#include "optimize/moved_limit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "io/files/specification_file.hpp"
#include "io/text/file_reader.hpp"
#include "optimize/refine.hpp"
#include "optimize/wider_search.hpp"

namespace gear3k::optimize::moved_limit_test {
namespace {

constexpr Candidate kSet{.teeth = {.S = 12, .P1 = 64, .R1 = 141, .P2 = 52, .R2 = 132},
                         .planets = 3};

using Edit = std::pair<std::string, std::string>;

std::string edited(std::string text, const std::vector<Edit>& edits) {
  for (const auto& [from, to] : edits) {
    std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    for (; at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  }
  return text;
}

/// A task in which a limit holds the optimum back.
struct Case {
  const char* key;
  LimitKind kind;
  std::vector<Edit> task;  ///< of examples/ratio-96.toml
  Edit moved{};            ///< of the task's own text, by giving_step(); empty: none is refined
};

void PrintTo(const Case& own, std::ostream* out) { *out << own.key; }

const Edit kCapacity{R"(objective = "backward_efficiency")", R"(objective = "torque_capacity")"};
const Edit kLightLoad{"output_torque_nm = 20.0", "output_torque_nm = 5.0"};

/// With one more table or key.
Edit with(const std::string& text) { return {"[solver]", text + "\n[solver]"}; }

/// Shifts so wide that a search may leave the model, where teeth have no rim or meshes no contact.
std::vector<Edit> wide_shifts() {
  return {{"range = [0.0, 1.0]", "range = [0.0, 5.0]"},
          {"tip_thickness = 0.3", "tip_thickness = 0.03"}};
}

const std::vector<Case>& cases() {
  static const std::vector<Case> kCases{
      {"contact_ratio.range[0]",
       LimitKind::kCheck,
       {with("[free]\ntip_shortening = [0.0, 0.3]\n")},
       {"range = [1.2, 2.5]", "range = [1.15, 2.5]"}},
      {"backlash.max_output_arcmin",
       LimitKind::kCheck,
       {},
       {"max_output_arcmin = 8.0", "max_output_arcmin = 9.0"}},
      {"backlash.P2-R2.min_normal_um",
       LimitKind::kCheck,
       {{"output_torque_nm = 20.0", "output_torque_nm = 44.0"},
        with("[backlash.P2-R2]\nmin_normal_um = 12.0\n")},
       {"min_normal_um = 12.0", "min_normal_um = 11.0"}},
      {"size.max_ring_root_diameter_mm",
       LimitKind::kCheck,
       {kCapacity, kLightLoad},
       {"max_ring_root_diameter_mm = 76.0", "max_ring_root_diameter_mm = 77.0"}},
      {"strength.s_f_min",
       LimitKind::kCheck,
       {{"output_torque_nm = 20.0", "output_torque_nm = 44.0"}},
       {"s_f_min = 1.5", "s_f_min = 1.45"}},
      {"strength.s_f_min",
       LimitKind::kCheck,
       {kCapacity, kLightLoad},
       {"s_f_min = 1.5", "s_f_min = 1.45"}},
      {"strength.s_h_min",
       LimitKind::kCheck,
       {kCapacity, kLightLoad, {"s_h_min = 1.2", "s_h_min = 2.5"}},
       {"s_h_min = 2.5", "s_h_min = 2.45"}},
      {"gears.P2.strength.s_f_min",
       LimitKind::kCheck,
       {kCapacity, kLightLoad, with("[gears.P2.strength]\ns_f_min = 1.6\n")},
       {"s_f_min = 1.6", "s_f_min = 1.55"}},
      {"profile_shift.range[0]",
       LimitKind::kProfileShift,
       {kCapacity, kLightLoad},
       {"range = [0.0, 1.0]", "range = [-0.05, 1.0]"}},
      {"profile_shift.range[1]",
       LimitKind::kProfileShift,
       {},
       {"range = [0.0, 1.0]", "range = [0.0, 1.05]"}},
      {"profile_shift.ring_range[1]",
       LimitKind::kRingShift,
       {{"range = [0.0, 1.0]", "range = [0.0, 1.0]\nring_range = [0.0, 0.9]"}},
       {"ring_range = [0.0, 0.9]", "ring_range = [0.0, 0.95]"}},
      {"module.stage2_mm.min",
       LimitKind::kModule,
       {{"max_ring_root_diameter_mm = 76.0", "max_ring_root_diameter_mm = 75.0"}},
       {"stage2_mm = { min = 0.5,", "stage2_mm = { min = 0.45,"}},
      {"free.tip_shortening[1]",
       LimitKind::kTipShortening,
       {with("[free]\ntip_shortening = [0.05, 0.2]\n")},
       {"tip_shortening = [0.05, 0.2]", "tip_shortening = [0.05, 0.25]"}},
      {"free.addendum[0]",
       LimitKind::kAddendum,
       {with("[free]\naddendum = [0.8, 1.0]\n")},
       {"addendum = [0.8, 1.0]", "addendum = [0.75, 1.0]"}},
      {"free.addendum[1]",
       LimitKind::kAddendum,
       {kCapacity, kLightLoad, with("[free]\naddendum = [0.8, 0.9]\n")},
       {"addendum = [0.8, 0.9]", "addendum = [0.8, 0.95]"}},
      {"free.pressure_angle_deg[1]",
       LimitKind::kPressureAngle,
       {with("[free]\npressure_angle_deg = [19.0, 21.0]\n")},
       {"pressure_angle_deg = [19.0, 21.0]", "pressure_angle_deg = [19.0, 22.0]"}},
      {"contact_ratio.range[0]",
       LimitKind::kCheck,
       wide_shifts(),
       {"range = [1.2, 2.5]", "range = [1.15, 2.5]"}},
      {"size.max_ring_root_diameter_mm",
       LimitKind::kCheck,
       wide_shifts(),
       {"max_ring_root_diameter_mm = 76.0", "max_ring_root_diameter_mm = 77.0"}},
      {"module.stage2_mm.min",
       LimitKind::kModule,
       wide_shifts(),
       {"stage2_mm = { min = 0.5,", "stage2_mm = { min = 0.45,"}},
      {"strength.output_torque_nm",
       LimitKind::kTorque,
       {{"output_torque_nm = 20.0", "output_torque_nm = 44.0"}}},
      {"stage2.face_width_mm.min",
       LimitKind::kFaceWidth,
       {{R"(objective = "backward_efficiency")", R"(objective = "mass")"},
        {"face_width_mm = 8.0", "face_width_mm = { min = 6.0, max = 9.0 }"},
        {"diameter_mm = 76.0", "diameter_mm = 76.0\nring_rim_mm = 5.0"}}},
  };
  return kCases;
}

class MovedLimit : public testing::TestWithParam<Case> {};

TEST_P(MovedLimit, GainsWhatTheFileStatedOtherwiseHas) {
  const Case& own = GetParam();
  const std::string text = edited(
      io::read_text(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml", "a file", 1 << 20),
      own.task);
  const Specification spec = io::parse_specification(text, "task.toml");
  const RefinedSet set = refine(spec, kSet);
  ASSERT_EQ(set.status, Status::kOptimal);
  HeldBack held = held_back(spec, set, spec.limits);
  std::erase_if(held.prices, [&](const LimitPrice& price) { return price.key != own.key; });
  ASSERT_EQ(held.prices.size(), 1U) << held.missing;
  EXPECT_EQ(held.prices.front().limit.kind, own.kind);
  Progress progress;
  refine_gains(spec, set, held, progress);
  const std::optional<double> told = held.prices.front().refined_gain_si;
  if (own.moved.first.empty()) {
    EXPECT_FALSE(told);
    return;
  }
  const RefinedSet again =
      refine(io::parse_specification(edited(text, {own.moved}), "task.toml"), kSet);
  ASSERT_TRUE(has_design(again.status));
  const double gain = merit_of(spec, again) - merit_of(spec, set);
  ASSERT_TRUE(told);
  // Two refinements of one problem end alike to the solver's 1e-9; a gain is far above it.
  const double scale = std::max(1.0, std::abs(merit_of(spec, set)));
  EXPECT_GT(gain, 1e-6 * scale);
  EXPECT_NEAR(sense_of(first_objective(spec)) * *told, gain, 1e-7 * scale);
}

// A range that would hold racks without a tooth, a step wider, ends where the model does: no file
// states the wider one.
TEST(HeldBack, ByTheRackThatComesToAPointIsNoLimitOfAFile) {
  const auto upper_end = [](const std::string& range) {
    const std::string loaded = io::read_text(
        std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml", "a file", 1 << 20);
    const std::string text =
        edited(loaded.substr(0, loaded.find("[stage1]")),
               {{"range = [1.2, 2.5]", "range = [1.0, 2.5]"},
                {"tip_thickness = 0.3", "tip_thickness = 0.1\nring_tip_thickness = 0.1"},
                with("[free]\npressure_angle_deg = " + range + "\n")});
    const Specification spec = io::parse_specification(text, "task.toml");
    const RefinedSet set =
        refine(spec, {.teeth = {.S = 14, .P1 = 43, .R1 = 100, .P2 = 37, .R2 = 94}, .planets = 3});
    EXPECT_EQ(set.status, Status::kOptimal);
    HeldBack held = held_back(spec, set, spec.limits);
    Progress progress;
    refine_gains(spec, set, held, progress);
    std::erase_if(held.prices, [](const LimitPrice& price) {
      return price.unit != units::Unit::kDegree || price.limit.at_least;
    });
    return held.prices.empty() ? LimitPrice{} : held.prices.front();
  };
  const LimitPrice far = upper_end("[28.0, 31.0]");
  EXPECT_EQ(far.key, "free.pressure_angle_deg[1]");
  EXPECT_TRUE(far.stated);
  EXPECT_TRUE(far.refined_gain_si);
  const LimitPrice near = upper_end("[28.0, 32.0]");
  EXPECT_EQ(near.key, "pointed_rack");
  EXPECT_FALSE(near.stated);
  EXPECT_FALSE(near.refined_gain_si);
}

INSTANTIATE_TEST_SUITE_P(OfEveryKind, MovedLimit, testing::ValuesIn(cases()));

}  // namespace
}  // namespace gear3k::optimize::moved_limit_test
