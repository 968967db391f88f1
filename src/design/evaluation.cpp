#include "design/evaluation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "backlash/normal_backlash.hpp"
#include "design/elastic_windup.hpp"
#include "design/evaluation_parts.hpp"
#include "design/friction_range.hpp"
#include "design/mass_model.hpp"
#include "design/measured_lost_motion.hpp"
#include "design/rated_gearbox.hpp"
#include "efficiency/train_efficiency.hpp"
#include "units/units.hpp"

namespace gear3k::design {

namespace {

using geometry::GearGeometry;

/// Says which bodies have no place along the axis, as their gaps are then not checked.
void note_axial_overlap(const Design& design, std::vector<std::string>& notes) {
  if (!design.limits[CheckId::kBodyGap]) return;
  std::vector<std::string_view> unknown;
  for (std::size_t i = 0; i < train::kBodyCount; ++i) {
    if (!design.axial.extent[i]) unknown.push_back(train::kBodyNames[i]);
  }
  if (unknown.size() == train::kBodyCount) {
    notes.emplace_back("axial overlap is not checked: the design has no [axial] table");
  } else if (!unknown.empty()) {
    notes.push_back(fmt::format("axial overlap is not checked for {}: not in [axial]",
                                fmt::join(unknown, ", ")));
  }
}

/// Says which stated limits of size have nothing to hold.
void note_sizes(const Design& design, std::vector<std::string>& notes) {
  const GearingLayout layout = train_layout(
      {.planets = design.train.planets, .axial = design.axial, .bodies = bodies_of(design)});
  if (design.limits[CheckId::kGearboxLength] && !layout.sized) {
    notes.emplace_back(
        "gearbox_length is not checked: no [axial] table, and not the face widths of both stages");
  }
  if (design.limits[CheckId::kWall] && std::ranges::none_of(layout.walled, std::identity())) {
    notes.emplace_back("wall is not checked: no gear has a bore or an outer diameter");
  }
  const auto& room = design.limits[CheckId::kRingCutter];
  const bool shaped = std::ranges::any_of(
      design.train.cutter, [](const geometry::PinionCutter& cutter) { return cutter.teeth > 0; });
  if (room && *room != *check_record(CheckId::kRingCutter).default_limit && !shaped) {
    notes.emplace_back("ring_cutter is not checked: no ring has a pinion cutter");
  }
}

/// Says where contact ratios over the temperatures, which no check holds, are below the limit of
/// those as drawn.
void note_thermal_contact(const Design& design, const Evaluation& e,
                          std::vector<std::string>& notes) {
  const auto& limit = design.limits[CheckId::kContactRatioMin];
  if (!limit || !e.thermal) return;
  const ThermalStateResult* at = nullptr;
  std::size_t mesh = 0;
  for (const ThermalStateResult& state : e.thermal->states) {
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      if (at != nullptr && state.meshes[k].contact_ratio >= at->meshes[mesh].contact_ratio) {
        continue;
      }
      at = &state;
      mesh = k;
    }
  }
  // The first state is the drawing, whose contact ratios are checked.
  if (at == nullptr || at == e.thermal->states.data()) return;
  const double least = at->meshes[mesh].contact_ratio;
  if (least >= *limit - kFeasibilityTolerance) return;
  notes.push_back(fmt::format(
      "over [thermal] the contact ratio is as low as {:.4f} ({} at {}), below the limit {:g}, "
      "which is checked as drawn only",
      least, train::kMeshNames[mesh], state_text(at->state), *limit));
}

/// Says which gears are shorter along the axis than their face width, and which mates have less in
/// common: one of both is wrong.
void note_face_widths(const Design& design, std::vector<std::string>& notes) {
  constexpr double kSlack_m = 1e-9;
  const auto mm = [](double length_m) {
    return units::from_si(length_m, units::Unit::kMillimetre);
  };
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    const int stage = train::stage_of(static_cast<int>(gear));
    const auto& extent = design.axial.extent[gear];
    const auto& width_m = design.masses.face_width_m[static_cast<std::size_t>(stage)];
    if (!extent || !width_m) continue;
    const double length_m = extent->to_m - extent->from_m;
    if (length_m >= *width_m - kSlack_m) continue;
    notes.push_back(fmt::format(
        "axial.{}_mm is {:.6g} mm long, stage{}.face_width_mm {:.6g} mm: masses and strength have "
        "the face width",
        train::kGearNames[gear], mm(length_m), stage + 1, mm(*width_m)));
  }
  for (const auto& [gear1, gear2] : train::kMeshGears) {
    const int stage = train::stage_of(gear1);
    const std::optional<double> common_m = train::common_length_m(design.axial, gear1, gear2);
    const auto& width_m = design.masses.face_width_m[static_cast<std::size_t>(stage)];
    if (!common_m || !width_m || *common_m >= *width_m - kSlack_m) continue;
    notes.push_back(fmt::format(
        "{} and {} have {:.6g} mm in common along the axis, stage{}.face_width_mm is {:.6g} mm: "
        "strength is that of the face width",
        train::kGearNames[static_cast<std::size_t>(gear1)],
        train::kGearNames[static_cast<std::size_t>(gear2)], mm(*common_m), stage + 1,
        mm(*width_m)));
  }
}

