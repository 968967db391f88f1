#pragma once
// Units at the door of the program.  Inside, everything is SI.

#include <array>
#include <cstddef>
#include <numbers>
#include <string_view>

namespace gear3k::units {

/// Units of files, tables and results.
enum class Unit {
  kNone,    ///< a number
  kModule,  ///< lengths over a module, as checks name them
  kModules,
  kMillimetre,
  kDiameterMillimetre,  ///< of a diameter whose radius is kept
  kMicrometre,
  kDegree,
  kArcmin,
  kRpm,
  kCelsius,
  kNewton,
  kNewtonPerMillimetre,
  kNewtonMetre,
  kMeshStiffness,  ///< per face width
  kTorsionalStiffness,
  kMetrePerSecond,
  kSecondPerMetre,
  kKilogram,
  kKilogramPerCubicMetre,
  kKilogramSquareMetre,
  kSquareMillimetrePerSecond,
  kViscousDrag,
  kQuadraticDrag,
  kMegapascal,
  kHour,
  kSquareMillimetre,
  kNewtonPerMicrometre,
  kWearCoefficient,
  kHousingResistance
};

/// SI value = value · factor / divisor + zero.
struct UnitRecord {
  std::string_view name;  ///< as files and tables print it; "" for kNone
  double factor = 1.0, divisor = 1.0;
  double zero = 0.0;  ///< SI value of 0
};
inline constexpr std::array<UnitRecord, 29> kUnits{
    {{.name = ""},
     {.name = "module"},
     {.name = "modules"},
     {.name = "mm", .factor = 1e-3},
     {.name = "mm", .factor = 0.5e-3},
     {.name = "um", .factor = 1e-6},
     {.name = "deg", .factor = std::numbers::pi, .divisor = 180.0},
     {.name = "arcmin", .factor = std::numbers::pi / 180.0 / 60.0},
     {.name = "rpm", .factor = std::numbers::pi / 30.0},
     {.name = "C", .zero = 273.15},
     {.name = "N"},
     {.name = "N/mm", .factor = 1e3},
     {.name = "N m"},
     {.name = "N/(mm um)", .factor = 1e9},
     {.name = "N m/rad"},
     {.name = "m/s"},
     {.name = "s/m"},
     {.name = "kg"},
     {.name = "kg/m3"},
     {.name = "kg m2"},
     {.name = "mm2/s", .factor = 1e-6},
     {.name = "N m s/rad"},
     {.name = "N m s2/rad2"},
     {.name = "MPa", .factor = 1e6},
     {.name = "h", .factor = 3600.0},
     {.name = "mm2", .factor = 1e-6},
     {.name = "N/um", .factor = 1e6},
     {.name = "mm3/(N m)", .factor = 1e-9},
     {.name = "K m2/W"}}};

constexpr const UnitRecord& record_of(Unit unit) { return kUnits[static_cast<std::size_t>(unit)]; }
constexpr std::string_view unit_name(Unit unit) { return record_of(unit).name; }
/// SI value of a difference of one unit.
constexpr double si_per(Unit unit) { return record_of(unit).factor / record_of(unit).divisor; }

constexpr double to_si(double value, Unit unit) {
  const UnitRecord& r = record_of(unit);
  const double si = value * r.factor / r.divisor;
  return r.zero == 0.0 ? si : si + r.zero;
}
/// For numbers that are shown; files are written by decimal_from_si().
constexpr double from_si(double si, Unit unit) {
  return (si - record_of(unit).zero) / si_per(unit);
}

/// A difference of two SI values in the unit: of temperatures, without the unit's zero.
constexpr double difference_from_si(double si, Unit unit) { return si / si_per(unit); }

/// The value of fewest decimal digits whose to_si() is `si` to the last bit: what a file states, so
/// that to_si(decimal_from_si(to_si(x))) = to_si(x).
///
/// A file's numbers lie on a grid of doubles in its unit, which in places is coarser than that of
/// SI: one in some forty SI lengths, drawn at random, is to_si() of no value in mm.  Of such a one
/// the value is from_si(), whose to_si() is off by one last bit.
double decimal_from_si(double si, Unit unit);

/// The SI value that a sum or product of decimal numbers means: of at most twelve digits in the
/// unit, where one is that but for rounding (four units of the last place); else `si` itself.
///
/// 2 (34.24 mm + 0.65 mm) is 69.78 mm then, not 69.77999999999999.  A value that means none is
/// taken for one, and moved by as much, in less than one of a hundred cases.
double meant_si(double si, Unit unit);

inline constexpr double kMillimetre = si_per(Unit::kMillimetre);  ///< m
inline constexpr double kMicrometre = si_per(Unit::kMicrometre);  ///< m
inline constexpr double kDegree = si_per(Unit::kDegree);          ///< rad
inline constexpr double kArcmin = si_per(Unit::kArcmin);          ///< rad
inline constexpr double kRpm = si_per(Unit::kRpm);                ///< rad/s
inline constexpr double kAbsoluteZero_c = -273.15;                ///< 0 K in degrees Celsius

}  // namespace gear3k::units
