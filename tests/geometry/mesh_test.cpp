#include "geometry/mesh.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>

#include "tests/largest_deviation.hpp"

namespace gear3k::geometry::mesh_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr int kCases = 4000;

struct Pair {
  GearGeometry<double> gear1, gear2;
};

Gear<double> gear_of(int teeth, GearKind kind, double module_m, double shift) {
  return {.teeth = teeth,
          .kind = kind,
          .module_m = module_m,
          .profile_shift = shift,
          .machining_allowance = 0.0,
          .tip_shortening = 0.0,
          .rack = {}};
}

class RandomPairs {
 public:
  Pair operator()(GearKind kind) {
    const double m = between(0.3e-3, 5e-3);
    const auto angle = make_pressure_angle(between(17.0, 26.0) * kPi / 180.0);
    const int z1 = count(10, 60);
    const bool ring = kind == GearKind::kRing;
    Gear<double> a = gear_of(z1, GearKind::kExternal, m, between(-0.2, 0.8));
    Gear<double> b = gear_of(ring ? z1 + count(8, 80) : count(10, 120), kind, m,
                             between(ring ? 0.0 : -0.2, 1.0));
    for (Gear<double>* gear : {&a, &b}) {
      gear->machining_allowance = between(0.0, 0.1);
      gear->tip_shortening = between(0.0, 0.1);
    }
    return {make_gear_geometry(a, angle), make_gear_geometry(b, angle)};
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

 private:
  std::mt19937_64 generator_{3};
};

bool tips_outside_base(const Pair& p) {
  return p.gear1.tip_radius_m > 1.002 * p.gear1.base_radius_m &&
         p.gear2.tip_radius_m > 1.002 * p.gear2.base_radius_m;
}

/// Zero of a function that decreases from `low` to `high`.
template <class F>
double root_of_decreasing(F f, double low, double high) {
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The path of contact drawn in the plane: gear 1 at the origin, gear 2 at (d, 0), the line of
/// action as common tangent of the base circles, the tip circles cut with it.
struct DrawnPath {
  double alpha_w_rad, tangent_length_m;
  double addendum1_m, addendum2_m;  // of the path, from the pitch point
};

DrawnPath draw_path(const Pair& p, double d) {
  const bool ring = p.gear2.gear.kind == GearKind::kRing;
  const double rb1 = p.gear1.base_radius_m;
  const double rb2 = p.gear2.base_radius_m;
  // Normal (cos psi, sin psi) of a line that touches circle 1; the line must touch circle 2 too,
  // with both circles on one side (ring) or one on each (external).
  const double side = ring ? -rb2 : rb2;
  const double psi =
      root_of_decreasing([&](double angle) { return d * std::cos(angle) - rb1 - side; }, 0.0, kPi);
  const double nx = std::cos(psi), ny = std::sin(psi);
  const double ux = -ny, uy = nx;
  const double t1x = rb1 * nx, t1y = rb1 * ny;
  const double tangent2 = (d - t1x) * ux - t1y * uy;  // foot of gear 2's centre, from T1 along u
  const double pitch = -t1y / uy;                     // where the line crosses the line of centres
  const auto distance_to = [&](double x, double t) {
    return std::hypot(t1x + t * ux - x, t1y + t * uy);
  };
  const double way1 = pitch > 0.0 ? 1.0 : -1.0;
  const double way2 = pitch > tangent2 ? 1.0 : -1.0;
  const double far = 4.0 * (p.gear1.tip_radius_m + p.gear2.tip_radius_m);
  const double tip1 = root_of_decreasing(
      [&](double t) { return p.gear1.tip_radius_m - distance_to(0.0, way1 * t); }, 0.0, far);
  const double tip2 = root_of_decreasing(
      [&](double t) { return p.gear2.tip_radius_m - distance_to(d, tangent2 + way2 * t); }, 0.0,
      far);
  const double pitch1 = std::abs(pitch);
  const double pitch2 = std::abs(pitch - tangent2);
  return {.alpha_w_rad = std::atan2(std::abs(ux), std::abs(uy)),
          .tangent_length_m = std::abs(tangent2),
          .addendum1_m = tip1 - pitch1,
          .addendum2_m = ring ? pitch2 - tip2 : tip2 - pitch2};
}

class MeshOfBothKinds : public ::testing::TestWithParam<GearKind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, MeshOfBothKinds,
                         ::testing::Values(GearKind::kExternal, GearKind::kRing),
                         [](const ::testing::TestParamInfo<GearKind>& kind) {
                           return kind.param == GearKind::kRing ? "Internal" : "External";
                         });

TEST_P(MeshOfBothKinds, PathOfContactIsTheOneDrawnInThePlane) {
  RandomPairs random;
  LargestDeviation angle, length, ratio1, ratio2, sum;
  int seen = 0;
  for (int i = 0; i < kCases; ++i) {
    const Pair p = random(GetParam());
    if (!tips_outside_base(p)) continue;
    const double base_sum = p.gear2.base_radius_m + mesh_sign(GetParam()) * p.gear1.base_radius_m;
    const double d = base_sum * random.between(1.01, 1.2);
    const auto mesh = make_mesh_geometry(p.gear1, p.gear2, d);
    ASSERT_TRUE(mesh);
    const DrawnPath drawn = draw_path(p, d);
    const double base_pitch = 2.0 * kPi * p.gear1.base_radius_m / p.gear1.gear.teeth;
    // Rounding of the drawing, enlarged where circles meet the line of action at a small angle
    // (tip near base, working angle near zero: at most 1/sin of it).
    const double rounding = 100.0 * kEps;
    const double size = p.gear2.tip_radius_m / base_pitch;
    angle.see(i, mesh->alpha_w_rad - drawn.alpha_w_rad, rounding);
    length.see(i, mesh->tangent_length_m - drawn.tangent_length_m, rounding * d);
    ratio1.see(i, mesh->addendum_contact_ratio1 - drawn.addendum1_m / base_pitch, rounding * size);
    ratio2.see(i, mesh->addendum_contact_ratio2 - drawn.addendum2_m / base_pitch, rounding * size);
    sum.see(i, mesh->contact_ratio - (drawn.addendum1_m + drawn.addendum2_m) / base_pitch,
            rounding * size);
    ++seen;
  }
  EXPECT_GT(seen, kCases / 4);
  angle.expect_allowed("angle");
  length.expect_allowed("length");
  ratio1.expect_allowed("ratio1");
  ratio2.expect_allowed("ratio2");
  sum.expect_allowed("sum");
}

TEST_P(MeshOfBothKinds, WorkingAngleTangentAndTangentLengthAreOfOneTriangle) {
  RandomPairs random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const Pair p = random(GetParam());
    const double base_sum = p.gear2.base_radius_m + mesh_sign(GetParam()) * p.gear1.base_radius_m;
    const double d = base_sum * random.between(1.001, 1.3);
    const auto mesh = make_mesh_geometry(p.gear1, p.gear2, d);
    ASSERT_TRUE(mesh);
    largest.see(i, std::hypot(mesh->tangent_length_m, base_sum) - d, 8.0 * kEps * d);
    largest.see(i, mesh->tan_alpha_w * base_sum - mesh->tangent_length_m, 8.0 * kEps * d);
    EXPECT_EQ(mesh->center_distance_m, d);
  }
  largest.expect_allowed("largest");
}

