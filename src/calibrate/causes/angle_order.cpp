#include "calibrate/causes/angle_order.hpp"

#include <cmath>
#include <numbers>

#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate {

namespace {

constexpr const char* kProportional = "proportional";

}  // namespace

std::vector<ParameterRecord> angle_parameters(const Form& form, Kind kind) {
  const bool share = form.name == kProportional;
  const auto record = [&](std::string_view name) {
    constexpr double kBound = 1e4;
    const double plausible = share ? 0.2 : kBound;
    return ParameterRecord{.name = name,
                           .unit = share ? "" : response_unit(kind).name,
                           .lower = share ? -10.0 : -kBound,
                           .upper = share ? 10.0 : kBound,
                           .plausible_low = -plausible,
                           .plausible_high = plausible};
  };
  return {record("cosine"), record("sine")};
}

std::vector<Form> angle_forms(const Occasion& o, const std::vector<train::ShaftOrder>& orders) {
  const ValueRange angle = range_of(*o.data, &Condition::output_angle_rad);
  const double revolutions = (angle.high - angle.low) / (2.0 * std::numbers::pi);
  std::vector<Form> result;
  for (const train::ShaftOrder& order : orders) {
    if (!(revolutions * order.order >= 1.0)) continue;
    const auto form = [&](const char* name, double weight) {
      return Form{.name = name, .body = order.body, .order = order.order, .weight = weight};
    };
    if (o.kind == Kind::kTransmission) {
      result.push_back(form(kProportional, 0.6));
      result.push_back(form("constant", 0.4));
    } else if (o.kind == Kind::kLostMotion) {
      result.push_back(form("constant", 1.0));
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
  const Scalar wave = p[0] * std::cos(angle) + p[1] * std::sin(angle);
  if (form.name == kProportional) {
    m.response_factor = m.response_factor * (1.0 + wave);
  } else {
    m.added = m.added + wave * response_unit(kind).si;
  }
}

}  // namespace gear3k::calibrate
