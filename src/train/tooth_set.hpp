#pragma once
// Tooth numbers of a 3K train and what follows from them alone: ratio, speeds, assembly.

#include <array>
#include <compare>
#include <cstddef>
#include <string_view>
#include <vector>

namespace gear3k::train {

enum GearId { kS = 0, kP1, kR1, kP2, kR2 };
enum MeshId { kMeshSP1 = 0, kMeshP1R1, kMeshP2R2 };
inline constexpr int kGearCount = 5;
inline constexpr int kMeshCount = 3;
inline constexpr std::array<std::string_view, kGearCount> kGearNames{"S", "P1", "R1", "P2", "R2"};
inline constexpr std::array<std::string_view, kMeshCount> kMeshNames{"S-P1", "P1-R1", "P2-R2"};
/// Gear 1 and gear 2 of each mesh (gear 2 is the ring in the internal ones).
inline constexpr std::array<std::array<int, 2>, kMeshCount> kMeshGears{
    {{kS, kP1}, {kP1, kR1}, {kP2, kR2}}};
/// The gear of each mesh that turns about the main axis, and the planet step that it meets.
inline constexpr std::array<GearId, kMeshCount> kCentralGears{kS, kR1, kR2};
inline constexpr std::array<GearId, kMeshCount> kPlanetGears{kP1, kP1, kP2};
/// Whether gear 1 of a mesh is the central gear; of the internal ones it is the planet.
constexpr bool central_is_gear1(std::size_t mesh) { return mesh == kMeshSP1; }

/// Tooth numbers; those of the rings are counted positive.
struct ToothSet {
  int S = 0, P1 = 0, R1 = 0, P2 = 0, R2 = 0;
  // clang-tidy takes the 0 of a rewritten comparison for a pointer.
  auto operator<=>(const ToothSet&) const = default;  // NOLINT(modernize-use-nullptr)
};

std::array<int, kGearCount> teeth_of(const ToothSet& z);

/// Whether the driving gear is gear 1 of a mesh, in the frame of the carrier.
///
/// Forward (sun drives the train): S drives P1 always; with G2 < 1, P1 drives R1 and R2 drives P2;
/// with G2 > 1, R1 drives P1 and P2 drives R2.  Backward reverses every mesh.
/// Source: own derivation, docs/theory §6 (sign of torque times speed in the carrier frame).
bool gear1_drives(MeshId mesh, bool g2_below_one, bool forward);

/// G1 = zR1/zS.
double g1(const ToothSet& z);
/// G2 = zP2 zR1/(zP1 zR2).
double g2(const ToothSet& z);

/// Ratio of the train, ratio ≝ w_S/w_R2 = (1 + G1)/(1 − G2), from integers with one rounding.
/// Negative when the output turns against the input (G2 > 1).
/// Source: Willis relation; low-backlash paper, eq. 31.
/// @throws std::invalid_argument when zP1 zR2 = zP2 zR1: the output then stands still
double ratio(const ToothSet& z);

/// Absolute speeds over the speed of the output ring R2, with R1 at rest.
///
///   w_C/w_R2 = 1/(1 − G2),  w_P/w_R2 = (1 − zR1/zP1)/(1 − G2),  w_S/w_R2 = ratio
///
/// Source: Willis relation, docs/theory §6.
struct SpeedRatios {
  double sun, planet, carrier;  ///< over w_R2; the planet's is its absolute spin
  double planet_rolling;        ///< (w_P − w_C)/(w_R2 − w_C) = zR2/zP2, relative to the carrier
  double sun_rolling;           ///< (w_S − w_C)/(w_R2 − w_C) = −G1/G2
};
SpeedRatios speed_ratios(const ToothSet& z);

/// Assembly of N equally spaced planets.
struct Assembly {
  /// N | zS + zR1: the planets' P1 fit between sun and ring R1 at equal spacing.
  bool equal_spacing = false;
  /// equal_spacing and N gcd(zP1, zP2) | zR2 zP1 − zR1 zP2: all planets may be the same part.
  bool identical_planets = false;
  /// Angle [rad] by which P2 of planet k must be turned against P1, compared with planet 0, in
  /// [0, 2π/lcm(zP1, zP2)): the tooth symmetry of a planet repeats with that period.  All zero when
  /// the planets are identical; empty unless equal_spacing.
  std::vector<double> planet_phase_rad;
};

/// Source: own derivation, docs/theory §7.
/// @throws std::invalid_argument when planets < 1
Assembly assembly(const ToothSet& z, int planets);

/// Where in its tooth pitch one mesh stands at each of N equally spaced planets, less that of
/// planet 0, in [0, 1):
///
///   S-P1  k zS/N,  P1-R1  −k zR1/N,  P2-R2  −k zR2/N  (mod 1)
///
/// All zero: the planets mesh in step; evenly spread: their mesh forces follow one another.
/// Source: own derivation, docs/theory §7.
/// @throws std::invalid_argument when planets < 1
std::vector<double> mesh_phases(const ToothSet& z, MeshId mesh, int planets);

/// Moment on the planets about their own axes over the torque on the central gear of each mesh,
/// without losses.
///
///   λ = (zP1/zS, −zP1/zR1, −zP2/zR2)
///
/// Source: own derivation, docs/theory §24.
inline std::array<double, kMeshCount> planet_levers(const ToothSet& z) {
  return {static_cast<double>(z.P1) / z.S, -static_cast<double>(z.P1) / z.R1,
          -static_cast<double>(z.P2) / z.R2};
}

/// Number of teeth that must pass until the same two teeth meet again: lcm(z1, z2).
/// gcd(z1, z2) = 1 is a hunting-tooth mesh.
long long hunting_period_teeth(int z1, int z2);

}  // namespace gear3k::train
