#include "calibrate/model/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "backlash/lost_motion.hpp"
#include "calibrate/measurement/blank_conditions.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "design/scalar_as.hpp"
#include "design/sun_torque.hpp"
#include "efficiency/coulomb_path.hpp"

namespace gear3k::calibrate {

namespace {

Scalar number(double value) { return constant<Scalar>(value); }

template <class To, class From>
To numbers(const From& from) {
  To to{};
  std::ranges::transform(from, to.begin(), number);
  return to;
}

geometry::BasicRack<Scalar> numbers_of(const geometry::BasicRack<double>& rack) {
  return {.addendum = number(rack.addendum),
          .dedendum = number(rack.dedendum),
          .root_radius = number(rack.root_radius)};
}

train::TrainParameters<Scalar> numbers_of(const train::TrainParameters<double>& p) {
  train::TrainParameters<Scalar> result;
  result.teeth = p.teeth;
  result.planets = p.planets;
  result.pressure_angle_rad = number(p.pressure_angle_rad);
  result.center_distance_m = number(p.center_distance_m);
  result.module_m = numbers<std::array<Scalar, 2>>(p.module_m);
  using PerGear = std::array<Scalar, train::kGearCount>;
  result.profile_shift = numbers<PerGear>(p.profile_shift);
  result.machining_allowance = numbers<PerGear>(p.machining_allowance);
  result.tip_shortening = numbers<PerGear>(p.tip_shortening);
  result.khk_tip = p.khk_tip;
  std::ranges::transform(p.rack, result.rack.begin(),
                         [](const auto& rack) { return numbers_of(rack); });
  result.cutter = p.cutter;
  return result;
}

/// Without the extension, which models bring.
efficiency::Friction<Scalar> numbers_of(const design::Friction& f) {
  auto result = design::friction_as<Scalar>(f);
  result.extension = {};
  return result;
}

/// Likewise.
design::ShaftLosses<Scalar> numbers_of(const design::ShaftLosses<double>& shafts) {
  auto result = design::shafts_as<Scalar>(shafts);
  result.drag_temperature_1_K = number(0.0);
  // Coefficient and radius act as their product: the arm of the bearings' friction.
  result.planet_bearing_coefficient = number(1.0);
  result.planet_bearing_radius_m =
      number(shafts.planet_bearing_coefficient * shafts.planet_bearing_radius_m);
  return result;
}

constexpr double kRoomTemperature_K = 293.15;

double temperature_of(const design::Design& design) {
  return design.operating_point ? design.operating_point->temperature_K : kRoomTemperature_K;
}

double stated_or(double value, double otherwise) {
  return std::isfinite(value) ? value : otherwise;
}

/// What the output carries beyond the torque that a row states [Nm]: what its sensor reads too
/// little, at most all of it.
Scalar more_output_torque(const Condition& c, const Modification& m) {
  if (c.reference_sensor) return Scalar(0.0);
  const double sign = c.rotation * (c.direction == design::Direction::kForward ? 1.0 : -1.0);
  Scalar more(-1.0 * (m.output_sensor.magnitude + sign * m.output_sensor.own_sign));
  // Below no load the other side would drive: such a row was not measured so.
  if (c.output_torque_Nm >= 0.0 && more.a < -c.output_torque_Nm) {
    return Scalar(-c.output_torque_Nm);
  }
  return more;
}

/// Friction torque of a black box over what it would need without: forward 1/η − 1, backward 1 − η.
Scalar black_box_torque(const BlackBox& box, const Condition& c, const Modification& m) {
  const auto& e = m.gearbox;
  const bool forward = c.direction == design::Direction::kForward;
  const Scalar load = c.output_torque_Nm + more_output_torque(c, m);
  const Scalar speed = number(c.sun_speed_rad_s);
  const Scalar temperature = number(stated_or(c.temperature_K, kRoomTemperature_K));
  const double ratio = std::abs(box.ratio);
  const double loss = forward ? 1.0 / box.efficiency_forward - 1.0 : 1.0 - box.efficiency_backward;
  const Scalar friction = loss * friction_factor(e.friction, load, speed, temperature, forward);
  using std::exp;
  const auto drag_at = [&](design::ShaftId shaft, double shaft_ratio) {
    const Scalar w = speed / shaft_ratio;
    const auto& drag = e.drag[shaft];
    return Scalar(drag.constant_Nm + drag.viscous_Nms * w + drag.quadratic_Nms2 * w * w);
  };
  // What drag and bearing of the output take has gone through the gears, or does not reach them.
  const Scalar at_output =
      drag_at(design::kOutputShaft, ratio) +
      (e.output_bearing_share + share_at(e.output_bearing_growth, load)) * load;
  const double sign = forward ? 1.0 : -1.0;
  const Scalar through = (load + sign * at_output) / ratio;
  return through * (1.0 + sign * friction) + sign * drag_at(design::kSunShaft, 1.0);
}

/// Loss per friction in approach and in recess: slopes of the exact loss where there is none.
std::array<double, 2> first_order_sides(const efficiency::MeshContact<Scalar>& contact) {
  const Scalar efficiency =
      efficiency::coulomb_path_efficiency<Scalar>(contact, {.coefficient = number(1.0),
                                                            .approach_factor = Scalar(0.0, 0),
                                                            .recess_factor = Scalar(0.0, 1)});
  return {-efficiency.v[0], -efficiency.v[1]};
}

/// Friction of a pair's flanks.
efficiency::FlankFriction<Scalar> flanks_of(const design::Friction& stated, const Modification& m) {
  efficiency::Friction<Scalar> friction = numbers_of(stated);
  friction.extension = m.gearbox.friction;
  const Scalar mu = friction.coefficient * constant_factor(friction.extension, true);
  return efficiency::flank_friction(friction, mu);
}

const geometry::BasicRack<double>& rack_of(const design::PairDesign& pair) {
  return pair.gear1.rack;
}

/// What a gearbox loses under an extension.
design::VariedLosses losses_under(const design::Extension<Scalar>& e,
                                  const efficiency::Friction<Scalar>& stated,
                                  const design::ShaftLosses<Scalar>& shafts_stated) {
  design::VariedLosses losses{.friction = stated, .shafts = shafts_stated};
  losses.friction.extension = e.friction;
  auto& shafts = losses.shafts;
  for (std::size_t i = 0; i < shafts.drag.size(); ++i) {
    auto& drag = shafts.drag[i];
    drag.constant_Nm = drag.constant_Nm + e.drag[i].constant_Nm;
    drag.viscous_Nms = drag.viscous_Nms + e.drag[i].viscous_Nms;
    drag.quadratic_Nms2 = drag.quadratic_Nms2 + e.drag[i].quadratic_Nms2;
  }
  shafts.drag_temperature_1_K = e.drag_temperature_1_K;
  shafts.drag_reference_temperature_K = e.drag_reference_temperature_K;
  shafts.planet_bearing_radius_m = shafts.planet_bearing_radius_m + e.planet_bearing_arm_m;
  shafts.output_bearing_share = shafts.output_bearing_share + e.output_bearing_share;
  shafts.output_bearing_growth = e.output_bearing_growth;
  return losses;
}

}  // namespace

Simulation::Simulation(const Subject& subject, Kind kind, std::vector<ExtendedModel> models)
    : kind_(kind), models_(std::move(models)) {
  const auto refuse = [&](const char* what) {
    throw std::invalid_argument(
        fmt::format("Simulation: {} data: {}", kKindNames[static_cast<std::size_t>(kind)], what));
  };
  if (const auto* box = std::get_if<BlackBox>(&subject)) {
    if (kind == Kind::kPairLoss) refuse("a black box has no gears");
    const bool angles = kind == Kind::kLostMotion || kind == Kind::kTorqueAngle;
    if (angles && !std::isfinite(box->backlash_rad)) refuse("a black box needs its backlash");
    subject_ = *box;
    return;
  }
  if (const auto* pair = std::get_if<design::PairDesign>(&subject)) {
    if (kind != Kind::kPairLoss) refuse("a pair is no gearbox");
    subject_ = *pair;
    return;
  }
  const auto& design = std::get<design::Design>(subject);
  if (const auto undefined = design::why_undefined(design)) refuse(undefined->message.c_str());
  Gearbox gearbox;
  gearbox.design = design;
  gearbox.parameters = numbers_of(design::resolved_parameters(design));
  gearbox.geometry = *train::make_train_geometry(gearbox.parameters);
  gearbox.fixed_geometry = *train::make_train_geometry(design::resolved_parameters(design));
  gearbox.friction = numbers_of(design.friction);
  gearbox.shafts = numbers_of(design.shafts);
  gearbox.face_width_m = {design.masses.face_width_m[0].value_or(0.0),
                          design.masses.face_width_m[1].value_or(0.0)};
  gearbox.lost_motion_rad =
      backlash::output_lost_motion(gearbox.geometry, backlash::normal_backlashes(gearbox.geometry),
                                   backlash::LostMotionModel::kKinematic);
  const bool measures_angles = kind == Kind::kLostMotion || kind == Kind::kTorqueAngle;
  if (measures_angles && !has_whole_windup(models_))
    gearbox.springs = design::elastic_train(design);
  subject_ = std::move(gearbox);
}

Modification Simulation::unmodified(const Condition& condition) const {
  Modification m;
  for (const ExtendedModel& model : models_) apply_model(model, condition, kind_, m);
  return m;
}

bool Simulation::models_cause(std::string_view id) const {
  return std::ranges::any_of(models_, [&](const ExtendedModel& model) {
    return model.kind == kind_ &&
           std::ranges::find(model.causes, id, &AppliedCause::id) != model.causes.end();
  });
}

const design::ElasticTrain* Simulation::springs() const {
  const auto* gearbox = std::get_if<Gearbox>(&subject_);
  return gearbox != nullptr && gearbox->springs ? &*gearbox->springs : nullptr;
}

const design::MapGrid* Simulation::grid() const {
  const auto* gearbox = std::get_if<Gearbox>(&subject_);
  return gearbox == nullptr ? nullptr : &gearbox->design.map;
}

double Simulation::ratio() const {
  if (const auto* box = std::get_if<BlackBox>(&subject_)) return box->ratio;
  if (const auto* gearbox = std::get_if<Gearbox>(&subject_)) {
    return train::ratio(gearbox->design.train.teeth);
  }
  return 0.0;
}

ResponseAt Simulation::sun_torques(const Modification& m) const {
  if (const auto* box = std::get_if<BlackBox>(&subject_)) {
    return [box, &m](const Condition& c) { return black_box_torque(*box, c, m); };
  }
  const auto& g = std::get<Gearbox>(subject_);
  const auto losses =
      std::make_shared<const design::VariedLosses>(losses_under(m.gearbox, g.friction, g.shafts));
  const auto temperature_K = [&g](const Condition& c) {
    return stated_or(c.temperature_K, temperature_of(g.design));
  };
  // Passes that creep towards locking are many: whether they end in a balance plain numbers tell.
  const auto balances = [&g, &m, temperature_K,
                         friction = design::friction_as<double>(losses->friction),
                         shafts = design::shafts_as<double>(losses->shafts)](const Condition& c) {
    const design::LossyTrain<double> train{.geometry = g.fixed_geometry,
                                           .friction = friction,
                                           .shafts = shafts,
                                           .face_width_m = g.face_width_m};
    return design::operate<double>(
               train,
               {.sun_speed_rad_s = c.sun_speed_rad_s,
                .output_torque_Nm = c.output_torque_Nm + value_of(more_output_torque(c, m)),
                .temperature_K = temperature_K(c)},
               c.direction)
        .operation.has_value();
  };
  const auto iterated = [&g, &m, losses, temperature_K,
                         balances](const Condition& c) -> std::optional<Scalar> {
    if (!balances(c)) return std::nullopt;
    const design::LossyTrain<Scalar> train{
        .geometry = g.geometry,
        .friction = losses->friction,
        .shafts = losses->shafts,
        .face_width_m = numbers<std::array<Scalar, 2>>(g.face_width_m)};
    const auto result =
        design::operate<Scalar>(train,
                                {.sun_speed_rad_s = number(c.sun_speed_rad_s),
                                 .output_torque_Nm = c.output_torque_Nm + more_output_torque(c, m),
                                 .temperature_K = number(temperature_K(c))},
                                c.direction);
    if (!result.operation) return std::nullopt;
    return result.operation->sun_torque_Nm;
  };
  const auto quick = std::make_shared<const design::SunTorque>(
      design::FixedTrain{.geometry = g.fixed_geometry, .face_width_m = g.face_width_m}, *losses);
  return [&m, quick, iterated, temperature_K](const Condition& c) {
    const auto torque = quick->at({.sun_speed_rad_s = c.sun_speed_rad_s,
                                   .output_torque_Nm = c.output_torque_Nm,
                                   .temperature_K = temperature_K(c)},
                                  c.direction, more_output_torque(c, m));
    return torque ? torque : iterated(c);
  };
}

std::optional<Scalar> Simulation::lost_motion(const Condition& c, const Modification& m) const {
  const auto& e = m.gearbox.lost_motion;
  Scalar rigid;
  if (const auto* box = std::get_if<BlackBox>(&subject_)) {
    rigid = number(box->backlash_rad);
  } else {
    const auto& g = std::get<Gearbox>(subject_);
    rigid = g.lost_motion_rad;
    if (!is_neutral(e.expansion_1_K, 0.0)) {
      const double warmer =
          stated_or(c.temperature_K, temperature_of(g.design)) - e.reference_temperature_K;
      train::TrainParameters<Scalar> parameters = g.parameters;
      parameters.center_distance_m =
          parameters.center_distance_m * (1.0 + e.expansion_1_K * warmer);
      const auto geometry = train::make_train_geometry(parameters);
      if (!geometry) return std::nullopt;
      rigid = backlash::output_lost_motion(*geometry, backlash::normal_backlashes(*geometry),
                                           backlash::LostMotionModel::kKinematic);
    }
  }
  // From -T to +T.
  if (const auto* elastic = springs()) {
    rigid = rigid + 2.0 * design::elastic_windup(*elastic, c.test_torque_Nm);
  }
  return Scalar(rigid + e.clearance_rad + backlash::windup(e, number(c.test_torque_Nm)));
}

const design::Friction& Simulation::stated_friction() const {
  const auto* pair = std::get_if<design::PairDesign>(&subject_);
  return pair != nullptr ? pair->friction : std::get<Gearbox>(subject_).design.friction;
}

std::array<Scalar, 2> Simulation::flank_coefficients(const Modification& m) const {
  const auto flank = flanks_of(stated_friction(), m);
  return {flank.coefficient * flank.approach_factor, flank.coefficient * flank.recess_factor};
}

std::vector<std::optional<FrictionRange>> Simulation::flank_friction(
    const std::vector<Condition>& conditions, const Modification& m) const {
  std::vector<std::optional<FrictionRange>> result(conditions.size());
  if (std::holds_alternative<BlackBox>(subject_)) return result;
  if (kind_ == Kind::kPairLoss) {
    const auto sides = flank_coefficients(m);
    const auto [least, greatest] = std::minmax({sides[0].a, sides[1].a});
    std::ranges::fill(result, FrictionRange{.least = least, .greatest = greatest});
    return result;
  }
  const auto& g = std::get<Gearbox>(subject_);
  const design::Design design = design::extended(g.design, design::extension_as<double>(m.gearbox));
  const auto& friction = design.friction;
  const auto [lower, upper] = std::minmax({friction.approach_factor * friction.extension.approach,
                                           friction.recess_factor * friction.extension.recess});
  const design::LossyTrain<double> train = design::lossy_train(design, g.fixed_geometry);
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    const Condition& c = conditions[i];
    const auto operated = design::operate<double>(
        train,
        {.sun_speed_rad_s = c.sun_speed_rad_s,
         .output_torque_Nm = c.output_torque_Nm,
         .temperature_K = stated_or(c.temperature_K, temperature_of(g.design))},
        c.direction);
    if (!operated.operation) continue;
    FrictionRange range{.least = HUGE_VAL, .greatest = -HUGE_VAL};
    for (const auto& mesh : operated.operation->mesh) {
      range.least = std::min(range.least, mesh.friction * lower);
      range.greatest = std::max(range.greatest, mesh.friction * upper);
    }
    result[i] = range;
  }
  return result;
}