/// Says where the rated torque is far from that of the operating point.
void note_rated_torque(const Design& design, std::vector<std::string>& notes) {
  if (!design.rating || !design.operating_point) return;
  const double rated_Nm = design.rating->torque_Nm;
  const double point_Nm = design.operating_point->output_torque_Nm;
  if (point_Nm >= 0.5 * rated_Nm && point_Nm <= rated_Nm) return;
  notes.push_back(fmt::format(
      "[strength] rates {:.6g} N m at R2, operating_point has {:.6g} N m: the friction of the "
      "rating is that of the operating point",
      rated_Nm, point_Nm));
}

/// Says whose help the backward rating takes for granted.
void note_help_of_the_sun(const Evaluation& e, std::vector<std::string>& notes) {
  if (!e.strength || e.strength->backward.locked) return;
  if (!e.efficiency.backward || e.efficiency.backdrivable) return;
  notes.emplace_back(
      "not back-drivable: strength driven backward is that of a load that turns the gearbox while "
      "the sun helps");
}

/// The gearbox at its operating point; empty without one.
std::optional<OperatingResult> operation_result(const LossyTrain<double>& train,
                                                const Design& design) {
  if (!design.operating_point) return std::nullopt;
  const OperatingPoint<double>& point = *design.operating_point;
  return OperatingResult{.point = point,
                         .forward = operate(train, point, Direction::kForward),
                         .backward = operate(train, point, Direction::kBackward)};
}

