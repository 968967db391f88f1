#include "design/tolerance_limits.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "backlash/normal_backlash.hpp"
#include "design/check_scope.hpp"
#include "geometry/interference.hpp"
#include "geometry/tooth_measures.hpp"

namespace gear3k::design {

namespace {

using backlash::DeviationLimits, backlash::GearTolerances;
using geometry::GearGeometry, geometry::MeshGeometry;

double outward_sign(const GearGeometry<double>& g) {
  return g.gear.kind == geometry::GearKind::kExternal ? 1.0 : -1.0;
}

/// What deviates: the centre distance, or a dimension of a gear.
enum class Dimension { kCenterDistance, kToothThickness, kTipDiameter, kRootDiameter };
struct Variable {
  Dimension dimension{};
  std::size_t gear = 0;
};

/// Ends of a gear's dimensions, as bits of an index into its states.
constexpr std::size_t kThickBit = 1, kTipBit = 2, kRootBit = 4, kGearStates = 8;
constexpr std::size_t bit_of(Dimension dimension) {
  return dimension == Dimension::kToothThickness ? kThickBit
         : dimension == Dimension::kTipDiameter  ? kTipBit
                                                 : kRootBit;
}

bool allows_drawn(const DeviationLimits& limits) {
  return limits.lower <= 0.0 && limits.upper >= 0.0;
}

/// Least and greatest of what it is shown; NaN once it was shown one.
class RangeFinder {
 public:
  explicit RangeFinder(double nominal, bool counts) : range_{.nominal = nominal} {
    range_.least = std::numeric_limits<double>::infinity();
    range_.greatest = -range_.least;
    if (counts) add(nominal);
  }
  void add(double value) {
    if (std::isnan(value) || std::isnan(range_.least)) {
      range_.least = range_.greatest = std::numeric_limits<double>::quiet_NaN();
      return;
    }
    range_.least = std::min(range_.least, value);
    range_.greatest = std::max(range_.greatest, value);
  }
  [[nodiscard]] const BuiltRange& range() const { return range_; }

 private:
  BuiltRange range_;
};

struct BuiltGear {
  geometry::GearGeometry<double> geometry;
  geometry::ToothForm<double> form;
};

/// A gear with deviations.
///
/// The drawn gear's own tool is fed in until the tooth is as thick as asked for,
///
///   x_E = x ± A_s/(2 m tan α)    (+ external, − ring)
///
/// and root, form circle and fillet move with it; the tip circle, which is turned, moves by its own
/// deviation only.  The machining allowance q stays what the file says, a tool with thicker teeth.
/// The root circle moves by m Δx_E as ISO 21771 has it.  The form circle and the fillet of a shaped
/// ring are those that the drawn gear's cutter, the same in size, leaves: with it the root circle
/// would move by sin α/sin α_w0 of that only.  With a deviation of the root diameter the tool is as
/// deep as that says, whatever the thickness, and form circle and fillet are that tool's.
/// Source: ISO 21771 (generating profile shift); docs/theory §14.  Against KISSsoft's root, form
/// and active diameters at both limits: tests/golden/kisssoft_stage_01.toml.
BuiltGear built_gear(const BuiltGear& drawn, const GearDeviation& deviation) {
  const GearGeometry<double>& g = drawn.geometry;
  const double m = g.gear.module_m, sign = outward_sign(g);
  // Outwards, in modules.
  const double infeed = sign * deviation.tooth_thickness_m / (2.0 * m * g.angle.tan);
  geometry::Gear<double> gear = g.gear;
  gear.profile_shift += infeed;
  gear.tip_shortening += sign * (infeed - 0.5 * deviation.tip_diameter_m / m);
  if (deviation.root_diameter_m) {
    gear.rack.dedendum += sign * (infeed - 0.5 * *deviation.root_diameter_m / m);
  }
  BuiltGear built{.geometry = geometry::make_gear_geometry(gear, g.angle), .form = {}};
  built.form = geometry::make_tooth_form(built.geometry);
  if (!deviation.root_diameter_m && drawn.form.cutter_tip_radius_m > 0.0) {
    GearGeometry<double> shaped = built.geometry;
    shaped.root_radius_m = built.form.cutter_center_distance_m + drawn.form.cutter_tip_radius_m;
    built.form = geometry::make_tooth_form(shaped);
  }
  return built;
}

/// A gearing that can be put into any corner of its tolerances.
class BuiltGearing {
 public:
  BuiltGearing(const DrawnGearing& drawn, std::span<const GearTolerances> tolerances,
               const DeviationLimits& center_distance_m)
      : drawn_(drawn),
        tolerances_(tolerances),
        center_distance_m_(center_distance_m),
        forms_(drawn.forms.begin(), drawn.forms.end()),
        j_bn_(drawn.mesh_gears.size()),
        states_(drawn.gears.size()) {
    if (drawn.train != nullptr) train_ = *drawn.train;
    for (std::size_t i = 0; i < drawn.gears.size(); ++i) {
      const GearTolerances& t = tolerances[i];
      for (std::size_t state = 0; state < kGearStates; ++state) {
        const auto end = [&](const DeviationLimits& limits, std::size_t bit) {
          return (state & bit) != 0 ? limits.upper : limits.lower;
        };
        GearDeviation deviation{.tooth_thickness_m = end(t.tooth_thickness_m, kThickBit),
                                .tip_diameter_m = end(t.tip_diameter_m, kTipBit),
                                .root_diameter_m = {}};
        if (t.root_diameter_m) {
          deviation.root_diameter_m = end(*t.root_diameter_m, kRootBit);
        } else if ((state & kRootBit) != 0) {
          break;
        }
        states_[i][state] = built_gear({drawn.gears[i], drawn.forms[i]}, deviation);
      }
    }
    set_gears_drawn();
  }

