#pragma once
// How the gears and the carrier of a train grow with temperature and moisture.

#include <array>

#include "geometry/gear.hpp"
#include "train/tooth_set.hpp"

namespace gear3k::train {

/// Linear strain by moisture of a part that is drawn as neither.
struct MoistureStrain {
  double dry = 0.0, wet = 0.0;
};

/// How a part grows: alike in all directions, and all of it at one temperature.
struct Growth {
  double expansion_1_K = 0.0;  ///< α, coefficient of linear expansion
  MoistureStrain swelling{};
};

/// Where a train is to work.  Gears and carrier are as drawn at the reference temperature.
struct ThermalRange {
  double least_K = 293.15, greatest_K = 293.15;
  double reference_K = 293.15;
  /// Of each gear; a ring grows by itself, whatever it is fixed in.
  std::array<Growth, kGearCount> gear{};
  Growth carrier{};  ///< of what sets the centre distance
};

enum class Moisture { kDrawn, kDry, kWet };

/// Temperature and moisture of all parts.
struct ThermalState {
  double temperature_K = 293.15;
  Moisture moisture = Moisture::kDrawn;
};

/// Size of a part over that of the drawing.
///
///   g = 1 + α (T − T_ref) + ε
///
/// ε is the strain of the state's moisture, 0 where that is as drawn.
/// Source: linear thermal expansion; docs/theory §64.
double growth_factor(const Growth& growth, double reference_K, const ThermalState& state);

/// Whether anything swells, so that dry and wet differ.
bool swells(const ThermalRange& range);

/// Ends of the range: its least and greatest temperature, where anything swells both dry and wet.
/// @param end  from 0 to end_count() − 1; the least temperature comes first, dry before wet
int end_count(const ThermalRange& range);
ThermalState end_state(const ThermalRange& range, int end);

/// A gear that has grown: module and all circles times the factor, every angle and profile shift
/// as it was.
template <class T>
geometry::GearGeometry<T> grown_gear(const geometry::GearGeometry<T>& gear, double factor);

}  // namespace gear3k::train
