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

/// The rows, what may be free in them, and the fit with all of it free.
class WindupModels {
 public:
  /// Empty where too few rows are left, or nothing is determined.
  static std::optional<WindupModels> of(WindupRows rows, const StatedWindup& stated);

  [[nodiscard]] WindupDiagnosis measured() const;
  void judge(double rate, WindupDiagnosis& d) const;

 private:
  /// Sets of causes that can exist, by increasing size; the first has none.
  struct Candidates {
    std::vector<WindupFit> fits;
    double null = 0.0;  ///< squares over σ² without a cause
    double gain = 0.0;  ///< of the best single cause
  };

  [[nodiscard]] WindupFit fit(const std::vector<Index>& causes_free) const;
  [[nodiscard]] double deviation(const WindupFit& fit, Index column) const;
  [[nodiscard]] MotionEstimate estimate(const WindupFit& fit, Index cause) const;
  [[nodiscard]] double base(Index cause) const;
  [[nodiscard]] bool is_physical(const WindupFit& fit) const;
  [[nodiscard]] Candidates candidates() const;
  /// Causes that are free in a fit; the delay, and of differences the drift, always are.
  [[nodiscard]] double size(const WindupFit& fit) const;
  [[nodiscard]] double price() const { return std::log(degrees_); }
  [[nodiscard]] double score(const WindupFit& fit) const;
  [[nodiscard]] MotionEffect effect_of(Index cause, const WindupFit& best,
                                       const Candidates& candidates) const;

  WindupRows rows_;
  StatedWindup stated_;
  WindupSums sums_;
  std::vector<Index> causes_;  ///< each determined alone
  std::vector<Index> most_;    ///< determined together
  WindupFit full_;             ///< with these free
  double degrees_ = 0.0, variance_ = 0.0;
};

std::optional<WindupModels> WindupModels::of(WindupRows rows, const StatedWindup& stated) {
  if (rows.y.size() < kFewestWindups) return std::nullopt;
  for (std::size_t k = 0; k < rows.y.size(); ++k) {
    rows.y[k] -=
        rows.x[k](kPlay) * stated.play_rad + rows.x[k](kCompliance) * stated.compliance_rad_Nm;
  }
  WindupModels m;
  m.rows_ = std::move(rows);
  m.stated_ = stated;
  m.sums_ = sums_of_windup(m.rows_, 0.0);
  for (const Index cause : {kPlay, kCompliance}) {
    if (m.fit({cause}).determined) m.causes_.push_back(cause);
  }
  if (m.causes_.empty()) return std::nullopt;
  m.most_ = m.causes_;
  if (!m.fit(m.most_).determined) m.most_ = {m.causes_.front()};
  m.sums_ = sums_of_windup(m.rows_, correlation_of(m.rows_, m.fit(m.most_)));
  m.full_ = m.fit(m.most_);
  m.degrees_ = static_cast<double>(m.rows_.y.size() - m.full_.free.size()) - m.rows_.constants;
  if (!m.full_.determined || m.degrees_ < 6.0 || !(m.full_.squares > 0.0)) return std::nullopt;
  m.variance_ = m.full_.squares / m.degrees_;
  return m;
}

WindupFit WindupModels::fit(const std::vector<Index>& causes_free) const {
  std::vector<Index> free = causes_free;
  free.push_back(kDelay);
  if (rows_.drifts) free.push_back(kDrift);
  return fit_windup(sums_, free);
}

double WindupModels::deviation(const WindupFit& fit, Index column) const {
  const auto place = std::ranges::find(fit.free, column) - fit.free.begin();
  return std::sqrt(variance_ * std::max(0.0, fit.covariance(place, place)));
}

MotionEstimate WindupModels::estimate(const WindupFit& fit, Index cause) const {
  const double half = numerics::student_quantile(0.975, degrees_) * deviation(fit, cause);
  return {
      .value = fit.value(cause), .low = fit.value(cause) - half, .high = fit.value(cause) + half};
}

double WindupModels::base(Index cause) const {
  return cause == kPlay ? stated_.play_rad : stated_.compliance_rad_Nm;
}

double WindupModels::size(const WindupFit& fit) const {
  return static_cast<double>(fit.free.size()) - (rows_.drifts ? 2.0 : 1.0);
}

double WindupModels::score(const WindupFit& fit) const {
  return fit.squares / variance_ + size(fit) * price();
}

WindupDiagnosis WindupModels::measured() const {
  WindupDiagnosis d;
  d.windows = rows_.y.size();
  d.flank_changes = rows_.flank_changes;
  d.of_speeds = rows_.drifts;
  d.delay_s = -full_.value(kDelay);
  d.delay_error_s = deviation(full_, kDelay);
  if (most_.size() < 2) return d;
  for (const Index cause : causes_) {
    const MotionEstimate e = estimate(full_, cause);
    d.found.at(static_cast<std::size_t>(cause)) = MotionEstimate{
        .value = base(cause) + e.value, .low = base(cause) + e.low, .high = base(cause) + e.high};
  }
  return d;
}

