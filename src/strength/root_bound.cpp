#include "strength/root_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/tooth_form.hpp"
#include "strength/life_factor.hpp"
#include "strength/mesh_rating.hpp"
#include "strength/root_section.hpp"
#include "strength/root_strength.hpp"
#include "strength/train_rating.hpp"

namespace gear3k::strength {

namespace {

constexpr int kRootKnots = 65;
constexpr int kKnotIterations = 50;
/// Of comparisons with the rated section.
constexpr double kTableSlack = 1e-9;

/// cos a from above and from below.
double cosine_above(double a) { return 1.0 - a * a * (0.5 - a * a / 24.0); }
double cosine_below(double a) { return cosine_above(a) - a * a * a * a * a * a / 720.0; }

}  // namespace

RootTable make_root_table(const geometry::GearGeometry<double>& gear, double greatest_shift) {
  // Symbols as in the header; lengths in modules.
  using std::numbers::pi;
  RootTable table;
  const auto form = geometry::make_tooth_form(gear);
  if (form.fillet.tool != geometry::RootTool::kRack ||
      !(form.form_normal_angle_rad < kExternalTangentAngle_rad)) {
    return table;
  }
  const double m = gear.gear.module_m;
  const int z = gear.gear.teeth;
  const double alpha = gear.angle.alpha_rad;
  const double rho = form.fillet.rounding_radius_m / m;
  const double a = form.fillet.center_offset / m;
  const double first_G = -form.fillet.rounding_depth_m / m;
  table.least_shift = gear.gear.profile_shift;
  table.step = std::max(greatest_shift - table.least_shift, 1e-6) / (kRootKnots - 1);
  table.rounding = rho;
  table.least_center = first_G;
  table.base_radius = gear.base_radius_m / m;
  table.cosine = gear.angle.cos;
  table.opening =
      (0.5 * pi - gear.gear.machining_allowance / gear.angle.cos) / z + gear.angle.tan - alpha;
  table.opening_slope = 2.0 * gear.angle.tan / z;
  const double end = 0.5 * pi - kExternalTangentAngle_rad - (pi - 2.0 * a) / z;
  double theta = end;
  for (int k = 0; k < kRootKnots; ++k) {
    const double G = first_G + k * table.step;
    double slope = 1.0;
    for (int i = 0; i < kKnotIterations; ++i) {
      const double t = std::tan(theta);
      slope = 1.0 - 2.0 * G / z * (1.0 + t * t);
      const double next = theta - (theta - 2.0 * G / z * t - end) / slope;
      const double moved = std::abs(next - theta);
      theta = next;
      if (!(moved > 1e-14)) break;
    }
    const double c = std::cos(theta);
    // The slopes' signs: z cos θ cos(θ + π/6) ≥ √3 G holds for smaller shifts if it does here.
    const bool proven = theta > 0.0 && theta < pi / 3.0 && slope > 0.0 &&
                        z * c * std::cos(theta + pi / 6.0) > std::sqrt(3.0) * G;
    if (!proven) break;
    table.knots.push_back({.chord = z * std::sin(pi / 3.0 - theta) + std::sqrt(3.0) * (G / c - rho),
                           .height = 0.5 * (z * std::cos(pi / 3.0 - theta) + G / c - rho),
                           .curvature_radius = rho + 2.0 * G * G / (c * (z * c * c - 2.0 * G))});
  }
  return table;
}

std::array<std::array<RootNeed, 2>, train::kMeshCount> root_needs(const RatingTask& task,
                                                                  const FlankExtremes& extremes) {
  std::array<std::array<RootNeed, 2>, train::kMeshCount> needs;
  const TrainCycles cycles = train_cycles(extremes.teeth, extremes.planets, task);
  const StatedFactors& stated = task.factors;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    if (k != train::kMeshP2R2 && !extremes.dissipative) continue;
    const double force_N =
        least_line_force(task, extremes, k) * std::cos(extremes.pressure_angle_rad) *
        least_load_factor(task, extremes, k,
                          stated.root_face.value_or(std::min(1.0, stated.flank_face.value_or(1.0))),
                          stated.root_transverse.value_or(1.0));
    for (std::size_t own = 0; own < 2; ++own) {
      const int id = train::kMeshGears[k][own];
      const auto gear = static_cast<std::size_t>(id);
      const GearMaterial& material = *task.material[gear];
      if (train::kind_of(id) == geometry::GearKind::kRing ||
          material.record.root_limit.law == LimitLaw::kNotStated) {
        continue;
      }
      const bool plastic = is_plastic(material.record.group);
      if (plastic && !task.tooth_temperature_K && !extremes.dissipative) continue;
      const StatedTeeth teeth = stated_teeth(task, gear);
      const RootLoading loading = root_loading(teeth, is_idler(id, extremes.teeth));
      double strength_Pa = 0.0;
      RootNeed& need = needs[k][own];
      need.plastic = plastic;
      if (plastic) {
        const auto limit = root_limit<double>(
            material.record, {.hardness = material.hardness,
                              .temperature_K = task.tooth_temperature_K.value_or(task.ambient_K),
                              .cycles = std::max(cycles[gear].value_or(1.0), 1.0)});
        strength_Pa = kPlasticStressCorrection * limit.stress_Pa *
                      reversal_factor<double>(loading, teeth.reversal, {.value = 1.0}).value;
      } else {
        const auto limit = root_limit<double>(material.record, {.hardness = material.hardness});
        const RootStrength<double> at =
            root_strength<double>(material.record, limit.stress_Pa,
                                  {.cycles = cycles[gear].value_or(kUnstatedCycles),
                                   .notch_parameter = 1.0,
                                   .module_m = 1e-3,
                                   .root_roughness_m = teeth.root_roughness_m,
                                   .loading = loading,
                                   .reversal = teeth.reversal});
        strength_Pa = at.strength_Pa / at.notch_sensitivity.value;
        if (!cycles[gear]) strength_Pa = strength_Pa / at.life.value;
        need.slip_layer_mm = slip_layer_thickness_mm(material.record).value_or(0.0);
      }
      if (!(strength_Pa > 0.0)) {
        need.load_m2 = std::numeric_limits<double>::infinity();
        continue;
      }
      const double least = least_root_safety(task, gear);
      const double safety = std::max(0.0, least - extremes.safety_slack * std::max(1.0, least));
      need.load_m2 = force_N * safety / strength_Pa;
    }
  }
  return needs;
}

