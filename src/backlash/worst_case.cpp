#include "backlash/worst_case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "numerics/square.hpp"

namespace gear3k::backlash {

namespace {

/// Linear function of the bounds of all plays: Σ coefficient · bound.
using BoundFunction = std::vector<double>;

/// a f + b g, for bounds of the same model.
BoundFunction combined(double a, const BoundFunction& f, double b, const BoundFunction& g) {
  BoundFunction sum(f.size());
  for (std::size_t i = 0; i < f.size(); ++i) sum[i] = a * f[i] + b * g[i];
  return sum;
}

/// A function's value at the middle, and its gradient by the components of every deviation.
class LinearForms {
 public:
  explicit LinearForms(const ClearanceModel& model) : model_(model) {}

  /// Components x and y, deviation by deviation, after the value at the middle.
  [[nodiscard]] std::vector<double> of_deviations(const BoundFunction& function) const {
    std::vector<double> form(1 + 2 * model_.deviations.size(), 0.0);
    for (std::size_t i = 0; i < function.size(); ++i) form[0] += function[i] * model_.middle_m[i];
    for (std::size_t d = 0; d < model_.deviations.size(); ++d) {
      for (const PlayEffect& e : model_.deviations[d].x) {
        form[1 + 2 * d] += function[e.bound] * e.coefficient;
      }
      for (const PlayEffect& e : model_.deviations[d].y) {
        form[2 + 2 * d] += function[e.bound] * e.coefficient;
      }
    }
    return form;
  }
  /// Greatest part of deviation d in the sum of two forms.
  [[nodiscard]] double swing(std::size_t d, std::span<const double> f,
                             std::span<const double> g) const {
    return model_.sources[model_.deviations[d].source].half_width_m *
           std::sqrt(numerics::square(f[1 + 2 * d] + g[1 + 2 * d]) +
                     numerics::square(f[2 + 2 * d] + g[2 + 2 * d]));
  }
  /// Greatest part of all deviations in the sum of two forms.
  [[nodiscard]] double swing(std::span<const double> f, std::span<const double> g) const {
    double sum = 0.0;
    for (std::size_t d = 0; d < model_.deviations.size(); ++d) sum += swing(d, f, g);
    return sum;
  }
  [[nodiscard]] std::vector<double> zero() const {
    return std::vector<double>(1 + 2 * model_.deviations.size(), 0.0);
  }

 private:
  const ClearanceModel& model_;
};

/// Ends of the strips of each planet, as functions of the bounds (docs/theory §33).
struct PlanetStrips {
  BoundFunction w_lower, w_upper, s13_lower, s13_upper, s23_lower, s23_upper;
};

std::vector<PlanetStrips> planet_strips(const ClearanceModel& model) {
  const double kappa = model.levers.planet;
  std::vector<PlanetStrips> strips;
  strips.reserve(static_cast<std::size_t>(model.planets));
  for (int planet = 0; planet < model.planets; ++planet) {
    const auto u = [&](int mesh, bool upper) {
      BoundFunction f(model.middle_m.size(), 0.0);
      f[bound_index(planet, mesh, upper)] = 1.0;
      return f;
    };
    const BoundFunction low1 = u(0, false), low2 = u(1, false), low3 = u(2, false);
    const BoundFunction high1 = u(0, true), high2 = u(1, true), high3 = u(2, true);
    strips.push_back({.w_lower = combined(1.0, low1, 1.0, low2),
                      .w_upper = combined(1.0, high1, 1.0, high2),
                      .s13_lower = combined(kappa, low1, 1.0, low3),
                      .s13_upper = combined(kappa, high1, 1.0, high3),
                      .s23_lower = combined(1.0, low3, -kappa, high2),
                      .s23_upper = combined(1.0, high3, -kappa, low2)});
  }
  return strips;
}

/// Forms of which the least is rb_R2 times the greatest output angle, and the same of minus the
/// least one.
struct WidthForms {
  std::vector<std::vector<double>> up, down;
};

WidthForms width_forms(const ClearanceModel& model, const LinearForms& forms,
                       const std::vector<PlanetStrips>& strips) {
  const auto& [kappa, e, f, output_m] = model.levers;
  const bool above = f > 0.0;
  WidthForms result;
  const auto add_up = [&](double a, const BoundFunction& x, double b, const BoundFunction& y) {
    result.up.push_back(forms.of_deviations(combined(a, x, b, y)));
  };
  const auto add_down = [&](double a, const BoundFunction& x, double b, const BoundFunction& y) {
    result.down.push_back(forms.of_deviations(combined(a, x, b, y)));
  };
  for (const PlanetStrips& p : strips) {
    for (const PlanetStrips& q : strips) {
      add_up(1.0, p.s13_upper, -e, q.w_lower);
      add_up(1.0, p.s23_upper, -f, above ? q.w_lower : q.w_upper);
      add_up(e / kappa, p.s23_upper, -f / kappa, above ? q.s13_lower : q.s13_upper);
      add_down(-1.0, p.s13_lower, e, q.w_upper);
      add_down(-1.0, p.s23_lower, f, above ? q.w_upper : q.w_lower);
      add_down(-e / kappa, p.s23_lower, f / kappa, above ? q.s13_upper : q.s13_lower);
    }
  }
  return result;
}

/// Forms of which the least is the margin.
std::vector<std::vector<double>> margin_forms(const ClearanceModel& model, const LinearForms& forms,
                                              const std::vector<PlanetStrips>& strips) {
  const double kappa = model.levers.planet;
  std::vector<std::vector<double>> result;
  const auto add = [&](const BoundFunction& f) { result.push_back(forms.of_deviations(f)); };
  for (int planet = 0; planet < model.planets; ++planet) {
    for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
      BoundFunction room(model.middle_m.size(), 0.0);
      room[bound_index(planet, mesh, true)] = 1.0;
      room[bound_index(planet, mesh, false)] = -1.0;
      add(room);
    }
  }
  for (const PlanetStrips& p : strips) {
    for (const PlanetStrips& q : strips) {
      add(combined(1.0, p.w_upper, -1.0, q.w_lower));
      add(combined(1.0, p.s13_upper, -1.0, q.s13_lower));
      add(combined(1.0, p.s23_upper, -1.0, q.s23_lower));
      const BoundFunction low = combined(1.0, p.s23_upper, -1.0, q.s13_lower);
      const BoundFunction high = combined(1.0, p.s13_upper, -1.0, q.s23_lower);
      for (const PlanetStrips& r : strips) {
        add(combined(kappa, r.w_upper, 1.0, low));
        add(combined(-kappa, r.w_lower, 1.0, high));
      }
    }
  }
  return result;
}

/// rb_R2 times the mean over the planets of the closed form of each planet's plays.
std::vector<double> mean_closed_form(const ClearanceModel& model, const LinearForms& forms) {
  const std::array<double, train::kMeshCount> lever{std::abs(model.levers.ring_side),
                                                    model.levers.sun_side, 1.0};
  BoundFunction mean(model.middle_m.size(), 0.0);
  for (int planet = 0; planet < model.planets; ++planet) {
    for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
      const double share = lever[static_cast<std::size_t>(mesh)] / model.planets;
      mean[bound_index(planet, mesh, true)] = share;
      mean[bound_index(planet, mesh, false)] = -share;
    }
  }
  return forms.of_deviations(mean);
}

