#include "tests/wide_rig/alternatives.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

namespace gear3k::wide_rig {
namespace {

using Column = std::vector<double>;

double dot(const Column& a, const Column& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Takes out of a column what unit columns hold; twice, for the rounding.
void take_out(Column& column, const std::vector<Column>& units) {
  for (int pass = 0; pass < 2; ++pass) {
    for (const Column& unit : units) {
      const double share = dot(column, unit);
      for (std::size_t i = 0; i < column.size(); ++i) column[i] -= share * unit[i];
    }
  }
}

// Adds a column to an orthonormal set unless it lies in it already.
void add_unit(Column column, std::vector<Column>& units) {
  const double before = std::sqrt(dot(column, column));
  take_out(column, units);
  const double after = std::sqrt(dot(column, column));
  if (!(after > 1e-7 * before)) return;
  for (double& v : column) v /= after;
  units.push_back(std::move(column));
}

// How the response moves with the friction of each mesh, with drags and with bearings: the slopes
// at each row, by differences.
struct Slopes {
  std::vector<std::array<double, 3>> friction;
  std::vector<std::array<MeshPoint, 3>> point;
  Column skew, pin, bearing, gain, offset;
  std::array<Column, 4> drag;
};

HiddenEffect probe(Channel channel, Body body,
                   std::function<double(double, const BenchRow&, const MeshPoint&)> value) {
  HiddenEffect effect;
  effect.channel = channel;
  effect.body = body;
  effect.value = std::move(value);
  return effect;
}

Slopes slopes_at(const BenchSubject& subject, const std::vector<BenchRow>& rows) {
  Slopes slopes;
  std::array<MeshPoint, 3> seen{};
  const HiddenEffect look =
      probe(Channel::friction, Body::none,
            [&seen](double, const BenchRow&, const MeshPoint& p) { return seen[p.mesh] = p, 0.0; });
  std::array<HiddenEffect, 3> mesh;
  for (std::size_t k = 0; k < 3; ++k) {
    mesh[k] =
        probe(Channel::friction, Body::none,
              [k](double a, const BenchRow&, const MeshPoint& p) { return p.mesh == k ? a : 0.0; });
  }
  const auto one = [](double a, const BenchRow&, const MeshPoint&) { return a; };
  const HiddenEffect skew = probe(Channel::skew, Body::none, one);
  const HiddenEffect pin = probe(Channel::pin, Body::none, one);
  const HiddenEffect bearing = probe(Channel::output_bearing, Body::none, one);
  std::array<HiddenEffect, 4> drag;
  for (std::size_t b = 0; b < 4; ++b) drag[b] = probe(Channel::drag, static_cast<Body>(b), one);
  const std::size_t meshes = subject.black_box ? 1 : 3;
  for (const BenchRow& row : rows) {
    seen = {};
    const double at = sun_torque(subject, row, {{&look, 0.0}}).value;
    const auto slope = [&](const HiddenEffect& effect, double step) {
      return (sun_torque(subject, row, {{&effect, step}}).value - at) / step;
    };
    std::array<double, 3> friction{};
    for (std::size_t k = 0; k < meshes; ++k) friction[k] = slope(mesh[k], 0.01);
    slopes.friction.push_back(friction);
    slopes.point.push_back(seen);
    slopes.skew.push_back(slope(skew, 0.01));
    slopes.pin.push_back(subject.black_box ? 0.0 : slope(pin, 0.005));
    slopes.bearing.push_back(slope(bearing, 0.005));
    for (std::size_t b = 0; b < 4; ++b) {
      const bool none = subject.black_box && (b == 1 || b == 2);
      slopes.drag[b].push_back(none ? 0.0 : slope(drag[b], 0.01 * at));
    }
    slopes.gain.push_back(at);
    slopes.offset.push_back(row.forward ? row.rotation : -row.rotation);
  }
  return slopes;
}

class ShapeList {
 public:
  ShapeList(const std::vector<BenchRow>& rows, const Column& sigma) : rows_(rows), sigma_(sigma) {}

  Column column(const std::function<double(std::size_t)>& value) const {
    Column result(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) result[i] = value(i) / sigma_[i];
    return result;
  }
  void add(const std::string& cause, const std::vector<std::function<double(std::size_t)>>& values,
           const TurningBody& body = {.name = "", .order = 0.0}) {
    CauseShape shape{.cause = cause, .order = body.order, .body = body.name};
    for (const auto& value : values) shape.columns.push_back(column(value));
    shapes.push_back(std::move(shape));
  }
  // Steps between all sessions of a target, and its drifts.
  void add_time(const BenchColumns& columns, const Column& target) {
    int sessions = 1;
    for (const BenchRow& row : rows_) sessions = std::max(sessions, row.session + 1);
    if ((columns.run || columns.time) && sessions > 1) {
      std::vector<std::function<double(std::size_t)>> steps;
      // The first session is the reference: what all share is no step.
      for (int s = 1; s < sessions; ++s) {
        steps.emplace_back(
            [&, s](std::size_t i) { return rows_[i].session == s ? target[i] : 0.0; });
      }
      add("run_step", steps);
    }
    if (!columns.time && !columns.cycles) return;
    const auto along = [&](const std::function<double(double)>& law) {
      add("drift", {[&](std::size_t i) { return target[i] * law(rows_[i].elapsed); }});
    };
    for (const double tau : {0.1, 0.3, 1.0}) {
      along([tau](double u) { return -std::expm1(-u / tau); });
      along([tau](double u) { return std::log1p(u / tau); });
    }
    for (const double power : {0.3, 0.6, 1.0, 1.6, 2.5}) {
      along([power](double u) { return std::pow(u, power); });
    }
  }
  // Waves of a target at the orders of bodies; the first two harmonics.
  void add_waves(const std::string& cause, const std::vector<TurningBody>& bodies,
                 const Column& target) {
    for (const TurningBody& body : bodies) {
      std::vector<std::function<double(std::size_t)>> waves;
      for (const double harmonic : {1.0, 2.0}) {
        const double rate = harmonic * body.order * std::numbers::pi / 180.0;
        waves.emplace_back([&, rate](std::size_t i) {
          return target[i] * std::cos(rate * rows_[i].output_angle_deg);
        });
        waves.emplace_back([&, rate](std::size_t i) {
          return target[i] * std::sin(rate * rows_[i].output_angle_deg);
        });
      }
      add(cause, waves, body);
    }
  }

  std::vector<CauseShape> shapes;

 private:
  const std::vector<BenchRow>& rows_;
  const Column& sigma_;
};

std::vector<CauseShape> waves_of(const std::vector<CauseShape>& shapes) {
  std::vector<CauseShape> waves;
  for (const CauseShape& shape : shapes) {
    if (shape.order > 0.0) waves.push_back(shape);
  }
  return waves;
}

Alternatives transmission_shapes(const BenchSubject& subject, const std::vector<BenchRow>& rows,
                                 const BenchColumns& columns, const Column& sigma) {
  const Slopes slopes = slopes_at(subject, rows);
  ShapeList list(rows, sigma);
  Column level(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    level[i] = slopes.friction[i][0] + slopes.friction[i][1] + slopes.friction[i][2];
  }
  double force_low = 1e300, force_high = 0.0, speed_low = 1e300, speed_high = 0.0;
  const std::size_t meshes = subject.black_box ? 1 : 3;
  for (const auto& points : slopes.point) {
    const MeshPoint& p = points[meshes - 1];
    force_low = std::min(force_low, p.force_N);
    force_high = std::max(force_high, p.force_N);
    speed_low = std::min(speed_low, p.sliding_m_s);
    speed_high = std::max(speed_high, p.sliding_m_s);
  }
  const auto friction = [&](const std::string& cause,
                            const std::function<double(const BenchRow&, const MeshPoint&)>& law) {
    list.add(cause, {[&](std::size_t i) {
               double sum = 0.0;
               for (std::size_t k = 0; k < meshes; ++k) {
                 sum += slopes.friction[i][k] * law(rows[i], slopes.point[i][k]);
               }
               return sum;
             }});
  };
  friction("friction_level", [](const BenchRow&, const MeshPoint&) { return 1.0; });
  const auto over_force = [&](const std::function<double(double)>& law) {
    friction("friction_load",
             [&](const BenchRow&, const MeshPoint& p) { return law(p.force_N / force_high); });
  };
  const auto over_speed = [&](const std::function<double(double)>& law) {
    friction("friction_speed",
             [&](const BenchRow&, const MeshPoint& p) { return law(p.sliding_m_s / speed_high); });
  };
  for (const double n : {-0.8, -0.4, 0.3, 0.7, 1.2, 2.5}) {
    over_force([n](double x) { return std::pow(x, n); });
    over_speed([n](double x) { return std::pow(x, n); });
  }
  for (const double at : {0.1, 0.25, 0.5}) {
    over_force([at](double x) { return std::exp(-x / at); });
    over_speed([at](double x) { return std::exp(-x / at); });
    over_speed([at](double x) { return 1.0 / (1.0 + (x / at) * (x / at)); });
    over_force([at](double x) { return std::tanh(std::log(x / at) / 0.5); });
  }
  if (columns.temperature) {
    for (const double rate : {-0.06, -0.02, 0.01, 0.03}) {
      friction("friction_temperature", [rate](const BenchRow& row, const MeshPoint&) {
        return std::exp(rate * (row.temperature_c - 25.0));
      });
    }
    // Any smooth law: where temperature follows another condition, nobody can say which it is.
    const auto bent = [&](double power) {
      return [&, power](std::size_t i) {
        return level[i] * std::pow((rows[i].temperature_c - 25.0) / 10.0, power);
      };
    };
    list.add("friction_temperature", {bent(1.0), bent(2.0)});
  }
  friction("friction_direction",
           [](const BenchRow& row, const MeshPoint&) { return row.forward ? 1.0 : -1.0; });
  friction("friction_direction",
           [](const BenchRow&, const MeshPoint& p) { return p.a_drives ? 1.0 : 0.0; });
  list.add("friction_direction", {[&](std::size_t i) { return slopes.skew[i]; }});
  for (std::size_t b = 0; b < 4; ++b) {
    if (subject.black_box && (b == 1 || b == 2)) continue;
    const Column& drag = slopes.drag[b];
    const auto speed = [&](std::size_t i) { return rows[i].sun_speed_rpm; };
    list.add("drag_constant", {[&](std::size_t i) { return drag[i]; }});
    list.add("drag_viscous", {[&](std::size_t i) { return drag[i] * speed(i); }});
    list.add("drag_quadratic", {[&](std::size_t i) { return drag[i] * speed(i) * speed(i); }});
  }
  if (!subject.black_box) list.add("bearing_load", {[&](std::size_t i) { return slopes.pin[i]; }});
  list.add("bearing_load", {[&](std::size_t i) { return slopes.bearing[i]; }});
  list.add("sensor_gain", {[&](std::size_t i) { return slopes.gain[i]; }});
  list.add("sensor_offset", {[&](std::size_t i) { return slopes.offset[i]; }});
  list.add_time(columns, level);
  list.add_time(columns, slopes.gain);
  list.add_time(columns, slopes.offset);
  list.add_time(columns, slopes.drag[0]);
  if (columns.angle) {
    const Column ones(rows.size(), 1.0);
    const Column& gain = slopes.gain;
    for (const Column* target : {&gain, &ones}) {
      list.add_waves("runout", turning_bodies(subject), *target);
      list.add_waves("mesh_order", tooth_orders(subject), *target);
    }
  }
  Alternatives result;
  result.always.push_back(list.column([&](std::size_t i) { return level[i]; }));
  result.shapes = std::move(list.shapes);
  result.waves = waves_of(result.shapes);
  if (columns.angle) {
    ShapeList by_friction(rows, sigma);
    by_friction.add_waves("runout", turning_bodies(subject), level);
    by_friction.add_waves("mesh_order", tooth_orders(subject), level);
    for (CauseShape& shape : by_friction.shapes) result.waves.push_back(std::move(shape));
  }
  return result;
}

Alternatives lost_motion_shapes(const BenchSubject& subject, const std::vector<BenchRow>& rows,
                                const BenchColumns& columns, const Column& sigma) {
  ShapeList list(rows, sigma);
  const Column ones(rows.size(), 1.0);
  list.add("clearance", {[](std::size_t) { return 1.0; }});
  for (const double n : {0.4, 0.7, 1.0}) {
    list.add("compliance", {[&, n](std::size_t i) { return std::pow(rows[i].test_torque_Nm, n); }});
  }
  if (columns.temperature) {
    list.add("thermal_expansion", {[&](std::size_t i) { return rows[i].temperature_c - 20.0; }});
    list.add("thermal_expansion", {[&](std::size_t i) { return rows[i].temperature_c - 28.0; }});
  }
  list.add_time(columns, ones);
  if (columns.angle) {
    list.add_waves("runout", turning_bodies(subject), ones);
    list.add_waves("mesh_order", tooth_orders(subject), ones);
  }
  Alternatives result;
  result.shapes = std::move(list.shapes);
  result.waves = waves_of(result.shapes);
  return result;
}

Alternatives pair_loss_shapes(const BenchSubject& subject, const std::vector<BenchRow>& rows,
                              const BenchColumns& columns, const Column& sigma) {
  ShapeList list(rows, sigma);
  Column loss(rows.size()), skewed(rows.size());
  const HiddenEffect skew = probe(Channel::skew, Body::none,
                                  [](double a, const BenchRow&, const MeshPoint&) { return a; });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    loss[i] = pair_loss(subject, rows[i], {}).value;
    skewed[i] = pair_loss(subject, rows[i], {{&skew, 0.1}}).value - loss[i];
  }
  const auto inverse = [&](std::size_t i) {
    return 1.0 / rows[i].driving_teeth + 1.0 / rows[i].driven_teeth;
  };
  const auto inverse_pinion = [&](std::size_t i) {
    return 1.0 / std::min(rows[i].driving_teeth, rows[i].driven_teeth);
  };
  list.add("friction_level", {[&](std::size_t i) { return loss[i]; }});
  list.add("friction_direction",
           {[&](std::size_t i) { return rows[i].forward ? loss[i] : -loss[i]; }});
  list.add("friction_direction", {[&](std::size_t i) { return skewed[i]; }});
  list.add("bearing_load", {inverse});
  list.add("bearing_load", {inverse_pinion});
  list.add("sensor_gain", {[&](std::size_t i) { return loss[i]; }});
  list.add("sensor_gain", {[](std::size_t) { return 1.0; }});
  list.add_time(columns, loss);
  Alternatives result;
  result.always.push_back(list.column([&](std::size_t i) { return loss[i]; }));
  result.shapes = std::move(list.shapes);
  return result;
}

// What is free beside an effect, as an orthonormal set.
std::vector<Column> free_beside(const Alternatives& alternatives, const std::vector<Column>& others,
                                bool is_level) {
  std::vector<Column> base;
  if (!is_level) {
    for (const Column& column : alternatives.always) add_unit(column, base);
  }
  for (const Column& column : others) add_unit(column, base);
  return base;
}

// What a shape leaves of an effect out of which the base is taken.
Column rest_of(const Column& reduced, const CauseShape& shape, const std::vector<Column>& base) {
  std::vector<Column> units;
  for (Column column : shape.columns) {
    const double before = dot(column, column);
    take_out(column, base);
    if (dot(column, column) > 1e-12 * before) add_unit(std::move(column), units);
  }
  Column rest = reduced;
  take_out(rest, units);
  return rest;
}

}  // namespace

Alternatives usual_shapes(const BenchSubject& subject, const std::string& kind,
                          const std::vector<BenchRow>& rows, const BenchColumns& columns,
                          const std::vector<double>& sigma) {
  if (kind == "transmission") return transmission_shapes(subject, rows, columns, sigma);
  if (kind == "lost_motion") return lost_motion_shapes(subject, rows, columns, sigma);
  if (kind == "pair_loss") return pair_loss_shapes(subject, rows, columns, sigma);
  return {};
}

std::vector<LeftOver> left_over(const Alternatives& alternatives, const std::vector<double>& effect,
                                const std::vector<std::vector<double>>& others, bool is_level) {
  const std::vector<Column> base = free_beside(alternatives, others, is_level);
  Column reduced = effect;
  take_out(reduced, base);
  std::vector<LeftOver> result;
  for (const CauseShape& shape : alternatives.shapes) {
    Column rest = rest_of(reduced, shape, base);
    const double left = dot(rest, rest);
    auto found = std::find_if(result.begin(), result.end(),
                              [&](const LeftOver& x) { return x.cause == shape.cause; });
    if (found == result.end()) {
      result.push_back({shape.cause, left, std::move(rest)});
    } else if (left < found->chi_square) {
      *found = {shape.cause, left, std::move(rest)};
    }
  }
  return result;
}

std::vector<OrderAsGood> orders_as_good(const Alternatives& alternatives,
                                        const std::vector<double>& effect,
                                        const std::vector<std::vector<double>>& others,
                                        double own_order, double more) {
  const std::vector<Column> base = free_beside(alternatives, others, false);
  Column reduced = effect;
  take_out(reduced, base);
  struct Best {
    OrderAsGood at;
    double left = 0.0;
  };
  std::vector<Best> best;
  double own = 1e300;
  for (const CauseShape& shape : alternatives.waves) {
    const Column rest = rest_of(reduced, shape, base);
    const double left = dot(rest, rest);
    if (shape.order == own_order) own = std::min(own, left);
    const auto found = std::find_if(best.begin(), best.end(), [&](const Best& b) {
      return b.at.cause == shape.cause && b.at.order == shape.order;
    });
    if (found == best.end()) {
      best.push_back({{shape.cause, shape.body, shape.order}, left});
    } else {
      found->left = std::min(found->left, left);
    }
  }
  std::vector<OrderAsGood> result;
  for (const Best& b : best) {
    if (b.left < own + more) result.push_back(b.at);
  }
  return result;
}

}  // namespace gear3k::wide_rig
