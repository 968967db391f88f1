#include "tests/geometry/rolling_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace gear3k::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kNodes = 360;  // per profile
constexpr int kRollRadii = 160;

double inv(double a) { return std::tan(a) - a; }
double involute_at_radius(double base, double r) {
  return r > base ? inv(std::acos(base / r)) : 0.0;
}

/// Largest f on [low, high] around a sampled maximum, by golden section.
template <class F>
double golden(const F& f, double low, double high, int steps, double* position = nullptr) {
  constexpr double kRatio = 0.6180339887498949;
  double a = high - kRatio * (high - low), b = low + kRatio * (high - low);
  double fa = f(a), fb = f(b);
  for (int k = 0; k < steps; ++k) {
    if (fa > fb) {
      high = b;
      b = a;
      fb = fa;
      a = high - kRatio * (high - low);
      fa = f(a);
    } else {
      low = a;
      a = b;
      fa = fb;
      b = low + kRatio * (high - low);
      fb = f(b);
    }
  }
  if (position != nullptr) *position = fa > fb ? a : b;
  return std::max(fa, fb);
}

/// Pieces on which a function is smooth; samples crowd at their ends, where contours end.
class Pieces {
 public:
  void add(double bound) {
    if (count_ < bounds_.size()) bounds_[count_++] = bound;
  }
  /// Adds ±bound.
  void add_both(double bound) {
    add(-bound);
    add(bound);
  }
  void sort() { std::sort(bounds_.begin(), bounds_.begin() + static_cast<std::ptrdiff_t>(count_)); }

  /// Calls see(position, value) for every local maximum, refined, and both ends.
  template <class F, class See>
  void maxima(const F& f, int samples, int steps, const See& see) const {
    std::array<double, 256> x{}, y{};
    std::size_t n = 0;
    for (std::size_t k = 0; k + 1 < count_; ++k) {
      const double middle = 0.5 * (bounds_[k] + bounds_[k + 1]);
      const double half = 0.5 * (bounds_[k + 1] - bounds_[k]);
      const bool last = k + 2 == count_;
      for (int i = 0; i < samples + (last ? 1 : 0); ++i) {
        x[n] = middle - half * std::cos(kPi * i / samples);
        y[n] = f(x[n]);
        ++n;
      }
    }
    double top = -kInfinity;
    for (std::size_t i = 0; i < n; ++i) top = std::max(top, y[i]);
    for (std::size_t i = 0; i < n; ++i) {
      const bool left = i == 0 || y[i] >= y[i - 1];
      const bool right = i + 1 == n || y[i] >= y[i + 1];
      if (!left || !right) continue;
      see(x[i], y[i]);
      // A refined maximum gains little over its sample: what is far below the best is left alone.
      if (steps > 0 && y[i] > top - 0.1 * (1.0 + std::abs(top))) {
        double at = 0.0;
        const double best = golden(f, x[i == 0 ? 0 : i - 1], x[i + 1 == n ? i : i + 1], steps, &at);
        see(at, best);
      }
    }
  }

  template <class F>
  [[nodiscard]] double largest(const F& f, int samples, int steps) const {
    double best = -kInfinity;
    maxima(f, samples, steps, [&](double, double value) { best = std::max(best, value); });
    return best;
  }

 private:
  std::array<double, 12> bounds_{};
  std::size_t count_ = 0;
};

/// Angle at the origin of a triangle with sides r and d around it and rho opposite.
double angle_opposite(double rho, double r, double d) {
  return std::acos(std::clamp((r * r + d * d - rho * rho) / (2.0 * r * d), -1.0, 1.0));
}

/// External involute tooth whose corners to the outer circle are arcs: a pinion cutter's tooth, or
/// the space of a ring with arc roots.  Radial below the base circle.
struct RoundedInvolute {
  double base, base_half_angle, outer;
  double corner_radius, corner_center, corner_angle = 0.0, flank_end = 0.0;