/// Friction of each mesh: that of the law at the operating point, where it depends on it.  NaN, and
/// with it no efficiency, without a point or where the gearbox does not run there.
std::array<MeshFriction, train::kMeshCount> mesh_frictions(
    const LossyTrain<double>& train, const std::optional<OperatingResult>& operation) {
  std::array<MeshFriction, train::kMeshCount> mu{};
  if (!efficiency::depends_on_state(train.friction)) {
    const auto forward = *mesh_friction<double>(train, {}, Direction::kForward);
    const auto backward = *mesh_friction<double>(train, {}, Direction::kBackward);
    for (std::size_t k = 0; k < mu.size(); ++k) {
      mu[k] = {.forward = forward[k], .backward = backward[k]};
    }
    return mu;
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  mu.fill({.forward = kNone, .backward = kNone});
  const auto at = [&](const OperationResult<double>& result, std::size_t k) {
    return result.operation ? result.operation->mesh[k].friction : kNone;
  };
  for (std::size_t k = 0; operation && k < mu.size(); ++k) {
    mu[k] = {.forward = at(operation->forward, k), .backward = at(operation->backward, k)};
  }
  return mu;
}

void note_operation(const std::optional<OperatingResult>& operation,
                    std::vector<std::string>& notes) {
  if (!operation) return;
  const auto note = [&](const OperationResult<double>& result, std::string_view direction) {
    if (result.operation) return;
    notes.push_back(fmt::format("at the operating point, driven {}: {}", direction,
                                no_operation_text(result.reason)));
  };
  note(operation->forward, "forward");
  note(operation->backward, "backward");
  const auto& backward = operation->backward.operation;
  if (backward && backward->sun_torque_Nm < 0.0) {
    notes.emplace_back(
        "at the operating point R2 alone does not turn the gearbox: drags and friction take more "
        "than it transmits, the sun must help");
  }
}

/// Says what the inertias leave out or count twice.
void note_masses(const MassModel& masses, std::vector<std::string>& notes) {
  if (masses.bodies && !masses.counts_carrier) notes.emplace_back(kCarrierNotCounted);
  if (masses.pins_in_solid_planets) {
    notes.emplace_back(
        "masses count the pins' place in the planets twice: state gears.P1.bore_mm and "
        "gears.P2.bore_mm");
  }
}

bool all_positive(const efficiency::MeshEfficiencies<double>& eta) {
  return std::ranges::all_of(eta, [](double e) { return e > 0.0; });
}

EfficiencyResult efficiency_result(const train::ToothSet& teeth,
                                   const inertia::DirectionalEfficiencies<double>& eta,
                                   bool in_contact) {
  EfficiencyResult result{
      .forward = {},
      .backward = {},
      .backdrivable = false,
      .backdriving_margin = efficiency::backdriving_margin(teeth, eta.backward)};
  if (!in_contact) return result;
  if (all_positive(eta.forward)) {
    result.forward = efficiency::forward_efficiency(teeth, eta.forward);
  }
  if (all_positive(eta.backward)) {
    result.backward = efficiency::backward_efficiency(teeth, eta.backward);
    result.backdrivable = result.backdriving_margin > 0.0;
  }
  return result;
}

/// Lost motion with a calibrated model; empty without one.
std::optional<double> measured_result(const Design& design,
                                      const train::TrainParameters<double>& parameters,
                                      const train::TrainGeometry<double>& geometry) {
  if (!changes_lost_motion(design.lost_motion)) return std::nullopt;
  const OperatingPoint<double> point = design.operating_point.value_or(OperatingPoint<double>{});
  auto result = measured_lost_motion<double>(
      parameters, geometry, design.lost_motion,
      {.torque_Nm = point.output_torque_Nm, .temperature_K = point.temperature_K});
  if (!result || !design.lost_motion.beyond_springs) return result;
  const auto springs = elastic_train(design);
  if (springs) *result += 2.0 * elastic_windup(*springs, point.output_torque_Nm);
  return result;
}

InertiaResult inertia_result(const inertia::InertialTrain<double>& train,
                             const inertia::DirectionalEfficiencies<double>& eta) {
  InertiaResult result{.lossless_kgm2 = inertia::lossless_inertia(train),
                       .backward_kgm2 = std::nullopt,
                       .forward_kgm2 = std::nullopt,
                       .paper_kgm2 = std::nullopt};
  if (!all_positive(eta.forward) || !all_positive(eta.backward)) return result;
  result.backward_kgm2 = inertia::effective_inertia(train, eta, false);
  result.forward_kgm2 = inertia::effective_inertia(train, eta, true);
  result.paper_kgm2 = inertia::paper_inertia(train, eta.backward);
  return result;
}

/// The centre distance as given, or the zero-backlash distance of mesh P1-R1 where it exists.
std::optional<double> resolved_center_distance(
    const Design& design, const std::array<GearGeometry<double>, train::kGearCount>& gears) {
  if (design.center_distance_given) return design.train.center_distance_m;
  return geometry::zero_backlash_center_distance(gears[train::kP1], gears[train::kR1]);
}

}  // namespace

std::optional<NotDefined> why_undefined(const Design& design) {
  const auto gears = train::make_train_gears(design.train);
  const auto distance = resolved_center_distance(design, gears);
  if (!distance) {
    return NotDefined{
        "mesh P1-R1 has no zero-backlash centre distance for these profile shifts: state "
        "center_distance_mm"};
  }
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    const double sum = geometry::base_radius_sum(gears[static_cast<std::size_t>(first)],
                                                 gears[static_cast<std::size_t>(second)]);
    if (!(sum > 0.0 && *distance > sum)) {
      return no_working_angle(train::kMeshNames[k], *distance, sum);
    }
  }
  if (!design.thermal) return std::nullopt;
  if (const auto none = mesh_without_angle(gears, *distance, *design.thermal)) {
    return NotDefined{fmt::format("at {} mesh {} has no working pressure angle",
                                  state_text(none->state), train::kMeshNames[none->mesh])};
  }
  return std::nullopt;
}

