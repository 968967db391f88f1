#include "optimize/shift_range.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/interference.hpp"
#include "numerics/parallel.hpp"

namespace gear3k::optimize {

using design::CheckId;

namespace {

/// A gear at a profile shift, with unit module.
geometry::GearGeometry<double> unit_gear(const Specification& spec, int gear, int teeth,
                                         double shift) {
  const auto i = static_cast<std::size_t>(gear);
  return geometry::make_gear_geometry<double>(
      {.teeth = teeth,
       .kind = train::kind_of(gear),
       .module_m = 1.0,
       .profile_shift = shift,
       .machining_allowance = spec.machining_allowance[i],
       .tip_shortening = spec.tip_shortening[i],
       .rack = spec.rack,
       .cutter = spec.cutter[i]},
      geometry::make_pressure_angle(spec.pressure_angle_rad));
}

/// What holds of the greatest shift at which an external gear's tip is thick enough.
struct TipShift {
  double most = 0.0;      ///< the greatest shift; the range's end where nothing is proven
  bool too_thin = false;  ///< nowhere in the range is it thick enough
};

/// Where the tip thickness s_a falls with the shift and is below the limit, it stays so for all
/// greater shifts:
///   ds_a/dx = 2 s_a/D − 2 (sin α_a − sin α)/cos α_a (per module, D = 2 r_a/m), and with falling
///   s_a
/// the first term falls and the second rises.
TipShift shift_at_tip_thickness(const Specification& spec, int gear, int teeth,
                                const Interval& range, double limit) {
  const auto tip = [&](double x) { return unit_gear(spec, gear, teeth, x); };
  const auto thickness = [&](double x) {
    const auto g = tip(x);
    return geometry::tooth_thickness(g, g.tip_radius_m);
  };
  const auto falls = [&](double x) {
    const auto g = tip(x);
    const double cosine = g.base_radius_m / g.tip_radius_m;
    return cosine < 1.0 && thickness(x) / (2.0 * g.tip_radius_m) <
                               (std::sqrt(1.0 - cosine * cosine) - g.angle.sin) / cosine;
  };
  if (thickness(range.hi) >= limit) return {.most = range.hi};
  if (thickness(range.lo) < limit) return {.most = range.hi, .too_thin = falls(range.lo)};
  double below = range.lo, above = range.hi;
  while (above - below > 1e-13 * (1.0 + std::abs(above))) {
    const double middle = 0.5 * (below + above);
    if (middle <= below || middle >= above) break;
    (thickness(middle) >= limit ? below : above) = middle;
  }
  return {.most = falls(above) ? below : range.hi};
}

/// A limit that a root radius has to reach, and the miss of its check over that of the radius.
struct LeastRoot {
  CheckId check{};
  double radius_m = 0.0, per_radius = 1.0;
};
std::vector<LeastRoot> least_roots(const Specification& spec, int gear) {
  std::vector<LeastRoot> least;
  const auto add = [&](CheckId check, double radius_m, double per_radius) {
    if (radius_m > 0.0) {
      least.push_back({.check = check, .radius_m = radius_m, .per_radius = per_radius});
    }
  };
  const auto& sun = spec.limits[CheckId::kSunRootDiameter];
  if (sun && gear == train::kS) add(CheckId::kSunRootDiameter, 0.5 * *sun, 2.0);
  const double bore = spec.bodies.bore_radius_m[static_cast<std::size_t>(gear)];
  if (const auto& wall = spec.limits[CheckId::kWall]; wall && bore > 0.0) {
    add(CheckId::kWall, bore + *wall, 1.0);
  }
  return least;
}

/// The limit of a tip's thickness that asks for more, at the greatest module.
struct LeastTip {
  CheckId check{};
  double modules = 0.0, per_module = 1.0;  ///< the check's own unit over modules, SI
};
std::optional<LeastTip> least_tip(const Specification& spec, int gear, double greatest_module_m) {
  std::optional<LeastTip> least;
  if (const auto& limit = spec.limits[CheckId::kTipThickness]) {
    least = LeastTip{.check = CheckId::kTipThickness, .modules = *limit};
  }
  const auto& length = spec.limits[CheckId::kTipThicknessLength];
  if (length && *length > 0.0 && (!least || *length / greatest_module_m > least->modules)) {
    least = LeastTip{.check = CheckId::kTipThicknessLength,
                     .modules = *length / greatest_module_m,
                     .per_module = greatest_module_m};
  }
  return train::kind_of(gear) == geometry::GearKind::kRing ? std::nullopt : least;
}

/// The range of one gear, made limit by limit.
class RangeMaker {
 public:
  RangeMaker(const Specification& spec, int gear, int teeth)
      : spec_(spec),
        gear_(gear),
        teeth_(teeth),
        all_{shift_limits(spec, gear).min, shift_limits(spec, gear).max},
        module_(module_range(spec.module[static_cast<std::size_t>(train::stage_of(gear))])),
        free_tips_(spec.free.tip_shortening.has_value()),
        free_angle_(spec.free.pressure_angle_rad.has_value()),
        result_{.range = all_, .widest = all_, .infeasible = std::nullopt} {
    module_.hi += design::kFeasibilitySlack * length_scale_m(spec);
  }