  [[nodiscard]] double sharp(double r) const {
    return base_half_angle - involute_at_radius(base, r);
  }
  /// Distance of a corner's centre from the sharp flank.
  [[nodiscard]] double distance(double center, double angle, double reach, double* foot) const {
    const double x = center * std::sin(angle), y = center * std::cos(angle);
    const auto closeness = [&](double r) {
      const double a = sharp(r);
      return -std::hypot(r * std::sin(a) - x, r * std::cos(a) - y);
    };
    return -golden(closeness, std::max(center - 3.0 * reach, 0.0), outer + reach, 50, foot);
  }
  /// Rolls the largest disc of at most the wanted radius into the corner.
  bool round_corner(double wanted) {
    if (!(sharp(outer) > 0.0)) return false;
    corner_radius = wanted;
    corner_center = outer - wanted;
    flank_end = outer;
    corner_angle = sharp(outer);
    if (!(wanted > 0.0)) return true;
    if (distance(corner_center, 0.0, wanted, &flank_end) < wanted) {
      double low = 0.0, high = wanted;
      for (int k = 0; k < 50; ++k) {
        const double middle = 0.5 * (low + high);
        (distance(outer - middle, 0.0, middle, &flank_end) > middle ? low : high) = middle;
      }
      corner_radius = low;
      corner_center = outer - low;
      corner_angle = 0.0;
      static_cast<void>(distance(corner_center, 0.0, low, &flank_end));
      return low > 0.0;
    }
    double low = 0.0, high = sharp(outer - wanted);
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (low + high);
      (distance(corner_center, middle, wanted, &flank_end) > wanted ? low : high) = middle;
    }
    corner_angle = low;
    static_cast<void>(distance(corner_center, low, wanted, &flank_end));
    return true;
  }
  [[nodiscard]] double at(double r) const {
    if (r <= flank_end || !(corner_radius > 0.0)) return sharp(r);
    return corner_angle + angle_opposite(corner_radius, r, corner_center);
  }
};

/// Half-angle of the space that a rack's tooth sweeps, at one radius.
struct RackTool {
  double reference_radius, tip_line, corner_line, flank_start;  // as distances from the gear's axis
  double corner_width, corner_radius, datum_line, datum_half_width, tan_alpha;

  static std::optional<RackTool> make(const geometry::Gear<double>& g, double alpha) {
    RackTool t{};
    t.reference_radius = 0.5 * g.teeth;
    t.datum_line = t.reference_radius + g.profile_shift;
    t.tip_line = t.datum_line - g.rack.dedendum;
    t.tan_alpha = std::tan(alpha);
    t.datum_half_width = kPi / 4.0 + 0.5 * g.machining_allowance / std::cos(alpha);
    t.corner_radius = g.rack.root_radius;
    t.corner_line = t.tip_line + t.corner_radius;
    t.flank_start = t.corner_line - t.corner_radius * std::sin(alpha);
    t.corner_width = t.datum_half_width + (t.corner_line - t.datum_line) * t.tan_alpha -
                     t.corner_radius / std::cos(alpha);
    if (!(t.tip_line > 0.0) || !(t.corner_width >= 0.0) || !(t.corner_radius >= 0.0)) return {};
    return t;
  }
  [[nodiscard]] double half_width(double y) const {
    if (y >= flank_start) return datum_half_width + (y - datum_line) * tan_alpha;
    const double h = y - corner_line;
    return corner_width + std::sqrt(std::max(corner_radius * corner_radius - h * h, 0.0));
  }
  /// The tool passes the point at (r, β) seen from the line of centres with its flank when it has
  /// moved by r sin β − half_width; the gear has turned by that over its reference radius.
  [[nodiscard]] double space(double r) const {
    if (r <= tip_line) return corner_width / reference_radius;
    Pieces pieces;
    pieces.add_both(std::atan2(std::sqrt(r * r - tip_line * tip_line), tip_line));
    if (r > flank_start) {
      pieces.add_both(std::atan2(std::sqrt(r * r - flank_start * flank_start), flank_start));
    }
    pieces.sort();
    return pieces.largest(
        [&](double b) {
          return b - (r * std::sin(b) - half_width(r * std::cos(b))) / reference_radius;
        },
        14, 20);
  }
};

/// Half-angle of the space that a pinion cutter's tooth sweeps in a ring, at one radius.
struct CutterTool {
  RoundedInvolute tooth;
  double center_distance, ratio;

  [[nodiscard]] double space(double r) const {
    Pieces pieces;
    pieces.add_both(angle_opposite(tooth.outer, r, center_distance));
    pieces.add(0.0);
    for (double rho : {tooth.flank_end, tooth.base}) {
      if (rho > r - center_distance && rho < tooth.outer) {
        pieces.add_both(angle_opposite(rho, r, center_distance));
      }
    }
    pieces.sort();
    return pieces.largest(
        [&](double b) {
          const double x = r * std::sin(b), y = r * std::cos(b) - center_distance;
          const double rho = std::min(std::hypot(x, y), tooth.outer);
          return b - (std::atan2(x, y) - tooth.at(rho)) * ratio;
        },
        12, 20);
  }
};

/// The working angle whose involute is given; nothing below zero.
std::optional<double> inverse_involute(double value) {
  if (!(value > 0.0)) return {};
  double low = 0.0, high = 0.5 * kPi - 1e-9;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (inv(middle) < value ? low : high) = middle;
  }
  return low;
}