TEST_P(MeshOfBothKinds, FullTeethFillTheWorkingPitchCircleAtTheZeroBacklashDistance) {
  RandomPairs random;
  LargestDeviation largest;
  int seen = 0;
  for (int i = 0; i < kCases; ++i) {
    Pair p = random(GetParam());
    const auto d = zero_backlash_center_distance(p.gear1, p.gear2);
    const auto angle = zero_backlash_angle(p.gear1, p.gear2);
    ASSERT_EQ(d.has_value(), angle.has_value());
    if (!d) continue;
    p.gear1.gear.machining_allowance = 0.0;
    p.gear2.gear.machining_allowance = 0.0;
    // Rolling circles whose radii are as the tooth numbers and that touch.
    const double z1 = p.gear1.gear.teeth;
    const double z2 = p.gear2.gear.teeth;
    const double rw1 = *d * z1 / (z2 + mesh_sign(GetParam()) * z1);
    const double rw2 = *d * z2 / (z2 + mesh_sign(GetParam()) * z1);
    if (rw1 < 1.001 * p.gear1.base_radius_m) continue;
    const double gap =
        2.0 * kPi * rw1 / z1 - tooth_thickness(p.gear1, rw1) - tooth_thickness(p.gear2, rw2);
    // The angle is accurate to 1e-14 rad; the arcs move by 2 r tan^2 a of it.
    const double tan_w = std::tan(*angle);
    largest.see(i, gap, 1e-14 * 4.0 * rw2 * (1.0 + tan_w * tan_w) / std::min(tan_w, 1.0));
    ++seen;
  }
  EXPECT_GT(seen, kCases / 2);
  largest.expect_allowed("largest");
}

