#include "strength/tooth_stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "numerics/gauss_rule.hpp"

namespace gear3k::strength {

namespace {

constexpr std::size_t kFlankSlices = 10;
constexpr int kCrossingSteps = 60;

/// A point of the flank: the contour's height above the base section, its chord, and the slope of
/// the height by ρ.
template <class T>
struct FlankPoint {
  T height_m{}, chord_m{}, slope{};
};

/// Half angle of the tooth where the flank is ρ from the tangent point.
template <class T>
T flank_half_angle(const ElasticTooth<T>& tooth, const T& roll) {
  using std::atan;
  return tooth.base_half_angle_rad - tooth.outwards * (roll - atan(roll));
}

template <class T>
FlankPoint<T> flank_point(const ElasticTooth<T>& tooth, const T& curvature_m) {
  using std::cos, std::sin, std::sqrt;
  const T roll = curvature_m / tooth.base_radius_m;
  const T stretch = sqrt(1.0 + roll * roll);  // r/rb
  const T psi = flank_half_angle(tooth, roll);
  const T c = cos(psi);
  const T s = sin(psi);
  const T radius = tooth.base_radius_m * stretch;
  return {.height_m = tooth.outwards * (radius * c - tooth.base.height_m),
          .chord_m = 2.0 * radius * s,
          .slope = tooth.outwards * (c + tooth.outwards * s * roll) * roll / stretch};
}

/// The same on the fillet, over γ.
template <class T>
FlankPoint<T> root_point(const ElasticTooth<T>& tooth, const T& gamma) {
  using std::cos, std::sin;
  const geometry::FilletPoint<T> p = geometry::fillet_point(tooth.fillet, gamma);
  const T psi = tooth.pitch_half_rad - p.angle_rad;
  const T c = cos(psi);
  const T s = sin(psi);
  return {.height_m = tooth.outwards * (p.radius_m * c - tooth.base.height_m),
          .chord_m = 2.0 * p.radius_m * s,
          .slope = tooth.outwards * (p.radius_slope_m * c + p.radius_m * p.angle_slope * s)};
}

/// The contour's values: what its points need of a tooth.
template <class T>
ElasticTooth<double> contour_values(const ElasticTooth<T>& tooth) {
  ElasticTooth<double> values;
  values.outwards = tooth.outwards;
  values.base_radius_m = value_of(tooth.base_radius_m);
  values.base_half_angle_rad = value_of(tooth.base_half_angle_rad);
  values.base.height_m = value_of(tooth.base.height_m);
  values.fillet = fillet_values<double>(tooth.fillet);
  values.pitch_half_rad = tooth.pitch_half_rad;
  return values;
}

/// Parameter between `low` and `high` at which a monotone height has a value.
/// @param point  FlankPoint<double>(double)
template <class Point>
double value_at_height(const Point& point, double height_m, double low, double high) {
  const bool rising = point(high).height_m >= point(low).height_m;
  double x = 0.5 * (low + high);
  for (int step = 0; step < kCrossingSteps; ++step) {
    const FlankPoint<double> p = point(x);
    const double miss = p.height_m - height_m;
    ((miss < 0.0) == rising ? low : high) = x;
    const double newton = x - miss / p.slope;
    const double next = newton >= low && newton <= high ? newton : 0.5 * (low + high);
    if (std::abs(next - x) <= 1e-15 * std::abs(x)) return next;
    x = next;
  }
  return x;
}

/// The same with its derivatives: the value is exact to rounding, each step of Newton doubles the
/// order of exact derivatives.
/// @param point  FlankPoint<T>(const T&)
template <class T, class Point>
T with_derivatives(const Point& point, const T& height_m, double value) {
  T result = constant<T>(value);
  if constexpr (!std::is_floating_point_v<T>) {
    for (int step = 0; step < 2; ++step) {
      const FlankPoint<T> p = point(result);
      result = result - (p.height_m - height_m) / p.slope;
    }
  }
  return result;
}

/// Slices of the contour between two parameters.
template <std::size_t kCount, class T, class Point>
std::array<BeamSlice<T>, kCount> slices_between(const Point& point, const T& from, const T& to) {
  static const std::array<numerics::GaussNode, kCount> kRule = numerics::gauss_rule<kCount>();
  std::array<BeamSlice<T>, kCount> slices{};
  const T span = to - from;
  for (std::size_t i = 0; i < kCount; ++i) {
    const FlankPoint<T> p = point(T(from + kRule[i].position * span));
    slices[i] = {.height_m = p.height_m,
                 .thickness_m = p.chord_m,
                 .length_m = kRule[i].weight * span * p.slope};
  }
  return slices;
}

}  // namespace

template <class T>
T beam_compliance(std::span<const BeamSlice<T>> slices, const BeamLoad<T>& load,
                  const BeamModuli& moduli) {
  T bending = constant<T>(0.0);
  T area = constant<T>(0.0);
  for (const BeamSlice<T>& slice : slices) {
    const T u = slice.height_m - load.crossing_height_m;
    const T share = slice.length_m / slice.thickness_m;
    area = area + share;
    bending = bending + share * u * u / (slice.thickness_m * slice.thickness_m);
  }
  const T tan2 = load.tan_angle * load.tan_angle;
  const T cos2 = 1.0 / (1.0 + tan2);
  return cos2 * ((12.0 / moduli.normal_Pa) * bending + (1.2 / moduli.shear_Pa) * area +
                 (1.0 / moduli.normal_Pa) * tan2 * area);
}

template <class T>
T body_compliance(const BeamLoad<T>& load, const T& base_chord_m, const Elasticity& material) {
  const double nu = material.poissons_ratio;
  const T p = load.crossing_height_m / base_chord_m;
  const T tan2 = load.tan_angle * load.tan_angle;
  return (5.306 * p * p + (2.0 * (1.0 - nu - 2.0 * nu * nu) / (1.0 - nu * nu)) * p +
          1.534 * (1.0 + (0.4167 / (1.0 + nu)) * tan2)) /
         ((1.0 + tan2) * material.plane_strain_modulus());
}

template <class T>
T contact_compliance(const T& depth_m, const T& half_width_m, const Elasticity& material) {
  using std::log, std::sqrt;
  const double nu = material.poissons_ratio;
  const T h = depth_m / half_width_m;
  const T root = sqrt(1.0 + h * h);
  // √(1 + h²) − h without cancellation.
  const T lateral = h / (root + h);
  return (2.0 / (std::numbers::pi * material.plane_strain_modulus())) *
         (log(h + root) - (nu / (1.0 - nu)) * lateral);
}

template <class T>
T contact_half_width(const T& line_load_N_m, const T& reduced_radius_m, const Elasticity& material1,
                     const Elasticity& material2) {
  using std::sqrt;
  const double compliance =
      1.0 / material1.plane_strain_modulus() + 1.0 / material2.plane_strain_modulus();
  return sqrt((4.0 * compliance / std::numbers::pi) * line_load_N_m * reduced_radius_m);
}

template <class T>
ElasticTooth<T> make_elastic_tooth(const geometry::GearGeometry<T>& gear,
                                   const geometry::ToothForm<T>& form) {
  ElasticTooth<T> tooth;
  tooth.outwards = gear.gear.kind == geometry::GearKind::kExternal ? 1.0 : -1.0;
  tooth.pitch_half_rad = std::numbers::pi / gear.gear.teeth;
  tooth.base_radius_m = gear.base_radius_m;
  tooth.base_half_angle_rad =
      tooth.pitch_half_rad - geometry::space_half_angle(gear, gear.base_radius_m);
  tooth.form_length_m = form.form_length_m;
  tooth.form_normal_angle_rad = form.form_normal_angle_rad;
  tooth.fillet = form.fillet;
  tooth.base = root_section(gear, form);
  tooth.form_height_m = root_point(tooth, form.form_normal_angle_rad).height_m;
  tooth.fillet_slices = slices_between<ElasticTooth<T>::kFilletSlices>(
      [&](const T& gamma) { return root_point(tooth, gamma); }, tooth.base.normal_angle_rad,
      form.form_normal_angle_rad);
  return tooth;
}

template <class T>
FlankLoad<T> flank_load(const ElasticTooth<T>& tooth, const T& curvature_m) {
  using std::atan, std::cos, std::sin, std::sqrt, std::tan;
  const T roll = curvature_m / tooth.base_radius_m;
  const T psi = flank_half_angle(tooth, roll);
  const T angle = atan(roll) - tooth.outwards * psi;
  const T cos_angle = cos(angle);
  FlankLoad<T> load;
  load.beam.tan_angle = tan(angle);
  load.beam.crossing_height_m =
      tooth.outwards * (tooth.base_radius_m / cos_angle - tooth.base.height_m);
  load.depth_m = tooth.base_radius_m * sqrt(1.0 + roll * roll) * sin(psi) / cos_angle;
  return load;
}

template <class T>
T tooth_compliance(const ElasticTooth<T>& tooth, const FlankLoad<T>& load,
                   const Elasticity& material) {
  const BeamModuli moduli{
      .normal_Pa = material.plane_strain_modulus(),
      .shear_Pa = material.youngs_modulus_Pa / (2.0 * (1.0 + material.poissons_ratio))};
  const T& h_c = load.beam.crossing_height_m;
  const auto compliance = [&](std::span<const BeamSlice<T>> slices) {
    return beam_compliance(slices, load.beam, moduli);
  };
  const auto on_fillet = [&](const T& gamma) { return root_point(tooth, gamma); };
  const auto on_flank = [&](const T& rho) { return flank_point(tooth, rho); };
  T beam = body_compliance(load.beam, tooth.base.chord_m, material);
  if (value_of(h_c) <= 0.0) {
    const auto beyond = slices_between<2>(
        [&](const T& height) {
          return FlankPoint<T>{
              .height_m = height, .chord_m = tooth.base.chord_m, .slope = constant<T>(1.0)};
        },
        constant<T>(0.0), h_c);
    return beam + compliance(beyond);
  }
  const ElasticTooth<double> contour = contour_values(tooth);
  const double crossing = value_of(h_c);
  if (crossing < value_of(tooth.form_height_m)) {
    const double end = value_at_height([&](double gamma) { return root_point(contour, gamma); },
                                       crossing, value_of(tooth.form_normal_angle_rad),
                                       value_of(tooth.base.normal_angle_rad));
    const auto part = slices_between<ElasticTooth<T>::kFilletSlices>(
        on_fillet, tooth.base.normal_angle_rad, with_derivatives(on_fillet, h_c, end));
    return beam + compliance(part);
  }
  beam = beam + compliance(tooth.fillet_slices);
  // From the form circle on, the height rises towards the tip.
  const double begin = value_of(tooth.form_length_m);
  double end = begin;
  double step = 0.25 * tooth.outwards * value_of(tooth.base.chord_m);
  for (int i = 0; i < kCrossingSteps && flank_point(contour, end).height_m < crossing; ++i) {
    end += step;
    step *= 2.0;
  }
  const double value = value_at_height([&](double rho) { return flank_point(contour, rho); },
                                       crossing, std::min(begin, end), std::max(begin, end));
  const auto flank = slices_between<kFlankSlices>(on_flank, tooth.form_length_m,
                                                  with_derivatives(on_flank, h_c, value));
  return beam + compliance(flank);
}

#define INSTANTIATE(T)                                                                        \
  template T beam_compliance<T>(std::span<const BeamSlice<T>>, const BeamLoad<T>&,            \
                                const BeamModuli&);                                           \
  template T body_compliance<T>(const BeamLoad<T>&, const T&, const Elasticity&);             \
  template T contact_compliance<T>(const T&, const T&, const Elasticity&);                    \
  template T contact_half_width<T>(const T&, const T&, const Elasticity&, const Elasticity&); \
  template ElasticTooth<T> make_elastic_tooth<T>(const geometry::GearGeometry<T>&,            \
                                                 const geometry::ToothForm<T>&);              \
  template FlankLoad<T> flank_load<T>(const ElasticTooth<T>&, const T&);                      \
  template T tooth_compliance<T>(const ElasticTooth<T>&, const FlankLoad<T>&, const Elasticity&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
