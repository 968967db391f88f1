#include "papers/published_sources.hpp"

#include <numbers>
#include <stdexcept>

#include "io/files/actuator_file.hpp"
#include "io/files/scenario_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/csv_table.hpp"
#include "papers/backdrivability_sources.hpp"
#include "papers/embedded_data.hpp"
#include "papers/statement_table.hpp"
#include "strength/material.hpp"
#include "units/units.hpp"

namespace gear3k::papers {

namespace {

constexpr const char* kPrototypes = "published_3k_prototypes.csv";
constexpr const char* kStatements = "low_backlash_paper_statements.csv";
constexpr const char* kPairLosses = "spur_pair_loss_dry_steel.csv";
constexpr const char* kThesisStatements = "directional_impedance_statements.csv";

std::optional<double> scaled(const io::CsvTable& table, const io::CsvTable::Row& row,
                             const std::string& column, double factor) {
  std::optional<double> value = table.number(row, column);
  if (value) *value *= factor;
  return value;
}

PublishedGearbox gearbox(const io::CsvTable& table, const io::CsvTable::Row& row,
                         const std::string& name) {
  const auto number = [&](const std::string& column) { return required(table, row, column); };
  const auto integer = [&](const std::string& column) {
    return static_cast<int>(required(table, row, column));
  };
  PublishedGearbox g;
  g.design.name = name;
  auto& t = g.design.train;
  t.teeth = {.S = integer("zS"),
             .P1 = integer("zP1"),
             .R1 = integer("zR1"),
             .P2 = integer("zP2"),
             .R2 = integer("zR2")};
  t.planets = integer("n_planets");
  t.pressure_angle_rad = number("alpha_deg") * std::numbers::pi / 180.0;
  t.module_m = {number("m1_mm") * units::kMillimetre, number("m2_mm") * units::kMillimetre};
  t.profile_shift = {number("xS"), number("xP1"), number("xR1"), number("xP2"), number("xR2")};
  constexpr double kPercent = 0.01;
  const double arcmin = units::to_si(1.0, units::Unit::kArcmin);
  if (const auto ratio = table.number(row, "ratio_stated")) {
    g.stated_ratio = {.value = *ratio, .source = "Table III"};
  }
  g.measured_lost_motion_rad = scaled(table, row, "backlash_arcmin", arcmin);
  g.measured_forward = scaled(table, row, "fwd_eff_pct", kPercent);
  g.measured_backward = scaled(table, row, "bwd_eff_pct", kPercent);
  g.outer_diameter_m = scaled(table, row, "diameter_mm", units::kMillimetre);
  return g;
}

ThesisSources thesis_sources() {
  ThesisSources sources;
  const io::CsvTable losses = io::parse_csv(std::string(pair_losses_csv()), kPairLosses);
  sources.measured.reserve(losses.rows.size());
  for (const io::CsvTable::Row& row : losses.rows) {
    sources.measured.push_back(
        {.driving_teeth = static_cast<int>(required(losses, row, "driving_teeth")),
         .driven_teeth = static_cast<int>(required(losses, row, "driven_teeth")),
         .loss = required(losses, row, "loss_factor")});
  }
  const io::CsvTable statements =
      io::parse_csv(std::string(thesis_statements_csv()), kThesisStatements);
  const auto stated = [&](const std::string& name) {
    return required(statements, row_named(statements, "name", name), "value");
  };
  sources.statements = {
      .module_m = units::to_si(stated("module"), units::Unit::kMillimetre),
      .pressure_angle_rad = units::to_si(stated("pressure_angle"), units::Unit::kDegree),
      .map_friction = stated("map_friction"),
      .corrected_friction = stated("corrected_friction"),
      .corrected_symmetric_scale = stated("corrected_symmetric_scale"),
      .corrected_offset = stated("corrected_offset"),
      .corrected_skew_factor = stated("corrected_skew_factor"),
      .largest_model_skew_percent = stated("largest_model_skew"),
      .single_pair_contact_ratio = stated("single_pair_contact_ratio"),
      .small_skew_teeth = static_cast<int>(stated("small_skew_teeth")),
      .small_skew_percent = stated("small_skew"),
      .sensor_sensitivity_error_percent = stated("sensor_sensitivity_error"),
      .mesh_rate_1_s = stated("mesh_rate"),
      .largest_asymmetry_percent = stated("largest_asymmetry"),
      .smaller_asymmetry_percent = stated("smaller_asymmetry")};
  return sources;
}

DirectionalBenchSources directional_bench_sources() {
  const auto scenario = [](std::string_view text, const char* name) {
    const auto table = [](const std::string& path) {
      return std::string(path == "directional_bench_angle.csv" ? bench_angle_csv()
                                                               : bench_torque_csv());
    };
    return io::parse_scenario(std::string(text), name, table).scenario;
  };
  // The thesis's 303 stainless is in no table; density differs little between steels.
  const strength::Material* steel = strength::find_material("normalised low carbon steel ML MQ");
  if (steel == nullptr || !steel->density_kgm3) throw std::invalid_argument("no density of steel");
  return {
      .actuator = io::parse_actuator(std::string(bench_actuator_toml()), "directional_bench.toml"),
      .load = scenario(bench_load_toml(), "directional_bench_load.toml"),
      .push = scenario(bench_push_toml(), "directional_bench_push.toml"),
      .braking = scenario(bench_braking_toml(), "directional_bench_braking.toml"),
      .steel_kg_m3 = *steel->density_kgm3};
}

}  // namespace

PublishedSources published_sources() {
  const io::CsvTable table = io::parse_csv(std::string(published_prototypes_csv()), kPrototypes);
  const io::CsvTable statements = io::parse_csv(std::string(paper_statements_csv()), kStatements);
  const auto stated = [&](const std::string& name) {
    return required(statements, row_named(statements, "name", name), "value");
  };
  // Its place is the part of the locator before what is said there.
  const auto printed = [&](const std::string& name, double factor) {
    const std::string locator =
        statements.text(row_named(statements, "name", name), "locator").value_or("");
    return Stated{.value = factor * stated(name), .source = locator.substr(0, locator.find(':'))};
  };
  const double arcmin = units::to_si(1.0, units::Unit::kArcmin);
  constexpr double kPercent = 0.01;
  const io::CsvTable::Row& proposed = row_named(table, "design", "low_backlash_proposed");
  const io::CsvTable::Row& strain_wave = row_named(table, "design", "harmonic_drive_csg25lw");
  PublishedSources sources;
  sources.low_backlash = gearbox(table, proposed, "low-backlash prototype");
  sources.low_backlash.stated_lost_motion_rad = printed("simulated_lost_motion", arcmin);
  sources.low_backlash.lost_motion_bracket_rad = arcmin * stated("measured_lost_motion_bracket");
  sources.low_backlash.stated_lost_motion_accuracy = printed("backlash_accuracy", kPercent);
  sources.low_backlash.stated_backward = printed("simulated_backward", kPercent);
  sources.bilateral =
      gearbox(table, row_named(table, "design", "bilateral_drive_gear"), "bilateral drive gear");
  sources.bilateral.stated_lost_motion_accuracy = printed("bilateral_backlash_accuracy", kPercent);
  sources.bilateral.stated_contact_ratio = {printed("bilateral_contact_ratio_SP1", 1.0),
                                            printed("bilateral_contact_ratio_P1R1", 1.0),
                                            printed("bilateral_contact_ratio_P2R2", 1.0)};
  sources.statements = {
      .bilateral_xP2_printed = stated("bilateral_xP2_printed"),
      .starting_torque_ratio = stated("starting_torque_ratio"),
      .eq10_factor = stated("eq10_factor_printed"),
      .figure_outer_diameter_m =
          units::to_si(stated("figure_outer_diameter"), units::Unit::kMillimetre),
      .lost_motion_before_rad = units::to_si(stated("lost_motion_before"), units::Unit::kArcmin),
      .lost_motion_after_rad = units::to_si(stated("lost_motion_after"), units::Unit::kArcmin),
      .efficiency_after = 0.01 * stated("efficiency_after")};
  sources.backdrive_starting_torque_Nm = required(table, proposed, "backdrive_start_Nm");
  sources.max_backdriving_torque_Nm = required(table, proposed, "max_backdrive_Nm");
  sources.strain_wave_starting_torque_Nm = required(table, strain_wave, "backdrive_start_Nm");
  sources.task = io::parse_specification(std::string(rp96_toml()), "rp96.toml");
  sources.figure_task =
      io::parse_specification(std::string(paper_figures_toml()), "paper-figures.toml");
  sources.thesis = thesis_sources();
  sources.directional_bench = directional_bench_sources();
  sources.backdrivability = backdrivability_sources();
  sources.backdrivability.measured_strain_wave_Nm = sources.strain_wave_starting_torque_Nm;
  sources.backdrivability.prototype = sources.low_backlash.design.train.teeth;
  return sources;
}

}  // namespace gear3k::papers
