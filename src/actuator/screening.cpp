#include "actuator/screening.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gear3k::actuator {

namespace {

/// Bounds are lowered by this share: their rounding is not that of the exact cycle.
constexpr double kScreenRoom = 1e-9;
constexpr double kNever = std::numeric_limits<double>::infinity();
/// Motors whose peaks are found side by side: a loop too long to be unrolled is made one of
/// vectors.
constexpr std::size_t kLanes = 16;
using Lanes = std::array<double, kLanes>;

struct LaneMotors {
  Lanes j1{}, d1{}, c1{}, per_torque{}, ohms{}, back_emf{};
};
struct LanePeaks {
  Lanes amperes{}, volts{};
};

void note_point(const std::array<double, 4>& point, const LaneMotors& m, LanePeaks& peaks) {
  const auto [u, a, w, s] = point;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double amperes = (u + m.j1[k] * a + m.d1[k] * w + m.c1[k] * s) * m.per_torque[k];
    const double volts = m.ohms[k] * amperes + m.back_emf[k] * w;
    const double current = std::abs(amperes);
    const double voltage = std::abs(volts);
    peaks.amperes[k] = peaks.amperes[k] < current ? current : peaks.amperes[k];
    peaks.volts[k] = peaks.volts[k] < voltage ? voltage : peaks.volts[k];
  }
}

}  // namespace

Actuator actuator_of(const SelectionTask& task, const Pair& pair) {
  Actuator a{.name = {},
             .motor = task.motors[pair.motor].motor,
             .gearbox = task.gearboxes[pair.gearbox].gearbox,
             .drive = task.drive,
             .load_inertia_kgm2 = task.load_inertia_kgm2,
             .felt = task.felt,
             .train = nullptr};
  a.motor.heat.ambient_K = ambient_of(task, pair.motor);
  return a;
}

void set_constants(const Motor& motor, const Gearbox& gearbox, const Chain& chain, PairResult& r) {
  if (motor.mass_kg && gearbox.mass_kg) r.mass_kg = *motor.mass_kg + *gearbox.mass_kg;
  if (chain.efficiency_backward > 0.0) {
    r.breakaway_Nm = chain.c2_static_Nm + chain.c1_static_Nm / chain.efficiency_backward;
  }
  r.inertia_kgm2 = chain.j1_kgm2 + gearbox.output_inertia_kgm2;
}

bool limits_felt(const FeltLimits& limits) {
  return limits.max_inertia_kgm2 || limits.max_breakaway_Nm || limits.max_transparency;
}

double total_time(const SelectionTask& task) {
  double time = 0.0;
  for (std::size_t k = 0; k < task.cycles.size(); ++k) {
    time += task.weights[k] * (task.cycles[k].time_s.back() - task.cycles[k].time_s.front());
  }
  return time;
}

Screening::Screening(const SelectionTask& task) : task_(task), time_s_(total_time(task)) {
  pieces_.reserve(task.cycles.size());
  for (const Cycle& cycle : task.cycles) pieces_.push_back(pieces_of(cycle));
  const std::size_t count = task.motors.size();
  Motors& m = motors_;
  for (const CatalogueMotor& motor : task.motors) {
    m.rotor_kgm2.push_back(motor.motor.rotor_inertia_kgm2);
    m.viscous_Nms.push_back(motor.motor.viscous_Nms);
    m.coulomb_Nm.push_back(motor.motor.coulomb_Nm);
    m.resistance_ohm.push_back(motor.motor.resistance_ohm);
    m.constant_Nm_A.push_back(motor.motor.torque_constant_Nm_A);
  }
  for (Column* column : {&m.j1_kgm2, &m.d1_Nms, &m.c1_Nm, &m.per_torque, &m.back_emf,
                         &sums_.square_A2, &sums_.energy_J, &sums_.magnitude_J}) {
    column->resize(count);
  }
  results_.resize(count);
}

void Screening::reflect_motors(double ratio) {
  Motors& m = motors_;
  const double square = ratio * ratio;
  const double fast = std::abs(ratio);
  for (std::size_t k = 0; k < results_.size(); ++k) {
    m.j1_kgm2[k] = square * m.rotor_kgm2[k];
    m.d1_Nms[k] = square * m.viscous_Nms[k];
    m.c1_Nm[k] = fast * m.coulomb_Nm[k];
    m.back_emf[k] = ratio * m.constant_Nm_A[k];
    m.per_torque[k] = 1.0 / m.back_emf[k];
  }
}

void Screening::add_cycle(const CycleMoments& moments, double weight) {
  const auto& s = moments.square;
  const double standby = task_.drive.standby_W * moments.period_s;
  const Motors& m = motors_;
  for (std::size_t k = 0; k < results_.size(); ++k) {
    const double j = m.j1_kgm2[k];
    const double d = m.d1_Nms[k];
    const double c = m.c1_Nm[k];
    // pᵀ M p with p = (1, j, d, c).
    const double square = s[0][0] + j * (2.0 * s[0][1] + j * s[1][1]) +
                          d * (2.0 * (s[0][2] + j * s[1][2]) + d * s[2][2]) +
                          c * (2.0 * (s[0][3] + j * s[1][3] + d * s[2][3]) + c * s[3][3]);
    const double amperes2 = square * m.per_torque[k] * m.per_torque[k];
    // ∫ τ w: rows of M with w.
    const double work = moments.input_work_J + j * s[1][2] + d * s[2][2] + c * s[3][2];
    const double copper = m.resistance_ohm[k] * amperes2;
    sums_.square_A2[k] += weight * amperes2;
    sums_.energy_J[k] += weight * (copper + work + standby);
    sums_.magnitude_J[k] += weight * (copper + std::abs(work) + standby);
  }
}