std::optional<CutterTool> make_cutter(const geometry::Gear<double>& g, double alpha) {
  const double z = g.teeth, z0 = g.cutter.teeth, x = g.profile_shift, x0 = g.cutter.profile_shift;
  if (z0 >= z) return {};
  const auto working = inverse_involute(inv(alpha) + 2.0 * std::tan(alpha) * (x - x0) / (z - z0));
  if (!working) return {};
  const double a0 = 0.5 * (z - z0) * std::cos(alpha) / std::cos(*working);
  const double thicker = g.machining_allowance / std::cos(alpha);
  CutterTool tool{
      .tooth = {.base = 0.5 * z0 * std::cos(alpha),
                .base_half_angle =
                    (kPi / 2.0 + 2.0 * x0 * std::tan(alpha) + thicker) / z0 + inv(alpha),
                .outer = 0.5 * z + g.rack.dedendum + x - a0,
                .corner_radius = 0.0,
                .corner_center = 0.0},
      .center_distance = a0,
      .ratio = z0 / z};
  if (!(tool.tooth.outer > tool.tooth.base)) return {};
  if (!tool.tooth.round_corner(g.cutter.tip_radius)) return {};
  return tool;
}

std::optional<CutProfile> tabulate(CutProfile p, std::function<double(double)> half_angle) {
  p.exact = std::move(half_angle);
  p.half_angle.resize(kNodes);
  for (std::size_t i = 0; i < kNodes; ++i) p.half_angle[i] = p.exact(p.radius(i));
  const double pitch = kPi / p.teeth;
  // What is left of the tooth ends where its flanks meet.
  const auto tooth = [&](std::size_t i) {
    return p.ring ? pitch - p.half_angle[i] : p.half_angle[i];
  };
  p.reach = p.tip_radius;
  for (std::size_t i = 1; i < kNodes; ++i) {
    if (tooth(i) > 0.0) continue;
    const double share = tooth(i - 1) / (tooth(i - 1) - tooth(i));
    p.reach = std::lerp(p.radius(i - 1), p.radius(i), share);
    break;
  }
  p.slope.resize(kNodes);
  for (std::size_t i = 0; i < kNodes; ++i) {
    const std::size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, kNodes - 1);
    p.slope[i] = p.radius(i) * (p.half_angle[b] - p.half_angle[a]) / (p.radius(b) - p.radius(a));
  }
  if (!(tooth(0) > 0.0)) return {};
  return p;
}

}  // namespace

double CutProfile::radius(std::size_t node) const {
  const double t = static_cast<double>(node) / static_cast<double>(kNodes - 1);
  return root_radius + (tip_radius - root_radius) * t * t;
}

namespace {
double interpolated(const CutProfile& p, const std::vector<double>& table, double r) {
  const double share = (r - p.root_radius) / (p.tip_radius - p.root_radius);
  if (!(share > 0.0)) return table.front();
  if (share >= 1.0) return table.back();
  const double t = std::sqrt(share) * static_cast<double>(kNodes - 1);
  const auto i = std::min(static_cast<std::size_t>(t), kNodes - 2);
  // Linear in the radius between the nodes.
  const double low = static_cast<double>(i * i), high = static_cast<double>((i + 1) * (i + 1));
  return table[i] + (table[i + 1] - table[i]) * (t * t - low) / (high - low);
}
}  // namespace

double CutProfile::at(double r) const { return interpolated(*this, half_angle, r); }
double CutProfile::slope_at(double r) const { return interpolated(*this, slope, r); }
double CutProfile::involute_at(double r) const {
  return base_half_angle - involute_at_radius(base_radius, r);
}
double CutProfile::missing_at(double r) const {
  const double more = ring ? exact(r) - involute_at(r) : involute_at(r) - exact(r);
  return base_radius * more;
}

std::optional<CutProfile> cut_gear(const geometry::Gear<double>& g, double alpha) {
  const double x = g.profile_shift, z = g.teeth, r = 0.5 * z;
  const double thicker = g.machining_allowance / std::cos(alpha);
  CutProfile p;
  p.teeth = g.teeth;
  p.ring = g.kind == geometry::GearKind::kRing;
  p.base_radius = r * std::cos(alpha);
  if (!p.ring) {
    const auto rack = RackTool::make(g, alpha);
    if (!rack) return {};
    p.root_radius = rack->tip_line;
    p.tip_radius = r + g.rack.addendum + x - g.tip_shortening;
    p.base_half_angle = (kPi / 2.0 + 2.0 * x * std::tan(alpha) - thicker) / z + inv(alpha);
    if (!(p.tip_radius > p.root_radius)) return {};
    return tabulate(p,
                    [tool = *rack, pitch = kPi / z](double at) { return pitch - tool.space(at); });
  }
  p.root_radius = r + g.rack.dedendum + x;
  p.tip_radius = r - g.rack.addendum + x + g.tip_shortening;
  p.base_half_angle = (kPi / 2.0 + 2.0 * x * std::tan(alpha) + thicker) / z + inv(alpha);
  if (!(p.tip_radius < p.root_radius) || !(p.tip_radius > 0.0)) return {};
  if (g.cutter.teeth == 0) {
    RoundedInvolute space{.base = p.base_radius,
                          .base_half_angle = p.base_half_angle,
                          .outer = p.root_radius,
                          .corner_radius = 0.0,
                          .corner_center = 0.0};
    if (!space.round_corner(g.rack.root_radius)) return {};
    return tabulate(p, [space](double at) { return space.at(at); });
  }
  const auto tool = make_cutter(g, alpha);
  if (!tool) return {};
  return tabulate(p, [tool = *tool](double at) { return tool.space(at); });
}