  /// Whether every mesh has a working angle at both ends of the centre distance.
  [[nodiscard]] bool meshes_everywhere() {
    return set_center_distance(drawn_.center_distance_m + center_distance_m_.lower) &&
           set_center_distance(drawn_.center_distance_m + center_distance_m_.upper);
  }

  /// Range of a value of this gearing over the corners of some variables, the others as drawn.
  /// @param value  as many numbers of a const BuiltGearing& wherever it is called
  template <class Value>
  std::vector<BuiltRange> ranges(std::span<const Variable> variables, Value value) {
    set_drawn();
    const auto nominal = value(*this);
    const bool counts = allow_drawn(variables);
    std::vector<RangeFinder> finders;
    finders.reserve(nominal.size());
    for (const double x : nominal) finders.emplace_back(x, counts);
    const std::size_t corners = std::size_t{1} << variables.size();
    for (std::size_t corner = 0; corner < corners; ++corner) {
      set_corner(variables, corner);
      const auto values = value(*this);
      for (std::size_t i = 0; i < finders.size(); ++i) finders[i].add(values[i]);
    }
    std::vector<BuiltRange> result(finders.size());
    std::ranges::transform(finders, result.begin(), &RangeFinder::range);
    return result;
  }

  [[nodiscard]] const GearGeometry<double>& gear(std::size_t i) const { return train_.gears[i]; }
  [[nodiscard]] const geometry::ToothForm<double>& form(std::size_t i) const { return forms_[i]; }
  [[nodiscard]] const MeshGeometry<double>& mesh(std::size_t k) const { return train_.meshes[k]; }
  [[nodiscard]] double normal_backlash_m(std::size_t k) const { return j_bn_[k]; }
  [[nodiscard]] double lost_motion_rad() const {
    return backlash::output_lost_motion(train_, {j_bn_[0], j_bn_[1], j_bn_[2]},
                                        backlash::LostMotionModel::kKinematic);
  }
  [[nodiscard]] Gearing<double> gearing() const {
    return {.gears = std::span(train_.gears).first(drawn_.gears.size()),
            .meshes = std::span(train_.meshes).first(drawn_.mesh_gears.size()),
            .mesh_gears = drawn_.mesh_gears,
            .normal_backlash_m = j_bn_,
            .forms = forms_,
            .train = drawn_.train != nullptr ? &train_ : nullptr,
            .axial = drawn_.axial,
            .bodies = drawn_.bodies,
            .model = drawn_.model,
            .rating = {},
            .train_rating = nullptr,
            .thermal = drawn_.thermal};
  }

