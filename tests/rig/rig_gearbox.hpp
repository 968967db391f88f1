#pragma once

#include <array>
#include <string>
#include <vector>

namespace gear3k::rig {

/// A 3K gearbox as the rig knows it, in the units of a DESIGN file.
///
/// Gears in the order S, P1, R1, P2, R2; ring teeth and ring shifts as in the KHK convention.
struct Gearbox {
  std::string name;
  int planets = 3;
  std::array<int, 5> teeth{};
  std::array<double, 5> profile_shift{};
  std::array<double, 5> machining_allowance{};  ///< thinning of a tooth normal to the flank / m
  double module1_mm = 0.0, module2_mm = 0.0;
  double pressure_angle_deg = 20.0;
  double center_distance_mm = 0.0;
  double addendum = 1.0;  ///< of the basic rack, in modules
  double friction = 0.1;
};

/// The bilateral drive gear of the low-backlash paper (x of P2 0.536, centre distance 21.268 mm);
/// its teeth are thinned such that it has about the published 24 arcmin.
Gearbox bilateral_drive_gear();

/// The paper's proposed gear at a centre distance of 16.193 mm; a mesh lies outside the range of
/// Ohlendorf's formula.
Gearbox low_backlash_gear();

/// A gearbox whose output turns against the input (G2 > 1).
Gearbox reversing_gear();

/// The DESIGN.toml of the nominal gearbox, loss model `sliding`.
std::string design_toml(const Gearbox& gearbox);

}  // namespace gear3k::rig
