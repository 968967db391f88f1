#include "design/evaluation.hpp"
#include "design/evaluation_parts.hpp"
#include "design/rated_gearbox.hpp"

namespace gear3k::design {

namespace {

using geometry::GearGeometry;

/// The gears of a pair; by the KHK rule where asked for and the distance is known.
std::array<GearGeometry<double>, 2> gears_of(const PairDesign& design,
                                             std::optional<double> center_distance_m) {
  const auto angle = geometry::make_pressure_angle(design.pressure_angle_rad);
  std::array<geometry::Gear<double>, 2> gears{design.gear1, design.gear2};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!design.khk_tip[i] || !center_distance_m) continue;
    gears[i].tip_shortening = geometry::khk_tip_shortening<double>(
        {.teeth_sum = design.gear1.teeth + design.gear2.teeth,
         .module_m = design.gear1.module_m,
         .shift_sum = design.gear1.profile_shift + design.gear2.profile_shift,
         .center_distance_m = *center_distance_m});
  }
  return {geometry::make_gear_geometry(gears[0], angle),
          geometry::make_gear_geometry(gears[1], angle)};
}

std::optional<double> resolved_center_distance(const PairDesign& design,
                                               const std::array<GearGeometry<double>, 2>& gears) {
  return design.center_distance_m ? design.center_distance_m
                                  : geometry::zero_backlash_center_distance(gears[0], gears[1]);
}

constexpr std::array<std::string_view, 1> kPairMesh{"1-2"};

}  // namespace

std::optional<NotDefined> why_undefined(const PairDesign& design) {
  const auto gears = gears_of(design, std::nullopt);
  const double sum = geometry::base_radius_sum(gears[0], gears[1]);
  const auto distance = resolved_center_distance(design, gears);
  if (sum > 0.0 && !distance) {
    return NotDefined{
        "the pair has no zero-backlash centre distance for these profile shifts: state "
        "center_distance_mm"};
  }
  if (!(sum > 0.0 && *distance > sum)) {
    return no_working_angle(kPairMesh[0], distance.value_or(0.0), sum);
  }
  return std::nullopt;
}

std::array<GearGeometry<double>, 2> resolved_gears(const PairDesign& design) {
  return gears_of(design, resolved_center_distance(design, gears_of(design, std::nullopt)));
}

std::variant<PairEvaluation, NotDefined> evaluate(const PairDesign& design) {
  static constexpr std::array<std::string_view, 2> kGears{"1", "2"};
  static constexpr std::array<std::array<int, 2>, 1> kPair{{{0, 1}}};
  if (auto undefined = why_undefined(design)) return *std::move(undefined);
  const auto distance = resolved_center_distance(design, gears_of(design, std::nullopt));
  const auto gears = gears_of(design, distance);
  const auto forms = tooth_forms(gears);
  const auto mesh = geometry::make_mesh_geometry(gears[0], gears[1], *distance);

  PairEvaluation e{};
  e.name = design.name;
  e.center_distance_m = *distance;
  e.center_distance_given = design.center_distance_m.has_value();
  e.mesh = mesh_result(
      {.name = kPairMesh[0],
       .gear1 = gears[0],
       .gear2 = gears[1],
       .mesh = *mesh,
       .gear1_drives = true},
      design.friction,
      {.forward = design.friction.coefficient, .backward = design.friction.coefficient});
  for (std::size_t i = 0; i < 2; ++i) {
    e.gears.push_back(gear_result(kGears[i], gears[i], forms[i], design.pin_diameter_m[i]));
  }
  const std::array<double, 1> j_bn{e.mesh.normal_backlash_m};
  const std::array<geometry::MeshGeometry<double>, 1> meshes{*mesh};
  const std::array<geometry::GearKind, 2> kinds{gears[0].gear.kind, gears[1].gear.kind};
  const std::vector<bool> shaped{e.gears[0].tooth.cutter_teeth > 0,
                                 e.gears[1].tooth.cutter_teeth > 0};
  const auto rated = rate_pair(design, gears, forms, *mesh);
  if (rated) {
    e.strength = rated->rating;
    e.torque_capacity = rated->capacity;
    std::ranges::copy(rated->notes, std::back_inserter(e.notes));
  }
  Gearing<double> gearing{.gears = gears,
                          .meshes = meshes,
                          .mesh_gears = kPair,
                          .normal_backlash_m = j_bn,
                          .forms = forms,
                          .train = nullptr,
                          .axial = nullptr,
                          .bodies = nullptr,
                          .model = design.limits.model};
  if (e.strength) gearing.rating = std::span(&*e.strength, 1);
  const auto checks = list_checks(design.limits, {.gear_kinds = kinds,
                                                  .mesh_gears = kPair,
                                                  .shaped = shaped,
                                                  .passing_bodies = {},
                                                  .walled = {},
                                                  .sized = false,
                                                  .planets = 0,
                                                  .length_scale_m = design.gear1.module_m,
                                                  .rating = stated_load(design)});
  e.checks = run_checks(checks, gearing, {.gears = kGears, .meshes = kPairMesh});
  e.tolerance_limits = limits_within(design.tolerances,
                                     {.gears = gears,
                                      .forms = forms,
                                      .mesh_gears = kPair,
                                      .gear_names = kGears,
                                      .mesh_names = kPairMesh,
                                      .center_distance_m = e.center_distance_m,
                                      .train = nullptr,
                                      .axial = nullptr,
                                      .bodies = nullptr,
                                      .model = design.limits.model,
                                      .rating = rated ? rated->rate : GearingRating{}},
                                     checks, e.notes);
  note_loss_model({e.mesh}, e.notes);
  note_pointed_teeth(e.gears, e.notes);
  if (!e.center_distance_given) {
    e.notes.emplace_back("no center_distance_mm given: the zero-backlash distance is used");
  }
  return e;
}

}  // namespace gear3k::design
