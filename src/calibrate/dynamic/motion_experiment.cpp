#include "calibrate/dynamic/motion_experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "numerics/distributions.hpp"
#include "numerics/linear_algebra.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

using Eigen::Index;
using numerics::square;

constexpr double kLeastStatistic = 4.0;  // of a proposal that is told

/// What the log was like.
struct LoggedMotion {
  double speed = 0.0;       ///< greatest of a window
  double angular = 0.0;     ///< Ω of the sine with its ratio of acceleration to speed
  double duration_s = 0.0;  ///< in windows
  double motor_Nm = 0.0;    ///< rms
};

LoggedMotion logged_motion(const std::vector<MotionWindow>& windows) {
  LoggedMotion r;
  double rate = 0.0, speed = 0.0, motor = 0.0;
  for (const MotionWindow& w : windows) {
    const double root = w.term[4];
    r.speed = std::max(r.speed, std::abs(w.term[1] / root));
    rate += square(w.term[0] / root);
    speed += square(w.term[1] / root);
    motor += square(w.motor_Nm / root);
    r.duration_s += w.duration_s;
  }
  r.angular = std::sqrt(rate / speed);
  r.motor_Nm = std::sqrt(motor / static_cast<double>(windows.size()));
  return r;
}

/// Sums that a motion would give, of unit noise per sample where the log's deviation is 1.
std::vector<WindowGroup> expected_groups(const MotionProposal& p, const DriveParameters& d,
                                         double load_kgm2, double variance, double samples) {
  std::vector<WindowGroup> groups;
  constexpr int kSteps = 400;
  std::array<WindowGroup, 2> both{};
  for (std::size_t f = 0; f < 2; ++f) {
    both.at(f).flow = f == 0 ? 1 : -1;
    both.at(f).load_kgm2 = load_kgm2 + p.inertia_kgm2;
    both.at(f).both_senses = true;
  }
  const bool chirp = p.id == "chirp";
  for (int k = 0; k < kSteps; ++k) {
    const double share = (k + 0.5) / kSteps;
    const double phase = 2.0 * std::numbers::pi * std::fmod(share * 37.0, 1.0);
    // A chirp goes from a third of the frequency to three times it.
    const double omega =
        2.0 * std::numbers::pi * p.frequency_Hz * (chirp ? std::pow(9.0, share - 0.5) : 1.0);
    const double w = p.amplitude_rad_s * std::sin(phase);
    const double a = p.amplitude_rad_s * omega * std::cos(phase), s = w > 0.0 ? 1.0 : -1.0;
    // An arm of its own slower swing.
    const double load = p.load_Nm * std::sin(2.0 * std::numbers::pi * 5.3 * share);
    const double mesh = (d.output_inertia_kgm2 + load_kgm2 + p.inertia_kgm2) * a +
                        d.output_viscous_Nms * w + d.output_coulomb_Nm * s - load;
    WindowGroup& g = both.at(s * mesh > 0.0 ? 0U : 1U);
    const Eigen::Vector4d x(a, w, s, -load);
    g.matrix += samples / kSteps / variance * x * x.transpose();
    ++g.windows;
  }
  for (WindowGroup& g : both) {
    if (g.windows == 0) continue;
    groups.push_back(g);
  }
  return groups;
}

/// Lets the sums be those that a drive gives without noise.
void make_exact(WindowSums& sums, const DriveParameters& drive) {
  assemble(sums);
  Eigen::VectorXd beta(sums.right.size());
  for (std::size_t k = 0; k < sums.groups.size(); ++k) {
    const auto own = drive_coefficients(drive, sums.groups[k].flow, sums.groups[k].load_kgm2);
    beta.segment<4>(static_cast<Index>(4 * k)) = Eigen::Vector4d(own[0], own[1], own[2], own[3]);
  }
  sums.right = sums.matrix * beta;
  sums.square = beta.dot(sums.right);
}

