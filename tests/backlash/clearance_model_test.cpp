#include "backlash/clearance_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "backlash/lost_motion.hpp"
#include "tests/backlash/flank_geometry.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::backlash {
namespace {

using train::TrainGeometry, train::TrainParameters;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

struct Subject {
  TrainParameters<double> parameters;
  TrainGeometry<double> geometry;
};

class Random : public RandomTrain {
 public:
  explicit Random(std::uint_fast64_t seed) : RandomTrain(seed) {}

  /// A train whose working angles leave the second order small.
  Subject subject() {
    for (;;) {
      const auto t = train(count(0, 1) == 1);
      TrainParameters<double> p{};
      p.teeth = t.teeth;
      p.planets = count(1, 5);
      p.pressure_angle_rad = t.gears[train::kS].angle.alpha_rad;
      p.center_distance_m = t.center_distance_m;
      p.module_m = {t.gears[train::kS].gear.module_m, t.gears[train::kP2].gear.module_m};
      for (std::size_t g = 0; g < train::kGearCount; ++g) {
        p.profile_shift[g] = t.gears[g].gear.profile_shift;
        p.machining_allowance[g] = between(0.0, 0.05);
      }
      const auto made = make_train_geometry(p);
      if (made && std::ranges::all_of(made->meshes, [](const auto& m) {
            return m.alpha_w_rad > 0.2 && m.alpha_w_rad < 0.7;
          })) {
        return {.parameters = p, .geometry = *made};
      }
    }
  }
  DeviationLimits limits(double least, double greatest) {
    const double a = between(least, greatest);
    const double b = between(least, greatest);
    return {.lower = std::min(a, b), .upper = std::max(a, b)};
  }
  Tolerances tolerances() {
    Tolerances t;
    for (GearTolerances& g : t.gears) {
      g.tooth_thickness_m = limits(-60e-6, 0.0);
      g.runout_m = between(5e-6, 20e-6);
      g.cumulative_pitch_m = between(30e-6, 45e-6);
      g.single_pitch_m = between(1e-6, 10e-6);
    }
    t.center_distance_m = limits(-20e-6, 20e-6);
    t.pin_position_m = between(5e-6, 20e-6);
    t.planet_phase_rad = limits(-5e-3, 5e-3);
    return t;
  }
  /// Within the limits.
  DeviationValue value(const ClearanceModel& model, const Deviation& d) {
    const double limit = model.sources[d.source].half_width_m;
    if (!d.planar) return {.x_m = between(-limit, limit)};
    const double angle = between(-kPi, kPi);
    const double radius = between(0.0, limit);
    return {.x_m = radius * std::cos(angle), .y_m = radius * std::sin(angle)};
  }
};

/// Centre distance at the middle of its tolerance.
TrainGeometry<double> at_middle(const Subject& subject, const Tolerances& tolerances) {
  auto p = subject.parameters;
  p.center_distance_m += tolerances.center_distance_m.middle();
  return *make_train_geometry(p);
}

/// The meshes as built, by what each deviation is said to be: nothing of its effects is read but,
/// for single pitches, which tooth touches where.
std::vector<PlanetPlay> built_plays(const TrainGeometry<double>& t, const Tolerances& tolerances,
                                    const ClearanceModel& model,
                                    const std::vector<DeviationValue>& values) {
  std::vector<PlanetPlay> result(static_cast<std::size_t>(model.planets));
  for (int planet = 0; planet < model.planets; ++planet) {
    const double angle = 2.0 * kPi * planet / model.planets;
    for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
      const auto k = static_cast<std::size_t>(mesh);
      const bool internal = mesh != train::kMeshSP1;
      const int central_gear = train::kMeshGears[k][internal ? 1 : 0];
      const int planet_gear = train::kMeshGears[k][internal ? 0 : 1];
      const auto middle = [&](int gear) {
        return tolerances.gears[static_cast<std::size_t>(gear)].tooth_thickness_m.middle();
      };
      ToothChange central{.thicker_m = middle(central_gear)};
      ToothChange own{.thicker_m = middle(planet_gear)};
      if (mesh == train::kMeshP2R2) own.turned_rad = tolerances.planet_phase_rad.middle();
      Point central_off, planet_off;
      std::array<double, 2> single{};  // arcs on the base circle that take from u
      for (std::size_t i = 0; i < values.size(); ++i) {
        const Deviation& d = model.deviations[i];
        const ToleranceSource& source = model.sources[d.source];
        const DeviationValue& v = values[i];
        const bool of_central = source.gear == central_gear;
        const bool of_planet = source.gear == planet_gear && d.planet == planet;
        if (source.gear >= 0 && !of_central && !of_planet) continue;
        if (source.gear < 0 && d.planet >= 0 && d.planet != planet) continue;
        ToothChange& change = of_central ? central : own;
        Point& off = of_central ? central_off : planet_off;
        switch (source.kind) {
          case ToleranceKind::kCenterDistance:
            planet_off.x += v.x_m * std::cos(angle);
            planet_off.y += v.x_m * std::sin(angle);
            break;
          case ToleranceKind::kToothThickness:
            change.thicker_m += v.x_m;
            break;
          case ToleranceKind::kPinPosition:
          case ToleranceKind::kRunout:
            off.x += v.x_m;
            off.y += v.y_m;
            break;
          case ToleranceKind::kPlanetPhase:
            if (mesh != train::kMeshP2R2) break;
            own.turned_rad += v.x_m / t.gears[train::kP2].base_radius_m;
            break;
          case ToleranceKind::kCumulativePitch: {
            // The tooth that stands towards the mesh, seen from the gear's own centre.
            const double at = of_planet && !internal ? angle + kPi : angle;
            const double arc_m = v.x_m * std::cos(at) + v.y_m * std::sin(at);
            change.turned_rad +=
                arc_m / t.gears[static_cast<std::size_t>(source.gear)].reference_radius_m;
            break;
          }
          case ToleranceKind::kSinglePitch: {
            EXPECT_EQ(d.x.size(), 1U);
            const std::size_t bound = d.x.front().bound;
            if (bound / 2 != static_cast<std::size_t>(planet * train::kMeshCount + mesh)) break;
            const auto& gear = t.gears[static_cast<std::size_t>(source.gear)];
            const double turned = v.x_m / gear.reference_radius_m;
            // Only the one flank: placed below.
            single[bound % 2] += turned * gear.base_radius_m *
                                 (of_central                ? 1.0
                                  : mesh == train::kMeshSP1 ? 1.0
                                                            : -1.0);
            break;
          }
        }
      }
      PlacedMesh placed = placed_mesh(t, mesh, angle, central, own);
      placed.central.x += central_off.x;
      placed.central.y += central_off.y;
      placed.planet.x += planet_off.x;
      placed.planet.y += planet_off.y;
      for (const std::size_t side : {0U, 1U}) {
        placed.central_origin[side] += single[side] / placed.central_rb;
      }
      const auto ends = placed.ends();
      result[static_cast<std::size_t>(planet)][k] = {.lower_m = ends.lower, .upper_m = ends.upper};
    }
  }
  return result;
}

