#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "app/analyze.hpp"
#include "app/diagnose.hpp"
#include "io/files/design_file.hpp"
#include "report/analysis_report.hpp"
#include "report/torque_angle_report.hpp"
#include "strength/mesh_stiffness.hpp"
#include "tests/strength/spring_network.hpp"

namespace gear3k::app::torque_angle_test {
namespace {

constexpr double kArcmin = std::numbers::pi / 10800.0;

/// examples/designs/loaded.toml with planets on bearings of 50 N/um.
design::Design loaded_design() {
  design::Design design = io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/loaded.toml");
  design.rating->supports->stiffness_N_m = 50e6;
  return design;
}

/// Compliance of the output by a network of springs and the tooth pairs' stiffness, summed over the
/// path by a trapezoidal rule.  Forces of the meshes from radii and the balance of torques.
double network_compliance(const design::Design& design, double torque_Nm,
                          std::optional<double> ring2_Nm_rad = {}) {
  const auto g = *train::make_train_geometry(design::resolved_parameters(design));
  const strength::RatingTask& task = *design.rating;
  const train::ToothSet& z = g.teeth;
  // R2 takes T, the sun T/i, the fixed ring the rest.
  const double ratio = (1.0 + static_cast<double>(z.R1) / z.S) /
                       (1.0 - static_cast<double>(z.R1) * z.P2 / (z.P1 * z.R2));
  const std::array<double, 3> share{1.0 / ratio, 1.0 - 1.0 / ratio, 1.0};
  const std::array<int, 3> central{train::kS, train::kR1, train::kR2};
  strength::TrainSprings<double> springs;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    const auto one = static_cast<std::size_t>(first);
    const auto two = static_cast<std::size_t>(second);
    const double force = torque_Nm * std::abs(share[k]) /
                         (g.planets * g.gears[static_cast<std::size_t>(central[k])].base_radius_m);
    const double width = task.face_width_m[static_cast<std::size_t>(train::stage_of(first))];
    const auto mesh =
        strength::make_elastic_mesh(g.gears[one], geometry::make_tooth_form(g.gears[one]),
                                    g.gears[two], geometry::make_tooth_form(g.gears[two]),
                                    g.meshes[k], strength::elasticity_of(*task.material[one]),
                                    strength::elasticity_of(*task.material[two]), force / width);
    constexpr int kSteps = 4000;
    const double step = (mesh.path_end_m - mesh.path_begin_m) / kSteps;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      sum += step * strength::pair_stiffness(mesh, mesh.path_begin_m + (i + 0.5) * step);
    }
    springs.mesh_N_m[k] = sum / mesh.base_pitch_m * width;
  }
  springs.bearings = strength::PlanetBearings<double>{
      .axis = strength::planet_axis<double>(*task.supports),
      .stiffness_N_m = {*task.supports->stiffness_N_m, *task.supports->stiffness_N_m}};
  springs.ring2_Nm_rad = ring2_Nm_rad;
  const strength::SpringNetwork network(g, springs);
  return 1.0 / network.stiffness(strength::SpringNetwork::kOutput, strength::SpringNetwork::kInput);
}

double rigid_lost_motion(const design::Design& design) {
  return std::get<design::Evaluation>(design::evaluate(design)).lost_motion.kinematic_rad;
}

/// Lost motion of the network at ten torques, four times each.
io::Measurements lost_motion_data(const design::Design& design,
                                  std::optional<double> ring2_Nm_rad = {}) {
  constexpr double kSigma_arcmin = 0.03;
  std::mt19937_64 generator(7);
  std::normal_distribution<double> noise(0.0, kSigma_arcmin);
  std::string text =
      "# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin,sigma_arcmin\n";
  const double rigid = rigid_lost_motion(design);
  for (int repeat = 0; repeat < 4; ++repeat) {
    for (int k = 1; k <= 10; ++k) {
      const double torque_Nm = 2.0 * k;
      const double angle =
          rigid + 2.0 * torque_Nm * network_compliance(design, torque_Nm, ring2_Nm_rad);
      text += fmt::format("{},{},{},{}\n", 36 * k, torque_Nm, angle / kArcmin + noise(generator),
                          kSigma_arcmin);
    }
  }
  return io::parse_measurements({{.path = "lost.csv", .text = text}});
}

