#include "actuator/duty_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "actuator/catalogue_gear.hpp"
#include "actuator/gear_model.hpp"

namespace gear3k::actuator {

namespace {

/// Offset of the two points of Gauss on [0, 1] from its middle, 1/√12: exact to degree three, which
/// no power exceeds where speed and torque are straight lines.
constexpr double kTwoPointOffset = 0.28867513459481288225;

double sign_of(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

/// Sums over a cycle; those of the gearbox's causes come after them.
enum SumOf : std::size_t {
  kPositive,
  kNegative,
  kDrawn,
  kRegenerated,
  kCopper,
  kCoulomb,
  kViscous,
  kDrive,
  kSquareCurrent,
  kSquareTorque,
  kBackdriven,
  kBraking,
  kRegenerating,
  kFirstGearCause
};

/// @tparam Gear  GearModel, or a final one of it, which is then called in line
template <class Gear, std::size_t kCauses>
class CycleRun {
 public:
  CycleRun(const Actuator& actuator, const Gear& gear, bool keep)
      : actuator_(actuator),
        chain_(chain_of(actuator)),
        gear_(gear),
        rotor_kgm2_(chain_.ratio * chain_.ratio * actuator.motor.rotor_inertia_kgm2),
        per_torque_(1.0 / (chain_.ratio * actuator.motor.torque_constant_Nm_A)),
        constant_(gear.constant_efficiencies()),
        keep_(keep) {}

  void add(const CyclePiece& piece, double start_s) {
    start_s_ = start_s;
    if (piece.rests()) {
      add_rest(piece);
      return;
    }
    edges_.clear();
    edges_.push_back(0.0);
    append_sign_changes(piece.speed_rad_s, edges_);
    edges_.push_back(1.0);
    for (std::size_t k = 1; k < edges_.size(); ++k) add_one_way(piece, edges_[k - 1], edges_[k]);
  }

  DutyCycle result(const Cycle& cycle, const std::vector<CyclePiece>& pieces);

 private:
  static constexpr std::size_t kSums = kFirstGearCause + kCauses;
  using Terms = std::array<double, kSums>;
  /// Motor and gearbox at a place of a piece.
  struct State {
    OutputMotion motion{};
    GearInstantOf<kCauses> gear{};
    double reflected_Nm = 0.0;  ///< τ
  };

  [[nodiscard]] State state_at(const OutputMotion& motion) const {
    State state{.motion = motion};
    if constexpr (std::is_same_v<Gear, CatalogueGear>) {
      state.gear = gear_.instant(motion);
    } else {
      state.gear = gear_.at(motion);
    }
    state.reflected_Nm = rotor_kgm2_ * motion.acceleration_rad_s2 +
                         chain_.d1_Nms * motion.speed_rad_s + chain_.c1_Nm * motion.sense +
                         state.gear.input_Nm;
    return state;
  }
  [[nodiscard]] State state_at(const CyclePiece& piece, double x, double sense) const {
    return state_at(motion_at(piece, x, sense));
  }
  /// Where speed and torque are straight lines.
  [[nodiscard]] State state_at(const CyclePiece& piece, double x, double sense,
                               double acceleration) const {
    return state_at({.speed_rad_s = piece.speed_rad_s[0] + x * piece.speed_rad_s[1],
                     .acceleration_rad_s2 = acceleration,
                     .load_Nm = piece.load_Nm[0] + x * piece.load_Nm[1],
                     .sense = sense});
  }

  /// A stretch of a piece that turns one way.
  void add_one_way(const CyclePiece& piece, double x0, double x1) {
    const double sense = sign_of(value_at(piece.speed_rad_s, 0.5 * (x0 + x1)));
    std::vector<double>& edges = flow_edges_;
    edges.clear();
    edges.push_back(x0);
    gear_.append_flow_changes(piece, {x0, x1}, sense, edges);
    loads_.clear();
    append_sign_changes(piece.load_Nm, loads_);
    for (const double x : loads_) {
      if (x > x0 && x < x1) edges.push_back(x);
    }
    edges.push_back(x1);
    if (edges.size() > 2) std::ranges::sort(edges);
    for (std::size_t k = 1; k < edges.size(); ++k) {
      if (edges[k] > edges[k - 1]) add_one_flow(piece, edges[k - 1], edges[k], sense);
    }
  }

  /// A stretch in which power flows one way through each mesh.
  void add_one_flow(const CyclePiece& piece, double x0, double x1, double sense) {
    if (piece.speed_rad_s[2] == 0.0 && constant_) {
      add_straight(piece, x0, x1, sense);
      return;
    }
    const double width = x1 - x0;
    const State first = state_at(piece, x0, sense);
    const State last = state_at(piece, x1, sense);
    const State half = state_at(piece, 0.5 * (x0 + x1), sense);
    const Quadratic torque = through(first.reflected_Nm, half.reflected_Nm, last.reflected_Nm);
    const Quadratic speed =
        through(first.motion.speed_rad_s, half.motion.speed_rad_s, last.motion.speed_rad_s);
    split_power(torque, speed);
    note_peaks(first);
    note_peaks(last);
    note_extremes(piece, x0, width, sense, torque, speed);
    for_each_part(x0, x1, [&](double begin, double end) {
      const double seconds = (end - begin) * piece.duration_s;
      const auto at = [&](std::size_t g) {
        return terms_of(state_at(piece, begin + (end - begin) * kGaussNodes[g], sense),
                        seconds * kGaussWeights[g]);
      };
      Terms terms = at(0);
      add_to(terms, at(1));
      add_to(terms, at(2));
      sums_.add(terms);
      keep_part(piece, begin, end, sense);
    });
  }
  /// The same where speed and torque are straight lines.
  void add_straight(const CyclePiece& piece, double x0, double x1, double sense) {
    const double acceleration = piece.acceleration(0.0);
    const State first = state_at(piece, x0, sense, acceleration);
    const State last = state_at(piece, x1, sense, acceleration);
    split_power(
        {first.reflected_Nm, last.reflected_Nm - first.reflected_Nm, 0.0},
        {first.motion.speed_rad_s, last.motion.speed_rad_s - first.motion.speed_rad_s, 0.0});
    note_peaks(first);
    note_peaks(last);
    for_each_part(x0, x1, [&](double begin, double end) {
      const double seconds = (end - begin) * piece.duration_s * 0.5;
      const auto at = [&](double place) {
        return terms_of(state_at(piece, begin + (end - begin) * place, sense, acceleration),
                        seconds);
      };
      Terms terms = at(0.5 - kTwoPointOffset);
      add_to(terms, at(0.5 + kTwoPointOffset));
      sums_.add(terms);
      keep_part(piece, begin, end, sense);
    });
  }

  /// Between the edges of split_power().
  template <class Take>
  void for_each_part(double x0, double x1, Take take) {
    const double width = x1 - x0;
    const std::vector<double>& parts = part_edges_;
    for (std::size_t k = 1; k < parts.size(); ++k) {
      const double begin = x0 + width * parts[k - 1];
      const double end = k + 1 == parts.size() ? x1 : x0 + width * parts[k];
      if (end > begin) take(begin, end);
    }
  }
  void keep_part(const CyclePiece& piece, double begin, double end, double sense) {
    if (!keep_) return;
    keep_instant(state_at(piece, begin, sense), start_s_ + begin * piece.duration_s);
    keep_instant(state_at(piece, end, sense), start_s_ + end * piece.duration_s);
  }

  /// Sets part_edges_: 0, where τ, P_el or P_bus change sign, 1.
  void split_power(const Quadratic& torque, const Quadratic& speed) {
    part_edges_.clear();
    part_edges_.push_back(0.0);
    append_sign_changes(torque, part_edges_);
    const double copper = actuator_.motor.resistance_ohm * per_torque_ * per_torque_;
    Quartic power = product(torque, speed);
    const Quartic square = product(torque, torque);
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += copper * square[k];
    append_sign_changes(power, part_edges_);
    const Drive& drive = actuator_.drive;
    if (drive.standby_W > 0.0 && drive.efficiency_regenerating > 0.0) {
      power[0] += drive.standby_W / drive.efficiency_regenerating;
      append_sign_changes(power, part_edges_);
    }
    part_edges_.push_back(1.0);
    if (part_edges_.size() > 2) std::ranges::sort(part_edges_);
  }

  [[nodiscard]] double current(const State& state) const {
    return state.reflected_Nm * per_torque_;
  }
  [[nodiscard]] double voltage(const State& state) const {
    return actuator_.motor.resistance_ohm * current(state) +
           actuator_.motor.torque_constant_Nm_A * chain_.ratio * state.motion.speed_rad_s;
  }

  /// What a node of a part adds to the sums.
  [[nodiscard]] Terms terms_of(const State& state, double seconds) const {
    const double w = state.motion.speed_rad_s;
    const double amperes = current(state);
    const double copper = actuator_.motor.resistance_ohm * amperes * amperes;
    const double electrical = copper + state.reflected_Nm * w;
    const double load = state.motion.load_Nm * w;
    const Drive& drive = actuator_.drive;
    const double bus = (electrical > 0.0 ? electrical / drive.efficiency_motoring
                                         : electrical * drive.efficiency_regenerating) +
                       drive.standby_W;
    const double moved = std::abs(load) * seconds;
    const double given = load > 0.0 ? moved : 0.0;
    const double taken = std::abs(bus) * seconds;
    Terms t;
    t[kPositive] = load > 0.0 ? 0.0 : moved;
    t[kNegative] = given;
    t[kDrawn] = bus > 0.0 ? taken : 0.0;
    t[kRegenerated] = bus > 0.0 ? 0.0 : taken;
    t[kCopper] = copper * seconds;
    t[kCoulomb] = chain_.c1_Nm * state.motion.sense * w * seconds;
    t[kViscous] = chain_.d1_Nms * w * w * seconds;
    t[kDrive] = (bus - electrical) * seconds;
    t[kSquareCurrent] = amperes * amperes * seconds;
    t[kSquareTorque] = state.reflected_Nm * state.reflected_Nm * seconds;
    t[kBackdriven] = state.gear.mesh_Nm * w < 0.0 ? given : 0.0;
    t[kBraking] = state.reflected_Nm * w < 0.0 ? given : 0.0;
    t[kRegenerating] = electrical < 0.0 ? given : 0.0;
    for (std::size_t k = 0; k < kCauses; ++k) {
      t[kFirstGearCause + k] = state.gear.loss_W[k] * seconds;
    }
    return t;
  }
  static void add_to(Terms& terms, const Terms& more) {
    for (std::size_t k = 0; k < kSums; ++k) terms[k] += more[k];
  }

  void note_peaks(const State& state) {
    const double i = std::abs(chain_.ratio);
    peak_current_A_ = std::max(peak_current_A_, std::abs(current(state)));
    peak_voltage_V_ = std::max(peak_voltage_V_, std::abs(voltage(state)));
    peak_speed_rad_s_ = std::max(peak_speed_rad_s_, i * std::abs(state.motion.speed_rad_s));
    peak_torque_Nm_ = std::max(peak_torque_Nm_, std::abs(state.reflected_Nm) / i);
  }

  /// Extremes of torque, speed and voltage between the ends of a stretch.
  void note_extremes(const CyclePiece& piece, double x0, double width, double sense,
                     const Quadratic& torque, const Quadratic& speed) {
    Quadratic volts{};
    for (std::size_t k = 0; k < volts.size(); ++k) {
      volts[k] = actuator_.motor.resistance_ohm * per_torque_ * torque[k] +
                 actuator_.motor.torque_constant_Nm_A * chain_.ratio * speed[k];
    }
    for (const Quadratic* p : {&torque, &speed, static_cast<const Quadratic*>(&volts)}) {
      const double place = -0.5 * (*p)[1] / (*p)[2];
      if (place > 0.0 && place < 1.0) note_peaks(state_at(piece, x0 + width * place, sense));
    }
  }

  void keep_instant(const State& state, double time_s) {
    const double amperes = current(state);
    instants_.push_back({.time_s = time_s,
                         .speed_rad_s = state.motion.speed_rad_s,
                         .load_Nm = state.motion.load_Nm,
                         .mesh_Nm = state.gear.mesh_Nm,
                         .motor_Nm = state.reflected_Nm / chain_.ratio,
                         .current_A = amperes,
                         .voltage_V = voltage(state),
                         .electrical_W = voltage(state) * amperes});
  }

  /// The output rests: the torque of least magnitude that holds it.
  [[nodiscard]] State resting(const CyclePiece& piece, double x) const {
    State state{.motion = motion_at(piece, x, 0.0)};
    const RestBand band = gear_.band(state.motion.load_Nm);
    const double low = band.low_Nm - chain_.c1_static_Nm;
    const double high = band.high_Nm + chain_.c1_static_Nm;
    state.reflected_Nm = low > 0.0 ? low : high < 0.0 ? high : 0.0;
    state.gear.mesh_Nm = -state.motion.load_Nm;
    return state;
  }
  void add_rest(const CyclePiece& piece);

  const Actuator& actuator_;
  Chain chain_;
  const Gear& gear_;
  double rotor_kgm2_, per_torque_;
  bool constant_, keep_;
  double start_s_ = 0.0;
  std::vector<double> edges_, flow_edges_, part_edges_, loads_;
  CompensatedSums<kSums> sums_;
  double peak_current_A_ = 0.0, peak_voltage_V_ = 0.0, peak_speed_rad_s_ = 0.0,
         peak_torque_Nm_ = 0.0;
  std::vector<MotorInstant> instants_;
};

template <class Gear, std::size_t kCauses>
void CycleRun<Gear, kCauses>::add_rest(const CyclePiece& piece) {
  std::vector<double> edges{0.0};
  gear_.append_band_kinks(piece, edges);
  edges.push_back(1.0);
  std::ranges::sort(edges);
  std::vector<double> parts{0.0};
  for (std::size_t k = 1; k < edges.size(); ++k) {
    const double width = edges[k] - edges[k - 1];
    if (!(width > 0.0)) continue;
    const RestBand from = gear_.band(value_at(piece.load_Nm, edges[k - 1]));
    const RestBand to = gear_.band(value_at(piece.load_Nm, edges[k]));
    std::vector<double> places;
    append_sign_changes(Quadratic{from.low_Nm - chain_.c1_static_Nm, to.low_Nm - from.low_Nm, 0.0},
                        places);
    append_sign_changes(
        Quadratic{from.high_Nm + chain_.c1_static_Nm, to.high_Nm - from.high_Nm, 0.0}, places);
    std::ranges::sort(places);
    for (const double place : places) parts.push_back(edges[k - 1] + width * place);
    parts.push_back(edges[k]);
  }
  for (std::size_t k = 1; k < parts.size(); ++k) {
    Terms terms{};
    for (std::size_t g = 0; g < kGaussNodes.size(); ++g) {
      const double width = parts[k] - parts[k - 1];
      add_to(terms, terms_of(resting(piece, parts[k - 1] + width * kGaussNodes[g]),
                             width * piece.duration_s * kGaussWeights[g]));
    }
    sums_.add(terms);
    for (const double x : {parts[k - 1], parts[k]}) {
      note_peaks(resting(piece, x));
      if (keep_) keep_instant(resting(piece, x), start_s_ + x * piece.duration_s);
    }
  }
}

std::vector<LimitCheck> limit_checks(const Actuator& actuator, const DutyCycle& d) {
  std::vector<LimitCheck> checks =
      drive_checks(actuator, {.current_A = d.peak_current_A,
                              .voltage_V = d.peak_voltage_V,
                              .motor_speed_rad_s = d.peak_motor_speed_rad_s});
  const MotorHeat& heat = actuator.motor.heat;
  if (heat.max_winding_K && d.winding) {
    checks.push_back(limit_check("winding", "K", d.winding->winding_K, *heat.max_winding_K));
  }
  return checks;
}

/// What a reader has to know about the temperatures.
void note_heat(const Actuator& actuator, DutyCycle& d) {
  const MotorHeat& heat = actuator.motor.heat;
  if (!d.winding) return;
  if (d.winding->runaway) {
    d.notes.emplace_back(
        "thermal runaway: the copper loss grows faster with temperature than heat leaves the "
        "winding; there is no steady state");
  }
  constexpr double kTold = 0.01;
  const double more = kCopperSlope_1_K * (d.winding->winding_K.value_or(kResistanceTemperature_K) -
                                          kResistanceTemperature_K);
  if (std::abs(more) >= kTold) {
    d.notes.push_back(fmt::format(
        "energies count the copper loss at 25 C: at the winding's mean of {:.1f} C it is {:.0f} % "
        "{}",
        units::from_si(*d.winding->winding_K, units::Unit::kCelsius), 100.0 * std::abs(more),
        more > 0.0 ? "more" : "less"));
  }
  constexpr double kBeyondInsulation_K = 300.0 + 273.15;
  if (d.winding->winding_K.value_or(0.0) > kBeyondInsulation_K) {
    d.notes.push_back(fmt::format(
        "at the winding's {:.0f} C no insulation lasts, nor do resistance and heat paths follow "
        "the linear model: it says that the cycle is too much, not by how much",
        units::from_si(*d.winding->winding_K, units::Unit::kCelsius)));
  }
  constexpr double kShort = 0.1;
  if (heat.winding_time_constant_s && d.period_s > kShort * *heat.winding_time_constant_s) {
    d.notes.push_back(fmt::format(
        "the cycle of {:g} s is not short against the winding's time constant of {:g} s: its "
        "temperature swings about the mean that is given",
        d.period_s, *heat.winding_time_constant_s));
  }
  if (!d.periodic) {
    d.notes.emplace_back("temperatures are those of the rows repeated without end");
  }
}

/// drawn − regenerated = positive − negative + losses + kinetic, relative to the magnitudes.
double balance_error_of(const DutyCycle& d) {
  CompensatedSum difference;
  double magnitude = 0.0;
  const auto add = [&](double energy) {
    difference.add(energy);
    magnitude += std::abs(energy);
  };
  for (const double energy :
       {d.drawn_J, -d.regenerated_J, -d.positive_J, d.negative_J, -d.kinetic_J}) {
    add(energy);
  }
  for (const LossEnergy& loss : d.losses) add(-loss.energy_J);
  return magnitude == 0.0 ? 0.0 : std::abs(difference.value()) / magnitude;
}

template <class Gear, std::size_t kCauses>
DutyCycle CycleRun<Gear, kCauses>::result(const Cycle& cycle,
                                          const std::vector<CyclePiece>& pieces) {
  DutyCycle d{.period_s = cycle.time_s.back() - cycle.time_s.front(),
              .periodic = is_periodic(cycle),
              .positive_J = sums_.value(kPositive),
              .negative_J = sums_.value(kNegative),
              .drawn_J = sums_.value(kDrawn),
              .regenerated_J = sums_.value(kRegenerated)};
  d.losses = {{.cause = "copper", .energy_J = sums_.value(kCopper)},
              {.cause = "motor_coulomb", .energy_J = sums_.value(kCoulomb)},
              {.cause = "motor_viscous", .energy_J = sums_.value(kViscous)}};
  for (std::size_t k = 0; k < kCauses; ++k) {
    d.losses.push_back({.cause = gear_.causes()[k], .energy_J = sums_.value(kFirstGearCause + k)});
  }
  d.losses.push_back({.cause = "drive", .energy_J = sums_.value(kDrive)});
  const double first = pieces.front().speed_rad_s[0];
  const double last = cycle.angles ? value_at(pieces.back().speed_rad_s, 1.0) : cycle.motion.back();
  d.kinetic_J = 0.5 * (rotor_kgm2_ + gear_.inertia_kgm2()) * (last - first) * (last + first);
  d.balance_error = balance_error_of(d);
  const double mean_square = sums_.value(kSquareCurrent) / d.period_s;
  d.peak_current_A = peak_current_A_;
  d.rms_current_A = std::sqrt(mean_square);
  d.peak_voltage_V = peak_voltage_V_;
  d.peak_motor_speed_rad_s = peak_speed_rad_s_;
  d.peak_motor_torque_Nm = peak_torque_Nm_;
  d.rms_motor_torque_Nm =
      std::sqrt(sums_.value(kSquareTorque) / d.period_s) / std::abs(chain_.ratio);
  if (d.negative_J > 0.0) {
    d.shares = {.backdriven = sums_.value(kBackdriven) / d.negative_J,
                .motor_braking = sums_.value(kBraking) / d.negative_J,
                .regenerating = sums_.value(kRegenerating) / d.negative_J};
  }
  d.winding =
      winding_state(actuator_.motor,
                    {.mean_square_current_A2 = mean_square,
                     .friction_W = (sums_.value(kCoulomb) + sums_.value(kViscous)) / d.period_s});
  if (!d.periodic) {
    d.notes.emplace_back(
        "the cycle does not close (its first and last row differ): it is taken once, not as "
        "periodic");
  }
  note_heat(actuator_, d);
  d.checks = limit_checks(actuator_, d);
  d.feasible = std::ranges::all_of(d.checks, &LimitCheck::ok) && !(d.winding && d.winding->runaway);
  d.instants = std::move(instants_);
  return d;
}

template <class Gear, std::size_t kCauses>
DutyCycle run_with(const Actuator& actuator, const Gear& gear, const Cycle& cycle, bool keep) {
  const std::vector<CyclePiece> pieces = pieces_of(cycle);
  CycleRun<Gear, kCauses> run(actuator, gear, keep);
  for (std::size_t k = 0; k < pieces.size(); ++k) run.add(pieces[k], cycle.time_s[k]);
  return run.result(cycle, pieces);
}

}  // namespace

LimitCheck limit_check(std::string name, std::string unit, std::optional<double> value,
                       double limit) {
  LimitCheck check{
      .name = std::move(name), .unit = std::move(unit), .value = value, .limit = limit};
  if (value) check.margin = limit - *value;
  check.ok = check.margin && *check.margin >= 0.0;
  return check;
}

std::vector<LimitCheck> drive_checks(const Actuator& actuator, const DrivePeaks& peaks) {
  const Motor& motor = actuator.motor;
  std::vector<LimitCheck> checks;
  if (motor.max_current_A) {
    checks.push_back(limit_check("current", "A", peaks.current_A, *motor.max_current_A));
  }
  if (const auto& bus_V = actuator.drive.bus_voltage_V) {
    checks.push_back(limit_check("voltage", "V", peaks.voltage_V, *bus_V));
  }
  if (motor.max_speed_rad_s) {
    checks.push_back(
        limit_check("speed", "rad/s", peaks.motor_speed_rad_s, *motor.max_speed_rad_s));
  }
  return checks;
}

DutyCycle run_cycle(const Actuator& actuator, const Cycle& cycle, bool keep_instants) {
  if (actuator.train == nullptr) {
    return run_with<CatalogueGear, CatalogueGear::kCauses>(actuator, CatalogueGear(actuator), cycle,
                                                           keep_instants);
  }
  return run_with<GearModel, kMostGearLosses>(actuator, *gear_model(actuator), cycle,
                                              keep_instants);
}

}  // namespace gear3k::actuator