namespace {

/// Depth of a point at (r, angle from the axis of symmetry) in the material beside one flank:
/// distance to the flank and to the tip circle, whichever is nearer.
double depth_in(const CutProfile& p, double r, double angle) {
  const double x = r * std::sin(angle), y = r * std::cos(angle);
  double nearest = kInfinity;
  double xa = 0.0, ya = 0.0;
  for (std::size_t i = 0; i < kNodes; ++i) {
    const double xb = p.radius(i) * std::sin(p.half_angle[i]);
    const double yb = p.radius(i) * std::cos(p.half_angle[i]);
    if (i > 0) {
      const double ux = xb - xa, uy = yb - ya, length2 = ux * ux + uy * uy;
      const double t =
          std::clamp(((x - xa) * ux + (y - ya) * uy) / std::max(length2, 1e-300), 0.0, 1.0);
      const double dx = xa + t * ux - x, dy = ya + t * uy - y;
      nearest = std::min(nearest, dx * dx + dy * dy);
    }
    xa = xb;
    ya = yb;
  }
  return std::min(std::sqrt(nearest), std::abs(p.reach - r));
}

}  // namespace

std::optional<RollingResult> roll(const SimulatedPair& pair, const CutProfile& gear1,
                                  const CutProfile& gear2) {
  const bool internal = gear2.ring;
  const double d = pair.center_distance;
  const double rb1 = gear1.base_radius, rb2 = gear2.base_radius;
  const double cos_w = (internal ? rb2 - rb1 : rb2 + rb1) / d;
  if (!(cos_w < 1.0) || !(cos_w > 0.0)) return {};
  const double line = d * std::sqrt(1.0 - cos_w * cos_w);  // d sin αw

  // `frame` stands still and offers its spaces; a tooth of `mate` sweeps through one of them.
  const CutProfile& frame = internal ? gear2 : gear1;
  const CutProfile& mate = internal ? gear1 : gear2;
  const double ratio = static_cast<double>(mate.teeth) / frame.teeth;
  const double pitch = kPi / frame.teeth;
  const auto space = [&](double r) { return internal ? frame.at(r) : pitch - frame.at(r); };
  const double sign = internal ? 1.0 : -1.0;

  RollingResult result;
  const double pitch_frame = frame.base_radius / cos_w, pitch_mate = mate.base_radius / cos_w;
  const double ideal_space =
      internal ? frame.involute_at(pitch_frame) : pitch - frame.involute_at(pitch_frame);
  const double play = ideal_space - ratio * mate.involute_at(pitch_mate);  // on either side
  result.normal_backlash = 2.0 * play * frame.base_radius;

  if (internal) {
    result.root1 = gear1.root_radius - (gear2.reach - d);
    result.root2 = d + gear1.reach - gear2.root_radius;
  } else {
    result.root1 = gear1.root_radius - (d - gear2.reach);
    result.root2 = gear2.root_radius - (d - gear1.reach);
  }

  // Where each tip wants contact on the mate, along the line of action.
  const auto along = [](const CutProfile& p) {
    return p.reach > p.base_radius ? std::sqrt(p.reach * p.reach - p.base_radius * p.base_radius)
                                   : 0.0;
  };
  result.contact_distance = internal ? std::array{along(gear2) - line, along(gear1) + line}
                                     : std::array{line - along(gear2), line - along(gear1)};
  const double frame_contact =
      std::hypot(frame.base_radius, result.contact_distance[internal ? 1 : 0]);
  // Contact ends at these angles from the line of centres; with some room, the mesh zone ends
  // there.
  const double working = std::acos(cos_w);
  double mesh_end = 0.0;
  for (double at : {frame_contact, frame.reach}) {
    if (at > frame.base_radius) {
      mesh_end = std::max(mesh_end, std::abs(std::acos(frame.base_radius / at) - working));
    } else {
      mesh_end = std::max(mesh_end, working);
    }
  }
  mesh_end = 1.1 * mesh_end + 0.01;

  const double low = internal ? frame.reach : std::max(frame.root_radius, d - mate.reach);
  const double high = internal ? std::min(frame.root_radius, d + mate.reach) : frame.reach;
  const auto consider = [&](double r, double b, double g) {
    if (!(g * r > 0.5 * kFaint.overlap)) return;
    const double x = r * std::sin(b), y = sign * (r * std::cos(b) - d);
    const double rho = std::hypot(x, y);
    const double below_frame = std::abs(r - frame.reach), below_mate = mate.reach - rho;
    const double slope = std::max(std::abs(frame.slope_at(r)), std::abs(mate.slope_at(rho)));
    const double roughly =
        std::min(g * r / std::sqrt(1.0 + slope * slope), std::max(below_frame, below_mate));
    Overlap& worst = std::abs(b) > mesh_end ? result.tips : result.mesh;
    if (roughly > worst.depth) {
      worst = {.depth = roughly,
               .radius1 = internal ? rho : r,
               .radius2 = internal ? r : rho,
               .angle_rad = b};
    }
  };
  const auto overlap_at = [&](double r, double b) {
    const double x = r * std::sin(b), y = sign * (r * std::cos(b) - d);
    return b - (std::atan2(x, y) - mate.at(std::hypot(x, y))) * ratio - space(r) + play;
  };
  for (int k = 0; k <= kRollRadii && high > low; ++k) {
    const double r = 0.5 * (low + high) - 0.5 * (high - low) * std::cos(kPi * k / kRollRadii);
    const double widest = angle_opposite(mate.reach, r, d);
    Pieces pieces;
    pieces.add_both(widest);
    pieces.add(0.0);
    pieces.sort();
    pieces.maxima([&](double b) { return overlap_at(r, b); }, 32, 12,
                  [&](double b, double g) { consider(r, b, g); });
  }
  // The true depth of the worst points: of the mate's flank in the frame's and the other way round.
  for (Overlap* worst : {&result.mesh, &result.tips}) {
    if (!(worst->depth > 0.0)) continue;
    const double r = internal ? worst->radius2 : worst->radius1;
    const double g = overlap_at(r, worst->angle_rad);
    const double in_frame = depth_in(frame, r, frame.at(r) + (internal ? g : -g));
    // Turning the frame's flank point back by g leaves it at nearly the same place.
    const double bf = worst->angle_rad - g;
    const double x = r * std::sin(bf), y = sign * (r * std::cos(bf) - d);
    const double turned = (worst->angle_rad - g - space(r) + play) / ratio;
    const double rho_f = std::hypot(x, y);
    const double in_mate =
        rho_f < mate.reach ? depth_in(mate, rho_f, std::atan2(x, y) - turned) : 0.0;
    worst->depth = std::max(in_frame, in_mate);
  }

  for (std::size_t k = 0; k < 2; ++k) {
    const CutProfile& p = k == 0 ? gear1 : gear2;
    const double distance = result.contact_distance[k];
    result.contact_radius[k] = std::hypot(p.base_radius, distance);
    if (distance < 0.0 || std::abs(p.reach - p.tip_radius) > kPlain.overlap) {
      result.missing[k] = kInfinity;
      continue;
    }
    for (int i = 0; i <= 64; ++i) {
      const double r = std::lerp(result.contact_radius[k], p.reach, i / 64.0);
      result.missing[k] = std::max(result.missing[k], p.missing_at(r));
    }
  }
  if (internal && pair.gear2.cutter.teeth > 0) {
    constexpr int kFeedPhases = 4;
    result.cutter_feed =
        cutter_feed_overlap(pair.gear2, pair.pressure_angle_rad, gear2, kFeedPhases);
  }
  return result;
}

