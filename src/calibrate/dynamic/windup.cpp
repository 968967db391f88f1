#include "calibrate/dynamic/windup.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>

#include "numerics/distributions.hpp"
#include "numerics/linear_algebra.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

using Eigen::Index;
using numerics::square;

constexpr std::size_t kFewestWindups = 16;
constexpr double kLeastAlternative = 0.05;
constexpr double kDependentWindup = 1e-6;  // of 1: what is left of a scaled column
/// Columns: play over two by flank, compliance, delay, drift over time.
enum WindupColumn : Index { kPlay, kCompliance, kDelay, kDrift, kWindupColumns };
using Row = Eigen::Matrix<double, kWindupColumns, 1>;

struct WindupRows {
  std::vector<Row> x;
  std::vector<double> y, torque_variance;  ///< the latter of m
  std::vector<char> follows;
  double constants = 0.0;  ///< taken off, of the degrees of freedom
  std::size_t flank_changes = 0;
  bool drifts = false;
};

struct OneWindup {
  Row x = Row::Zero();
  double y = 0.0, variance = 0.0;
  int session = 0;
  bool follows = false;
};

OneWindup one_of(const MotionWindow& w, const DriveParameters& d) {
  const double root = w.term[4], inertia = d.output_inertia_kgm2 + w.load_kgm2;
  OneWindup r;
  r.x(kPlay) = 0.5 * w.flow * w.sense;
  r.x(kCompliance) = (inertia * w.term[0] + d.output_viscous_Nms * w.term[1] +
                      d.output_coulomb_Nm * w.term[2] + w.term[3]) /
                     root;
  r.x(kDelay) = w.term[1] / root;
  r.x(kDrift) = w.time_s;
  r.y = *w.windup_rad;
  r.variance = (square(inertia) * w.variance[0] + w.variance[1]) / square(root);
  r.session = w.session;
  r.follows = w.follows;
  return r;
}

/// Levels less the means of their sessions; of summed-up speeds differences of neighbours.
WindupRows rows_of(const std::vector<MotionWindow>& windows, const DriveParameters& drive) {
  WindupRows r;
  std::vector<OneWindup> all;
  for (const MotionWindow& w : windows) {
    if (!w.windup_rad) continue;
    all.push_back(one_of(w, drive));
    r.drifts = r.drifts || w.windup_drifts;
  }
  for (std::size_t k = 1; k < all.size(); ++k) {
    const bool same = all[k].session == all[k - 1].session;
    if (same && all[k].x(kPlay) != all[k - 1].x(kPlay)) ++r.flank_changes;
  }
  if (r.drifts) {
    for (std::size_t k = 1; k < all.size(); ++k) {
      if (all[k].session != all[k - 1].session) continue;
      // Summed-up noise grows with the time between.
      const double apart = all[k].x(kDrift) - all[k - 1].x(kDrift);
      if (!(apart > 0.0)) continue;
      r.x.emplace_back((all[k].x - all[k - 1].x) / std::sqrt(apart));
      r.y.push_back((all[k].y - all[k - 1].y) / std::sqrt(apart));
      r.torque_variance.push_back((all[k].variance + all[k - 1].variance) / apart);
      r.follows.push_back(k > 1 && all[k - 1].session == all[k - 2].session ? 1 : 0);
    }
    return r;
  }
  struct RowMean {
    Row x = Row::Zero();
    double y = 0.0, n = 0.0;
  };
  std::map<int, RowMean> means;
  for (const OneWindup& w : all) {
    RowMean& m = means[w.session];
    m.x += w.x;
    m.y += w.y;
    m.n += 1.0;
  }
  for (const OneWindup& w : all) {
    const RowMean& m = means[w.session];
    r.x.emplace_back(w.x - m.x / m.n);
    r.x.back()(kDrift) = 0.0;
    r.y.push_back(w.y - m.y / m.n);
    r.torque_variance.push_back(w.variance);
    r.follows.push_back(w.follows ? 1 : 0);
  }
  r.constants = static_cast<double>(means.size());
  return r;
}

/// Normal equations over σ², neighbours whitened.
struct WindupSums {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  double square = 0.0;
};