train::TrainParameters<double> resolved_parameters(const Design& design) {
  train::TrainParameters<double> parameters = design.train;
  parameters.center_distance_m =
      *resolved_center_distance(design, train::make_train_gears(parameters));
  return parameters;
}

LossyTrain<double> lossy_train(const Design& design, const train::TrainGeometry<double>& geometry) {
  return {.geometry = geometry,
          .friction = design.friction,
          .shafts = design.shafts,
          .face_width_m = {design.masses.face_width_m[0].value_or(0.0),
                           design.masses.face_width_m[1].value_or(0.0)}};
}

namespace {

using TrainForms = std::array<geometry::ToothForm<double>, train::kGearCount>;

/// A train whose centre distance and forms are known.
struct DrawnTrain {
  const Design& design;
  const train::TrainParameters<double>& parameters;
  const train::TrainGeometry<double>& geometry;
  const TrainForms& forms;
  const std::array<double, train::kMeshCount>& normal_backlash_m;
};

/// Losses of the meshes and of the train at the operating point, or by constant friction.
/// @returns the efficiencies of the meshes
inertia::DirectionalEfficiencies<double> add_meshes(const DrawnTrain& drawn, Evaluation& e) {
  const auto& gears = drawn.geometry.gears;
  const LossyTrain<double> lossy = lossy_train(drawn.design, drawn.geometry);
  e.operation = operation_result(lossy, drawn.design);
  const auto mu = mesh_frictions(lossy, e.operation);
  note_operation(e.operation, e.notes);
  if (e.operation) {
    std::ranges::copy(friction_range_notes(lossy, *e.operation), std::back_inserter(e.notes));
  }
  inertia::DirectionalEfficiencies<double> eta{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    e.meshes.push_back(mesh_result(
        {.name = train::kMeshNames[k],
         .gear1 = gears[static_cast<std::size_t>(first)],
         .gear2 = gears[static_cast<std::size_t>(second)],
         .mesh = drawn.geometry.meshes[k],
         .gear1_drives = train::gear1_drives(static_cast<train::MeshId>(k), e.g2 < 1.0, true)},
        drawn.design.friction, mu[k]));
    eta.forward[k] = e.meshes[k].efficiency_forward;
    eta.backward[k] = e.meshes[k].efficiency_backward;
  }
  const bool in_contact = std::ranges::all_of(
      e.meshes, [](const MeshResult& mesh) { return mesh.contact_ratio > 0.0; });
  e.efficiency = efficiency_result(e.teeth, eta, in_contact);
  return eta;
}

LostMotionResult lost_motion_result(const DrawnTrain& drawn, double ratio) {
  using backlash::LostMotionModel;
  const auto& j_bn = drawn.normal_backlash_m;
  const double kinematic =
      backlash::output_lost_motion(drawn.geometry, j_bn, LostMotionModel::kKinematic);
  return {.paper_rad = backlash::output_lost_motion(drawn.geometry, j_bn, LostMotionModel::kPaper),
          .kinematic_rad = kinematic,
          .input_kinematic_rad = kinematic * std::abs(ratio),
          .kinematic_share_rad = backlash::kinematic_lost_motion(drawn.geometry, j_bn),
          .measured_rad = measured_result(drawn.design, drawn.parameters, drawn.geometry)};
}

void add_masses(const DrawnTrain& drawn, const inertia::DirectionalEfficiencies<double>& eta,
                Evaluation& e) {
  MassModel masses = mass_model(drawn.design.masses, drawn.geometry);
  e.parts = std::move(masses.parts);
  e.total_mass_kg = masses.total_mass_kg;
  e.total_mass_missing = std::move(masses.total_mass_missing);
  if (!masses.bodies) {
    e.inertia_missing = std::move(masses.bodies_missing);
  } else {
    e.inertia = inertia_result({.teeth = e.teeth,
                                .planets = e.planets,
                                .center_distance_m = e.center_distance_m,
                                .bodies = *masses.bodies},
                               eta);
  }
  note_masses(masses, e.notes);
}

/// Strength, all checks, and both within the tolerances.
void add_checks(const DrawnTrain& drawn, Evaluation& e) {
  const Design& design = drawn.design;
  Gearing<double> gearing =
      gearing_of(drawn.geometry, drawn.normal_backlash_m, design.limits.model);
  gearing.forms = drawn.forms;
  gearing.axial = &design.axial;
  const TrainBodies<double> bodies = bodies_of(design);
  gearing.bodies = &bodies;
  gearing.thermal = stated_range(design);
  const auto checks = list_checks(design.limits, train_layout({.planets = e.planets,
                                                               .stage1_module_m = e.module_m[0],
                                                               .cutter = drawn.parameters.cutter,
                                                               .axial = design.axial,
                                                               .bodies = bodies,
                                                               .rating = stated_load(design),
                                                               .thermal = gearing.thermal}));
  const auto rated = rate_gearbox(design, drawn.geometry, drawn.forms, e.meshes, e.parts);
  LoadedGearing deciding;
  if (rated) {
    deciding = rated->rating(gearing, {true, true, true});
    gearing.rating = deciding.rating.mesh;
    gearing.train_rating = &deciding.rating;
    e.strength = rated->result;
    std::ranges::copy(rated->notes, std::back_inserter(e.notes));
  }
  e.checks = run_checks(checks, gearing, {.gears = train::kGearNames, .meshes = train::kMeshNames});
  e.tolerance_limits = limits_within(design.tolerances,
                                     {.gears = drawn.geometry.gears,
                                      .forms = drawn.forms,
                                      .mesh_gears = train::kMeshGears,
                                      .gear_names = train::kGearNames,
                                      .mesh_names = train::kMeshNames,
                                      .center_distance_m = e.center_distance_m,
                                      .train = &drawn.geometry,
                                      .axial = &design.axial,
                                      .bodies = &bodies,
                                      .model = design.limits.model,
                                      .rating = rated ? rated->rating : GearingRating{},
                                      .thermal = gearing.thermal},
                                     checks, e.notes);
}

void add_notes(const Design& design, Evaluation& e) {
  note_loss_model(e.meshes, e.notes);
  note_pointed_teeth(e.gears, e.notes);
  note_axial_overlap(design, e.notes);
  note_face_widths(design, e.notes);
  note_sizes(design, e.notes);
  note_thermal_contact(design, e, e.notes);
  note_rated_torque(design, e.notes);
  note_help_of_the_sun(e, e.notes);
  if (!design.center_distance_given) {
    e.notes.emplace_back(
        "no center_distance_mm given: the zero-backlash distance of mesh P1-R1 is used");
  }
}

}  // namespace

