#include "design/torque_angle_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "design/loaded_train.hpp"
#include "design/measured_lost_motion.hpp"
#include "design/rated_gearbox.hpp"

namespace gear3k::design {

namespace {

using strength::LockedCompliance, strength::LockedLoads, strength::SlidingCouple;
using Couples = std::array<SlidingCouple, train::kMeshCount>;
using Angles = std::array<double, 1 + train::kMeshCount>;  ///< φ, ψ_1, ψ_2, ψ_3

/// Unknowns of a step: m_1, m_2, m_3 and the gap at the sun's flank, and their equations.
constexpr std::size_t kUnknowns = 1 + train::kMeshCount;
using StepRow = std::array<double, kUnknowns + 1>;  ///< with the right side
using StepEquations = std::array<StepRow, kUnknowns>;
using StepUnknowns = std::array<double, kUnknowns>;

/// Gives the planets' turns a compliance of their own where two of them are one, over the greatest
/// of theirs: numerical.
constexpr double kSplit = 1e-9;
/// How far a step may break its conditions, over the peak's torque and wind-up.
constexpr double kAllowed = 1e-8;

enum class Sliding { kRests, kCentralDrives, kPlanetDrives };

/// By elimination with pivots; empty for a singular system.
std::optional<StepUnknowns> solved(StepEquations a) {
  for (std::size_t k = 0; k < kUnknowns; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < kUnknowns; ++i) {
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    }
    if (a[pivot][k] == 0.0) return std::nullopt;
    std::swap(a[k], a[pivot]);
    for (std::size_t i = k + 1; i < kUnknowns; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j <= kUnknowns; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  StepUnknowns x{};
  for (std::size_t k = kUnknowns; k-- > 0;) {
    double sum = a[k][kUnknowns];
    for (std::size_t j = k + 1; j < kUnknowns; ++j) sum -= a[k][j] * x[j];
    x[k] = sum / a[k][k];
  }
  return x;
}

double product(const LockedLoads& a, const LockedLoads& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Loads of the held train and where they put it.
struct LoopState {
  LockedLoads load{};  ///< T, m_k
  Angles angle{};
  double gap_m = 0.0;
  std::array<double, train::kMeshCount> normal_N{};
};

/// One side of the loop, step by step.
class LoopPath {
 public:
  LoopPath(const ElasticTrain& train, const train::ToothSet& teeth, double peak_torque_Nm)
      : train_(train), peak_Nm_(peak_torque_Nm), lever_(train::planet_levers(teeth)) {
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      sense_[k] = train.train.mesh_torque[k][0] < 0.0 ? -1.0 : 1.0;
    }
    elastic_rad_ = elastic_windup(train, peak_torque_Nm);
  }

  [[nodiscard]] const LoopState& state() const { return state_; }

  /// Goes on to a torque; false where no forces are in balance, or the springs' are not found.
  bool go_to(double torque_Nm, const Couples& couples) {
    LoopState next = state_;
    for (std::size_t k = 0; k < train::kMeshCount; ++k) next.normal_N[k] = lossless(k, torque_Nm);
    constexpr int kMostRounds = 50;
    for (int round = 0; round < kMostRounds; ++round) {
      const auto found = balanced(torque_Nm, couples, next.normal_N);
      if (!found) return false;
      const auto before = next.normal_N;
      next = *found;
      // The springs depend on the logarithm of their forces.
      double change = 0.0;
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        change = std::max(change, std::abs(next.normal_N[k] - before[k]));
      }
      if (change <= 1e-12 * (lossless(1, peak_Nm_) + lossless(2, peak_Nm_))) {
        state_ = next;
        return true;
      }
    }
    return false;
  }

 private:
  [[nodiscard]] double lossless(std::size_t k, double torque_Nm) const {
    return std::abs(train_.train.mesh_torque[k][0] * torque_Nm) * train_.train.normal_N_per_Nm[k];
  }

  [[nodiscard]] LockedCompliance compliance_at(
      const std::array<double, train::kMeshCount>& normal_N) const {
    std::array<double, train::kMeshCount> mesh{};
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      mesh[k] = mesh_compliance(train_.mesh[k], normal_N[k]);
    }
    LockedCompliance c = strength::locked_compliance(train_.train, mesh);
    const double greatest = std::max({c[1][1], c[2][2], c[3][3]});
    for (std::size_t k = 1; k < c.size(); ++k) c[k][k] += kSplit * greatest;
    return c;
  }

  /// ∂(N F_1)/∂load: what a gap at the sun's flank does to the angles.
  [[nodiscard]] LockedLoads sun_force() const {
    LockedLoads force = train_.train.mesh_torque[0];
    for (double& f : force) f *= sense_[0] * train_.train.normal_N_per_Nm[0] * train_.train.planets;
    return force;
  }

  [[nodiscard]] double couple_of(Sliding sliding, const SlidingCouple& couple) const {
    return sliding == Sliding::kCentralDrives ? couple.central_drives : couple.planet_drives;
  }

