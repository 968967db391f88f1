#include "calibrate/causes/angle_order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
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

bool angles_show(const std::vector<double>& angle_rad, double order, int harmonics) {
  const auto n = static_cast<double>(angle_rad.size());
  const Eigen::Index columns = 1 + 2 * static_cast<Eigen::Index>(harmonics);
  if (n < static_cast<double>(columns)) return false;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::VectorXd row(columns);
  row[0] = 1.0;
  double walked = 0.0;  // of the wave, less whole turns
  double last = 0.0;
  double passed = 0.0,
         passed_by = 0.0;  // turns between neighbours, and of those beyond half a turn
  for (std::size_t i = 0; i < angle_rad.size(); ++i) {
    const double turn = order * angle_rad[i] / (2.0 * std::numbers::pi);
    for (Eigen::Index m = 1; 2 * m < columns; ++m) {
      const double phase =
          2.0 * std::numbers::pi * static_cast<double>(m) * (turn - std::floor(turn));
      row[2 * m - 1] = std::numbers::sqrt2 * std::cos(phase);
      row[2 * m] = std::numbers::sqrt2 * std::sin(phase);
    }
    normal.noalias() += row * row.transpose() / n;
    if (i > 0) {
      passed += turn - last;
      constexpr double kHalfTurn = 0.5;
      if (turn - last > kHalfTurn) passed_by += turn - last;
      walked += std::abs(turn - last - std::round(turn - last));
    }
    last = turn;
  }
  const Eigen::LDLT<Eigen::MatrixXd> factors(normal);
  constexpr double kMostInflation = 4.0;
  if (!(factors.vectorD().minCoeff() > 1e-9)) return false;
  const Eigen::VectorXd inflation =
      factors.solve(Eigen::MatrixXd::Identity(columns, columns)).diagonal();
  if (inflation.tail(columns - 1).maxCoeff() > kMostInflation) return false;
  constexpr double kMostly = 0.5, kLeastWalk = 1.5;
  return passed_by < kMostly * passed || walked >= kLeastWalk;
}

namespace {

constexpr double kLeastPeriods = 0.6;  // less of a period is hardly told from a slope

std::vector<double> angles_of(const MeasurementSet& data) {
  std::vector<double> result;
  if (!used_range(data, kOutputAngle).known()) return result;
  for (const Observation& row : data.rows) {
    if (std::isfinite(row.condition.output_angle_rad)) {
      result.push_back(row.condition.output_angle_rad);
    }
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

double revolutions_of(const std::vector<double>& angles) {
  return angles.empty() ? 0.0 : (angles.back() - angles.front()) / (2.0 * std::numbers::pi);
}

/// Whether a wave of either order has the same phases at all angles, but for a shift and the sense.
bool are_aliases(const std::vector<double>& angles, double a, double b) {
  constexpr double kSame = 0.98;
  const auto together = [&](double order) {
    std::complex<double> sum = 0.0;
    for (const double angle : angles) sum += std::polar(1.0, order * angle);
    return std::abs(sum) >= kSame * static_cast<double>(angles.size());
  };
  return together(a - b) || together(a + b);
}

bool reach(const std::vector<double>& angles, double order) {
  return revolutions_of(angles) * order >= kLeastPeriods;
}

/// The order by which angles are asked whether they show a wave of another one: it itself, or that
/// of a shaft which they show, where both draw the same.
double order_shown(const Occasion& o, const std::vector<double>& angles, double order) {
  if (angles_show(angles, order, 1)) return order;
  for (const train::ShaftOrder& shaft : shafts_of(o)) {
    if (reach(angles, shaft.order) && angles_show(angles, shaft.order, 1) &&
        are_aliases(angles, order, shaft.order)) {
      return shaft.order;
    }
  }
  return order;
}

}  // namespace

std::vector<train::ShaftOrder> shafts_of(const Occasion& o) {
  if (o.teeth != nullptr) return train::shaft_orders(*o.teeth);
  // Of a black box only its two shafts are known.
  return {{.body = "sun", .order = std::abs(o.ratio)}, {.body = "output", .order = 1.0}};
}

std::vector<std::string> shafts_not_shown(const Occasion& o) {
  if (o.kind != Kind::kTransmission && o.kind != Kind::kLostMotion) return {};
  const std::vector<double> angles = angles_of(*o.data);
  std::vector<std::string> result;
  for (const train::ShaftOrder& order : shafts_of(o)) {
    if (reach(angles, order.order) &&
        !angles_show(angles, order_shown(o, angles, order.order), 1)) {
      result.push_back(
          fmt::format("the {} ({:.4g} per turn of the output)", order.body, order.order));
    }
  }
  return result;
}

void add_note_on_shafts(const Occasion& o, std::vector<std::string>& notes) {
  const std::vector<std::string> shafts = shafts_not_shown(o);
  if (shafts.empty()) return;
  notes.push_back(fmt::format(
      "the angles do not show the turn of {}: a wave at that order is not told from what all rows "
      "have in common or from a drift, and was not looked for; angles at random or in small steps "
      "would show it",
      fmt::join(shafts, ", ")));
}

std::vector<Form> angle_forms(const Occasion& o, const std::vector<train::ShaftOrder>& orders) {
  const std::vector<double> angles = angles_of(*o.data);
  std::vector<Form> result;
  for (const train::ShaftOrder& order : orders) {
    if (!reach(angles, order.order)) continue;
    const double by = order_shown(o, angles, order.order);
    std::array<bool, 3> shown{};
    for (int m = 1; m <= 3; ++m) {
      shown[static_cast<std::size_t>(m - 1)] = o.every_wave || angles_show(angles, by, m);
    }
    if (!shown[0]) continue;
    const auto add = [&](std::string_view name, double weight, std::string_view law = "") {
      for (const std::string_view more : {std::string_view(), kSecond, kThird}) {
        if (!more.empty() && !shown[more == kSecond ? 1 : 2]) continue;
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