WindupSums sums_of_windup(const WindupRows& r, double correlation) {
  WindupSums s{.matrix = Eigen::MatrixXd::Zero(kWindupColumns, kWindupColumns),
               .right = Eigen::VectorXd::Zero(kWindupColumns)};
  const double own = std::sqrt(1.0 - correlation * correlation);
  for (std::size_t k = 0; k < r.y.size(); ++k) {
    Row x = r.x[k];
    double y = r.y[k], variance = r.torque_variance[k];
    if (correlation != 0.0 && r.follows[k] != 0 && k > 0) {
      x = (x - correlation * r.x[k - 1]) / own;
      y = (y - correlation * r.y[k - 1]) / own;
      variance = (variance + square(correlation) * r.torque_variance[k - 1]) / square(own);
    }
    s.matrix += x * x.transpose();
    s.matrix(kCompliance, kCompliance) -= variance;
    s.right += x * y;
    s.square += y * y;
  }
  return s;
}

struct WindupFit {
  bool determined = false, physical = true;
  std::vector<Index> free;
  Eigen::VectorXd value;       ///< of all columns, 0 for those that are not free
  Eigen::MatrixXd covariance;  ///< of the free ones, over σ²
  double squares = 0.0;
};

WindupFit fit_windup(const WindupSums& s, const std::vector<Index>& free) {
  WindupFit fit{.free = free, .value = Eigen::VectorXd::Zero(kWindupColumns), .covariance = {}};
  const auto n = static_cast<Index>(free.size());
  fit.covariance = Eigen::MatrixXd::Zero(n, n);
  fit.squares = s.square;
  if (n == 0) {
    fit.determined = true;
    return fit;
  }
  Eigen::MatrixXd a(n, n);
  Eigen::VectorXd b(n), scale(n);
  for (Index j = 0; j < n; ++j) {
    const Index at = free[static_cast<std::size_t>(j)];
    if (!(s.matrix(at, at) > 0.0)) return fit;
    scale(j) = 1.0 / std::sqrt(s.matrix(at, at));
    b(j) = s.right(at);
    for (Index k = 0; k < n; ++k) a(j, k) = s.matrix(at, free[static_cast<std::size_t>(k)]);
  }
  const Eigen::MatrixXd scaled = scale.asDiagonal() * a * scale.asDiagonal();
  if (numerics::symmetric_eigenvalues(scaled)(0) < kDependentWindup) return fit;
  const Eigen::VectorXd right = scale.asDiagonal() * b;
  const Eigen::VectorXd x = scale.asDiagonal() * numerics::solve_symmetric(scaled, right);
  fit.covariance = scale.asDiagonal() * numerics::pseudo_inverse(scaled) * scale.asDiagonal();
  for (Index j = 0; j < n; ++j) fit.value(free[static_cast<std::size_t>(j)]) = x(j);
  fit.squares = s.square - b.dot(x);
  fit.determined = true;
  return fit;
}

/// Correlation of neighbours' residuals; none within two standard errors.
double correlation_of(const WindupRows& r, const WindupFit& fit) {
  double lagged = 0.0, both = 0.0, pairs = 0.0;
  const auto left = [&](std::size_t k) { return r.y[k] - fit.value.dot(r.x[k]); };
  for (std::size_t k = 1; k < r.y.size(); ++k) {
    if (r.follows[k] == 0) continue;
    const double now = left(k), before = left(k - 1);
    lagged += now * before;
    both += 0.5 * (now * now + before * before);
    pairs += 1.0;
  }
  if (!(std::abs(lagged) * std::sqrt(pairs) > 2.0 * both)) return 0.0;
  return std::clamp(lagged / both, -0.5, 0.9);
}

}  // namespace