std::string_view seen(const RollingResult& result, const Sight& sight) {
  if (std::max(result.missing[0], result.missing[1]) > sight.missing) return "flank lost";
  if (std::max(result.root1, result.root2) > sight.overlap) return "root";
  if (result.tips.depth > sight.overlap) return "tips";
  if (result.mesh.depth > sight.overlap) return "mesh";
  if (result.cutter_feed > sight.overlap) return "feed";
  return "";
}

double near_limit(std::string_view check) { return check == "tip_fouling" ? kNearGap : kNearLimit; }

Comparison compare(const RollingResult& result, std::span<const NamedMargin> margins) {
  Comparison comparison;
  double smallest = kInfinity;  // margin in shares of its band
  for (const NamedMargin& m : margins) {
    if (std::find(kInterferenceChecks.begin(), kInterferenceChecks.end(), m.name) ==
        kInterferenceChecks.end()) {
      continue;
    }
    const double share = m.margin / near_limit(m.name);
    if (std::abs(share) <= 1.0) comparison.away_from_limits = false;
    if (!comparison.worst || share < smallest) comparison.worst = m;
    smallest = std::min(smallest, share);
  }
  if (smallest >= 0.0) {
    if (!seen(result).empty()) comparison.agreement = Agreement::kMissed;
  } else if (smallest < -1.0 && seen(result, kFaint).empty()) {
    comparison.agreement = Agreement::kFalseAlarm;
  }
  return comparison;
}

