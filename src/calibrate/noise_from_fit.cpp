#include "calibrate/noise_from_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

namespace gear3k::calibrate {

namespace {

/// A step or a drift: what sessions could differ by without scattering.
bool separates_sessions(const Candidate& c) { return c.cause->remedy == Remedy::kProcedure; }

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
  const auto likelihood = [&](double power) {
    const Eigen::VectorXd weight = size.array().pow(-power);
    return weight.array().log().sum() -
           0.5 * n * std::log(residual.cwiseProduct(weight).squaredNorm() / n);
  };
  double best = 0.0;
  for (const double power : {0.5, 1.0}) {
    if (likelihood(power) > likelihood(best)) best = power;
  }
  constexpr double kClearly = 4.0;
  if (likelihood(best) < likelihood(0.0) + kClearly) return std::nullopt;
  return size.array().pow(-best).matrix();
}

double session_variance(const Problem& problem, const SearchResult& found) {
  constexpr int kFewestRuns = 4;
  const NoiseModel& noise = problem.noise;
  if (noise.runs < kFewestRuns) return 0.0;
  // What a step or a drift would take off counts as theirs, not as scatter.
  const Hypothesis& all = found.fit.hypothesis;
  std::vector<bool> stays;
  stays.reserve(all.effects.size());
  for (const Candidate& c : all.effects) stays.push_back(!separates_sessions(c));
  const Hypothesis h = subset(all, stays);
  std::vector<Candidate> steps;
  for (const Candidate& c : found.candidates) {
    if (separates_sessions(c)) steps.push_back(c);
  }
  const Columns columns = columns_at(problem, h, steps, found.scale);
  const Screen screen(columns.own, columns.other, blocks_of(steps), 0.0);
  const auto gains = screen.gains(columns.residual);
  const auto best = std::ranges::max_element(gains, {}, &Gain::sum_of_squares) - gains.begin();
  const Block& block = screen.blocks()[static_cast<std::size_t>(best)];
  Eigen::MatrixXd own(columns.own.rows(), columns.own.cols() + block.count);
  own << columns.own, columns.other.middleCols(block.first, block.count);
  const Eigen::MatrixXd basis = orthonormal_basis(own);
  const Eigen::VectorXd left = columns.residual - basis * (basis.transpose() * columns.residual);
  Eigen::MatrixXd sessions = Eigen::MatrixXd::Zero(left.size(), noise.runs);
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    const int r = noise.run[static_cast<std::size_t>(i)];
    if (r >= 0) sessions(i, r) = 1.0;
  }
  sessions -= basis * (basis.transpose() * sessions);
  const Eigen::MatrixXd session_basis = orthonormal_basis(sessions);
  const auto degrees = static_cast<int>(session_basis.cols());
  const auto rest = static_cast<int>(left.size() - basis.cols() - session_basis.cols());
  if (degrees < 1 || rest < 4) return 0.0;
  const double between = (session_basis.transpose() * left).squaredNorm();
  const double within = (left.squaredNorm() - between) / rest;
  const double f = between / degrees / within;
  // A few sessions that scatter are hardly told from one step; with more of them it is the rule
  // that they do, until the data say otherwise.
  constexpr double kChance = 0.01;
  constexpr int kSeveralRuns = 5;
  if (noise.runs < kSeveralRuns && f_tail(f, degrees, rest) > kChance) return 0.0;
  // The twentieth of values that chance makes smallest is guarded against: few sessions say little
  // of how much sessions scatter.
  const double guard =
      boost::math::quantile(boost::math::complement(boost::math::fisher_f(rest, degrees), 0.05));
  const double rows = static_cast<double>(left.size()) / noise.runs;
  return std::max(0.0, (f * std::max(1.0, guard) - 1.0) / rows);
}

}  // namespace gear3k::calibrate
