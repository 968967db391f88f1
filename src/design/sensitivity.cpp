#include "design/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "backlash/normal_backlash.hpp"
#include "design/evaluation.hpp"
#include "design/loaded_train.hpp"
#include "design/operation.hpp"
#include "design/scalar_as.hpp"
#include "design/thermal_result.hpp"
#include "efficiency/friction_dependence.hpp"

namespace gear3k::design {

namespace {

/// The continuous inputs of a design.
template <class T>
struct Parameters {
  T pressure_angle_rad{};
  T center_distance_m{};  ///< as stated, or where the train sits
  std::array<T, 2> module_m{}, face_width_m{};
  std::array<T, train::kGearCount> profile_shift{}, machining_allowance{}, tip_shortening{};
  geometry::BasicRack<T> rack{};  ///< of the first gear
  efficiency::Friction<T> friction{};
  ShaftLosses<T> shafts{};
  OperatingPoint<T> point{};
};

/// The unit of inputs, and their step in it.
struct StepRule {
  Unit unit = Unit::kNone;
  double step = 0.01;  ///< units; of a relative step, share of the value
  bool relative = true;
};
constexpr StepRule kModules{.unit = Unit::kModules, .relative = false};
constexpr StepRule kDistance{.unit = Unit::kMillimetre, .relative = false};
constexpr StepRule kModuleLength{.unit = Unit::kMillimetre, .step = 0.001, .relative = false};
constexpr StepRule kAngle{.unit = Unit::kDegree, .step = 0.1, .relative = false};
constexpr StepRule kTemperatures{.unit = Unit::kCelsius, .step = 1.0, .relative = false};
/// A hundredth of the value.
constexpr StepRule hundredth(Unit unit) { return {.unit = unit}; }

/// Record of an input.
template <class T>
struct Input {
  InputId id;
  StepRule rule;
  T* at = nullptr;   ///< its place
  bool acts = true;  ///< a design that is otherwise as this one changes with it
};

/// What of a design decides which of its inputs act.
struct ActingLosses {
  bool load_power, stribeck, schlenk;  ///< the law
  bool coefficient;                    ///< the law reads it
  bool directional, bearing, drag, speed_drag;
  bool width_sizes;      ///< the gearbox's length, which is limited, is that of the face widths
  bool growing_bearing;  ///< the output bearing's share of the load is another by the load
};
ActingLosses acting_losses(const Design& design) {
  using efficiency::FrictionLaw;
  const FrictionLaw law = design.friction.law;
  const auto& shafts = design.shafts;
  ActingLosses acting{
      .load_power = law == FrictionLaw::kLoadPower,
      .stribeck = law == FrictionLaw::kStribeck,
      .schlenk = law == FrictionLaw::kSchlenk,
      .coefficient = efficiency::reads_coefficient(law),
      .directional = design.friction.model == efficiency::LossModel::kDirectional,
      .bearing = shafts.planet_bearing_coefficient > 0.0 && shafts.planet_bearing_radius_m > 0.0,
      .drag = false,
      .speed_drag = false,
      .width_sizes = design.limits[CheckId::kGearboxLength] && !train::whole_extent(design.axial),
      .growing_bearing = shafts.output_bearing_growth.share != 0.0 &&
                         shafts.output_bearing_growth.exponent != 0.0};
  for (const ShaftDrag<double>& d : shafts.drag) {
    if (d.viscous_Nms > 0.0 || d.quadratic_Nms2 > 0.0) acting.speed_drag = true;
    if (d.constant_Nm > 0.0) acting.drag = true;
  }
  acting.drag = acting.drag || acting.speed_drag;
  return acting;
}

/// The load under which checks are derived; null where there is none, or K_γ is that of the
/// tolerances, which has no derivatives.
const strength::RatingTask* derived_rating(const Design& design) {
  const bool drawn = design.rating && design.rating->factors.mesh_load_source ==
                                          strength::MeshLoadSource::kTolerances;
  return design.rating && !drawn ? &*design.rating : nullptr;
}

/// Every input, in the order of the file; the same list for any scalar type.
template <class T>
std::vector<Input<T>> inputs_of(const Design& design, Parameters<T>& p) {
  const ActingLosses acting = acting_losses(design);
  const bool runs = design.operating_point.has_value();
  const bool turns = runs && design.operating_point->sun_speed_rad_s > 0.0;
  const bool loaded = runs && design.operating_point->output_torque_Nm > 0.0;
  const efficiency::StateDependence by = efficiency::state_dependence(design.friction);
  const bool drag_by_temperature = acting.drag && design.shafts.drag_temperature_1_K != 0.0;
  std::vector<Input<T>> list;
  const auto add = [&](InputId id, const StepRule& rule, T& at, bool acts = true) {
    list.push_back({.id = id, .rule = rule, .at = &at, .acts = acts});
  };
  using enum InputKind;
  add({kPressureAngle}, kAngle, p.pressure_angle_rad);
  add({kCenterDistance}, kDistance, p.center_distance_m);
  add({kAddendum}, kModules, p.rack.addendum);
  add({kDedendum}, kModules, p.rack.dedendum);
  add({kRootRadius}, kModules, p.rack.root_radius);
  for (const std::size_t stage : {0U, 1U}) {
    add({kModule, stage}, kModuleLength, p.module_m[stage]);
    add({kFaceWidth, stage}, hundredth(Unit::kMillimetre), p.face_width_m[stage],
        acting.schlenk || acting.width_sizes || derived_rating(design) != nullptr);
  }
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    add({kProfileShift, i}, kModules, p.profile_shift[i]);
    add({kMachiningAllowance, i}, kModules, p.machining_allowance[i]);
    add({kTipShortening, i}, kModules, p.tip_shortening[i], !design.train.khk_tip[i]);
  }
  auto& f = p.friction;
  add({kFrictionCoefficient}, hundredth(Unit::kNone), f.coefficient, acting.coefficient);
  add({kApproachFactor}, hundredth(Unit::kNone), f.approach_factor, acting.directional);
  add({kRecessFactor}, hundredth(Unit::kNone), f.recess_factor, acting.directional);
  add({kLoadExponent}, hundredth(Unit::kNone), f.load_exponent, acting.load_power);
  add({kReferenceForce}, hundredth(Unit::kNewton), f.reference_force_N, acting.load_power);
  add({kStaticCoefficient}, hundredth(Unit::kNone), f.static_coefficient, acting.stribeck);
  add({kStribeckSpeed}, hundredth(Unit::kMetrePerSecond), f.stribeck_speed_m_s, acting.stribeck);
  add({kStribeckExponent}, hundredth(Unit::kNone), f.stribeck_exponent, acting.stribeck);
  add({kViscousFriction}, hundredth(Unit::kSecondPerMetre), f.viscous_s_m, acting.stribeck);
  add({kRoughness}, hundredth(Unit::kMicrometre), f.roughness_m, acting.schlenk);
  add({kLubricantFactor}, hundredth(Unit::kNone), f.lubricant_factor, acting.schlenk);
  for (const std::size_t i : {0U, 1U}) {
    add({kLubricantTemperature, i}, kTemperatures, f.lubricant.temperature_K[i], acting.schlenk);
    add({kLubricantViscosity, i}, hundredth(Unit::kSquareMillimetrePerSecond),
        f.lubricant.viscosity_m2_s[i], acting.schlenk);
  }
  add({kLubricantDensity}, hundredth(Unit::kKilogramPerCubicMetre), f.lubricant.density_kgm3,
      acting.schlenk);
  for (std::size_t i = 0; i < kShaftCount; ++i) {
    const ShaftDrag<double>& stated = design.shafts.drag[i];
    ShaftDrag<T>& drag = p.shafts.drag[i];
    add({kConstantDrag, i}, hundredth(Unit::kNewtonMetre), drag.constant_Nm,
        runs && stated.constant_Nm > 0.0);
    add({InputKind::kViscousDrag, i}, hundredth(Unit::kViscousDrag), drag.viscous_Nms,
        runs && stated.viscous_Nms > 0.0);
    add({InputKind::kQuadraticDrag, i}, hundredth(Unit::kQuadraticDrag), drag.quadratic_Nms2,
        runs && stated.quadratic_Nms2 > 0.0);
  }
  add({kBearingCoefficient}, hundredth(Unit::kNone), p.shafts.planet_bearing_coefficient,
      runs && acting.bearing);
  add({kBearingRadius}, hundredth(Unit::kMillimetre), p.shafts.planet_bearing_radius_m,
      runs && acting.bearing);
  add({kSunSpeed}, hundredth(Unit::kRpm), p.point.sun_speed_rad_s,
      turns && (by.speed || acting.speed_drag));
  add({kOutputTorque}, hundredth(Unit::kNewtonMetre), p.point.output_torque_Nm,
      loaded && (by.load || acting.drag || acting.growing_bearing));
  add({kTemperature}, kTemperatures, p.point.temperature_K,
      runs && (by.temperature || drag_by_temperature));
  return list;
}

/// The inputs as the design states them, with the distance at which its train sits.
Parameters<double> parameters_of(const Design& design, double center_distance_m) {
  const auto& t = design.train;
  const auto stated_width = [&](std::size_t stage) {
    const double rated = design.rating ? design.rating->face_width_m[stage] : 0.0;
    return design.masses.face_width_m[stage].value_or(rated);
  };
  return {.pressure_angle_rad = t.pressure_angle_rad,
          .center_distance_m = center_distance_m,
          .module_m = t.module_m,
          .face_width_m = {stated_width(0), stated_width(1)},
          .profile_shift = t.profile_shift,
          .machining_allowance = t.machining_allowance,
          .tip_shortening = t.tip_shortening,
          .rack = t.rack[0],
          .friction = design.friction,
          .shafts = design.shafts,
          .point = design.operating_point.value_or(OperatingPoint<double>{})};
}

/// The train for given inputs.  `center_distance_m` is the distance where it is stated; else its
/// derivatives are added to those of the zero-backlash distance.
template <class T>
train::TrainParameters<T> train_parameters(const Design& design, const Parameters<T>& p) {
  const auto& stated = design.train;
  train::TrainParameters<T> t{.teeth = stated.teeth,
                              .planets = stated.planets,
                              .pressure_angle_rad = p.pressure_angle_rad,
                              .center_distance_m = constant<T>(0.0),
                              .module_m = p.module_m,
                              .profile_shift = p.profile_shift,
                              .machining_allowance = p.machining_allowance,
                              .tip_shortening = p.tip_shortening,
                              .khk_tip = stated.khk_tip,
                              .rack = {},
                              .cutter = stated.cutter};
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const auto& first = stated.rack[0];
    const auto& own = stated.rack[i];
    t.rack[i] = {.addendum = p.rack.addendum + (own.addendum - first.addendum),
                 .dedendum = p.rack.dedendum + (own.dedendum - first.dedendum),
                 .root_radius = p.rack.root_radius + (own.root_radius - first.root_radius)};
  }
  if (design.center_distance_given) {
    t.center_distance_m = p.center_distance_m;
  } else {
    const auto gears = train::make_train_gears(t);
    const auto zero_backlash =
        geometry::zero_backlash_center_distance(gears[train::kP1], gears[train::kR1]);
    t.center_distance_m = *zero_backlash + (p.center_distance_m - value_of(p.center_distance_m));
  }
  return t;
}