TEST_P(MeshOfBothKinds, ZeroShiftSumLeavesReferenceGeometry) {
  RandomPairs random;
  LargestDeviation distance, angle;
  for (int i = 0; i < kCases; ++i) {
    Pair p = random(GetParam());
    p.gear1.gear.profile_shift = -mesh_sign(GetParam()) * p.gear2.gear.profile_shift;
    const auto d = zero_backlash_center_distance(p.gear1, p.gear2);
    const auto alpha_w = zero_backlash_angle(p.gear1, p.gear2);
    ASSERT_TRUE(d && alpha_w);
    const double reference =
        p.gear2.reference_radius_m + mesh_sign(GetParam()) * p.gear1.reference_radius_m;
    distance.see(i, *d - reference, 1e-14 * p.gear2.reference_radius_m);
    angle.see(i, *alpha_w - p.gear1.angle.alpha_rad, 1e-14);
  }
  distance.expect_allowed("distance");
  angle.expect_allowed("angle");
}

TEST_P(MeshOfBothKinds, MachiningAllowanceDoesNotMoveTheZeroBacklashDistance) {
  RandomPairs random;
  for (int i = 0; i < 100; ++i) {
    Pair p = random(GetParam());
    const auto thinned = zero_backlash_center_distance(p.gear1, p.gear2);
    p.gear1.gear.machining_allowance = 0.0;
    p.gear2.gear.machining_allowance = 0.0;
    EXPECT_EQ(thinned, zero_backlash_center_distance(p.gear1, p.gear2));
  }
}

TEST_P(MeshOfBothKinds, HasNoGeometryWhereTheBaseCirclesLeaveNoTangent) {
  RandomPairs random;
  for (int i = 0; i < 200; ++i) {
    const Pair p = random(GetParam());
    const double base_sum = p.gear2.base_radius_m + mesh_sign(GetParam()) * p.gear1.base_radius_m;
    EXPECT_FALSE(make_mesh_geometry(p.gear1, p.gear2, base_sum * (1.0 - 1e-9)));
    EXPECT_FALSE(make_mesh_geometry(p.gear1, p.gear2, 0.0));
    EXPECT_FALSE(make_mesh_geometry(p.gear1, p.gear2, -base_sum));
    EXPECT_FALSE(make_mesh_geometry(p.gear1, p.gear2, std::numeric_limits<double>::quiet_NaN()));
    EXPECT_TRUE(make_mesh_geometry(p.gear1, p.gear2, base_sum * (1.0 + 1e-9)));
  }
}

TEST(Mesh, RingNotLargerThanItsPinionHasNoGeometry) {
  const auto angle = make_pressure_angle(20.0 * kPi / 180.0);
  const auto pinion = make_gear_geometry(gear_of(30, GearKind::kExternal, 1e-3, 0.0), angle);
  for (const int teeth : {20, 30}) {
    const auto ring = make_gear_geometry(gear_of(teeth, GearKind::kRing, 1e-3, 0.0), angle);
    EXPECT_FALSE(make_mesh_geometry(pinion, ring, 10e-3)) << teeth;
    EXPECT_FALSE(zero_backlash_angle(pinion, ring)) << teeth;
    EXPECT_FALSE(zero_backlash_center_distance(pinion, ring)) << teeth;
  }
}

TEST(Mesh, ShiftsThatLeaveNoPositiveInvoluteHaveNoZeroBacklashDistance) {
  // inv a_w = inv 20 deg + 2 tan 20 deg (-0.8)/(20 + 10) < 0.
  const auto angle = make_pressure_angle(20.0 * kPi / 180.0);
  const auto a = make_gear_geometry(gear_of(20, GearKind::kExternal, 1e-3, -0.5), angle);
  const auto b = make_gear_geometry(gear_of(10, GearKind::kExternal, 1e-3, -0.3), angle);
  EXPECT_FALSE(zero_backlash_angle(a, b));
  EXPECT_FALSE(zero_backlash_center_distance(a, b));
}

// Published calculations, tests/golden/spur_pairs.toml.

std::optional<double> number(const toml::table& table, std::string_view key) {
  return table[key].value<double>();
}

struct GoldenPair {
  GearGeometry<double> gear1;
  std::optional<GearGeometry<double>> gear2;
  double center_distance_m = 0.0;
};

