// What a rating says of itself beside its numbers.

#include "design/rated_gearbox.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "design/evaluation.hpp"
#include "geometry/tooth_form.hpp"
#include "io/files/design_file.hpp"

namespace gear3k::design::rated_gearbox_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

PairDesign pair_of(double pressure_angle_deg, int teeth1, int teeth2, double root_radius) {
  return io::parse_pair(
      fmt::format("kind = \"external\"\nmodule_mm = 1.0\npressure_angle_deg = {}\n"
                  "face_width_mm = 10.0\n[rack]\naddendum = 0.8\ndedendum = 1.0\n"
                  "root_radius = {}\n[gear1]\nteeth = {}\n[gear2]\nteeth = {}\n"
                  "[material]\nname = \"34CrNiMo6 through hardened\"\n"
                  "[strength]\ntorque_nm = 10.0\n",
                  pressure_angle_deg, root_radius, teeth1, teeth2),
      "a pair");
}

/// Angle between the tooth's axis and the least inclined tangent of its fillet, from points of it.
double least_tangent_rad(const geometry::GearGeometry<double>& gear) {
  const auto form = geometry::make_tooth_form(gear);
  const double pitch_half = std::numbers::pi / gear.gear.teeth;
  constexpr int kPoints = 20'000;
  double least = std::numbers::pi, before_x = 0.0, before_y = 0.0;
  for (int i = 0; i <= kPoints; ++i) {
    const double share = static_cast<double>(i) / kPoints;
    const auto p = geometry::fillet_point(
        form.fillet,
        form.form_normal_angle_rad + share * (std::numbers::pi / 2.0 - form.form_normal_angle_rad));
    const double x = p.radius_m * std::sin(pitch_half - p.angle_rad);
    const double y = p.radius_m * std::cos(pitch_half - p.angle_rad);
    if (i > 0) least = std::min(least, std::atan2(std::abs(x - before_x), std::abs(y - before_y)));
    before_x = x;
    before_y = y;
  }
  return least;
}

TEST(RatedPair, SaysOfWhichGearNoTangentOfTheFilletIsThatOfTheRatedSection) {
  int off = 0, on = 0;
  for (const double angle : {20.0, 28.0, 31.0, 33.0, 35.0}) {
    for (const int teeth : {14, 24, 60, 150, 300}) {
      const PairDesign pair = pair_of(angle, teeth, 80, 0.2);
      const auto evaluated = evaluate(pair);
      const auto& e = std::get<PairEvaluation>(evaluated);
      ASSERT_TRUE(e.strength);
      const auto pressure = geometry::make_pressure_angle(angle * kDegree);
      for (const bool first : {true, false}) {
        const double least =
            least_tangent_rad(make_gear_geometry(first ? pair.gear1 : pair.gear2, pressure));
        if (std::abs(least - 30.0 * kDegree) < 0.1 * kDegree) continue;
        const std::string text =
            fmt::format("the fillet of {} has no tangent at 30 deg", first ? 1 : 2);
        const bool told = std::ranges::any_of(
            e.notes, [&](const std::string& note) { return note.starts_with(text); });
        EXPECT_EQ(told, least > 30.0 * kDegree) << angle << " deg, " << teeth << " teeth";
        (told ? off : on) += 1;
      }
    }
  }
  EXPECT_GE(off, 5);
  EXPECT_GE(on, 10);
}

TEST(RatedGearbox, SaysSoOfEachGearOnce) {
  const auto notes_of = [](double angle_deg) {
    Design d = io::read_design(std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/loaded.toml");
    d.train.pressure_angle_rad = angle_deg * kDegree;
    for (auto& rack : d.train.rack) rack = {.addendum = 0.6, .dedendum = 0.85, .root_radius = 0.1};
    d.center_distance_given = false;
    const auto evaluated = evaluate(d);
    const auto& e = std::get<Evaluation>(evaluated);
    std::vector<std::string> gears;
    for (const std::string& note : e.notes) {
      const std::string begin = "the fillet of ";
      if (note.starts_with(begin)) gears.push_back(note.substr(begin.size(), 2));
    }
    return gears;
  };
  EXPECT_TRUE(notes_of(20.0).empty());
  const auto gears = notes_of(37.0);
  EXPECT_EQ(gears, (std::vector<std::string>{"P1", "P2"}));
}

}  // namespace
}  // namespace gear3k::design::rated_gearbox_test