template <class T>
struct Responses {
  std::array<std::optional<T>, kQuantityCount> quantity{};
  std::vector<T> margin;
  std::vector<ThermalPlay<T>> ends;  ///< of the range of temperature
};

/// The train's efficiency in a direction; empty where evaluate() has none, or it is not positive.
template <class T>
std::optional<T> train_efficiency(const LossyTrain<T>& lossy,
                                  const std::optional<OperatingPoint<T>>& point,
                                  Direction direction) {
  const bool forward = direction == Direction::kForward;
  const auto& friction = lossy.friction;
  if (efficiency::depends_on_state(friction) && !point) return std::nullopt;
  const auto mu = mesh_friction(lossy, point.value_or(OperatingPoint<T>{}), direction);
  if (!mu) return std::nullopt;
  efficiency::MeshEfficiencies<T> eta;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    if (!(value_of(lossy.geometry.meshes[k].contact_ratio) > 0.0)) return std::nullopt;
    eta[k] = efficiency::mesh_efficiency(
        efficiency::mesh_contact(lossy.geometry, static_cast<train::MeshId>(k), forward),
        efficiency::flank_friction(friction, (*mu)[k]), friction.model);
    if (!(value_of(eta[k]) > 0.0)) return std::nullopt;
  }
  const train::ToothSet& z = lossy.geometry.teeth;
  const T result =
      forward ? efficiency::forward_efficiency(z, eta) : efficiency::backward_efficiency(z, eta);
  if (!(value_of(result) > 0.0)) return std::nullopt;
  return result;
}

