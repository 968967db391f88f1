#include "calibrate/dynamic/window_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "numerics/linear_algebra.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

using Eigen::Index;
using numerics::square;

constexpr double kLeastSenseShare = 0.1;  // of a group's windows, for an offset of its own
constexpr double kCollinear = 1e-8;       // of 1: what is left of a scaled parameter
constexpr int kMostSteps = 30;

using Row5 = Eigen::Matrix<double, 5, 1>;
using Square5 = Eigen::Matrix<double, 5, 5>;

/// Sums of a group before the offset is eliminated.
struct RawGroup {
  int flow = 1;
  double load_kgm2 = 0.0;
  std::size_t windows = 0, forward_sense = 0;
  Square5 matrix = Square5::Zero();
  Row5 right = Row5::Zero();
  double square = 0.0;
};

/// Variance of each window, and correlation between neighbours.
struct NoiseOfWindows {
  double correlation = 0.0;
  std::vector<double> variance;
};

RawGroup& group_of(std::vector<RawGroup>& groups, const MotionWindow& w) {
  const auto at = std::ranges::find_if(
      groups, [&](const RawGroup& g) { return g.flow == w.flow && g.load_kgm2 == w.load_kgm2; });
  if (at != groups.end()) return *at;
  groups.push_back({.flow = w.flow, .load_kgm2 = w.load_kgm2});
  return groups.back();
}

std::vector<RawGroup> raw_groups(const std::vector<MotionWindow>& windows,
                                 const NoiseOfWindows& noise) {
  std::vector<RawGroup> groups;
  const double rho = noise.correlation, still = std::sqrt(1.0 - rho * rho);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const MotionWindow& w = windows[k];
    RawGroup& g = group_of(groups, w);
    const bool follows = w.follows && k > 0 && rho != 0.0;
    const double own = follows ? still : 1.0;
    const double now = 1.0 / (own * std::sqrt(noise.variance[k]));
    const double before = follows ? rho / (own * std::sqrt(noise.variance[k - 1])) : 0.0;
    Row5 x;
    Row5 variance = Row5::Zero();
    const MotionWindow& earlier = windows[follows ? k - 1 : k];
    for (Index j = 0; j < 5; ++j) {
      const auto place = static_cast<std::size_t>(j);
      x(j) = (now * w.term.at(place) - before * earlier.term.at(place));
    }
    const double y = (now * w.motor_Nm - before * earlier.motor_Nm);
    variance(0) = now * now * w.variance[0] + before * before * earlier.variance[0];
    variance(3) = now * now * w.variance[1] + before * before * earlier.variance[1];
    g.matrix += x * x.transpose();
    g.matrix.diagonal() -= variance;
    g.right += x * y;
    g.square += y * y;
    ++g.windows;
    if (w.sense > 0) ++g.forward_sense;
  }
  return groups;
}

/// With the offset eliminated where both senses show it.
WindowGroup settled_group(const RawGroup& raw) {
  const double share = static_cast<double>(raw.forward_sense) /
                       static_cast<double>(std::max<std::size_t>(1, raw.windows));
  WindowGroup g{.flow = raw.flow,
                .load_kgm2 = raw.load_kgm2,
                .windows = raw.windows,
                .both_senses = share >= kLeastSenseShare && share <= 1.0 - kLeastSenseShare};
  g.matrix = raw.matrix.topLeftCorner<4, 4>();
  g.right = raw.right.head<4>();
  g.square = raw.square;
  if (g.both_senses) {
    const Eigen::Vector4d cross = raw.matrix.topRightCorner<4, 1>();
    const double own = raw.matrix(4, 4);
    g.matrix -= cross * cross.transpose() / own;
    g.right -= cross * raw.right(4) / own;
    g.square -= square(raw.right(4)) / own;
  }
  return g;
}