  /// Variables of these gears and, if asked for, of the centre distance.
  [[nodiscard]] std::vector<Variable> variables(std::span<const int> gears,
                                                bool with_distance) const {
    std::vector<Variable> result;
    if (with_distance) result.push_back({.dimension = Dimension::kCenterDistance});
    for (const int id : gears) {
      const auto i = static_cast<std::size_t>(id);
      result.push_back({.dimension = Dimension::kToothThickness, .gear = i});
      result.push_back({.dimension = Dimension::kTipDiameter, .gear = i});
      if (tolerances_[i].root_diameter_m) {
        result.push_back({.dimension = Dimension::kRootDiameter, .gear = i});
      }
    }
    return without_points(std::move(result));
  }
  /// Those on which a rating of meshes of these gears depends: the tips of the others share the
  /// load out by their losses.
  [[nodiscard]] std::vector<Variable> rating_variables(std::span<const int> gears) const {
    std::vector<Variable> result = variables(gears, true);
    for (std::size_t i = 0; i < drawn_.gears.size(); ++i) {
      if (std::ranges::find(gears, static_cast<int>(i)) != gears.end()) continue;
      result.push_back({.dimension = Dimension::kTipDiameter, .gear = i});
    }
    return without_points(std::move(result));
  }
  /// Those on which backlash depends, of all gears.
  [[nodiscard]] std::vector<Variable> backlash_variables() const {
    std::vector<Variable> result{{.dimension = Dimension::kCenterDistance}};
    for (std::size_t i = 0; i < drawn_.gears.size(); ++i) {
      result.push_back({.dimension = Dimension::kToothThickness, .gear = i});
    }
    return without_points(std::move(result));
  }

 private:
  [[nodiscard]] const DeviationLimits& limits(const Variable& v) const {
    const GearTolerances& t = tolerances_[v.gear];
    switch (v.dimension) {
      case Dimension::kCenterDistance:
        break;
      case Dimension::kToothThickness:
        return t.tooth_thickness_m;
      case Dimension::kTipDiameter:
        return t.tip_diameter_m;
      case Dimension::kRootDiameter:
        return *t.root_diameter_m;
    }
    return center_distance_m_;
  }
  /// A tolerance of no width that leaves the drawing as it is has no corners.
  [[nodiscard]] std::vector<Variable> without_points(std::vector<Variable> all) const {
    std::erase_if(
        all, [&](const Variable& v) { return limits(v).lower == 0.0 && limits(v).upper == 0.0; });
    return all;
  }
  [[nodiscard]] bool allow_drawn(std::span<const Variable> variables) const {
    return std::ranges::all_of(variables,
                               [&](const Variable& v) { return allows_drawn(limits(v)); });
  }

  bool set_center_distance(double d_m) {
    train_.center_distance_m = d_m;
    for (std::size_t k = 0; k < drawn_.mesh_gears.size(); ++k) {
      const auto [first, second] = drawn_.mesh_gears[k];
      const GearGeometry<double>& a = train_.gears[static_cast<std::size_t>(first)];
      const GearGeometry<double>& b = train_.gears[static_cast<std::size_t>(second)];
      const auto mesh = geometry::make_mesh_geometry(a, b, d_m);
      if (!mesh) return false;
      train_.meshes[k] = *mesh;
      j_bn_[k] = backlash::normal_backlash(a, b, *mesh);
    }
    return true;
  }
  void set_gears_drawn() {
    std::ranges::copy(drawn_.gears, train_.gears.begin());
    std::ranges::copy(drawn_.forms, forms_.begin());
  }
  void set_drawn() {
    set_gears_drawn();
    set_center_distance(drawn_.center_distance_m);
  }
  void set_corner(std::span<const Variable> variables, std::size_t corner) {
    constexpr std::size_t kDrawn = kGearStates;
    std::array<std::size_t, train::kGearCount> state{};
    state.fill(kDrawn);
    double d_m = drawn_.center_distance_m;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      const Variable& v = variables[i];
      const bool upper = (corner >> i & 1U) != 0;
      if (v.dimension == Dimension::kCenterDistance) {
        d_m += upper ? center_distance_m_.upper : center_distance_m_.lower;
        continue;
      }
      std::size_t& s = state[v.gear];
      if (s == kDrawn) s = 0;
      if (upper) s |= bit_of(v.dimension);
    }
    set_gears_drawn();
    for (std::size_t i = 0; i < drawn_.gears.size(); ++i) {
      if (state[i] == kDrawn) continue;
      train_.gears[i] = states_[i][state[i]].geometry;
      forms_[i] = states_[i][state[i]].form;
    }
    set_center_distance(d_m);
  }