/// The worse drive direction of every quantity at the stated load, without the planets' masses;
/// empty where a mesh has no contact, or a gear no rim.
template <class T>
std::optional<strength::TrainRating<T>> loaded_rating(
    const Design& design, const LossyTrain<T>& lossy, std::span<const geometry::ToothForm<T>> forms,
    const std::optional<OperatingPoint<T>>& point) {
  const strength::RatingTask* task = derived_rating(design);
  if (task == nullptr) return std::nullopt;
  for (const auto& mesh : lossy.geometry.meshes) {
    if (!(value_of(mesh.contact_ratio) > 0.0)) return std::nullopt;
  }
  DirectionalFriction<T> friction =
      even_friction(efficiency::flank_friction(lossy.friction, constant<T>(0.0)),
                    efficiency::flank_friction(lossy.friction, constant<T>(0.0)));
  for (const Direction direction : {Direction::kForward, Direction::kBackward}) {
    if (efficiency::depends_on_state(lossy.friction) && !point) break;
    const auto mu = mesh_friction(lossy, point.value_or(OperatingPoint<T>{}), direction);
    for (std::size_t k = 0; mu && k < train::kMeshCount; ++k) {
      friction[direction == Direction::kForward ? 0 : 1][k] =
          efficiency::flank_friction(lossy.friction, (*mu)[k]);
    }
  }
  const auto loaded =
      loaded_train<T>(lossy.geometry, forms, lossy.face_width_m, friction, lossy.friction.model);
  if (!strength::has_rims(loaded, *task)) return std::nullopt;
  return strength::rate_train(loaded, *task, strength::Drive::kEither, constant<T>(task->torque_Nm),
                              strength::StiffnessPart::kFactors);
}

