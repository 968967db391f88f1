#include "design/mass_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "design/evaluation.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::design::mass_model_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr int kCases = 300;

/// The published bilateral drive gear, 12/39/90/32/81.
train::TrainGeometry<double> train_of(double scale, int planets) {
  return train::make_train_geometry<double>(
             {.teeth = {.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81},
              .planets = planets,
              .pressure_angle_rad = 20.0 * kPi / 180.0,
              .center_distance_m = 21.268e-3 * scale,
              .module_m = {0.8e-3 * scale, 0.8467e-3 * scale},
              .profile_shift = {0.476, 0.762, 2.0, 0.536, 1.21}})
      .value();
}

class Random {
 public:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int planets() { return std::uniform_int_distribution<int>(1, 5)(generator_); }
  /// Every part from geometry.
  Masses masses() {
    Masses m;
    m.density_kgm3 = between(2000.0, 8000.0);
    m.face_width_m = {between(3e-3, 15e-3), between(3e-3, 15e-3)};
    m.bore_radius_m = {between(0.0, 3e-3), between(3e-3, 8e-3), 0.0, between(3e-3, 8e-3), 0.0};
    m.ring1_outer_radius_m = between(41e-3, 50e-3);
    m.ring2_outer_radius_m = between(41e-3, 50e-3);
    m.carrier_outer_radius_m = between(22e-3, 33e-3);
    m.carrier_bore_radius_m = between(0.0, 15e-3);
    m.carrier_thickness_m = between(2e-3, 12e-3);
    m.carrier_density_kgm3 = between(2000.0, 8000.0);
    m.planet_pin_radius_m = between(1e-3, 3e-3);
    m.planet_pin_length_m = between(5e-3, 30e-3);
    return m;
  }

 private:
  std::mt19937_64 generator_{17};
};

Masses scaled(Masses m, double s) {
  for (auto* length : {&m.face_width_m[0], &m.face_width_m[1], &m.ring1_outer_radius_m,
                       &m.ring2_outer_radius_m, &m.carrier_outer_radius_m, &m.carrier_bore_radius_m,
                       &m.carrier_thickness_m, &m.planet_pin_radius_m, &m.planet_pin_length_m}) {
    if (*length) **length *= s;
  }
  for (double& bore : m.bore_radius_m) bore *= s;
  return m;
}

const PartMass& part(const MassModel& model, const std::string& name) {
  const auto found =
      std::ranges::find_if(model.parts, [&](const PartMass& p) { return p.name == name; });
  if (found == model.parts.end()) throw std::invalid_argument("no part " + name);
  return *found;
}

bool has_part(const MassModel& model, const std::string& name) {
  return std::ranges::any_of(model.parts, [&](const PartMass& p) { return p.name == name; });
}

/// Mass and inertia about the z axis of a disc whose centre lies at x = distance, as thin slices
/// along x: a slice of half length h has the area 2 h dx and, about the origin, 2 h x² + 2 h³/3.
/// With x = distance + R cos t the integrands are even polynomials of sin t, cos t: the midpoint
/// rule over a period is exact.
struct Area {
  double area, inertia;
};
Area disc_by_slices(double radius_m, double distance_m) {
  constexpr int kSteps = 16;
  Area sum{.area = 0.0, .inertia = 0.0};
  for (int k = 0; k < kSteps; ++k) {
    const double t = kPi * (k + 0.5) / kSteps;
    const double half = radius_m * std::sin(t);
    const double x = distance_m + radius_m * std::cos(t);
    const double dx = half * kPi / kSteps;
    sum.area += 2.0 * half * dx;
    sum.inertia += (2.0 * half * x * x + 2.0 * half * half * half / 3.0) * dx;
  }
  return sum;
}

