#pragma once
// The conditions of measurements as files name them: one record for reading, ranges and reports.

#include <array>
#include <string_view>

#include "calibrate/measurement/measurement.hpp"
#include "units/units.hpp"

namespace gear3k::calibrate {

/// A condition that a file states as a number.
struct ConditionQuantity {
  std::string_view column;           ///< of a measurement file: name and unit
  std::string_view name;             ///< of the column without its unit
  std::string_view unit = {};        ///< as in the column; "" = none
  std::string_view title;            ///< in sentences
  std::string_view shown_unit = {};  ///< the unit as sentences write it
  units::Unit conversion = units::Unit::kNone;
  double Condition::*member = nullptr;  ///< null: of another type than double, or no condition

  [[nodiscard]] constexpr double si(double written) const {
    return units::to_si(written, conversion);
  }
  [[nodiscard]] constexpr double written(double si) const { return units::from_si(si, conversion); }
  /// What a file states: of a value that was read in few digits these, and no roundings.
  [[nodiscard]] double stated(double si) const { return units::decimal_from_si(si, conversion); }
};

inline constexpr ConditionQuantity kSunSpeed{.column = "sun_speed_rpm",
                                             .name = "sun_speed",
                                             .unit = "rpm",
                                             .title = "sun speed",
                                             .shown_unit = "rpm",
                                             .conversion = units::Unit::kRpm,
                                             .member = &Condition::sun_speed_rad_s};
inline constexpr ConditionQuantity kOutputTorque{.column = "output_torque_nm",
                                                 .name = "output_torque",
                                                 .unit = "nm",
                                                 .title = "output torque",
                                                 .shown_unit = "Nm",
                                                 .member = &Condition::output_torque_Nm};
inline constexpr ConditionQuantity kTemperature{.column = "temperature_c",
                                                .name = "temperature",
                                                .unit = "c",
                                                .title = "temperature",
                                                .shown_unit = "C",
                                                .conversion = units::Unit::kCelsius,
                                                .member = &Condition::temperature_K};
inline constexpr ConditionQuantity kOutputAngle{.column = "output_angle_deg",
                                                .name = "output_angle",
                                                .unit = "deg",
                                                .title = "output angle",
                                                .shown_unit = "deg",
                                                .conversion = units::Unit::kDegree,
                                                .member = &Condition::output_angle_rad};
inline constexpr ConditionQuantity kTime{.column = "time_s",
                                         .name = "time",
                                         .unit = "s",
                                         .title = "time",
                                         .shown_unit = "s",
                                         .member = &Condition::time_s};
inline constexpr ConditionQuantity kCycles{
    .column = "cycles", .name = "cycles", .title = "cycles", .member = &Condition::cycles};
inline constexpr ConditionQuantity kTestTorque{.column = "test_torque_nm",
                                               .name = "test_torque",
                                               .unit = "nm",
                                               .title = "test torque",
                                               .shown_unit = "Nm",
                                               .member = &Condition::test_torque_Nm};
/// Of a torque-angle record: of the shaft that is not locked.
inline constexpr ConditionQuantity kShaftAngle{.column = "angle_deg",
                                               .name = "angle",
                                               .unit = "deg",
                                               .title = "angle",
                                               .shown_unit = "deg",
                                               .conversion = units::Unit::kDegree,
                                               .member = &Condition::output_angle_rad};
/// The response of a torque-angle record.
inline constexpr ConditionQuantity kShaftTorque{
    .column = "torque_nm", .name = "torque", .unit = "nm", .title = "torque", .shown_unit = "Nm"};
inline constexpr ConditionQuantity kDrivingTeeth{
    .column = "driving_teeth", .name = "driving_teeth", .title = "teeth of the driver"};
inline constexpr ConditionQuantity kDrivenTeeth{
    .column = "driven_teeth", .name = "driven_teeth", .title = "teeth of the driven gear"};
inline constexpr ConditionQuantity kModule{.column = "module_mm",
                                           .name = "module",
                                           .unit = "mm",
                                           .title = "module",
                                           .shown_unit = "mm",
                                           .conversion = units::Unit::kMillimetre,
                                           .member = &Condition::module_m};

/// All of them; a model may state its range along each.
inline constexpr std::array<ConditionQuantity, 12> kConditionQuantities{
    {kSunSpeed, kOutputTorque, kTemperature, kOutputAngle, kTime, kCycles, kTestTorque, kShaftAngle,
     kShaftTorque, kDrivingTeeth, kDrivenTeeth, kModule}};

}  // namespace gear3k::calibrate