/// Coefficients of a group by themselves, zero for what it does not show.
Eigen::Vector4d own_coefficients(const WindowGroup& g, int& count) {
  Eigen::Vector4d scale;
  for (Index j = 0; j < 4; ++j)
    scale(j) = g.matrix(j, j) > 0.0 ? 1.0 / std::sqrt(g.matrix(j, j)) : 0.0;
  const Eigen::Matrix4d scaled = scale.asDiagonal() * g.matrix * scale.asDiagonal();
  const Eigen::VectorXd values = numerics::symmetric_eigenvalues(scaled);
  for (Index j = 0; j < 4; ++j) count += values(j) > kCollinear ? 1 : 0;
  const Eigen::VectorXd right = scale.asDiagonal() * g.right;
  return scale.asDiagonal() * numerics::least_norm_solution(scaled, right);
}

/// Residuals of windows under coefficients by group, mean offset of each group included.
struct WindowResiduals {
  std::vector<double> value;
  std::vector<double> known;  ///< variance that noise of speed and load alone gives
  double coefficients = 0.0;
};

WindowResiduals own_residuals(const std::vector<MotionWindow>& windows,
                              const NoiseOfWindows& noise) {
  const std::vector<RawGroup> raws = raw_groups(windows, noise);
  WindowResiduals r;
  std::vector<Row5> solution;
  for (const RawGroup& raw : raws) {
    const WindowGroup g = settled_group(raw);
    int count = g.both_senses ? 1 : 0;
    Row5 beta = Row5::Zero();
    beta.head<4>() = own_coefficients(g, count);
    if (g.both_senses) {
      beta(4) = (raw.right(4) - raw.matrix.row(4).head<4>().dot(beta.head<4>())) / raw.matrix(4, 4);
    }
    r.coefficients += count;
    solution.push_back(beta);
  }
  r.value.reserve(windows.size());
  for (const MotionWindow& w : windows) {
    for (std::size_t k = 0; k < raws.size(); ++k) {
      if (raws[k].flow != w.flow || raws[k].load_kgm2 != w.load_kgm2) continue;
      double left = w.motor_Nm;
      for (std::size_t j = 0; j < 5; ++j) left -= w.term.at(j) * solution[k](static_cast<Index>(j));
      r.value.push_back(left);
      r.known.push_back(square(solution[k](0)) * w.variance[0] +
                        square(solution[k](3)) * w.variance[1]);
    }
  }
  return r;
}

/// What the windows scatter beyond the known part is the torque's own noise, the same in all of
/// them: the variance that makes the mean of the standardised squares 1.
NoiseOfWindows noise_of_windows(const std::vector<MotionWindow>& windows,
                                const WindowResiduals& residuals) {
  const auto n = static_cast<double>(windows.size());
  const double kept = (n - residuals.coefficients) / n;
  double greatest = 0.0;
  for (const double r : residuals.value) greatest = std::max(greatest, r * r);
  double low = 1e-12 * greatest, high = greatest + std::numeric_limits<double>::min();
  for (int step = 0; step < 100; ++step) {
    const double middle = std::sqrt(low * high);
    double sum = 0.0;
    for (std::size_t k = 0; k < windows.size(); ++k) {
      sum += square(residuals.value[k]) / (middle + residuals.known[k]);
    }
    (sum / n > kept ? low : high) = middle;
  }
  NoiseOfWindows noise;
  for (const double known : residuals.known) {
    noise.variance.push_back(std::max(high + known, std::numeric_limits<double>::min()));
  }
  double lagged = 0.0, both = 0.0, pairs = 0.0;
  for (std::size_t k = 1; k < windows.size(); ++k) {
    if (!windows[k].follows) continue;
    const double now = residuals.value[k] / std::sqrt(noise.variance[k]);
    const double before = residuals.value[k - 1] / std::sqrt(noise.variance[k - 1]);
    lagged += now * before;
    both += 0.5 * (now * now + before * before);
    pairs += 1.0;
  }
  // Within two standard errors of none it is none.
  if (std::abs(lagged) * std::sqrt(pairs) > 2.0 * both) {
    noise.correlation = std::clamp(lagged / both, -0.5, 0.9);
  }
  return noise;
}