double least_root_module2(const RootTable& table, const RootNeed& need, const RootRange& range,
                          double least_of_interest_m2) {
  const int last = static_cast<int>(table.knots.size()) - 1;
  if (!(need.load_m2 > 0.0) || last < 0) return 0.0;
  const double from = (range.least_shift - table.least_shift) / table.step;
  const double to = (range.greatest_shift - table.least_shift) / table.step;
  if (!(from >= -kTableSlack && to <= last + kTableSlack)) return 0.0;
  const int end = std::clamp(static_cast<int>(std::ceil(to)), 0, last);
  const auto& low =
      table.knots[static_cast<std::size_t>(std::clamp(static_cast<int>(from), 0, last))];
  const auto& high = table.knots[static_cast<std::size_t>(end)];
  const double most_radius = std::max(low.curvature_radius, high.curvature_radius);
  const double pitch = std::numbers::pi * table.cosine;
  // Where the load acts, as a distance from the tangent point.
  double least_length = range.least_tip, most_length = range.greatest_tip;
  double contact = 1.0;
  if (need.plastic) {
    contact = 0.25 + 0.75 / std::max(range.greatest_contact_ratio, 1.0);
  } else {
    const auto beyond = [&](double ratio) { return std::clamp(ratio - 1.0, 0.0, 1.0) * pitch; };
    least_length = std::min(
        least_length,
        std::max(least_length - beyond(range.greatest_contact_ratio), range.least_by_mate));
    most_length = most_length - beyond(range.least_contact_ratio);
    if (range.greatest_contact_ratio <= 2.0) {
      most_length = std::min(most_length, range.greatest_by_mate);
    }
  }
  const double least_angle =
      least_length / table.base_radius - table.opening - table.opening_slope * range.greatest_shift;
  const double most_angle =
      most_length / table.base_radius - table.opening - table.opening_slope * range.least_shift;
  const double least_above = std::max(0.0, least_angle);
  const double most_off = std::max(std::abs(least_angle), std::abs(most_angle));
  const double lever = table.base_radius - high.height * cosine_above(least_above);
  const double least_cosine = cosine_below(most_off);
  if (!(lever > 0.0 && least_cosine > 0.0)) return 0.0;
  const double form_factor = 6.0 * lever / (high.chord * high.chord * table.cosine);
  const double most_arm = table.base_radius / least_cosine - low.height;
  const double arm_ratio = low.chord / most_arm;
  const double notch = low.chord / (2.0 * most_radius);
  // Without the power: q^e is at most the greater of 1 and q; and Y_δ at least 1/(1 + √(1.2 ρ')).
  const double factor = need.load_m2 * form_factor * (1.2 + 0.13 * arm_ratio) * contact;
  constexpr double kMostOfSupport = 1.4;  // of the greatest ρ'
  if (kMostOfSupport * factor * std::max(1.0, notch) < least_of_interest_m2) return 0.0;
  const double exponent = notch >= 1.0 ? 1.0 / (1.21 + 2.3 / arm_ratio) : 1.0 / 1.21;
  double support = 1.0;
  if (need.slip_layer_mm > 0.0) {
    const bool falls = table.least_center + end * table.step <= 0.0;
    const double most_notch = high.chord / (2.0 * (falls ? high.curvature_radius : table.rounding));
    support = (1.0 + std::sqrt(0.2 * need.slip_layer_mm * (1.0 + 2.0 * most_notch))) /
              (1.0 + std::sqrt(1.2 * need.slip_layer_mm));
  }
  return factor * std::pow(notch, exponent) / support * (1.0 - kTableSlack);
}

}  // namespace gear3k::strength