GoldenPair pair_from(const toml::table& in) {
  constexpr double kMm = 1e-3;
  const std::string kind = in["kind"].value_or("");
  const double m = number(in, "module").value() * kMm;
  const auto angle = make_pressure_angle(number(in, "alpha").value() * kPi / 180.0);
  const double distance_m = number(in, "center_distance").value_or(0.0) * kMm;
  const auto gear = [&](const std::string& index, GearKind gear_kind) {
    Gear<double> g = gear_of(static_cast<int>(number(in, "z" + index).value()), gear_kind, m,
                             number(in, "x" + index).value());
    if (const auto tip_diameter = number(in, "tip_diameter" + index)) {
      const double full = make_gear_geometry(g, angle).tip_radius_m;
      g.tip_shortening = (full - 0.5 * kMm * *tip_diameter) / m;
    }
    if (in["tip_rule"].value_or("") == std::string("khk")) {
      const double z_sum = number(in, "z1").value() + number(in, "z2").value();
      g.tip_shortening =
          number(in, "x1").value() + number(in, "x2").value() - (distance_m / m - 0.5 * z_sum);
    }
    return make_gear_geometry(g, angle);
  };
  GoldenPair pair{.gear1 = gear("1", GearKind::kExternal),
                  .gear2 = std::nullopt,
                  .center_distance_m = distance_m};
  if (kind != "gear") {
    pair.gear2 = gear("2", kind == "internal" ? GearKind::kRing : GearKind::kExternal);
  }
  return pair;
}

void add_gear(const GearGeometry<double>& g, const std::string& index,
              std::map<std::string, double>& values) {
  constexpr double kToMm = 1e3;
  values["reference_diameter" + index] = 2.0 * g.reference_radius_m * kToMm;
  values["base_diameter" + index] = 2.0 * g.base_radius_m * kToMm;
  values["tip_diameter" + index] = 2.0 * g.tip_radius_m * kToMm;
  values["root_diameter" + index] = 2.0 * g.root_radius_m * kToMm;
  values["tip_curvature" + index] = tip_curvature_radius(g) * kToMm;
  values["reference_thickness" + index] = reference_tooth_thickness(g) * kToMm;
  values["half_tooth_angle" + index] =
      reference_tooth_thickness(g) / g.reference_radius_m / 2.0 * 180.0 / kPi;
  values["tip_thickness" + index] = tooth_thickness(g, g.tip_radius_m) * kToMm;
}

std::map<std::string, double> values_of(const GoldenPair& pair) {
  constexpr double kToMm = 1e3;
  std::map<std::string, double> values;
  add_gear(pair.gear1, "1", values);
  if (!pair.gear2) return values;
  add_gear(*pair.gear2, "2", values);
  const auto mesh = make_mesh_geometry(pair.gear1, *pair.gear2, pair.center_distance_m).value();
  const double cos_w = std::cos(mesh.alpha_w_rad);
  values["working_angle"] = mesh.alpha_w_rad * 180.0 / kPi;
  values["zero_backlash_distance"] =
      zero_backlash_center_distance(pair.gear1, *pair.gear2).value() * kToMm;
  values["base_pitch"] = mesh.base_pitch_m * kToMm;
  values["contact_ratio"] = mesh.contact_ratio;
  values["path_length"] = mesh.contact_ratio * mesh.base_pitch_m * kToMm;
  values["pitch_diameter1"] = 2.0 * pair.gear1.base_radius_m / cos_w * kToMm;
  values["pitch_diameter2"] = 2.0 * pair.gear2->base_radius_m / cos_w * kToMm;
  values["pitch_curvature1"] = pair.gear1.base_radius_m * mesh.tan_alpha_w * kToMm;
  values["pitch_curvature2"] = pair.gear2->base_radius_m * mesh.tan_alpha_w * kToMm;
  return values;
}

TEST(Mesh, PublishedPairsAreReproducedToTheirPrintedDigits) {
  const toml::table file = toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/spur_pairs.toml");
  int compared = 0;
  for (const toml::node& node : *file["case"].as_array()) {
    const toml::table& c = *node.as_table();
    SCOPED_TRACE(c["id"].value_or("(no id)"));
    ASSERT_NE(std::string(c["cite"].value_or("")), "");
    ASSERT_NE(std::string(c["locator"].value_or("")), "");
    const auto values = values_of(pair_from(*c["inputs"].as_table()));
    for (const toml::node& item : *c["expect"].as_array()) {
      const toml::table& e = *item.as_table();
      const std::string quantity = e["quantity"].value_or("");
      ASSERT_TRUE(values.contains(quantity)) << quantity;
      double tolerance = 0.0;
      if (const auto decimals = e["decimals"].value<int>()) {
        tolerance = 0.5 * std::pow(10.0, -*decimals);  // half a unit of the last printed digit
      } else if (const auto stated = number(e, "tolerance")) {
        tolerance = *stated;
      } else {
        tolerance = number(c, "tolerance").value();  // stated by the source
      }
      EXPECT_NEAR(values.at(quantity), number(e, "value").value(), tolerance) << quantity;
      ++compared;
    }
  }
  EXPECT_GE(compared, 60);
}

}  // namespace
}  // namespace gear3k::geometry::mesh_test