std::vector<MotionProposal> proposals(const LoggedMotion& m, const DriveParameters& d,
                                      double load_kgm2) {
  const double frequency = m.angular / (2.0 * std::numbers::pi);
  MotionProposal plain{.id = "",
                       .advice = "",
                       .amplitude_rad_s = m.speed,
                       .frequency_Hz = frequency,
                       .duration_s = m.duration_s,
                       .separates = {}};
  std::vector<MotionProposal> all(3, plain);
  all[0].id = "gravity";
  all[0].load_Nm = m.motor_Nm;
  all[0].advice = fmt::format(
      "move a known weight on an arm, up to {:.3g} N m at the output, up and down, and log its "
      "torque as output_torque_nm",
      m.motor_Nm);
  all[1].id = "second_inertia";
  all[1].inertia_kgm2 = d.motor_inertia_kgm2 + d.output_inertia_kgm2 + load_kgm2;
  all[1].advice = fmt::format(
      "add a known inertia of {:.3g} kg m2 to the output and log the same motion, with the note "
      "\"# load_inertia_kgm2: ...\"",
      all[1].inertia_kgm2);
  all[2].id = "chirp";
  all[2].advice = fmt::format("log a chirp from {:.3g} to {:.3g} Hz at {:.3g} rad/s",
                              frequency / 3.0, frequency * 3.0, m.speed);
  return all;
}

/// Sets of causes that the log leaves open.
struct Hypotheses {
  std::vector<std::vector<std::size_t>> sets;  ///< the effects, then with an alternative each
};

Hypotheses hypotheses_of(const MotionDiagnosis& d) {
  Hypotheses h;
  std::vector<std::size_t> own;
  for (const MotionEffect& e : d.effects) own.push_back(e.cause);
  h.sets.push_back(own);
  for (std::size_t k = 0; k < d.effects.size(); ++k) {
    for (const MotionAlternative& a : d.effects[k].alternatives) {
      std::vector<std::size_t> other = own;
      other[k] = a.cause;
      std::ranges::sort(other);
      h.sets.push_back(other);
    }
  }
  if (d.sides_as_well) {
    h.sets.push_back({kMotorCoulombChange, kOutputCoulombChange, kMotorViscousChange,
                      kOutputViscousChange, kMotorInertiaChange, kOutputInertiaChange});
  }
  return h;
}

}  // namespace

std::optional<MotionProposal> next_motion(const MotionDiagnosis& diagnosis, const WindowSums& sums,
                                          const DriveParameters& stated,
                                          const DriveChanges& changes) {
  const DriveParameters drive = changed_drive(stated, changes);
  if (diagnosis.effects.empty() || sums.groups.empty()) return std::nullopt;
  const LoggedMotion logged = logged_motion(diagnosis.rows);
  const double load_kgm2 = sums.groups.front().load_kgm2;
  double samples = 0.0;
  for (const MotionWindow& w : diagnosis.rows) samples += square(w.term[4]);
  const double per_window = samples / static_cast<double>(diagnosis.rows.size());
  const double variance = square(sums.deviation_Nm) * per_window;
  const Hypotheses h = hypotheses_of(diagnosis);
  std::optional<MotionProposal> best;
  for (MotionProposal p : proposals(logged, drive, load_kgm2)) {
    WindowSums after = sums;
    for (const WindowGroup& g : expected_groups(p, drive, load_kgm2, variance, samples)) {
      after.groups.push_back(g);
    }
    make_exact(after, drive);
    p.expected_statistic = std::numeric_limits<double>::max();
    for (std::size_t k = 1; k < h.sets.size(); ++k) {
      const DriveFit fit = fit_drive(after, stated, h.sets[k]);
      p.expected_statistic = std::min(p.expected_statistic, fit.statistic);
    }
    std::vector<std::size_t> all = h.sets[0];
    for (const MotionEffect& e : diagnosis.effects) {
      for (const MotionAlternative& a : e.alternatives) {
        if (std::ranges::find(all, a.cause) == all.end()) all.push_back(a.cause);
      }
    }
    p.separates = all;
    std::ranges::sort(all);
    const DriveFit joint = fit_drive(after, stated, all);
    if (joint.determined) {
      const auto at =
          static_cast<Index>(std::ranges::find(all, diagnosis.effects.front().cause) - all.begin());
      p.half_width =
          numerics::student_quantile(0.975, sums.degrees) * std::sqrt(joint.covariance(at, at));
    }
    if (p.expected_statistic < kLeastStatistic) continue;
    if (!best || p.expected_statistic > best->expected_statistic) best = std::move(p);
  }
  return best;
}

}  // namespace gear3k::calibrate
