#include "app/optimize.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "app/search.hpp"
#include "design/checks.hpp"
#include "io/files/design_file.hpp"
#include "io/files/model_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"
#include "report/limit_price_report.hpp"
#include "report/relaxed_limits_report.hpp"
#include "report/result_tally.hpp"
#include "units/units.hpp"

namespace gear3k::app::optimize_test {
namespace {

/// rp96 with suns of 12 teeth only.
optimize::Specification small_spec() {
  optimize::Specification spec = io::read_specification(GEAR3K_SOURCE_DIR "/examples/rp96.toml");
  spec.teeth.S = {12, 12};
  return spec;
}

TEST(Search, RanksAllSetsThatFit) {
  optimize::Progress progress;
  const ToothSets sets = search({.spec = small_spec()}, progress);
  EXPECT_FALSE(sets.search.interrupted);
  EXPECT_GT(sets.ranking.added(), 0U);
  EXPECT_EQ(sets.ranking.held(), sets.search.candidate_count());
}

TEST(Search, HasNoRankingWhenItWasEnded) {
  optimize::Progress progress;
  progress.stop = true;
  const ToothSets sets = search({.spec = small_spec()}, progress);
  EXPECT_TRUE(sets.search.interrupted);
  EXPECT_EQ(sets.ranking.added(), 0U);
}

TEST(Optimize, BestDesignIsThatOfItsFile) {
  OptimizeTask task = optimize_task({.spec = small_spec()});
  optimize::Progress progress;
  std::vector<optimize::RefinedSet> kept;
  const Optimization run = optimize(
      task, {.on_wave = [&](auto sets) { kept.insert(kept.end(), sets.begin(), sets.end()); }},
      progress);
  ASSERT_TRUE(run.best);
  EXPECT_FALSE(run.interrupted);
  EXPECT_FALSE(run.robust);
  EXPECT_EQ(kept.size(), run.result.refined.size());
  EXPECT_TRUE(design::all_ok(run.best->evaluation.checks));
  const design::Design read = io::parse_design(io::design_text(run.best->stated), "best.toml");
  const auto again = std::get<design::Evaluation>(design::evaluate(read));
  EXPECT_EQ(again.efficiency.backward, run.best->evaluation.efficiency.backward);
  EXPECT_EQ(again.lost_motion.kinematic_rad, run.best->evaluation.lost_motion.kinematic_rad);
}

TEST(Optimize, RoundedDesignIsThatOfItsFileToTheLastBit) {
  optimize::Specification spec = small_spec();
  spec.teeth.P1 = {.min = 52, .max = 54};
  OptimizeTask task = optimize_task({.spec = spec, .round = true});
  optimize::Progress progress;
  const Optimization run = optimize(task, {}, progress);
  ASSERT_TRUE(run.rounding && run.rounding->best && run.rounded);
  EXPECT_TRUE(design::all_ok(run.rounded->evaluation.checks));
  const design::Design read = io::parse_design(io::design_text(run.rounded->stated), "rounded");
  const auto again = std::get<design::Evaluation>(design::evaluate(read));
  EXPECT_EQ(again.efficiency.backward, run.rounded->evaluation.efficiency.backward);
  EXPECT_EQ(again.lost_motion.kinematic_rad, run.rounded->evaluation.lost_motion.kinematic_rad);
  EXPECT_EQ(read.train.profile_shift, run.rounding->best->set.train.profile_shift);
  EXPECT_EQ(read.train.center_distance_m, run.rounding->best->set.train.center_distance_m);
  EXPECT_NEAR(again.efficiency.backward.value(), run.rounding->best->objective, 1e-12);
}

TEST(Optimize, SaysWhatCanBeCarriedOfATorqueThatIsTooMuch) {
  optimize::Specification spec = small_spec();
  spec.planets = {3};
  optimize::Progress progress;
  EXPECT_FALSE(carried_torque(spec, progress));  // it carries what is asked for, or asks for none
  spec = io::read_specification(GEAR3K_SOURCE_DIR "/examples/ratio-96.toml");
  spec.teeth.S = {.min = 12, .max = 12};
  spec.teeth.P1 = {.min = 62, .max = 64};
  EXPECT_FALSE(carried_torque(spec, progress));
  // The same whatever is asked for, and the edge of what can be designed.
  double before_Nm = 0.0;
  for (const double asked_Nm : {100.0, 1000.0}) {
    spec.rating->torque_Nm = asked_Nm;
    const auto carried = carried_torque(spec, progress);
    ASSERT_TRUE(carried);
    EXPECT_GT(carried->torque_Nm, 20.0);
    if (before_Nm > 0.0) {
      EXPECT_NEAR(carried->torque_Nm, before_Nm, 1e-4 * before_Nm);
    }
    before_Nm = carried->torque_Nm;
  }
  const auto feasible = [&](double torque_Nm) {
    spec.rating->torque_Nm = torque_Nm;
    return optimize::optimize(spec, progress).best.has_value();
  };
  EXPECT_TRUE(feasible(0.999 * before_Nm));
  EXPECT_FALSE(feasible(1.01 * before_Nm));
}

TEST(Optimize, GoesOnWithWhatIsKnown) {
  OptimizeTask task = optimize_task({.spec = small_spec()});
  optimize::Progress progress;
  const Optimization whole = optimize(task, {}, progress);
  std::size_t refined_again = 0;
  optimize::Progress second;
  const Optimization run = optimize(task,
                                    {.known = [&] { return whole.result.refined; },
                                     .on_wave = [&](auto sets) { refined_again += sets.size(); }},
                                    second);
  EXPECT_EQ(refined_again, 0U);
  ASSERT_TRUE(run.best && whole.best);
  EXPECT_EQ(run.best->evaluation.efficiency.backward, whole.best->evaluation.efficiency.backward);
}

TEST(Optimize, ADesignThatIsNoOptimumIsADesignAndToldAsWhatItIs) {
  OptimizeTask task = optimize_task({.spec = small_spec()});
  optimize::Progress progress;
  const Optimization whole = optimize(task, {}, progress);
  ASSERT_TRUE(whole.best);
  std::vector<optimize::RefinedSet> known = whole.result.refined;
  for (optimize::RefinedSet& set : known) {
    if (set.status != optimize::Status::kOptimal) continue;
    set.status = optimize::Status::kNotStationary;
    set.kkt_residual = 2e-3;
  }
  optimize::Progress second;
  const Optimization run = optimize(task, {.known = [&] { return known; }}, second);
  ASSERT_TRUE(run.best);
  EXPECT_EQ(run.best->evaluation.efficiency.backward, whole.best->evaluation.efficiency.backward);
  const auto told = [](const Optimization& of) {
    return std::ranges::count_if(of.best->evaluation.notes, [](const std::string& note) {
      return note.find("no optimum (KKT residual 0.002") != std::string::npos;
    });
  };
  EXPECT_EQ(told(run), 1);
  EXPECT_EQ(told(whole), 0);
  ASSERT_TRUE(run.held);
  EXPECT_TRUE(run.held->best.held.prices.empty());
  EXPECT_FALSE(run.held->best.held.missing.empty());
  EXPECT_FALSE(run.relaxed);
}

TEST(Optimize, WhereTheSolverFailedOnEverySetNoLimitHasToGiveWay) {
  OptimizeTask task = optimize_task({.spec = small_spec()});
  optimize::Progress progress;
  std::vector<optimize::RefinedSet> known = optimize(task, {}, progress).result.refined;
  ASSERT_FALSE(known.empty());
  for (optimize::RefinedSet& set : known) set.status = optimize::Status::kFailed;
  optimize::Progress second;
  const Optimization run = optimize(task, {.known = [&] { return known; }}, second);
  EXPECT_FALSE(run.best);
  EXPECT_TRUE(report::only_failed(report::tally_of(run.result)));
  EXPECT_FALSE(run.relaxed);
  EXPECT_EQ(run.not_relaxed.find("the solver failed on "), 0U) << run.not_relaxed;
}

TEST(Optimize, HasWhatCanBeCarriedWhereTheLoadLeavesNoDesign) {
  optimize::Specification spec =
      io::read_specification(GEAR3K_SOURCE_DIR "/examples/ratio-96.toml");
  spec.teeth.S = {.min = 12, .max = 12};
  spec.teeth.P1 = {.min = 64, .max = 64};
  spec.rating->torque_Nm = 100.0;
  OptimizeTask task = optimize_task({.spec = spec});
  optimize::Progress progress;
  const Optimization run = optimize(task, {}, progress);
  EXPECT_FALSE(run.best);
  EXPECT_FALSE(run.interrupted);
  ASSERT_TRUE(run.carried);
  EXPECT_GT(run.carried->torque_Nm, 20.0);
  EXPECT_LT(run.carried->torque_Nm, 100.0);
}

TEST(Optimize, SaysThatNotAllSetsAreRefinedWhereItWasEnded) {
  optimize::Specification spec = io::read_specification(GEAR3K_SOURCE_DIR "/examples/rp96.toml");
  spec.planets = {3, 4};
  OptimizeTask task = optimize_task({.spec = spec});
  optimize::Progress progress;
  const Optimization run =
      optimize(task, {.on_wave = [&](auto) { progress.stop = true; }}, progress);
  EXPECT_TRUE(run.interrupted);
  ASSERT_TRUE(run.held);
  EXPECT_LT(run.result.refined.size(), run.result.search.candidates.size());
  EXPECT_FALSE(run.held->all_refined);
  EXPECT_TRUE(run.held->best.held.interrupted);  // nothing beyond bounds and limits was tried
}

TEST(Optimize, KeepsNothingWhenItWasEndedAtOnce) {
  OptimizeTask task = optimize_task({.spec = small_spec()});
  optimize::Progress progress;
  progress.stop = true;
  const Optimization run = optimize(task, {}, progress);
  EXPECT_TRUE(run.interrupted);
  EXPECT_FALSE(run.best);
}

/// rp96 with few sets under a load that its planets share as their tolerances let them.
optimize::Specification shared_load_spec() {
  return io::parse_specification(R"(
planets = 3
objective = "backward_efficiency"
[ratio]
target = 96.2
tolerance = 0.005
[teeth]
S = [12, 12]
P1 = [52, 54]
R1_max = 120
P2 = [20, 60]
R2_max = 120
max_coaxial_offset = 4
min_internal_difference = 8
[module]
stage1_mm = 1.0
stage2_mm = { min = 0.5, max = 2.0 }
[profile_shift]
range = [0.0, 1.0]
[backlash]
max_output_arcmin = 12.0
min_normal_um = 20.0
[contact_ratio]
range = [1.2, 2.5]
[friction]
coefficient = 0.1
[stage1]
face_width_mm = 8.0
[stage2]
face_width_mm = 8.0
[material]
name = "34CrNiMo6 through hardened"
[tolerances]
samples = 1000
pin_position_um = 5
[tolerances.P1]
tooth_thickness_um = [-3, 0]
[strength]
output_torque_nm = 100.0
s_f_min = 1.5
k_gamma = "tolerances"
)",
                                 "spec.toml");
}

TEST(Optimize, HoldsKGammaUntilTheBestDesignHasNoMore) {
  OptimizeTask task = optimize_task({.spec = shared_load_spec()});
  optimize::Progress progress;
  const Optimization shared = optimize(task, {}, progress);
  ASSERT_TRUE(shared.best);
  const auto& held = task.spec.rating->factors.held_mesh_load;
  ASSERT_TRUE(held);
  const auto& strength = shared.best->evaluation.strength;
  ASSERT_TRUE(strength && strength->planet_sharing && strength->planet_sharing->series);
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const double own = std::max(1.0, strength->planet_sharing->series->quantile[k]);
    EXPECT_LE(own, (*held)[k]) << k;
    EXPECT_LE((*held)[k], 1.02 * own) << k;
    EXPECT_GT(own, 1.2) << k;
  }
  EXPECT_FALSE(shared.best->design.rating->factors.held_mesh_load);
  // What it carries is one number, in every result.
  const double carried_Nm = strength->least_capacity().value().capacity.torque_Nm;
  EXPECT_EQ(shared.result.best->torque_capacity_Nm, carried_Nm);
  const auto row = std::ranges::find(shared.result.refined, shared.result.best->index,
                                     &optimize::RefinedSet::index);
  ASSERT_NE(row, shared.result.refined.end());
  EXPECT_EQ(row->torque_capacity_Nm, carried_Nm);
  for (const design::CheckResult& check : shared.best->evaluation.checks) {
    EXPECT_TRUE(check.ok);
  }
  EXPECT_TRUE(std::ranges::any_of(shared.best->evaluation.notes, [](const std::string& note) {
    return note.starts_with("K_gamma of the tolerances: held at");
  }));
}