  ShiftRange range() {
    if (train::kind_of(gear_) == geometry::GearKind::kRing) {
      keep_ring_tip();
      keep_ring_diameters();
    } else {
      keep_undercut();
      keep_roots();
      keep_tip();
    }
    return result_;
  }

 private:
  [[nodiscard]] geometry::GearGeometry<double> at(double shift) const {
    return unit_gear(spec_, gear_, teeth_, shift);
  }
  void miss(CheckId check, double miss_si, double violation) {
    // Two limits that are missed by the tolerance each may be met together.
    if (violation <= 2.0 * design::kFeasibilitySlack) return;
    if (!result_.infeasible || violation > result_.infeasible->violation) {
      result_.infeasible = {.check = check, .miss_si = miss_si, .violation = violation};
    }
  }
  void at_least(CheckId check, double shift) {
    miss(check, shift - all_.hi, shift - all_.hi);
    result_.range.lo = std::max(result_.range.lo, std::min(shift, all_.hi));
  }
  void widen_by_slack() {
    result_.widest = {result_.range.lo - design::kFeasibilitySlack,
                      result_.range.hi + design::kFeasibilitySlack};
  }

  /// Keeps ring tips off their base circles, where the tip's curvature has no derivative: with the
  /// shortest tips and the greatest pressure angle that are free.
  void keep_ring_tip() {
    constexpr double kTipAboveBase = 1e-6;
    Specification least = spec_;
    if (free_tips_) least.tip_shortening.fill(spec_.free.tip_shortening->max);
    if (free_angle_) least.pressure_angle_rad = spec_.free.pressure_angle_rad->max;
    const double above = geometry::ring_tip_above_base(unit_gear(least, gear_, teeth_, 0.0));
    result_.range.lo = std::max(all_.lo, std::min(all_.hi, kTipAboveBase - above));
    const auto& limit = spec_.limits[CheckId::kRingTipOutsideBase];
    if (limit && !free_tips_ && !free_angle_) {
      at_least(CheckId::kRingTipOutsideBase, *limit - above);
    }
    widen_by_slack();
  }
  /// The root circle and the rim outside it, at the least module.
  void keep_ring_diameters() {
    const double root = at(all_.lo).root_radius_m;
    const double rim = spec_.bodies.ring_rim_m;
    for (const auto& [check, around] : {std::pair{CheckId::kRingRootDiameter, 0.0},
                                        std::pair{CheckId::kGearboxDiameter, 2.0 * rim}}) {
      const auto& diameter = spec_.limits[check];
      if (!diameter || !(*diameter > 0.0)) continue;
      const double excess = 2.0 * root * module_.lo + around - *diameter;
      miss(check, excess, excess / *diameter);
      const double most =
          all_.lo + 0.5 * (*diameter * (1.0 + design::kFeasibilitySlack) - around) / module_.lo -
          root;
      result_.widest.hi = std::max(result_.widest.lo, std::min(result_.widest.hi, most));
    }
    if (const auto& wall = spec_.limits[CheckId::kWall]; wall && rim > 0.0) {
      miss(CheckId::kWall, *wall - rim, (*wall - rim) / *wall);
    }
  }
  void keep_undercut() {
    if (const auto& limit = spec_.limits[CheckId::kUndercut]; limit && !free_angle_) {
      at_least(CheckId::kUndercut, *limit - geometry::undercut_margin(at(0.0)));
    }
    widen_by_slack();
  }
  /// The root circle grows with the shift, one to one, and with the module.
  void keep_roots() {
    for (const LeastRoot& least : least_roots(spec_, gear_)) {
      const double root = at(all_.hi).root_radius_m;
      const double lacking = least.radius_m - root * module_.hi;
      miss(least.check, lacking * least.per_radius, lacking / least.radius_m);
      const double shift =
          all_.hi + least.radius_m * (1.0 - design::kFeasibilitySlack) / module_.hi - root;
      result_.widest.lo = std::min(result_.widest.hi, std::max(result_.widest.lo, shift));
    }
  }
  void keep_tip() {
    const auto limit = least_tip(spec_, gear_, module_.hi);
    if (!limit || spec_.khk_tip[static_cast<std::size_t>(gear_)] || free_tips_ || free_angle_ ||
        thinning_varies(spec_)) {
      return;
    }
    const TipShift tip =
        shift_at_tip_thickness(spec_, gear_, teeth_, result_.range, limit->modules);
    if (tip.too_thin) {
      const auto g = at(result_.range.lo);
      const double amount = limit->modules - geometry::tooth_thickness(g, g.tip_radius_m);
      miss(limit->check, amount * limit->per_module, amount);
    }
    result_.range.hi = tip.most;
    const TipShift eased = shift_at_tip_thickness(spec_, gear_, teeth_, {result_.range.lo, all_.hi},
                                                  limit->modules - design::kFeasibilitySlack);
    result_.widest.hi = std::max(result_.widest.lo, design::kFeasibilitySlack + eased.most);
  }

