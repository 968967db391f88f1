#include "io/keys/loss_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "units/units.hpp"

namespace gear3k::io {

namespace {

using efficiency::FrictionLaw;

constexpr double kCelsius = 273.15;  // 0 °C in kelvin
constexpr double kDefaultTemperatureC = 20.0;

std::string_view law_name(FrictionLaw law) {
  return efficiency::kFrictionLawNames[static_cast<std::size_t>(law)];
}

/// What a law's number is worth where it is not stated.
const LossInput& defaults() {
  static const LossInput input{};
  return input;
}

std::vector<LossNumber> law_numbers() {
  using Input = LossInput;
  std::vector<LossNumber> n;
  n.push_back({.record = {.path = "friction.load_exponent",
                          .min = -0.9,
                          .max = 2.0,
                          .default_text = "required by load_power",
                          .help = "law load_power: n of coefficient (F/reference_force_n)^n"},
               .member = [](Input& i) -> double& { return i.friction.load_exponent; },
               .law = FrictionLaw::kLoadPower,
               .required_by_law = true});
  n.push_back({.record = {.path = "friction.reference_force_n",
                          .unit = "N",
                          .min = 0.0,
                          .max = 1e7,
                          .min_excluded = true,
                          .default_text = "required by load_power",
                          .help = "law load_power: normal force on the flanks of one planet's mesh "
                                  "at which friction.coefficient holds"},
               .member = [](Input& i) -> double& { return i.friction.reference_force_N; },
               .law = FrictionLaw::kLoadPower,
               .required_by_law = true});
  n.push_back({.record = {.path = "friction.static_coefficient",
                          .min = 0.0,
                          .max = 1.0,
                          .default_text = "required by stribeck",
                          .help = "law stribeck: coefficient of friction at rest; "
                                  "friction.coefficient is that at high speed"},
               .member = [](Input& i) -> double& { return i.friction.static_coefficient; },
               .law = FrictionLaw::kStribeck,
               .required_by_law = true});
  n.push_back({.record = {.path = "friction.stribeck_speed_m_s",
                          .unit = "m/s",
                          .min = 0.0,
                          .max = 1e3,
                          .min_excluded = true,
                          .default_text = "required by stribeck",
                          .help = "law stribeck: mean sliding speed at which the difference has "
                                  "fallen to 1/e"},
               .member = [](Input& i) -> double& { return i.friction.stribeck_speed_m_s; },
               .law = FrictionLaw::kStribeck,
               .required_by_law = true});
  n.push_back({.record = {.path = "friction.stribeck_exponent",
                          .min = 0.1,
                          .max = 10.0,
                          .default_text = "with stribeck: 1",
                          .help = "law stribeck: exponent of speed in the exponential"},
               .member = [](Input& i) -> double& { return i.friction.stribeck_exponent; },
               .law = FrictionLaw::kStribeck});
  n.push_back({.record = {.path = "friction.viscous_s_per_m",
                          .unit = "s/m",
                          .min = 0.0,
                          .max = 10.0,
                          .default_text = "with stribeck: 0",
                          .help = "law stribeck: rise of the coefficient per sliding speed"},
               .member = [](Input& i) -> double& { return i.friction.viscous_s_m; },
               .law = FrictionLaw::kStribeck});
  n.push_back({.record = {.path = "friction.roughness_um",
                          .unit = "um",
                          .min = 0.0,
                          .max = 100.0,
                          .min_excluded = true,
                          .default_text = "required by schlenk",
                          .help = "law schlenk: arithmetic mean roughness Ra, mean of both flanks"},
               .member = [](Input& i) -> double& { return i.friction.roughness_m; },
               .per_unit = 1e-6,
               .law = FrictionLaw::kSchlenk,
               .required_by_law = true});
  n.push_back({.record = {.path = "friction.lubricant_factor",
                          .min = 0.0,
                          .max = 10.0,
                          .min_excluded = true,
                          .default_text = "required by schlenk",
                          .help = "law schlenk: X_L of the lubricant"},
               .member = [](Input& i) -> double& { return i.friction.lubricant_factor; },
               .law = FrictionLaw::kSchlenk,
               .required_by_law = true});
  for (const std::size_t point : {0U, 1U}) {
    n.push_back({.record = {.path = fmt::format("lubricant.temperature{}_c", point + 1),
                            .unit = "C",
                            .min = -80.0,
                            .max = 400.0,
                            .default_text = "required by schlenk",
                            .help = fmt::format("temperature of viscosity{}_mm2_s", point + 1)},
                 .member = [point](Input& i) -> double& {
                   return i.friction.lubricant.temperature_K[point];
                 },
                 .offset = kCelsius,
                 .law = FrictionLaw::kSchlenk,
                 .required_by_law = true});
    n.push_back(
        {.record = {.path = fmt::format("lubricant.viscosity{}_mm2_s", point + 1),
                    .unit = "mm2/s",
                    .min = 0.3,
                    .max = 1e6,
                    .default_text = "required by schlenk",
                    .help =
                        "kinematic viscosity of the lubricant; between the two temperatures and "
                        "beyond by DIN 51563"},
         .member = [point](Input& i) -> double& {
           return i.friction.lubricant.viscosity_m2_s[point];
         },
         .per_unit = 1e-6,
         .law = FrictionLaw::kSchlenk,
         .required_by_law = true});
  }
  n.push_back({.record = {.path = "lubricant.density_kg_m3",
                          .unit = "kg/m3",
                          .min = 0.0,
                          .max = 5000.0,
                          .min_excluded = true,
                          .default_text = "required by schlenk",
                          .help = "density of the lubricant"},
               .member = [](Input& i) -> double& { return i.friction.lubricant.density_kgm3; },
               .law = FrictionLaw::kSchlenk,
               .required_by_law = true});
  return n;
}

std::vector<LossNumber> shaft_numbers() {
  using Input = LossInput;
  struct Term {
    const char* name;
    const char* unit;
    double design::ShaftDrag<double>::*member;
    const char* help;
  };
  using Drag = design::ShaftDrag<double>;
  static constexpr std::array<Term, 3> kTerms{
      {{"constant_nm", "N m", &Drag::constant_Nm, "torque at any speed (seal, preload)"},
       {"viscous_nms_per_rad", "N m s/rad", &Drag::viscous_Nms, "torque per speed"},
       {"quadratic_nms2_per_rad2", "N m s2/rad2", &Drag::quadratic_Nms2,
        "torque per speed squared (churning, windage)"}}};
  static constexpr std::array<const char*, design::kShaftCount> kOf{
      "on the sun's shaft", "on each planet, by its speed on the carrier", "on the carrier",
      "on R2 with the output"};
  std::vector<LossNumber> n;
  for (std::size_t shaft = 0; shaft < design::kShaftCount; ++shaft) {
    for (const Term& term : kTerms) {
      n.push_back(
          {.record = {.path = fmt::format("drag.{}.{}", design::kShaftNames[shaft], term.name),
                      .unit = term.unit,
                      .min = 0.0,
                      .max = 1e4,
                      .default_text = "0",
                      .help = fmt::format("{} {}, whatever the load", term.help, kOf[shaft])},
           .member = [shaft, member = term.member](Input& i) -> double& {
             return i.shafts.drag[shaft].*member;
           }});
    }
  }
  n.push_back({.record = {.path = "bearings.planet_coefficient",
                          .min = 0.0,
                          .max = 1.0,
                          .default_text = "none",
                          .help = "coefficient of friction of a planet on its pin, under the "
                                  "resultant of its mesh forces; with planet_radius_mm"},
               .member = [](Input& i) -> double& { return i.shafts.planet_bearing_coefficient; }});
  n.push_back({.record = {.path = "bearings.planet_radius_mm",
                          .unit = "mm",
                          .min = 0.0,
                          .max = 1e3,
                          .default_text = "none",
                          .help = "radius at which that friction acts"},
               .member = [](Input& i) -> double& { return i.shafts.planet_bearing_radius_m; },
               .per_unit = units::kMillimetre});
  return n;
}

std::vector<LossNumber> point_numbers() {
  using Input = LossInput;
  std::vector<LossNumber> n;
  n.push_back({.record = {.path = "operating_point.sun_speed_rpm",
                          .unit = "rpm",
                          .min = 0.0,
                          .max = 1e6,
                          .default_text = "none",
                          .help = "speed of the sun; with output_torque_nm"},
               .member = [](Input& i) -> double& { return i.operating_point.sun_speed_rad_s; },
               .per_unit = units::kRpm});
  n.push_back({.record = {.path = "operating_point.output_torque_nm",
                          .unit = "N m",
                          .min = 0.0,
                          .max = 1e7,
                          .default_text = "none",
                          .help = "torque at R2: of the load (forward) or of the drive (backward)"},
               .member = [](Input& i) -> double& { return i.operating_point.output_torque_Nm; }});
  n.push_back({.record = {.path = "operating_point.temperature_c",
                          .unit = "C",
                          .min = -80.0,
                          .max = 400.0,
                          .default_text = fmt::format("with a point: {:g}", kDefaultTemperatureC),
                          .help = "temperature of the lubricant"},
               .member = [](Input& i) -> double& { return i.operating_point.temperature_K; },
               .offset = kCelsius});
  return n;
}

void append(std::vector<LossNumber>& to, std::vector<LossNumber> more) {
  to.reserve(to.size() + more.size());
  for (LossNumber& n : more) to.push_back(std::move(n));
}

bool rising(const std::vector<double>& points) {
  return std::ranges::adjacent_find(points, std::greater_equal<>()) == points.end();
}

void check_table(const efficiency::FrictionTable& table, FileReading& reading) {
  for (const LossList& list : loss_lists()) {
    const std::string& path = list.record.path;
    const auto& points = table.*list.member;
    if (list.member != &efficiency::FrictionTable::coefficient && reading.has(path) &&
        !rising(points)) {
      reading.error_at(path, fmt::format("{}: allowed: rising numbers", path));
    }
  }
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
  for (const LossNumber& n : loss_numbers()) {
    if (!n.law) continue;
    const bool stated = reading.stated(n.record.path);
    if (stated && *n.law != law) unread(n.record.path, *n.law);
    if (!stated && *n.law == law && n.required_by_law) missing(n.record);
  }
  for (const LossList& list : loss_lists()) {
    const bool stated = reading.stated(list.record.path);
    if (stated && law != FrictionLaw::kTable) unread(list.record.path, FrictionLaw::kTable);
    if (!stated && law == FrictionLaw::kTable && list.required) missing(list.record);
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
                                 oil.temperature_K[1] - kCelsius, oil.temperature_K[0] - kCelsius));
  }
  if (reading.has("lubricant.viscosity1_mm2_s") && reading.has("lubricant.viscosity2_mm2_s") &&
      !(oil.viscosity_m2_s[0] > oil.viscosity_m2_s[1])) {
    reading.error_at(
        "lubricant.viscosity2_mm2_s",
        fmt::format("lubricant.viscosity2_mm2_s = {:g}: allowed: below viscosity1_mm2_s = {:g} "
                    "(the lubricant thins as it warms)",
                    oil.viscosity_m2_s[1] * 1e6, oil.viscosity_m2_s[0] * 1e6));
  }
}