TEST(MassModel, PartsAreTheirVolumesIntegrated) {
  Random random;
  LargestDeviation mass, inertia;
  for (int i = 0; i < kCases; ++i) {
    const Masses m = random.masses();
    const auto train = train_of(1.0, random.planets());
    const MassModel model = mass_model(m, train);
    const auto see = [&](const std::string& name, double outer, double inner, double width,
                         double density) {
      const Area full = disc_by_slices(outer, 0.0);
      const Area hole = disc_by_slices(inner, 0.0);
      const PartMass& p = part(model, name);
      const double rho_b = density * width;
      mass.see(i, p.mass_kg.value() - rho_b * (full.area - hole.area),
               32.0 * kEps * rho_b * full.area);
      inertia.see(i, p.inertia_kgm2.value() - rho_b * (full.inertia - hole.inertia),
                  32.0 * kEps * rho_b * full.inertia);
      EXPECT_EQ(p.mass_origin, MassOrigin::kGeometry);
      EXPECT_EQ(p.inertia_origin, MassOrigin::kGeometry);
    };
    const auto toothed = [&](train::GearId id) {
      const auto& g = train.gears[static_cast<std::size_t>(id)];
      return 0.5 * (g.tip_radius_m + g.root_radius_m);
    };
    const double rho = *m.density_kgm3;
    see("S", toothed(train::kS), m.bore_radius_m[train::kS], *m.face_width_m[0], rho);
    see("P1", toothed(train::kP1), m.bore_radius_m[train::kP1], *m.face_width_m[0], rho);
    see("R1", *m.ring1_outer_radius_m, toothed(train::kR1), *m.face_width_m[0], rho);
    see("P2", toothed(train::kP2), m.bore_radius_m[train::kP2], *m.face_width_m[1], rho);
    see("R2", *m.ring2_outer_radius_m, toothed(train::kR2), *m.face_width_m[1], rho);
    see("carrier", *m.carrier_outer_radius_m, *m.carrier_bore_radius_m, *m.carrier_thickness_m,
        *m.carrier_density_kgm3);
    see("pin", *m.planet_pin_radius_m, 0.0, *m.planet_pin_length_m, rho);
  }
  mass.expect_allowed("mass");
  inertia.expect_allowed("inertia");
}

TEST(MassModel, CarrierCarriesItsPinsAtTheCentreDistance) {
  Random random;
  LargestDeviation inertia;
  for (int i = 0; i < kCases; ++i) {
    const Masses m = random.masses();
    const auto train = train_of(1.0, random.planets());
    // Volume integrals about the main axis, the pins where they stand.
    const Area plate = disc_by_slices(*m.carrier_outer_radius_m, 0.0);
    const Area bore = disc_by_slices(*m.carrier_bore_radius_m, 0.0);
    const Area pin = disc_by_slices(*m.planet_pin_radius_m, train.center_distance_m);
    const double plates =
        *m.carrier_density_kgm3 * *m.carrier_thickness_m * (plate.inertia - bore.inertia);
    const double expected =
        plates + train.planets * *m.density_kgm3 * *m.planet_pin_length_m * pin.inertia;
    const MassModel model = mass_model(m, train);
    ASSERT_TRUE(model.bodies);
    inertia.see(i, model.bodies->carrier_kgm2 - expected, 64.0 * kEps * expected);
    EXPECT_EQ(model.bodies->planet1_kgm2, part(model, "P1").inertia_kgm2)
        << "pins do not spin with their planet";
  }
  inertia.expect_allowed("inertia");
}

TEST(MassModel, PinsWithoutPlatesAreTheCarrier) {
  Masses m = Random().masses();
  m.carrier_outer_radius_m.reset();
  m.carrier_bore_radius_m.reset();
  m.carrier_thickness_m.reset();
  const auto train = train_of(1.0, 3);
  const MassModel pins = mass_model(m, train);
  ASSERT_TRUE(pins.bodies);
  EXPECT_FALSE(pins.counts_carrier);
  EXPECT_FALSE(pins.total_mass_kg);
  m.planet_pin_radius_m.reset();
  m.planet_pin_length_m.reset();
  const MassModel none = mass_model(m, train);
  ASSERT_TRUE(none.bodies);
  EXPECT_EQ(none.bodies->carrier_kgm2, 0.0);
  EXPECT_FALSE(has_part(none, "pin"));
  const double d = train.center_distance_m;
  EXPECT_GT(pins.bodies->carrier_kgm2, 3.0 * part(pins, "pin").mass_kg.value() * d * d);
}

