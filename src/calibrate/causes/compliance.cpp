#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::compliance {

namespace {

constexpr const char* kHardening = "hardening";
constexpr const char* kPreloaded = "preloaded";
constexpr const char* kTwoStage = "two_stage";
constexpr const char* kAnyStages = "any_stages";
constexpr const char* kHardeningTorque = "hardening_torque";

/// Parameter of a torque within a range about the middle of it.
ParameterRecord torque_change(std::string_view name, double most) {
  return {.name = name,
          .unit = "",
          .lower = -most,
          .upper = most,
          .plausible_low = -most,
          .plausible_high = most,
          .is_of_shape = true};
}

/// Names of the parameters and constants of a form of several stages.
struct StageNames {
  const char* windup;
  const char* torque;
};
constexpr std::array<StageNames, backlash::kMostSoftStages> kStages{
    {{.windup = "soft_windup_1", .torque = "soft_torque_1"},
     {.windup = "soft_windup_2", .torque = "soft_torque_2"},
     {.windup = "soft_windup_3", .torque = "soft_torque_3"},
     {.windup = "soft_windup_4", .torque = "soft_torque_4"},
     {.windup = "soft_windup_5", .torque = "soft_torque_5"}}};

/// Parameter of what winds up until a torque is reached.
/// @param is_of_shape  one of several: rows that would have it below 0 soften with the torque,
/// there
ParameterRecord soft_windup(const char* name, bool is_of_shape) {
  return {.name = name,
          .unit = "arcmin",
          .lower = 0.0,
          .upper = 1e4,
          .plausible_low = 0.0,
          .plausible_high = 1e3,
          .is_of_shape = is_of_shape};
}

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  std::vector<ParameterRecord> result{{.name = "compliance",
                                       .unit = "arcmin/Nm",
                                       .lower = 0.0,
                                       .upper = 1e3,
                                       .plausible_low = 0.0,
                                       .plausible_high = 10.0}};
  if (form.name == kHardening) {
    // Compliance by T^(-h): points that touch have 1/3 (Hertz), a cone 1/2 (Sneddon), rough seats
    // up to 1, as their approach goes with ln T (Persson 2007).  Beyond 1/2 the fit would take up
    // play, which is `clearance`, but a gearbox may well be so soft at first.
    constexpr double kSoftestOfFit = 0.5, kSoftest = 1.0;
    result.push_back({.name = "hardening",
                      .unit = "",
                      .lower = -1.0,
                      .upper = kSoftestOfFit,
                      .plausible_low = -0.2,
                      .plausible_high = kSoftest});
  }
  if (form.name == kPreloaded) {
    result.push_back(torque_change("log_preload_torque_change", half_range_of(form)));
  }
  if (form.name == kTwoStage) {
    result.push_back(soft_windup("soft_windup", false));
    result.push_back(torque_change("log_soft_torque_change", half_range_of(form)));
  }
  if (form.name == kAnyStages) {
    for (std::size_t k = 0; k < form.constants.size(); ++k) {
      result.push_back(soft_windup(kStages[k].windup, true));
    }
  }
  return result;
}

/// Test torques above 0, rising.
std::vector<double> loaded_torques(const MeasurementSet& data) {
  std::vector<double> torque_Nm;
  for (const Observation& row : data.rows) {
    if (row.condition.test_torque_Nm > 0.0) torque_Nm.push_back(row.condition.test_torque_Nm);
  }
  std::ranges::sort(torque_Nm);
  return torque_Nm;
}

/// The first torque that is more than another one.
double next_torque(const std::vector<double>& rising_Nm, double torque_Nm) {
  constexpr double kApart = 1.02;
  const auto next =
      std::ranges::find_if(rising_Nm, [&](double t) { return t > kApart * torque_Nm; });
  return next == rising_Nm.end() ? HUGE_VAL : *next;
}

/// Test torques between which what is soft at first may come to its end: a quarter of the loaded
/// rows, and two torques at least, lie at or below.  Otherwise it would be a constant in disguise,
/// which is `clearance`.
ValueRange soft_torques(const std::vector<double>& rising_Nm) {
  if (rising_Nm.empty()) return {};
  const double second_Nm = next_torque(rising_Nm, rising_Nm.front());
  if (!std::isfinite(second_Nm)) return {};
  return {.low = std::max(second_Nm, rising_Nm[rising_Nm.size() / 4]), .high = rising_Nm.back()};
}

/// Preloads that rows of three torques at least can tell: from the least torque, as one below it
/// would be a constant in disguise, to where the wind-up over the greatest is nearly straight.
ValueRange preload_torques(const std::vector<double>& rising_Nm) {
  if (rising_Nm.empty()) return {};
  const double second_Nm = next_torque(rising_Nm, rising_Nm.front());
  if (!std::isfinite(next_torque(rising_Nm, second_Nm))) return {};
  constexpr double kNearlyStraight = 4.0;
  return {.low = rising_Nm.front(), .high = kNearlyStraight * rising_Nm.back()};
}