/// Second order of a displacement: (cos α n + sin α t)²/(2 d sin α), and a half for the third.
double second_order(const TrainGeometry<double>& t, std::size_t mesh, double displacement_m) {
  return 0.75 * displacement_m * displacement_m /
         (t.center_distance_m * std::sin(t.meshes[mesh].alpha_w_rad));
}
double rounding(const TrainGeometry<double>& t) { return 200.0 * kEps * t.center_distance_m; }

class EachDeviation : public ::testing::TestWithParam<ToleranceKind> {};
INSTANTIATE_TEST_SUITE_P(Of, EachDeviation,
                         ::testing::Values(ToleranceKind::kCenterDistance,
                                           ToleranceKind::kToothThickness,
                                           ToleranceKind::kPinPosition, ToleranceKind::kPlanetPhase,
                                           ToleranceKind::kRunout, ToleranceKind::kCumulativePitch,
                                           ToleranceKind::kSinglePitch),
                         [](const ::testing::TestParamInfo<ToleranceKind>& kind) {
                           return std::string(
                               kToleranceKindNames[static_cast<std::size_t>(kind.param)]);
                         });

TEST_P(EachDeviation, MovesTheFlanksAsDisplacedTeethDo) {
  Random random(81);
  LargestDeviation largest;
  const bool moves_centres = GetParam() == ToleranceKind::kCenterDistance ||
                             GetParam() == ToleranceKind::kPinPosition ||
                             GetParam() == ToleranceKind::kRunout;
  for (int i = 0; i < 400; ++i) {
    const Subject subject = random.subject();
    const Tolerances tolerances = random.tolerances();
    const auto model = clearance_model(subject.parameters, tolerances);
    ASSERT_TRUE(model);
    const auto t = at_middle(subject, tolerances);
    std::vector<std::size_t> of_kind;
    for (std::size_t d = 0; d < model->deviations.size(); ++d) {
      if (model->sources[model->deviations[d].source].kind == GetParam()) of_kind.push_back(d);
    }
    ASSERT_FALSE(of_kind.empty());
    std::vector<DeviationValue> values(model->deviations.size());
    const std::size_t one =
        of_kind[static_cast<std::size_t>(random.count(0, static_cast<int>(of_kind.size()) - 1))];
    values[one] = random.value(*model, model->deviations[one]);
    const auto exact = built_plays(t, tolerances, *model, values);
    const auto modelled = plays(*model, values);
    ASSERT_EQ(modelled.size(), exact.size());
    for (std::size_t p = 0; p < exact.size(); ++p) {
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        const double displacement =
            moves_centres ? std::hypot(values[one].x_m, values[one].y_m) : 0.0;
        const double allowed = second_order(t, k, displacement) + rounding(t);
        largest.see(i, modelled[p][k].lower_m - exact[p][k].lower_m, allowed);
        largest.see(i, modelled[p][k].upper_m - exact[p][k].upper_m, allowed);
      }
    }
  }
  largest.expect_allowed("bound");
}