  const Specification& spec_;
  int gear_, teeth_;
  Interval all_, module_;
  bool free_tips_, free_angle_;
  ShiftRange result_;
};

}  // namespace

Interval module_range(const ModuleChoice& choice) {
  if (choice.range_m) return {choice.range_m->min, choice.range_m->max};
  const auto [least, most] = std::minmax_element(choice.series_m.begin(), choice.series_m.end());
  return {*least, *most};
}

ShiftRange shift_range(const Specification& spec, int gear, int teeth) {
  return RangeMaker(spec, gear, teeth).range();
}

bool in_shift_range(const Specification& spec, const design::CheckInstance& check) {
  const bool free_tips = spec.free.tip_shortening.has_value();
  const bool free_angle = spec.free.pressure_angle_rad.has_value();
  switch (check.record->id) {
    case CheckId::kUndercut:
      return !free_angle;
    case CheckId::kRingTipOutsideBase:
      return !free_tips && !free_angle;
    default:
      return false;
  }
}

ShiftTable::ShiftTable(const Specification& spec, std::span<const Candidate> candidates) {
  if (candidates.empty()) return;
  std::array<IntegerRange, train::kGearCount> teeth;
  teeth.fill({.min = std::numeric_limits<int>::max(), .max = 0});
  for (const Candidate& c : candidates) {
    const auto z = train::teeth_of(c.teeth);
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      teeth[i] = {.min = std::min(teeth[i].min, z[i]), .max = std::max(teeth[i].max, z[i])};
    }
  }
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    Gear& g = gear_[i];
    g.first = teeth[i].min;
    g.by_teeth.resize(static_cast<std::size_t>(teeth[i].max) - static_cast<std::size_t>(g.first) +
                      1);
    numerics::parallel_for(g.by_teeth.size(), [&](std::size_t k) {
      g.by_teeth[k] = shift_range(spec, static_cast<int>(i), g.first + static_cast<int>(k));
    });
  }
}

const ShiftRange& ShiftTable::of(int gear, int teeth) const {
  const Gear& g = gear_[static_cast<std::size_t>(gear)];
  return g.by_teeth.at(static_cast<std::size_t>(teeth) - static_cast<std::size_t>(g.first));
}

ShiftRanges ShiftTable::of(const train::ToothSet& teeth) const {
  const auto z = train::teeth_of(teeth);
  ShiftRanges ranges;
  for (std::size_t i = 0; i < train::kGearCount; ++i) ranges[i] = of(static_cast<int>(i), z[i]);
  return ranges;
}

}  // namespace gear3k::optimize
