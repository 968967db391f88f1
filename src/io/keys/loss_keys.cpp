#include "io/keys/loss_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "io/keys/temperature_range.hpp"

namespace gear3k::io {

namespace {

using efficiency::FrictionLaw, units::Unit;
using Friction = design::Friction;
using Lubricant = efficiency::Lubricant<double>;
using Table = efficiency::FrictionTable;

constexpr double kDefaultTemperature_c = 20.0;

std::string_view law_name(FrictionLaw law) {
  return efficiency::kFrictionLawNames[static_cast<std::size_t>(law)];
}

/// A key that a law needs.
template <class View>
LossKey needed_key(FrictionLaw law, KeyRecord record, View view) {
  record.default_text = fmt::format("required by {}", law_name(law));
  return {.key = make_key<LossInput>(
              std::move(record), view,
              [law](const LossInput& input, std::size_t) { return input.friction.law == law; }),
          .law = law,
          .required_by_law = true};
}

/// A key that a law reads, written where it is not the default.
template <class View>
LossKey optional_key(FrictionLaw law, KeyRecord record, View view) {
  Key<LossInput> key = unless_default(make_key<LossInput>(std::move(record), view));
  key.written = [law, differs = key.written](const LossInput& input, std::size_t gear) {
    return input.friction.law == law && differs(input, gear);
  };
  return {.key = std::move(key), .law = law};
}

/// The view of a member of the friction.
template <class Member>
auto of_friction(Member Friction::*member) {
  return [member](auto& t, std::size_t) -> auto& { return t.friction.*member; };
}

void add_law_keys(std::vector<LossKey>& keys) {
  keys.push_back(
      {.key = unless_default(make_key<LossInput>(
           {.path = "friction.law",
            .type = KeyType::kChoice,
            .choices = {efficiency::kFrictionLawNames.begin(), efficiency::kFrictionLawNames.end()},
            .default_text = "\"constant\"",
            .help = "what friction depends on: nothing; load; sliding speed; load, "
                    "speed, viscosity and roughness by ISO/TR 14179-2; a table.  All "
                    "but constant need [operating_point]"},
           of_friction(&Friction::law)))});
  keys.push_back(needed_key(FrictionLaw::kLoadPower,
                            number("friction.load_exponent", Unit::kNone, within(-0.9, 2.0), "",
                                   "law load_power: n of coefficient (F/reference_force_n)^n",
                                   {design::InputKind::kLoadExponent}),
                            of_friction(&Friction::load_exponent)));
  keys.push_back(
      needed_key(FrictionLaw::kLoadPower,
                 number("friction.reference_force_n", Unit::kNewton, above(0.0, 1e7), "",
                        "law load_power: normal force on the flanks of one planet's mesh at which "
                        "friction.coefficient holds",
                        {design::InputKind::kReferenceForce}),
                 of_friction(&Friction::reference_force_N)));
  keys.push_back(needed_key(FrictionLaw::kStribeck,
                            number("friction.static_coefficient", Unit::kNone, within(0.0, 1.0), "",
                                   "law stribeck: coefficient of friction at rest; "
                                   "friction.coefficient is that at high speed",
                                   {design::InputKind::kStaticCoefficient}),
                            of_friction(&Friction::static_coefficient)));
  keys.push_back(
      needed_key(FrictionLaw::kStribeck,
                 number("friction.stribeck_speed_m_s", Unit::kMetrePerSecond, above(0.0, 1e3), "",
                        "law stribeck: mean sliding speed at which the difference has "
                        "fallen to 1/e",
                        {design::InputKind::kStribeckSpeed}),
                 of_friction(&Friction::stribeck_speed_m_s)));
  keys.push_back(
      optional_key(FrictionLaw::kStribeck,
                   number("friction.stribeck_exponent", Unit::kNone, within(0.1, 10.0),
                          "with stribeck: 1", "law stribeck: exponent of speed in the exponential",
                          {design::InputKind::kStribeckExponent}),
                   of_friction(&Friction::stribeck_exponent)));
  keys.push_back(optional_key(
      FrictionLaw::kStribeck,
      number("friction.viscous_s_per_m", Unit::kSecondPerMetre, within(0.0, 10.0),
             "with stribeck: 0", "law stribeck: rise of the coefficient per sliding speed",
             {design::InputKind::kViscousFriction}),
      of_friction(&Friction::viscous_s_m)));
}

void add_schlenk_keys(std::vector<LossKey>& keys) {
  const auto add = [&](KeyRecord record, auto view) {
    keys.push_back(needed_key(FrictionLaw::kSchlenk, std::move(record), view));
  };
  add(number("friction.roughness_um", Unit::kMicrometre, within(0.01, 100.0), "",
             "law schlenk: arithmetic mean roughness Ra, mean of both flanks",
             {design::InputKind::kRoughness}),
      of_friction(&Friction::roughness_m));
  add(number("friction.lubricant_factor", Unit::kNone, above(0.0, 10.0), "",
             "law schlenk: X_L of the lubricant", {design::InputKind::kLubricantFactor}),
      of_friction(&Friction::lubricant_factor));
  for (const std::size_t point : {0U, 1U}) {
    add(
        number(fmt::format("lubricant.temperature{}_c", point + 1), Unit::kCelsius,
               within(kColdest_C, kHottest_C), "",
               fmt::format("temperature of viscosity{}_mm2_s", point + 1),
               {design::InputKind::kLubricantTemperature, point}),
        [point](auto& t, std::size_t) -> auto& {
          return t.friction.lubricant.temperature_K[point];
        });
    add(
        number(fmt::format("lubricant.viscosity{}_mm2_s", point + 1),
               Unit::kSquareMillimetrePerSecond, within(0.3, 1e6), "",
               "kinematic viscosity of the lubricant; between the two temperatures and beyond by "
               "DIN 51563",
               {design::InputKind::kLubricantViscosity, point}),
        [point](auto& t, std::size_t) -> auto& {
          return t.friction.lubricant.viscosity_m2_s[point];
        });
  }
  add(
      number("lubricant.density_kg_m3", Unit::kKilogramPerCubicMetre, within(500.0, 2000.0), "",
             "density of the lubricant", {design::InputKind::kLubricantDensity}),
      [](auto& t, std::size_t) -> auto& { return t.friction.lubricant.density_kgm3; });
}

void add_shaft_keys(std::vector<LossKey>& keys) {
  using Drag = design::ShaftDrag<double>;
  struct Term {
    const char* name;
    Unit unit;
    double Drag::*member;
    design::InputKind input;
    const char* help;
  };
  static constexpr std::array<Term, 3> kTerms{
      {{"constant_nm", Unit::kNewtonMetre, &Drag::constant_Nm, design::InputKind::kConstantDrag,
        "torque at any speed (seal, preload)"},
       {"viscous_nms_per_rad", Unit::kViscousDrag, &Drag::viscous_Nms,
        design::InputKind::kViscousDrag, "torque per speed"},
       {"quadratic_nms2_per_rad2", Unit::kQuadraticDrag, &Drag::quadratic_Nms2,
        design::InputKind::kQuadraticDrag, "torque per speed squared (churning, windage)"}}};
  static constexpr std::array<const char*, design::kShaftCount> kOf{
      "on the sun's shaft", "on each planet, by its speed on the carrier", "on the carrier",
      "on R2 with the output"};
  for (std::size_t shaft = 0; shaft < design::kShaftCount; ++shaft) {
    for (const Term& term : kTerms) {
      keys.push_back({.key = unless_default(make_key<LossInput>(
                          number(fmt::format("drag.{}.{}", design::kShaftNames[shaft], term.name),
                                 term.unit, within(0.0, 1e4), "0",
                                 fmt::format("{} {}, whatever the load", term.help, kOf[shaft]),
                                 {term.input, shaft}),
                          [ shaft, member = term.member ](auto& t, std::size_t) -> auto& {
                            return t.shafts.drag[shaft].*member;
                          }))});
    }
  }
  // The bearing's two keys stand together.
  const auto bears = [](const LossInput& t, std::size_t) {
    return t.shafts.planet_bearing_coefficient > 0.0 || t.shafts.planet_bearing_radius_m > 0.0;
  };
  keys.push_back(
      {.key = make_key<LossInput>(
           number("bearings.planet_coefficient", Unit::kNone, within(0.0, 1.0), "none",
                  "coefficient of friction of a planet on its pin, under the "
                  "resultant of its mesh forces; with planet_radius_mm",
                  {design::InputKind::kBearingCoefficient}),
           [](auto& t, std::size_t) -> auto& { return t.shafts.planet_bearing_coefficient; },
           bears)});
  keys.push_back(
      {.key = make_key<LossInput>(
           number("bearings.planet_radius_mm", Unit::kMillimetre, within(0.0, 1e3), "none",
                  "radius at which that friction acts", {design::InputKind::kBearingRadius}),
           [](auto& t, std::size_t) -> auto& { return t.shafts.planet_bearing_radius_m; }, bears)});
}

void add_point_keys(std::vector<LossKey>& keys) {
  using Point = design::OperatingPoint<double>;
  const auto add = [&](KeyRecord record, double Point::*member) {
    keys.push_back(
        {.key = make_key<LossInput>(
             std::move(record),
             [member](auto& t, std::size_t) -> auto& { return t.operating_point.*member; },
             [](const LossInput& t, std::size_t) { return t.has_point; })});
  };
  add(number("operating_point.sun_speed_rpm", Unit::kRpm, within(0.0, 1e6), "none",
             "speed of the sun; with output_torque_nm", {design::InputKind::kSunSpeed}),
      &Point::sun_speed_rad_s);
  add(number("operating_point.output_torque_nm", Unit::kNewtonMetre, within(0.0, 1e7), "none",
             "torque at R2: of the load (forward) or of the drive (backward)",
             {design::InputKind::kOutputTorque}),
      &Point::output_torque_Nm);
  add(number("operating_point.temperature_c", Unit::kCelsius, within(kColdest_C, kHottest_C),
             fmt::format("with a point: {:g}", kDefaultTemperature_c),
             "temperature of the lubricant", {design::InputKind::kTemperature}),
      &Point::temperature_K);
}

void add_table_keys(std::vector<LossKey>& keys) {
  const auto of_table = [](std::vector<double> Table::*member) {
    return [member](auto& t, std::size_t) -> auto& { return t.friction.table.*member; };
  };
  keys.push_back(needed_key(FrictionLaw::kTable,
                            {.path = "friction.table_speed_m_s",
                             .type = KeyType::kNumbers,
                             .unit = Unit::kMetrePerSecond,
                             .min = 0.0,
                             .max = 1e3,
                             .help = "law table: mean sliding speeds, rising"},
                            of_table(&Table::sliding_speed_m_s)));
  keys.push_back(optional_key(
      FrictionLaw::kTable,
      {.path = "friction.table_force_n",
       .type = KeyType::kNumbers,
       .unit = Unit::kNewton,
       .min = 0.0,
       .max = 1e7,
       .default_text = "none",
       .help = "law table: normal forces on the flanks of one planet's mesh, rising; without it "
               "friction does not depend on load"},
      of_table(&Table::tooth_force_N)));
  keys.push_back(
      needed_key(FrictionLaw::kTable,
                 {.path = "friction.table_coefficient",
                  .type = KeyType::kNumbers,
                  .min = 0.0,
                  .max = 1.0,
                  .help = "law table: coefficients, one per speed, for each force in turn; linear "
                          "between, constant beyond"},
                 of_table(&Table::coefficient)));
}

/// An axis of the map: its range and its number of points.
struct MapAxis {
  design::GridAxis design::MapGrid::*axis;
  KeyRecord range, points;
};
std::vector<MapAxis> map_axes() {
  return {{.axis = &design::MapGrid::sun_speed_rad_s,
           .range = number_range("map.sun_speed_rpm", Unit::kRpm, above(0.0, 1e6), "[200, 1000]",
                                 "speeds of the operating map"),
           .points = integer("map.speed_points", within(2, 200), "9", "number of speeds")},
          {.axis = &design::MapGrid::output_torque_Nm,
           .range = number_range("map.output_torque_nm", Unit::kNewtonMetre, above(0.0, 1e7),
                                 "[5, 50]", "torques at R2 of the operating map"),
           .points = integer("map.torque_points", within(2, 200), "10", "number of torques")}};
}

void add_map_keys(std::vector<LossKey>& keys) {
  for (const MapAxis& a : map_axes()) {
    keys.push_back({.key = unless_default(Key<LossInput>{
                        .record = a.range,
                        .assign =
                            [axis = a.axis](const KeyRecord& r, LossInput& t, std::size_t,
                                            const TomlValue& v) {
                              design::GridAxis& grid = t.map.*axis;
                              store(r, v.list[0], grid.from);
                              store(r, v.list[1], grid.to);
                            },
                        .state =
                            [axis = a.axis](const KeyRecord& r, const LossInput& t, std::size_t) {
                              const design::GridAxis& grid = t.map.*axis;
                              return list_value({*stated(r, grid.from), *stated(r, grid.to)});
                            }})});
    keys.push_back({.key = unless_default(make_key<LossInput>(
                        a.points, [axis = a.axis](auto& t, std::size_t) -> auto& {
                          return (t.map.*axis).points;
                        }))});
  }
}

bool rising(const std::vector<double>& points) {
  return std::ranges::adjacent_find(points, std::greater_equal<>()) == points.end();
}

void check_table(const Table& table, FileReading& reading) {
  const auto check_rising = [&](const std::string& path, const std::vector<double>& points) {
    if (reading.has(path) && !rising(points)) {
      reading.error_at(path, fmt::format("{}: allowed: rising numbers", path));
    }
  };
  check_rising("friction.table_speed_m_s", table.sliding_speed_m_s);
  check_rising("friction.table_force_n", table.tooth_force_N);
  const std::size_t rows = std::max<std::size_t>(1, table.tooth_force_N.size());
  const std::size_t expected = rows * table.sliding_speed_m_s.size();
  if (reading.has("friction.table_speed_m_s") && reading.has("friction.table_coefficient") &&
      table.coefficient.size() != expected) {
    reading.error_at("friction.table_coefficient",
                     fmt::format("friction.table_coefficient: {} numbers, allowed: {} (one per "
                                 "speed, for each force in turn)",
                                 table.coefficient.size(), expected));
  }
}

/// Keys that the law does not read are errors, as are those that it lacks.
void check_law(const LossInput& input, FileReading& reading) {
  const FrictionLaw law = input.friction.law;
  const auto unread = [&](const std::string& path, FrictionLaw reader) {
    reading.error_at(path, fmt::format("{}: allowed with friction.law = \"{}\" only, it is \"{}\"",
                                       path, law_name(reader), law_name(law)));
  };
  const auto missing = [&](const KeyRecord& record) {
    reading.error_at(
        "friction.law",
        fmt::format("{} is missing, required by friction.law = \"{}\": {}; allowed: {}",
                    record.path, law_name(law), record.help, allowed_text(record)));
  };
  for (const LossKey& k : loss_keys()) {
    if (!k.law) continue;
    const bool stated = reading.stated(k.key.record.path);
    if (stated && *k.law != law) unread(k.key.record.path, *k.law);
    if (!stated && *k.law == law && k.required_by_law) missing(k.key.record);
  }
  if (law == FrictionLaw::kTable) check_table(input.friction.table, reading);
  if (!efficiency::reads_coefficient(law) && reading.stated("friction.coefficient")) {
    reading.error_at("friction.coefficient",
                     fmt::format("friction.coefficient: not read with friction.law = \"{}\", "
                                 "allowed: the law's own keys",
                                 law_name(law)));
  }
  const auto& oil = input.friction.lubricant;
  if (reading.has("lubricant.temperature1_c") && reading.has("lubricant.temperature2_c") &&
      !(oil.temperature_K[0] < oil.temperature_K[1])) {
    reading.error_at("lubricant.temperature2_c",
                     fmt::format("lubricant.temperature2_c = {:g}: allowed: above temperature1_c = "
                                 "{:g}",
                                 units::from_si(oil.temperature_K[1], Unit::kCelsius),
                                 units::from_si(oil.temperature_K[0], Unit::kCelsius)));
  }
  if (reading.has("lubricant.viscosity1_mm2_s") && reading.has("lubricant.viscosity2_mm2_s") &&
      !(oil.viscosity_m2_s[0] > oil.viscosity_m2_s[1])) {
    reading.error_at(
        "lubricant.viscosity2_mm2_s",
        fmt::format("lubricant.viscosity2_mm2_s = {:g}: allowed: below viscosity1_mm2_s = {:g} "
                    "(the lubricant thins as it warms)",
                    units::from_si(oil.viscosity_m2_s[1], Unit::kSquareMillimetrePerSecond),
                    units::from_si(oil.viscosity_m2_s[0], Unit::kSquareMillimetrePerSecond)));
  }
}

void both_or_neither(FileReading& reading, const std::string& one, const std::string& other) {
  if (reading.stated(one) == reading.stated(other)) return;
  const std::string& stated = reading.stated(one) ? one : other;
  const std::string& lacking = reading.stated(one) ? other : one;
  reading.error_at(stated, fmt::format("{} without {}: allowed: both or neither", stated, lacking));
}

}  // namespace

const std::vector<LossKey>& loss_keys() {
  static const std::vector<LossKey> keys = [] {
    std::vector<LossKey> list;
    add_law_keys(list);
    add_schlenk_keys(list);
    add_shaft_keys(list);
    add_point_keys(list);
    add_table_keys(list);
    add_map_keys(list);
    return list;
  }();
  return keys;
}

void finish_losses(const LossInput& input, design::Design& design, FileReading& reading) {
  check_law(input, reading);
  design.friction = input.friction;
  design.shafts = input.shafts;
  design.map = input.map;
  for (const MapAxis& a : map_axes()) {
    const design::GridAxis& axis = input.map.*a.axis;
    if (reading.has(a.range.path) && !(axis.from < axis.to)) {
      reading.error_at(a.range.path,
                       fmt::format("{} = [{:g}, {:g}]: allowed: from below to", a.range.path,
                                   units::from_si(axis.from, a.range.unit),
                                   units::from_si(axis.to, a.range.unit)));
    }
  }
  both_or_neither(reading, "bearings.planet_coefficient", "bearings.planet_radius_mm");
  both_or_neither(reading, "operating_point.sun_speed_rpm", "operating_point.output_torque_nm");
  const bool point = reading.stated("operating_point.sun_speed_rpm") ||
                     reading.stated("operating_point.output_torque_nm");
  if (point) design.operating_point = input.operating_point;
  if (!point && reading.stated("operating_point.temperature_c")) {
    reading.error_at("operating_point.temperature_c",
                     "operating_point.temperature_c without sun_speed_rpm and output_torque_nm: "
                     "allowed: all three");
  }
  const FrictionLaw law = input.friction.law;
  if (efficiency::depends_on_state(law) && !point) {
    reading.error_at("friction.law",
                     fmt::format("friction.law = \"{}\" without [operating_point]: allowed: with "
                                 "sun_speed_rpm and output_torque_nm, where analyze evaluates it",
                                 law_name(law)));
  }
  if (law == FrictionLaw::kSchlenk) {
    for (const std::size_t stage : {0U, 1U}) {
      if (design.masses.face_width_m[stage]) continue;
      reading.error_at("friction.law",
                       fmt::format("stage{}.face_width_mm is missing, required by friction.law = "
                                   "\"schlenk\"",
                                   stage + 1));
    }
    if (point && !(input.operating_point.sun_speed_rad_s > 0.0)) {
      reading.error_at("operating_point.sun_speed_rpm",
                       "operating_point.sun_speed_rpm = 0: allowed: above 0 with friction.law = "
                       "\"schlenk\", which has no value at rest");
    }
  }
  if (law == FrictionLaw::kLoadPower && input.friction.load_exponent < 0.0 && point &&
      !(input.operating_point.output_torque_Nm > 0.0)) {
    reading.error_at("operating_point.output_torque_nm",
                     "operating_point.output_torque_nm = 0: allowed: above 0 with a negative "
                     "friction.load_exponent, which has no value without load");
  }
}

LossInput stated_losses(const design::Design& design) {
  return {.friction = design.friction,
          .shafts = design.shafts,
          .operating_point = design.operating_point.value_or(design::OperatingPoint<double>{}),
          .has_point = design.operating_point.has_value(),
          .map = design.map};
}

}  // namespace gear3k::io