namespace {

/// A toothed wheel that moves into a ring: its tooth's half-angle over radius.
struct Wheel {
  int teeth;
  double inner, outer;  ///< radii between which the flanks are looked at
  double distance;      ///< of its axis from the ring's in the end
};

template <class HalfAngle>
double radial_move_overlap(const Wheel& wheel, const HalfAngle& half_angle, const CutProfile& ring,
                           int phases) {
  const double tooth_pitch = 2.0 * kPi / wheel.teeth, space_pitch = 2.0 * kPi / ring.teeth;
  constexpr int kFlankPoints = 40, kPathPoints = 16;
  double worst = 0.0;
  for (int phase = 0; phase <= phases; ++phase) {
    const double turned = 0.5 * tooth_pitch * phase / phases;
    const double ring_turned = turned * wheel.teeth / ring.teeth;
    for (int tooth = -wheel.teeth / 2; tooth <= wheel.teeth / 2; ++tooth) {
      const double axis = turned + tooth * tooth_pitch;
      if (std::abs(axis) > 0.5 * kPi + tooth_pitch) continue;
      for (int point = 0; point <= 2 * kFlankPoints + 1; ++point) {
        const int i = point % (kFlankPoints + 1);
        const double side = point > kFlankPoints ? -1.0 : 1.0;
        // Points crowd at the tip, where a cutter's corner is round.
        const double t = static_cast<double>(i) / kFlankPoints;
        const double rho = wheel.outer - (wheel.outer - wheel.inner) * t * t;
        const double angle = axis + side * half_angle(rho);
        const double x = rho * std::sin(angle), y = wheel.distance + rho * std::cos(angle);
        const double end = std::hypot(x, y);
        if (y <= 0.0 || end <= ring.reach) continue;
        for (int k = 1; k <= kPathPoints; ++k) {
          const double r = std::lerp(ring.reach, end, static_cast<double>(k) / kPathPoints);
          if (r <= std::abs(x)) continue;
          const double at = std::asin(x / r) - ring_turned;
          const double from_space = std::abs(at - space_pitch * std::round(at / space_pitch));
          const double inside = r * (from_space - ring.at(r));
          if (!(inside > worst)) continue;
          const double slope = ring.slope_at(r);
          worst =
              std::max(worst, std::min(inside / std::sqrt(1.0 + slope * slope), r - ring.reach));
        }
      }
    }
  }
  return worst;
}

}  // namespace

double radial_assembly_overlap(const SimulatedPair& pair, const CutProfile& pinion,
                               const CutProfile& ring, int phases) {
  return radial_move_overlap(
      {.teeth = pinion.teeth,
       .inner = pinion.root_radius,
       .outer = pinion.reach,
       .distance = pair.center_distance},
      [&](double r) { return pinion.at(r); }, ring, phases);
}

double cutter_feed_overlap(const geometry::Gear<double>& gear, double alpha, const CutProfile& ring,
                           int phases) {
  const auto tool = make_cutter(gear, alpha);
  if (!tool) return 0.0;
  return radial_move_overlap(
      {.teeth = gear.cutter.teeth,
       .inner = tool->tooth.base,
       .outer = tool->tooth.outer,
       .distance = tool->center_distance},
      [&](double r) { return tool->tooth.at(r); }, ring, phases);
}