void both_or_neither(FileReading& reading, const std::string& one, const std::string& other) {
  if (reading.stated(one) == reading.stated(other)) return;
  const std::string& stated = reading.stated(one) ? one : other;
  const std::string& lacking = reading.stated(one) ? other : one;
  reading.error_at(stated, fmt::format("{} without {}: allowed: both or neither", stated, lacking));
}

}  // namespace

const std::vector<LossNumber>& loss_numbers() {
  static const std::vector<LossNumber> numbers = [] {
    std::vector<LossNumber> n = law_numbers();
    append(n, shaft_numbers());
    append(n, point_numbers());
    return n;
  }();
  return numbers;
}

const std::vector<LossList>& loss_lists() {
  using Table = efficiency::FrictionTable;
  static const std::vector<LossList> lists{
      {.record = {.path = "friction.table_speed_m_s",
                  .type = KeyType::kNumbers,
                  .unit = "m/s",
                  .min = 0.0,
                  .max = 1e3,
                  .default_text = "required by table",
                  .help = "law table: mean sliding speeds, rising"},
       .member = &Table::sliding_speed_m_s,
       .required = true},
      {.record = {.path = "friction.table_force_n",
                  .type = KeyType::kNumbers,
                  .unit = "N",
                  .min = 0.0,
                  .max = 1e7,
                  .default_text = "none",
                  .help = "law table: normal forces on the flanks of one planet's mesh, rising; "
                          "without it friction does not depend on load"},
       .member = &Table::tooth_force_N},
      {.record = {.path = "friction.table_coefficient",
                  .type = KeyType::kNumbers,
                  .min = 0.0,
                  .max = 1.0,
                  .default_text = "required by table",
                  .help = "law table: coefficients, one per speed, for each force in turn; linear "
                          "between, constant beyond"},
       .member = &Table::coefficient,
       .required = true}};
  return lists;
}

