#include "backlash/output_range.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace gear3k::backlash {

namespace {

/// Intersection of the planets' intervals of one sum.
struct Strip {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();

  void meet(double least, double greatest) {
    lower = std::max(lower, least);
    upper = std::min(upper, greatest);
  }
  [[nodiscard]] double width() const { return upper - lower; }
};

/// What the upper bounds hold back, or, of mirrored strips, the lower ones.
double greatest_output(const OutputLevers& l, const Strip& w, const Strip& s13, const Strip& s23) {
  const double by_s13 = s13.upper - l.sun_side * w.lower;
  const double by_s23 = s23.upper - l.ring_side * (l.ring_side > 0.0 ? w.lower : w.upper);
  const double by_both =
      (l.sun_side * s23.upper - l.ring_side * (l.ring_side > 0.0 ? s13.lower : s13.upper)) /
      l.planet;
  return std::min({by_s13, by_s23, by_both});
}

Strip mirrored(const Strip& s) { return {.lower = -s.upper, .upper = -s.lower}; }

}  // namespace

OutputLevers output_levers(const train::TrainGeometry<double>& train) {
  const auto rb = [&](train::GearId gear) { return train.gears[gear].base_radius_m; };
  const double kappa = rb(train::kP2) / rb(train::kP1);
  const double sum = rb(train::kS) + rb(train::kR1);
  return {.planet = kappa,
          .sun_side = (rb(train::kR2) + kappa * rb(train::kS)) / sum,
          .ring_side = (rb(train::kR2) - kappa * rb(train::kR1)) / sum,
          .output_m = rb(train::kR2)};
}

OutputRange output_range(const OutputLevers& levers, std::span<const PlanetPlay> planets) {
  if (planets.empty()) throw std::invalid_argument("output_range: 0 planets, allowed: at least 1");
  // Symbols as in docs/theory §33.
  const double kappa = levers.planet;
  Strip w, s13, s23;
  double margin = std::numeric_limits<double>::infinity();
  for (const auto& [u1, u2, u3] : planets) {
    w.meet(u1.lower_m + u2.lower_m, u1.upper_m + u2.upper_m);
    s13.meet(kappa * u1.lower_m + u3.lower_m, kappa * u1.upper_m + u3.upper_m);
    s23.meet(u3.lower_m - kappa * u2.upper_m, u3.upper_m - kappa * u2.lower_m);
    margin = std::min(
        {margin, u1.upper_m - u1.lower_m, u2.upper_m - u2.lower_m, u3.upper_m - u3.lower_m});
  }
  // s13 − s23 = κ w.
  margin = std::min({margin, w.width(), s13.width(), s23.width(),
                     kappa * w.upper - (s13.lower - s23.upper),
                     (s13.upper - s23.lower) - kappa * w.lower});
  return {.lower_rad =
              -greatest_output(levers, mirrored(w), mirrored(s13), mirrored(s23)) / levers.output_m,
          .upper_rad = greatest_output(levers, w, s13, s23) / levers.output_m,
          .margin_m = margin};
}

}  // namespace gear3k::backlash