  const DrawnGearing& drawn_;
  std::span<const GearTolerances> tolerances_;
  DeviationLimits center_distance_m_;
  train::TrainGeometry<double> train_{};  ///< of a pair: its gears and its mesh in the first places
  std::vector<geometry::ToothForm<double>> forms_;
  std::vector<double> j_bn_;
  std::vector<std::array<BuiltGear, kGearStates>> states_;
};

/// Centre distance at which these teeth, thinned as they are, have no backlash; NaN without one.
double backlash_free_distance(GearGeometry<double> gear1, GearGeometry<double> gear2) {
  for (GearGeometry<double>* g : {&gear1, &gear2}) {
    g->gear.profile_shift = geometry::infeed(*g).profile_shift;
  }
  return geometry::zero_backlash_center_distance(gear1, gear2)
      .value_or(std::numeric_limits<double>::quiet_NaN());
}

MeshLimits mesh_limits(BuiltGearing& built, const DrawnGearing& drawn, std::size_t k) {
  const std::array<int, 2>& pair = drawn.mesh_gears[k];
  const auto first = static_cast<std::size_t>(pair[0]);
  const auto second = static_cast<std::size_t>(pair[1]);
  const auto values = [&](const BuiltGearing& g) {
    const GearGeometry<double>& gear1 = g.gear(first);
    const GearGeometry<double>& gear2 = g.gear(second);
    const MeshGeometry<double>& mesh = g.mesh(k);
    const double j_bn = g.normal_backlash_m(k);
    std::array<double, 11> v{j_bn, j_bn / std::cos(mesh.alpha_w_rad),
                             geometry::mesh_sign(gear2.gear.kind) *
                                 (mesh.center_distance_m - backlash_free_distance(gear1, gear2)),
                             mesh.contact_ratio, mesh.alpha_w_rad};
    for (const int which : {1, 2}) {
      const auto i = static_cast<std::size_t>(which);
      const GearGeometry<double>& own = which == 1 ? gear1 : gear2;
      const auto& form = g.form(which == 1 ? first : second);
      const double length = geometry::active_root_length(gear1, gear2, mesh, which);
      const double radius = length >= 0.0 ? std::hypot(own.base_radius_m, length)
                                          : std::numeric_limits<double>::quiet_NaN();
      v[4 + i] = geometry::root_clearance(gear1, gear2, mesh, which) * own.gear.module_m;
      v[6 + i] = 2.0 * radius;
      v[8 + i] = outward_sign(own) * (radius - form.form_radius_m);
    }
    return v;
  };
  const auto r = built.ranges(built.variables(pair, true), values);
  return {
      .name = std::string(drawn.mesh_names[k]),
      .gear_names = {std::string(drawn.gear_names[first]), std::string(drawn.gear_names[second])},
      .normal_backlash_m = r[0],
      .circumferential_backlash_m = r[1],
      .radial_backlash_m = r[2],
      .contact_ratio = r[3],
      .working_pressure_angle_rad = r[4],
      .root_clearance_m = {r[5], r[6]},
      .active_root_diameter_m = {r[7], r[8]},
      .form_reserve_m = {r[9], r[10]}};
}

GearLimits gear_limits(BuiltGearing& built, const DrawnGearing& drawn, std::size_t i) {
  const auto values = [i](const BuiltGearing& g) {
    const GearGeometry<double>& gear = g.gear(i);
    return std::array<double, 6>{geometry::infeed(gear).profile_shift,
                                 geometry::reference_tooth_thickness(gear),
                                 2.0 * gear.tip_radius_m,
                                 2.0 * gear.root_radius_m,
                                 2.0 * g.form(i).form_radius_m,
                                 geometry::tooth_thickness(gear, gear.tip_radius_m)};
  };
  const std::array<int, 1> self{static_cast<int>(i)};
  const auto r = built.ranges(built.variables(self, false), values);
  return {.name = std::string(drawn.gear_names[i]),
          .generating_shift = r[0],
          .tooth_thickness_m = r[1],
          .tip_diameter_m = r[2],
          .root_diameter_m = r[3],
          .form_diameter_m = r[4],
          .tip_thickness_m = r[5]};
}

/// The variables that the value of a check that is not rated depends on.
std::vector<Variable> variables_of(const CheckInstance& check, const BuiltGearing& built,
                                   const DrawnGearing& drawn) {
  const int member = check.subject.member;
  const CheckScope scope = check.record->scope;
  switch (target_of(scope)) {
    case CheckTarget::kGear:
      return built.variables(std::array{member}, scope == CheckScope::kPlanetStep);
    case CheckTarget::kMesh:
    case CheckTarget::kMember:
      return built.variables(drawn.mesh_gears[static_cast<std::size_t>(member)], true);
    case CheckTarget::kBodyPair: {
      const auto [first, second] = train::kPassingBodies[static_cast<std::size_t>(member)];
      if (first == train::kCarrier) return built.variables(std::array{second}, false);
      return built.variables(std::array{first, second}, true);
    }
    case CheckTarget::kTrain:
      if (scope == CheckScope::kSizedTrain) return {};
      break;
    case CheckTarget::kPlanetBearing:
    case CheckTarget::kPlanetPin:
      break;  // rated
  }
  return built.backlash_variables();
}

/// Meshes that have to be rated for a check; none where forces suffice.
std::array<bool, train::kMeshCount> meshes_rated_for(const CheckInstance& check,
                                                     const DrawnGearing& drawn) {
  std::array<bool, train::kMeshCount> rated{};
  const CheckScope scope = check.record->scope;
  if (scope != CheckScope::kRatedTooth && scope != CheckScope::kRatedMesh) return rated;
  rated[static_cast<std::size_t>(check.subject.member)] = true;
  const bool of_planet1 = rated[train::kMeshSP1] || rated[train::kMeshP1R1];
  if (check.record->id == CheckId::kToothWear && of_planet1 && drawn.train != nullptr &&
      train::g2(drawn.train->teeth) > 1.0) {
    // Both mates of P1 may wear the same flank.
    rated[train::kMeshSP1] = rated[train::kMeshP1R1] = true;
  }
  return rated;
}

/// Checks whose values are read from the same rating.
struct RatedTogether {
  std::array<bool, train::kMeshCount> rated{};
  std::vector<std::size_t> checks;
};
std::vector<RatedTogether> rated_together(std::span<const CheckInstance> checks,
                                          const DrawnGearing& drawn) {
  std::vector<RatedTogether> groups;
  for (std::size_t i = 0; i < checks.size(); ++i) {
    if (!checks[i].record->rating) continue;
    const auto rated = meshes_rated_for(checks[i], drawn);
    auto group = std::ranges::find(groups, rated, &RatedTogether::rated);
    if (group == groups.end()) {
      groups.push_back({.rated = rated, .checks = {}});
      group = groups.end() - 1;
    }
    group->checks.push_back(i);
  }
  return groups;
}

/// Whether a check is of a tooth of one of these gears.
bool rates_tooth_of(const std::array<bool, train::kGearCount>& gears, const CheckInstance& check,
                    const DrawnGearing& drawn) {
  if (check.record->scope != CheckScope::kRatedTooth) return false;
  const auto [first, second] = drawn.mesh_gears[static_cast<std::size_t>(check.subject.member)];
  return gears[static_cast<std::size_t>(check.subject.which == 1 ? first : second)];
}

/// Margins of checks, and the gears that a corner leaves no rim of.
struct CheckRanges {
  std::vector<BuiltRange> margins;
  std::array<bool, train::kGearCount> without_rim{};
};

/// Of checks that are read from the same rating.
CheckRanges rated_ranges(BuiltGearing& built, const DrawnGearing& drawn,
                         std::span<const CheckInstance> checks, const RatedTogether& group) {
  CheckRanges result;
  std::vector<int> gears;
  for (std::size_t k = 0; k < drawn.mesh_gears.size(); ++k) {
    for (const int gear : drawn.mesh_gears[k]) {
      if (group.rated[k] && std::ranges::find(gears, gear) == gears.end()) gears.push_back(gear);
    }
  }
  result.margins = built.ranges(built.rating_variables(gears), [&](const BuiltGearing& g) {
    std::vector<double> margins(group.checks.size(), std::numeric_limits<double>::quiet_NaN());
    Gearing<double> gearing = g.gearing();
    const LoadedGearing loaded = drawn.rating(gearing, group.rated);
    gearing.rating = loaded.rating.mesh;
    gearing.train_rating = &loaded.rating;
    for (std::size_t i = 0; i < margins.size(); ++i) {
      const CheckInstance& check = checks[group.checks[i]];
      if (!rates_tooth_of(loaded.without_rim, check, drawn)) {
        margins[i] = check_margin(check, gearing);
      }
    }
    std::ranges::transform(result.without_rim, loaded.without_rim, result.without_rim.begin(),
                           std::logical_or<>{});
    return margins;
  });
  return result;
}

/// Of all checks.
CheckRanges check_ranges(BuiltGearing& built, const DrawnGearing& drawn,
                         std::span<const CheckInstance> checks) {
  CheckRanges ranges{.margins = std::vector<BuiltRange>(checks.size())};
  for (std::size_t i = 0; i < checks.size(); ++i) {
    if (checks[i].record->rating) continue;
    ranges.margins[i] =
        built.ranges(variables_of(checks[i], built, drawn), [&](const BuiltGearing& g) {
          return std::array<double, 1>{check_margin(checks[i], g.gearing())};
        })[0];
  }
  for (const RatedTogether& group : rated_together(checks, drawn)) {
    const CheckRanges rated = rated_ranges(built, drawn, checks, group);
    for (std::size_t i = 0; i < group.checks.size(); ++i) {
      ranges.margins[group.checks[i]] = rated.margins[i];
    }
    std::ranges::transform(ranges.without_rim, rated.without_rim, ranges.without_rim.begin(),
                           std::logical_or<>{});
  }
  return ranges;
}

}  // namespace

