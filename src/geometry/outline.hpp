#pragma once
// The generated tooth as a list of points: what a workshop cuts and a drawing shows.

#include <vector>

#include "geometry/tooth_form.hpp"

namespace gear3k::geometry {

struct Point {
  double x_m = 0.0, y_m = 0.0;
};

/// One pitch of a gear's contour, from the middle of one tooth space over the tooth to the middle
/// of the next: root, fillet, flank, tip, flank, fillet, root.  The tooth is centred on the +x
/// axis, the gear on the origin; angles increase along the list.  Rings likewise: their tooth
/// points inwards.
///
/// Every point lies on the contour to rounding; between two points the chord leaves it by at most
/// `chord_error_m`.  A tooth that is pointed below its tip circle ends at its point.  Where a
/// ring's tip lies inside its base circle, the flank is continued radially.
/// Source: docs/theory §22.
/// @throws std::invalid_argument unless chord_error_m > 0
std::vector<Point> tooth_outline(const GearGeometry<double>& gear, double chord_error_m);

/// The closed contour of the whole gear: tooth_outline() turned from tooth to tooth, tooth 0 on the
/// +x axis, counter-clockwise; the first point is not repeated at the end.
std::vector<Point> gear_outline(const GearGeometry<double>& gear, double chord_error_m);

/// The points turned by an angle [rad] about the origin, then moved.
std::vector<Point> placed(const std::vector<Point>& points, double angle_rad, Point center);

}  // namespace gear3k::geometry
