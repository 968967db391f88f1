#include "io/files/measurement_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "io/files/temperature_column.hpp"
#include "io/keys/temperature_range.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io {

namespace {

using calibrate::ConditionQuantity;
using calibrate::Kind;
using calibrate::Observation;
using Column = MeasurementColumn;
using Type = MeasurementColumn::Type;

static_assert(units::si_per(units::Unit::kArcmin) ==
              calibrate::response_unit(Kind::kLostMotion).si);
static_assert(kAbsoluteZero_C == -calibrate::kTemperature.si(0.0));
constexpr double kFewestPairTeeth = 3, kMostTeeth = 2000;
constexpr std::string_view kMagnitude =
    " (speeds and torques are magnitudes; direction and rotation give the signs)";

/// A column that states a condition.
template <const ConditionQuantity& quantity>
Column condition(bool required) {
  return {.name = quantity.column,
          .unit = quantity.unit,
          .required = required,
          .conversion = quantity.conversion,
          .store = [](Observation& o, double si) { o.condition.*quantity.member = si; }};
}

/// A number that is required and not negative.
Column magnitude(Column column) {
  column.required = true;
  column.min = 0.0;
  column.hint = kMagnitude;
  return column;
}

Column sigma(std::string_view name, std::string_view unit, units::Unit conversion) {
  return {.name = name,
          .unit = unit,
          .min = 0.0,
          .ends_excluded = true,
          .hint = " (one standard deviation)",
          .conversion = conversion,
          .store = [](Observation& o, double si) { o.sigma = si; }};
}

/// Optional columns of every kind.
void append_circumstances(std::vector<Column>& columns) {
  columns.push_back(condition<calibrate::kTemperature>(false));
  columns.back().min = kAbsoluteZero_C;
  columns.back().max = kHottest_C;
  columns.back().hint = kTemperatureHint;
  columns.push_back(condition<calibrate::kCycles>(false));
  columns.back().min = 0.0;
  columns.push_back(condition<calibrate::kTime>(false));
  columns.push_back({.name = "run", .type = Type::kRun});
}

void store_response(Observation& o, double si) { o.response = si; }

std::vector<Column> transmission_columns() {
  std::vector<Column> columns{
      {.name = "direction", .type = Type::kDirection, .required = true},
      magnitude(condition<calibrate::kSunSpeed>(true)),
      magnitude(condition<calibrate::kOutputTorque>(true)),
      magnitude({.name = "sun_torque_nm", .unit = "nm", .store = store_response}),
      {.name = "rotation",
       .type = Type::kSense,
       .store = [](Observation& o, double si) { o.condition.rotation = si < 0.0 ? -1 : 1; }},
      condition<calibrate::kOutputAngle>(false),
      sigma("sigma_nm", "nm", units::Unit::kNewtonMetre)};
  append_circumstances(columns);
  return columns;
}

std::vector<Column> lost_motion_columns() {
  std::vector<Column> columns{
      condition<calibrate::kOutputAngle>(true),
      magnitude(condition<calibrate::kTestTorque>(true)),
      {.name = "lost_motion_arcmin",
       .unit = "arcmin",
       .required = true,
       .min = 0.0,
       .hint = " (a magnitude: the angle travelled between the two torques)",
       .conversion = units::Unit::kArcmin,
       .store = store_response},
      sigma("sigma_arcmin", "arcmin", units::Unit::kArcmin)};
  append_circumstances(columns);
  return columns;
}

std::vector<Column> torque_angle_columns() {
  return {condition<calibrate::kTime>(true),
          condition<calibrate::kShaftAngle>(true),
          {.name = calibrate::kShaftTorque.column,
           .unit = calibrate::kShaftTorque.unit,
           .required = true,
           .store = store_response},
          {.name = "run", .type = Type::kRun}};
}

Column module_column() {
  Column column = condition<calibrate::kModule>(false);
  column.min = 0.0;
  column.max = 100.0;
  column.ends_excluded = true;
  return column;
}

std::vector<Column> pair_loss_columns() {
  const auto teeth = [](const ConditionQuantity& quantity, void (*store)(Observation&, double)) {
    return Column{.name = quantity.column,
                  .type = Type::kInteger,
                  .required = true,
                  .min = kFewestPairTeeth,
                  .max = kMostTeeth,
                  .store = store};
  };
  std::vector<Column> columns{
      teeth(calibrate::kDrivingTeeth,
            [](Observation& o, double si) { o.condition.driving_teeth = static_cast<int>(si); }),
      teeth(calibrate::kDrivenTeeth,
            [](Observation& o, double si) { o.condition.driven_teeth = static_cast<int>(si); }),
      {.name = "loss_factor",
       .required = true,
       .min = -1.0,
       .max = 1.0,
       .ends_excluded = true,
       .hint = " (a fraction, not per cent)",
       .store = store_response},
      module_column(),
      sigma("sigma", "", units::Unit::kNone)};
  append_circumstances(columns);
  return columns;
}

/// What a column's name may end in for a unit; "" = no unit.
constexpr std::array<std::string_view, 48> kUnits{
    "",      "nm",        "mnm",  "unm",     "knm",       "nmm",     "ncm",   "kgm",
    "kgcm",  "ozin",      "inlb", "lbft",    "rpm",       "rps",     "hz",    "krpm",
    "rad_s", "rad_per_s", "rads", "deg_s",   "deg_per_s", "degs",    "rev_s", "deg",
    "rad",   "mrad",      "urad", "arcmin",  "arcsec",    "rev",     "turns", "c",
    "k",     "f",         "degc", "celsius", "kelvin",    "s",       "ms",    "us",
    "min",   "h",         "mm",   "m",       "um",        "percent", "pct",   "per_cent"};

/// Lower case, anything but letters and digits as one '_' between words.
std::string normalised(std::string_view written) {
  std::string text;
  for (const char c : written) {
    if (c >= 'A' && c <= 'Z') {
      text += static_cast<char>(c - 'A' + 'a');
    } else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      text += c;
    } else if (!text.empty() && text.back() != '_') {
      text += '_';
    }
  }
  if (!text.empty() && text.back() == '_') text.pop_back();
  return text;
}

}  // namespace