namespace {

/// Half-angle of the ideal tooth (external) or space (ring) at the base circle.
double base_half_angle(const geometry::Gear<double>& g, double alpha) {
  const double thinner = g.machining_allowance / std::cos(alpha);
  const double sign = g.kind == geometry::GearKind::kRing ? 1.0 : -1.0;
  return (kPi / 2.0 + 2.0 * g.profile_shift * std::tan(alpha) + sign * thinner) / g.teeth +
         inv(alpha);
}

double tip_radius(const geometry::Gear<double>& g) {
  const double sign = g.kind == geometry::GearKind::kRing ? -1.0 : 1.0;
  return 0.5 * g.teeth + g.profile_shift + sign * (g.rack.addendum - g.tip_shortening);
}

/// Centre distance at which the teeth without allowance have no backlash.
std::optional<double> tight_distance(const SimulatedPair& p) {
  const bool internal = p.gear2.kind == geometry::GearKind::kRing;
  const double teeth = internal ? p.gear2.teeth - p.gear1.teeth : p.gear1.teeth + p.gear2.teeth;
  const double shift = internal ? p.gear2.profile_shift - p.gear1.profile_shift
                                : p.gear1.profile_shift + p.gear2.profile_shift;
  const double alpha = p.pressure_angle_rad;
  const auto working = inverse_involute(inv(alpha) + 2.0 * std::tan(alpha) * shift / teeth);
  if (!working) return {};
  return 0.5 * teeth * std::cos(alpha) / std::cos(*working);
}

/// Whether the pair's tools exist and its teeth have a tip, contact and no negative backlash.
bool usable(const SimulatedPair& p, double least_contact_ratio) {
  constexpr double kLeastTip = 0.05;
  const double alpha = p.pressure_angle_rad, d = p.center_distance;
  const bool internal = p.gear2.kind == geometry::GearKind::kRing;
  const double rb1 = 0.5 * p.gear1.teeth * std::cos(alpha);
  const double rb2 = 0.5 * p.gear2.teeth * std::cos(alpha);
  const double cos_w = (internal ? rb2 - rb1 : rb1 + rb2) / d;
  if (!(cos_w > 0.0 && cos_w < 0.9999)) return false;
  const double line = d * std::sqrt(1.0 - cos_w * cos_w);
  std::array<double, 2> along{};
  for (int k = 0; k < 2; ++k) {
    const geometry::Gear<double>& g = k == 0 ? p.gear1 : p.gear2;
    const bool ring = g.kind == geometry::GearKind::kRing;
    const double rb = k == 0 ? rb1 : rb2, ra = tip_radius(g);
    if (ra < 0.5 * rb) return false;
    const double half = base_half_angle(g, alpha) - involute_at_radius(rb, ra);
    if (!(2.0 * ra * (ring ? kPi / g.teeth - half : half) >= kLeastTip)) return false;
    along[static_cast<std::size_t>(k)] = std::sqrt(std::max(ra * ra - rb * rb, 0.0));
    if (!ring && !RackTool::make(g, alpha)) return false;
    // The ideal space must reach down to the root circle.
    const double root = 0.5 * g.teeth + g.profile_shift + (ring ? 1.0 : -1.0) * g.rack.dedendum;
    if (ring && !(base_half_angle(g, alpha) - involute_at_radius(rb, root) > 0.02 / root))
      return false;
    if (!(g.tip_shortening >= 0.0) || !(g.rack.root_radius >= 0.0)) return false;
  }
  const double path = internal ? along[0] + line - along[1] : along[0] + along[1] - line;
  if (!(path >= least_contact_ratio * kPi * std::cos(alpha))) return false;
  const double inv_w = inv(std::acos(cos_w));
  const double half1 = base_half_angle(p.gear1, alpha) - inv_w;
  const double half2 = base_half_angle(p.gear2, alpha) - inv_w;
  const double play = internal ? half2 * p.gear2.teeth - half1 * p.gear1.teeth
                               : kPi - half2 * p.gear2.teeth - half1 * p.gear1.teeth;
  return play >= -1e-9;
}

double full_root_radius(const geometry::BasicRack<double>& rack, double allowance, double alpha) {
  const double land =
      kPi / 4.0 + 0.5 * allowance / std::cos(alpha) - rack.dedendum * std::tan(alpha);
  return land * std::cos(alpha) / (1.0 - std::sin(alpha));
}

}  // namespace

RandomPair::RandomPair(std::uint64_t seed, std::uint64_t number) {
  std::seed_seq sequence{seed & 0xffffffffU, seed >> 32U, number & 0xffffffffU, number >> 32U};
  generator_.seed(sequence);
}
double RandomPair::between(double low, double high) {
  return low + (high - low) * static_cast<double>(generator_() >> 11U) * 0x1p-53;
}
int RandomPair::count(int low, int high) {
  return low + static_cast<int>(generator_() % static_cast<std::uint64_t>(high - low + 1));
}