KeyRecord friction_law_record() {
  return {.path = "friction.law",
          .type = KeyType::kChoice,
          .choices = {efficiency::kFrictionLawNames.begin(), efficiency::kFrictionLawNames.end()},
          .default_text = "\"constant\"",
          .help =
              "what friction depends on: nothing; load; sliding speed; load, speed, viscosity "
              "and roughness by ISO/TR 14179-2; a table.  All but constant need "
              "[operating_point]"};
}

const std::vector<MapKey>& map_keys() {
  static const std::vector<MapKey> keys{{.record = {.path = "map.sun_speed_rpm",
                                                    .type = KeyType::kNumberRange,
                                                    .unit = "rpm",
                                                    .min = 0.0,
                                                    .max = 1e6,
                                                    .min_excluded = true,
                                                    .default_text = "[200, 1000]",
                                                    .help = "speeds of the operating map"},
                                         .axis = &design::MapGrid::sun_speed_rad_s,
                                         .per_unit = units::kRpm},
                                        {.record = {.path = "map.speed_points",
                                                    .type = KeyType::kInteger,
                                                    .min = 2,
                                                    .max = 200,
                                                    .default_text = "9",
                                                    .help = "number of speeds"},
                                         .axis = &design::MapGrid::sun_speed_rad_s,
                                         .points = true},
                                        {.record = {.path = "map.output_torque_nm",
                                                    .type = KeyType::kNumberRange,
                                                    .unit = "N m",
                                                    .min = 0.0,
                                                    .max = 1e7,
                                                    .min_excluded = true,
                                                    .default_text = "[5, 50]",
                                                    .help = "torques at R2 of the operating map"},
                                         .axis = &design::MapGrid::output_torque_Nm},
                                        {.record = {.path = "map.torque_points",
                                                    .type = KeyType::kInteger,
                                                    .min = 2,
                                                    .max = 200,
                                                    .default_text = "10",
                                                    .help = "number of torques"},
                                         .axis = &design::MapGrid::output_torque_Nm,
                                         .points = true}};
  return keys;
}

