// K_γ of a design from its tolerances: against the series of the plays, and fixed points.

#include "design/planet_sharing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "report/strength_report.hpp"

namespace gear3k::design::planet_sharing_test {
namespace {

using strength::MeshLoadSource;

void scale_tolerances(backlash::Tolerances& tolerances, double scale) {
  const auto scale_limits = [scale](auto& limits) {
    limits = {.lower = scale * limits.lower, .upper = scale * limits.upper};
  };
  for (backlash::GearTolerances& gear : tolerances.gears) {
    gear.runout_m *= scale;
    gear.cumulative_pitch_m *= scale;
    gear.single_pitch_m *= scale;
    scale_limits(gear.tooth_thickness_m);
  }
  tolerances.pin_position_m *= scale;
  scale_limits(tolerances.planet_phase_rad);
}

bool has_note(const Evaluation& e, std::string_view text) {
  return std::ranges::any_of(
      e.notes, [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

Design shared_design() {
  const std::string folder = std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/";
  Design design = io::read_design(folder + "loaded.toml");
  design.tolerances = io::read_design(folder + "ratio_96_tolerances.toml").tolerances;
  // A fifth of the example's, so that K_gamma is between its ends.
  scale_tolerances(*design.tolerances, 0.2);
  design.rating->factors.mesh_load_source = MeshLoadSource::kTolerances;
  return design;
}

Evaluation evaluated(const Design& design) { return std::get<Evaluation>(evaluate(design)); }

std::array<double, 3> mesh_loads(const strength::TrainRating<double>& rating) {
  std::array<double, 3> k{};
  for (std::size_t m = 0; m < 3; ++m) k[m] = rating.mesh[m].factors.mesh_load.value;
  return k;
}

TEST(PlanetSharing, IsTheQuantileOfTheSeriesAtTheMeshesOwnStiffness) {
  for (const double quantile : {0.99, 0.9}) {
    Design design = shared_design();
    design.rating->factors.mesh_load_quantile = quantile;
    const Evaluation e = evaluated(design);
    const auto& sharing = e.strength->planet_sharing;
    ASSERT_TRUE(sharing && sharing->series);
    EXPECT_EQ(sharing->drawn, kSharingSamples);
    EXPECT_GT(sharing->assembled, 9000U);
    EXPECT_EQ(sharing->quantile, quantile);
    const auto sample = strength::draw_plays(
        *clearance_model_of(design), {.samples = kSharingSamples,
                                      .seed = design.sampling.seed,
                                      .scatter = {.scatter = design.tolerances->scatter,
                                                  .sigma_level = design.tolerances->sigma_level}});
    const auto series = strength::load_factor_series(
        sample, e.strength->forward.springs.value().mesh_N_m, design.rating->torque_Nm, quantile);
    EXPECT_EQ(mesh_loads(e.strength->forward), series.quantile);
    EXPECT_EQ(mesh_loads(e.strength->backward), series.quantile);
    EXPECT_EQ(sharing->series->mean, series.mean);
    for (const double k : series.quantile) {
      EXPECT_GT(k, 1.05);
      EXPECT_LE(k, 3.0 + 1e-9);
    }
    EXPECT_EQ(e.strength->forward.mesh[0].factors.mesh_load.source, "tolerances");
  }
}

TEST(PlanetSharing, IsReportedWithHowManyGearboxes) {
  Design design = shared_design();
  const Evaluation e = evaluated(design);
  const auto strength = nlohmann::json::parse(report::strength_fields(e).json().text());
  const nlohmann::json& sharing = strength.at("planet_sharing");
  EXPECT_EQ(sharing.at("drawn"), kSharingSamples);
  EXPECT_EQ(sharing.at("assembled"), e.strength->planet_sharing->assembled);
  EXPECT_EQ(sharing.at("quantile"), 0.99);
  EXPECT_EQ(sharing.at("mean_k_gamma").size(), 3U);
  for (std::size_t m = 0; m < 3; ++m) {
    const double k = mesh_loads(e.strength->forward)[m];
    // S-P1 is at N in more gearboxes than the interval spans.
    const double slack = m == 0 ? 1e-9 : -1e-6;
    EXPECT_LT(sharing.at("k_gamma_lower").at(m), k + slack);
    EXPECT_GT(sharing.at("k_gamma_upper").at(m), k - slack);
    EXPECT_LT(sharing.at("k_gamma_upper").at(m), 1.2 * k);
  }
  for (std::size_t m = 0; m < 3; ++m) {
    EXPECT_EQ(strength.at("meshes").at(m).at("k_gamma"), mesh_loads(e.strength->forward)[m]);
  }
  const std::string table = report::strength_table(e);
  EXPECT_NE(table.find("K_gamma of tolerances"), std::string::npos);
  EXPECT_NE(table.find("10000 drawn"), std::string::npos);
  design.rating->factors.mesh_load_source = MeshLoadSource::kNumber;
  const Evaluation without = evaluated(design);
  EXPECT_TRUE(report::strength_fields(without).json().at("planet_sharing").is_null());
  EXPECT_EQ(report::strength_table(without).find("K_gamma of tolerances"), std::string::npos);
}

TEST(PlanetSharing, SafetiesAreThoseOfTheirMeshsNumber) {
  Design design = shared_design();
  const Evaluation shared = evaluated(design);
  for (std::size_t m = 0; m < 3; ++m) {
    Design stated = design;
    stated.rating->factors.mesh_load_source = MeshLoadSource::kNumber;
    stated.rating->factors.mesh_load = mesh_loads(shared.strength->forward)[m];
    const Evaluation e = evaluated(stated);
    EXPECT_FALSE(e.strength->planet_sharing);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& expected = e.strength->forward.mesh[m].teeth[i];
      const auto& found = shared.strength->forward.mesh[m].teeth[i];
      EXPECT_EQ(found.root_safety, expected.root_safety);
      EXPECT_EQ(found.flank_safety, expected.flank_safety);
    }
    // Within the tolerances too.
    for (std::size_t i = 0; i < e.checks.size(); ++i) {
      if (!e.checks[i].record->rating || e.checks[i].mesh != train::kMeshNames[m]) continue;
      EXPECT_EQ(shared.tolerance_limits->checks[i].margin.least,
                e.tolerance_limits->checks[i].margin.least);
    }
  }
}

TEST(PlanetSharing, CapacityIsTheTorqueWhoseOwnFactorLeavesNothing) {
  Design design = shared_design();
  const Evaluation stated = evaluated(design);
  const double capacity = stated.strength->capacity_forward.value().torque_Nm;
  EXPECT_GT(std::abs(capacity - design.rating->torque_Nm), 0.5);
  design.rating->torque_Nm = capacity;
  const Evaluation at = evaluated(design);
  double least = 1e300;
  for (std::size_t m = 0; m < 3; ++m) {
    for (const auto& tooth : at.strength->forward.mesh[m].teeth) {
      least = std::min({least, tooth.root_safety / *design.rating->teeth.root_safety_min,
                        tooth.flank_safety / *design.rating->teeth.flank_safety_min});
    }
  }
  EXPECT_NEAR(least, 1.0, 1e-9);
  EXPECT_NEAR(at.strength->capacity_forward->torque_Nm, capacity, 1e-9 * capacity);
  // The deviations stay as they are: in the limit of the torque K_gamma is 1.
  design.rating->torque_Nm = 0x1p16 * capacity;
  for (const double k : mesh_loads(evaluated(design).strength->forward)) EXPECT_NEAR(k, 1.0, 0.01);
}

TEST(PlanetSharing, IsNotKnownWhereNoneAssembles) {
  Design design = shared_design();
  for (double& allowance : design.train.machining_allowance) allowance = 0.0;
  design.train.center_distance_m += 60e-6;  // closes the rings' meshes
  const Evaluation e = evaluated(design);
  ASSERT_TRUE(e.strength->planet_sharing);
  EXPECT_EQ(e.strength->planet_sharing->assembled, 0U);
  EXPECT_FALSE(e.strength->planet_sharing->series);
  for (const double k : mesh_loads(e.strength->forward)) EXPECT_TRUE(std::isnan(k));
  EXPECT_TRUE(has_note(e, "K_gamma of the tolerances is not known"));
  // Nothing that depends on it looks safe; what does not is there.
  EXPECT_FALSE(e.strength->capacity_forward || e.strength->capacity_backward);
  for (const auto& mesh : e.strength->forward.mesh) {
    EXPECT_GT(mesh.normal_N, 0.0);
    for (const auto& tooth : mesh.teeth) {
      EXPECT_TRUE(std::isnan(tooth.root_safety) && std::isnan(tooth.flank_safety));
    }
  }
  EXPECT_TRUE(e.strength->forward.stiffness);
  int failed = 0;
  for (const CheckResult& check : e.checks) {
    const std::string_view name = check.record->name;
    if (name != "root_safety" && name != "flank_safety") continue;
    EXPECT_FALSE(check.ok);
    ++failed;
  }
  EXPECT_EQ(failed, 12);
  const auto strength = nlohmann::json::parse(report::strength_fields(e).json().text());
  EXPECT_TRUE(strength.at("capacity_nm").is_null());
  EXPECT_TRUE(strength.at("meshes").at(0).at("k_gamma").is_null());
  EXPECT_TRUE(strength.at("planet_sharing").at("k_gamma_lower").is_null());
}

TEST(PlanetSharing, IsAboveTheNumberOfPlanetsWhereBackFlanksCarry) {
  const std::string folder = std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/";
  Design design = shared_design();
  design.tolerances = io::read_design(folder + "ratio_96_tolerances.toml").tolerances;
  scale_tolerances(*design.tolerances, 5.0);
  for (double& allowance : design.train.machining_allowance) allowance = 0.005;
  design.rating->torque_Nm = 5.0;
  const Evaluation e = evaluated(design);
  EXPECT_GT(mesh_loads(e.strength->forward)[2], 3.0);
  EXPECT_TRUE(has_note(e, "K_gamma of P2-R2 is"));
  EXPECT_FALSE(has_note(evaluated(shared_design()), "above the 3 of one planet"));
}

TEST(PlanetSharing, WantsTolerances) {
  Design design = shared_design();
  design.tolerances.reset();
  EXPECT_THROW(static_cast<void>(evaluate(design)), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::design::planet_sharing_test
