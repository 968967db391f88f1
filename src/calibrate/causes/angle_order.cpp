#include "calibrate/causes/angle_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "calibrate/measurement/blank_conditions.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate {

namespace {

// Forms by what the wave is of, each with none, one or two harmonics.
constexpr std::string_view kConstant = "constant", kProportional = "proportional",
                           kFriction = "friction", kDrag = "drag", kSecond = "_with_second",
                           kThird = "_with_third";

std::size_t harmonics_of(const Form& form) {
  if (form.name.ends_with(kThird)) return 3;
  return form.name.ends_with(kSecond) ? 2 : 1;
}

bool both_ways(const MeasurementSet& data) {
  return std::ranges::any_of(data.rows, [&](const Observation& row) {
    return row.condition.direction != data.rows.front().condition.direction;
  });
}

}  // namespace

std::vector<ParameterRecord> angle_parameters(const Form& form, Kind kind) {
  const bool share = !form.name.starts_with(kConstant) && !form.name.starts_with(kDrag);
  const double bound = form.name.starts_with(kFriction) ? 0.99 : share ? 10.0 : 1e4;
  const double plausible = share ? (form.name.starts_with(kFriction) ? 0.99 : 0.2) : bound;
  const auto record = [&](std::string_view name) {
    return ParameterRecord{.name = name,
                           .unit = share ? "" : response_unit(kind).name,
                           .lower = -bound,
                           .upper = bound,
                           .plausible_low = -plausible,
                           .plausible_high = plausible};
  };
  static constexpr std::array<std::string_view, 6> kNames{"cosine", "sine",     "cosine_2",
                                                          "sine_2", "cosine_3", "sine_3"};
  std::vector<ParameterRecord> result;
  const std::size_t count = 2 * harmonics_of(form);
  for (std::size_t k = 0; k < count; ++k) result.push_back(record(kNames[k]));
  return result;
}

std::vector<Form> angle_forms(const Occasion& o, const std::vector<train::ShaftOrder>& orders) {
  const ValueRange angle = used_range(*o.data, kOutputAngle);
  const double revolutions = (angle.high - angle.low) / (2.0 * std::numbers::pi);
  // Less of a period is hardly told from a slope.
  constexpr double kLeastPeriods = 0.6;
  std::vector<Form> result;
  for (const train::ShaftOrder& order : orders) {
    if (!(revolutions * order.order >= kLeastPeriods)) continue;
    const auto add = [&](std::string_view name, double weight, std::string_view law = "") {
      for (const std::string_view more : {std::string_view(), kSecond, kThird}) {
        // Once it is found: bodies and teeth are not round in one harmonic alone.
        result.push_back({.name = std::string(name).append(more),
                          .body = order.body,
                          .order = order.order,
                          .weight = more.empty() ? weight : 0.0,
                          .law = law});
      }
    };
    if (o.kind == Kind::kTransmission) {
      add(kProportional, 0.5);
      add(kConstant, 0.3);
      add(kFriction, 0.2, kOnFriction);
      // In data of one direction a ripple of the sun's torque is one of the reading.
      if (both_ways(*o.data)) add(kDrag, 0.3, kOnDrag);
    } else if (o.kind == Kind::kLostMotion) {
      add(kConstant, 1.0);
    }
  }
  return result;
}

std::vector<DerivedParameter> angle_amplitude(const Form& form, std::span<const Scalar> p,
                                              const Simulation& simulation, const Modification&) {
  using std::sqrt;
  ParameterRecord record = angle_parameters(form, simulation.kind()).front();
  record.name = "amplitude";
  return {{.record = record, .value = sqrt(p[0] * p[0] + p[1] * p[1]), .leads = true}};
}

void apply_angle(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
                 Modification& m) {
  const double angle = form.order * condition.output_angle_rad;
  if (!std::isfinite(angle)) return;
  Scalar wave(0.0);
  double phase = 0.0;
  for (std::size_t k = 0; k + 1 < p.size(); k += 2) {
    phase += angle;
    wave = wave + p[k] * std::cos(phase) + p[k + 1] * std::sin(phase);
  }
  if (form.name.starts_with(kFriction)) {
    m.friction_level = m.friction_level * (1.0 + wave);
  } else if (form.name.starts_with(kProportional)) {
    m.response_factor = m.response_factor * (1.0 + wave);
  } else {
    const bool takes =
        form.name.starts_with(kDrag) && condition.direction != design::Direction::kForward;
    m.added = m.added + (takes ? -1.0 : 1.0) * wave * response_unit(kind).si;
  }
}

}  // namespace gear3k::calibrate
