#include "papers/directional_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "actuator/felt.hpp"
#include "actuator/reflected.hpp"
#include "numerics/square.hpp"
#include "papers/thesis_model.hpp"

namespace gear3k::papers {

using motion::MotionRow, motion::Phase, numerics::square;

namespace {

constexpr double kHeldTorque_Nm = 0.05;  // of the motor, in tables
constexpr int kHeldPoints = 20;          // of a curve

/// Sums of a straight line by least squares.
struct StraightLine {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  void add(double a, double b) {
    n += 1.0;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  [[nodiscard]] double slope() const { return (n * xy - x * y) / (n * xx - x * x); }
};

std::vector<FeltGears> felt_gears(const ThesisSources& thesis, const actuator::Actuator& bench) {
  std::vector<FeltGears> felt;
  for (const MeasuredBothWays& m : measured_both_ways(thesis.measured)) {
    FeltGears g{.pinion = m.pinion(),
                .gear = m.gear(),
                .forward = 1.0 - m.small_drives.loss,
                .backward = 1.0 - m.large_drives.loss};
    const actuator::Actuator a = with_gears(bench, g);
    const actuator::Reflected r = actuator::reflected(a);
    g.plain_kgm2 = r.total_kgm2;
    g.speeding_up_kgm2 = r.speeding_up_kgm2.value();
    g.slowing_down_kgm2 = r.slowing_down_kgm2.value();
    g.transparency = actuator::felt_torque(a, g.ratio() * kHeldTorque_Nm).transparency.value();
    felt.push_back(g);
  }
  return felt;
}

std::vector<HeldTorque> held_torques(const DirectionalBenchSources& sources,
                                     const std::vector<FeltGears>& felt) {
  const auto asymmetry = [](const FeltGears& g) { return g.forward * g.backward; };
  const auto [most, least] = std::ranges::minmax_element(felt, {}, asymmetry);
  std::vector<HeldTorque> held;
  for (const FeltGears& g : {*least, *most}) {
    const actuator::Actuator a = with_gears(sources.actuator, g);
    for (int k = 1; k <= kHeldPoints; ++k) {
      const double motor_Nm = 2.0 * kHeldTorque_Nm * k / kHeldPoints;
      const actuator::FeltTorque t = actuator::felt_torque(a, g.ratio() * motor_Nm);
      held.push_back({.pinion = g.pinion,
                      .gear = g.gear,
                      .motor_Nm = motor_Nm,
                      .moving_with_Nm = t.moving_with_Nm.value_or(0.0),
                      .pushed_back_Nm = t.pushed_back_Nm.value()});
    }
  }
  return held;
}

BrakingRun braking_run(const DirectionalBenchSources& sources) {
  actuator::Actuator fixed = sources.actuator;
  actuator::Gearbox& g = fixed.gearbox;
  g.efficiency_forward = g.efficiency_backward =
      0.5 * (g.efficiency_forward + g.efficiency_backward);
  BrakingRun run{.directional = motion::simulate(sources.actuator, sources.braking),
                 .fixed = motion::simulate(fixed, sources.braking)};
  const auto& rows = run.directional.rows;
  const auto driven = [](const MotionRow& row) {
    return row.mode.phase == Phase::kSlide && row.mode.flow < 0;
  };
  const auto opposite = [&](const MotionRow& row) {
    return driven(row) && row.outside.reflected_Nm * row.sides.output_rad_s > 0.0;
  };
  for (std::size_t k = 1; k < rows.size(); ++k) {
    // Where one end of an interval alone is so, half of it counts.
    const double half = 0.5 * (rows[k].time_s - rows[k - 1].time_s) / sources.braking.duration_s;
    for (const MotionRow* row : {&rows[k - 1], &rows[k]}) {
      if (driven(*row)) run.backward_share += half;
      if (opposite(*row)) run.opposite_share += half;
    }
  }
  // Rows at the samples of both; those of events belong to one of them.
  double difference = 0.0, speed = 0.0;
  std::size_t at = 0;
  for (const MotionRow& row : rows) {
    const auto& other = run.fixed.rows;
    while (at < other.size() && other[at].time_s < row.time_s) ++at;
    if (at == other.size()) break;
    if (other[at].time_s != row.time_s) continue;
    difference += square(row.sides.output_rad_s - other[at].sides.output_rad_s);
    speed += square(row.sides.output_rad_s);
  }
  run.speed_error = std::sqrt(difference / speed);
  return run;
}

/// Inertia that is felt as torque over acceleration where a torque from outside moves the bench,
/// motor open, from a speed against which its drag is nothing.
double simulated_inertia(const actuator::Actuator& bench, bool speeding_up) {
  actuator::Actuator a = bench;
  a.motor.viscous_Nms = 0.0;
  motion::Scenario s;
  s.duration_s = 1e-3;
  s.control = motion::Control::kOpen;
  s.start_speed_rad_s = 1.0;
  s.load.torque_Nm.constant = speeding_up ? 1e-3 : -1e-3;
  const MotionRow row = motion::simulate(a, s).rows.at(1);
  return row.outside.load_Nm / row.acceleration_rad_s2;
}

/// Radius r, of steel: m = π r² b ρ, J = m r²/2, without bore and as if to the pitch circle.
double disc_kgm2(double radius_m, double width_m, double density) {
  return 0.5 * std::numbers::pi * density * width_m * square(square(radius_m));
}

/// Of the pairs of the ratio that has most of them, the one with the smallest and the one with the
/// largest gears.
std::pair<FeltGears, FeltGears> same_ratio(const std::vector<FeltGears>& felt) {
  std::pair<FeltGears, FeltGears> chosen{felt.front(), felt.front()};
  std::ptrdiff_t most = 0;
  for (const FeltGears& g : felt) {
    const auto same = [&](const FeltGears& o) { return o.gear * g.pinion == g.gear * o.pinion; };
    const auto count = std::ranges::count_if(felt, same);
    if (count <= most) continue;
    most = count;
    chosen = {g, g};
    for (const FeltGears& o : felt) {
      if (!same(o)) continue;
      if (o.gear < chosen.first.gear) chosen.first = o;
      if (o.gear > chosen.second.gear) chosen.second = o;
    }
  }
  return chosen;
}

/// b at which N² (J_m + J_p)/η_b + J_g is the same for two pairs of one ratio N.
double even_width(const ThesisSources& thesis, const DirectionalBenchSources& sources,
                  const std::vector<FeltGears>& felt) {
  const auto [small, large] = same_ratio(felt);
  const double module = thesis.statements.module_m;
  const auto per_width = [&](const FeltGears& g) {
    const auto disc = [&](int teeth) {
      return disc_kgm2(0.5 * module * teeth, 1.0, sources.steel_kg_m3);
    };
    return square(g.ratio()) * disc(g.pinion) / g.backward + disc(g.gear);
  };
  const double saved = square(small.ratio()) * sources.actuator.motor.rotor_inertia_kgm2 *
                       (1.0 / small.backward - 1.0 / large.backward);
  return saved / (per_width(large) - per_width(small));
}

/// Its eqs. 2.6 and 2.7 with the motor off and no damping: −τ2 over N times the acceleration.
std::vector<ComparedRow> bench_rows(const ThesisSources& thesis,
                                    const DirectionalBenchSources& sources,
                                    const DirectionalBench& bench, const FeltGears& g) {
  const double n = g.ratio(), loss1 = 1.0 - g.forward, loss2 = 1.0 - g.backward;
  const double j1 = sources.actuator.motor.rotor_inertia_kgm2;
  const double j2 = sources.actuator.load_inertia_kgm2;
  const SlopeLosses slopes = slope_losses(bench.load);
  const double k = sources.push.control_stiffness_Nm_rad;
  const SpringSlopes spring = spring_slopes(bench.push, k);
  double slowest = 1e300, fastest = 0.0;
  for (const MotionRow& row : bench.load.rows) {
    const double rate = std::abs(row.sides.output_rad_s) * g.gear / (2.0 * std::numbers::pi);
    slowest = std::min(slowest, rate);
    fastest = std::max(fastest, rate);
  }
  const auto named = [](int driving, int driven) {
    return fmt::format("loss of {} driving {}, from the slope at constant speed", driving, driven);
  };
  return {
      {"teeth a second, least of the run",
       "1/s",
       thesis.statements.mesh_rate_1_s,
       {},
       slowest,
       {},
       1},
      {"teeth a second, most of the run",
       "1/s",
       thesis.statements.mesh_rate_1_s,
       {},
       fastest,
       {},
       1},
      {named(g.pinion, g.gear), "", loss1, {}, slopes.forward, {}, 4},
      {named(g.gear, g.pinion), "", loss2, {}, slopes.backward, {}, 4},
      {"inertia felt at the output, sped up from outside (eq. 2.7)",
       "1e-6 kg m2",
       {},
       1e6 * n * n * (j1 + (1.0 - loss2) * j2 / (n * n)) / (1.0 - loss2),
       1e6 * simulated_inertia(sources.actuator, true),
       {},
       2},
      {"inertia felt at the output, slowed from outside (eq. 2.6)",
       "1e-6 kg m2",
       {},
       1e6 * n * n * ((1.0 - loss1) * j1 + j2 / (n * n)),
       1e6 * simulated_inertia(sources.actuator, false),
       {},
       2},
      {"virtual spring pushed in, over its stiffness",
       "",
       {},
       1.0 / (1.0 - loss2),
       spring.pushed_in,
       {},
       4},
      {"virtual spring let out, over its stiffness", "", {}, 1.0 - loss1, spring.let_out, {}, 4}};
}

}  // namespace

actuator::Actuator with_gears(const actuator::Actuator& bench, const FeltGears& gears) {
  actuator::Actuator a = bench;
  a.gearbox.ratio = -gears.ratio();  // an external pair turns the other way round
  a.gearbox.efficiency_forward = gears.forward;
  a.gearbox.efficiency_backward = gears.backward;
  return a;
}

const FeltGears& gears_of(const std::vector<FeltGears>& felt, int pinion, int gear) {
  for (const FeltGears& g : felt) {
    if (g.pinion == pinion && g.gear == gear) return g;
  }
  throw std::invalid_argument(fmt::format("gears {} and {}: not measured both ways", pinion, gear));
}

SlopeLosses slope_losses(const motion::Motion& motion) {
  // The control has settled half a second after a change of flow.
  constexpr double kSettled_s = 0.5;
  StraightLine forward, backward;
  double since = 0.0;
  int flow = 0;
  for (const MotionRow& row : motion.rows) {
    if (row.mode.flow != flow) since = row.time_s;
    flow = row.mode.flow;
    if (row.mode.phase != Phase::kSlide || row.time_s - since < kSettled_s) continue;
    const double motor = row.outside.reflected_Nm, load = row.outside.load_Nm;
    flow > 0 ? forward.add(motor, -load) : backward.add(load, -motor);
  }
  return {.forward = 1.0 - forward.slope(), .backward = 1.0 - backward.slope()};
}

SpringSlopes spring_slopes(const motion::Motion& motion, double stiffness_Nm_rad) {
  double most = 0.0;
  for (const MotionRow& row : motion.rows) most = std::max(most, std::abs(row.outside.load_Nm));
  StraightLine in, out;
  for (const MotionRow& row : motion.rows) {
    // Away from both ends, where the output turns round.
    const double load = std::abs(row.outside.load_Nm);
    if (row.mode.phase != Phase::kSlide || load < 0.1 * most || load > 0.7 * most) continue;
    (row.mode.flow < 0 ? in : out).add(row.sides.output_rad, row.outside.load_Nm);
  }
  return {.pushed_in = in.slope() / stiffness_Nm_rad, .let_out = out.slope() / stiffness_Nm_rad};
}

DirectionalBench directional_bench(const ThesisSources& thesis,
                                   const DirectionalBenchSources& sources) {
  DirectionalBench bench;
  bench.felt = felt_gears(thesis, sources.actuator);
  const actuator::Gearbox& own = sources.actuator.gearbox;
  const auto gears = std::ranges::find_if(bench.felt, [&](const FeltGears& g) {
    return -g.ratio() == own.ratio && g.forward == own.efficiency_forward &&
           g.backward == own.efficiency_backward;
  });
  if (gears == bench.felt.end()) {
    throw std::invalid_argument(sources.actuator.name +
                                ": its gears are not in Table 3.1 both ways");
  }
  bench.held = held_torques(sources, bench.felt);
  bench.load = motion::simulate(sources.actuator, sources.load);
  bench.push = motion::simulate(sources.actuator, sources.push);
  bench.braking = braking_run(sources);
  bench.even_width_m = even_width(thesis, sources, bench.felt);
  bench.rows = bench_rows(thesis, sources, bench, *gears);
  bench.ledger = directional_bench_ledger(thesis, sources, bench);
  return bench;
}

}  // namespace gear3k::papers
