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

/// Variance of each window, and correlation between neighbours.
struct NoiseOfWindows {
  double correlation = 0.0;
  std::vector<double> variance;
};

WindowGroup& group_of(std::vector<WindowGroup>& groups, const MotionWindow& w) {
  const auto at = std::ranges::find_if(
      groups, [&](const WindowGroup& g) { return g.flow == w.flow && g.load_kgm2 == w.load_kgm2; });
  if (at != groups.end()) return *at;
  groups.push_back({.flow = w.flow, .load_kgm2 = w.load_kgm2});
  return groups.back();
}

/// Groups of the same load show an offset of the torque where both senses are among their windows.
void mark_senses(std::vector<WindowGroup>& groups, const std::vector<MotionWindow>& windows) {
  for (WindowGroup& g : groups) {
    double all = 0.0, forward = 0.0;
    for (const MotionWindow& w : windows) {
      if (w.load_kgm2 != g.load_kgm2) continue;
      all += 1.0;
      if (w.sense > 0) forward += 1.0;
    }
    g.both_senses = forward >= kLeastSenseShare * all && forward <= (1.0 - kLeastSenseShare) * all;
  }
}

WindowSums sums_of(const std::vector<MotionWindow>& windows, const NoiseOfWindows& noise) {
  WindowSums sums;
  const double rho = noise.correlation, still = std::sqrt(1.0 - rho * rho);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const MotionWindow& w = windows[k];
    WindowGroup& g = group_of(sums.groups, w);
    const bool follows = w.follows && k > 0 && rho != 0.0;
    const double own = follows ? still : 1.0;
    const double now = 1.0 / (own * std::sqrt(noise.variance[k]));
    const double before = follows ? rho / (own * std::sqrt(noise.variance[k - 1])) : 0.0;
    const MotionWindow& earlier = windows[follows ? k - 1 : k];
    const auto whitened = [&](std::size_t place) {
      return now * w.term.at(place) - before * earlier.term.at(place);
    };
    const Eigen::Vector4d x(whitened(0), whitened(1), whitened(2), whitened(3));
    const double one = whitened(4);
    const double y = now * w.motor_Nm - before * earlier.motor_Nm;
    g.matrix += x * x.transpose();
    g.matrix(0, 0) -= now * now * w.variance[0] + before * before * earlier.variance[0];
    g.matrix(3, 3) -= now * now * w.variance[1] + before * before * earlier.variance[1];
    g.right += x * y;
    g.square += y * y;
    g.offset += one * x;
    g.offset_square += one * one;
    g.offset_right += one * y;
    ++g.windows;
  }
  mark_senses(sums.groups, windows);
  assemble(sums);
  return sums;
}

/// 1 over the roots of a matrix's diagonal; 0 for what is not there.
Eigen::VectorXd unit_scale(const Eigen::MatrixXd& matrix) {
  Eigen::VectorXd scale = Eigen::VectorXd::Zero(matrix.rows());
  for (Index j = 0; j < matrix.rows(); ++j) {
    if (matrix(j, j) > 0.0) scale(j) = 1.0 / std::sqrt(matrix(j, j));
  }
  return scale;
}

/// Coefficients of all groups by themselves, zero for what they do not show.
Eigen::VectorXd own_coefficients(const WindowSums& sums, int& count) {
  const Eigen::VectorXd scale = unit_scale(sums.matrix);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * sums.matrix * scale.asDiagonal();
  const Eigen::VectorXd values = numerics::symmetric_eigenvalues(scaled);
  for (Index j = 0; j < values.size(); ++j) count += values(j) > kCollinear ? 1 : 0;
  const Eigen::VectorXd right = scale.asDiagonal() * sums.right;
  return scale.asDiagonal() * numerics::least_norm_solution(scaled, right);
}

/// Sums of the offset of a load over its groups.
struct OffsetOfLoad {
  double load_kgm2 = 0.0, square = 0.0, right = 0.0;
  Eigen::VectorXd cross;  ///< with the coefficients of all groups
};

std::vector<OffsetOfLoad> offsets_of(const std::vector<WindowGroup>& groups) {
  std::vector<OffsetOfLoad> offsets;
  const auto size = static_cast<Index>(4 * groups.size());
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const WindowGroup& g = groups[k];
    if (!g.both_senses || !(g.offset_square > 0.0)) continue;
    auto at = std::ranges::find(offsets, g.load_kgm2, &OffsetOfLoad::load_kgm2);
    if (at == offsets.end()) {
      offsets.push_back({.load_kgm2 = g.load_kgm2, .cross = Eigen::VectorXd::Zero(size)});
      at = offsets.end() - 1;
    }
    at->square += g.offset_square;
    at->right += g.offset_right;
    at->cross.segment<4>(static_cast<Index>(4 * k)) = g.offset;
  }
  return offsets;
}

