#include "backlash/first_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

namespace gear3k::backlash {

namespace {

constexpr double kTogether_m = 1e-9;

/// Bounds of w, s13 and s23 of one planet, docs/theory §33.
struct Chains {
  MeshPlay w, s13, s23;
};
Chains chains_of(const OutputLevers& l, const PlanetPlay& planet) {
  const auto& [u1, u2, u3] = planet;
  return {.w = {u1.lower_m + u2.lower_m, u1.upper_m + u2.upper_m},
          .s13 = {l.planet * u1.lower_m + u3.lower_m, l.planet * u1.upper_m + u3.upper_m},
          .s23 = {u3.lower_m - l.planet * u2.upper_m, u3.upper_m - l.planet * u2.lower_m}};
}

/// The lower end is the upper end of the mirrored gearbox.
MeshPlay mirrored(const MeshPlay& play) {
  return {.lower_m = -play.upper_m, .upper_m = -play.lower_m};
}
Chains mirrored(const Chains& c) {
  return {.w = mirrored(c.w), .s13 = mirrored(c.s13), .s23 = mirrored(c.s23)};
}

using Member = MeshPlay Chains::*;

class End {
 public:
  End(const OutputLevers& levers, std::vector<Chains> planets)
      : l_(levers), planets_(std::move(planets)) {}

  [[nodiscard]] FirstContact contact() const {
    const double e = l_.sun_side;
    const double f = l_.ring_side;
    const double kappa = l_.planet;
    const double w_by_s23 = f > 0.0 ? greatest_lower(&Chains::w) : least_upper(&Chains::w);
    const double s13_of_both = f > 0.0 ? greatest_lower(&Chains::s13) : least_upper(&Chains::s13);
    const double s23 = least_upper(&Chains::s23);
    const double s13 = least_upper(&Chains::s13);
    const double w_by_s13 = greatest_lower(&Chains::w);
    const std::array<double, 3> sides{s13 - e * w_by_s13, s23 - f * w_by_s23,
                                      (e * s23 - f * s13_of_both) / kappa};
    const auto decisive = std::ranges::min_element(sides) - sides.begin();
    FirstContact result{.share = std::vector<double>(planets_.size(), 0.0), .room_m = {}};
    double w = 0.0;
    switch (decisive) {
      case 0:
        w = w_by_s13;
        add(result, 1.0, &Chains::s13, true);
        break;
      case 1:
        w = w_by_s23;
        add(result, 1.0, &Chains::s23, true);
        break;
      default:
        w = (s13_of_both - s23) / kappa;
        add(result, e / kappa, &Chains::s23, true);
        add(result, -f / kappa, &Chains::s13, !(f > 0.0));
    }
    const double output = sides[static_cast<std::size_t>(decisive)];
    for (const Chains& c : planets_) {
      result.room_m.push_back(std::max(
          0.0, std::min(c.s13.upper_m - (output + e * w), c.s23.upper_m - (output + f * w))));
    }
    return result;
  }

 private:
  [[nodiscard]] double least_upper(Member strip) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Chains& c : planets_) least = std::min(least, (c.*strip).upper_m);
    return least;
  }
  [[nodiscard]] double greatest_lower(Member strip) const {
    double greatest = -std::numeric_limits<double>::infinity();
    for (const Chains& c : planets_) greatest = std::max(greatest, (c.*strip).lower_m);
    return greatest;
  }
  /// Gives a share to the planets that hold this end of a strip.
  void add(FirstContact& result, double share, Member strip, bool upper) const {
    std::vector<std::size_t> holding;
    holding.reserve(planets_.size());
    for (std::size_t p = 0; p < planets_.size(); ++p) {
      const MeshPlay& play = planets_[p].*strip;
      const double distance =
          upper ? play.upper_m - least_upper(strip) : greatest_lower(strip) - play.lower_m;
      if (distance <= kTogether_m) holding.push_back(p);
    }
    for (const std::size_t p : holding) {
      result.share[p] += share / static_cast<double>(holding.size());
    }
  }

  OutputLevers l_;
  std::vector<Chains> planets_;
};

}  // namespace

FirstContact first_contact(const OutputLevers& levers, std::span<const PlanetPlay> planets,
                           bool greatest) {
  const OutputRange range = output_range(levers, planets);
  if (!range.assembles()) {
    throw std::invalid_argument(fmt::format(
        "first_contact: margin = {} m, allowed: at least 0 (it must assemble)", range.margin_m));
  }
  std::vector<Chains> chains;
  chains.reserve(planets.size());
  for (const PlanetPlay& planet : planets) {
    const Chains c = chains_of(levers, planet);
    chains.push_back(greatest ? c : mirrored(c));
  }
  return End(levers, std::move(chains)).contact();
}

}  // namespace gear3k::backlash
