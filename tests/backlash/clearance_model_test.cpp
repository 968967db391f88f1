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
#include "tests/backlash/built_gearbox.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::backlash::clearance_model_test {
namespace {

using train::TrainGeometry, train::TrainParameters;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

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
  RandomSubject random(81);
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
  RandomSubject random(82);
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
  RandomSubject random(83);
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
  RandomSubject random(84);
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
  RandomSubject random(85);
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
  RandomSubject random(86);
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
  RandomSubject random(87);
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
}  // namespace gear3k::backlash::clearance_model_test