Scalar Simulation::pair_loss(const Condition& c, const Modification& m) const {
  double pressure_angle_rad = 0.0;
  geometry::BasicRack<double> rack;
  if (const auto* pair = std::get_if<design::PairDesign>(&subject_)) {
    pressure_angle_rad = pair->pressure_angle_rad;
    rack = rack_of(*pair);
  } else {
    const auto& design = std::get<Gearbox>(subject_).design;
    pressure_angle_rad = design.train.pressure_angle_rad;
    rack = design.train.rack.front();
  }
  const auto angle = geometry::make_pressure_angle(pressure_angle_rad);
  const auto gear = [&](int teeth) {
    geometry::Gear<double> g{};
    g.kind = geometry::GearKind::kExternal;
    g.teeth = teeth;
    g.module_m = c.module_m > 0.0 ? c.module_m : 1e-3;
    g.rack = rack;
    return geometry::make_gear_geometry(g, angle);
  };
  const auto driver = gear(c.driving_teeth);
  const auto driven = gear(c.driven_teeth);
  const auto mesh = geometry::make_mesh_geometry(
      driver, driven, driver.reference_radius_m + driven.reference_radius_m);
  const auto contact = efficiency::contact_of(driver, driven, *mesh, true);
  const auto scalar_contact =
      efficiency::contact_in<Scalar>(contact, [](double x) { return number(x); });
  const efficiency::FlankFriction<Scalar> flanks = flanks_of(stated_friction(), m);
  const Scalar mu = flanks.coefficient;
  const efficiency::LossModel model = stated_friction().model;
  if (model == efficiency::LossModel::kCoulombPath ||
      model == efficiency::LossModel::kDirectional) {
    return 1.0 - efficiency::mesh_efficiency(scalar_contact, flanks, model);
  }
  // A model of first order in the friction stays one: the change on either side is linear too, and
  // defined for any value.
  const std::array<double, 2> side = first_order_sides(scalar_contact);
  return 1.0 - efficiency::mesh_efficiency(scalar_contact, mu, model) +
         mu * (side[0] * (flanks.approach_factor - 1.0) + side[1] * (flanks.recess_factor - 1.0));
}