/// Deviations that raise a form most.
std::vector<DeviationValue> maximiser(const ClearanceModel& model, std::span<const double> form) {
  // What cancels between planets leaves rounding errors, which have a direction too.
  double largest = 0.0;
  for (std::size_t i = 1; i < form.size(); ++i) largest = std::max(largest, std::abs(form[i]));
  std::vector<DeviationValue> values;
  values.reserve(model.deviations.size());
  for (std::size_t d = 0; d < model.deviations.size(); ++d) {
    const double half = model.sources[model.deviations[d].source].half_width_m;
    const double size =
        std::sqrt(numerics::square(form[1 + 2 * d]) + numerics::square(form[2 + 2 * d]));
    const double scale = size > 1e-12 * largest ? half / size : 0.0;
    values.push_back({.x_m = scale * form[1 + 2 * d], .y_m = scale * form[2 + 2 * d]});
  }
  return values;
}

}  // namespace

WorstCase worst_case(const ClearanceModel& model) {
  const LinearForms forms(model);
  const std::vector<PlanetStrips> strips = planet_strips(model);
  const std::vector<double> zero = forms.zero();
  const double output_m = model.levers.output_m;
  WorstCase result;

  const std::vector<double> closed = mean_closed_form(model, forms);
  result.middle_rad = closed[0] / output_m;
  result.share_rad.assign(model.sources.size(), 0.0);
  for (std::size_t d = 0; d < model.deviations.size(); ++d) {
    result.share_rad[model.deviations[d].source] += forms.swing(d, closed, zero) / output_m;
  }
  result.greatest_rad = (closed[0] + forms.swing(closed, zero)) / output_m;
  double squares = 0.0;
  for (const double share : result.share_rad) squares += share * share;
  result.root_sum_square_rad = std::sqrt(squares);
  result.greatest_attained =
      output_range(model.levers, plays(model, maximiser(model, closed))).assembles();

  const auto [up, down] = width_forms(model, forms, strips);
  double least_m = std::numeric_limits<double>::infinity();
  for (const auto& f : up) {
    for (const auto& g : down) least_m = std::min(least_m, f[0] + g[0] - forms.swing(f, g));
  }
  result.least_rad = std::max(0.0, least_m / output_m);

  result.least_margin_m = result.greatest_margin_m = std::numeric_limits<double>::infinity();
  for (const auto& f : margin_forms(model, forms, strips)) {
    const double swing = forms.swing(f, zero);
    result.least_margin_m = std::min(result.least_margin_m, f[0] - swing);
    result.greatest_margin_m = std::min(result.greatest_margin_m, f[0] + swing);
  }
  return result;
}

}  // namespace gear3k::backlash
