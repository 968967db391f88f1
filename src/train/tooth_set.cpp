#include "train/tooth_set.hpp"

#include <fmt/format.h>

#include <numbers>
#include <numeric>
#include <stdexcept>

namespace gear3k::train {

std::array<int, kGearCount> teeth_of(const ToothSet& z) { return {z.S, z.P1, z.R1, z.P2, z.R2}; }

bool gear1_drives(MeshId mesh, bool g2_below_one, bool forward) {
  bool drives_forward = true;
  if (mesh == kMeshP1R1) drives_forward = g2_below_one;
  if (mesh == kMeshP2R2) drives_forward = !g2_below_one;
  return drives_forward == forward;
}

double g1(const ToothSet& z) { return static_cast<double>(z.R1) / z.S; }

double g2(const ToothSet& z) {
  return static_cast<double>(1LL * z.P2 * z.R1) / static_cast<double>(1LL * z.P1 * z.R2);
}

namespace {

/// zP1 zR2 − zP2 zR1, that is zP1 zR2 (1 − G2).
long long g2_gap(const ToothSet& z) { return 1LL * z.P1 * z.R2 - 1LL * z.P2 * z.R1; }

}  // namespace

double ratio(const ToothSet& z) {
  const long long gap = g2_gap(z);
  if (gap == 0 || z.S == 0) {
    throw std::invalid_argument(
        fmt::format("ratio: zP1 zR2 - zP2 zR1 = {} and zS = {}, allowed: both non-zero", gap, z.S));
  }
  return static_cast<double>((1LL * z.S + z.R1) * z.P1 * z.R2) / static_cast<double>(z.S * gap);
}

SpeedRatios speed_ratios(const ToothSet& z) {
  const double i = ratio(z);
  const double carrier = static_cast<double>(1LL * z.P1 * z.R2) / static_cast<double>(g2_gap(z));
  return {.sun = i,
          .planet = carrier * (z.P1 - z.R1) / z.P1,
          .carrier = carrier,
          .planet_rolling = static_cast<double>(z.R2) / z.P2,
          .sun_rolling = -g1(z) / g2(z)};
}

Assembly assembly(const ToothSet& z, int planets) {
  if (planets < 1) {
    throw std::invalid_argument(
        fmt::format("assembly: planets = {}, allowed: at least 1", planets));
  }
  Assembly result;
  result.equal_spacing = (z.S + z.R1) % planets == 0;
  if (!result.equal_spacing) return result;
  // Rolling P1 on R1 and P2 on R2 by 2 pi k/N around the centre turns them by different angles;
  // in units of the planet's symmetry 2 pi/lcm(zP1, zP2) the difference is k D/(N gcd).
  const long long gcd = std::gcd(z.P1, z.P2);
  const long long difference = 1LL * z.R1 * z.P2 - 1LL * z.R2 * z.P1;
  const long long period = planets * gcd;
  result.identical_planets = difference % period == 0;
  const double symmetry_rad =
      2.0 * std::numbers::pi * static_cast<double>(gcd) / static_cast<double>(1LL * z.P1 * z.P2);
  for (long long k = 0; k < planets; ++k) {
    const long long phase = ((k * difference) % period + period) % period;
    result.planet_phase_rad.push_back(symmetry_rad * static_cast<double>(phase) /
                                      static_cast<double>(period));
  }
  return result;
}

std::vector<double> mesh_phases(const ToothSet& z, MeshId mesh, int planets) {
  if (planets < 1) {
    throw std::invalid_argument(fmt::format("planets = {}, allowed: at least 1", planets));
  }
  const long long teeth = mesh == kMeshSP1 ? z.S : mesh == kMeshP1R1 ? -z.R1 : -z.R2;
  std::vector<double> phases;
  for (long long k = 0; k < planets; ++k) {
    const long long remainder = ((k * teeth) % planets + planets) % planets;
    phases.push_back(static_cast<double>(remainder) / planets);
  }
  return phases;
}

long long hunting_period_teeth(int z1, int z2) {
  return std::lcm(static_cast<long long>(z1), static_cast<long long>(z2));
}

}  // namespace gear3k::train