TEST(ClearanceModel, AllDeviationsAtOnceAreThoseOfTheBuiltGearbox) {
  Random random(82);
  LargestDeviation largest;
  for (int i = 0; i < 400; ++i) {
    const Subject subject = random.subject();
    const Tolerances tolerances = random.tolerances();
    const auto model = clearance_model(subject.parameters, tolerances);
    ASSERT_TRUE(model);
    const auto t = at_middle(subject, tolerances);
    std::vector<DeviationValue> values;
    values.reserve(model->deviations.size());
    for (const Deviation& d : model->deviations) values.push_back(random.value(*model, d));
    const auto exact = built_plays(t, tolerances, *model, values);
    const auto modelled = plays(*model, values);
    // Centres: carrier, pin, run-out of sun or ring and of the planet's step.
    const double displacement = 20e-6 + 10e-6 + 10e-6 + 10e-6;
    for (std::size_t p = 0; p < exact.size(); ++p) {
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        const double allowed = second_order(t, k, displacement) + rounding(t);
        largest.see(i, modelled[p][k].lower_m - exact[p][k].lower_m, allowed);
        largest.see(i, modelled[p][k].upper_m - exact[p][k].upper_m, allowed);
      }
    }
  }
  largest.expect_allowed("bound");
}

TEST(ClearanceModel, MiddleIsTheGeometryAtTheMiddleOfEveryTolerance) {
  Random random(83);
  LargestDeviation largest;
  for (int i = 0; i < 500; ++i) {
    const Subject subject = random.subject();
    const Tolerances tolerances = random.tolerances();
    const auto model = clearance_model(subject.parameters, tolerances);
    ASSERT_TRUE(model);
    const auto t = at_middle(subject, tolerances);
    for (int planet = 0; planet < model->planets; ++planet) {
      for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
        const auto [first, second] = train::kMeshGears[static_cast<std::size_t>(mesh)];
        const bool internal = mesh != train::kMeshSP1;
        const auto thicker = [&](int gear) {
          return tolerances.gears[static_cast<std::size_t>(gear)].tooth_thickness_m.middle();
        };
        const double turned = mesh == train::kMeshP2R2 ? tolerances.planet_phase_rad.middle() : 0.0;
        const auto ends =
            placed_mesh(t, mesh, 2.0 * kPi * planet / model->planets,
                        {.thicker_m = thicker(internal ? second : first)},
                        {.thicker_m = thicker(internal ? first : second), .turned_rad = turned})
                .ends();
        largest.see(i, model->middle_m[bound_index(planet, mesh, false)] - ends.lower, rounding(t));
        largest.see(i, model->middle_m[bound_index(planet, mesh, true)] - ends.upper, rounding(t));
      }
    }
  }
  largest.expect_allowed("middle");
}