  /// The state under a torque from the last one on, with the springs at these forces.
  [[nodiscard]] std::optional<LoopState> balanced(
      double torque_Nm, const Couples& couples,
      const std::array<double, train::kMeshCount>& normal_N) const {
    const LockedCompliance c = compliance_at(normal_N);
    std::optional<LoopState> best;
    double least = kAllowed;
    constexpr unsigned kWays = 54;  // three ways in each mesh, the sun's flank in contact or not
    for (unsigned way = 0; way < kWays; ++way) {
      const std::array<Sliding, train::kMeshCount> sliding{static_cast<Sliding>(way % 3),
                                                           static_cast<Sliding>(way / 3 % 3),
                                                           static_cast<Sliding>(way / 9 % 3)};
      const bool lifted = way >= kWays / 2;
      const auto tried = state_of(torque_Nm, couples, c, sliding, lifted);
      if (!tried) continue;
      const double broken = violation(*tried, couples, sliding);
      if (broken < least) {
        least = broken;
        best = tried;
        if (broken < 1e-3 * kAllowed) break;
      }
    }
    return best;
  }

  [[nodiscard]] std::optional<LoopState> state_of(
      double torque_Nm, const Couples& couples, const LockedCompliance& c,
      const std::array<Sliding, train::kMeshCount>& sliding, bool lifted) const {
    const LockedLoads by_gap = sun_force();
    StepEquations equations{};
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      StepRow& row = equations[k];
      if (sliding[k] == Sliding::kRests) {
        const double scale = 1.0 / c[k + 1][k + 1];
        for (std::size_t j = 0; j < train::kMeshCount; ++j) row[j] = c[k + 1][j + 1] * scale;
        row[3] = -by_gap[k + 1] * scale;
        row[kUnknowns] = (state_.angle[k + 1] - c[k + 1][0] * torque_Nm) * scale;
      } else {
        const double couple = couple_of(sliding[k], couples[k]);
        const LockedLoads& t = train_.train.mesh_torque[k];
        for (std::size_t j = 0; j < train::kMeshCount; ++j) row[j] = -couple * t[j + 1];
        row[k] += 1.0;
        row[kUnknowns] = couple * t[0] * torque_Nm;
      }
    }
    StepRow& contact = equations[3];
    if (lifted) {
      const LockedLoads& t = train_.train.mesh_torque[0];
      for (std::size_t j = 0; j < train::kMeshCount; ++j) contact[j] = t[j + 1];
      contact[kUnknowns] = -t[0] * torque_Nm;
    } else {
      contact[3] = 1.0;
    }
    const auto x = solved(equations);
    if (!x) return std::nullopt;
    LoopState s;
    s.load = {torque_Nm, (*x)[0], (*x)[1], (*x)[2]};
    s.gap_m = (*x)[3];
    for (std::size_t i = 0; i < s.angle.size(); ++i) {
      s.angle[i] = product(c[i], s.load) - by_gap[i] * s.gap_m;
    }
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      s.normal_N[k] = sense_[k] * product(train_.train.mesh_torque[k], s.load) *
                      train_.train.normal_N_per_Nm[k];
    }
    return s;
  }

  /// By how much a state breaks what its ways of sliding ask for; 0: not at all.
  [[nodiscard]] double violation(const LoopState& s, const Couples& couples,
                                 const std::array<Sliding, train::kMeshCount>& sliding) const {
    const LockedLoads by_gap = sun_force();
    double broken = std::max(0.0, -s.gap_m * by_gap[0] / elastic_rad_);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const double unit_N = lossless(k, peak_Nm_);
      broken = std::max(broken, -s.normal_N[k] / unit_N);
      const double turn = (s.angle[k + 1] - state_.angle[k + 1]) / elastic_rad_;
      // The central gear drives where t ψ̇ λ > 0.
      const double driven = sense_[k] * lever_[k] * turn;
      if (sliding[k] == Sliding::kCentralDrives) {
        broken = std::max(broken, -driven);
      } else if (sliding[k] == Sliding::kPlanetDrives) {
        broken = std::max(broken, driven);
      } else {
        const double t = product(train_.train.mesh_torque[k], s.load);
        const auto [low, high] =
            std::minmax({couples[k].central_drives * t, couples[k].planet_drives * t});
        const double m = s.load[k + 1];
        broken = std::max({broken, (low - m) / peak_Nm_, (m - high) / peak_Nm_});
      }
    }
    return broken;
  }

  const ElasticTrain& train_;
  double peak_Nm_ = 0.0, elastic_rad_ = 0.0;
  std::array<double, train::kMeshCount> lever_{}, sense_{};
  LoopState state_{};
};

std::optional<Couples> couples_of(const train::ToothSet& teeth,
                                  const strength::MeshDriverEfficiencies<double>& efficiency) {
  Couples result;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto couple = strength::sliding_couple(teeth, k, efficiency[k]);
    if (!couple) return std::nullopt;
    result[k] = *couple;
  }
  return result;
}

/// What a calibrated model adds to the springs on one side of the loop.
double added_windup(const ElasticTrain& train, const backlash::LostMotionExtension<double>& e,
                    double torque_Nm) {
  const double half_rad = 0.5 * backlash::windup(e, torque_Nm);
  if (half_rad == 0.0 || e.beyond_springs) return half_rad;
  return half_rad - elastic_windup(train, torque_Nm);
}