bool MeasurementColumn::allows(double written) const {
  if (!std::isfinite(written)) return false;
  if (type == Type::kSense) return written == 1.0 || written == -1.0;
  if (type == Type::kInteger && written != std::floor(written)) return false;
  return ends_excluded ? written > min && written < max : written >= min && written <= max;
}

std::string MeasurementColumn::allowed_text() const {
  switch (type) {
    case Type::kDirection:
      return "forward or backward";
    case Type::kSense:
      return "+1 or -1";
    case Type::kRun:
      return "a label";
    case Type::kNumber:
    case Type::kInteger:
      break;
  }
  std::string what = type == Type::kInteger ? "an integer" : "a finite number";
  const bool low = std::isfinite(min), high = std::isfinite(max);
  if (low && high && ends_excluded) {
    return fmt::format("{} above {} and below {}{}", what, min, max, hint);
  }
  if (low && high) return fmt::format("{}, {} to {}{}", what, min, max, hint);
  if (low) return fmt::format("{}, {} {}{}", what, ends_excluded ? "above" : "at least", min, hint);
  return what;
}

const std::vector<MeasurementColumn>& columns_of(Kind kind) {
  static const std::array<std::vector<Column>, calibrate::kKindNames.size()> kColumns{
      transmission_columns(), lost_motion_columns(), torque_angle_columns(), pair_loss_columns()};
  return kColumns[static_cast<std::size_t>(kind)];
}

MeantColumn meant_column(std::string_view written,
                         const std::vector<const MeasurementColumn*>& absent) {
  const std::string name = normalised(written);
  std::vector<std::string> names;
  names.reserve(absent.size());
  for (const Column* column : absent) {
    if (name == column->name) return {.column = column};
    names.emplace_back(column->name);
    // Counts and labels have no unit that could be another one.
    const bool has_unit =
        !column->unit.empty() || column->name == "sigma" || column->name == "loss_factor";
    std::string_view quantity = column->name;
    if (!column->unit.empty()) quantity.remove_suffix(column->unit.size() + 1);
    if (!has_unit || !name.starts_with(quantity)) continue;
    std::string_view rest = std::string_view(name).substr(quantity.size());
    if (!rest.empty() && rest.front() != '_') continue;
    if (!rest.empty()) rest.remove_prefix(1);
    if (std::ranges::find(kUnits, rest) != kUnits.end()) {
      return {.column = column, .other_unit = true};
    }
  }
  // The end of a name says which where no other that is wanted ends so.
  const auto ends_so = [&](const Column* column) {
    return column->required && column->name.ends_with("_" + name);
  };
  if (std::ranges::count_if(absent, ends_so) == 1) {
    return {.column = *std::ranges::find_if(absent, ends_so)};
  }
  const std::string near = closest_word(name, names);
  for (const Column* column : absent) {
    if (!near.empty() && column->name == near) return {.column = column};
  }
  return {};
}

}  // namespace gear3k::io