TEST(MassModel, MassGrowsWithTheThirdPowerOfSizeAndInertiaWithTheFifth) {
  Random random;
  LargestDeviation mass, inertia;
  for (int i = 0; i < kCases; ++i) {
    const Masses m = random.masses();
    const int planets = random.planets();
    const double s = random.between(0.3, 4.0);
    const MassModel small = mass_model(m, train_of(1.0, planets));
    const MassModel large = mass_model(scaled(m, s), train_of(s, planets));
    const double rounding = 256.0 * kEps;  // thin rings are differences of squares
    ASSERT_EQ(small.parts.size(), large.parts.size());
    for (std::size_t k = 0; k < small.parts.size(); ++k) {
      const PartMass& a = small.parts[k];
      const PartMass& b = large.parts[k];
      mass.see(i, b.mass_kg.value() / a.mass_kg.value() / std::pow(s, 3) - 1.0, rounding);
      inertia.see(i, b.inertia_kgm2.value() / a.inertia_kgm2.value() / std::pow(s, 5) - 1.0,
                  rounding);
    }
    ASSERT_TRUE(small.bodies && large.bodies);
    inertia.see(i, large.bodies->carrier_kgm2 / small.bodies->carrier_kgm2 / std::pow(s, 5) - 1.0,
                rounding);
    mass.see(i, *large.total_mass_kg / *small.total_mass_kg / std::pow(s, 3) - 1.0, rounding);
  }
  mass.expect_allowed("mass");
  inertia.expect_allowed("inertia");
}

TEST(MassModel, TotalCountsEveryPlanetAndPin) {
  const Masses m = Random().masses();
  const MassModel one = mass_model(m, train_of(1.0, 1));
  const MassModel four = mass_model(m, train_of(1.0, 4));
  const double planet = part(one, "P1").mass_kg.value() + part(one, "P2").mass_kg.value() +
                        part(one, "pin").mass_kg.value();
  ASSERT_TRUE(one.total_mass_kg && four.total_mass_kg);
  EXPECT_NEAR(*four.total_mass_kg - *one.total_mass_kg, 3.0 * planet,
              8.0 * kEps * *four.total_mass_kg);
  EXPECT_EQ(part(four, "P2").count, 4);
  EXPECT_EQ(part(four, "pin").count, 4);
  EXPECT_EQ(part(four, "R1").count, 1);
}

TEST(MassModel, TotalNeedsEveryPartAndSaysWhichLacks) {
  Masses m = Random().masses();
  const auto train = train_of(1.0, 3);
  m.ring1_outer_radius_m.reset();
  const MassModel without_ring = mass_model(m, train);
  EXPECT_FALSE(without_ring.total_mass_kg);
  EXPECT_EQ(without_ring.total_mass_missing, "R1 (gears.R1.outer_diameter_mm)");
  EXPECT_TRUE(without_ring.bodies) << "R1 is at rest";
  m.ring1_outer_radius_m = 45e-3;
  m.carrier_thickness_m.reset();
  const MassModel without_plates = mass_model(m, train);
  EXPECT_FALSE(without_plates.total_mass_kg);
  EXPECT_EQ(without_plates.total_mass_missing, "carrier (carrier_thickness_mm)");
  EXPECT_FALSE(without_plates.bodies) << "half a carrier is not none";
  EXPECT_NE(without_plates.bodies_missing.find("inertia.carrier_kgm2"), std::string::npos);
}