void check_loop(const TorqueAngleTask& task) {
  if (!(task.peak_torque_Nm > 0.0 && task.lost_motion_rad >= 0.0 && task.steps >= 1)) {
    throw std::invalid_argument(
        fmt::format("torque-angle loop: peak torque {} N m, lost motion {} rad, {} steps; allowed: "
                    "above 0, at least 0, at least 1",
                    task.peak_torque_Nm, task.lost_motion_rad, task.steps));
  }
}

}  // namespace

std::optional<TorqueAngleCurve> torque_angle_loop(const ElasticTrain& train,
                                                  const TorqueAngleTask& task) {
  check_loop(task);
  const auto couples = couples_of(task.teeth, task.efficiency);
  if (!couples) return std::nullopt;
  TorqueAngleCurve curve;
  curve.peak_torque_Nm = task.peak_torque_Nm;
  curve.lost_motion_rad = task.lost_motion_rad;
  LoopPath path(train, task.teeth, task.peak_torque_Nm);
  double side_J = 0.0;
  double side_friction_J = 0.0;
  const auto angle_at = [&] {
    return 0.5 * task.lost_motion_rad + path.state().angle[0] +
           added_windup(train, task.extension, path.state().load[0]);
  };
  curve.branch[0].push_back({.torque_Nm = 0.0, .angle_rad = angle_at()});
  for (const std::size_t side : {0U, 1U}) {
    if (side == 1) curve.branch[1].push_back(curve.branch[0].back());
    for (int step = 1; step <= task.steps; ++step) {
      const double share = static_cast<double>(side == 0 ? step : task.steps - step) / task.steps;
      const LoopState before = path.state();
      const double angle_before = angle_at();
      if (!path.go_to(share * task.peak_torque_Nm, *couples)) {
        return std::nullopt;
      }
      const LoopState& now = path.state();
      curve.sun_lifts_off = curve.sun_lifts_off || now.gap_m > 0.0;
      side_J += 0.5 * (now.load[0] + before.load[0]) * (angle_at() - angle_before);
      for (std::size_t k = 1; k < now.load.size(); ++k) {
        side_friction_J -= 0.5 * (now.load[k] + before.load[k]) * (now.angle[k] - before.angle[k]);
      }
      curve.branch[side].push_back({.torque_Nm = now.load[0], .angle_rad = angle_at()});
    }
    if (side == 0) curve.windup_rad = angle_at() - 0.5 * task.lost_motion_rad;
  }
  curve.held_rad = angle_at() - 0.5 * task.lost_motion_rad;
  for (const std::size_t side : {0U, 1U}) {
    for (const TorqueAnglePoint& point : curve.branch[side]) {
      curve.branch[side + 2].push_back(
          {.torque_Nm = -point.torque_Nm, .angle_rad = -point.angle_rad});
    }
  }
  curve.loop_J = 2.0 * side_J;
  curve.friction_J = 2.0 * side_friction_J;
  const auto elastic = [&](double torque_Nm) {
    return elastic_windup(train, torque_Nm) + added_windup(train, task.extension, torque_Nm);
  };
  curve.elastic_rad = elastic(task.peak_torque_Nm);
  for (const double share : {0.125, 0.25, 0.5, 1.0}) {
    const double torque_Nm = share * task.peak_torque_Nm;
    curve.stiffness.push_back(
        {.torque_Nm = torque_Nm, .output_Nm_rad = torque_Nm / elastic(torque_Nm)});
  }
  return curve;
}

std::variant<TorqueAngleCurve, std::string> torque_angle_curve(const Design& design,
                                                               const Evaluation& evaluation) {
  if (!design.rating) return "the design states no [strength]";
  const auto train = elastic_train(design);
  if (!train) return "a mesh has no path of contact";
  const train::TrainParameters<double> parameters = resolved_parameters(design);
  const auto geometry = train::make_train_geometry(parameters);
  const double temperature_K =
      design.operating_point.value_or(OperatingPoint<double>{}).temperature_K;
  const auto lost_motion = measured_lost_motion<double>(parameters, *geometry, design.lost_motion,
                                                        {.temperature_K = temperature_K});
  if (!lost_motion) return "a mesh has no working pressure angle at the temperature";
  if (!(*lost_motion >= 0.0)) return "the lost motion is negative: it jams";
  const strength::RatingTask& task = *design.rating;
  const auto loaded = loaded_train<double>(*geometry, {}, task.face_width_m,
                                           force_friction(design.friction, evaluation.meshes),
                                           design.friction.model);
  auto curve = torque_angle_loop(
      *train,
      {.peak_torque_Nm = task.torque_Nm,
       .lost_motion_rad = *lost_motion,
       .teeth = parameters.teeth,
       .efficiency = loaded.efficiency[static_cast<std::size_t>(strength::Drive::kBackward)],
       .extension = design.lost_motion});
  if (!curve)
    return "no forces of the locked train were found in balance: too much friction, or springs "
           "that no force keeps";
  return *std::move(curve);
}

}  // namespace gear3k::design