/// Torques at which a wind-up of any falling softness changes: the levels of few between the first
/// and the last, or those that part the rows into equal shares.  One below the second torque would
/// be a constant in disguise.
std::vector<double> stage_torques(const std::vector<double>& rising_Nm) {
  std::vector<double> levels;
  for (double t = rising_Nm.empty() ? HUGE_VAL : rising_Nm.front(); std::isfinite(t);
       t = next_torque(rising_Nm, t)) {
    levels.push_back(t);
  }
  constexpr std::size_t kFewestLevels = 4, kMostLevels = kStages.size() + 2;
  if (levels.size() < kFewestLevels) return {};
  if (levels.size() <= kMostLevels) return {levels.begin() + 1, levels.end() - 1};
  std::vector<double> result;
  for (std::size_t k = 1; k <= kStages.size(); ++k) {
    const double t = rising_Nm[k * (rising_Nm.size() - 1) / (kStages.size() + 1)];
    if (t >= levels[1] && t < levels.back() && (result.empty() || t > result.back())) {
      result.push_back(t);
    }
  }
  return result;
}

/// A form with a torque that is free within a range.
/// @param name  of that torque
Form form_about(const char* form, const char* name, const ValueRange& torque) {
  return {.name = form,
          .constants = {{.name = name, .unit = "Nm", .value = std::sqrt(torque.low * torque.high)},
                        {.name = "torque_half_range",
                         .unit = "",
                         .value = 0.5 * std::log(torque.high / torque.low)}},
          .weight = 0.0};
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kLostMotion && o.kind != Kind::kTorqueAngle) return {};
  std::vector<Form> result{{.name = "output"}};
  // Once it is found: teeth and bearings that touch more as the torque grows are soft near zero.
  const ValueRange torque = range_of(*o.data, &Condition::test_torque_Nm);
  if (torque.varies()) {
    result.push_back({.name = kHardening,
                      .constants = {{.name = kHardeningTorque, .unit = "Nm", .value = torque.high}},
                      .weight = 0.0});
  }
  const std::vector<double> loaded = loaded_torques(*o.data);
  // Rough joints that a preload presses together, and the torque more and more.
  if (const ValueRange preload = preload_torques(loaded); preload.varies()) {
    result.push_back(form_about(kPreloaded, "preload_torque", preload));
    result.back().constants.push_back(
        {.name = kHardeningTorque, .unit = "Nm", .value = loaded.back()});
  }
  // Bearings whose rollers do not all carry yet, or a flexible part that settles: soft up to a
  // torque.
  const ValueRange soft = soft_torques(loaded);
  constexpr double kApart = 1.2;
  if (soft.high > kApart * soft.low) {
    result.push_back(form_about(kTwoStage, "soft_torque", soft));
  }
  // Several of these one after another, or what softens in no such pieces.
  if (const std::vector<double> stages = stage_torques(loaded); stages.size() > 1) {
    result.push_back({.name = kAnyStages, .constants = {}, .weight = 0.0});
    for (std::size_t k = 0; k < stages.size(); ++k) {
      result.back().constants.push_back(
          {.name = kStages[k].torque, .unit = "Nm", .value = stages[k]});
    }
  }
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition&, Kind kind,
           Modification& m) {
  auto& e = m.gearbox.lost_motion;
  e.compliance_rad_Nm = e.compliance_rad_Nm + p[0] * response_unit(kind).si;
  if (form.name == kHardening) {
    e.hardening = p[1];
    e.hardening_torque_Nm = form.constant(kHardeningTorque);
  }
  if (form.name == kPreloaded) {
    using std::exp;
    e.preload_torque_Nm = Scalar(form.constant("preload_torque") * exp(p[1]));
    e.hardening_torque_Nm = form.constant(kHardeningTorque);
  }
  if (form.name == kTwoStage) {
    using std::exp;
    e.soft[0] = {.windup_rad = p[1] * response_unit(kind).si,
                 .torque_Nm = Scalar(form.constant("soft_torque") * exp(p[2]))};
  }
  if (form.name == kAnyStages) {
    for (std::size_t k = 0; k < form.constants.size(); ++k) {
      e.soft[k] = {.windup_rad = p[k + 1] * response_unit(kind).si,
                   .torque_Nm = Scalar(form.constants[k].value)};
    }
  }
}

/// The preload's torque, and where what is soft at first comes to its end.
std::vector<DerivedParameter> torques(const Form& form, std::span<const Scalar> p,
                                      const Simulation&, const Modification&) {
  using std::exp;
  const bool preloaded = form.name == kPreloaded;
  if (!preloaded && form.name != kTwoStage) return {};
  const char* name = preloaded ? "preload_torque" : "soft_torque";
  return {{.record = {.name = name,
                      .unit = "Nm",
                      .lower = -HUGE_VAL,
                      .upper = HUGE_VAL,
                      .plausible_low = 0.0,
                      .plausible_high = HUGE_VAL},
           .value = Scalar(form.constant(name) * exp(p.back()))}};
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "compliance",
                  .title = "elastic wind-up under the test torque",
                  .remedy = Remedy::kStiffness,
                  .place = Place::kGearbox,
                  .weight = 0.6,
                  .exclusive_forms = true,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply,
                  .derived = torques};

}  // namespace gear3k::calibrate::compliance