std::variant<Evaluation, NotDefined> evaluate(const Design& design) {
  if (auto undefined = why_undefined(design)) return *std::move(undefined);
  const train::TrainParameters<double> parameters = resolved_parameters(design);
  const auto train = train::make_train_geometry(parameters);
  const auto forms = tooth_forms(train->gears);
  const auto j_bn = backlash::normal_backlashes(*train);
  const DrawnTrain drawn{.design = design,
                         .parameters = parameters,
                         .geometry = *train,
                         .forms = forms,
                         .normal_backlash_m = j_bn};
  Evaluation e{};
  e.name = design.name;
  e.teeth = parameters.teeth;
  e.planets = parameters.planets;
  e.ratio = train::ratio(e.teeth);
  e.g1 = train::g1(e.teeth);
  e.g2 = train::g2(e.teeth);
  e.center_distance_m = parameters.center_distance_m;
  e.center_distance_given = design.center_distance_given;
  e.module_m = parameters.module_m;
  const inertia::DirectionalEfficiencies<double> eta = add_meshes(drawn, e);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    e.gears.push_back(
        gear_result(train::kGearNames[i], train->gears[i], forms[i], design.pin_diameter_m[i]));
  }
  e.lost_motion = lost_motion_result(drawn, e.ratio);
  add_masses(drawn, eta, e);
  e.assembly = train::assembly(e.teeth, e.planets);
  for (std::size_t k = 0; e.assembly.equal_spacing && k < train::kMeshCount; ++k) {
    e.meshes[k].planet_phase =
        train::mesh_phases(e.teeth, static_cast<train::MeshId>(k), e.planets);
  }
  if (design.thermal) e.thermal = thermal_result(*train, *design.thermal);
  add_checks(drawn, e);
  add_notes(design, e);
  return e;
}

bool all_ok(const std::vector<CheckResult>& checks) {
  return std::ranges::all_of(checks, [](const CheckResult& c) { return c.ok; });
}

}  // namespace gear3k::design