SimulatedPair RandomPair::pair() {
  const bool internal = count(0, 9) < 6;
  for (;;) {
    SimulatedPair p;
    const double alpha = count(0, 2) == 0 ? kPi / 9.0 : between(14.5, 25.0) * kPi / 180.0;
    p.pressure_angle_rad = alpha;
    geometry::Gear<double>&g1 = p.gear1, &g2 = p.gear2;
    g1.teeth = internal ? count(12, 60) : count(8, 60);
    g2.teeth = internal ? g1.teeth + count(6, 60) : count(8, 100);
    g2.kind = internal ? geometry::GearKind::kRing : geometry::GearKind::kExternal;
    const bool shifted = count(0, 3) > 0, thinned = count(0, 1) > 0, shortened = count(0, 2) > 0;
    const bool same_rack = count(0, 2) > 0;
    for (geometry::Gear<double>* g : {&g1, &g2}) {
      g->module_m = 1.0;
      g->profile_shift = shifted ? between(-0.5, internal ? 1.5 : 1.2) : 0.0;
      g->machining_allowance = thinned ? between(0.0, 0.1) : 0.0;
      g->rack.addendum = between(0.8, 1.2);
      g->rack.dedendum = g->rack.addendum + between(0.15, 0.35);
      if (same_rack && g == &g2) g2.rack = g1.rack;
      g->rack.root_radius = between(0.0, 1.0) *
                            std::min(0.6, full_root_radius(g->rack, g->machining_allowance, alpha));
    }
    // A ring whose shift differs much from its planet's has no common distance: draw it near.
    if (internal && shifted) g2.profile_shift = g1.profile_shift + between(-0.3, 0.8);
    if (g2.profile_shift > 1.5 || g2.profile_shift < -0.5) continue;
    if (internal && count(0, 1) > 0) {
      g2.cutter.teeth = count(10, std::max(11, std::min(g2.teeth - 8, 60)));
      g2.cutter.profile_shift = between(-0.2, 0.5);
      g2.cutter.tip_radius = between(0.0, 0.25);
    }
    const auto tight = tight_distance(p);
    if (!tight) continue;
    const double away =
        count(0, 2) > 0 ? (count(0, 2) > 0 ? between(0.0, 0.1) : 0.0) : between(0.0, 0.4);
    p.center_distance = *tight + (internal ? -away : away);
    if (shortened) {
      // Tips that keep a radial clearance, as a designer would turn them.
      const double keep = between(0.1, 0.3);
      for (int k = 0; k < 2; ++k) {
        geometry::Gear<double>& g = k == 0 ? g1 : g2;
        const geometry::Gear<double>& mate = k == 0 ? g2 : g1;
        const double mate_root =
            0.5 * mate.teeth + mate.profile_shift +
            (mate.kind == geometry::GearKind::kRing ? mate.rack.dedendum : -mate.rack.dedendum);
        double reach = 0.0;  // tip beyond the wanted clearance
        if (!internal) reach = tip_radius(g) - (p.center_distance - mate_root - keep);
        if (internal && k == 0) reach = p.center_distance + tip_radius(g) - (mate_root - keep);
        if (internal && k == 1) reach = mate_root + keep - (tip_radius(g) - p.center_distance);
        g.tip_shortening = std::max(0.0, reach) + (count(0, 3) == 0 ? between(0.0, 0.3) : 0.0);
      }
    }
    if (!usable(p, 1.0)) continue;
    const auto cut1 = cut_gear(g1, alpha), cut2 = cut_gear(g2, alpha);
    if (cut1 && cut2) return p;
  }
}

std::optional<SimulatedPair> RandomPair::move_near_limit(const SimulatedPair& base,
                                                         const NamedMargin& check,
                                                         const MarginsOf& margins_of) {
  const double within = test::near_limit(check.name);
  const auto tight = tight_distance(base);
  if (!tight) return {};
  const double away = base.center_distance - *tight;
  const int parameter = count(0, 8);
  const auto changed = [&](double t) -> std::optional<SimulatedPair> {
    SimulatedPair p = base;
    geometry::Gear<double>& g = parameter % 2 == 0 ? p.gear1 : p.gear2;
    switch (parameter) {
      case 0:
      case 1:
        g.rack.addendum += 0.4 * t;
        g.rack.dedendum += 0.4 * t;
        break;
      case 2:
      case 3:
        g.tip_shortening += 0.6 * t;
        break;
      case 4:
      case 5:
        g.profile_shift += 0.8 * t;
        break;
      case 6:
      case 7:
        g.rack.root_radius += 0.4 * t;
        break;
      default:
        p.center_distance += 0.4 * t;
    }
    if (parameter == 4 || parameter == 5) {
      const auto moved = tight_distance(p);
      if (!moved) return {};
      p.center_distance = *moved + away;
    }
    if (!usable(p, 0.9)) return {};
    return p;
  };
  const auto margin = [&](double t) -> std::optional<double> {
    const auto p = changed(t);
    if (!p) return {};
    for (const NamedMargin& m : margins_of(*p)) {
      if (m.name == check.name && m.gear == check.gear && std::isfinite(m.margin)) return m.margin;
    }
    return {};
  };
  const double wanted = between(-within, within);
  constexpr int kSteps = 12;
  std::optional<double> before;
  for (int k = 0; k <= kSteps; ++k) {
    const double t = -1.0 + 2.0 * k / kSteps;
    const auto here = margin(t);
    if (before && here && (*before - wanted) * (*here - wanted) <= 0.0) {
      double low = t - 2.0 / kSteps, high = t;
      const bool rising = *here > *before;
      for (int step = 0; step < 12; ++step) {
        const double middle = 0.5 * (low + high);
        const auto value = margin(middle);
        if (!value) return {};
        ((*value < wanted) == rising ? low : high) = middle;
      }
      const auto found = margin(low);
      if (!found || std::abs(*found) > within) return {};
      auto p = changed(low);
      if (!cut_gear(p->gear1, p->pressure_angle_rad) ||
          !cut_gear(p->gear2, p->pressure_angle_rad)) {
        return {};
      }
      return p;
    }
    before = here;
  }
  return {};
}

}  // namespace gear3k::test
