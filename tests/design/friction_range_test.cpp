#include "design/friction_range.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "io/files/design_file.hpp"

namespace gear3k::design::friction_range_test {
namespace {

using efficiency::FrictionLaw;

/// 1000 rpm, 20 N m, 40 C; friction by schlenk, oil of 40 and 100 C.
Design with_losses() {
  return io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/ratio_96_with_losses.toml");
}

Evaluation evaluated(const Design& design) { return std::get<Evaluation>(evaluate(design)); }

/// The one note of the evaluation with `words`; "" where there is none.
std::string note_with(const Design& design, const std::string& words) {
  std::string found;
  for (const std::string& note : evaluated(design).notes) {
    if (note.find(words) == std::string::npos) continue;
    EXPECT_EQ(found, "") << note;
    found = note;
  }
  return found;
}

/// Whether a note has all of these words and none of those.
void expect_words(const std::string& note, const std::vector<std::string>& words,
                  const std::vector<std::string>& none = {}) {
  for (const std::string& w : words)
    EXPECT_NE(note.find(w), std::string::npos) << w << ": " << note;
  for (const std::string& w : none) EXPECT_EQ(note.find(w), std::string::npos) << w << ": " << note;
}

constexpr const char* kCut = "is cut at 1";
constexpr const char* kEdge = "its edge is taken";
constexpr const char* kSmall = "schlenk is extrapolated";
constexpr const char* kOil = "viscosity is extrapolated";

Design by_load_power(double exponent, double reference_N) {
  Design d = with_losses();
  d.friction.law = FrictionLaw::kLoadPower;
  d.friction.coefficient = 0.08;
  d.friction.load_exponent = exponent;
  d.friction.reference_force_N = reference_N;
  return d;
}

TEST(FrictionRange, ACoefficientThatIsCutIsToldWithWhatTheLawHas) {
  const Design d = by_load_power(0.5, 0.05);
  const Evaluation e = evaluated(d);
  const std::string note = note_with(d, kCut);
  expect_words(note, {"by load_power S-P1 "});
  const auto& mesh = e.operation->forward.operation->mesh;
  for (const std::size_t k : {0U, 1U, 2U}) {
    EXPECT_EQ(mesh[k].friction, 1.0);
    const std::string name(train::kMeshNames[k]);
    const std::size_t at = note.find(name);
    ASSERT_NE(at, std::string::npos) << note;
    const double told = std::stod(note.substr(at + name.size()));
    const double by_hand = 0.08 * std::sqrt(mesh[k].normal_force_N / 0.05);
    EXPECT_NEAR(told, by_hand, 5e-3 * by_hand) << note;  // three digits
  }
}

TEST(FrictionRange, OnlyMeshesAboveTheGreatestFrictionAreCut) {
  // 0.08 sqrt(F/F_0) is 1 at F = 156.25 F_0: S-P1 has 24.5 N, the others 190 and more.
  const std::string note = note_with(by_load_power(0.5, 1.0), kCut);
  expect_words(note, {"P1-R1", "P2-R2"}, {"S-P1"});
  EXPECT_EQ(note_with(by_load_power(0.5, 2.0), kCut), "");
}

Design by_table(std::vector<double> speeds, std::vector<double> forces) {
  Design d = with_losses();
  d.friction.law = FrictionLaw::kTable;
  const std::size_t rows = forces.empty() ? 1 : forces.size();
  d.friction.table = {.sliding_speed_m_s = std::move(speeds),
                      .tooth_force_N = std::move(forces),
                      .coefficient = {}};
  d.friction.table.coefficient.assign(rows * d.friction.table.sliding_speed_m_s.size(), 0.1);
  return d;
}

TEST(FrictionRange, ATableLeftAtItsEdgeIsToldWithTheMeshesThatLeaveIt) {
  EXPECT_EQ(note_with(by_table({0.001, 1.0}, {1.0, 1000.0}), kEdge), "");
  expect_words(note_with(by_table({1.0, 2.0}, {1000.0, 2000.0}), kEdge),
               {"(1 to 2 m/s, 1000 to 2000 N)", "S-P1 0.0488 m/s", "P1-R1", "P2-R2"});
  // Of the forces only: the sun's mesh has less than 100 N, the others more.
  const std::string force = note_with(by_table({0.001, 1.0}, {100.0, 1000.0}), kEdge);
  expect_words(force, {"S-P1", " N"}, {"P1-R1", "P2-R2"});
  // Of the speeds only: the sun's mesh slides by 0.0488 m/s, the others by 0.006.
  expect_words(note_with(by_table({0.001, 0.03}, {}), kEdge), {"S-P1"}, {"P1-R1"});
}

TEST(FrictionRange, ATableOfOnePointIsAConstantWithoutEdges) {
  EXPECT_EQ(note_with(by_table({1.0}, {}), kEdge), "");
  EXPECT_EQ(note_with(by_table({1.0}, {1000.0}), kEdge), "");
}

// By the pitch-line speed relative to the carrier, from tooth numbers: v_sum = 2 v_t sin alpha_w.
TEST(FrictionRange, SchlenkTellsLineLoadsAndSumsOfSpeedsOfItsMeshes) {
  const Design d = with_losses();
  const Evaluation e = evaluated(d);
  const std::string note = note_with(d, kSmall);
  const double sun = 1000.0 * std::numbers::pi / 30.0;
  const double on_carrier = sun * (1.0 - 12.0 / (12.0 + 141.0));
  const double planet = on_carrier * 12.0 / 64.0;
  constexpr double kDistance = 20.3236e-3;
  const std::array<double, 3> pitch_line{on_carrier * kDistance * 12.0 / (12.0 + 64.0),
                                         planet * kDistance * 64.0 / (141.0 - 64.0),
                                         planet * kDistance * 52.0 / (132.0 - 52.0)};
  const std::array<double, 3> width_mm{8.0, 8.0, 10.0};
  for (const std::size_t k : {0U, 1U, 2U}) {
    const std::string name(train::kMeshNames[k]);
    const std::size_t at = note.find(name);
    ASSERT_NE(at, std::string::npos) << note;
    double line_load = 0.0;
    double speed = 0.0;
    ASSERT_EQ(
        std::sscanf(note.c_str() + at + name.size(), " %lf N/mm, %lf m/s", &line_load, &speed), 2)
        << note;
    const double force_N = e.operation->forward.operation->mesh[k].normal_force_N;
    EXPECT_NEAR(line_load, force_N / width_mm[k], 5e-3 * line_load) << note;
    const double by_hand = 2.0 * pitch_line[k] * std::sin(e.meshes[k].working_pressure_angle_rad);
    EXPECT_NEAR(speed, by_hand, 5e-3 * speed) << note;
  }
}

TEST(FrictionRange, SchlenkAtIndustrialLoadsAndSpeedsIsNotNoted) {
  Design d = with_losses();
  d.operating_point->sun_speed_rad_s *= 10.0;
  d.operating_point->output_torque_Nm *= 40.0;
  EXPECT_EQ(note_with(d, kSmall), "");
  d.operating_point->sun_speed_rad_s *= 0.3;
  EXPECT_NE(note_with(d, kSmall), "");
}

TEST(FrictionRange, ViscosityFarOutsideItsTemperaturesIsTold) {
  Design d = with_losses();
  for (const double inside_c : {0.0, 40.0, 140.0}) {
    d.operating_point->temperature_K = inside_c + 273.15;
    EXPECT_EQ(note_with(d, kOil), "") << inside_c;
  }
  d.operating_point->temperature_K = 141.0 + 273.15;
  expect_words(note_with(d, kOil), {"extrapolated by 41 K"});
  d.operating_point->temperature_K = -80.0 + 273.15;
  expect_words(note_with(d, kOil), {"extrapolated by 120 K", "at -80 C", "stated at 40 and 100 C"});
  std::swap(d.friction.lubricant.temperature_K[0], d.friction.lubricant.temperature_K[1]);
  std::swap(d.friction.lubricant.viscosity_m2_s[0], d.friction.lubricant.viscosity_m2_s[1]);
  expect_words(note_with(d, kOil), {"extrapolated by 120 K"});
}

TEST(FrictionRange, NothingIsToldWhereTheGearboxDoesNotRun) {
  const Design d = with_losses();
  const auto train = train::make_train_geometry(resolved_parameters(d));
  const LossyTrain<double> lossy = lossy_train(d, *train);
  OperatingPoint<double> rest = *d.operating_point;
  rest.sun_speed_rad_s = 0.0;
  const OperatingResult none{.point = rest,
                             .forward = operate(lossy, rest, Direction::kForward),
                             .backward = operate(lossy, rest, Direction::kBackward)};
  ASSERT_EQ(none.forward.reason, NoOperation::kNoFriction);
  EXPECT_TRUE(friction_range_notes(lossy, none).empty());
}

}  // namespace
}  // namespace gear3k::design::friction_range_test
