#include "calibrate/search/noise_from_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "calibrate/causes/reading_change.hpp"
#include "numerics/distributions.hpp"
#include "numerics/linear_algebra.hpp"
#include "numerics/median.hpp"

namespace gear3k::calibrate {

namespace {

/// A step or a drift: what sessions could differ by without scattering.
bool separates_sessions(const Candidate& c) { return c.cause->remedy == Remedy::kProcedure; }

/// Residuals of which those far from their session's median count as less far: the sessions' own
/// distance, however great, is what is looked for.
Eigen::VectorXd clipped_in_sessions(const Eigen::VectorXd& residual, const NoiseModel& noise) {
  std::vector<std::vector<double>> rows(static_cast<std::size_t>(noise.runs) + 1);
  const auto session = [&](Eigen::Index i) {
    return static_cast<std::size_t>(noise.run[static_cast<std::size_t>(i)]) + 1;
  };
  for (Eigen::Index i = 0; i < residual.size(); ++i) rows[session(i)].push_back(residual[i]);
  // The median of fewer rows is as far off as one of them.
  constexpr std::size_t kFewestInMedian = 3;
  std::vector<double> median(rows.size(), 0.0);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].size() >= kFewestInMedian) median[r] = numerics::upper_median(std::move(rows[r]));
  }
  Eigen::VectorXd offset(residual.size());
  for (Eigen::Index i = 0; i < residual.size(); ++i) offset[i] = median[session(i)];
  const Eigen::VectorXd within = residual - offset;
  return offset + winsorised(within, robust_deviation(within));
}

/// What sessions' own values take off rows that other columns have left.
struct BetweenSessions {
  double sum_of_squares = 0.0;
  int degrees = 0;
  double squares = 0.0;  ///< of what one unit more is in a session's rows, on average
};

/// With s_r what one unit more is in the rows of session r, all orthogonal, d_r = s_rᵀ s_r and
/// U = D^(−1/2) Sᵀ B, the sum of squares of the rows l in the span of (I − B Bᵀ) S is
///
///   hᵀ h + (Uᵀ h)ᵀ (I − Uᵀ U)⁺ Uᵀ h,   h = D^(−1/2) Sᵀ l
///
/// and each direction of the sessions that B holds, 1 an eigenvalue of Uᵀ U, is one degree less:
/// no matrix of rows by sessions.
/// @param basis  B, orthonormal columns  @param left  l, orthogonal to them
BetweenSessions between_sessions(const NoiseModel& noise, const Eigen::MatrixXd& basis,
                                 const Eigen::VectorXd& left) {
  const Eigen::VectorXd ones = noise.whitened_ones();
  const std::vector<double> squares = noise.squares_by_session(ones);
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(noise.runs, basis.cols());
  Eigen::VectorXd h = Eigen::VectorXd::Zero(noise.runs);
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    const int r = noise.run[static_cast<std::size_t>(i)];
    if (r < 0) continue;
    const double share = ones[i] / std::sqrt(squares[static_cast<std::size_t>(r)]);
    u.row(r) += share * basis.row(i);
    h[r] += share * left[i];
  }
  const Eigen::VectorXd of_basis = u.transpose() * h;
  const Eigen::MatrixXd rest =
      Eigen::MatrixXd::Identity(basis.cols(), basis.cols()) - u.transpose() * u;
  constexpr double kHeld = 1e-9;
  const auto held = (numerics::symmetric_eigenvalues(rest).array() < kHeld).count();
  const auto with_rows = std::ranges::count_if(squares, [](double d) { return d > 0.0; });
  return {.sum_of_squares =
              h.squaredNorm() + of_basis.dot(numerics::least_norm_solution(rest, of_basis)),
          .degrees = static_cast<int>(with_rows - held),
          .squares = std::accumulate(squares.begin(), squares.end(), 0.0) / noise.runs};
}

/// From here on sessions that scatter are the rule.
constexpr int kSeveralRuns = 5;

/// A step in one session, of which several that scatter have one that lies farthest off.
bool is_of_one_among_several(const Candidate& c, const NoiseModel& noise) {
  return separates_sessions(c) && c.form.name.ends_with("only") && noise.runs >= kSeveralRuns;
}

/// Sessions beside what does not scatter.
struct SessionsBeside {
  BetweenSessions between{};
  double within = 0.0;  ///< variance of rows in their session
  int rest = 0;         ///< its degrees of freedom
};