/// Residuals of windows under coefficients by group, mean offset of each group included.
struct WindowResiduals {
  std::vector<double> value;
  std::vector<double> known;  ///< variance that noise of speed and load alone gives
  double coefficients = 0.0;
};

WindowResiduals own_residuals(const std::vector<MotionWindow>& windows,
                              const NoiseOfWindows& noise) {
  const WindowSums sums = sums_of(windows, noise);
  const std::vector<OffsetOfLoad> offsets = offsets_of(sums.groups);
  WindowResiduals r;
  int count = static_cast<int>(offsets.size());
  const Eigen::VectorXd beta = own_coefficients(sums, count);
  r.coefficients = count;
  r.value.reserve(windows.size());
  for (const MotionWindow& w : windows) {
    double offset = 0.0;
    for (const OffsetOfLoad& o : offsets) {
      if (o.load_kgm2 == w.load_kgm2) offset = (o.right - o.cross.dot(beta)) / o.square;
    }
    for (std::size_t k = 0; k < sums.groups.size(); ++k) {
      if (sums.groups[k].flow != w.flow || sums.groups[k].load_kgm2 != w.load_kgm2) continue;
      const Eigen::Vector4d own = beta.segment<4>(static_cast<Index>(4 * k));
      double left = w.motor_Nm - offset * w.term[4];
      for (std::size_t j = 0; j < 4; ++j) left -= w.term.at(j) * own(static_cast<Index>(j));
      r.value.push_back(left);
      r.known.push_back(square(own(0)) * w.variance[0] + square(own(3)) * w.variance[1]);
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
  return sums.square - 2.0 * beta.dot(sums.right) + beta.dot(sums.matrix * beta);
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
  const Eigen::VectorXd left = sums.right - sums.matrix * beta;
  return {.matrix = slopes.transpose() * sums.matrix * slopes, .right = slopes.transpose() * left};
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

void assemble(WindowSums& sums) {
  const auto size = static_cast<Index>(4 * sums.groups.size());
  sums.matrix = Eigen::MatrixXd::Zero(size, size);
  sums.right = Eigen::VectorXd::Zero(size);
  sums.square = 0.0;
  for (std::size_t k = 0; k < sums.groups.size(); ++k) {
    const auto at = static_cast<Index>(4 * k);
    sums.matrix.block<4, 4>(at, at) = sums.groups[k].matrix;
    sums.right.segment<4>(at) = sums.groups[k].right;
    sums.square += sums.groups[k].square;
  }
  for (const OffsetOfLoad& o : offsets_of(sums.groups)) {
    sums.matrix -= o.cross * o.cross.transpose() / o.square;
    sums.right -= o.cross * (o.right / o.square);
    sums.square -= square(o.right) / o.square;
  }
}

std::optional<OwnCoefficient> own_coefficient(const WindowSums& sums, std::size_t place) {
  const auto at = static_cast<Index>(place), rest = sums.matrix.rows() - 1;
  const double all = sums.matrix(at, at);
  if (!(all > 0.0)) return std::nullopt;
  const auto other = [&](Index j) { return j < at ? j : j + 1; };
  Eigen::MatrixXd others(rest, rest);
  Eigen::VectorXd cross(rest), right(rest);
  for (Index j = 0; j < rest; ++j) {
    for (Index k = 0; k < rest; ++k) others(j, k) = sums.matrix(other(j), other(k));
    cross(j) = sums.matrix(at, other(j));
    right(j) = sums.right(other(j));
  }
  const Eigen::VectorXd scale = unit_scale(others);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * others * scale.asDiagonal();
  const Eigen::VectorXd weights =
      scale.asDiagonal() * (numerics::pseudo_inverse(scaled) * (scale.asDiagonal() * cross));
  const double own = all - cross.dot(weights);
  if (!(own > kCollinear * all)) return std::nullopt;
  return OwnCoefficient{.value = (sums.right(at) - weights.dot(right)) / own,
                        .variance = 1.0 / own};
}

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
  WindowSums sums = sums_of(windows, noise);
  sums.correlation = noise.correlation;
  sums.degrees = static_cast<double>(windows.size()) - coefficients;
  double sum = 0.0;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    sum += noise.variance[k] / square(windows[k].term[4]);
  }
  sums.deviation_Nm = std::sqrt(sum / static_cast<double>(windows.size()));
  return sums;
}

FreeFit free_fit(const WindowSums& sums) {
  FreeFit r;
  r.statistic = statistic_of(sums, own_coefficients(sums, r.coefficients));
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