/// Coefficients of every group under changes, one below the other.
Eigen::VectorXd all_coefficients(const WindowSums& sums, const DriveParameters& stated,
                                 const DriveChanges& changes) {
  const DriveParameters drive = changed_drive(stated, changes);
  Eigen::VectorXd beta(static_cast<Index>(4 * sums.groups.size()));
  for (std::size_t k = 0; k < sums.groups.size(); ++k) {
    const auto own = drive_coefficients(drive, sums.groups[k].flow, sums.groups[k].load_kgm2);
    for (std::size_t j = 0; j < 4; ++j) beta(static_cast<Index>(4 * k + j)) = own.at(j);
  }
  return beta;
}

double statistic_of(const WindowSums& sums, const Eigen::VectorXd& beta) {
  double sum = 0.0;
  for (std::size_t k = 0; k < sums.groups.size(); ++k) {
    const WindowGroup& g = sums.groups[k];
    const Eigen::Vector4d own = beta.segment<4>(static_cast<Index>(4 * k));
    sum += g.square - 2.0 * own.dot(g.right) + own.dot(g.matrix * own);
  }
  return sum;
}

/// A step of a change by which its effect is measured.
double natural_step(const DriveParameters& d, std::size_t change) {
  constexpr double kShare = 1e-4;
  const auto of = [&](double value, double otherwise) {
    return kShare * (value > 0.0 ? value : otherwise);
  };
  const double inertia = d.motor_inertia_kgm2 + d.output_inertia_kgm2;
  switch (change) {
    case kMotorCoulombChange:
    case kOutputCoulombChange:
      return of(d.motor_coulomb_Nm + d.output_coulomb_Nm, 1.0);
    case kMotorViscousChange:
    case kOutputViscousChange:
      return of(d.motor_viscous_Nms + d.output_viscous_Nms, 1.0);
    case kMotorInertiaChange:
    case kOutputInertiaChange:
      return of(inertia, 1.0);
    default:
      return kShare;
  }
}

/// Normal equations of the free changes at some changes.
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
};

NormalEquations normal_equations(const WindowSums& sums, const DriveParameters& stated,
                                 const DriveFit& fit) {
  const auto free = static_cast<Index>(fit.free.size());
  const Eigen::VectorXd beta = all_coefficients(sums, stated, fit.changes);
  Eigen::MatrixXd slopes(beta.size(), free);
  for (Index j = 0; j < free; ++j) {
    const std::size_t change = fit.free[static_cast<std::size_t>(j)];
    const double step = natural_step(stated, change);
    DriveChanges up = fit.changes, down = fit.changes;
    up.at(change) += step;
    down.at(change) -= step;
    slopes.col(j) =
        (all_coefficients(sums, stated, up) - all_coefficients(sums, stated, down)) / (2.0 * step);
  }
  NormalEquations n{.matrix = Eigen::MatrixXd::Zero(free, free),
                    .right = Eigen::VectorXd::Zero(free)};
  for (std::size_t k = 0; k < sums.groups.size(); ++k) {
    const WindowGroup& g = sums.groups[k];
    const auto at = static_cast<Index>(4 * k);
    const Eigen::MatrixXd own = slopes.middleRows(at, 4);
    n.matrix += own.transpose() * g.matrix * own;
    n.right += own.transpose() * (g.right - g.matrix * beta.segment<4>(at));
  }
  return n;
}

/// Whether anything can exist within three standard errors of a fit.
bool nearly_physical(const DriveFit& fit, const DriveParameters& stated) {
  constexpr double kErrors = 3.0;
  if (is_physical(changed_drive(stated, fit.changes))) return true;
  DriveChanges nearer = fit.changes;
  for (std::size_t j = 0; j < fit.free.size(); ++j) {
    const auto at = static_cast<Index>(j);
    const double room = kErrors * std::sqrt(fit.covariance(at, at));
    double& change = nearer.at(fit.free[j]);
    change = std::abs(change) <= room ? 0.0 : change - std::copysign(room, change);
  }
  return is_physical(changed_drive(stated, nearer));
}

}  // namespace

