#include "tests/wide_rig/part_laws.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace gear3k::wide_rig {

std::function<double(double)> stage_law(const std::string& law, Span torque,
                                        rig::DeterministicRandom& random) {
  const double top_Nm = torque.high;
  const double first_Nm = top_Nm * random.between(0.15, 0.5);
  const double stiffer = random.between(1.5, 5.0);  // K_2/K_1
  std::function<double(double)> wound;
  if (law == "two_stage") {
    wound = [=](double t) { return std::min(t, first_Nm) + std::max(0.0, t - first_Nm) / stiffer; };
  } else if (law == "three_stage") {
    const double second_Nm = first_Nm + (top_Nm - first_Nm) * random.between(0.3, 0.7);
    const double last = stiffer * random.between(1.2, 2.0);  // K_3/K_1
    wound = [=](double t) {
      return std::min(t, first_Nm) + std::clamp(t - first_Nm, 0.0, second_Nm - first_Nm) / stiffer +
             std::max(0.0, t - second_Nm) / last;
    };
  } else if (law == "gradual_stages") {
    wound = [=](double t) {
      return t / stiffer + (1.0 - 1.0 / stiffer) * first_Nm * std::atan(t / first_Nm);
    };
  } else {
    throw std::invalid_argument("no stages '" + law + "'");
  }
  const double whole = wound(top_Nm);
  return [=](double t) { return wound(t) / whole; };
}

std::function<double(double)> bearing_radius_law(const std::string& law,
                                                 rig::DeterministicRandom& random) {
  if (law == "torsion_shafts") {
    const double at_ten_mm = random.between(2.0, 5.0);
    return [=](double r) { return at_ten_mm * std::cbrt(r / 10.0); };
  }
  if (law == "hub_bores") {
    const double hub_mm = random.between(1.5, 4.0), share = random.between(0.1, 0.4);
    return [=](double r) { return hub_mm + share * r; };
  }
  if (law == "catalogue_bores") {
    const double share = random.between(0.2, 0.5);
    return [=](double r) {
      // Bores of deep groove ball bearings [mm].
      constexpr std::array<double, 20> kBores{2.0,  3.0,  4.0,  5.0,  6.0,  7.0,  8.0,
                                              9.0,  10.0, 12.0, 15.0, 17.0, 20.0, 25.0,
                                              30.0, 35.0, 40.0, 50.0, 60.0, 80.0};
      const auto* bore = std::ranges::lower_bound(kBores, 2.0 * share * r);
      return 0.5 * (bore == kBores.end() ? kBores.back() : *bore);
    };
  }
  throw std::invalid_argument("no bearings '" + law + "'");
}

}  // namespace gear3k::wide_rig