template <class T>
Responses<T> responses(const Design& design, const Parameters<T>& p,
                       const std::vector<CheckInstance>& checks) {
  const auto train = train::make_train_geometry(train_parameters(design, p));
  Responses<T> r;
  const LossyTrain<T> lossy{.geometry = *train,
                            .friction = p.friction,
                            .shafts = p.shafts,
                            .face_width_m = p.face_width_m};
  std::optional<OperatingPoint<T>> point;
  if (design.operating_point) point = p.point;
  r.quantity[kEtaForward] = train_efficiency(lossy, point, Direction::kForward);
  r.quantity[kEtaBackward] = train_efficiency(lossy, point, Direction::kBackward);
  bool in_contact = true;
  for (const auto& mesh : train->meshes) {
    in_contact = in_contact && value_of(mesh.contact_ratio) > 0.0;
  }
  if (point && in_contact) {
    const auto total = [&](Direction direction) -> std::optional<T> {
      const auto result = operate(lossy, *point, direction);
      return result.operation ? result.operation->efficiency : std::nullopt;
    };
    r.quantity[kTotalEtaForward] = total(Direction::kForward);
    r.quantity[kTotalEtaBackward] = total(Direction::kBackward);
  }
  const auto j_bn = backlash::normal_backlashes(*train);
  r.quantity[kLostMotion] =
      backlash::output_lost_motion(*train, j_bn, backlash::LostMotionModel::kKinematic);

  std::array<geometry::ToothForm<T>, train::kGearCount> forms;
  std::ranges::transform(train->gears, forms.begin(), geometry::make_tooth_form<T>);
  Gearing<T> gearing = gearing_of(*train, j_bn, design.limits.model);
  gearing.forms = forms;
  gearing.axial = &design.axial;
  const TrainBodies<double> stated = bodies_of(design);
  const TrainBodies<T> bodies{.bore_radius_m = stated.bore_radius_m,
                              .ring_outer_radius_m = stated.ring_outer_radius_m,
                              .ring_rim_m = stated.ring_rim_m,
                              .face_width_m = p.face_width_m,
                              .allowed_teeth = stated.allowed_teeth};
  gearing.bodies = &bodies;
  gearing.thermal = stated_range(design);
  const auto rating = loaded_rating<T>(design, lossy, forms, point);
  if (rating) {
    gearing.rating = rating->mesh;
    gearing.train_rating = &*rating;
  }
  if (gearing.thermal != nullptr) {
    for (int end = 0; end < train::end_count(*gearing.thermal); ++end) {
      r.ends.push_back(
          thermal_play(*train, *gearing.thermal, train::end_state(*gearing.thermal, end)));
    }
  }
  r.margin.reserve(checks.size());
  for (const CheckInstance& check : checks) {
    const bool known = !check.record->rating || rating;
    r.margin.push_back(known ? check_margin(check, gearing)
                             : constant<T>(std::numeric_limits<double>::quiet_NaN()));
  }
  return r;
}