TEST(OptimizeTask, RefusesKGammaOfTolerancesWhereNoDesignHasOne) {
  const auto error_of = [](const OptimizeRequest& request) -> std::string {
    try {
      optimize_task(request);
    } catch (const io::InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  OptimizeRequest request{.spec = shared_load_spec(), .source = "spec.toml"};
  EXPECT_EQ(error_of(request), "");
  request.spec.objectives = {optimize::Objective::kTorqueCapacity};
  EXPECT_NE(error_of(request).find("with an objective of the torque"), std::string::npos);
  request.spec.objectives = {optimize::Objective::kBackwardEfficiency,
                             optimize::Objective::kOuterDiameter};
  EXPECT_NE(error_of(request).find("with a list of objectives"), std::string::npos);
  request.spec.objectives.pop_back();
  request.round = true;
  EXPECT_NE(error_of(request).find("with --round"), std::string::npos);
}

TEST(OptimizeTask, RefusesACertificateWithoutBounds) {
  optimize::Specification spec = small_spec();
  spec.free.pressure_angle_rad = {0.3, 0.4};
  try {
    optimize_task({.spec = spec, .source = "spec.toml", .certify = true});
    FAIL() << "no exception";
  } catch (const io::InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()).find("spec.toml: --certify needs bounds"), 0U);
  }
}