std::optional<WindupDiagnosis> diagnose_windup(const std::vector<MotionWindow>& windows,
                                               const DriveParameters& drive,
                                               const StatedWindup& stated, double rate) {
  WindupRows rows = rows_of(windows, drive);
  if (rows.y.size() < kFewestWindups) return std::nullopt;
  for (std::size_t k = 0; k < rows.y.size(); ++k) {
    rows.y[k] -=
        rows.x[k](kPlay) * stated.play_rad + rows.x[k](kCompliance) * stated.compliance_rad_Nm;
  }
  // What is always free: the delay, and of differences the drift.
  const double nuisances = rows.drifts ? 2.0 : 1.0;
  const auto with = [&](const std::vector<Index>& causes_free) {
    std::vector<Index> free;
    free.reserve(kWindupColumns);
    for (const Index cause : causes_free) free.push_back(cause);
    free.push_back(kDelay);
    if (rows.drifts) free.push_back(kDrift);
    return free;
  };
  WindupSums sums = sums_of_windup(rows, 0.0);
  std::vector<Index> causes;
  for (const Index cause : {kPlay, kCompliance}) {
    if (fit_windup(sums, with({cause})).determined) causes.push_back(cause);
  }
  if (causes.empty()) return std::nullopt;
  std::vector<Index> most = causes;
  if (!fit_windup(sums, with(most)).determined) most = {causes.front()};
  sums = sums_of_windup(rows, correlation_of(rows, fit_windup(sums, with(most))));
  const WindupFit full = fit_windup(sums, with(most));
  const double degrees = static_cast<double>(rows.y.size() - full.free.size()) - rows.constants;
  if (!full.determined || degrees < 6.0 || !(full.squares > 0.0)) return std::nullopt;
  const double variance = full.squares / degrees;

  const auto estimate = [&](const WindupFit& fit, Index cause) {
    const auto place = std::ranges::find(fit.free, cause) - fit.free.begin();
    const double half = numerics::student_quantile(0.975, degrees) *
                        std::sqrt(variance * std::max(0.0, fit.covariance(place, place)));
    return MotionEstimate{
        .value = fit.value(cause), .low = fit.value(cause) - half, .high = fit.value(cause) + half};
  };
  const auto base = [&](Index cause) {
    return cause == kPlay ? stated.play_rad : stated.compliance_rad_Nm;
  };
  const auto change = [](Index cause) {
    return cause == kPlay ? std::size_t{kClearanceChange} : std::size_t{kComplianceChange};
  };

  WindupDiagnosis d;
  d.windows = rows.y.size();
  d.flank_changes = rows.flank_changes;
  d.of_speeds = rows.drifts;
  d.delay_s = -full.value(kDelay);
  {
    const auto place = std::ranges::find(full.free, Index{kDelay}) - full.free.begin();
    d.delay_error_s = std::sqrt(variance * std::max(0.0, full.covariance(place, place)));
  }
  if (most.size() == 2) {
    for (const Index cause : causes) {
      MotionEstimate e = estimate(full, cause);
      e = {
          .value = base(cause) + e.value, .low = base(cause) + e.low, .high = base(cause) + e.high};
      d.found.at(static_cast<std::size_t>(cause)) = e;
    }
  }

  // Every set of causes that can exist.
  std::vector<WindupFit> fits{fit_windup(sums, with({}))};
  const double null = fits.front().squares / variance;
  double gain = 0.0;
  const auto add = [&](const std::vector<Index>& free) {
    WindupFit fit = fit_windup(sums, with(free));
    if (!fit.determined) return;
    if (free.size() == 1) gain = std::max(gain, null - fit.squares / variance);
    // Within three standard errors of neither play nor compliance.
    for (const Index cause : free) {
      const MotionEstimate e = estimate(fit, cause);
      constexpr double kErrors = 1.5;  // of the half width, of about two
      const double room = kErrors * (e.high - e.value);
      fit.physical = fit.physical && base(cause) + e.value + room >= 0.0;
      // A crossing between two readings of a speed is missed: they do not show less play.
      if (rows.drifts && cause == kPlay) fit.physical = fit.physical && e.value > 0.0;
    }
    if (fit.physical) fits.push_back(std::move(fit));
  };
  for (const Index cause : causes) add({cause});
  if (most.size() == 2) add(most);
  const double single = numerics::f_upper_tail(gain, 1.0, degrees);
  d.p_value = std::min(1.0, single * static_cast<double>(causes.size()));
  if (d.p_value >= rate || fits.size() < 2) return d;
  const double price = std::log(degrees);
  const auto size = [&](const WindupFit& f) {
    return static_cast<double>(f.free.size()) - nuisances;
  };
  const auto score = [&](const WindupFit& f) { return f.squares / variance + size(f) * price; };
  const auto best = std::ranges::min_element(fits.begin() + 1, fits.end(), {}, score);
  double total = 0.0;
  for (const WindupFit& f : fits) total += std::exp(-0.5 * (score(f) - score(*best)));
  for (const Index cause : causes) {
    if (std::ranges::find(best->free, cause) == best->free.end()) continue;
    MotionEffect e;
    e.cause = change(cause);
    e.estimate = estimate(*best, cause);
    if (most.size() == 2) {
      // The other number is stated, not known: the interval holds what it leaves open.
      const MotionEstimate open = estimate(full, cause);
      e.estimate.low = std::min(e.estimate.low, open.low);
      e.estimate.high = std::max(e.estimate.high, open.high);
    }
    double without = null;
    for (const WindupFit& f : fits) {
      if (std::ranges::find(f.free, cause) != f.free.end()) {
        e.probability += std::exp(-0.5 * (score(f) - score(*best))) / total;
      } else if (size(f) + 1.0 == size(*best)) {
        without = f.squares / variance;
      }
    }
    const double gained = without - best->squares / variance;
    e.delta_bic = gained - price;
    e.p_value = numerics::f_upper_tail(std::max(0.0, gained), 1.0, degrees);
    if (size(*best) == 1.0) {
      for (const WindupFit& f : fits) {
        if (&f == &*best || size(f) != 1.0) continue;
        const Index other = f.free.front();
        const double statistic = (f.squares - best->squares) / variance;
        const double weight = std::exp(-0.5 * statistic);
        if (weight / (1.0 + weight) < kLeastAlternative) continue;
        e.alternatives.push_back({.cause = change(other),
                                  .estimate = estimate(f, other),
                                  .statistic = statistic,
                                  .probability = weight / (1.0 + weight)});
      }
    }
    d.effects.push_back(std::move(e));
  }
  std::ranges::sort(d.effects, std::greater{}, &MotionEffect::delta_bic);
  return d;
}