/// A record of the network's torque and angle, to and fro, behind dry friction.
io::Measurements loop_data(const design::Design& design) {
  std::mt19937_64 generator(6);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::string text = "# kind: torque_angle\n# locked: sun\ntime_s,angle_deg,torque_nm\n";
  const double half = 0.5 * rigid_lost_motion(design) / kArcmin;
  // The compliance at some torques, by which the loop goes on the logarithm between them.
  std::array<double, 6> at{};
  for (std::size_t k = 0; k < at.size(); ++k) {
    at[k] = network_compliance(design, std::ldexp(20.0, -static_cast<int>(k))) / kArcmin;
  }
  const auto windup = [&](double torque_Nm) {
    if (torque_Nm == 0.0) return 0.0;
    const double place = std::clamp(std::log2(20.0 / std::abs(torque_Nm)), 0.0, 4.999);
    const auto k = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(k);
    return torque_Nm * ((1.0 - share) * at[k] + share * at[k + 1]);
  };
  constexpr int kSamples = 1600;
  constexpr double kFriction_Nm = 1.0;
  double inside_Nm = 0.0;
  for (int k = 0; k <= 6 * kSamples; ++k) {
    const double phase = static_cast<double>(k % kSamples) / kSamples;
    const double triangle = phase < 0.25   ? 4.0 * phase
                            : phase < 0.75 ? 2.0 - 4.0 * phase
                                           : 4.0 * phase - 4.0;
    const double torque_Nm = 20.0 * triangle;
    inside_Nm = std::clamp(inside_Nm, torque_Nm - kFriction_Nm, torque_Nm + kFriction_Nm);
    const double side = inside_Nm > 0.0 ? half : inside_Nm < 0.0 ? -half : 0.0;
    text += fmt::format("{},{},{}\n", 0.05 * k,
                        (side + windup(inside_Nm) + noise(generator)) / 60.0, torque_Nm);
  }
  return io::parse_measurements({{.path = "loop.csv", .text = text}});
}

calibrate::Diagnosis diagnosed(const design::Design& design, const io::Measurements& data) {
  const DiagnosisTask task =
      diagnosis_task({.subject = design, .source = "design.toml", .data = data});
  const auto results = diagnose(task, {});
  EXPECT_TRUE(results && results->size() == 1);
  return results->front();
}

const calibrate::Effect* compliance_of(const calibrate::Diagnosis& d) {
  const auto found = std::ranges::find(d.effects, "compliance", &calibrate::Effect::id);
  return found == d.effects.end() ? nullptr : &*found;
}

/// That the cause is found, and its interval meets a range of compliances [rad/(N m)].
void expect_compliance(const calibrate::Diagnosis& d, double least, double greatest) {
  const calibrate::Effect* effect = compliance_of(d);
  ASSERT_NE(effect, nullptr);
  const calibrate::ParameterResult& p = effect->parameters.front();
  EXPECT_EQ(p.name, "compliance");
  EXPECT_LE(p.low, greatest / kArcmin);
  EXPECT_GE(p.high, least / kArcmin);
}

bool says_springs(const calibrate::Diagnosis& d) {
  return std::ranges::any_of(d.notes, [](const std::string& note) {
    return note.find("springs of [strength]") != std::string::npos;
  });
}

TEST(DiagnoseWindUp, WithStrengthTheNetworksWindUpIsNoFinding) {
  const design::Design design = loaded_design();
  const calibrate::Diagnosis d = diagnosed(design, lost_motion_data(design));
  EXPECT_EQ(d.verdict, calibrate::Verdict::kNoDiscrepancy);
  EXPECT_TRUE(d.effects.empty());
  EXPECT_TRUE(says_springs(d));
  EXPECT_TRUE(d.model.beyond_springs);
  ASSERT_TRUE(d.springs_Nm_rad);
  EXPECT_NEAR(*d.springs_Nm_rad * network_compliance(design, 20.0), 1.0, 1e-3);
}

TEST(DiagnoseWindUp, WithoutStrengthItIsAComplianceOfItsSize) {
  design::Design design = loaded_design();
  const io::Measurements data = lost_motion_data(design);
  const double expected = network_compliance(design, 15.0);
  design.rating.reset();
  const calibrate::Diagnosis d = diagnosed(design, data);
  expect_compliance(d, expected, expected);
  EXPECT_FALSE(says_springs(d));
  EXPECT_FALSE(d.model.beyond_springs);
  EXPECT_FALSE(d.springs_Nm_rad);
}

TEST(DiagnoseWindUp, ASoftOutputShaftIsTheComplianceBeyondTheSprings) {
  constexpr double kShaft_Nm_rad = 1e5;
  const design::Design design = loaded_design();
  const calibrate::Diagnosis d = diagnosed(design, lost_motion_data(design, kShaft_Nm_rad));
  expect_compliance(d, 1.0 / kShaft_Nm_rad, 1.0 / kShaft_Nm_rad);
  EXPECT_TRUE(says_springs(d));
}

TEST(DiagnoseWindUp, LoopsOfTheNetworkAreExplainedByItsSprings) {
  design::Design design = loaded_design();
  const io::Measurements data = loop_data(design);
  const calibrate::Diagnosis with = diagnosed(design, data);
  EXPECT_EQ(compliance_of(with), nullptr);
  EXPECT_TRUE(says_springs(with));
  // Read at 0.3 to 0.8 of 20 N m, the springs harder as the torque grows.
  const double least = network_compliance(design, 16.0);
  const double greatest = network_compliance(design, 6.0);
  design.rating.reset();
  expect_compliance(diagnosed(design, data), least, greatest);
}