std::optional<WindowSums> window_sums(const std::vector<MotionWindow>& windows) {
  if (windows.size() < 12) return std::nullopt;
  NoiseOfWindows noise;
  noise.variance.assign(windows.size(), 1.0);
  constexpr int kRounds = 4;
  double coefficients = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const WindowResiduals residuals = own_residuals(windows, noise);
    coefficients = residuals.coefficients;
    if (static_cast<double>(windows.size()) < coefficients + 6.0) return std::nullopt;
    noise = noise_of_windows(windows, residuals);
  }
  WindowSums sums;
  sums.correlation = noise.correlation;
  sums.degrees = static_cast<double>(windows.size()) - coefficients;
  double sum = 0.0;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    sum += noise.variance[k] / square(windows[k].term[4]);
  }
  sums.deviation_Nm = std::sqrt(sum / static_cast<double>(windows.size()));
  for (const RawGroup& raw : raw_groups(windows, noise)) sums.groups.push_back(settled_group(raw));
  return sums;
}

FreeFit free_fit(const WindowSums& sums) {
  FreeFit r;
  for (const WindowGroup& g : sums.groups) {
    const Eigen::Vector4d beta = own_coefficients(g, r.coefficients);
    r.statistic += g.square - 2.0 * beta.dot(g.right) + beta.dot(g.matrix * beta);
  }
  return r;
}

DriveFit fit_drive(const WindowSums& sums, const DriveParameters& stated,
                   const std::vector<std::size_t>& free) {
  DriveFit fit{.free = free, .covariance = {}};
  const auto count = static_cast<Index>(free.size());
  fit.statistic = statistic_of(sums, all_coefficients(sums, stated, fit.changes));
  fit.covariance = Eigen::MatrixXd::Zero(count, count);
  for (int step = 0; count > 0 && step < kMostSteps; ++step) {
    const NormalEquations n = normal_equations(sums, stated, fit);
    Eigen::VectorXd scale(count);
    for (Index j = 0; j < count; ++j) {
      if (!(n.matrix(j, j) > 0.0)) {
        fit.determined = false;
        return fit;
      }
      scale(j) = 1.0 / std::sqrt(n.matrix(j, j));
    }
    const Eigen::MatrixXd scaled = scale.asDiagonal() * n.matrix * scale.asDiagonal();
    if (numerics::symmetric_eigenvalues(scaled)(0) < kCollinear) {
      fit.determined = false;
      return fit;
    }
    const Eigen::VectorXd right = scale.asDiagonal() * n.right;
    const Eigen::VectorXd move = scale.asDiagonal() * numerics::solve_symmetric(scaled, right);
    fit.covariance = scale.asDiagonal() * numerics::pseudo_inverse(scaled) * scale.asDiagonal();
    // Shorter steps where the whole one leads uphill.
    double share = 1.0;
    DriveChanges next = fit.changes;
    double statistic = fit.statistic;
    for (int halving = 0; halving < 12; ++halving, share *= 0.5) {
      next = fit.changes;
      for (Index j = 0; j < count; ++j)
        next.at(free[static_cast<std::size_t>(j)]) += share * move(j);
      statistic = statistic_of(sums, all_coefficients(sums, stated, next));
      if (statistic <= fit.statistic) break;
    }
    if (!(statistic <= fit.statistic)) break;
    const double gained = fit.statistic - statistic;
    fit.changes = next;
    fit.statistic = statistic;
    if (gained < 1e-9 * (1.0 + statistic)) break;
  }
  fit.physical = nearly_physical(fit, stated);
  return fit;
}

}  // namespace gear3k::calibrate
