#pragma once
// Laws of friction whose shape is free: the level at the middle and how the law bends are
// parameters too.

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

#include "calibrate/causes/friction_change.hpp"

namespace gear3k::calibrate {

/// Names of forms: a law with its level, with its level and a curvature, and with an S-shape too.
inline constexpr std::string_view kAnyLevel = "any_level", kAnyCurve = "any_curve",
                                  kAnyShape = "any_shape";

/// Appends what a form's name says: level, curvature and skewness.
inline void add_shape_parameters(const Form& form, std::vector<ParameterRecord>& parameters) {
  const bool shape = form.name == kAnyShape;
  const bool curve = shape || form.name == kAnyCurve;
  if (curve || form.name == kAnyLevel) parameters.push_back(level_parameter());
  const auto bend = [&](std::string_view name) {
    constexpr double kMost = 3.0;
    parameters.push_back({.name = name,
                          .unit = "",
                          .lower = -kMost,
                          .upper = kMost,
                          .plausible_low = -kMost,
                          .plausible_high = kMost});
  };
  if (curve) bend("curvature");
  if (shape) bend("skewness");
}

/// Half the range over which a law bends, in its variable; of a form that a model states without it
/// 1, as it does not bend.
inline double half_range_of(const Form& form) {
  const auto at = std::ranges::find_if(
      form.constants, [](const FormConstant& c) { return c.name.ends_with("half_range"); });
  return at != form.constants.end() && at->value > 0.0 ? at->value : 1.0;
}

/// Sets them.
/// @param p  of the form, without those of the law itself
inline void change_shape(std::span<const Scalar> p, double half_range,
                         efficiency::FrictionBend<Scalar>& bend, Modification& m) {
  if (!p.empty()) change_level(p[0], m);
  if (p.size() > 1) bend.quadratic = p[1];
  if (p.size() > 2) bend.cubic = p[2];
  bend.half_range = half_range;
}

/// Appends the forms of free shape of a law about its middle.
/// @param form  without name
inline void add_free_shapes(const Form& form, std::vector<Form>& forms) {
  for (const std::string_view name : {kAnyLevel, kAnyCurve, kAnyShape}) {
    Form free = form;
    free.name = name;
    free.weight = 0.0;
    forms.push_back(std::move(free));
  }
}

}  // namespace gear3k::calibrate