TEST(OptimizeTask, SaysWhyNoTeethCanKeepALimitWithTheModel) {
  const std::string text =
      "[lost_motion.causes.clearance]\nform = \"constant\"\nextra_lost_motion_arcmin = 60.0\n";
  const Model model = model_of(io::parse_model(text, "model.toml"), "model.toml");
  OptimizeTask task = optimize_task({.spec = small_spec(), .model = model});
  EXPECT_NE(task.unreachable.find("backlash.max_output_arcmin = 8: the model adds 60 arcmin"),
            std::string::npos)
      << task.unreachable;
  optimize::Progress progress;
  EXPECT_THROW(optimize(task, {}, progress), std::invalid_argument);
}

TEST(OptimizeTask, AWindUpThatIsSoftOnlyLowersTheLimitOfLostMotion) {
  const std::string text =
      "[lost_motion.causes.compliance]\nform = \"two_stage\"\ncompliance_arcmin_per_nm = 0.0\n"
      "soft_windup_arcmin = 1.5\nlog_soft_torque_change = 0.0\nsoft_torque_nm = 4.0\n"
      "torque_half_range = 1.0\n";
  const Model model = model_of(io::parse_model(text, "model.toml"), "model.toml");
  for (const auto& [torque_Nm, limit_arcmin] : {std::pair{2.0, 7.25}, {4.0, 6.5}, {9.0, 6.5}}) {
    optimize::Specification spec = small_spec();
    spec.operating_point = {.output_torque_Nm = torque_Nm};
    const OptimizeTask task = optimize_task({.spec = spec, .model = model});
    EXPECT_NEAR(*task.spec.limits[design::CheckId::kOutputBacklashMax],
                limit_arcmin * units::kArcmin, 1e-12);
  }
}