std::optional<double> finite(double value) {
  return std::isfinite(value) ? std::optional(value + 0.0) : std::nullopt;  // no -0
}

/// The design's inputs that act, without derivatives.
std::vector<Sensitivity> acting_inputs(const std::vector<Input<double>>& inputs,
                                       std::size_t checks) {
  std::vector<Sensitivity> list;
  list.reserve(inputs.size());
  for (const Input<double>& input : inputs) {
    if (!input.acts) continue;
    const StepRule& rule = input.rule;
    const double value = units::from_si(*input.at, rule.unit);
    const double size = rule.relative && value != 0.0 ? std::abs(value) : 1.0;
    list.push_back({.input = input.id,
                    .unit = rule.unit,
                    .value = value,
                    .step = rule.step * size,
                    .slope = {},
                    .margin_slope = std::vector<std::optional<double>>(checks),
                    .thermal = {}});
  }
  return list;
}

/// Fills the derivatives of the inputs that act, kMaxVariables in a pass.
void derive(const Design& design, Parameters<double>& at, const std::vector<CheckInstance>& checks,
            std::vector<Sensitivity>& rows) {
  const auto values = inputs_of(design, at);
  for (std::size_t begin = 0; begin < rows.size(); begin += kMaxVariables) {
    const std::size_t end = std::min(begin + kMaxVariables, rows.size());
    Parameters<Jet1> p;
    p.friction.model = design.friction.model;
    p.friction.law = design.friction.law;
    p.friction.table = design.friction.table;
    p.friction.extension = extension_as<Jet1>(design.friction.extension);
    p.shafts.output_bearing_share = constant<Jet1>(design.shafts.output_bearing_share);
    p.shafts.output_bearing_growth = growing_share_as<Jet1>(design.shafts.output_bearing_growth);
    p.shafts.drag_temperature_1_K = constant<Jet1>(design.shafts.drag_temperature_1_K);
    p.shafts.drag_reference_temperature_K = design.shafts.drag_reference_temperature_K;
    const auto jets = inputs_of(design, p);
    std::array<double, kMaxVariables> si{};
    std::size_t row = 0;
    for (std::size_t i = 0; i < jets.size(); ++i) {
      *jets[i].at = constant<Jet1>(*values[i].at);
      if (!jets[i].acts) continue;
      if (row >= begin && row < end) {
        jets[i].at->v[static_cast<Eigen::Index>(row - begin)] = 1.0;
        si[row - begin] = units::si_per(jets[i].rule.unit);
      }
      ++row;
    }
    const Responses<Jet1> r = responses(design, p, checks);
    for (std::size_t k = begin; k < end; ++k) {
      const auto slope = [&](const Jet1& jet) {
        return finite(jet.v[static_cast<Eigen::Index>(k - begin)] * si[k - begin]);
      };
      for (std::size_t q = 0; q < kQuantityCount; ++q) {
        if (r.quantity[q]) rows[k].slope[q] = slope(*r.quantity[q]);
      }
      for (const ThermalPlay<Jet1>& play : r.ends) {
        ThermalSlopes& slopes = rows[k].thermal.emplace_back();
        slopes.lost_motion = slope(play.lost_motion_rad);
        for (std::size_t m = 0; m < train::kMeshCount; ++m) {
          slopes.normal_backlash[m] = slope(play.normal_backlash_m[m]);
          slopes.least_backlash[m] = slope(play.least_backlash_m[m]);
        }
      }
      for (std::size_t c = 0; c < checks.size(); ++c) {
        // A rating takes its speed as a number: no derivatives by it.
        if (checks[c].record->rating && rows[k].input.kind == InputKind::kSunSpeed) continue;
        rows[k].margin_slope[c] = slope(r.margin[c]);
      }
    }
  }
}