void add_windup(const WindupDiagnosis& windup, const StatedWindup& stated, MotionDiagnosis& d) {
  d.quantities.push_back({.name = "backlash",
                          .unit = "arcmin",
                          .stated = stated.play_rad,
                          .found = windup.found[kPlay]});
  d.quantities.push_back({.name = "compliance",
                          .unit = "rad/Nm",
                          .stated = stated.compliance_rad_Nm,
                          .found = windup.found[kCompliance]});
  constexpr double kClearly = 4.0, kLeastDelay_s = 1e-4;
  if (std::abs(windup.delay_s) > std::max(kClearly * windup.delay_error_s, kLeastDelay_s)) {
    d.notes.push_back(
        fmt::format("the motor's side is read {:.3g} ms {} the output: it is taken out",
                    1e3 * std::abs(windup.delay_s), windup.delay_s > 0.0 ? "after" : "before"));
  }
  if (windup.of_speeds && windup.flank_changes > 0) {
    d.notes.emplace_back(
        "play is summed up from speeds: it is all there where they are differences of counts over "
        "the step between rows, and too small where the play is crossed between two readings, so "
        "that less play than stated is not told; angles of both sides tell it");
  }
  if (windup.flank_changes == 0) {
    d.notes.emplace_back(
        "both sides are logged, but the mesh stays on one flank: play cannot be known");
  }
  if (windup.effects.empty()) return;
  const bool doubtful =
      std::ranges::any_of(windup.effects, [](const auto& e) { return !e.alternatives.empty(); });
  d.effects.insert(d.effects.end(), windup.effects.begin(), windup.effects.end());
  if (doubtful) {
    d.notes.emplace_back(
        "play and compliance do the same where the torque is alike on either flank: a log with "
        "torques from small to great on both would tell");
  }
  if (d.verdict == MotionVerdict::kUnexplained) return;
  if (doubtful) {
    d.verdict = MotionVerdict::kAmbiguous;
  } else if (d.verdict == MotionVerdict::kNoDiscrepancy) {
    d.verdict = MotionVerdict::kExplained;
  }
}

}  // namespace gear3k::calibrate