ResponseAt Simulation::responses(const Modification& m) const {
  switch (kind_) {
    case Kind::kTransmission:
      return sun_torques(m);
    case Kind::kLostMotion:
    case Kind::kTorqueAngle:
      return [this, &m](const Condition& c) { return lost_motion(c, m); };
    case Kind::kPairLoss:
      break;
  }
  return [this, &m](const Condition& c) { return pair_loss(c, m); };
}

std::optional<Scalar> Simulation::response(const Condition& c, const Modification& m) const {
  return responses(m)(c);
}

bool Simulation::reads_temperature(const Modification& m) const {
  const auto& e = m.gearbox;
  switch (kind_) {
    case Kind::kTransmission: {
      const auto* gearbox = std::get_if<Gearbox>(&subject_);
      const bool by_law =
          gearbox != nullptr && gearbox->friction.law == efficiency::FrictionLaw::kSchlenk;
      return by_law || depends_on_temperature(e.friction) ||
             !is_neutral(e.drag_temperature_1_K, 0.0);
    }
    case Kind::kLostMotion:
    case Kind::kTorqueAngle:
      return !is_neutral(e.lost_motion.expansion_1_K, 0.0);
    case Kind::kPairLoss:
      break;
  }
  return false;
}

Scalar Simulation::reading(const Scalar& response, const Condition& c,
                           const Modification& m) const {
  const Scalar real = response * m.response_factor + m.added;
  if (kind_ == Kind::kPairLoss) return Scalar(1.0 - (1.0 - real) * m.sensor_gain);
  // The sun's torque acts along its rotation when it drives and against it when it is driven.
  const double sign = c.rotation * (c.direction == design::Direction::kForward ? 1.0 : -1.0);
  return Scalar(real * m.sensor_gain + sign * m.sensor_offset);
}

