// K_γ of a design from its tolerances: against the series of the plays, and fixed points.

#include "design/planet_sharing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "report/strength_report.hpp"

namespace gear3k::design::planet_sharing_test {
namespace {

using strength::MeshLoadSource;

Design shared_design() {
  const std::string folder = std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/";
  Design design = io::read_design(folder + "loaded.toml");
  design.tolerances = io::read_design(folder + "ratio_96_tolerances.toml").tolerances;
  // A fifth of the example's, so that K_gamma is between its ends.
  for (backlash::GearTolerances& gear : design.tolerances->gears) {
    gear.runout_m *= 0.2;
    gear.cumulative_pitch_m *= 0.2;
    gear.single_pitch_m *= 0.2;
    gear.tooth_thickness_m = {.lower = 0.2 * gear.tooth_thickness_m.lower,
                              .upper = 0.2 * gear.tooth_thickness_m.upper};
  }
  design.tolerances->pin_position_m *= 0.2;
  design.tolerances->planet_phase_rad = {.lower = 0.2 * design.tolerances->planet_phase_rad.lower,
                                         .upper = 0.2 * design.tolerances->planet_phase_rad.upper};
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
      least = std::min({least, tooth.root_safety / *design.rating->root_safety_min,
                        tooth.flank_safety / *design.rating->flank_safety_min});
    }
  }
  EXPECT_NEAR(least, 1.0, 1e-9);
  EXPECT_NEAR(at.strength->capacity_forward->torque_Nm, capacity, 1e-9 * capacity);
  // K_gamma falls with the torque.
  design.rating->torque_Nm = 2.0 * capacity;
  const auto more = mesh_loads(evaluated(design).strength->forward);
  EXPECT_LT(more[1], mesh_loads(at.strength->forward)[1]);
  EXPECT_LT(more[2], mesh_loads(at.strength->forward)[2]);
}

TEST(PlanetSharing, IsAllOnOnePlanetWhereNoneAssembles) {
  Design design = shared_design();
  for (double& allowance : design.train.machining_allowance) allowance = 0.0;
  design.train.center_distance_m += 60e-6;  // closes the rings' meshes
  const Evaluation e = evaluated(design);
  ASSERT_TRUE(e.strength->planet_sharing);
  EXPECT_EQ(e.strength->planet_sharing->assembled, 0U);
  EXPECT_FALSE(e.strength->planet_sharing->series);
  for (const double k : mesh_loads(e.strength->forward)) EXPECT_EQ(k, 3.0);
  EXPECT_TRUE(std::ranges::any_of(e.notes, [](const std::string& note) {
    return note.find("K_gamma of the tolerances is not computed") != std::string::npos;
  }));
}

TEST(PlanetSharing, WantsTolerances) {
  Design design = shared_design();
  design.tolerances.reset();
  EXPECT_THROW(static_cast<void>(evaluate(design)), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::design::planet_sharing_test