TEST(TorqueAngleOfADesign, WithoutFrictionItsSlopeIsTheRatedStiffness) {
  design::Design design = loaded_design();
  design.friction.coefficient = 0.0;
  const Analysis analysis = analyze({.design = design});
  ASSERT_TRUE(analysis.torque_angle);
  const design::TorqueAngleCurve& curve = *analysis.torque_angle;
  const double stiffness = analysis.evaluation.strength->forward.stiffness->output_Nm_rad;
  EXPECT_NEAR(curve.peak_torque_Nm / curve.windup_rad / stiffness, 1.0, 1e-9);
  EXPECT_NEAR(curve.stiffness.back().output_Nm_rad / stiffness, 1.0, 1e-9);
  EXPECT_NEAR(curve.loop_J, 0.0, 1e-9 * curve.peak_torque_Nm * curve.windup_rad);
  // By the load: softer under less.
  EXPECT_LT(curve.stiffness.front().output_Nm_rad, stiffness);
}

TEST(TorqueAngleOfADesign, LostMotionIsThatOfTheEvaluationAndTheLoopCloses) {
  const Analysis analysis = analyze({.design = loaded_design()});
  ASSERT_TRUE(analysis.torque_angle);
  const design::TorqueAngleCurve& curve = *analysis.torque_angle;
  const auto& [loading, unloading, reverse_loading, reverse_unloading] = curve.branch;
  const double lost = analysis.evaluation.lost_motion.kinematic_rad;
  EXPECT_NEAR(loading.front().angle_rad - reverse_loading.front().angle_rad, lost, 1e-12 * lost);
  EXPECT_EQ(loading.back().angle_rad, unloading.front().angle_rad);
  EXPECT_EQ(reverse_loading.back().angle_rad, reverse_unloading.front().angle_rad);
  EXPECT_NEAR(unloading.back().angle_rad, loading.front().angle_rad, 1e-9 * curve.windup_rad);
  EXPECT_NEAR(reverse_unloading.back().angle_rad, reverse_loading.front().angle_rad,
              1e-9 * curve.windup_rad);
  EXPECT_GT(curve.loop_J, 0.0);
  // Springs that depend on their load, and steps of a hundredth.
  EXPECT_NEAR(curve.loop_J / curve.friction_J, 1.0, 1e-3);
}

TEST(TorqueAngleOfADesign, AModelsComplianceIsInSeriesWithTheSpringsThatItCountsBeyond) {
  const design::Design design = loaded_design();
  const double springs = analyze({.design = design}).torque_angle->elastic_rad;
  design::Design beyond = design;
  beyond.lost_motion.compliance_rad_Nm = 1e-5;
  beyond.lost_motion.beyond_springs = true;
  EXPECT_NEAR(analyze({.design = beyond}).torque_angle->elastic_rad, springs + 20.0 * 1e-5, 1e-12);
  design::Design whole = design;
  whole.lost_motion.compliance_rad_Nm = 1e-5;
  EXPECT_NEAR(analyze({.design = whole}).torque_angle->elastic_rad, 20.0 * 1e-5, 1e-12);
}

TEST(TorqueAngleOfADesign, AModelInTwoStagesIsSoftAtFirst) {
  design::Design design = loaded_design();
  design.lost_motion.soft[0] = {.windup_rad = 1.6e-3, .torque_Nm = 10.0};
  design.operating_point = {.output_torque_Nm = 5.0};
  const Analysis analysis = analyze({.design = design});
  const auto& lost = analysis.evaluation.lost_motion;
  ASSERT_TRUE(lost.measured_rad);
  EXPECT_NEAR(*lost.measured_rad, lost.kinematic_rad + 0.8e-3, 1e-12);
  // Half of it on each side, and that is all of the wind-up: 0.2 mrad of 2.5 N m, 0.8 of 10 and 20.
  ASSERT_TRUE(analysis.torque_angle);
  const auto& stiffness = analysis.torque_angle->stiffness;
  ASSERT_EQ(stiffness.size(), 4U);
  EXPECT_NEAR(stiffness[0].output_Nm_rad, 2.5 / 0.2e-3, 1e-6);
  EXPECT_NEAR(stiffness[2].output_Nm_rad, 10.0 / 0.8e-3, 1e-6);
  EXPECT_NEAR(stiffness[3].output_Nm_rad, 20.0 / 0.8e-3, 1e-6);
}

TEST(TorqueAngleOfADesign, IsThereWithStrengthOnly) {
  design::Design design = loaded_design();
  EXPECT_NE(report::torque_angle_csv(*analyze({.design = design}).torque_angle)
                .find("branch,torque_nm,angle_arcmin\nloading,0,"),
            std::string::npos);
  design.rating.reset();
  EXPECT_FALSE(analyze({.design = design}).torque_angle);
}

}  // namespace
}  // namespace gear3k::app::torque_angle_test
