#pragma once
// Laws of friction whose shape is free: the level at the middle and how the law bends are
// parameters too.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "calibrate/causes/friction_change.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

/// Names of forms: a law with its level, with its level and a curvature, and with an S-shape too;
/// a level with any smooth curve through 5 or 7 places; and one through the 4 to 7 levels that the
/// data have, "any_smooth_4_levels".
inline constexpr std::string_view kAnyLevel = "any_level", kAnyCurve = "any_curve",
                                  kAnyShape = "any_shape", kAnySmooth = "any_smooth",
                                  kAnyFineSmooth = "any_smooth_fine", kLevels = "_levels";
/// Constants of a form through levels: x of those between the first and the last.
inline constexpr std::string_view kPlace = "place_";
/// At the end of the name of a form that takes the torque that R2's teeth carry in the place of
/// each mesh's force: every mesh by its own share of the load.
inline constexpr std::string_view kByTorque = "_by_torque";
/// The same with that torque by each mesh's own force: with what is lost between it and R2.
inline constexpr std::string_view kByShare = "_by_share";
/// What of the load a form takes.
inline std::string_view load_variable(const Form& form) {
  for (const std::string_view name : {kByTorque, kByShare}) {
    if (form.name.ends_with(name)) return name;
  }
  return {};
}

inline bool is_smooth(const Form& form) { return form.name.starts_with(kAnySmooth); }
/// Whether every level of a condition has a value of its own: what lies between is not known.
inline bool is_of_levels(const Form& form) {
  return is_smooth(form) && form.name.find(kLevels) != std::string::npos;
}
/// Whether a form is for the end of a search: it says little that the others of its cause do not.
inline bool is_refinement(const Form& form) {
  return is_smooth(form) || !load_variable(form).empty();
}

/// Where a smooth curve has values of its own: those of x that are given, or even ones.
inline int places_of(const Form& form) {
  constexpr int kCoarse = 5, kFine = 7;
  if (!is_of_levels(form)) return form.name.starts_with(kAnyFineSmooth) ? kFine : kCoarse;
  return form.name[kAnySmooth.size() + 1] - '0';
}

/// Appends what a form's name says: level, curvature and skewness.
inline void add_shape_parameters(const Form& form, std::vector<ParameterRecord>& parameters) {
  const bool shape = form.name.starts_with(kAnyShape);
  const bool curve = shape || form.name.starts_with(kAnyCurve);
  if (curve || is_smooth(form) || form.name.starts_with(kAnyLevel)) {
    parameters.push_back(level_parameter());
  }
  if (is_smooth(form)) {
    // ln of friction over that at the middle, at the other places.
    constexpr std::array<std::string_view, efficiency::kMostCurvePlaces> kNames{
        "log_change_1", "log_change_2", "log_change_3", "log_change_4",
        "log_change_5", "log_change_6", "log_change_7"};
    const auto places = static_cast<std::size_t>(places_of(form));
    for (std::size_t k = 0; k < places; ++k) {
      if (k == places / 2) continue;
      constexpr double kMost = 4.0;
      parameters.push_back({.name = kNames[k],
                            .unit = "",
                            .lower = -kMost,
                            .upper = kMost,
                            .plausible_low = -kMost,
                            .plausible_high = kMost});
    }
  }
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

/// Sets level and curve of a form of any smooth shape.
inline void change_smoothly(const Form& form, std::span<const Scalar> p,
                            efficiency::FrictionBend<Scalar>& bend, Modification& m) {
  change_level(p[0], m);
  const std::size_t middle = p.size() / 2;
  for (std::size_t k = 1; k < p.size(); ++k) bend.s[k <= middle ? k - 1 : k] = p[k];
  bend.places = static_cast<int>(p.size());
  bend.half_range = half_range_of(form);
  if (!is_of_levels(form)) return;
  bend.x[0] = -1.0;
  std::size_t place = 1;
  for (const FormConstant& c : form.constants) {
    if (c.name.starts_with(kPlace)) bend.x[place++] = c.value;
  }
  bend.x[place] = 1.0;
}

/// Whether each of several even places over the range of some values is the nearest to one of them:
/// what has no rows near it is no part of a curve.
inline bool cover(const std::vector<double>& values, int places) {
  const ValueRange range = range_of(values);
  if (!range.varies()) return false;
  std::vector<bool> covered(static_cast<std::size_t>(places), false);
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    const double at = (value - range.low) / (range.high - range.low) * (places - 1);
    covered[static_cast<std::size_t>(std::lround(at))] = true;
  }
  return std::ranges::find(covered, false) == covered.end();
}

/// The levels that values have, where they are so few that a curve through them holds all that the
/// data say of a law, and more than a curve of fewer parameters goes through; else none.
inline std::vector<double> few_levels(std::vector<double> values) {
  constexpr std::size_t kFewest = 4, kMost = efficiency::kMostCurvePlaces;
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  std::ranges::sort(values);
  if (values.empty()) return {};
  constexpr double kSame = 0.01, kApart = 0.04;  // of the range
  const double range = values.back() - values.front();
  std::vector<double> levels;
  double low = values.front(), sum = 0.0, count = 0.0;
  for (const double v : values) {
    if (v - low > kSame * range) {
      levels.push_back(sum / count);
      if (levels.size() >= kMost || v - levels.back() < kApart * range) return {};
      low = v;
      sum = count = 0.0;
    }
    sum += v;
    count += 1.0;
  }
  levels.push_back(sum / count);
  return levels.size() < kFewest ? std::vector<double>{} : levels;
}

/// What rows state, or ln of it.
inline std::vector<double> stated(const MeasurementSet& data, double Condition::*member,
                                  bool logarithm) {
  std::vector<double> values;
  values.reserve(data.rows.size());
  for (const Observation& row : data.rows) {
    const double value = row.condition.*member;
    values.push_back(logarithm ? std::log(value) : value);
  }
  return values;
}

/// Appends the forms of free shape of a law about its middle.
/// @param form  without name
/// @param values  of the law's variable in the data
inline void add_free_shapes(const Form& form, const std::vector<double>& values,
                            std::vector<Form>& forms) {
  for (const std::string_view name :
       {kAnyLevel, kAnyCurve, kAnyShape, kAnySmooth, kAnyFineSmooth}) {
    if (name == kAnySmooth && !cover(values, 5)) continue;
    if (name == kAnyFineSmooth && !cover(values, 7)) continue;
    Form free = form;
    free.name = name;
    free.weight = 0.0;
    forms.push_back(std::move(free));
  }
  const std::vector<double> levels = few_levels(values);
  if (levels.empty()) return;
  Form free = form;
  free.name = std::string(kAnySmooth) + "_" + std::to_string(levels.size()) + std::string(kLevels);
  free.weight = 0.0;
  const double low = levels.front(), high = levels.back();
  for (std::size_t k = 1; k + 1 < levels.size(); ++k) {
    free.constants.push_back({.name = std::string(kPlace) + std::to_string(k + 1),
                              .unit = "",
                              .value = (2.0 * levels[k] - low - high) / (high - low)});
  }
  forms.push_back(std::move(free));
}

}  // namespace gear3k::calibrate