void finish_losses(const LossInput& input, design::Design& design, FileReading& reading) {
  check_law(input, reading);
  const auto friction = design.friction;
  design.friction = input.friction;
  design.friction.coefficient = friction.coefficient;
  design.friction.model = friction.model;
  design.friction.approach_factor = friction.approach_factor;
  design.friction.recess_factor = friction.recess_factor;
  design.shafts = input.shafts;
  design.map = input.map;
  for (const MapKey& key : map_keys()) {
    const design::GridAxis& axis = input.map.*key.axis;
    if (!key.points && reading.has(key.record.path) && !(axis.from < axis.to)) {
      reading.error_at(key.record.path,
                       fmt::format("{} = [{:g}, {:g}]: allowed: from below to", key.record.path,
                                   axis.from / key.per_unit, axis.to / key.per_unit));
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

std::string loss_text(const design::Design& design) {
  LossInput input{
      .friction = design.friction,
      .shafts = design.shafts,
      .operating_point = design.operating_point.value_or(design::OperatingPoint<double>{}),
      .map = design.map};
  LossInput without = defaults();
  const FrictionLaw law = design.friction.law;
  // Keys in the order of the records; those of one table follow each other.
  std::string text, table = "friction";
  const auto add = [&](const std::string& path, const std::string& value) {
    const auto dot = path.rfind('.');
    if (path.substr(0, dot) != table) {
      table = path.substr(0, dot);
      text += fmt::format("\n[{}]\n", table);
    }
    text += fmt::format("{} = {}\n", path.substr(dot + 1), value);
  };
  if (law != FrictionLaw::kConstant) add("friction.law", fmt::format("\"{}\"", law_name(law)));
  for (const LossList& list : loss_lists()) {
    const auto& points = input.friction.table.*list.member;
    if (law != FrictionLaw::kTable || points.empty()) continue;
    add(list.record.path, fmt::format("[{}]", fmt::join(points, ", ")));
  }
  for (const LossNumber& n : loss_numbers()) {
    const bool of_point = n.record.path.starts_with("operating_point.");
    const bool read = n.law ? *n.law == law : !of_point || design.operating_point.has_value();
    const double value = n.member(input);
    const bool stated = n.required_by_law || of_point || value != n.member(without);
    // The bearing's two keys stand together.
    const bool bearing =
        n.record.path.starts_with("bearings.") && (design.shafts.planet_bearing_coefficient > 0.0 ||
                                                   design.shafts.planet_bearing_radius_m > 0.0);
    if (!read || !(stated || bearing)) continue;
    add(n.record.path, fmt::format("{}", (value - n.offset) / n.per_unit));
  }
  for (const MapKey& key : map_keys()) {
    const design::GridAxis& axis = design.map.*key.axis;
    const design::GridAxis& usual = without.map.*key.axis;
    if (key.points && axis.points != usual.points) {
      add(key.record.path, fmt::format("{}", axis.points));
    } else if (!key.points && (axis.from != usual.from || axis.to != usual.to)) {
      add(key.record.path,
          fmt::format("[{}, {}]", axis.from / key.per_unit, axis.to / key.per_unit));
    }
  }
  return text;
}

}  // namespace gear3k::io
