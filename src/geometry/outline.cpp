#include "geometry/outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

namespace gear3k::geometry {

namespace {

constexpr int kChordBisections = 60;
constexpr double kOnAxis_rad = 1e-12;
constexpr int kGreatestDepth = 20;
/// Share of the chord error that the sampled deviations may use up; the rest is for the deviation
/// between the samples.
constexpr double kSampledShare = 0.8;

/// A point of half a tooth: radius, and angle from the tooth's axis.
struct Polar {
  double radius_m = 0.0, angle_rad = 0.0;
};

Point cartesian(const Polar& p) {
  return {.x_m = p.radius_m * std::cos(p.angle_rad), .y_m = p.radius_m * std::sin(p.angle_rad)};
}

/// A piece of the contour over t in [0, 1].
using Piece = std::function<Polar(double)>;

double distance_to_chord(const Point& p, const Point& a, const Point& b) {
  const double ux = b.x_m - a.x_m, uy = b.y_m - a.y_m;
  const double px = p.x_m - a.x_m, py = p.y_m - a.y_m;
  const double length = std::hypot(ux, uy);
  if (!(length > 0.0)) return std::hypot(px, py);
  return std::abs(ux * py - uy * px) / length;
}

class HalfTooth {
 public:
  HalfTooth(const GearGeometry<double>& gear, double chord_error_m)
      : gear_(gear), form_(make_tooth_form(gear)), allowed_m_(kSampledShare * chord_error_m) {}

  /// From the middle of the space to the tooth's axis.
  std::vector<Polar> points() {
    const double pitch_half = std::numbers::pi / gear_.gear.teeth;
    const FilletPoint<double> root = fillet_point(form_.fillet, std::numbers::pi / 2.0);
    add_arc(root.radius_m, pitch_half, pitch_half - root.angle_rad);
    bool open = add_until_tip([&](double t) {
      const double end = std::numbers::pi / 2.0;
      const FilletPoint<double> p =
          fillet_point(form_.fillet, end + t * (form_.form_normal_angle_rad - end));
      return Polar{.radius_m = p.radius_m, .angle_rad = pitch_half - p.angle_rad};
    });
    const bool radial_end = is_ring() && gear_.tip_radius_m < gear_.base_radius_m;
    const double flank_end = radial_end ? gear_.base_radius_m : gear_.tip_radius_m;
    if (open) {
      open = add_until_tip([&](double t) {
        const double r = form_.form_radius_m + t * (flank_end - form_.form_radius_m);
        return Polar{.radius_m = r, .angle_rad = pitch_half - space_half_angle(gear_, r)};
      });
    }
    if (open && radial_end) {
      points_.push_back({.radius_m = gear_.tip_radius_m, .angle_rad = points_.back().angle_rad});
    }
    // A pointed tooth was followed to its axis, to rounding.
    if (points_.back().angle_rad < kOnAxis_rad) points_.back().angle_rad = 0.0;
    if (points_.back().angle_rad > 0.0) {
      add_arc(points_.back().radius_m, points_.back().angle_rad, 0.0);
    }
    return points_;
  }

 private:
  [[nodiscard]] bool is_ring() const { return gear_.gear.kind == GearKind::kRing; }

  /// True where a contour point is no longer part of the tooth: past its tip circle or its axis.
  [[nodiscard]] bool past_tip(const Polar& p) const {
    return p.angle_rad < 0.0 ||
           (is_ring() ? p.radius_m < gear_.tip_radius_m : p.radius_m > gear_.tip_radius_m);
  }

  /// Adds a piece as far as the tooth goes.  @returns whether it goes on after it
  bool add_until_tip(const Piece& piece) {
    if (past_tip(piece(0.0))) return false;
    const bool whole = !past_tip(piece(1.0));
    double end = 1.0;
    if (!whole) {
      double low = 0.0;
      for (int i = 0; i < kChordBisections; ++i) {
        const double middle = 0.5 * (low + end);
        (past_tip(piece(middle)) ? end : low) = middle;
      }
      end = low;
    }
    add([&](double t) { return piece(t * end); });
    return whole;
  }

  void add_arc(double radius_m, double from_rad, double to_rad) {
    add([=](double t) {
      return Polar{.radius_m = radius_m, .angle_rad = from_rad + t * (to_rad - from_rad)};
    });
  }

  void add(const Piece& piece) {
    const Polar first = piece(0.0), last = piece(1.0);
    if (points_.empty()) points_.push_back(first);
    const double length = std::hypot(cartesian(last).x_m - cartesian(points_.back()).x_m,
                                     cartesian(last).y_m - cartesian(points_.back()).y_m);
    if (length > 1e-12 * gear_.reference_radius_m) refine(piece, 0.0, 1.0, 0);
  }

  /// Adds points over (t0, t1] so that the chords stay within the allowed deviation.
  void refine(const Piece& piece, double t0, double t1, int depth) {
    const Point a = cartesian(piece(t0)), b = cartesian(piece(t1));
    double deviation = 0.0;
    for (const double share : {0.25, 0.5, 0.75}) {
      const Point p = cartesian(piece(t0 + share * (t1 - t0)));
      deviation = std::max(deviation, distance_to_chord(p, a, b));
    }
    if (depth < kGreatestDepth && deviation > allowed_m_) {
      const double middle = 0.5 * (t0 + t1);
      refine(piece, t0, middle, depth + 1);
      refine(piece, middle, t1, depth + 1);
    } else {
      points_.push_back(piece(t1));
    }
  }

  const GearGeometry<double>& gear_;
  ToothForm<double> form_;
  double allowed_m_;
  std::vector<Polar> points_;
};

}  // namespace

std::vector<Point> tooth_outline(const GearGeometry<double>& gear, double chord_error_m) {
  if (!(chord_error_m > 0.0)) {
    throw std::invalid_argument(
        fmt::format("outline: chord error = {} m, allowed: above 0", chord_error_m));
  }
  const std::vector<Polar> half = HalfTooth(gear, chord_error_m).points();
  std::vector<Point> points;
  points.reserve(2 * half.size());
  for (const Polar& p : half) points.push_back(cartesian({p.radius_m, -p.angle_rad}));
  for (auto p = half.rbegin(); p != half.rend(); ++p) {
    if (p->angle_rad > 0.0) points.push_back(cartesian(*p));
  }
  return points;
}

std::vector<Point> gear_outline(const GearGeometry<double>& gear, double chord_error_m) {
  std::vector<Point> tooth = tooth_outline(gear, chord_error_m);
  tooth.pop_back();  // the middle of the space: the next tooth's first point
  std::vector<Point> points;
  const int z = gear.gear.teeth;
  points.reserve(tooth.size() * static_cast<std::size_t>(z));
  for (int k = 0; k < z; ++k) {
    const std::vector<Point> turned = placed(tooth, 2.0 * std::numbers::pi * k / z, {});
    points.insert(points.end(), turned.begin(), turned.end());
  }
  return points;
}

std::vector<Point> placed(const std::vector<Point>& points, double angle_rad, Point center) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  std::vector<Point> result;
  result.reserve(points.size());
  for (const Point& p : points) {
    result.push_back(
        {.x_m = center.x_m + c * p.x_m - s * p.y_m, .y_m = center.y_m + s * p.x_m + c * p.y_m});
  }
  return result;
}

}  // namespace gear3k::geometry