/// Indices of the tightest checks that any input moves.
std::vector<std::size_t> tightest_checks(const std::vector<CheckInstance>& checks,
                                         const std::vector<double>& margin,
                                         const std::vector<Sensitivity>& rows, std::size_t count) {
  std::vector<std::size_t> order;
  order.reserve(checks.size());
  for (std::size_t c = 0; c < checks.size(); ++c) {
    const bool moves = std::ranges::any_of(
        rows, [&](const Sensitivity& s) { return s.margin_slope[c].value_or(0.0) != 0.0; });
    if (moves) order.push_back(c);
  }
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return margin[a] / checks[a].scale < margin[b] / checks[b].scale;
  });
  if (order.size() > count) order.resize(count);
  return order;
}

}  // namespace

std::optional<double> Sensitivity::effect(QuantityId quantity) const {
  const auto& s = slope[static_cast<std::size_t>(quantity)];
  return s ? std::optional(*s * step) : std::nullopt;
}

std::optional<double> Sensitivity::margin_effect(std::size_t check) const {
  const auto& s = margin_slope[check];
  return s ? std::optional(*s * step) : std::nullopt;
}

Sensitivities sensitivities(const Design& design, std::size_t tightest) {
  Sensitivities result;
  result.center_distance_given = design.center_distance_given;
  result.operating_point = design.operating_point.has_value();
  if (why_undefined(design)) return result;
  Parameters<double> at = parameters_of(design, design.train.center_distance_m);
  at.center_distance_m = train_parameters(design, at).center_distance_m;
  std::vector<CheckInstance> checks =
      list_checks(design.limits, train_layout({.planets = design.train.planets,
                                               .stage1_module_m = design.train.module_m[0],
                                               .cutter = design.train.cutter,
                                               .axial = design.axial,
                                               .bodies = bodies_of(design),
                                               .rating = derived_rating(design),
                                               .thermal = stated_range(design)}));
  // Loads that the planets' masses are part of.
  std::erase_if(checks, [&](const CheckInstance& check) {
    const CheckScope scope = check.record->scope;
    return (scope == CheckScope::kPlanetBearing || scope == CheckScope::kPlanetPin) &&
           design.rating->speed_rad_s > 0.0;
  });
  const Responses<double> r = responses(design, at, checks);
  result.value = r.quantity;
  for (int end = 0; design.thermal && end < train::end_count(*design.thermal); ++end) {
    result.ends.push_back(train::end_state(*design.thermal, end));
  }
  std::vector<Sensitivity> rows = acting_inputs(inputs_of(design, at), checks.size());
  derive(design, at, checks, rows);

  const std::vector<std::size_t> kept = tightest_checks(checks, r.margin, rows, tightest);
  for (Sensitivity& row : rows) {
    std::vector<std::optional<double>> slopes;
    slopes.reserve(kept.size());
    for (const std::size_t c : kept) slopes.push_back(row.margin_slope[c]);
    row.margin_slope = std::move(slopes);
  }
  result.checks.reserve(kept.size());
  for (const std::size_t c : kept) {
    SubjectNames subject =
        subject_names(checks[c], train::kGearNames, train::kMeshNames, train::kMeshGears);
    result.checks.push_back({.record = checks[c].record,
                             .mesh = std::move(subject.mesh),
                             .gear = std::move(subject.gear),
                             .margin = r.margin[c]});
  }
  const auto size = [](const Sensitivity& s) {
    const auto of = [&](QuantityId q) { return -std::abs(s.effect(q).value_or(0.0)); };
    return std::tuple(of(kEtaBackward), of(kEtaForward), of(kLostMotion));
  };
  std::ranges::stable_sort(rows, [&](const auto& a, const auto& b) { return size(a) < size(b); });
  result.inputs = std::move(rows);
  return result;
}

}  // namespace gear3k::design
