#include "design/checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>

namespace gear3k::design::checks_test {
namespace {

using geometry::GearKind;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

Limits all_on() {
  Limits limits = default_limits();
  for (auto& limit : limits.limit) limit = limit.value_or(0.0);
  return limits;
}

train::TrainParameters<double> low_backlash() {
  return {.teeth = {.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92},
          .planets = 3,
          .pressure_angle_rad = 20.0 * kPi / 180.0,
          .center_distance_m = 16.19e-3,
          .module_m = {0.59e-3, 0.58e-3},
          .profile_shift = {0.5, 0.0, 0.45, 0.4, 0.29},
          .machining_allowance = {0.02, 0.02, 0.02, 0.02, 0.02},
          .tip_shortening = {},
          .rack = {}};
}

train::TrainParameters<double> bilateral() {
  return {.teeth = {.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81},
          .planets = 3,
          .pressure_angle_rad = 20.0 * kPi / 180.0,
          .center_distance_m = 21.268e-3,
          .module_m = {0.8e-3, 0.8467e-3},
          .profile_shift = {0.476, 0.762, 2.0, 0.536, 1.21},
          .machining_allowance = {},
          .tip_shortening = {},
          .rack = {}};
}

/// A train with all that its checks look at.
struct Subject {
  explicit Subject(const train::TrainParameters<double>& parameters)
      : train(make_train_geometry(parameters).value()), j(backlash::normal_backlashes(train)) {
    std::ranges::transform(train.gears, forms.begin(), geometry::make_tooth_form<double>);
    axial.extent.fill(train::AxialInterval{.from_m = 0.0, .to_m = 0.01});
    axial.carrier_radius_m = 0.02;
  }

  [[nodiscard]] Gearing<double> gearing(
      backlash::LostMotionModel model = backlash::LostMotionModel::kKinematic) const {
    Gearing<double> g = gearing_of(train, j, model);
    g.forms = forms;
    g.axial = &axial;
    return g;
  }

  double value(CheckId id, CheckSubject subject = {},
               backlash::LostMotionModel model = backlash::LostMotionModel::kKinematic) const {
    return check_value(CheckInstance{.record = &check_record(id), .subject = subject},
                       gearing(model));
  }