std::array<double, 2> Simulation::load_and_speed(const Condition& c) const {
  if (const auto* gearbox = std::get_if<Gearbox>(&subject_)) {
    const train::TrainGeometry<double> geometry =
        *train::make_train_geometry(design::resolved_parameters(gearbox->design));
    const auto result = design::operate<double>(
        design::lossy_train(gearbox->design, geometry),
        {.sun_speed_rad_s = c.sun_speed_rad_s,
         .output_torque_Nm = c.output_torque_Nm,
         .temperature_K = stated_or(c.temperature_K, temperature_of(gearbox->design))},
        c.direction);
    if (!result.operation) return {kUnknown, kUnknown};
    const auto& mesh = result.operation->mesh[train::kMeshP1R1];
    return {mesh.normal_force_N, mesh.sliding_speed_m_s};
  }
  return {c.output_torque_Nm, c.sun_speed_rad_s};
}

Occasion Simulation::occasion(const MeasurementSet& data) const {
  Occasion o{.kind = kind_, .data = &data};
  o.ratio = ratio();
  const ValueRange torque = range_of(data, &Condition::output_torque_Nm);
  const ValueRange speed = range_of(data, &Condition::sun_speed_rad_s);
  const ValueRange temperature = used_range(data, kTemperature);
  o.temperature_K = {temperature.low, temperature.high};
  if (const auto* gearbox = std::get_if<Gearbox>(&subject_)) {
    o.teeth = &gearbox->design.train.teeth;
    o.design_temperature_K = temperature_of(gearbox->design);
    o.has_drag = std::ranges::any_of(gearbox->design.shafts.drag, [](const auto& drag) {
      return drag.constant_Nm > 0.0 || drag.viscous_Nms > 0.0 || drag.quadratic_Nms2 > 0.0;
    });
  } else {
    o.load_unit = "Nm";
    o.speed_unit = "rad/s";
  }
  if (kind_ == Kind::kTransmission && !data.rows.empty()) {
    // Rows without load or at rest have no place in a law of either.
    const auto above_zero = [&](double Condition::*member) {
      double least = HUGE_VAL;
      for (const Observation& row : data.rows) {
        if (row.condition.*member > 0.0) least = std::min(least, row.condition.*member);
      }
      return std::isfinite(least) ? least : 0.0;
    };
    const auto least =
        load_and_speed({.sun_speed_rad_s = above_zero(&Condition::sun_speed_rad_s),
                        .output_torque_Nm = above_zero(&Condition::output_torque_Nm)});
    const auto most =
        load_and_speed({.sun_speed_rad_s = speed.high, .output_torque_Nm = torque.high});
    o.load = {least[0], most[0]};
    o.speed = {least[1], most[1]};
  }
  return o;
}

}  // namespace gear3k::calibrate