TEST(ClearanceModel, ThinnerTeethOpenTheBacklashOfAsMuchMoreMachiningAllowance) {
  // Thinner by A on the reference circle is cos α A normal to the flank.
  Random random(84);
  LargestDeviation largest;
  for (int i = 0; i < 500; ++i) {
    const Subject subject = random.subject();
    const auto gear = static_cast<std::size_t>(random.count(0, train::kGearCount - 1));
    Tolerances tolerances;
    const double least = random.between(-80e-6, -20e-6);
    tolerances.gears[gear].tooth_thickness_m = {.lower = least, .upper = 0.0};
    const auto model = clearance_model(subject.parameters, tolerances);
    ASSERT_TRUE(model);
    auto thinned = subject.parameters;
    thinned.machining_allowance[gear] += -least * std::cos(thinned.pressure_angle_rad) /
                                         thinned.module_m[gear >= train::kP2 ? 1 : 0];
    const auto j = normal_backlashes(*make_train_geometry(thinned));
    const std::vector<DeviationValue> all_at_least(model->deviations.size(), {.x_m = 0.5 * least});
    for (const PlanetPlay& planet : plays(*model, all_at_least)) {
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        largest.see(i, planet[k].upper_m - planet[k].lower_m - j[k], rounding(subject.geometry));
      }
    }
  }
  largest.expect_allowed("backlash");
}

TEST(ClearanceModel, EccentricityAndTheRestReachTheStatedCumulativePitchTogether) {
  Random random(85);
  for (int i = 0; i < 200; ++i) {
    const Subject subject = random.subject();
    const Tolerances tolerances = random.tolerances();
    const auto model = clearance_model(subject.parameters, tolerances);
    ASSERT_TRUE(model);
    const double cos_alpha = std::cos(subject.parameters.pressure_angle_rad);
    for (int gear = 0; gear < train::kGearCount; ++gear) {
      // Of every bound that the gear takes part in: twice the greatest sum over a turn.
      std::vector<double> reach(model->middle_m.size());
      for (const Deviation& d : model->deviations) {
        const ToleranceSource& source = model->sources[d.source];
        if (source.gear != gear || !d.planar) continue;
        for (std::size_t e = 0; e < d.x.size(); ++e) {
          ASSERT_EQ(d.x[e].bound, d.y[e].bound);
          reach[d.x[e].bound] +=
              2.0 * source.half_width_m * std::hypot(d.x[e].coefficient, d.y[e].coefficient);
        }
      }
      const double stated = tolerances.gears[static_cast<std::size_t>(gear)].cumulative_pitch_m;
      const bool two_meshes = gear == train::kP1;
      int reached = 0;
      for (const double r : reach) {
        if (r == 0.0) continue;
        ++reached;
        EXPECT_NEAR(r, stated * cos_alpha, 100.0 * kEps * stated);
      }
      EXPECT_EQ(reached, 2 * model->planets * (two_meshes ? 2 : 1));
    }
  }
}

TEST(ClearanceModel, SharedDeviationsStandOnceAndThoseOfPlanetsOncePerPlanet) {
  Random random(86);
  const Subject subject = random.subject();
  const Tolerances tolerances = random.tolerances();
  const auto model = clearance_model(subject.parameters, tolerances);
  ASSERT_TRUE(model);
  const int n = model->planets;
  for (std::size_t s = 0; s < model->sources.size(); ++s) {
    const ToleranceSource& source = model->sources[s];
    const bool planets = source.gear == train::kP1 || source.gear == train::kP2 ||
                         source.kind == ToleranceKind::kPinPosition ||
                         source.kind == ToleranceKind::kPlanetPhase;
    const auto count =
        std::ranges::count_if(model->deviations, [&](const auto& d) { return d.source == s; });
    const int flanks = source.gear == train::kP1 ? 4 : 2;
    EXPECT_EQ(count, source.kind == ToleranceKind::kSinglePitch ? flanks * n
                     : planets                                  ? n
                                                                : 1)
        << source.name();
  }
}

TEST(ClearanceModel, WithoutTolerancesIsTheDrawing) {
  Random random(87);
  const Subject subject = random.subject();
  const auto model = clearance_model(subject.parameters, {});
  ASSERT_TRUE(model);
  EXPECT_TRUE(model->sources.empty());
  EXPECT_TRUE(model->deviations.empty());
  const auto j = normal_backlashes(subject.geometry);
  for (const PlanetPlay& planet : plays(*model, {})) {
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      EXPECT_DOUBLE_EQ(planet[k].upper_m, 0.5 * j[k]);
      EXPECT_DOUBLE_EQ(planet[k].lower_m, -0.5 * j[k]);
    }
  }
  EXPECT_THROW(plays(*model, std::vector<DeviationValue>(1)), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::backlash