// A sun of steel, planets of POM, rings of brass: each volume integrated, times its own density.
TEST(MassModel, GearsOfSeveralMaterialsHaveTheirOwnDensities) {
  Random random;
  Masses m = random.masses();
  m.density_kgm3.reset();
  m.planet_pin_density_kgm3 = 7800.0;
  m.gear_density_kgm3 = {7830.0, 1415.0, 8500.0, 1415.0, 8500.0};
  const auto train = train_of(1.0, 3);
  const MassModel model = mass_model(m, train);
  double total = part(model, "carrier").mass_kg.value();
  for (const std::size_t gear : {train::kS, train::kP1, train::kR1, train::kP2, train::kR2}) {
    const auto& g = train.gears[gear];
    const bool ring = g.gear.kind == geometry::GearKind::kRing;
    const double toothed = 0.5 * (g.tip_radius_m + g.root_radius_m);
    const double outer = !ring                ? toothed
                         : gear == train::kR1 ? *m.ring1_outer_radius_m
                                              : *m.ring2_outer_radius_m;
    const double inner = ring ? toothed : m.bore_radius_m[gear];
    const bool first = gear == train::kS || gear == train::kP1 || gear == train::kR1;
    const double by_hand = m.gear_density_kgm3[gear].value() * *m.face_width_m[first ? 0 : 1] *
                           (disc_by_slices(outer, 0.0).area - disc_by_slices(inner, 0.0).area);
    EXPECT_NEAR(part(model, std::string(train::kGearNames[gear])).mass_kg.value(), by_hand,
                1e-13 * by_hand);
    total += by_hand * (gear == train::kP1 || gear == train::kP2 ? 3.0 : 1.0);
  }
  total +=
      3.0 * 7800.0 * kPi * *m.planet_pin_radius_m * *m.planet_pin_radius_m * *m.planet_pin_length_m;
  EXPECT_NEAR(model.total_mass_kg.value(), total, 1e-13 * total);
  Masses same = m;
  same.density_kgm3 = 7000.0;
  EXPECT_NEAR(part(mass_model(same, train), "P1").mass_kg.value(),
              part(model, "P1").mass_kg.value() * 7000.0 / 1415.0, 1e-12);
  m.gear_density_kgm3[train::kP2].reset();
  EXPECT_FALSE(mass_model(m, train).total_mass_kg);
  EXPECT_TRUE(part(mass_model(m, train), "P1").mass_kg);
}

TEST(MassModel, PlatesTakeTheGearsDensityUnlessTheyHaveTheirOwn) {
  Masses m = Random().masses();
  const auto train = train_of(1.0, 3);
  const double own = part(mass_model(m, train), "carrier").mass_kg.value();
  const double ratio = *m.density_kgm3 / *m.carrier_density_kgm3;
  m.carrier_density_kgm3.reset();
  EXPECT_NEAR(part(mass_model(m, train), "carrier").mass_kg.value() / own, ratio, 8.0 * kEps);
}

TEST(MassModel, StatedInertiasTakePrecedenceAndKeepTheMassOfTheGeometry) {
  Masses m = Random().masses();
  const auto train = train_of(1.0, 3);
  const MassModel geometric = mass_model(m, train);
  m.sun_kgm2 = 1e-3;
  m.carrier_kgm2 = 2e-3;
  const MassModel stated = mass_model(m, train);
  EXPECT_EQ(part(stated, "S").inertia_kgm2, 1e-3);
  EXPECT_EQ(part(stated, "S").inertia_origin, MassOrigin::kStated);
  EXPECT_EQ(part(stated, "S").mass_origin, MassOrigin::kGeometry);
  EXPECT_EQ(part(stated, "S").mass_kg, part(geometric, "S").mass_kg);
  ASSERT_TRUE(stated.bodies);
  EXPECT_EQ(stated.bodies->sun_kgm2, 1e-3);
  EXPECT_EQ(stated.bodies->carrier_kgm2, 2e-3) << "holds the pins already";
  EXPECT_EQ(stated.bodies->ring2_kgm2, geometric.bodies->ring2_kgm2);
}

