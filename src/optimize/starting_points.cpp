#include "optimize/starting_points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/involute.hpp"
#include "optimize/solve_outcome.hpp"
#include "optimize/uniform.hpp"

namespace gear3k::optimize {

namespace {

using train::kP1, train::kP2, train::kR1, train::kR2, train::kS;

/// Fractions of the shift range for x_S, x_P1, x_P2, x_R2.
struct ShiftFractions {
  double S, P1, P2, R2;
};
constexpr std::array<ShiftFractions, 4> kFixedStarts{{{0.50, 0.25, 0.30, 0.95},
                                                      {0.35, 0.05, 0.10, 0.50},
                                                      {0.80, 0.60, 0.50, 0.95},
                                                      {0.30, 0.40, 0.70, 0.80}}};

/// More of them where the objective is of sizes: a ring of little shift has a larger base circle in
/// the same root circle.
constexpr std::array<ShiftFractions, 2> kLargeBaseStarts{
    {{0.50, 0.00, 0.90, 0.00}, {0.20, 0.10, 0.50, 0.05}}};

/// Shift with the effect of the machining allowance on backlash folded in: j of (x, q) equals j of
/// (x − q/(2 sin α), 0) for external gears and of (x + q/(2 sin α), 0) for rings.
double thinned_shift(const Specification& spec, int gear, double x) {
  const double sign = train::kind_of(gear) == geometry::GearKind::kRing ? 1.0 : -1.0;
  return x + sign * spec.machining_allowance[static_cast<std::size_t>(gear)] /
                 (2.0 * std::sin(spec.pressure_angle_rad));
}

/// Angle whose involute is inv α + 2 tan α x_sum/z_sum, clipped to [low, high].
struct AngleRange {
  double low, high;
};
double closing_angle(const Specification& spec, double x_sum, double z_sum, AngleRange range) {
  const double alpha = spec.pressure_angle_rad;
  const double inv = geometry::involute(alpha) + 2.0 * std::tan(alpha) * x_sum / z_sum;
  if (!(inv > geometry::involute(range.low))) return range.low;
  return std::clamp(geometry::inverse_involute(inv), range.low, range.high);
}

/// x_sum that closes a mesh of working angle α_w: the inverse of closing_angle().
double closing_shift(const Specification& spec, double alpha_w, double z_sum) {
  const double alpha = spec.pressure_angle_rad;
  return (geometry::involute(alpha_w) - geometry::involute(alpha)) * z_sum /
         (2.0 * std::tan(alpha));
}

double working_angle(double base_sum, double center_distance) {
  return base_sum < center_distance ? std::acos(base_sum / center_distance) : 0.0;
}

/// m2/m1, where it is not refined.
std::optional<double> module_ratio(const RefinementProblem& p) {
  if (p.fixed_module_m[0] && p.fixed_module_m[1])
    return *p.fixed_module_m[1] / *p.fixed_module_m[0];
  return has_same_module(*p.spec) ? std::optional(1.0) : std::nullopt;
}

/// Efficiency does not depend on the scale: start at the coarsest module, so that limits of size
/// are filled and teeth are as strong as they can be.
void start_scale(const RefinementProblem& p, Point& v) {
  if (p.scale > 0) v[p.scale] = p.upper[p.scale];
}

/// @param reach  share of the way from the least shifts (by amount) to those of the fractions
Point start_from(const RefinementProblem& p, const ShiftFractions& fractions, double reach) {
  const Specification& spec = *p.spec;
  const auto [sum1, sum2, sum3] = tooth_sums(p.candidate.teeth);
  Point v{};
  const auto within = [&](int k, double x) {
    const auto i = static_cast<std::size_t>(k);
    return std::clamp(x, p.lower[i], p.upper[i]);
  };
  const auto start = [&](int gear, double fraction) {
    const NumberRange& range = shift_limits(spec, gear);
    const double least = std::clamp(0.0, range.min, range.max);
    const double x = range.min + fraction * (range.max - range.min);
    v[static_cast<std::size_t>(gear)] = within(gear, least + reach * (x - least));
  };
  start(kS, fractions.S);
  start(kP1, fractions.P1);
  start(kP2, fractions.P2);
  start(kR2, fractions.R2);

  const AngleRange range{.low = p.lower[kAngleA], .high = p.upper[kAngleA]};
  const double cos_alpha = std::cos(spec.pressure_angle_rad);
  // Work in units of stage 1's module; a module of stage 2 that is given comes with its ratio.
  const double angle1 = closing_angle(
      spec, thinned_shift(spec, kS, v[kS]) + thinned_shift(spec, kP1, v[kP1]), sum1, range);
  const double distance = 0.5 * cos_alpha * sum1 / std::cos(angle1);
  const double angle2 = working_angle(0.5 * cos_alpha * sum2, distance);
  const double ring1 =
      closing_shift(spec, std::max(angle2, range.low), sum2) + thinned_shift(spec, kP1, v[kP1]);
  v[kR1] = within(kR1, ring1 - thinned_shift(spec, kR1, 0.0));

  start_scale(p, v);
  if (const auto ratio = module_ratio(p)) {
    const double base3 = 0.5 * cos_alpha * sum3 * *ratio;
    const double angle3 = std::max(working_angle(base3, distance), range.low);
    const double ring2 = closing_shift(spec, angle3, sum3) + thinned_shift(spec, kP2, v[kP2]);
    v[kR2] = within(kR2, ring2 - thinned_shift(spec, kR2, 0.0));
    const double angle_of_mesh[] = {angle1, angle2, angle3};
    v[kAngleA] = std::clamp(angle_of_mesh[p.angle_mesh], range.low, range.high);
    return v;
  }
  v[kAngleA] = std::clamp(p.angle_mesh == train::kMeshSP1 ? angle1 : angle2, range.low, range.high);
  v[kAngleB] = closing_angle(
      spec, thinned_shift(spec, kR2, v[kR2]) - thinned_shift(spec, kP2, v[kP2]), sum3, range);
  return v;
}

/// Free tips and pressure angle: as stated, or as near to it as their ranges allow; face widths and
/// torque.
void start_free_variables(const RefinementProblem& p, Point& v) {
  const Specification& spec = *p.spec;
  for (std::size_t i = 0; p.first_tip > 0 && i < train::kGearCount; ++i) {
    const std::size_t k = p.first_tip + i;
    v[k] = std::clamp(spec.tip_shortening[i], p.lower[k], p.upper[k]);
  }
  if (p.pressure_angle > 0) {
    v[p.pressure_angle] =
        std::clamp(spec.pressure_angle_rad, p.lower[p.pressure_angle], p.upper[p.pressure_angle]);
  }
  // As strong as they can be, at the torque that is stated.
  for (const std::size_t width : p.face_width) {
    if (width > 0) v[width] = p.upper[width];
  }
  if (p.torque > 0) v[p.torque] = p.lower[p.torque];
}

/// As start_from(), nearer to gears without shift where the model is not defined so far out: of
/// wide ranges a fraction is no gear.
Point defined_start(const RefinementProblem& p, const ShiftFractions& fractions) {
  constexpr int kHalvings = 4;
  double reach = 1.0;
  Point start{};
  for (int k = 0; k <= kHalvings; ++k, reach *= 0.5) {
    start = start_from(p, fractions, reach);
    start_free_variables(p, start);
    if (std::isfinite(outcome_at(p, start).violation)) return start;
  }
  start = start_from(p, fractions, 1.0);
  start_free_variables(p, start);
  return start;
}

/// The shifts and distances of a bound; where stage 2's module is given with stage 1's, R2 closes
/// its mesh at stage 1's distance.
Point start_at(const RefinementProblem& p, const SetBound& bound) {
  const Specification& spec = *p.spec;
  const train::ToothSet& z = p.candidate.teeth;
  const double half_cos = 0.5 * std::cos(spec.pressure_angle_rad);
  std::array<double, train::kMeshCount> base_sum = tooth_sums(z);
  for (double& sum : base_sum) sum *= half_cos;
  Point v{};
  const auto set = [&](std::size_t k, double x) { v[k] = std::clamp(x, p.lower[k], p.upper[k]); };
  set(kS, bound.stage1.sun_shift);
  set(kP1, bound.stage1.planet_shift);
  set(kR1, bound.stage1.ring_shift);
  set(kP2, bound.stage2.planet_shift);
  set(kR2, bound.stage2.ring_shift);
  start_scale(p, v);
  double distance = bound.stage1.center_distance;
  if (const auto ratio = module_ratio(p)) {
    const double distance2 = distance / *ratio;
    const double angle3 = std::max(working_angle(base_sum[2], distance2), p.lower[kAngleA]);
    set(kR2, closing_shift(spec, angle3, z.R2 - z.P2) + thinned_shift(spec, kP2, v[kP2]) -
                 thinned_shift(spec, kR2, 0.0));
    if (p.angle_mesh == train::kMeshP2R2) distance = distance2;
    set(kAngleA, working_angle(base_sum[static_cast<std::size_t>(p.angle_mesh)], distance));
    return v;
  }
  set(kAngleA, working_angle(base_sum[static_cast<std::size_t>(p.angle_mesh)], distance));
  set(kAngleB, working_angle(base_sum[2], bound.stage2.center_distance));
  return v;
}

}  // namespace

std::vector<Point> starting_points(const RefinementProblem& problem, int count,
                                   unsigned long long seed, const SetBound* bound) {
  Uniform uniform(stream_of(problem.candidate, seed));
  std::vector<Point> points;
  points.reserve(static_cast<std::size_t>(count) + 1);
  if (bound != nullptr && count > 0) {
    points.push_back(start_at(problem, *bound));
    start_free_variables(problem, points.back());
  }
  for (int k = 0; k < count; ++k) {
    const auto index = static_cast<std::size_t>(k);
    points.push_back(defined_start(problem, index < kFixedStarts.size()
                                                ? kFixedStarts[index]
                                                : ShiftFractions{.S = uniform.next(),
                                                                 .P1 = uniform.next(),
                                                                 .P2 = uniform.next(),
                                                                 .R2 = uniform.next()}));
  }
  if (problem.objective == Objective::kLostMotion) {
    for (const ShiftFractions& start : kLargeBaseStarts) {
      points.push_back(defined_start(problem, start));
    }
  }
  return points;
}

}  // namespace gear3k::optimize