std::optional<ToleranceLimits> tolerance_limits(const DrawnGearing& drawn,
                                                std::span<const GearTolerances> gears,
                                                const DeviationLimits& center_distance_m,
                                                std::span<const CheckInstance> checks) {
  BuiltGearing built(drawn, gears, center_distance_m);
  if (!built.meshes_everywhere()) return std::nullopt;
  ToleranceLimits limits;
  for (std::size_t k = 0; k < drawn.mesh_gears.size(); ++k) {
    limits.meshes.push_back(mesh_limits(built, drawn, k));
  }
  for (std::size_t i = 0; i < drawn.gears.size(); ++i) {
    limits.gears.push_back(gear_limits(built, drawn, i));
  }
  limits.checks.reserve(checks.size());
  const CheckRanges ranges = check_ranges(built, drawn, checks);
  for (std::size_t i = 0; i < checks.size(); ++i) {
    const CheckInstance& check = checks[i];
    const BuiltRange& range = ranges.margins[i];
    SubjectNames subject =
        subject_names(check, drawn.gear_names, drawn.mesh_names, drawn.mesh_gears);
    limits.checks.push_back({.record = check.record,
                             .mesh = std::move(subject.mesh),
                             .gear = std::move(subject.gear),
                             .margin = range,
                             .holds = range.least >= -kFeasibilityTolerance * check.scale});
  }
  for (std::size_t i = 0; i < drawn.gears.size(); ++i) {
    if (ranges.without_rim[i]) limits.gears_without_rim.emplace_back(drawn.gear_names[i]);
  }
  if (drawn.train != nullptr) {
    limits.lost_motion_rad = built.ranges(built.backlash_variables(), [](const BuiltGearing& g) {
      return std::array<double, 1>{g.lost_motion_rad()};
    })[0];
  }
  return limits;
}

}  // namespace gear3k::design