/// Which limits would have to give way, with a model that takes most of one of them.
TEST(Optimize, LimitsThatGiveWayAreThoseOfTheSpecificationWithAModel) {
  constexpr auto kMost = design::CheckId::kOutputBacklashMax;
  const std::string text =
      "[lost_motion.causes.clearance]\nform = \"constant\"\nextra_lost_motion_arcmin = 1.5\n"
      "[transmission.causes.bearing_load]\nform = \"planet_bearings\"\nfriction_radius_mm = 1.0\n";
  const Model model = model_of(io::parse_model(text, "model.toml"), "model.toml");
  optimize::Specification spec = small_spec();
  spec.planets = {3};
  spec.teeth.P1 = {.min = 52, .max = 54};
  spec.limits[design::CheckId::kNormalBacklash] = 40e-6;
  spec.limits[kMost] = 3.0 * units::kArcmin;
  spec.operating_point = {.sun_speed_rad_s = 100.0, .output_torque_Nm = 10.0};
  OptimizeTask task = optimize_task({.spec = spec, .model = model});
  optimize::Progress progress;
  const Optimization run = optimize(task, {}, progress);
  ASSERT_FALSE(run.best);
  ASSERT_TRUE(run.relaxed);
  const auto freed = std::ranges::find_if(run.relaxed->freed, [](const optimize::Freed& one) {
    return one.limits.size() == 1 && *one.limits.front().of.check == kMost;
  });
  ASSERT_NE(freed, run.relaxed->freed.end());
  const optimize::RelaxedLimit& told = freed->limits.front();
  EXPECT_EQ(told.stated_si, 3.0 * units::kArcmin);
  ASSERT_TRUE(told.relaxed_si);
  EXPECT_GT(*told.relaxed_si, told.stated_si);
  const std::string screen = report::relaxed_limits_text(task.spec, *run.relaxed);
  EXPECT_NE(screen.find(fmt::format("backlash.max_output_arcmin = {:g} arcmin instead of 3: ",
                                    *told.relaxed_si / units::kArcmin)),
            std::string::npos)
      << screen;
  EXPECT_NE(screen.find(" % without the model's losses at the operating point\n"),
            std::string::npos)
      << screen;
  const std::string json = report::relaxed_limits_json(task.spec, *run.relaxed).text();
  EXPECT_NE(json.find("\"objective_without_model\": true"), std::string::npos) << json;
  EXPECT_NE(json.find("\"stated\": 3.0"), std::string::npos) << json;
  // With the value told there is a design, and with what the model leaves of it there is none.
  for (const double share_rad : {0.0, 1.5 * units::kArcmin}) {
    optimize::Specification again = spec;
    again.limits[kMost] = *told.relaxed_si - share_rad;
    OptimizeTask second = optimize_task({.spec = again, .model = model, .explain = false});
    EXPECT_EQ(optimize(second, {}, progress).best.has_value(), share_rad == 0.0);
  }
}

TEST(Optimize, EndedBeyondItsBoundsIsInterrupted) {
  optimize::Specification spec = small_spec();
  spec.teeth.P1 = {.min = 52, .max = 54};
  int interrupted = 0;
  // Another thread may come too late.
  for (int trial = 0; trial < 20 && interrupted == 0; ++trial) {
    OptimizeTask task = optimize_task({.spec = spec});
    optimize::Progress progress;
    std::atomic<bool> ended = false;
    std::thread other([&] {
      while (progress.stage != optimize::Progress::Stage::kBeyond && !ended) {
      }
      progress.stop = true;
    });
    const Optimization run = optimize(task, {}, progress);
    ended = true;
    other.join();
    ASSERT_TRUE(run.held);
    EXPECT_FALSE(run.result.interrupted);
    EXPECT_EQ(run.interrupted, run.held->best.held.interrupted);
    const std::string table = report::held_back_table(task.spec, run.held->best);
    EXPECT_EQ(table.find("interrupted") != std::string::npos, run.interrupted) << table;
    interrupted += run.interrupted ? 1 : 0;
  }
  EXPECT_EQ(interrupted, 1);
}

}  // namespace
}  // namespace gear3k::app::optimize_test