/// Whether neither play nor compliance comes out below zero by more than three standard errors.
bool WindupModels::is_physical(const WindupFit& fit) const {
  constexpr double kErrors = 1.5;  // of the half width, of about two
  return std::ranges::all_of(fit.free, [&](Index cause) {
    if (cause != kPlay && cause != kCompliance) return true;
    const MotionEstimate e = estimate(fit, cause);
    const double room = kErrors * (e.high - e.value);
    if (!(base(cause) + e.value + room >= 0.0)) return false;
    // A crossing between two readings of a speed is missed: they do not show less play.
    return !rows_.drifts || cause != kPlay || e.value > 0.0;
  });
}

WindupModels::Candidates WindupModels::candidates() const {
  Candidates c{.fits = {fit({})}};
  c.null = c.fits.front().squares / variance_;
  const auto add = [&](const std::vector<Index>& free) {
    WindupFit one = fit(free);
    if (!one.determined) return;
    if (free.size() == 1) c.gain = std::max(c.gain, c.null - one.squares / variance_);
    if (is_physical(one)) c.fits.push_back(std::move(one));
  };
  for (const Index cause : causes_) add({cause});
  if (most_.size() == 2) add(most_);
  return c;
}

std::size_t change_of(Index cause) {
  return cause == kPlay ? std::size_t{kClearanceChange} : std::size_t{kComplianceChange};
}

MotionEffect WindupModels::effect_of(Index cause, const WindupFit& best,
                                     const Candidates& candidates) const {
  const auto holds = [](const WindupFit& f, Index which) {
    return std::ranges::find(f.free, which) != f.free.end();
  };
  MotionEffect e;
  e.cause = change_of(cause);
  e.estimate = estimate(best, cause);
  if (most_.size() == 2) {
    // The other number is stated, not known: the interval holds what it leaves open.
    const MotionEstimate open = estimate(full_, cause);
    e.estimate.low = std::min(e.estimate.low, open.low);
    e.estimate.high = std::max(e.estimate.high, open.high);
  }
  double total = 0.0, without = candidates.null;
  for (const WindupFit& f : candidates.fits) total += std::exp(-0.5 * (score(f) - score(best)));
  for (const WindupFit& f : candidates.fits) {
    if (holds(f, cause)) {
      e.probability += std::exp(-0.5 * (score(f) - score(best))) / total;
    } else if (size(f) + 1.0 == size(best)) {
      without = f.squares / variance_;
    }
  }
  const double gained = without - best.squares / variance_;
  e.delta_bic = gained - price();
  e.p_value = numerics::f_upper_tail(std::max(0.0, gained), 1.0, degrees_);
  if (size(best) != 1.0) return e;
  for (const WindupFit& f : candidates.fits) {
    if (&f == &best || size(f) != 1.0) continue;
    const Index other = f.free.front();
    const double statistic = (f.squares - best.squares) / variance_;
    const double weight = std::exp(-0.5 * statistic);
    if (weight / (1.0 + weight) < kLeastAlternative) continue;
    e.alternatives.push_back({.cause = change_of(other),
                              .estimate = estimate(f, other),
                              .statistic = statistic,
                              .probability = weight / (1.0 + weight)});
  }
  return e;
}

/// Of every set of causes that can exist the one that is best by BIC, if any is significant.
void WindupModels::judge(double rate, WindupDiagnosis& d) const {
  const Candidates all = candidates();
  const double single = numerics::f_upper_tail(all.gain, 1.0, degrees_);
  d.p_value = std::min(1.0, single * static_cast<double>(causes_.size()));
  if (d.p_value >= rate || all.fits.size() < 2) return;
  const auto best = std::ranges::min_element(all.fits.begin() + 1, all.fits.end(), {},
                                             [&](const WindupFit& f) { return score(f); });
  for (const Index cause : causes_) {
    if (std::ranges::find(best->free, cause) == best->free.end()) continue;
    d.effects.push_back(effect_of(cause, *best, all));
  }
  std::ranges::sort(d.effects, std::greater{}, &MotionEffect::delta_bic);
}

}  // namespace

std::optional<WindupDiagnosis> diagnose_windup(const std::vector<MotionWindow>& windows,
                                               const DriveParameters& drive,
                                               const StatedWindup& stated, double rate) {
  const auto models = WindupModels::of(rows_of(windows, drive), stated);
  if (!models) return std::nullopt;
  WindupDiagnosis d = models->measured();
  models->judge(rate, d);
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