/// Beside effects that were found, and where neither a step nor a drift is among them beside the
/// best single one: what it takes off is its own, and no scatter.
SessionsBeside sessions_beside(const Problem& problem, const SearchResult& found,
                               const std::vector<bool>& stays) {
  const NoiseModel& noise = problem.noise;
  const Hypothesis h = subset(found.fit.hypothesis, stays);
  std::vector<Candidate> steps;
  if (std::ranges::none_of(h.effects, separates_sessions)) {
    for (const Candidate& c : found.candidates) {
      if (separates_sessions(c) && !gives_each_session_a_value(c.form) &&
          !is_of_one_among_several(c, noise)) {
        steps.push_back(c);
      }
    }
  }
  const Columns columns = columns_at(problem, h, steps, 0.0);
  const Eigen::VectorXd residual = clipped_in_sessions(columns.residual, noise);
  // What is the same in all sessions is no scatter of theirs.
  Eigen::MatrixXd own(columns.own.rows(), columns.own.cols() + 1);
  Eigen::MatrixXd constant = Eigen::MatrixXd::Ones(columns.own.rows(), 1);
  noise.whiten(constant);
  own << constant, columns.own;
  if (!steps.empty()) {
    const Screen screen(own, columns.other, blocks_of(steps), 0.0);
    const auto gains = screen.gains(residual);
    const auto best = std::ranges::max_element(gains, {}, &Gain::sum_of_squares) - gains.begin();
    const Block& block = screen.blocks()[static_cast<std::size_t>(best)];
    Eigen::MatrixXd grown(own.rows(), own.cols() + block.count);
    grown << own, columns.other.middleCols(block.first, block.count);
    own = std::move(grown);
  }
  const Eigen::MatrixXd basis = orthonormal_basis(own);
  const Eigen::VectorXd left = residual - basis * (basis.transpose() * residual);
  SessionsBeside result{.between = between_sessions(noise, basis, left)};
  result.rest = static_cast<int>(left.size() - basis.cols()) - result.between.degrees;
  result.within = (left.squaredNorm() - result.between.sum_of_squares) / std::max(result.rest, 1);
  return result;
}

}  // namespace

std::optional<Eigen::VectorXd> weights_by_response(const Problem& problem,
                                                   const SearchResult& found) {
  if (problem.noise.source == NoiseSource::kStated) return std::nullopt;
  const Eigen::VectorXd simulated = found.fit.simulated.cwiseAbs();
  const double middle = simulated.mean();
  constexpr double kLeast = 0.05;
  const Eigen::VectorXd size = (simulated / middle).cwiseMax(kLeast);
  const Eigen::VectorXd residual = winsorised(found.fit.residual, found.scale);
  const auto n = static_cast<double>(residual.size());
  const auto weights = [&](double share) -> Eigen::VectorXd {
    return (1.0 - share + share * size.array().square()).rsqrt();
  };
  const auto likelihood = [&](double share) {
    const Eigen::VectorXd weight = weights(share);
    return weight.array().log().sum() -
           0.5 * n * std::log(residual.cwiseProduct(weight).squaredNorm() / n);
  };
  double best = 0.0;
  for (const double share : {0.1, 0.25, 0.5, 0.75, 0.9, 0.97, 1.0}) {
    if (likelihood(share) > likelihood(best)) best = share;
  }
  constexpr double kClearly = 3.0;
  if (best == 0.0 || likelihood(best) < likelihood(0.0) + kClearly) return std::nullopt;
  return problem.noise.weight.cwiseProduct(weights(best));
}

SessionScatter session_scatter(const Problem& problem, const SearchResult& found) {
  constexpr int kFewestRuns = 4;
  constexpr double kChance = 0.01;
  const NoiseModel& noise = problem.noise;
  if (noise.runs < kFewestRuns) return {};
  // Where every session has a value of its own nothing is left to scatter.
  const std::vector<Candidate>& effects = found.fit.hypothesis.effects;
  if (std::ranges::any_of(effects, gives_each_session_a_value, &Candidate::form)) return {};
  std::vector<bool> stays;
  stays.reserve(effects.size());
  bool alone = false;
  for (const Candidate& c : effects) {
    stays.push_back(!is_of_one_among_several(c, noise));
    alone = alone || !stays.back();
  }
  SessionsBeside sessions = sessions_beside(problem, found, stays);
  if (alone) {
    // Among several sessions that scatter one lies farthest off: that is no step unless it lies
    // farther off than the scatter of the others makes the farthest of so many.
    const SessionsBeside others =
        sessions_beside(problem, found, std::vector<bool>(effects.size(), true));
    const int taken = sessions.between.degrees - others.between.degrees;
    if (taken >= 1 && others.between.degrees >= 1) {
      const double f = (sessions.between.sum_of_squares - others.between.sum_of_squares) / taken /
                       (others.between.sum_of_squares / others.between.degrees);
      if (noise.runs * f_tail(f, taken, others.between.degrees) <= kChance) sessions = others;
    }
  }
  const int degrees = sessions.between.degrees;
  const int rest = sessions.rest;
  if (degrees < 1 || rest < 4) return {};
  const double f = sessions.between.sum_of_squares / degrees / sessions.within;
  // A few sessions that scatter are hardly told from one step; with more of them it is the rule
  // that they do, until the data say otherwise.
  if (noise.runs < kSeveralRuns && f_tail(f, degrees, rest) > kChance) return {};
  // The twentieth of values that chance makes smallest is guarded against: few sessions say little
  // of how much sessions scatter.
  const double guard = numerics::f_upper_quantile(0.05, rest, degrees);
  const double squares = sessions.between.squares;
  return {.estimate = std::max(0.0, (f - 1.0) / squares),
          .guarded = std::max(0.0, (f * std::max(1.0, guard) - 1.0) / squares)};
}

}  // namespace gear3k::calibrate