/// Peaks of current and voltage at the ends of all parts, of the motors in left_.
void Screening::set_peaks() {
  for (std::size_t begin = 0; begin < left_.size(); begin += kLanes) {
    const std::size_t count = std::min(kLanes, left_.size() - begin);
    LaneMotors lanes;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t motor = left_[begin + k];
      lanes.j1[k] = motors_.j1_kgm2[motor];
      lanes.d1[k] = motors_.d1_Nms[motor];
      lanes.c1[k] = motors_.c1_Nm[motor];
      lanes.per_torque[k] = motors_.per_torque[motor];
      lanes.ohms[k] = motors_.resistance_ohm[motor];
      lanes.back_emf[k] = motors_.back_emf[motor];
    }
    LanePeaks peaks;
    for (const CycleMoments& cycle : moments_) {
      for (const auto& point : cycle.points) note_point(point, lanes, peaks);
    }
    for (std::size_t k = 0; k < count; ++k) {
      PairResult& r = results_[left_[begin + k]];
      r.peak_current_A = peaks.amperes[k] * (1.0 - kScreenRoom);
      r.peak_voltage_V = peaks.volts[k] * (1.0 - kScreenRoom);
    }
  }
}

/// As felt_torque() and reflected() have them, in closed form and lowered.
Felt Screening::felt_bound(const Chain& chain) const {
  const double backward = chain.efficiency_backward;
  if (!(backward > 0.0))
    return {.inertia_kgm2 = kNever, .breakaway_Nm = kNever, .transparency = kNever};
  Felt felt{
      .inertia_kgm2 = (chain.j2_kgm2 + chain.j1_kgm2 / backward) * (1.0 - kScreenRoom),
      .breakaway_Nm = (chain.c2_static_Nm + chain.c1_static_Nm / backward) * (1.0 - kScreenRoom)};
  if (const auto& motor_Nm = task_.felt.transparency_torque_Nm) {
    const double with = chain.efficiency_forward * (*motor_Nm - chain.c1_Nm) - chain.c2_Nm;
    const double against = (*motor_Nm + chain.c1_Nm) / backward + chain.c2_Nm;
    const bool told = *motor_Nm > chain.c1_Nm && with + against > 0.0;
    // A difference: its rounding is of the size of what it is one of.
    const double over_mean = 2.0 * (against - with) / (against + with);
    felt.transparency = told ? over_mean - kScreenRoom * (1.0 + std::abs(over_mean)) : kNever;
  }
  return felt;
}

const std::vector<PairResult>& Screening::bounds(std::size_t gearbox) {
  return bounds(actuator_of(task_, {.motor = 0, .gearbox = gearbox}), gearbox);
}

const std::vector<PairResult>& Screening::bounds(const Actuator& first) { return bounds(first, 0); }

/// Of a train the constants are those without its losses, which bound them from below.
const std::vector<PairResult>& Screening::bounds(const Actuator& first, std::size_t gearbox) {
  moments_.clear();
  std::ranges::fill(sums_.square_A2, 0.0);
  std::ranges::fill(sums_.energy_J, 0.0);
  std::ranges::fill(sums_.magnitude_J, 0.0);
  reflect_motors(first.gearbox.ratio);
  double square_mesh = 0.0;
  double peak_mesh = 0.0;
  for (std::size_t k = 0; k < task_.cycles.size(); ++k) {
    moments_.push_back(cycle_moments(first, pieces_[k]));
    const CycleMoments& m = moments_.back();
    square_mesh += task_.weights[k] * m.square_mesh;
    peak_mesh = std::max(peak_mesh, m.peak_mesh_Nm);
    add_cycle(m, task_.weights[k]);
  }
  left_.clear();
  const Gearbox& gears = first.gearbox;
  const bool felt = limits_felt(task_.felt);
  for (std::size_t k = 0; k < results_.size(); ++k) {
    PairResult& r = results_[k];
    r = {.pair = {.motor = k, .gearbox = gearbox}};
    const Motor& motor = task_.motors[k].motor;
    const Chain chain = chain_of(motor, gears, task_.load_inertia_kgm2);
    set_constants(motor, gears, chain, r);
    if (felt) r.felt = felt_bound(chain);
    r.energy_J = sums_.energy_J[k] - kScreenRoom * sums_.magnitude_J[k];
    r.rms_current_A = std::sqrt(sums_.square_A2[k] / time_s_) * (1.0 - kScreenRoom);
    r.rms_torque_Nm = std::sqrt(square_mesh / time_s_) * (1.0 - kScreenRoom);
    r.peak_torque_Nm = peak_mesh * (1.0 - kScreenRoom);
    judge(task_, r, 0.0, r);
    if (!(r.excess > 0.0)) left_.push_back(k);
  }
  set_peaks();
  for (const std::size_t k : left_) judge(task_, results_[k], 0.0, results_[k]);
  return results_;
}

}  // namespace gear3k::actuator