  train::TrainGeometry<double> train;
  std::array<double, train::kMeshCount> j;
  std::array<geometry::ToothForm<double>, train::kGearCount> forms;
  train::AxialLayout axial;
};

/// A train whose bodies all overlap along the axis and whose rings are shaped by cutters.
TrainLayout full_layout(int planets = 3, double stage1_module_m = 1e-3) {
  TrainLayout layout{.planets = planets, .stage1_module_m = stage1_module_m};
  layout.cutter[train::kR1].teeth = 25;
  layout.cutter[train::kR2].teeth = 25;
  layout.axial.extent.fill(train::AxialInterval{.from_m = 0.0, .to_m = 0.01});
  return layout;
}

TEST(CheckRegistry, EveryRecordIsCompleteAndAtThePlaceOfItsId) {
  ASSERT_EQ(check_records().size(), kCheckCount);
  for (std::size_t i = 0; i < kCheckCount; ++i) {
    const CheckRecord& r = check_records()[i];
    EXPECT_EQ(static_cast<std::size_t>(r.id), i) << r.name;
    EXPECT_EQ(&check_record(r.id), &r);
    EXPECT_FALSE(r.name.empty());
    EXPECT_FALSE(r.title.empty()) << r.name;
    EXPECT_FALSE(r.help.empty()) << r.name;
    EXPECT_NE(r.value, nullptr) << r.name;
    EXPECT_NE(r.value1, nullptr) << r.name;
    EXPECT_NE(r.value2, nullptr) << r.name;
  }
}

TEST(CheckRegistry, NamesTitlesAndHelpTextsAreUniqueAndNamesFitInFiles) {
  std::set<std::string_view> names, titles, helps;
  for (const CheckRecord& r : check_records()) {
    EXPECT_TRUE(names.insert(r.name).second) << r.name;
    EXPECT_TRUE(titles.insert(r.title).second) << r.title;
    EXPECT_TRUE(helps.insert(r.help).second) << r.help;
    EXPECT_TRUE(std::ranges::all_of(r.name, [](char c) {
      return (c >= 'a' && c <= 'z') || c == '_';
    })) << r.name;
  }
}

TEST(CheckRegistry, OfEachLeastAndGreatestPairOneIsAtLeastAndTheOtherAtMost) {
  EXPECT_TRUE(check_record(CheckId::kContactRatioMin).at_least);
  EXPECT_FALSE(check_record(CheckId::kContactRatioMax).at_least);
  EXPECT_TRUE(check_record(CheckId::kOutputBacklashMin).at_least);
  EXPECT_FALSE(check_record(CheckId::kOutputBacklashMax).at_least);
  EXPECT_FALSE(check_record(CheckId::kRingRootDiameter).at_least);
  EXPECT_FALSE(check_record(CheckId::kCoaxiality).at_least);
  for (const CheckId id :
       {CheckId::kUndercut, CheckId::kTipThickness, CheckId::kRingTipThickness,
        CheckId::kRingTipOutsideBase, CheckId::kInvoluteInterference, CheckId::kFormCircle,
        CheckId::kTipFouling, CheckId::kRootClearance, CheckId::kTrochoidInterference,
        CheckId::kTrimming, CheckId::kRingCutter, CheckId::kBodyGap, CheckId::kPlanetGap,
        CheckId::kNormalBacklash, CheckId::kEqualSpacing, CheckId::kIdenticalPlanets}) {
    EXPECT_TRUE(check_record(id).at_least) << check_record(id).name;
  }
}

TEST(Units, ConvertThereAndBackAndAreNamed) {
  const std::map<Unit, std::pair<std::string, double>> units{
      {Unit::kNone, {"", 1.0}},
      {Unit::kModule, {"module", 1.0}},
      {Unit::kMillimetre, {"mm", 1e-3}},
      {Unit::kMicrometre, {"um", 1e-6}},
      {Unit::kArcmin, {"arcmin", kPi / 10800.0}},
      {Unit::kDegree, {"deg", kPi / 180.0}}};
  for (const auto& [unit, expected] : units) {
    EXPECT_EQ(unit_name(unit), expected.first);
    EXPECT_NEAR(units::to_si(3.5, unit), 3.5 * expected.second, 4.0 * kEps * 3.5 * expected.second);
    EXPECT_NEAR(units::from_si(units::to_si(3.5, unit), unit), 3.5, 4.0 * kEps * 3.5);
  }
}

TEST(DefaultLimits, AreTheRecordsInSiAndEmptyWhereTheRecordHasNone) {
  const Limits limits = default_limits();
  for (const CheckRecord& r : check_records()) {
    ASSERT_EQ(limits[r.id].has_value(), r.default_limit.has_value()) << r.name;
    EXPECT_EQ(limits[r.id].value_or(0.0), units::to_si(r.default_limit.value_or(0.0), r.unit))
        << r.name;
  }
  EXPECT_EQ(limits.model, backlash::LostMotionModel::kKinematic);
}

std::map<CheckScope, std::set<std::size_t>> counts_by_scope(const GearingLayout& layout) {
  std::map<CheckId, std::size_t> by_id;
  for (const CheckInstance& c : list_checks(all_on(), layout)) ++by_id[c.record->id];
  std::map<CheckScope, std::set<std::size_t>> result;
  for (const CheckRecord& r : check_records()) result[r.scope].insert(by_id[r.id]);
  return result;
}

using Counts = std::set<std::size_t>;

TEST(ListChecks, OfATrainHasOneEntryPerMemberOfItsScope) {
  auto counts = counts_by_scope(train_layout(full_layout()));
  EXPECT_EQ(counts[CheckScope::kExternalGear], Counts{3});  // S, P1, P2
  EXPECT_EQ(counts[CheckScope::kRing], Counts{2});
  EXPECT_EQ(counts[CheckScope::kMesh], Counts{3});
  EXPECT_EQ(counts[CheckScope::kTip], Counts{4});  // both gears of S-P1, the rings of the others
  EXPECT_EQ(counts[CheckScope::kMember], Counts{6});
  EXPECT_EQ(counts[CheckScope::kInternalMesh], Counts{2});
  EXPECT_EQ(counts[CheckScope::kCutRing], Counts{2});
  EXPECT_EQ(counts[CheckScope::kBodyPair], Counts{5});
  EXPECT_EQ(counts[CheckScope::kPlanetStep], Counts{2});
  EXPECT_EQ(counts[CheckScope::kTrain], Counts{1});
}

TEST(ListChecks, OfOnePlanetHasNoGapBetweenPlanets) {
  auto counts = counts_by_scope(train_layout(full_layout(1)));
  EXPECT_EQ(counts[CheckScope::kPlanetStep], Counts{0});
  EXPECT_EQ(counts[CheckScope::kTrain], Counts{1});
}

TEST(ListChecks, OfAPairHasNeitherPlanetsNorATrain) {
  constexpr std::array<std::array<int, 2>, 1> kPair{{{0, 1}}};
  for (const GearKind second : {GearKind::kExternal, GearKind::kRing}) {
    const std::array<GearKind, 2> kinds{GearKind::kExternal, second};
    const bool ring = second == GearKind::kRing;
    auto counts = counts_by_scope({.gear_kinds = kinds,
                                   .mesh_gears = kPair,
                                   .shaped = {false, false},
                                   .length_scale_m = 1e-3});
    EXPECT_EQ(counts[CheckScope::kExternalGear], Counts{ring ? 1U : 2U});
    EXPECT_EQ(counts[CheckScope::kRing], Counts{ring ? 1U : 0U});
    EXPECT_EQ(counts[CheckScope::kMesh], Counts{1});
    EXPECT_EQ(counts[CheckScope::kTip], Counts{ring ? 1U : 2U});
    EXPECT_EQ(counts[CheckScope::kMember], Counts{2});
    EXPECT_EQ(counts[CheckScope::kInternalMesh], Counts{ring ? 1U : 0U});
    EXPECT_EQ(counts[CheckScope::kCutRing], Counts{0});
    EXPECT_EQ(counts[CheckScope::kBodyPair], Counts{0});
    EXPECT_EQ(counts[CheckScope::kPlanetStep], Counts{0});
    EXPECT_EQ(counts[CheckScope::kTrain], Counts{0});
  }
}

TEST(ListChecks, LeavesOutWhatIsSwitchedOffAndKeepsTheOrderOfTheRegistry) {
  for (const CheckRecord& off : check_records()) {
    Limits limits = all_on();
    limits[off.id] = std::nullopt;
    int last = -1;
    for (const CheckInstance& c : list_checks(limits, train_layout(full_layout()))) {
      EXPECT_NE(c.record->id, off.id);
      EXPECT_GE(static_cast<int>(c.record->id), last);
      last = static_cast<int>(c.record->id);
    }
  }
}

TEST(ListChecks, CarriesTheLimitInForceAndAPositiveScale) {
  Limits limits = all_on();
  double value = 0.01;
  for (auto& limit : limits.limit) limit = value += 0.01;
  for (const CheckInstance& c : list_checks(limits, train_layout(full_layout()))) {
    EXPECT_EQ(c.limit, *limits[c.record->id]);
    EXPECT_GT(c.scale, 0.0);
  }
}

TEST(CheckMargin, IsPositiveOnTheGoodSideOfTheLimitAndZeroOnIt) {
  const Subject s(low_backlash());
  const auto gearing = s.gearing();
  for (CheckInstance c : list_checks(all_on(), train_layout(full_layout(3, 0.59e-3)))) {
    SCOPED_TRACE(c.record->name);
    const double value = check_value(c, gearing);
    c.limit = value;
    EXPECT_EQ(check_margin(c, gearing), 0.0);
    const double step = 0.1 * std::max(std::abs(value), 1e-6);
    c.limit = value - step;
    EXPECT_EQ(check_margin(c, gearing) > 0.0, c.record->at_least);
    EXPECT_NEAR(std::abs(check_margin(c, gearing)), step, 4.0 * kEps * (std::abs(value) + step));
    c.limit = value + step;
    EXPECT_EQ(check_margin(c, gearing) < 0.0, c.record->at_least);
  }
}

TEST(CheckValue, LengthsOfAToothAreInTheModuleOfTheirOwnGear) {
  // The same gearing ten times larger has the same values in modules.
  auto p = low_backlash();
  const Subject small(p);
  p.center_distance_m *= 10.0;
  for (double& m : p.module_m) m *= 10.0;
  Subject large(p);
  large.axial.carrier_radius_m *= 10.0;
  for (const CheckInstance& c : list_checks(all_on(), train_layout(full_layout()))) {
    const CheckId id = c.record->id;
    if (id == CheckId::kGearboxLength) continue;  // that of [axial], which stays
    const double ratio = large.value(id, c.subject) / small.value(id, c.subject);
    const bool length = c.record->unit == Unit::kMillimetre || c.record->unit == Unit::kMicrometre;
    if (small.value(id, c.subject) == 0.0) {
      EXPECT_EQ(large.value(id, c.subject), 0.0) << c.record->name;
    } else {
      EXPECT_NEAR(ratio, length ? 10.0 : 1.0, 1e-10) << c.record->name;
    }
  }
}

TEST(CheckValue, PlanetGapIsInModulesOfStageOneForBothSteps) {
  const Subject s(low_backlash());
  const double chord = 2.0 * 16.19e-3 * std::sin(kPi / 3.0);
  const double tip1 = 0.59e-3 * (20.0 + 1.0 + 0.0);
  const double tip2 = 0.58e-3 * (18.0 + 1.0 + 0.4);
  EXPECT_NEAR(s.value(CheckId::kPlanetGap, {.member = train::kP1}), (chord - 2.0 * tip1) / 0.59e-3,
              64.0 * kEps * 40.0);
  EXPECT_NEAR(s.value(CheckId::kPlanetGap, {.member = train::kP2}), (chord - 2.0 * tip2) / 0.59e-3,
              64.0 * kEps * 40.0);
}

TEST(CheckValue, BodyGapIsTheRadialRoomBetweenTipCircles) {
  const Subject s(low_backlash());
  // Tip radii m (z/2 + 1 + x), of rings m (z/2 - 1 + x); d = 16.19 mm, carrier radius 20 mm.
  const double d = 16.19, m1 = 0.59, m2 = 0.58;
  const double tip_S = m1 * 8.5, tip_P1 = m1 * 21.0, tip_R1 = m1 * 46.45;
  const double tip_P2 = m2 * 19.4, tip_R2 = m2 * 45.29;
  const std::array<double, 5> gap_mm{d - tip_P2 - tip_S, tip_R1 - d - tip_P2, tip_R2 - d - tip_P1,
                                     tip_R1 - 20.0, tip_R2 - 20.0};
  for (int pair = 0; pair < 5; ++pair) {
    EXPECT_NEAR(s.value(CheckId::kBodyGap, {.member = pair}),
                gap_mm[static_cast<std::size_t>(pair)] / m1, 256.0 * kEps * 50.0);
  }
}

TEST(CheckValue, CoaxialityIsTheDistanceFromEachMeshsOwnCentreDistance) {
  // Zero-backlash distances of the proposed gear: 16.2077, 16.1813, 16.1752 mm (errata, 4).
  const Subject s(low_backlash());
  const std::array<double, 3> off_mm{0.0177, 0.0087, 0.0148};
  for (int mesh = 0; mesh < 3; ++mesh) {
    EXPECT_NEAR(s.value(CheckId::kCoaxiality, {.member = mesh}) * 1e3,
                off_mm[static_cast<std::size_t>(mesh)], 0.5e-4 + 1e-9);
  }
}

TEST(ListChecks, OfBodiesApartAlongTheAxisHasNoBodyGap) {
  TrainLayout layout = full_layout();
  layout.axial.extent[train::kP2] = train::AxialInterval{.from_m = 0.01, .to_m = 0.02};  // touching
  layout.axial.extent[train::kCarrier] = std::nullopt;
  std::set<int> pairs;
  for (const CheckInstance& c : list_checks(all_on(), train_layout(layout))) {
    if (c.record->id == CheckId::kBodyGap) pairs.insert(c.subject.member);
  }
  EXPECT_EQ(pairs, std::set<int>{2});  // P1, R2
}

TEST(CheckValue, RingRootDiameterIsTwiceTheRootRadius) {
  const Subject s(low_backlash());
  EXPECT_NEAR(s.value(CheckId::kRingRootDiameter, {.member = train::kR1}),
              0.59e-3 * (94.0 + 2.0 * (1.25 + 0.45)), 8.0 * kEps * 0.06);
  EXPECT_NEAR(s.value(CheckId::kRingRootDiameter, {.member = train::kR2}),
              0.58e-3 * (92.0 + 2.0 * (1.25 + 0.29)), 8.0 * kEps * 0.06);
}

TEST(CheckValue, OutputBacklashFollowsTheModelAndThePapersIsItsLargerBranch) {
  using backlash::LostMotionModel;
  const Subject s(low_backlash());
  for (const CheckId id : {CheckId::kOutputBacklashMin, CheckId::kOutputBacklashMax}) {
    const double kinematic = s.value(id, {}, LostMotionModel::kKinematic);
    const double paper = s.value(id, {}, LostMotionModel::kPaper);
    EXPECT_EQ(kinematic, backlash::output_lost_motion(s.train, s.j, LostMotionModel::kKinematic));
    const double branch1 = s.value(id, {.member = 0, .which = 1}, LostMotionModel::kPaper);
    const double branch2 = s.value(id, {.member = 0, .which = 2}, LostMotionModel::kPaper);
    EXPECT_EQ(paper, std::max(branch1, branch2));
    EXPECT_NE(branch1, branch2);
    EXPECT_NE(paper, kinematic);
  }
}

TEST(CheckValue, EqualSpacingIsTheAngleToTheNearestPositionThatFits) {
  for (int planets = 2; planets <= 8; ++planets) {
    auto p = low_backlash();
    p.planets = planets;
    const int positions = p.teeth.S + p.teeth.R1;  // of the planet carrier, one every 2 pi/108
    double nearest = 2.0 * kPi;
    for (int k = 0; k <= positions; ++k) {
      nearest = std::min(nearest, std::abs(2.0 * kPi / planets - 2.0 * kPi * k / positions));
    }
    EXPECT_NEAR(Subject(p).value(CheckId::kEqualSpacing), -nearest, 16.0 * kEps) << planets;
  }
}

TEST(CheckValue, IdenticalPlanetsIsTheLargestPhaseThatAPlanetNeeds) {
  // Phases 0, 1/3, 2/3 degree in a symmetry of 1 degree: a third of a degree either way.
  EXPECT_NEAR(Subject(low_backlash()).value(CheckId::kIdenticalPlanets), -kPi / 540.0, 4.0 * kEps);
  EXPECT_EQ(Subject(bilateral()).value(CheckId::kIdenticalPlanets), 0.0);
  auto p = low_backlash();
  p.planets = 5;  // does not divide 108: no planet phase helps, the spacing itself misses
  EXPECT_EQ(Subject(p).value(CheckId::kIdenticalPlanets), Subject(p).value(CheckId::kEqualSpacing));
  EXPECT_LT(Subject(p).value(CheckId::kIdenticalPlanets), 0.0);
}

TEST(SubjectNames, AreThoseOfTheGearMeshOrTrainThatACheckIsAbout) {
  std::map<std::string, std::set<std::string>> seen;
  for (const CheckInstance& c : list_checks(all_on(), train_layout(full_layout()))) {
    const auto names = subject_names(c, train::kGearNames, train::kMeshNames, train::kMeshGears);
    seen[std::string(c.record->name)].insert(names.mesh + "/" + names.gear);
  }
  using Names = std::set<std::string>;
  EXPECT_EQ(seen["undercut"], (Names{"/S", "/P1", "/P2"}));
  EXPECT_EQ(seen["ring_tip_thickness"], (Names{"/R1", "/R2"}));
  EXPECT_EQ(seen["contact_ratio_min"], (Names{"S-P1/", "P1-R1/", "P2-R2/"}));
  EXPECT_EQ(seen["involute_interference"], (Names{"S-P1/S", "S-P1/P1", "P1-R1/R1", "P2-R2/R2"}));
  EXPECT_EQ(seen["planet_gap"], (Names{"/P1", "/P2"}));
  EXPECT_EQ(seen["form_circle"],
            (Names{"S-P1/S", "S-P1/P1", "P1-R1/P1", "P1-R1/R1", "P2-R2/P2", "P2-R2/R2"}));
  EXPECT_EQ(seen["trochoid_interference"], (Names{"P1-R1/", "P2-R2/"}));
  EXPECT_EQ(seen["ring_cutter"], (Names{"/R1", "/R2"}));
  EXPECT_EQ(seen["body_gap"],
            (Names{"/P2, S", "/P2, R1", "/P1, R2", "/carrier, R1", "/carrier, R2"}));
  EXPECT_EQ(seen["output_backlash_max"], (Names{"/"}));
}

}  // namespace
}  // namespace gear3k::design::checks_test