TEST(MassModel, StatedPlanetMassIsOfBothSteps) {
  Masses m = Random().masses();
  const auto train = train_of(1.0, 3);
  const MassModel geometric = mass_model(m, train);
  m.planet_mass_kg =
      part(geometric, "P1").mass_kg.value() + part(geometric, "P2").mass_kg.value() + 0.1;
  const MassModel stated = mass_model(m, train);
  EXPECT_FALSE(part(stated, "P1").mass_kg);
  EXPECT_FALSE(part(stated, "P2").mass_kg);
  EXPECT_EQ(part(stated, "planet").mass_kg, m.planet_mass_kg);
  EXPECT_EQ(part(stated, "planet").mass_origin, MassOrigin::kStated);
  EXPECT_FALSE(has_part(geometric, "planet"));
  EXPECT_NEAR(*stated.total_mass_kg - *geometric.total_mass_kg, 0.3,
              16.0 * kEps * *stated.total_mass_kg);
  EXPECT_EQ(stated.bodies->planet_mass_kg, *m.planet_mass_kg);
}

TEST(MassModel, NothingStatedIsNothingKnown) {
  const MassModel model = mass_model({}, train_of(1.0, 3));
  EXPECT_FALSE(model.bodies);
  EXPECT_FALSE(model.total_mass_kg);
  EXPECT_EQ(model.parts.size(), 6U);
  for (const PartMass& p : model.parts) {
    EXPECT_FALSE(p.mass_kg || p.inertia_kgm2) << p.name;
    EXPECT_NE(model.total_mass_missing.find(p.name + " ("), std::string::npos) << p.name;
  }
  EXPECT_TRUE(model.total_mass_missing.starts_with(
      "S (density_kg_m3, stage1.face_width_mm); P1 (density_kg_m3, stage1.face_width_mm); "))
      << model.total_mass_missing;
  EXPECT_NE(model.total_mass_missing.find("R2 (density_kg_m3, stage2.face_width_mm, "
                                          "gears.R2.outer_diameter_mm)"),
            std::string::npos);
}

TEST(MassModel, PinsInPlanetsWithoutABoreAreSaid) {
  Masses m = Random().masses();
  EXPECT_FALSE(mass_model(m, train_of(1.0, 3)).pins_in_solid_planets);
  m.bore_radius_m[train::kP2] = 0.0;
  EXPECT_TRUE(mass_model(m, train_of(1.0, 3)).pins_in_solid_planets);
}

TEST(MassModel, CarrierOfPlatesEqualsTheSameCarrierStated) {
  Design d;
  d.train = {.teeth = {.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81},
             .planets = 3,
             .pressure_angle_rad = 20.0 * kPi / 180.0,
             .center_distance_m = 21.268e-3,
             .module_m = {0.8e-3, 0.8467e-3},
             .profile_shift = {0.476, 0.762, 2.0, 0.536, 1.21}};
  d.center_distance_given = true;
  d.masses = Random().masses();
  const auto plates = std::get<Evaluation>(evaluate(d));
  ASSERT_TRUE(plates.inertia);
  EXPECT_TRUE(plates.total_mass_kg);
  EXPECT_EQ(plates.parts.size(), 7U);
  Design stated = d;
  const auto bodies = mass_model(d.masses, train_of(1.0, 3)).bodies;
  stated.masses.carrier_kgm2 = bodies.value().carrier_kgm2;
  const auto same = std::get<Evaluation>(evaluate(stated));
  EXPECT_EQ(plates.inertia->lossless_kgm2, same.inertia.value().lossless_kgm2);
  stated.masses.carrier_kgm2 = 0.0;
  const auto without = std::get<Evaluation>(evaluate(stated));
  // The carrier turns at sun speed over 1 + zR1/zS.
  const double turns = plates.ratio / (1.0 + 90.0 / 12.0);
  EXPECT_NEAR((plates.inertia->lossless_kgm2 - without.inertia.value().lossless_kgm2) /
                  (turns * turns * bodies->carrier_kgm2),
              1.0, 1e-10);
}

}  // namespace
}  // namespace gear3k::design::mass_model_test
